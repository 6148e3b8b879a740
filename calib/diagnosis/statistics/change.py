"""A change of all statistics of a recording."""

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]


def unread() -> Floats:
    """Return no change of a monitor's readings, to which those of any blocks can be added."""
    return np.zeros(())


@dataclass(frozen=True)
class Change:
    """A change of the statistics, or the statistics themselves.

    Attributes:
        means: Of each block's pixels, DN, (n_blocks, n_pixels).
        onset: Of the first lines' means against the block's later ones, DN, (n_blocks, 3).
        pooled: Of each block's pooled statistics, (n_blocks, n_pooled).
        rare: Of what is counted, by trial, (n_blocks, n_rare).
        pixel_variance: Of each pixel's variance over the expected one, all blocks, (n_pixels,).
        pixel_misfit: By how many standard deviations each pixel's means miss, (n_pixels,).
        tones: Of squared amplitudes at the peaks of the spectrum, DN^2, (n_blocks, n_tones).
        monitor: Of the logarithm of what the monitor reads in each block, (n_blocks,).
        codes: Of the share of samples by code, (1 or 2 draws, n_codes); where only effects before
            the conversion change anything, means and variances say it all, and this is 0, (2, 1).
    """

    means: Floats
    onset: Floats
    pooled: Floats
    rare: Floats
    pixel_variance: Floats
    codes: Floats
    tones: Floats
    pixel_misfit: Floats
    monitor: Floats = field(default_factory=unread)

    def __sub__(self, other: "Change") -> "Change":
        """Return the difference."""
        return Change(*(a - b for a, b in zip(self.parts(), other.parts(), strict=True)))

    def __add__(self, other: "Change") -> "Change":
        """Return the sum."""
        return Change(*(a + b for a, b in zip(self.parts(), other.parts(), strict=True)))

    def __mul__(self, factor: float) -> "Change":
        """Return it scaled."""
        return Change(*(a * factor for a in self.parts()))

    def parts(self) -> tuple[Floats, ...]:
        """Return its arrays."""
        return (
            self.means, self.onset, self.pooled, self.rare, self.pixel_variance, self.codes,
            self.tones, self.pixel_misfit, self.monitor,
        )  # fmt: skip

    @property
    def nbytes(self) -> int:
        """Size in memory."""
        return sum(part.nbytes for part in self.parts())
