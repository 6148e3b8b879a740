"""Counts of rare events, summed where their rate is alike, on a scale on which they scatter by 1.

A count x of mean m scatters by sqrt(m); 2 (sqrt(x + c) - sqrt(c)) scatters by 1 about its value at
m whatever m is, if it is not small (Anscombe, Biometrika 35, 246 (1948), there with c = 3/8). Here
c is far less, since Gaussian noise reaches so far next to never. For the same reason the first
event says more than that it is one of few: without a cause there would be none. Up to `FIRST`
standard deviations are added, FIRST x / (x + 1), which leaves counts of several as they are.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from calib.diagnosis.statistics.rare import FLIPS, RARE, SINGLE, rare_trials

Floats = NDArray[np.float64]

CHANCE = 0.15
FIRST = 2.0
CLASSES = (2.0, 8.0)
"""Blocks are told apart by their noise: up to twice the least variance, up to 8 times, beyond."""


@dataclass(frozen=True)
class RareSpace:
    """Where the blocks' rates of rare events are whitened.

    Attributes:
        weights: What each block counts in each sum, (n_sums, n_blocks, n_rare).
        seen: How often each happened by trial, (n_blocks, n_rare).
    """

    weights: Floats
    seen: Floats

    @classmethod
    def of(
        cls,
        counts: Floats,
        n_lines: Floats,
        n_pixels: int,
        variance: Floats,
        stopped: NDArray[np.bool_],
    ) -> "RareSpace":
        """Return the space of a recording.

        Args:
            counts: As they happened, (n_blocks, n_rare).
            n_lines: Of each block.
            n_pixels: Of the sensor.
            variance: Mean variance of each block's samples, DN^2.
            stopped: Blocks, (n_blocks,), whose codes stop amid their noise. What stands out there
                does so of what is left of it, oftener by a factor for each tenth of the noise.
        """
        lines = n_lines + counts[:, RARE.index("identical_lines")]
        trials = np.stack([rare_trials(n, n_pixels) for n in lines])
        noise = np.searchsorted(CLASSES, variance / max(float(variance.min()), 1e-12))
        sums = []
        for k, name in enumerate(RARE):
            groups = range(len(CLASSES) + 1) if name in SINGLE else (None,)
            told = ~stopped | (name == "identical_lines")
            for group in groups:
                weight = np.zeros_like(trials)
                used = told if group is None else told & (noise == group)
                # A pixel is noisy in all blocks or in none.
                share = 1.0 / len(noise) if name == "noisy_pixels" else 1.0
                weight[used, k] = share * trials[used, k]
                sums.append(weight)
        return cls(np.stack(sums), counts / trials)

    def whitened(self, rates: Floats, kept: NDArray[np.bool_] | None = None) -> Floats:
        """Return rates beyond chance, (n_blocks, n_rare), as sums that scatter by 1, (n_sums,)."""
        counts = np.maximum(self._sums(rates, kept), 0.0)
        return whitened_counts(counts)

    def derivative(
        self, change: Floats, about: Floats, kept: NDArray[np.bool_] | None = None
    ) -> Floats:
        """Return the derivative of `whitened` where rates move by `change` from `about` on."""
        counts = np.maximum(self._sums(about, kept), 0.0)
        slope = 1.0 / np.sqrt(counts + CHANCE) + FIRST / (counts + 1.0) ** 2
        return np.asarray(self._sums(change, kept) * slope)

    @cached_property
    def n_sums(self) -> int:
        """How many sums there are."""
        return len(self.weights)

    @cached_property
    def n_seen(self) -> int:
        """How many of the sums hold an event: freedom that a remainder has, at the most."""
        return max(int((self._sums(self.seen, None) > 0).sum()), 1)

    @cached_property
    def rate(self) -> Floats:
        """How often samples stand out in blocks of like noise, by sample, (n_blocks,)."""
        rate = np.zeros(self.seen.shape[0])
        for weight in self.weights:
            used = weight[:, : len(SINGLE)]
            if used.any():
                happened = float((used * self.seen[:, : len(SINGLE)]).sum())
                rate += np.where(used.any(axis=1), happened / float(used.sum()), 0.0)
        return rate

    def by_block(self, rates: Floats) -> Floats:
        """Return roughly how many events more than none each block holds, (n_blocks,)."""
        return np.asarray(np.abs(np.einsum("kbr,br->b", self.weights, rates)))

    def flips(self, rates: Floats) -> Floats:
        """Return by how many standard deviations samples are one flipped bit off, by bit."""
        counts = np.einsum("kbr,br->r", self.weights, rates)[-2 * FLIPS :]
        return np.asarray(2.0 * np.sqrt(np.maximum(counts[:FLIPS] + counts[FLIPS:], 0.0)))

    def _sums(self, rates: Floats, kept: NDArray[np.bool_] | None) -> Floats:
        used = rates if kept is None else np.where(kept[:, None], rates, 0.0)
        return np.asarray(np.einsum("kbr,br->k", self.weights, used))


def whitened_counts(counts: Floats) -> Floats:
    """Return counts on the scale on which they scatter by 1."""
    root = 2.0 * (np.sqrt(counts + CHANCE) - np.sqrt(CHANCE))
    return np.asarray(root + FIRST * counts / (counts + 1.0))
