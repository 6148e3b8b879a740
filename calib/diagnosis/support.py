"""Whether names hold: one that explains little more than what it leaves is none.

Of physics that the catalogue does not have, the nearest name always explains a part. A right name
leaves chance, and of a shape that its family does not have, a small share. So a name has to explain
several times what remains beside it, in the statistics where most remains; otherwise it is dropped,
the weakest first, and the whole is called unexplained.
"""

import numpy as np

from calib.diagnosis.contest import Contest
from calib.diagnosis.model import Model
from calib.diagnosis.remainder import unexplained_deviance

LEAST_RATIO = 5.0
"""Of the deviance that a name explains to what remains: two patterns that part by an angle of
24 degrees, tan^2 = 1/5, are no longer one."""


def supported(model: Model, contest: Contest) -> Model:
    """Return the model without names that explain too little of what there is to explain."""
    while model.members:
        left = unexplained_deviance(model, contest.evidence)
        gains = [contest.own_gain(model, k) for k in range(len(model.members))]
        least = int(np.argmin(gains))
        if gains[least] >= LEAST_RATIO * left:
            return model
        kept = [m for j, m in enumerate(model.members) if j != least]
        model = contest.refitted(model, kept)
    return model
