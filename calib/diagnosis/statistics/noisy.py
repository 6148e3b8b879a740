"""Pixels that are left out of what is pooled: a few that would outweigh all others."""

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]

NOISY_SIGMA = 6.0
"""A pixel whose variance or whose means miss by so much is left out."""
MOST_NOISY = 0.05
"""More of them than this share are no exceptions, and are kept."""
MEDIAN_OF_NORMAL = 0.6745
"""Median of the absolute values of a standard normal variable."""


def few(pixels: NDArray[np.intp], of: int) -> NDArray[np.intp]:
    """Return `pixels` where they are a small share of all, else none."""
    return pixels if len(pixels) <= MOST_NOISY * of else pixels[:0]


def beyond(z: Floats, others: Floats) -> Floats:
    """Return by how many standard deviations numbers stand out of `others`, (n,) each.

    These have their median for a mean, and for a standard deviation 1, or more where their median
    absolute deviation says so: a few that are far off change neither.
    """
    middle = float(np.median(others))
    scatter = float(np.median(np.abs(others - middle))) / MEDIAN_OF_NORMAL
    return np.asarray((z - middle) / max(scatter, 1.0))
