"""Weighted means of the pixels' moments, with their covariance: what pooled estimates are made of.

Of each exposure five numbers: Σαm and Σαv with the gain's weights, Σµm with equal ones, Σβv with
the read noise's, and Σµk₃. Their covariance is the sum over pixels of the sampling covariances,
and beside it what pixels of a frame have in common, since that does not average out over them:
the offset and the flicker of `common_mode` in the means, and in the variances the excess of their
scatter from eight frames to the next over what independent pixels would show (`dispersion`).
"""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from scipy.stats import chi2

from calib.kernels.pixel_sums import Pixels
from calib.transfer.two_exposures.common_mode import CommonMode
from calib.transfer.two_exposures.exposure_pair import ExposureMoments, ExposurePair
from calib.transfer.two_exposures.frame_series import FrameSeries
from calib.transfer.two_exposures.in_parts import in_parts
from calib.transfer.two_exposures.sampling import SamplingCovariance, sampling_covariances
from calib.transfer.two_exposures.weights import Weights

MEAN_BY_GAIN, VARIANCE_BY_GAIN, MEAN, VARIANCE_BY_READ, THIRD = range(5)
_MEANS, _VARIANCES = (MEAN_BY_GAIN, MEAN), (VARIANCE_BY_GAIN, VARIANCE_BY_READ)
_COVARIANCE_OF = 1 << 19  # pixels tell the errors to well under 1 %
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


def pooled_moments(
    pair: ExposurePair, weights: Weights, members: NDArray[np.bool_], series: list[FrameSeries]
) -> PooledMoments:
    """Return the means over the pixels that have weights.

    Args:
        pair: Both exposures.
        weights: (n_pixels,).
        members: The pixels that `series` is over, whether they count or not, (n_pixels,).
        series: Frame means of the first and of the second exposure.
    """
    w = np.stack([weights.gain, weights.read, weights.even])
    w = (w / w.sum(axis=1, keepdims=True))[[0, 0, 2, 1, 2]]
    gain, common = pair.ratio_of_sums, _common_mode(pair, members, series)

    every = -(-pair.n_pixels // _COVARIANCE_OF)

    def sums(some: slice) -> tuple[NDArray[np.float64], ...]:
        of, lit = w[:, some], weights.signal_dn[some]
        part = _without(common, pair.at(some), lit)
        few = part.at(slice(None, None, every))
        covs = sampling_covariances(few, gain)
        counted = members[some][::every]
        return (
            np.stack([_values(moments, of) for moments in (part.first, part.second)]),
            every * np.stack([_covariance(cov, of[:, ::every]) for cov in covs]),
            every * np.array([np.sum(cov.variance[counted]) for cov in covs]),
            np.einsum("ki,i->k", of, lit),
            np.einsum("ki,i,i->k", of, lit, lit),
            np.array([_powers(e.variance_dn2[counted]) for e in (few.first, few.second)]),
        )

    parts = zip(*in_parts(pair.n_pixels, sums), strict=True)
    values, covariance, scatter, signal, square, powers = (sum(each) for each in parts)
    own = _own_share(pair, common, powers)
    scatter = scatter * own
    dispersion = _dispersion(pair, scatter, series)
    for a, moments in enumerate((pair.first, pair.second)):
        _add_variances(covariance[a], common, a, square, dispersion[a] * own[a])
        _add_means(covariance[a], common, a, signal, moments.n_frames)
    return PooledMoments(values, covariance, dispersion, common)


def _without(common: CommonMode, pair: ExposurePair, signal_dn: Pixels) -> ExposurePair:
    """Return the pair with the common mode taken off the variances."""
    first, second = (
        replace(e, variance_dn2=e.variance_dn2 - common.in_variance(a, signal_dn))
        for a, e in enumerate((pair.first, pair.second))
    )
    return replace(pair, first=first, second=second)


def _powers(variance: Pixels) -> tuple[float, float]:
    """Return Σv and Σv²."""
    return float(np.sum(variance)), float(np.einsum("i,i", variance, variance))


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


def _values(moments: ExposureMoments, w: NDArray[np.float64]) -> NDArray[np.float64]:
    m, v, t = moments.mean_dn, moments.variance_dn2, moments.third_dn3
    return np.array([np.einsum("i,i", row, x) for row, x in zip(w, (m, v, m, v, t), strict=True)])


def _covariance(cov: SamplingCovariance, w: NDArray[np.float64]) -> NDArray[np.float64]:
    kinds = "mvmvt"
    of = {
        "mm": cov.mean,
        "mv": cov.mean_variance,
        "vv": cov.variance,
        "mt": cov.mean_third,
        "tv": cov.variance_third,
        "tt": cov.third,
    }
    total = np.zeros((5, 5))
    for k in range(5):
        for j in range(k, 5):
            both = of["".join(sorted(kinds[k] + kinds[j]))]
            total[k, j] = total[j, k] = float(np.einsum("i,i,i", w[k], w[j], both))
    return total


def _common_mode(
    pair: ExposurePair, members: NDArray[np.bool_], series: list[FrameSeries]
) -> CommonMode:
    first, second = (float(np.mean(e.variance_dn2[members])) for e in (pair.first, pair.second))
    signal = float(np.mean(pair.difference_dn[members])) / (pair.ratio - 1.0)
    return CommonMode.of(series[0], series[1], (first, second), signal, pair.ratio)


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
