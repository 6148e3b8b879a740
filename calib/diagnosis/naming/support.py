"""Whether names hold: a right one leaves little, and says what happens where it was not fitted.

Of physics that the catalogue does not have, the nearest name always explains a part. A right name
leaves chance, and of a shape that its family does not have, a small share. So a name has to explain
several times what remains beside it, in the statistics where most remains, and must not make
exposures or levels worse that are left out of its fit; otherwise it is dropped, the weakest first.
What is dropped is unexplained.
"""

import numpy as np

from calib.diagnosis.evidence.evidence import Evidence
from calib.diagnosis.naming.contest import Contest, told_twice
from calib.diagnosis.naming.heldout import HeldOutDeviances
from calib.diagnosis.naming.model import Model
from calib.diagnosis.naming.remainder import unexplained_deviance

LEAST_RATIO = 8.0
"""Of the deviance that a name explains to what remains: two patterns that part by an angle of
19 degrees, tan^2 = 1/8, are no longer one."""
WORST_GAIN = -9.0
"""Of a right name: a gain that is G on average scatters by 2 sqrt(G), and G - 3 x 2 sqrt(G) is
least, -9, at G = 9."""


def supported(model: Model, contest: Contest) -> Model:
    """Return the model without names that do not hold."""
    never = unexplained_deviance(model, contest.evidence)
    while model.members:
        left = unexplained_deviance(model, contest.evidence)
        gains = [_gain(k, model, contest) for k in range(len(model.members))]
        least = int(np.argmin(gains))
        # What a name has explained that was dropped is no remainder like what no name explains.
        if gains[least] >= max(LEAST_RATIO * min(left, never), left):
            wrong = _mispredicting(model, contest.evidence)
            if wrong is None:
                return model
            least = wrong
        kept = [m for j, m in enumerate(model.members) if j != least]
        model = contest.refitted(model, kept)
    return model


def _gain(k: int, model: Model, contest: Contest) -> float:
    """Return the deviance that member `k` explains, also of what whitened counts have less of."""
    shape = model.members[k].signature.shape
    others = [m for j, m in enumerate(model.members) if j != k]
    return contest.own_gain(model, k) + max(-shape.cost - told_twice(shape, others), 0.0)


def _mispredicting(model: Model, evidence: Evidence) -> int | None:
    """Return the member that makes left out exposures or levels worst; None where none does.

    What shows in single samples or codes is not put to this test, which does not look at them.
    """
    folded = [HeldOutDeviances(model, evidence, by) for by in ("exposures", "levels")]
    worst = [
        min((each.gain(k) for each in folded if each.folds), default=0.0)
        if member.effect.shows_in not in {"tail", "histogram"}
        else 0.0
        for k, member in enumerate(model.members)
    ]
    return int(np.argmin(worst)) if min(worst) < WORST_GAIN else None
