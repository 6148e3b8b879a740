"""Scatter beyond what statistics allow: how large, whether it is there, and how likely the data.

A datum has the variance v + τ²·w: v is what statistics give, τ²·w what else happens, in proportion
to the square of the expected value. τ² is where χ² equals its degrees of freedom (Paule and Mandel
1982). That of variances counts only where χ² without it is less likely than 1 in 100, so that good
data are not given larger errors by chance half of the time; that of means always, since sources
are never still. In a likelihood it is profiled, τ² ≥ 0.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import brentq, minimize_scalar
from scipy.stats import chi2

from calib.arrays import Columns

_LEAST_LIKELY = 0.01


@dataclass(frozen=True)
class Excess:
    """What scatter there is beyond statistics.

    Attributes:
        relative: τ, relative to the expected value; 0 where none is seen.
        freedom: Degrees of freedom that it comes from.
        chi_squared: Without it.
    """

    relative: float
    freedom: int
    chi_squared: float


def excess(
    residual: Columns,
    own: Columns,
    size: Columns,
    freedom: int,
    least_likely: float = _LEAST_LIKELY,
) -> Excess:
    """Return the excess of residuals.

    Args:
        residual: Seen less expected.
        own: Variance by statistics.
        size: Square of the expected value, of which τ² is a share.
        freedom: How many of the residuals are free.
        least_likely: The excess counts where χ² without it is less likely than this; 1 for always.
    """
    if freedom < 1:
        return Excess(0.0, max(freedom, 0), float(np.sum(residual**2 / own)))

    def beyond(tau2: float) -> float:
        return float(np.sum(residual**2 / (own + tau2 * size))) - freedom

    without = beyond(0.0) + freedom
    if without <= freedom or chi2.sf(without, freedom) > least_likely:
        return Excess(0.0, freedom, without)
    most = float(np.max(residual**2 / np.maximum(size, 1e-300))) * len(residual) / freedom + 1e-30
    found = float(brentq(beyond, 0.0, 10.0 * most, xtol=1e-18, rtol=1e-10))
    return Excess(float(np.sqrt(found)), freedom, without)


@dataclass(frozen=True)
class ByLight:
    """The excess of flats and of darks, which different things make.

    Attributes:
        flats: Of the flats.
        darks: Of the darks.
    """

    flats: Excess
    darks: Excess

    def tau2(self, is_dark: NDArray[np.bool_]) -> Columns:
        """Return τ² of each point."""
        return np.where(is_dark, self.darks.relative, self.flats.relative) ** 2


def excess_by_light(
    residual: Columns, own: Columns, size: Columns, is_dark: NDArray[np.bool_], n_curve: int
) -> ByLight:
    """Return the excess of flats and darks.

    Args:
        residual: Seen less expected.
        own: Variance by statistics.
        size: Square of the expected value.
        is_dark: Which are darks'.
        n_curve: Parameters of the curve; one of them, the read noise, is the darks' if there are.
    """

    def of(which: NDArray[np.bool_], n_free: int) -> Excess:
        left = int(which.sum()) - n_free
        return excess(residual[which], own[which], size[which], left)

    by_darks = int(is_dark.any())
    return ByLight(of(~is_dark, n_curve - by_darks), of(is_dark, by_darks))


def deviance(residual: Columns, own: Columns, size: Columns) -> float:
    """Return minus twice the log likelihood of normal residuals, least over τ² ≥ 0."""

    def of(log_tau2: float) -> float:
        total = own + np.exp(log_tau2) * size
        return float(np.sum(residual**2 / total + np.log(2.0 * np.pi * total)))

    if not len(residual):
        return 0.0
    ratio = np.maximum(residual**2, own) / np.maximum(size, 1e-300)
    high = float(np.log(np.max(ratio[size > 0]))) + 2.0 if (size > 0).any() else 0.0
    grid = np.linspace(high - 30.0, high, 61)
    best = float(grid[np.argmin([of(g) for g in grid])])
    least = minimize_scalar(of, bounds=(best - 0.5, best + 0.5), method="bounded")
    none = float(np.sum(residual**2 / own + np.log(2.0 * np.pi * own)))
    return min(none, float(least.fun))
