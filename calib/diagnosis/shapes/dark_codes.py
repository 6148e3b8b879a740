"""How often a tap's darks give each code, and how often they would about their pixels' own means.

A stop of the codes bends the lower edge of what noise does to a dark. Moments tell little of it:
offset, read noise and what else is smooth absorb them. So the noise is given a variance, a skewness
and a kurtosis of its own here, by the Gram-Charlier series (Kendall and Stuart, The Advanced Theory
of Statistics 1, chapter 6), and what remains is the edge itself.
"""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray
from scipy.special import ndtr

from calib.arrays import Lines

Floats = NDArray[np.float64]
Map = Callable[[Lines], Lines]
"""Codes in, codes out."""

FINE = 4.0
"""Nodes lie this part of a standard deviation apart: what lies between widens the noise by 1 %."""
NUISANCES = np.array([0.3, 0.05, 0.05])
"""By which the logarithm of a variance, skewness and kurtosis may be off: darks have few electrons
of their own, and 10 beside a read noise of 5 electrons have a skewness of 0.05."""
STEPS = 3
"""Of Gauss and Newton."""
GRAIN = 0.05
"""Of the logarithm of a variance: between its multiples chances are taken for straight."""
STRAY = 1e-5
"""Share of the samples that anything else may have put anywhere."""
FEW = 10.0
"""Codes of which fewer are expected are not judged one by one."""


@dataclass(frozen=True)
class DarkCodes:
    """Of the darks of one tap.

    Attributes:
        seen: Samples by code, (n_codes,), of the codes from `first` on.
        first: The first code; lower ones count as this, and those beyond the last as that.
        means: Own means of pixels, those that are alike together, DN, (n,).
        weight: Samples of each, (n,).
        std: Standard deviation of the samples about them before rounding, DN.
        start: Of the nuisances.
    """

    seen: Floats
    first: int
    means: Floats
    weight: Floats
    std: float

    def deviance(self, changed: Map | None) -> tuple[float, Floats]:
        """Return minus twice the log-likelihood, and the samples expected, (n_codes,)."""
        at, found = np.zeros(3), np.zeros_like(self.seen)
        for _ in range(STEPS):
            found = self.expected(changed, at)
            slopes = np.stack([
                (self.expected(changed, at + 0.1 * each) - found) / 0.1
                for each in np.diag(NUISANCES)
            ]) / NUISANCES[:, None]  # fmt: skip
            information = (slopes / found) @ slopes.T + np.diag(NUISANCES**-2.0)
            along = slopes @ ((self.seen - found) / found) - at / NUISANCES**2
            step = np.linalg.solve(information, along)
            at = at + step / max(1.0, float(np.abs(step / NUISANCES).max()))
        found = self.expected(changed, at)
        fit = 2.0 * float((self.seen * np.log(np.maximum(self.seen, 1.0) / found)).sum())
        return fit + float(((at / NUISANCES) ** 2).sum()), found

    def expected(self, changed: Map | None, at: Floats) -> Floats:
        """Return the samples expected by code, (n_codes,), with nuisances, (3,)."""
        codes = self._codes
        stored = codes if changed is None else np.clip(changed(codes), codes[0], codes[-1])
        weight = self._share
        if changed is not None:
            weight = self._weights(self._chances(at, lambda chance: chance @ stored))
        counts = self._chances(at, lambda chance: weight @ chance)
        if changed is not None:
            to = (stored - codes[0]).astype(np.intp)
            counts = np.bincount(to, counts, len(codes)).astype(np.float64)
        # The series may leave a code far out less than nothing.
        counts = np.maximum(counts, 0.0) * self.seen.sum()
        return np.asarray((1.0 - STRAY) * counts + STRAY * self.seen.sum() / len(codes))

    @cached_property
    def _codes(self) -> Floats:
        return np.asarray(self.first + np.arange(len(self.seen)), np.float64)

    def _chances(self, at: Floats, product: Map) -> Floats:
        """Return a product of the chance of each code at each node, (n_nodes, n_codes).

        Chances are a sum of terms, and straight in a grain: products of each take one look at it.
        """
        step, share = divmod(float(at[0]), GRAIN)
        low, high = (product(self._series(int(step) + k)) for k in (0, 1))
        share /= GRAIN
        return np.asarray(np.array([1.0, *at[1:]]) @ ((1.0 - share) * low + share * high))

    def _series(self, step: int) -> Floats:
        """Return the terms of the series, (3, n_nodes, n_codes), of so many grains of variance."""
        if step not in self._known:
            std = self.std * float(np.exp(0.5 * GRAIN * step))
            self._known[step] = _terms((self._codes[:-1] + 0.5 - self._nodes[:, None]) / std)
        return self._known[step]

    @cached_property
    def _known(self) -> dict[int, Floats]:
        return {}

    @cached_property
    def _nodes(self) -> Floats:
        low, high = self.means.min() - 2.0 * self.std, self.means.max()
        return np.linspace(low, high, 2 + int((high - low) * FINE / self.std))

    @cached_property
    def _share(self) -> Floats:
        return self._weights(self._nodes)

    def _weights(self, means: Floats) -> Floats:
        """Return the share of the samples at each node, whose pixels' means are given."""
        place = np.interp(self.means, means, np.arange(len(means), dtype=np.float64))
        k = np.minimum(place.astype(np.intp), len(means) - 2)
        above = self.weight * (place - k)
        found = np.bincount(k, self.weight - above, len(means))
        found = found + np.bincount(k + 1, above, len(means))
        return np.asarray(found / self.weight.sum())


def misfit_per_code(codes: DarkCodes, expected: Floats) -> float:
    """Return the mean square of what codes are off by, in standard deviations, 1 or more.

    Where codes are wide and narrow, or bits stick, likelihoods are to be taken by so much less.
    """
    enough = expected > FEW
    off = (codes.seen - expected)[enough] ** 2 / expected[enough]
    return max(float(off.sum()) / max(int(enough.sum()) - len(NUISANCES), 1), 1.0)


def _terms(z: Floats) -> Floats:
    """Return what normal noise, skewness and kurtosis make of each code, (3, n_nodes, n_codes).

    Args:
        z: Upper edge of each code but the last about each node, over the noise's std.
    """
    density = np.exp(-0.5 * z**2) / np.sqrt(2.0 * np.pi)
    upto = np.stack([ndtr(z), -density * (z**2 - 1.0) / 6.0, -density * (z**3 - 3.0 * z) / 24.0])
    ends = np.zeros((*upto.shape[:2], 1))
    found = np.diff(upto, axis=2, prepend=ends)
    last = np.array([1.0, 0.0, 0.0])[:, None] - upto[:, :, -1]
    return np.concatenate([found, last[:, :, None]], axis=2)
