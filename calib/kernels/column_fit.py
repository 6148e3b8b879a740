"""A straight line against exposure in every column: intercept, slope and what they are worth.

Weighted least squares in closed form (Bevington and Robinson, Data Reduction and Error Analysis
for the Physical Sciences, section 6.3). Where all columns share their weights, both estimates are
fixed linear combinations of the means, so that the fit costs one read of the means.
"""

from dataclasses import dataclass

import numpy as np
from numba import njit
from numpy.typing import NDArray

from calib.errors import InputError


@dataclass(frozen=True)
class LineFit:
    """mean = offset + slope x exposure per column; each array (n_columns,).

    Variances and covariance are those of the estimates where the weights are inverse variances;
    without weights they are for samples of unit variance. They are read-only views of a single
    number where all columns share their weights. A column with weight at fewer than two distinct
    exposures has NaN everywhere.

    Attributes:
        offset: Intercept at exposure 0, in the unit of the means.
        slope: In the unit of the means per unit of exposure.
        offset_variance: Of `offset`.
        slope_variance: Of `slope`.
        covariance: Of `offset` and `slope`; negative where all exposures are positive.
    """

    offset: NDArray[np.floating]
    slope: NDArray[np.floating]
    offset_variance: NDArray[np.floating]
    slope_variance: NDArray[np.floating]
    covariance: NDArray[np.floating]


def fit_lines(
    means: NDArray[np.generic],
    weights: NDArray[np.floating] | None,
    exposures: NDArray[np.floating],
    *,
    out: NDArray[np.floating] | None = None,
) -> LineFit:
    """Fit a straight line against exposure in each column.

    Args:
        means: (n_exposures, n_columns), any real dtype. Estimates are summed in double precision
            and returned as float64, or as float32 where the means are float32 or 8/16-bit codes.
        weights: None (all 1), (n_exposures,) shared by all columns, or (n_exposures, n_columns);
            inverse variances. A weight of 0 masks a sample, whatever its mean (NaN too).
        exposures: (n_exposures,), any unit.
        out: (2, n_columns), where offset and slope are put if the weights are shared; of the dtype
            that is returned. Fresh memory for millions of pixels costs as much as the fit.

    Raises:
        InputError: shapes disagree ("fit-shape"), a weight is negative or not finite
            ("fit-weights"), or fewer than two distinct exposures carry a shared weight
            ("too-few-exposures").
    """
    means, times = np.asarray(means), np.asarray(exposures, dtype=np.float64)
    _check_shapes(means, weights, times)
    precision = np.float32 if means.dtype in _SHORT else np.float64
    if weights is None or weights.ndim == 1:
        return _fit_shared(means, weights, times, _estimates(means, precision, out))
    values = means.astype(np.float64, copy=False)
    fitted = np.empty((5, means.shape[1]))
    _fit_columns(values, weights.astype(np.float64, copy=False), times, fitted)
    return LineFit(*fitted.astype(precision, copy=False))


_TILE = 512
_SHORT = (np.dtype(np.float32), np.dtype(np.uint8), np.dtype(np.uint16))


def _check_shapes(
    means: NDArray[np.generic],
    weights: NDArray[np.floating] | None,
    exposures: NDArray[np.float64],
) -> None:
    if means.ndim != 2 or exposures.shape != means.shape[:1]:
        msg = (
            f"Means of shape {means.shape} do not go with {exposures.shape} exposures; "
            "give (n_exposures, n_columns) and (n_exposures,)."
        )
        raise InputError(msg, code="fit-shape")
    if weights is None:
        return
    if weights.shape not in (means.shape, means.shape[:1]):
        msg = f"Weights of shape {weights.shape} fit neither {means.shape} nor {means.shape[:1]}."
        raise InputError(msg, code="fit-shape")
    if not np.isfinite(weights).all() or (weights < 0).any():
        msg = "A weight of the line fit is negative or not finite; use 0 to leave a sample out."
        raise InputError(msg, code="fit-weights")


def _estimates(
    means: NDArray[np.generic], precision: type[np.floating], out: NDArray[np.floating] | None
) -> NDArray[np.floating]:
    """Return where offset and slope are put, (2, n_columns)."""
    shape = (2, means.shape[1])
    if out is None:
        return np.empty(shape, precision)
    if out.shape != shape or out.dtype != precision:
        msg = f"Output of shape {out.shape}, {out.dtype}, must be {shape}, {np.dtype(precision)}."
        raise InputError(msg, code="fit-shape")
    return out


def _fit_shared(
    means: NDArray[np.generic],
    weights: NDArray[np.floating] | None,
    exposures: NDArray[np.float64],
    estimates: NDArray[np.floating],
) -> LineFit:
    """Fit with the same weights in every column: two linear combinations of the rows."""
    shared = np.ones(len(exposures)) if weights is None else weights.astype(np.float64)
    used = shared > 0
    if len(np.unique(exposures[used])) < 2:
        msg = "A straight line needs two distinct exposures or more; record others too."
        raise InputError(msg, code="too-few-exposures")
    rows = means if used.all() else means[used]
    shared, exposures = shared[used], exposures[used]
    total = shared.sum()
    centre = (shared * exposures).sum() / total
    spread = (shared * (exposures - centre) ** 2).sum()
    for_slope = shared * (exposures - centre) / spread
    for_offset = shared / total - centre * for_slope
    offset, slope = estimates
    _combine(rows, tuple(for_offset.tolist()), tuple(for_slope.tolist()), offset, slope)
    variances = 1 / total + centre**2 / spread, 1 / spread, -centre / spread
    return LineFit(
        offset, slope, *(np.broadcast_to(np.float64(v), offset.shape) for v in variances)
    )


@njit(cache=True, nogil=True)
def _combine(rows, for_offset, for_slope, offset, slope):  # type: ignore[no-untyped-def]
    """Sum the rows with two sets of coefficients; tuples, so that the inner loop is unrolled."""
    for column in range(rows.shape[1]):
        intercept = 0.0
        gradient = 0.0
        for k in range(len(for_offset)):
            value = np.float64(rows[k, column])
            intercept += for_offset[k] * value
            gradient += for_slope[k] * value
        offset[column] = intercept
        slope[column] = gradient


@njit(cache=True, nogil=True, error_model="numpy")
def _fit_columns(means, weights, exposures, fitted):  # type: ignore[no-untyped-def]
    """Fit each column with its own weights; `fitted` is (5, n_columns), in LineFit's order.

    Exposure by exposure over a few hundred columns at once, which makes vector instructions.
    """
    width = min(_TILE, means.shape[1])
    total, centre, level, spread, product, lowest, highest = np.empty((7, width))
    for left in range(0, means.shape[1], _TILE):
        right = min(left + _TILE, means.shape[1])
        total[:], centre[:], level[:], spread[:], product[:] = 0, 0, 0, 0, 0
        lowest[:], highest[:] = np.inf, -np.inf
        for k in range(len(exposures)):
            exposure, weight = exposures[k], weights[k, left:right]
            for i in range(right - left):
                total[i] += weight[i]
                centre[i] += weight[i] * exposure
                lowest[i] = min(lowest[i], exposure if weight[i] > 0 else np.inf)
                highest[i] = max(highest[i], exposure if weight[i] > 0 else -np.inf)
        for i in range(right - left):
            centre[i] /= total[i]
        for k in range(len(exposures)):
            exposure, weight, mean = exposures[k], weights[k, left:right], means[k, left:right]
            for i in range(right - left):
                away = exposure - centre[i]
                weighted = weight[i] * mean[i] if weight[i] > 0 else 0.0
                spread[i] += weight[i] * away * away
                level[i] += weighted
                product[i] += weighted * away
        for i in range(right - left):
            known = 0.0 if highest[i] > lowest[i] else np.nan
            slope = product[i] / spread[i] + known
            fitted[0, left + i] = level[i] / total[i] - centre[i] * slope
            fitted[1, left + i] = slope
            fitted[2, left + i] = 1 / total[i] + centre[i] ** 2 / spread[i] + known
            fitted[3, left + i] = 1 / spread[i] + known
            fitted[4, left + i] = -centre[i] / spread[i] + known
