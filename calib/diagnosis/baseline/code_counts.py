"""The histogram of all codes against what Gaussian noise about the fitted means would give."""

from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from calib.diagnosis.baseline.baseline import Baseline
from calib.diagnosis.baseline.code_contrasts import CodeContrasts
from calib.diagnosis.baseline.code_likelihood import CodeLikelihood
from calib.diagnosis.baseline.expected_codes import about_means, fine_blocks, own_means_hidden
from calib.diagnosis.statistics.block_sums import BlockSums

Floats = NDArray[np.float64]

TAIL_CHANCE = 30.0
"""Variance of the counts at and below the lowest code, where Gaussian tails are not exact."""
CLASSES = 16
"""Codes are also counted by their remainder after this: what repeats within it is a comb."""
BIT_ERROR = 0.0015
"""Of the share in which a high bit is set: where its edges lie hangs on means, and on skewness."""
UNEVEN_ERROR = 0.05
"""Likewise of a class's share, of what it differs by from that of all."""
NEAR_END = 3
"""So many codes from the lowest on are not compared with others: codes may stop there."""
EVEN = 0.2
"""A class whose expected share is off by more than this share hangs on the means."""


@dataclass(frozen=True)
class CodeCounts:
    """Observed and expected samples by code.

    Attributes:
        observed: Of all blocks that count, (n_codes,).
        expected: Likewise.
        of_blocks: Expected of each of these blocks.
        noise: Standard deviation of its samples before rounding, DN, likewise.
    """

    observed: Floats
    expected: Floats
    of_blocks: dict[int, Floats] = field(default_factory=dict)
    noise: dict[int, float] = field(default_factory=dict)

    @classmethod
    def of(cls, sums: Sequence[BlockSums], baseline: Baseline) -> "CodeCounts":
        """Return both histograms of a recording."""
        fine = fine_blocks(baseline)
        histograms = [f * each.histogram for f, each in zip(fine, sums, strict=True)]
        observed = np.sum(histograms, axis=0).astype(np.float64)
        if not fine.any():
            observed[0] = 1.0
        hidden, n_codes = own_means_hidden(baseline), len(observed)
        of_blocks = {
            b: about_means(
                baseline.mean_dn[b] if hidden[b] else sums[b].mean_dn,
                baseline.variance_dn2[b],
                sums[b].n_lines,
                n_codes,
            )
            for b in np.flatnonzero(fine).tolist()
        }
        before = np.maximum(baseline.variance_dn2.mean(axis=(1, 2)) - 1.0 / 12.0, 0.01)
        noise = {b: float(np.sqrt(before[b])) for b in of_blocks}
        return cls(observed, sum(of_blocks.values(), np.zeros(n_codes)), of_blocks, noise)

    @cached_property
    def likelihood(self) -> CodeLikelihood:
        """How likely counts of single codes are."""
        return CodeLikelihood(self.of_blocks, self.noise)

    @cached_property
    def samples(self) -> float:
        """All samples."""
        return float(self.observed.sum())

    @property
    def n_numbers(self) -> int:
        """How many numbers `whitened` gives."""
        return CLASSES + self._bits + 3

    def residual(self) -> Floats:
        """Return observed less expected shares, (1, n_codes)."""
        return ((self.observed - self.expected) / self.samples)[None]

    def whitened(self, shares: Floats) -> Floats:
        """Return comb, high bits, roughness, and what is at the lowest code and below, over std.

        Args:
            shares: Change of the share of samples by code, (1, n_codes) of a recording, (2,
                n_codes) of two simulated draws: what both of them show is no chance.
        """
        if len(shares) > 1 and not shares.any():
            return np.zeros(self.n_numbers)
        mean = shares.mean(axis=0)
        low = self._lowest
        ends = np.array([mean[:low].sum(), mean[low]]) * self.samples
        expected = np.array([self.expected[:low].sum(), self.expected[low]])
        tails = ends / np.sqrt(TAIL_CHANCE + expected)
        comb = self._by_class(mean) / self._class_std
        return np.concatenate(
            [comb, self.high_bits(mean), [self.contrasts.roughness(shares)], tails]
        )

    def comb(self, period: int) -> Floats:
        """Return observed over expected samples by the code's remainder, (period,), of mean 1."""
        whole = len(self.observed) // period * period
        above = np.arange(whole) >= self._lowest + NEAR_END
        counts = (above * x[:whole] for x in (self.observed, self.expected))
        seen, due = (x.reshape(-1, period).sum(axis=0) for x in counts)
        if not due.all() or not seen.any():
            return np.ones(period)
        ratio = seen / np.maximum(due, 1.0)
        return np.asarray(ratio / ratio.mean())

    def high_bits(self, share: Floats) -> Floats:
        """Return by how many standard deviations bits beyond the comb are set too often."""
        # Of 2^bit codes each, every other stretch has the bit set.
        stretches = [share.reshape(-1, 2, 1 << bit) for bit in range(4, 4 + self._bits)]
        off = np.array([float(each[:, 1].sum()) for each in stretches])
        return np.asarray(off / np.hypot(0.5 / np.sqrt(self.samples), BIT_ERROR))

    @property
    def _bits(self) -> int:
        return int(np.log2(len(self.observed))) - 4

    def _by_class(self, share: Floats) -> Floats:
        above = np.where(np.arange(len(share)) < self._lowest + NEAR_END, 0.0, share)
        return np.asarray(above.reshape(-1, CLASSES).sum(axis=0))

    @cached_property
    def _class_std(self) -> Floats:
        """Standard deviations of the classes' shares; one that hangs on means has none.

        Where single codes are found to be wide or narrow, classes scatter by that, too.
        """
        share = self._by_class(self.expected) / self.samples
        scattered = (
            self._by_class(self.expected**2) / self.samples**2 * self.contrasts.width_variance
        )
        hangs = (UNEVEN_ERROR * (share - 1.0 / CLASSES)) ** 2
        std = np.sqrt(np.maximum(share, 1e-12) / self.samples + scattered + hangs)
        return np.where(np.abs(share * CLASSES - 1.0) < EVEN, std, np.inf)

    @cached_property
    def contrasts(self) -> CodeContrasts:
        """Codes against their neighbours."""
        return CodeContrasts(self.observed, self.expected, self._lowest + NEAR_END)

    @cached_property
    def _lowest(self) -> int:
        """The lowest code that was seen."""
        return int(np.flatnonzero(self.observed)[0])
