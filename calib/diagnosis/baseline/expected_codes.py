"""Which blocks' codes are compared with Gaussian noise about their means, and what that gives."""

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import CubicSpline

from calib.diagnosis.baseline.baseline import Baseline
from calib.kernels.expected_histogram import expected_histogram

Floats = NDArray[np.float64]

SMOOTH_DN2 = 0.25
"""Below this variance, 0.41 DN of noise, a pixel's mean is off by 0.012 DN or more with its phase
in a code, and most of its samples share one: their histogram is no Gaussian about the mean."""
MOSTLY = 0.9
"""A lit block of which fewer pixels are usable saturates."""
SPLINED = 1.5
"""In so many steps of noise or more, cubic splines run between steps."""
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
    some, std, samples = _of_some(mean, variance, n_lines)
    return expected_histogram(some, std, samples, n_codes)


def in_steps(mean: Floats, variance: Floats, n_lines: float, n_codes: int) -> tuple[int, Floats]:
    """Return the same of steps that noise is not small against, and how many make a code."""
    some, std, samples = _of_some(mean, variance, n_lines)
    fine = int(np.ceil(SPLINED / float(std.min())))
    # A code's first part begins where the code does.
    places = some * fine + 0.5 * (fine - 1)
    return fine, expected_histogram(places, std * fine, samples, n_codes * fine)


def between_edges(steps: Floats, fine: int, edges: Floats) -> Floats:
    """Return the samples of codes that lie between edges, DN, (n_codes + 1,).

    How many samples lie below is told at steps, and by cubic splines between these, which err by
    1/384 of the fourth derivative (de Boor, A Practical Guide to Splines, 2001): of 1.5 steps of
    noise, 1e-3 of the samples that its codes share.

    Args:
        steps: Samples by step, (n_codes fine,); of one block or the sum of several.
        fine: Steps of a code.
        edges: Ascending.
    """
    ends = np.arange(len(steps) + 1) / fine - 0.5
    below = np.concatenate([[0.0], np.cumsum(steps)])
    seen = np.flatnonzero(steps)
    # Outside of the samples and some steps there is nothing to run a spline through.
    low, high = max(int(seen[0]) - 8, 0), min(int(seen[-1]) + 10, len(ends))
    inside = CubicSpline(ends[low:high], below[low:high])
    return np.diff(inside(np.clip(edges, ends[low], ends[high - 1])))


def _of_some(mean: Floats, variance: Floats, n_lines: float) -> tuple[Floats, Floats, float]:
    """Return means and noise, DN, of pixels that stand for all, and the samples that each gives."""
    # An odd step meets all taps.
    step = mean.size // MOST_PIXELS // 2 * 2 + 1
    some = mean.ravel()[::step]
    # Rounding is in the variance that was fitted, and done once more here. Samples scatter less
    # about their own mean than about the true one.
    before = np.maximum(variance.ravel()[::step] - 1.0 / 12.0, 0.01) * (1.0 - 1.0 / n_lines)
    return some, np.sqrt(before), n_lines * mean.size / len(some)


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
