"""Normal equations of the levels, from which the columns' lines have been eliminated.

With mean = offset + slope·r·t, the residual e = mean − offset − slope·r·t and the line fitted to
each column, the sum of squares Σ w·e² depends on the levels r alone (variable projection: Golub
and Pereyra 1973; without second derivatives: Kaufman 1975). Its half gradient and curvature are,
for the levels g and h,

    c_g  = Σ_i Σ_{b∈g} w·s·t·e,
    C_gh = Σ_i [δ_gh·Σ_{b∈g} w·(s·t)² − u_gᵀ·V·u_h],    u_g = Σ_{b∈g} w·s·t·(1, r·t)ᵀ,

V the covariance of the column's offset and slope. C⁻¹·c is the step to the levels' least squares.
"""

import numpy as np
from numba import njit
from numpy.typing import NDArray

from calib.kernels.column_fit import LineFit

Cells = NDArray[np.float64]

_TILE = 512


def level_equations(
    mean_dn: Cells,
    weights: Cells,
    *,
    exposure_us: Cells,
    group: NDArray[np.intp],
    relative_level: Cells,
    lines: LineFit,
) -> tuple[Cells, Cells, Cells]:
    """Return C, (n_groups, n_groups), c, and Σ w·(s·t)², (n_groups,) each.

    The last is 0 for a level of which no column tells anything.

    Args:
        mean_dn: (n_blocks, n_columns).
        weights: As `mean_dn`; inverse variances. What has weight 0 may be NaN.
        exposure_us: t, (n_blocks,).
        group: Level of each block, (n_blocks,).
        relative_level: r of each level, (n_groups,); NaN where its blocks have no weight.
        lines: Fitted with these weights at r·t; a column that is NaN is left out.
    """
    known = np.isfinite(lines.slope) & np.isfinite(lines.offset)
    columns = np.stack(
        [
            np.where(known, each, 0.0)
            for each in (
                lines.offset,
                lines.slope,
                lines.offset_variance,
                lines.covariance,
                lines.slope_variance,
            )
        ]
    )
    n_groups = len(relative_level)
    curvature, (gradient, told) = np.zeros((n_groups, n_groups)), np.zeros((2, n_groups))
    level = np.nan_to_num(relative_level)
    _add(mean_dn, weights, exposure_us, group, level, columns, curvature, gradient, told)
    return curvature + np.diag(told), gradient, told


@njit(cache=True, nogil=True, fastmath={"reassoc", "contract"})
def _add(mean, weights, exposures, group, level, columns, curvature, gradient, told):  # type: ignore[no-untyped-def]  # noqa: PLR0917 - compiled
    first, second = np.empty((2, len(level), _TILE))
    for left in range(0, mean.shape[1], _TILE):
        right = min(left + _TILE, mean.shape[1])
        offset, slope = columns[0, left:right], columns[1, left:right]
        first[:], second[:] = 0.0, 0.0
        for block in range(mean.shape[0]):
            g, exposure = group[block], exposures[block]
            x = level[g] * exposure
            row, weight = mean[block, left:right], weights[block, left:right]
            along, across = first[g], second[g]
            above, squares = 0.0, 0.0
            for i in range(right - left):
                expected = weight[i] * slope[i] * exposure
                squares += weight[i] * slope[i] * slope[i]
                rest = row[i] - offset[i] - slope[i] * x
                above += expected * rest if weight[i] > 0 else 0.0
                along[i] += expected
                across[i] += expected * x
            gradient[g] += above
            told[g] += squares * exposure * exposure
        _eliminate(first, second, columns[2:, left:right], curvature)


@njit(cache=True, nogil=True, fastmath={"reassoc", "contract"})
def _eliminate(first, second, variances, curvature):  # type: ignore[no-untyped-def]
    """Take u_gᵀ·V·u_h off the curvature."""
    for g in range(len(first)):
        for h in range(g + 1):
            total = 0.0
            for i in range(variances.shape[1]):
                a = variances[0, i] * first[h, i] + variances[1, i] * second[h, i]
                b = variances[1, i] * first[h, i] + variances[2, i] * second[h, i]
                total += first[g, i] * a + second[g, i] * b
            curvature[g, h] -= total
            if h != g:
                curvature[h, g] -= total
