"""How often each code is expected of pixels with Gaussian noise, rounded and clipped."""

from math import erfc, exp, pi, sqrt

import numpy as np
from numba import njit
from numpy.typing import NDArray

Floats = NDArray[np.float64]

_REACH = 7.0
_WIDE = 2.0
"""From so many DN of noise on densities stand for the codes' shares, to 1e-9 of all samples."""


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
        low = min(max(int(mean[i] - _REACH * std[i]) - 1, 0), last)
        high = min(max(int(mean[i] + _REACH * std[i]) + 2, 0), last)
        if std[i] < _WIDE:
            _add_exactly(mean[i], std[i], samples, low, high, counts)
        else:
            _add_densities(mean[i], std[i], samples, low, high, counts)


@njit(cache=True, nogil=True)
def _add_exactly(mean, std, samples, low, high, counts):  # type: ignore[no-untyped-def]  # noqa: PLR0917 - compiled
    below = 0.0
    for code in range(low, high):
        upto = 0.5 * erfc((mean - code - 0.5) / (std * sqrt(2.0)))
        counts[code] += samples * (upto - below)
        below = upto
    counts[high] += samples * (1.0 - below)


@njit(cache=True, nogil=True)
def _add_densities(mean, std, samples, low, high, counts):  # type: ignore[no-untyped-def]  # noqa: PLR0917 - compiled
    """Add the chances from the density in each code's middle, which follows from its neighbour's.

    Of the density f at u standard deviations a code one wide holds f (1 + H2 / (24 s^2) + H4 /
    (1920 s^4) + H6 / (322560 s^6)), the Taylor series of the integral: H are Hermite's polynomials
    of u.
    """
    last = counts.shape[0] - 1
    if low == 0:
        counts[0] += samples * 0.5 * erfc((mean - 0.5) / (std * sqrt(2.0)))
    if high == last:
        counts[last] += samples * 0.5 * erfc((last - 0.5 - mean) / (std * sqrt(2.0)))
    first, end = max(low, 1), min(high, last - 1) + 1
    start = min(max(int(mean + 0.5), first), end)
    square = 1.0 / std**2
    for way in (1, -1):
        code = start if way == 1 else start - 1
        off = code - mean
        density = samples / (std * sqrt(2.0 * pi)) * exp(-0.5 * off * off * square)
        ratio, change = exp(-(way * off + 0.5) * square), exp(-square)
        while first <= code < end:
            u2 = (code - mean) ** 2 * square
            bent = (u2 * (u2 * (u2 - 15.0) + 45.0) - 15.0) * square / 322560.0
            bent = (bent + (u2 * (u2 - 6.0) + 3.0) / 1920.0) * square
            bent = (bent + (u2 - 1.0) / 24.0) * square
            counts[code] += density * (1.0 + bent)
            density *= ratio
            ratio *= change
            code += way
