"""How well models predict blocks that they did not see.

The deviance of the blocks left out is the log predictive density given all others, summed over
folds: offsets, slopes, gains, noise and the effects' parameters are those of the other blocks, with
what they leave uncertain (flat priors, linear about the fit).

Left out are single blocks, and whole exposures, and whole levels: a name that only resembles what
is there may interpolate between blocks, but says wrong things of exposures that it has not seen.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from calib.diagnosis.evidence.evidence import Evidence
from calib.diagnosis.evidence.point import Point
from calib.diagnosis.evidence.projection import orthonormal, without
from calib.diagnosis.naming.contribution import contribution_change
from calib.diagnosis.naming.model import Model
from calib.diagnosis.statistics.change import Change

Folds = tuple[NDArray[np.intp], ...]

FOLDS = 4
FEWEST_GROUPS = 3
"""Of so many exposures or levels one may be left out and the rest still tell a law."""


@dataclass(frozen=True)
class HeldOut:
    """Deviance of what was left out.

    Attributes:
        deviance: Minus twice the log predictive density, up to what all models share.
        dof: How many numbers were predicted.
    """

    deviance: float
    dof: int


def blocks_of(evidence: Evidence) -> Folds:
    """Return blocks in groups that are as unlike as can be: each takes every fourth by dose."""
    order = np.lexsort((evidence.table.started_s, evidence.table.dose))
    n = min(FOLDS, max(evidence.n_blocks // 3, 1))
    return tuple(np.sort(order[k::n]) for k in range(n)) if n > 1 else ()


def exposures_of(evidence: Evidence) -> Folds:
    """Return whole exposures, every fourth of them together."""
    return _alike(evidence.table.exposure_us, np.ones(evidence.n_blocks, bool))


def levels_of(evidence: Evidence) -> Folds:
    """Return whole levels, every fourth of them together; darks are in none."""
    return _alike(evidence.table.level, ~evidence.table.dark)


FOLDINGS: dict[str, Callable[[Evidence], Folds]] = {
    "blocks": blocks_of,
    "exposures": exposures_of,
    "levels": levels_of,
}


class HeldOutDeviances:
    """Answers for several models of one recording; what they share is worked out once."""

    def __init__(self, model: Model, evidence: Evidence, folding: str = "blocks") -> None:
        self._model = model
        full = evidence.without_blocks(np.zeros(0, np.intp))
        folds = FOLDINGS[folding](evidence)
        self._spaces = [full, *(evidence.without_blocks(fold) for fold in folds)]
        self._points = [_points(model, space) for space in self._spaces]

    @property
    def folds(self) -> int:
        """How many times something is left out; 0 where there is too little."""
        return len(self._spaces) - 1

    def of(self, members: Sequence[int]) -> HeldOut:
        """Return the deviance with only those members of the model, refitted linearly."""
        every, *trained = [
            _deviance(self._model, members, points, space)
            for points, space in zip(self._points, self._spaces, strict=True)
        ]
        if not trained:
            return HeldOut(every, self.dof)
        return HeldOut(float(sum(every - each for each in trained)), self.dof)

    def gain(self, k: int) -> float:
        """Return by how much member `k` lowers the deviance, the others there."""
        every = range(len(self._model.members))
        return self.of([j for j in every if j != k]).deviance - self.of(every).deviance

    @cached_property
    def dof(self) -> int:
        """How many numbers are predicted.

        Where all of them are left out once, pixels' own offsets and slopes take none of them away.
        """
        space = self._spaces[0]
        pooled = int(space.pooled.used.sum())
        means = int((space.space.weight > 0).sum())
        return pooled + (means if self.folds else space.space.degrees_of_freedom)


def _alike(values: NDArray[np.float64], among: NDArray[np.bool_]) -> Folds:
    found = np.unique(values[among])
    if len(found) < FEWEST_GROUPS:
        return ()
    n = min(FOLDS, len(found))
    return tuple(np.flatnonzero(among & np.isin(values, found[k::n])) for k in range(n))


def _points(model: Model, space: Evidence) -> tuple[Point, list[list[Point]], list[Point]]:
    """Return what the model leaves, its derivatives, and what each member contributes."""
    if model.change is None:
        return space.point(model.observed), [], []
    change: Change = model.change
    changes = [(*m.changes, *(each for each, _ in m.course)) for m in model.members]
    directions = [space.whitening.derivatives(of_one, change) for of_one in changes]
    whole = [contribution_change(m) for m in model.members]
    shares = space.whitening.derivatives(whole, change)
    # Counts are whitened along a curve: a difference of counts is not that of their points.
    return space.point(model.observed) - space.point(change), directions, shares


def _deviance(
    model: Model,
    members: Sequence[int],
    points: tuple[Point, list[list[Point]], list[Point]],
    space: Evidence,
) -> float:
    """Return the least squared misfit, and what the fitted parameters' spread adds."""
    target, directions, shares = points
    for k in range(len(model.members)):
        if k not in members:
            target = target + shares[k]
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
