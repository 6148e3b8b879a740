"""Sums over those of each pixel's samples that lie near a middle."""

import numpy as np
from numba import njit
from numpy.typing import NDArray

Floats = NDArray[np.float64]


def near_sums(samples: NDArray[np.generic], middle: Floats, limit: Floats) -> Floats:
    """Return how many samples lie within the limit, their sum and that of their squares.

    Args:
        samples: Codes, (n_lines, n_pixels).
        middle: From which samples are counted, DN, (n_pixels,).
        limit: How far a sample may be from it, likewise.

    Returns:
        (3, n_pixels): samples, their deviations from the middle, DN, and the squares, DN^2.
    """
    sums = np.zeros((3, samples.shape[1]))
    _add(samples, middle, limit, sums)
    return sums


@njit(cache=True, nogil=True)
def _add(samples, middle, limit, sums):  # type: ignore[no-untyped-def]  # compiled
    for t in range(samples.shape[0]):
        for c in range(samples.shape[1]):
            off = float(samples[t, c]) - middle[c]
            near = 1.0 if abs(off) <= limit[c] else 0.0
            sums[0, c] += near
            sums[1, c] += near * off
            sums[2, c] += near * off * off
