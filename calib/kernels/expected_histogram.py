"""How often each code is expected of pixels with Gaussian noise, rounded and clipped."""

from math import erfc, sqrt

import numpy as np
from numba import njit
from numpy.typing import NDArray

Floats = NDArray[np.float64]

_REACH = 7.0


def expected_histogram(mean: Floats, std: Floats, samples: float, n_codes: int) -> Floats:
    """Return the expected number of samples by code, (n_codes,).

    Args:
        mean: Of each pixel before rounding, DN, (n_pixels,).
        std: Its standard deviation, likewise.
        samples: How many each pixel gives.
        n_codes: Codes run 0 .. n_codes - 1.
    """
    counts = np.zeros(n_codes)
    _add(mean, std, samples, counts)
    return counts


@njit(cache=True, nogil=True)
def _add(mean, std, samples, counts):  # type: ignore[no-untyped-def]  # compiled
    last = counts.shape[0] - 1
    for i in range(mean.shape[0]):
        s = std[i] * sqrt(2.0)
        low = min(max(int(mean[i] - _REACH * std[i]) - 1, 0), last)
        high = min(max(int(mean[i] + _REACH * std[i]) + 2, 0), last)
        below = 0.0
        for code in range(low, high):
            upto = 0.5 * erfc((mean[i] - code - 0.5) / s)
            counts[code] += samples * (upto - below)
            below = upto
        counts[high] += samples * (1.0 - below)
