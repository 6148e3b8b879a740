"""Which blocks' codes are compared with Gaussian noise about their means, and what that gives."""

import numpy as np
from numpy.typing import NDArray

from calib.diagnosis.baseline.baseline import Baseline
from calib.kernels.expected_histogram import expected_histogram

Floats = NDArray[np.float64]

SMOOTH_DN2 = 0.25
"""Below this variance, 0.41 DN of noise, a pixel's mean is off by 0.012 DN or more with its phase
in a code, and most of its samples share one: their histogram is no Gaussian about the mean."""
MOSTLY = 0.9
"""A lit block of which fewer pixels are usable saturates."""
MOST_PIXELS = 4096
"""Of each block; more give the same smooth expectation."""


def about_means(mean: Floats, variance: Floats, n_lines: float, n_codes: int) -> Floats:
    """Return the samples by code of a block of Gaussian noise about its pixels' means, (n_codes,).

    Args:
        mean: Of each pixel, DN, (n_rows, n_columns).
        variance: Of its samples with rounding, DN^2, likewise.
        n_lines: Lines of the block.
        n_codes: Codes run 0 .. n_codes - 1.
    """
    # An odd step meets all taps.
    step = mean.size // MOST_PIXELS // 2 * 2 + 1
    some = mean.ravel()[::step]
    # Rounding is in the variance that was fitted, and done once more here. Samples scatter less
    # about their own mean than about the true one.
    before = np.maximum(variance.ravel()[::step] - 1.0 / 12.0, 0.01) * (1.0 - 1.0 / n_lines)
    return expected_histogram(some, np.sqrt(before), n_lines * mean.size / len(some), n_codes)


def own_means_hidden(baseline: Baseline) -> NDArray[np.bool_]:
    """Return the blocks, (n_blocks,), whose codes stop: their means are not those of the light.

    What other blocks say holds there.
    """
    return np.asarray(baseline.usable.mean(axis=(1, 2)) < MOSTLY)


def fine_blocks(baseline: Baseline) -> NDArray[np.bool_]:
    """Return the blocks, (n_blocks,), whose noise spreads samples over codes smoothly.

    Full wells and codes at full scale spread them otherwise.
    """
    smooth = baseline.variance_dn2.mean(axis=(1, 2)) > SMOOTH_DN2
    return np.asarray(smooth & ~saturated_blocks(baseline))


def stopped_blocks(baseline: Baseline) -> NDArray[np.bool_]:
    """Return the blocks, (n_blocks,), whose codes stop amid their noise, at the lower end."""
    return own_means_hidden(baseline) & fine_blocks(baseline)


def saturated_blocks(baseline: Baseline) -> NDArray[np.bool_]:
    """Return the lit blocks, (n_blocks,), of which pixels are not usable: they are full."""
    lit = baseline.dose.max(axis=(1, 2)) > 0
    return np.asarray(lit & (baseline.usable.mean(axis=(1, 2)) < MOSTLY))
