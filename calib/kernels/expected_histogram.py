"""How often each code is expected of pixels with Gaussian noise, rounded and clipped."""

from functools import lru_cache
from math import erfc, exp, pi, sqrt

import numpy as np
from numba import njit
from numpy.typing import NDArray

Floats = NDArray[np.float64]

_REACH = 7.0
_WIDE = 2.0
"""From so many DN of noise on densities stand for the codes' shares, to 1e-9 of all samples."""
_FINE = 6.0
"""Parts of a standard deviation at which sums of densities are told, where these are codes apart.

Between them run polynomials through eight neighbours: of a normal density they err by 105 x 0.0011
/ 6^8, 7e-8 of its height, 2e-9 of all samples of noise of 12 DN."""
_SIDE = 4
"""Neighbours of a code on either side that its polynomial runs through."""


def expected_histogram(mean: Floats, std: Floats, samples: float, n_codes: int) -> Floats:
    """Return the expected number of samples by code, (n_codes,).

    Args:
        mean: Of each pixel before rounding, DN, (n_pixels,).
        std: Its standard deviation, likewise.
        samples: How many each pixel gives.
        n_codes: Codes run 0 .. n_codes - 1.
    """
    counts = np.zeros(n_codes)
    step = int(float(std.min()) / _FINE) if len(std) else 1
    if step > 1:
        nodes = np.zeros((n_codes - 1) // step + 2 + 2 * _SIDE)
        _add_at_nodes(mean, std, samples, step, counts, nodes)
        _interpolate(nodes, _weights(step), counts)
    else:
        _add(mean, std, samples, counts)
    return counts


def code_chances(mean: Floats, std: Floats, n_codes: int) -> Floats:
    """Return the chance of each code in each pixel, (n_pixels, n_codes), as above."""
    chances = np.zeros((len(mean), n_codes))
    _add_each(mean, std, chances)
    return chances


@lru_cache(maxsize=64)
def _weights(step: int) -> Floats:
    """Return Lagrange's weights of a code's neighbours among every `step`th, (step, 2 _SIDE)."""
    places = np.arange(1.0 - _SIDE, 1.0 + _SIDE)
    off = np.arange(step)[:, None] / step - places
    found = np.ones((step, len(places)))
    for k, place in enumerate(places):
        others = np.arange(len(places)) != k
        found[:, k] = off[:, others].prod(axis=1) / (place - places[others]).prod()
    return found


@njit(cache=True, nogil=True)
def _add_each(mean, std, chances):  # type: ignore[no-untyped-def]  # compiled
    for i in range(mean.shape[0]):
        _add(mean[i : i + 1], std[i : i + 1], 1.0, chances[i])


@njit(cache=True, nogil=True)
def _add(mean, std, samples, counts):  # type: ignore[no-untyped-def]  # compiled
    last = counts.shape[0] - 1
    for i in range(mean.shape[0]):
        low = min(max(int(mean[i] - _REACH * std[i]) - 1, 0), last)
        high = min(max(int(mean[i] + _REACH * std[i]) + 2, 0), last)
        if std[i] < _WIDE:
            _add_exactly(mean[i], std[i], samples, low, high, counts)
        else:
            _add_ends(mean[i], std[i], samples, low, high, counts)
            first, end = max(low, 1), min(high, last - 1) + 1
            _add_densities(mean[i], std[i], samples, 1, first, end, counts)


@njit(cache=True, nogil=True)
def _add_at_nodes(mean, std, samples, step, counts, nodes):  # type: ignore[no-untyped-def]  # noqa: PLR0917 - compiled
    """Add to the ends of the counts, and to nodes what codes hold that lie `step` apart."""
    last = counts.shape[0] - 1
    for i in range(mean.shape[0]):
        low = min(max(int(mean[i] - _REACH * std[i]) - 1, 0), last)
        high = min(max(int(mean[i] + _REACH * std[i]) + 2, 0), last)
        _add_ends(mean[i], std[i], samples, low, high, counts)
        about, reach = mean[i] / step + _SIDE, _REACH * std[i] / step + 1.0
        first = min(max(int(about - reach), 0), nodes.shape[0])
        end = min(max(int(about + reach) + 1, 0), nodes.shape[0])
        _add_densities(about * step, std[i], samples, step, first, end, nodes)


@njit(cache=True, nogil=True)
def _interpolate(nodes, weights, counts):  # type: ignore[no-untyped-def]  # compiled
    step, n = weights.shape
    for first in range(1, nodes.shape[0] - n + 1):
        if nodes[first] + nodes[first + n - 1] + nodes[first + n // 2] == 0.0:
            continue
        start = (first - 1) * step
        for code in range(max(start, 1), min(start + step, counts.shape[0] - 1)):
            found = 0.0
            for k in range(n):
                found += weights[code - start, k] * nodes[first + k]
            counts[code] = max(found, 0.0)


@njit(cache=True, nogil=True)
def _add_exactly(mean, std, samples, low, high, counts):  # type: ignore[no-untyped-def]  # noqa: PLR0917 - compiled
    below = 0.0
    for code in range(low, high):
        upto = 0.5 * erfc((mean - code - 0.5) / (std * sqrt(2.0)))
        counts[code] += samples * (upto - below)
        below = upto
    counts[high] += samples * (1.0 - below)


@njit(cache=True, nogil=True)
def _add_ends(mean, std, samples, low, high, counts):  # type: ignore[no-untyped-def]  # noqa: PLR0917 - compiled
    last = counts.shape[0] - 1
    if low == 0:
        counts[0] += samples * 0.5 * erfc((mean - 0.5) / (std * sqrt(2.0)))
    if high == last:
        counts[last] += samples * 0.5 * erfc((last - 0.5 - mean) / (std * sqrt(2.0)))


@njit(cache=True, nogil=True)
def _add_densities(mean, std, samples, step, first, end, found):  # type: ignore[no-untyped-def]  # noqa: PLR0917 - compiled
    """Add what codes hold that lie `step` apart; each density follows from its neighbour's.

    Of the density f at u standard deviations a code one wide holds f (1 + H2 / (24 s^2) + H4 /
    (1920 s^4) + H6 / (322560 s^6)), the Taylor series of the integral: H are Hermite's polynomials
    of u. Here they are sorted by powers of u^2.
    """
    square = 1.0 / std**2
    c3 = square**3 / 322560.0
    c2 = square**2 / 1920.0 - 15.0 * c3
    c1 = square / 24.0 - square**2 / 320.0 + 45.0 * c3
    c0 = 1.0 - square / 24.0 + square**2 / 640.0 - 15.0 * c3
    start = min(max(int(mean / step + 0.5), first), end)
    for way in (1, -1):
        k = start if way == 1 else start - 1
        off = k * step - mean
        density = samples / (std * sqrt(2.0 * pi)) * exp(-0.5 * off * off * square)
        ratio = exp(-(way * off + 0.5 * step) * step * square)
        change = exp(-step * step * square)
        while first <= k < end:
            u2 = (k * step - mean) ** 2 * square
            found[k] += density * (c0 + u2 * (c1 + u2 * (c2 + u2 * c3)))
            density *= ratio
            ratio *= change
            k += way
