"""Weighted sums over pixels, tap by tap, that pooled estimates are made of.

The weights are made on the way (`pixel_weights`) and never stored. Sums of all pixels take one
pass; their covariances another, over as many pixels as tell them well.
"""

import numpy as np
from numba import njit
from numpy.typing import NDArray

from calib.kernels.exposure_arrays import PairArrays
from calib.kernels.moment_sampling import factors, third_moment, two_moments
from calib.kernels.pixel_sums import Pixels
from calib.kernels.pixel_weights import Typical, shared, weights_of

GAIN, READ, EVEN, MEMBERS = range(4)
"""Rows of `weighted_sums`: with the weights a, β and 1 of pixels that count; 1 of all."""
WEIGHT, MEAN_1, MEAN_2, VARIANCE_1, VARIANCE_2, THIRD_1, THIRD_2, SIGNAL, SIGNAL_2 = range(9)
"""Columns: Σw, Σw·D̄, Σw·k₂ and Σw·k₃ of both exposures, Σw·q and Σw·q²; of a and β without k₃."""

ALL_TAPS = -1
"""In place of the number of one."""


def weighted_sums(
    pair: PairArrays,
    smooth_dn: Pixels,
    where: NDArray[np.bool_],
    tap: NDArray[np.uint8],
    typical: Typical,
    *,
    n_taps: int,
) -> NDArray[np.float64]:
    """Return the sums by tap, (n_taps, 4, 9); every other array is (n_pixels,)."""
    sums = np.zeros((n_taps, 4, 9))
    _add(pair, smooth_dn, where, tap, typical, sums)
    return sums


def covariance_sums(
    pair: PairArrays,
    smooth_dn: Pixels,
    where: NDArray[np.bool_],
    tap: NDArray[np.uint8],
    typical: Typical,
    *,
    of_tap: int,
    common: tuple[tuple[float, float], tuple[float, float]],
    every: int,
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return how far the weighted sums of each exposure scatter, from one pixel in `every`.

    Args:
        pair: Both exposures.
        smooth_dn: q̃, (n_pixels,).
        where: The pixels that count, (n_pixels,).
        tap: (n_pixels,).
        typical: For the weights.
        of_tap: One tap's pixels alone, or `ALL_TAPS`.
        common: (a, b) of each exposure: a + bq² is taken off the variances first.
        every: Its inverse is the share of the pixels that is looked at.

    Returns:
        (2, 5, 5), of Σam, Σak₂, Σm, Σβk₂, Σk₃; and of all pixels, whether they count or not,
        Σ var k₂, Σ k₂ and Σ k₂², (2, 3).
    """
    covariance, powers = np.zeros((2, 5, 5)), np.zeros((2, 3))
    _add_covariances(
        pair, smooth_dn, where, tap, typical, of_tap, common, every, covariance, powers
    )
    upper = np.triu(covariance, 1)
    whole = covariance + np.transpose(upper, (0, 2, 1))
    return every * whole, powers * np.array([every, 1.0, 1.0])


@njit(cache=True, nogil=True)
def _add(pair, smooth, where, tap, typical, sums):  # type: ignore[no-untyped-def]  # noqa: PLR0917 - compiled
    left = 0
    while left < len(tap):
        right = left + 1
        while right < len(tap) and tap[right] == tap[left]:
            right += 1
        _add_run(pair, smooth, where, typical, left, right, sums[tap[left]])
        left = right


@njit(cache=True, nogil=True, error_model="numpy", fastmath={"reassoc", "contract"})
def _add_run(pair, smooth, where, typical, left, right, sums):  # type: ignore[no-untyped-def]  # noqa: PLR0917 - compiled
    """Add pixels of one tap; scalars, and nothing stored, so that it is done in vectors."""
    mean1, variance1, third1 = pair.first.mean, pair.first.variance, pair.first.third
    mean2, variance2, third2 = pair.second.mean, pair.second.variance, pair.second.third
    exposures = shared(pair)
    a0, a1, a2, a3, a4, a5, a6 = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    b0, b3, b4, b5, b6 = 0.0, 0.0, 0.0, 0.0, 0.0
    e0, e1, e2, e3, e4, e5, e6 = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    x1, x2, x3, x4 = 0.0, 0.0, 0.0, 0.0
    for i in range(left, right):
        m1, v1, t1 = mean1[i], variance1[i], third1[i]
        m2, v2, t2 = mean2[i], variance2[i], third2[i]
        even = 1.0 if where[i] else 0.0
        a, beta, q = weights_of((m1, m2), smooth[i], even, exposures, typical)
        a0, a1, a2, a3, a4 = a0 + a, a1 + a * m1, a2 + a * m2, a3 + a * v1, a4 + a * v2
        a5, a6 = a5 + a * q, a6 + a * q * q
        b0, b3, b4 = b0 + beta, b3 + beta * v1, b4 + beta * v2
        b5, b6 = b5 + beta * q, b6 + beta * q * q
        e0, e1, e2, e3, e4 = (
            e0 + even,
            e1 + even * m1,
            e2 + even * m2,
            e3 + even * t1,
            e4 + even * t2,
        )
        e5, e6 = e5 + even * q, e6 + even * q * q
        x1, x2, x3, x4 = x1 + m1, x2 + m2, x3 + v1, x4 + v2
    of_a = (a0, a1, a2, a3, a4, 0.0, 0.0, a5, a6)
    of_beta = (b0, 0.0, 0.0, b3, b4, 0.0, 0.0, b5, b6)
    of_even = (e0, e1, e2, 0.0, 0.0, e3, e4, e5, e6)
    of_all = (float(right - left), x1, x2, x3, x4, 0.0, 0.0, 0.0, 0.0)
    for k in range(9):
        sums[0, k] += of_a[k]
        sums[1, k] += of_beta[k]
        sums[2, k] += of_even[k]
        sums[3, k] += of_all[k]


@njit(cache=True, nogil=True, error_model="numpy")
def _add_covariances(  # type: ignore[no-untyped-def]  # noqa: PLR0917 - compiled
    pair, smooth, where, tap, typical, of_tap, common, every, covariance, powers
):
    mean1, variance1, mean2, variance2 = (
        pair.first.mean, pair.first.variance, pair.second.mean, pair.second.variance
    )  # fmt: skip
    exposures, ratio, gain = shared(pair), pair.ratio, pair.gain_dn_per_e
    of_first, of_second = factors(pair.first), factors(pair.second)
    for i in range(0, len(tap), every):
        if of_tap >= 0 and tap[i] != of_tap:
            continue
        even = 1.0 if where[i] else 0.0
        means = mean1[i], mean2[i]
        a, beta, q = weights_of(means, smooth[i], even, exposures, typical)
        of_pixel = a, beta, even
        lit = max(means[1] - means[0], 0.0) / (ratio - 1.0)
        v1 = variance1[i] - (common[0][0] + common[0][1] * q * q)
        v2 = variance2[i] - (common[1][0] + common[1][1] * q * q)
        _add_pixel(of_first, v1, lit, gain, of_pixel, covariance[0], powers[0])
        _add_pixel(of_second, v2, ratio * lit, gain, of_pixel, covariance[1], powers[1])


@njit(cache=True, nogil=True, error_model="numpy", inline="always")
def _add_pixel(of_exposure, v, lit, gain, weights, covariance, powers):  # type: ignore[no-untyped-def]  # noqa: PLR0917 - compiled
    a, beta, even = weights
    mm, mv, vv = two_moments(of_exposure, v, lit, gain)
    mt, vt, tt = third_moment(of_exposure, v, lit, gain)
    powers[0] += vv
    powers[1] += v
    powers[2] += v * v
    # The upper half of those of (am, av, em, βv, et).
    covariance[0, 0] += a * a * mm
    covariance[0, 1] += a * a * mv
    covariance[0, 2] += a * even * mm
    covariance[0, 3] += a * beta * mv
    covariance[0, 4] += a * even * mt
    covariance[1, 1] += a * a * vv
    covariance[1, 2] += a * even * mv
    covariance[1, 3] += a * beta * vv
    covariance[1, 4] += a * even * vt
    covariance[2, 2] += even * mm
    covariance[2, 3] += even * beta * mv
    covariance[2, 4] += even * mt
    covariance[3, 3] += beta * beta * vv
    covariance[3, 4] += beta * even * vt
    covariance[4, 4] += even * tt
