"""Exact sums of codes, squares and cubes pixel by pixel, and the moments that follow from them."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Sums = NDArray[np.uint64]
"""Sums modulo 2⁶⁴, (n_pixels,)."""

Pixels = NDArray[np.float64]
"""One number per pixel, (n_pixels,)."""


def most_frames(full_scale_dn: int) -> int:
    """Return of how many frames the third central moment is exact, whatever the codes.

    Σ|x − c|³ has to stay below 2⁶³.

    >>> most_frames(65535), most_frames(16383)
    (32769, 2097536)
    """
    return int(((1 << 63) - 1) // full_scale_dn**3)


@dataclass(frozen=True)
class PixelSums:
    """Exact sums over `n_frames` frames, each (n_pixels,).

    The sums themselves may exceed 64 bits: they are kept modulo 2⁶⁴, which loses nothing as long
    as the central ones, about a whole number next to the mean, fit (`most_frames`).
    """

    n_frames: int
    codes: Sums
    squares: Sums
    cubes: Sums
    at_zero: NDArray[np.uint32]
    at_full_scale: NDArray[np.uint32]

    @classmethod
    def zero(cls, n_pixels: int) -> "PixelSums":
        """Return the sums over no frames."""
        codes, squares, cubes = (np.zeros(n_pixels, np.uint64) for _ in range(3))
        at_zero, at_full_scale = (np.zeros(n_pixels, np.uint32) for _ in range(2))
        return cls(0, codes, squares, cubes, at_zero, at_full_scale)

    def __add__(self, other: "PixelSums") -> "PixelSums":
        """Return the sums over the frames of both."""
        return PixelSums(
            self.n_frames + other.n_frames,
            self.codes + other.codes,
            self.squares + other.squares,
            self.cubes + other.cubes,
            self.at_zero + other.at_zero,
            self.at_full_scale + other.at_full_scale,
        )


@dataclass(frozen=True)
class Moments:
    """Unbiased moments (k-statistics), each (n_pixels,).

    Attributes:
        mean_dn: Mean code.
        variance_dn2: k₂, NaN below two frames.
        third_dn3: k₃, the third central moment, NaN below three frames.
    """

    mean_dn: Pixels
    variance_dn2: Pixels
    third_dn3: Pixels
