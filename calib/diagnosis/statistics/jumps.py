"""By how much pixels scatter of which some samples jump: what is left out must not follow these.

A bit that sticks in one sample of ten triples what its pixel seems to scatter by, and no jump
stands out of that. Where jumps are about as large as what is left out, a pixel with more of them
than others has a wider cut, and keeps more of them: its variance scatters by far more than single
jumps make it. What lies within three standard deviations knows nothing of those beyond.
"""

import numpy as np
from numpy.typing import NDArray
from scipy.stats import norm

from calib.diagnosis.recorded.sensor import Sensor
from calib.diagnosis.statistics.neighbourhoods import about_each, middles
from calib.diagnosis.statistics.noisy import MEDIAN_OF_NORMAL
from calib.kernels.near_sums import near_sums

Floats = NDArray[np.float64]

FEW_LINES = 16
"""Of so few, or fewer, no pixel's own variance tells its noise."""
MEDIAN_LINES = 64
"""Of so many lines a pixel's median is told, and how its samples scatter without jumps."""
NEAR_SIGMA = 3.0
"""So near samples lie that tell the noise beside jumps."""
FIRST_SIGMA = (2.0, 2.0)
"""Likewise as long as the noise is hardly known: whole codes, and jumps in three samples of ten,
make the median of deviations twice as large."""
WIDE = 1.1
"""Where samples jump, their variance is larger by this factor than those near the middle tell, or
more. With less, the cut follows the jumps by so little that variances scatter by 10 % more."""
SMALLEST = 1.0
"""In standard deviations: of what fills all of its limit, no more can be told."""


def without_jumps(
    samples: NDArray[np.generic], variance: Floats, local: Floats, sensor: Sensor
) -> tuple[Floats, Floats, NDArray[np.bool_]]:
    """Return pixels' variances, and their neighbourhoods', without samples that jump far away.

    The median of deviations from the median (Hampel, J. Am. Stat. Assoc. 69, 383 (1974)) knows
    nothing of fewer than half of the samples; half a code is added, by which whole codes hide it.
    From there the variance of what lies near the median is told, as that of a truncated normal
    distribution. It takes the variance's place where that is wider.

    Args:
        samples: Codes, (n_lines, n_rows, n_columns).
        variance: Of each pixel, DN^2, (n_rows, n_columns).
        local: Of those about each, likewise.
        sensor: The sensor.

    Returns:
        Both variances, and where they are not those of all samples.
    """
    if len(samples) <= FEW_LINES:
        return variance, local, np.zeros(variance.shape, bool)
    few = samples[:: -(-len(samples) // MEDIAN_LINES)].astype(np.float64)
    middle = np.median(few, axis=0)
    off = np.median(np.abs(few - middle), axis=0)
    about = middles(((off + 0.5) / MEDIAN_OF_NORMAL) ** 2, sensor)
    for first in FIRST_SIGMA:
        about = about_each(_near(few, middle, first * np.sqrt(about)), len(few), sensor)
    settled = _near(samples, middle, NEAR_SIGMA * np.sqrt(about))
    about = about_each(settled, len(samples), sensor)
    jumps = local > WIDE * about
    return np.where(jumps, settled, variance), np.where(jumps, about, local), jumps


def _near(samples: NDArray[np.generic], middle: Floats, limit: Floats) -> Floats:
    """Return each pixel's variance, told by what is within a limit, (n_rows, n_columns)."""
    # Codes are whole: half a code beyond the limit belongs to those within.
    limit = limit + 0.5
    flat = np.ascontiguousarray(samples.reshape(len(samples), -1))
    n, total, squares = near_sums(flat, middle.ravel(), limit.ravel())
    n = np.maximum(n, 2.0)
    share = (squares - total**2 / n) / (n - 1.0) / limit.ravel() ** 2
    # Of a normal variable within c standard deviations, the variance is this share of c^2.
    c = np.linspace(SMALLEST, 12.0, 400)
    kept = (1.0 - 2.0 * c * norm.pdf(c) / (1.0 - 2.0 * norm.sf(c))) / c**2
    found = (limit.ravel() / np.interp(share, kept[::-1], c[::-1])) ** 2
    return np.asarray(found.reshape(middle.shape))
