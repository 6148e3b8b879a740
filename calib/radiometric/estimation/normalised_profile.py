"""VE with its uncertainty: the profile divided by its maximum at the axis.

With the profile p and the covariance C of its coefficients, VE(i) = p(i)/p(i0) has the relative
variance gᵀCg, g = B(i)/p(i) − B(i0)/p(i0). That i0 is itself estimated does not count to first
order (p is flat there). To second order the maximum of a noisy profile is too high: by
β = var p'(i0) / (2·|p''(i0)|·p(i0)) on average, and its square is 3β² on average. VE stays 1 at
the axis by definition and 3β² is added to its relative variance.

The order is chosen from the same columns. What the other orders would have given, each with the
weight of its prediction, scatters about VE by an amount that is added (model averaging; Buckland,
Burnham and Augustin 1997): without it an order that is too low by chance would look too sure.

A source that is uniform only to ±h lends its shape to VE. The deviation from the radiance at the
axis is taken to grow in proportion to the distance from it, up to ±h (rectangular, h/√3) at the
end of the line that is farther away.

An error σ of all slopes alike (`common_offset`, DN/µs) is a constant in p, which every order takes
up: VE is off by σ·(1/p(i) − 1/p(i0)), relative.
"""

from dataclasses import dataclass

import numpy as np
from numpy.polynomial import legendre

from calib.arrays import Columns
from calib.radiometric.estimation.vignette import ProfileFit, scaled
from calib.radiometric.estimation.whitened import Matrix


@dataclass(frozen=True)
class Vignette:
    """VE along the line; arrays (n_columns,).

    Attributes:
        values: VE, 1 at the axis.
        relative_std: From PRNU's scatter, noise and normalisation.
        uniformity_relative_std: From the source's shape, type B.
        offset_relative_std: From what shifts all slopes alike.
        axis_slope: p(i0), DN per µs of reference light.
        axis_column: 0-based, fractional.
        axis_column_std: None where the profile has no maximum inside the line.
        own_noise_share: What of a column's own relative slope error is found again in its VE.
    """

    values: Columns
    relative_std: Columns
    uniformity_relative_std: Columns
    offset_relative_std: Columns
    axis_slope: float
    axis_column: float
    axis_column_std: float | None
    own_noise_share: Columns

    @property
    def std(self) -> Columns:
        """Standard uncertainty of `values`."""
        shape = np.hypot(self.uniformity_relative_std, self.offset_relative_std)
        return self.values * np.hypot(self.relative_std, shape)


def normalise(
    fit: ProfileFit, slope_variance: Columns, uniformity: float, common_slope_std: float = 0.0
) -> Vignette:
    """Divide the profile by its maximum.

    Args:
        fit: The profile.
        slope_variance: Of the columns' slopes, (n_columns,).
        uniformity: h, the source's relative half-width.
        common_slope_std: σ, DN/µs.
    """
    columns = np.arange(len(slope_variance), dtype=np.float64)
    legend = np.asarray(
        legendre.legvander(scaled(columns, len(columns)), fit.alternatives.shape[1] - 1), np.float64
    )
    basis = legend[:, : fit.order + 1]
    profile = basis @ fit.coefficients[: fit.order + 1]
    axis, inside = _axis(fit, profile)
    at_axis = fit.profile(np.array([axis]))[0]
    by_coefficient = basis / profile[:, None] - fit.basis(np.array([axis])) / at_axis
    spread = by_coefficient @ fit.smooth_covariance
    variance = np.einsum("ij,ij->i", spread, by_coefficient)
    slope_std, bend = _at_maximum(fit, axis)
    too_high = slope_std**2 / (2.0 * bend * at_axis) if inside and bend > 0 else 0.0
    farthest = max(axis, len(columns) - 1 - axis)
    total = fit.scatter**2 * profile**2 + np.nan_to_num(slope_variance)
    share = np.where(fit.columns_used, np.einsum("ij,ij->i", spread, basis) * profile / total, 0.0)
    others, axes = _other_orders(fit, legend, axis)
    weights = np.array(fit.choice.weights)
    variance = variance + (others / (profile / at_axis)[:, None] - 1.0) ** 2 @ weights
    axis_spread = float(np.sqrt((axes - round(axis)) ** 2 @ weights))
    axis_std = float(np.hypot(slope_std / bend, axis_spread)) if inside and bend > 0 else None
    if axis_std is not None and axis_std > len(columns) / 2:
        axis_std, too_high = None, 0.0
    return Vignette(
        values=profile / at_axis,
        relative_std=np.sqrt(np.maximum(variance, 0.0) + 3.0 * too_high**2),
        uniformity_relative_std=uniformity / np.sqrt(3.0) * np.abs(columns - axis) / farthest,
        offset_relative_std=common_slope_std * np.abs(1.0 / profile - 1.0 / at_axis),
        axis_slope=float(at_axis),
        axis_column=axis,
        axis_column_std=axis_std,
        own_noise_share=share,
    )


def _other_orders(fit: ProfileFit, legend: Matrix, axis: float) -> tuple[Matrix, Columns]:
    """Return every order's profile, 1 at the chosen axis, and the column of its own maximum."""
    n_columns, n_terms = legend.shape
    along = legend @ fit.alternatives.T
    at_axis = legendre.legvander(scaled(np.array([axis]), n_columns), n_terms - 1)
    at_axis = at_axis @ fit.alternatives.T
    return along / at_axis, np.argmax(along, axis=0).astype(np.float64)


def _axis(fit: ProfileFit, profile: Columns) -> tuple[float, bool]:
    """Return where the profile is largest, and whether that is inside the line."""
    top = int(np.argmax(profile))
    if top in {0, len(profile) - 1}:
        return float(top), False
    axis = float(top)
    for _ in range(4):
        below, here, above = fit.profile(np.array([axis - 0.5, axis, axis + 0.5]))
        bend = below - 2.0 * here + above
        if bend >= 0:
            break
        axis += float(np.clip(0.25 * (below - above) / bend, -0.5, 0.5))
    return float(np.clip(axis, top - 1, top + 1)), True


def _at_maximum(fit: ProfileFit, axis: float) -> tuple[float, float]:
    """Return the standard uncertainty of p' and the size of p'' at the axis, per column."""
    n_columns = len(fit.columns_used)
    x, scale = 2.0 * axis / (n_columns - 1) - 1.0, 2.0 / (n_columns - 1)
    unit = np.eye(fit.order + 1)
    first = legendre.legval(x, legendre.legder(unit, 1)) * scale
    bend = legendre.legval(x, legendre.legder(fit.coefficients[: fit.order + 1], 2)) * scale**2
    return float(np.sqrt(first @ fit.smooth_covariance @ first)), float(-bend)
