"""Claims of names to the samples that lie far out: what they explain beyond sums of counts."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from calib.diagnosis.evidence.evidence import Evidence
from calib.diagnosis.shapes.far_likelihood import most_likely
from calib.diagnosis.statistics.rare import RARE, SINGLE

Floats = NDArray[np.float64]
Cause = tuple[Floats, float]
"""Density ratios of the samples, and how many are far if all are of it."""

EVERY_NOISE = 3
"""Sums of each kind of single sample: blocks are told apart by their noise."""


@dataclass(frozen=True)
class Claim:
    """What a name, or two, claim.

    Attributes:
        causes: By which they explain samples.
        beside: Causes beside which they do.
        price: Deviance that the likeliest of so many as were tried has by chance.
        sums: Squares of the whitened counts in which they show, by kind.
    """

    causes: tuple[Cause, ...]
    beside: tuple[Cause, ...]
    price: float
    sums: Mapping[str, float]

    @cached_property
    def credit(self) -> float:
        """Deviance beyond the sums'; none where these have nothing to take a strength from."""
        of_sums = sum(self.sums.values())
        if of_sums <= 0.0:
            return 0.0
        return max(deviance_beside(self.causes, self.beside) - self.price - of_sums, 0.0)

    def and_(self, other: "Claim") -> "Claim":
        """Return what both claim together."""
        causes, price = (*self.causes, *other.causes), self.price + other.price
        return Claim(causes, self.beside, price, {**self.sums, **other.sums})


def counted(evidence: Evidence) -> dict[str, float]:
    """Return squares of whitened counts, by kind, those of blocks of different noise added."""
    squares = evidence.rare_space.whitened(evidence.rare_space.seen) ** 2
    single, rest = np.split(squares, [len(SINGLE) * EVERY_NOISE])
    by_kind = [*single.reshape(len(SINGLE), -1).sum(axis=1), *rest]
    return dict(zip(RARE, map(float, by_kind), strict=True))


def likeliest(causes: Sequence[Cause], beside: Sequence[Cause]) -> Cause:
    """Return the likeliest of `causes` beside others."""
    return max(causes, key=lambda cause: deviance_beside((cause,), beside))


def deviance_beside(causes: Sequence[Cause], beside: Sequence[Cause]) -> float:
    """Return the deviance that causes explain beside others."""
    return _deviance([*causes, *beside]) - _deviance(beside)


def _deviance(causes: Sequence[Cause]) -> float:
    if not causes:
        return 0.0
    ratios, expected = zip(*causes, strict=True)
    return most_likely(np.stack(ratios), np.array(expected))
