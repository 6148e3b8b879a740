"""The histogram of all codes against what Gaussian noise about the fitted means would give."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from calib.diagnosis.baseline import Baseline
from calib.diagnosis.statistics.block_sums import BlockSums
from calib.kernels.expected_histogram import expected_histogram

Floats = NDArray[np.float64]

TAIL_CHANCE = 30.0
"""Variance of the counts at and below the lowest code, where Gaussian tails are not exact."""
MOST_CONTRAST = 30.0
"""In standard deviations: one code that is far off is not the roughness of all."""
SMOOTH_DN2 = 0.35
"""Below this variance most samples of a pixel share a code, and their histogram is no Gaussian."""
LOW_BITS = 6
HANGS = 0.02
"""A bit whose share is off from half by so much, or may be, hangs on the means."""
ENOUGH = 50.0
"""Codes with fewer samples expected than this are not judged one by one."""
MOST_PIXELS = 4096
"""Of each block; more give the same smooth expectation."""


@dataclass(frozen=True)
class CodeCounts:
    """Observed and expected samples by code, (n_codes,) each, and how many were simulated."""

    observed: Floats
    expected: Floats

    @classmethod
    def of(cls, sums: Sequence[BlockSums], baseline: Baseline) -> "CodeCounts":
        """Return both histograms of a recording."""
        fine = fine_blocks(baseline)
        histograms = [f * each.histogram for f, each in zip(fine, sums, strict=True)]
        observed = np.sum(histograms, axis=0).astype(np.float64)
        if not fine.any():
            observed[0] = 1.0
        expected = np.zeros(len(observed))
        for b in np.flatnonzero(fine).tolist():
            each = sums[b]
            mean = each.mean_dn.ravel()
            step = max(1, len(mean) // MOST_PIXELS)
            # Rounding is in the variance that was fitted, and done once more here.
            variance = np.maximum(baseline.variance_dn2[b].ravel() - 1.0 / 12.0, 0.01)
            share = len(mean) / len(mean[::step])
            expected += expected_histogram(
                mean[::step], np.sqrt(variance[::step]), each.n_lines * share, len(observed)
            )
        return cls(observed, expected)

    @property
    def samples(self) -> float:
        """All samples."""
        return float(self.observed.sum())

    def residual(self) -> Floats:
        """Return observed less expected shares, (1, n_codes)."""
        return ((self.observed - self.expected) / self.samples)[None]

    def whitened(self, shares: Floats) -> Floats:
        """Return low bits, roughness, and what is at the lowest code and below, over their std.

        Args:
            shares: Change of the share of samples by code, (1, n_codes) of a recording, (2,
                n_codes) of two simulated draws: what both of them show is no chance.
        """
        mean = shares.mean(axis=0)
        bits = np.array([float(mean[mask].sum()) for mask in self._masks])
        low = self._lowest
        ends = np.array([mean[:low].sum(), mean[low]]) * self.samples
        expected = np.array([self.expected[:low].sum(), self.expected[low]])
        tails = ends / np.sqrt(TAIL_CHANCE + expected)
        return np.concatenate([bits / self._bit_std, [self._roughness(shares)], tails])

    @cached_property
    def _masks(self) -> tuple[NDArray[np.bool_], ...]:
        codes = np.arange(len(self.observed))
        return tuple((codes >> bit & 1).astype(bool) for bit in range(LOW_BITS))

    @cached_property
    def _bit_std(self) -> Floats:
        """Standard deviations; a bit far above the noise hangs on means, and has none."""
        shares = np.array([float(self.expected[m].sum()) / self.samples for m in self._masks])
        smooth = (np.abs(shares - 0.5) < HANGS) & (self._swing < HANGS)
        return np.where(smooth, 0.5 / np.sqrt(self.samples), np.inf)

    @cached_property
    def _swing(self) -> Floats:
        """By how much each bit's share goes up and down as all means move, (6,).

        A share of half may stand where it follows the means most. That of the lowest bit has two
        phases alone, and is not told.
        """
        codes = np.arange(len(self.observed))
        periods = 2.0 ** np.arange(2, LOW_BITS + 1)
        waves = np.exp(2j * np.pi * codes / periods[:, None])
        swing = 2.0 / np.pi * np.abs(waves @ self.expected) / self.samples
        return np.concatenate([[0.0], swing])

    @cached_property
    def _judged(self) -> NDArray[np.bool_]:
        enough = self.expected > ENOUGH
        judged = enough & np.roll(enough, 1) & np.roll(enough, -1)
        judged[: self._lowest + 3] = False
        return judged

    @cached_property
    def _lowest(self) -> int:
        """The lowest code that was seen."""
        return int(np.flatnonzero(self.observed)[0])

    def _roughness(self, shares: Floats) -> float:
        """Return the sum of squared contrasts of neighbouring codes beyond chance, over its std."""
        judged = self._judged
        n_judged = int(judged.sum())
        if n_judged < 8:
            return 0.0
        scale = self.samples / np.maximum(self.expected, 1e-9)
        inverse = 1.0 / np.maximum(self.expected, 1.0)
        variance = (inverse + 0.25 * (np.roll(inverse, 1) + np.roll(inverse, -1)))[judged]
        most = MOST_CONTRAST * np.sqrt(variance)
        one, other = (
            np.clip(_contrast(each * scale)[judged], -most, most)
            for each in (shares[0], shares[-1])
        )
        chance = float(n_judged) if len(shares) == 1 else 0.0
        return float(((one * other / variance).sum() - chance) / np.sqrt(4.0 * n_judged))


def fine_blocks(baseline: Baseline) -> NDArray[np.bool_]:
    """Return the blocks, (n_blocks,), whose noise spreads samples over codes smoothly."""
    return np.asarray(baseline.variance_dn2.mean(axis=(1, 2)) > SMOOTH_DN2)


def _contrast(values: Floats) -> Floats:
    return np.asarray(values - 0.5 * (np.roll(values, 1) + np.roll(values, -1)))
