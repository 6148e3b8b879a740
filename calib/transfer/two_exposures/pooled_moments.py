"""Weighted means of the pixels' moments, with their covariance: what pooled estimates are made of.

Of each exposure five numbers: Σαm and Σαv with the gain's weights, Σµm with equal ones, Σβv with
the read noise's, and Σµk₃. Their covariance is the sum over pixels of the sampling covariances,
and beside it what pixels of a frame have in common, since that does not average out over them:
the offset and the flicker of `common_mode` in the means, and in the variances the excess of their
scatter from eight frames to the next over what independent pixels would show (`dispersion`).
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.stats import chi2

from calib.kernels.pooled_sums import (
    EVEN,
    GAIN,
    MEAN_1,
    MEAN_2,
    MEMBERS,
    READ,
    SIGNAL,
    SIGNAL_2,
    THIRD_1,
    VARIANCE_1,
    VARIANCE_2,
    WEIGHT,
)
from calib.transfer.two_exposures.common_mode import CommonMode
from calib.transfer.two_exposures.exposure_pair import ExposurePair
from calib.transfer.two_exposures.frame_series import FrameSeries
from calib.transfer.two_exposures.tap_sums import TapSums

MEAN_BY_GAIN, VARIANCE_BY_GAIN, MEAN, VARIANCE_BY_READ, THIRD = range(5)
_MEANS, _VARIANCES = (MEAN_BY_GAIN, MEAN), (VARIANCE_BY_GAIN, VARIANCE_BY_READ)
_ROWS = [GAIN, GAIN, EVEN, READ, EVEN]  # the weights of the five
CHANCE = 1e-3
"""A dispersion that chance gives more rarely than this is counted."""


@dataclass(frozen=True)
class PooledMoments:
    """Of both exposures.

    Attributes:
        values: (2, 5), in the order of the names above; the common mode is taken off the variances.
        covariance: (2, 5, 5); the exposures are independent.
        dispersion: How many times as large as expected the scatter of the variances is, by
            exposure; 1 where it is not shown to be more.
        common: What the frames have in common.
    """

    values: NDArray[np.float64]
    covariance: NDArray[np.float64]
    dispersion: tuple[float, float]
    common: CommonMode


def pooled_moments(sums: TapSums, of_tap: int, series: list[FrameSeries]) -> PooledMoments:
    """Return the means over the pixels that have weights.

    Args:
        sums: Of all pixels.
        of_tap: One tap, or `ALL_TAPS`.
        series: Frame means of the first and of the second exposure, over the tap's pixels.
    """
    pair, total = sums.pair, sums.over(of_tap)
    common = _common_mode(pair, total[MEMBERS], series)
    in_variance = common.in_variance(0), common.in_variance(1)
    covariance, powers = sums.covariance(of_tap, in_variance)
    mean = total / total[:, WEIGHT, None]
    weight = total[_ROWS, WEIGHT]
    covariance = covariance / np.outer(weight, weight)
    signal, square = mean[_ROWS, SIGNAL], mean[_ROWS, SIGNAL_2]
    own = _own_share(pair, common, powers[:, 1:])
    dispersion = _dispersion(pair, powers[:, 0] * own, series)
    for a, moments in enumerate((pair.first, pair.second)):
        _add_variances(covariance[a], common, a, square, dispersion[a] * own[a])
        _add_means(covariance[a], common, a, signal, moments.n_frames)
    values = np.stack([_values(mean, a, in_variance[a]) for a in (0, 1)])
    return PooledMoments(values, covariance, dispersion, common)


def _values(
    mean: NDArray[np.float64], exposure: int, in_variance: tuple[float, float]
) -> NDArray[np.float64]:
    """Return the five of an exposure, without the common mode."""
    m, v, t = MEAN_1 + exposure, VARIANCE_1 + exposure, THIRD_1 + exposure
    taken = in_variance[0] + in_variance[1] * mean[:, SIGNAL_2]
    own = mean[:, v] - taken
    return np.array([mean[GAIN, m], own[GAIN], mean[EVEN, m], own[READ], mean[EVEN, t]])


def _own_share(
    pair: ExposurePair, common: CommonMode, powers: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Return which share of Σv² is that of the pixels' own noise, by exposure.

    A pixel's noise meets the common one by chance: beside v² there is 4xv/ν, which cancels in the
    sum over the pixels, and is no error of it, but does not in the sum of squares.
    """
    x = np.maximum(common.excess_dn2, 0.0)
    free = np.array([pair.first.n_free, pair.second.n_free])
    one, two = powers.T
    crossed = 4.0 * x * one / (free * np.maximum(two, 1e-300))
    return np.asarray(np.maximum(1.0 - crossed, 0.1))


def _common_mode(
    pair: ExposurePair, members: NDArray[np.float64], series: list[FrameSeries]
) -> CommonMode:
    mean = members / members[WEIGHT]
    variances = float(mean[VARIANCE_1]), float(mean[VARIANCE_2])
    signal = float(mean[MEAN_2] - mean[MEAN_1]) / (pair.ratio - 1.0)
    return CommonMode.of(series[0], series[1], variances, signal, pair.ratio)


def _dispersion(
    pair: ExposurePair, scatter: NDArray[np.float64], series: list[FrameSeries]
) -> tuple[float, float]:
    """Return the ratio of the chunks' scatter to the expected one, where it is significant."""
    found = []
    for moments, expected, s in zip((pair.first, pair.second), scatter, series, strict=True):
        free = s.chunk_sizes - 1.0
        n = len(free) - 1
        of_one = expected / s.n_pixels**2 * moments.n_free  # of one degree of freedom
        if n < 1 or of_one <= 0:
            found.append(1.0)
            continue
        mean = np.average(s.chunk_variances, weights=free)
        chi_squared = float(np.sum(free * (s.chunk_variances - mean) ** 2) / of_one)
        found.append(chi_squared / n if chi2.sf(chi_squared, n) < CHANCE else 1.0)
    return found[0], found[1]


def _add_variances(
    covariance: NDArray[np.float64],
    common: CommonMode,
    exposure: int,
    square: NDArray[np.float64],
    dispersion: float,
) -> None:
    """Widen the variances' covariance by the dispersion and by what was taken off them."""
    taken = np.array([common.variance_std(exposure, float(each)) for each in square])
    for k in _VARIANCES:
        for j in _VARIANCES:
            covariance[k, j] = covariance[k, j] * dispersion + taken[k] * taken[j]


def _add_means(
    covariance: NDArray[np.float64],
    common: CommonMode,
    exposure: int,
    signal: NDArray[np.float64],
    n_frames: int,
) -> None:
    """Add what the frames have in common to the means; chance may make it negative, to a half."""
    own = covariance[np.ix_(_MEANS, _MEANS)]
    shared = np.array(
        [[common.in_mean(exposure, float(signal[k]), float(signal[j])) for j in _MEANS]
         for k in _MEANS]
    ) / n_frames  # fmt: skip
    share = min(1.0, 0.5 * float(np.min(np.diag(own) / np.maximum(-np.diag(shared), 1e-300))))
    covariance[np.ix_(_MEANS, _MEANS)] = own + shared * share
