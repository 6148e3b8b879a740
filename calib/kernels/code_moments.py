"""Moments of pixels whose codes have known chances, without the samples that lie beyond a cut."""

from math import frexp, sqrt
from typing import NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray

Floats = NDArray[np.float64]

N_MOMENTS = 6
ROOT_HALF = sqrt(0.5)


class Limits(NamedTuple):
    """By which samples are told apart; in standard deviations where not said otherwise.

    Attributes:
        cut: Beyond so many and one DN samples are left out.
        hardly: Where a smaller share is beyond the cut about the mean, no median is asked for.
        near: By this part of it a cut may be off.
        near_share: Where a larger share of samples lies so near the cut, that counts.
        beside: So much is raised what may be a track's.
        far: So far is what is counted.
        flip: So near to a power of two DN is a bit that flipped,
        very_far: if it is so far.
    """

    cut: float
    hardly: float
    near: float
    near_share: float
    beside: float
    far: float
    flip: float
    very_far: float


def code_moments(
    codes: Floats, chance: Floats, sigma: Floats, limits: Limits, flips: int
) -> tuple[Floats, Floats]:
    """Return the moments of each node's codes, and the shares of what stands out.

    Args:
        codes: Whole, of each node, in any order, (n_nodes, n).
        chance: Of each code, likewise; those of a node sum up to 1.
        sigma: Of each node, by which its samples are told apart, DN, (n_nodes,).
        limits: By which.
        flips: Bits that may flip.

    Returns:
        (n_nodes, 6): the mean within the cut about the median, DN; of deviations from it the
        squares, DN^2, and fourth powers, DN^4, over all samples; the share beyond the cut; 1 where
        some lie near the cut; the share that is raised as one beside a track.
        (n_nodes, 2 + 2 flips): the share that is counted as above, below, a raised and a lowered
        bit.
    """
    moments = np.zeros((len(codes), N_MOMENTS))
    far = np.zeros((len(codes), 2 + 2 * flips))
    _fill(codes, chance, sigma, limits, moments, far)
    return moments, far


@njit(cache=True, nogil=True)
def _fill(codes, chance, sigma, limits, moments, far):  # type: ignore[no-untyped-def]  # noqa: PLR0917 - compiled
    for k in range(codes.shape[0]):
        cut = limits.cut * sigma[k] + 1.0
        mean = _mean(codes[k], chance[k], 0.0, np.inf)
        if _beyond(codes[k], chance[k], mean, cut) > limits.hardly:
            middle = _median(codes[k], chance[k], mean, sigma[k] + 1.0)
            mean = _mean(codes[k], chance[k], middle, cut)
        _add(codes[k], chance[k], sigma[k], mean, cut, limits, moments[k], far[k])


@njit(cache=True, nogil=True, fastmath={"reassoc", "nsz"})
def _mean(codes, chance, middle, cut):  # type: ignore[no-untyped-def]  # compiled
    total, weight = 0.0, 0.0
    for j in range(codes.shape[0]):
        code, share = codes[j], chance[j]
        inside = share if abs(code - middle) <= cut else 0.0
        total += inside * code
        weight += inside
    return total / max(weight, 1e-12)


@njit(cache=True, nogil=True, fastmath={"reassoc", "nsz"})
def _beyond(codes, chance, mean, cut):  # type: ignore[no-untyped-def]  # compiled
    beyond = 0.0
    for j in range(codes.shape[0]):
        share = chance[j]
        beyond += share if abs(codes[j] - mean) > cut else 0.0
    return beyond


@njit(cache=True, nogil=True, fastmath={"reassoc", "nsz"})
def _upto(codes, chance, code):  # type: ignore[no-untyped-def]  # compiled
    upto = 0.0
    for j in range(codes.shape[0]):
        share = chance[j]
        upto += share if codes[j] <= code else 0.0
    return upto


@njit(cache=True, nogil=True)
def _median(codes, chance, about, wide):  # type: ignore[no-untyped-def]  # compiled
    """Return the lowest code up to which half of the samples lie, by halving what it may be.

    It is looked for `about` a place first, and on either side in steps of `wide` that double.
    """
    half = 0.5 * chance.sum()
    low, high, step = codes.min() - 1.0, codes.max(), np.ceil(wide)
    middle = min(max(np.floor(about), low), high)
    if _upto(codes, chance, middle) >= half:
        high = middle
        while middle - step > low and _upto(codes, chance, middle - step) >= half:
            high, step = middle - step, 2.0 * step
        low = max(low, middle - step)
    else:
        low = middle
        while middle + step < high and _upto(codes, chance, middle + step) < half:
            low, step = middle + step, 2.0 * step
        high = min(high, middle + step)
    while high - low > 1.0:
        middle = np.floor(0.5 * (low + high))
        if _upto(codes, chance, middle) >= half:
            high = middle
        else:
            low = middle
    return high


@njit(cache=True, nogil=True, fastmath={"reassoc", "nsz"})
def _sums(codes, chance, mean, cut, near, beside):  # type: ignore[no-untyped-def]  # noqa: PLR0917 - compiled
    """Return shares near the cut, raised and beyond it, and sums of powers of what is within."""
    by_cut, raised, out, shift, square, fourth = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    for j in range(codes.shape[0]):
        off, share = codes[j] - mean, chance[j]
        size = abs(off)
        by_cut += share if abs(size - cut) < near else 0.0
        raised += share if off > beside else 0.0
        inside = share if size <= cut else 0.0
        out += share if size > cut else 0.0
        shift += inside * off
        square += inside * off * off
        fourth += inside * off * off * off * off
    return by_cut, raised, out, shift, square, fourth


@njit(cache=True, nogil=True)
def _add(codes, chance, sigma, mean, cut, limits, moments, far):  # type: ignore[no-untyped-def]  # noqa: PLR0917 - compiled
    near, raised, out, shift, square, fourth = _sums(
        codes, chance, mean, cut, limits.near * cut, limits.beside * sigma
    )
    # Where samples lie near the cut, those about the first mean have another than those about the
    # median.
    moments[0], moments[1], moments[2] = mean + shift, square, fourth
    moments[3], moments[4], moments[5] = out, 1.0 if near > limits.near_share else 0.0, raised
    if out > 0.0:
        for j in range(codes.shape[0]):
            off = codes[j] - mean
            if abs(off) > cut and abs(off) > limits.far * sigma:
                far[_kind(off, sigma, limits, (far.shape[0] - 2) // 2)] += chance[j]


@njit(cache=True, nogil=True)
def _kind(off, sigma, limits, flips):  # type: ignore[no-untyped-def]  # compiled
    size = max(abs(off), 1.0)
    if size > limits.very_far * sigma:
        # The power of two that is nearest in its logarithm.
        part, above = frexp(size)
        bit = min(above if part > ROOT_HALF else above - 1, flips - 1)
        if abs(size - 2.0**bit) < limits.flip * sigma:
            return 2 + bit + (0 if off > 0.0 else flips)
    return 0 if off > 0.0 else 1
