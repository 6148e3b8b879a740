"""How well models predict blocks that they did not see.

The deviance of the blocks left out is the log predictive density given all others, summed over
folds: offsets, slopes, gains, noise and the effects' parameters are those of the other blocks, with
what they leave uncertain (flat priors, linear about the fit).
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from calib.diagnosis.change import Change
from calib.diagnosis.evidence import Evidence
from calib.diagnosis.model import Model
from calib.diagnosis.point import Point
from calib.diagnosis.projection import orthonormal, without

FOLDS = 4


@dataclass(frozen=True)
class HeldOut:
    """Deviance of what was left out.

    Attributes:
        deviance: Minus twice the log predictive density, up to what all models share.
        dof: How many numbers were predicted.
    """

    deviance: float
    dof: int


def folds_of(evidence: Evidence) -> tuple[NDArray[np.intp], ...]:
    """Return blocks in groups that are as unlike as can be: each takes every fourth by dose."""
    order = np.lexsort((evidence.table.started_s, evidence.table.dose))
    n = min(FOLDS, max(evidence.n_blocks // 3, 1))
    return tuple(np.sort(order[k::n]) for k in range(n)) if n > 1 else ()


class HeldOutDeviances:
    """Answers for several models of one recording; what they share is worked out once."""

    def __init__(self, model: Model, evidence: Evidence) -> None:
        self._model = model
        full = evidence.without_blocks(np.zeros(0, np.intp))
        self._spaces = [full, *(evidence.without_blocks(fold) for fold in folds_of(evidence))]
        self._points = [_points(model, space) for space in self._spaces]

    def of(self, members: Sequence[int]) -> HeldOut:
        """Return the deviance with only those members of the model, refitted linearly."""
        every, *trained = [
            _deviance(self._model, members, points, space)
            for points, space in zip(self._points, self._spaces, strict=True)
        ]
        if not trained:
            return HeldOut(every, self.dof)
        return HeldOut(float(sum(every - each for each in trained)), self.dof)

    @property
    def dof(self) -> int:
        """How many numbers are predicted."""
        space = self._spaces[0]
        pooled = int((np.isfinite(space.pooled_std) & (space.pooled_std > 0)).sum())
        return space.space.degrees_of_freedom + pooled


def _points(model: Model, space: Evidence) -> tuple[Point, list[list[Point]]]:
    observed = space.point(model.observed)
    if model.change is None:
        return observed, []
    change: Change = model.change
    directions = [[space.derivative(each, change) for each in m.changes] for m in model.members]
    return observed, directions


def _deviance(
    model: Model,
    members: Sequence[int],
    points: tuple[Point, list[list[Point]]],
    space: Evidence,
) -> float:
    """Return the least squared misfit, and what the fitted parameters' spread adds."""
    observed, directions = points
    target = observed
    if model.change is not None and len(members) == len(model.members):
        target = observed - space.point(model.change)
    basis: list[Point] = []
    spread = 0.0
    for k in members:
        for each in directions[k]:
            rest = without(each, basis, space)
            length2 = space.product(rest, rest)
            if length2 > 1e-6 * max(space.product(each, each), 1e-12):
                spread += float(np.log(length2))
                basis += orthonormal([rest], space)
    rest = without(target, basis, space)
    return space.product(rest, rest) + spread
