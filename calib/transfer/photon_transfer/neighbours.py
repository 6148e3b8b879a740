"""How neighbours' noise correlates: with which coefficient, how surely, and how it grows."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from calib.arrays import Columns
from calib.kernels.difference_sums import Lag
from calib.transfer.photon_transfer.points import Points


@dataclass(frozen=True)
class Neighbours:
    """One lag of one tap.

    Attributes:
        lag: Rows and columns.
        correlation: Covariance over variance of the flats' noise beyond the darks', weighted.
        correlation_std: Its standard uncertainty, from the model of the noise.
        growth_per_e: a in C = a·K²·N² beyond the darks' covariance, 1/e-; to first order a_ij.
        growth_std: Its standard uncertainty.
    """

    lag: Lag
    correlation: float
    correlation_std: float
    growth_per_e: float
    growth_std: float


def neighbours_of(points: Points, variance: Columns) -> tuple[Neighbours, ...]:
    """Return what every lag shows.

    Args:
        points: Of one tap, those in use.
        variance: The model's, for the weights, (n_points,).
    """
    dark = points.is_dark
    return tuple(
        _of_lag(points, k, variance, dark)
        for k in range(len(points.lags))
        if np.isfinite(points.covariance_dn2[k]).any() and (~dark).any()
    )


def _of_lag(points: Points, k: int, variance: Columns, dark: NDArray[np.bool_]) -> Neighbours:
    seen = points.covariance_dn2[k]
    own = points.covariance_factor[k] * variance**2
    known = np.isfinite(seen) & np.isfinite(own)
    floor, floor_variance, noise = 0.0, 0.0, 0.0
    if (known & dark).any():
        weight = 1.0 / own[known & dark]
        floor = float((weight * seen[known & dark]).sum() / weight.sum())
        floor_variance = float(1.0 / weight.sum())
        noise = float(np.average(variance[dark]))
    flat = known & ~dark
    beyond, weight = seen[flat] - floor, 1.0 / own[flat]
    values = []
    for size in (variance[flat] - noise, points.signal_dn[flat] ** 2):
        total = float((weight * size**2).sum())
        lever = float((weight * size).sum()) / total
        value = float((weight * size * beyond).sum()) / total
        values.append((value, float(np.sqrt(1.0 / total + lever**2 * floor_variance))))
    (correlation, correlation_std), (growth, growth_std) = values
    return Neighbours(points.lags[k], correlation, correlation_std, growth, growth_std)


def nearest_sigma(found: tuple[Neighbours, ...]) -> float:
    """Return how surely the nearest neighbours' covariances grow with the signal's square.

    The lags of one row or one column are taken together; NaN where there are none.
    """
    near = [n for n in found if max(n.lag) == 1]
    if not near:
        return float("nan")
    weight = np.array([n.growth_std**-2 for n in near])
    value = np.array([n.growth_per_e for n in near])
    return float((weight * value).sum() / np.sqrt(weight.sum()))
