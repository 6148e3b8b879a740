"""What errors of strong signatures may leave, in the direction of a weaker name.

A signature that errs by a share e of its length errs where it lives: one that moves means by a
thousand standard deviations leaves e of that in the means, and hardly anything in the counts of
rare events. With errors of e^2 E_k in statistics of kind k, E_k being what the effects found
explain there, a unit direction c gathers sum_k |c_k|^2 e^2 E_k of them by chance.
"""

import numpy as np
from numpy.typing import NDArray

from calib.diagnosis.evidence.evidence import Evidence
from calib.diagnosis.evidence.point import Point
from calib.diagnosis.naming.model import Model

Floats = NDArray[np.float64]

IMPERFECT = 0.002
"""e^2, e being about 0.03 (see `calib.diagnosis.naming.template_error`), and twice that."""
ASTRAY = 0.1
"""Of that, what errors leave in statistics that the signature itself does not move."""


def left_by_errors(direction: Point, model: Model, evidence: Evidence) -> float:
    """Return the deviance that `direction` may gather of what the model's members leave."""
    if not model.members:
        return 0.0
    moved = energies(model.first - model.residual, evidence)
    along = energies(direction, evidence)
    there = float(along @ moved) / max(float(along.sum()), 1e-300)
    return IMPERFECT * (there + ASTRAY * float(moved.sum()))


def energies(point: Point, evidence: Evidence) -> Floats:
    """Return the squared length of a point in each kind of statistic, (n_kinds,)."""
    n = evidence.pooled.std.size
    pooled = point.rest[:n].reshape(evidence.pooled.std.shape)
    found = [max(evidence.space.product(point.means, point.means), 0.0)]
    found += [float((pooled[:, where] ** 2).sum()) for where in evidence.pooled.places.values()]
    end = n
    for kind, where in evidence.rest_places.items():
        if kind != "pooled":
            found.append(float((point.rest[where] ** 2).sum()))
            end = max(end, where.stop)
    found.append(float((point.rest[end:] ** 2).sum()))
    return np.array(found)
