"""The lines of all columns together: DN0 and slope, and what each level shines relative to others.

Eq. 2 of AgCam with the level's radiance R of its own: mean_b(i) = DN0(i) + s(i)·r_g(b)·t_b, where
r_g = R_g / R_ref. Columns are weighted least squares fits against x = r·t, which leaves the levels
to be found: Gauss-Newton steps on what is left of the sum of squares (`calib.kernels.level_sums`)
lead to the least squares of both at once. Blocks of a level with a single exposure tell r; those
of a level with several tell DN0.

Units: x in µs of the reference level's light, s in DN per such µs.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from calib.arrays import Columns
from calib.kernels.column_fit import LineFit, fit_lines
from calib.kernels.level_sums import level_equations
from calib.radiometric.estimation.block_table import Cells

ROUNDS = 50
TOLERANCE = 1e-9


@dataclass(frozen=True)
class JointFit:
    """Columns and levels fitted together.

    Attributes:
        lines: The columns.
        relative_level: r of each group, 1 for the reference; NaN where no block could be used.
        x_us: r·t of each block, (n_blocks,); NaN where r is.
        weights: Inverse variances that entered, 0 where left out, (n_blocks, n_columns).
        mean_dn: The means that were fitted.
    """

    lines: LineFit
    relative_level: Columns
    x_us: Columns
    weights: Cells
    mean_dn: Cells

    @property
    def offset(self) -> Columns:
        """DN0, (n_columns,)."""
        return np.asarray(self.lines.offset, np.float64)

    @property
    def slope(self) -> Columns:
        """Slope, (n_columns,)."""
        return np.asarray(self.lines.slope, np.float64)

    @cached_property
    def freedom(self) -> int:
        """Degrees of freedom of all residuals together; what has weight has a line."""
        columns = int(np.isfinite(self.lines.slope).sum())
        levels = int(np.isfinite(self.relative_level).sum()) - 1
        return int(np.count_nonzero(self.weights)) - 2 * columns - levels

    @cached_property
    def residual_dn(self) -> Cells:
        """Mean minus prediction, NaN where left out."""
        return np.where(self.weights > 0, self.mean_dn - self.predicted_dn(), np.nan)

    def predicted_dn(self) -> Cells:
        """Return DN0 + s·x for every cell, (n_blocks, n_columns)."""
        return self.offset + np.outer(self.x_us, self.slope)


def fit_jointly(
    mean_dn: Cells,
    weights: Cells,
    exposure_us: Columns,
    group: NDArray[np.intp],
    start: Columns,
) -> JointFit:
    """Fit columns at given levels, step to better levels, and so on until these stand still.

    Args:
        mean_dn: (n_blocks, n_columns).
        weights: Inverse variances, 0 where a cell is left out.
        exposure_us: (n_blocks,).
        group: Level group of each block.
        start: First guess of r per group; the reference, where it is 1, stays.
    """
    relative = np.where(_groups_in_use(weights, group, len(start)), start, np.nan)
    reference = int(np.flatnonzero(relative == 1.0)[0])
    for _ in range(ROUNDS):
        x = relative[group] * exposure_us
        used = weights if np.isfinite(x).all() else np.where(np.isfinite(x)[:, None], weights, 0.0)
        lines = fit_lines(mean_dn, used, np.nan_to_num(x))
        equations = level_equations(
            mean_dn,
            used,
            exposure_us=exposure_us,
            group=group,
            relative_level=relative,
            lines=lines,
        )
        step = _level_step(*equations, reference)
        moved = np.nanmax(np.abs(step / relative))
        relative = relative + np.clip(step, -0.5 * relative, 0.5 * relative)
        if moved < TOLERANCE:
            break
    x = relative[group] * exposure_us
    used = np.where(np.isfinite(x)[:, None] & np.isfinite(lines.slope), weights, 0.0)
    return JointFit(fit_lines(mean_dn, used, np.nan_to_num(x)), relative, x, used, mean_dn)


def _level_step(curvature: Cells, gradient: Columns, told: Columns, reference: int) -> Columns:
    """Return the Gauss-Newton step of each level: none of the reference, NaN if no column tells.

    A direction in which the sum of squares does not change is not moved along.
    """
    step = np.where(told > 0, 0.0, np.nan)
    step[reference] = 0.0
    free = np.flatnonzero((told > 0) & (np.arange(len(told)) != reference))
    if free.size:
        square = curvature[np.ix_(free, free)]
        step[free] = np.linalg.lstsq(square, gradient[free], rcond=1e-12)[0]
    return step


def _groups_in_use(weights: Cells, group: NDArray[np.intp], n_groups: int) -> NDArray[np.bool_]:
    return np.array([(weights[group == g] > 0).any() for g in range(n_groups)])
