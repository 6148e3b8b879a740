"""What is to be known of a pixel beside its radiance: one bit each, in a byte.

Nothing is repaired or interpolated: a pixel keeps what was measured, or is NaN, and says why.
"""

from enum import IntFlag

import numpy as np
from numpy.typing import NDArray


class Flag(IntFlag):
    """Bits of a pixel's quality byte; 0 is a sample that the calibration covers.

    SATURATED: The code stands at full scale: the radiance is a lower bound, its std infinite.
    BELOW_BLACK: The code is below the column's dark level, so that the radiance is negative (kept,
        because means would be biased without it), or 0, where the radiance is an upper bound.
    MASKED: The set has no valid coefficients for this column; radiance and std are NaN.
    EXTRAPOLATED: The code (beyond three standard deviations of its noise), the exposure or the
        temperature lies outside what the calibration has seen.
    OUTSIDE_VALIDITY: The set's validity does not cover the time of the sample; forced.
    MISMATCHED: The set belongs to another camera, band, gain or bit depth; forced.
    """

    SATURATED = 1
    BELOW_BLACK = 2
    MASKED = 4
    EXTRAPOLATED = 8
    OUTSIDE_VALIDITY = 16
    MISMATCHED = 32


def count_flags(flags: NDArray[np.uint8]) -> dict[str, int]:
    """Return how many pixels carry each flag, by the flag's name in lower case; none left out."""
    histogram = np.bincount(flags.ravel(), minlength=256)
    codes = np.arange(len(histogram))
    return {
        str(flag.name).lower(): int(histogram[(codes & flag.value) != 0].sum()) for flag in Flag
    }
