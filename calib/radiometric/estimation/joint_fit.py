"""The lines of all columns together: DN0 and slope, and what each level shines relative to others.

Eq. 2 of AgCam with the level's radiance R of its own: mean_b(i) = DN0(i) + s(i)·r_g(b)·t_b, where
r_g = R_g / R_ref. Columns are weighted least squares fits against x = r·t; levels are weighted
ratios over all columns. The two are repeated in turn until they agree: least squares of both at
once. Blocks of a level with a single exposure tell r; those of a level with several tell DN0.

Units: x in µs of the reference level's light, s in DN per such µs.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from calib.arrays import Columns
from calib.kernels.column_fit import LineFit, fit_lines
from calib.kernels.level_sums import level_sums
from calib.radiometric.estimation.block_table import Cells

ROUNDS = 200
TOLERANCE = 1e-10


@dataclass(frozen=True)
class JointFit:
    """Columns and levels fitted together.

    Attributes:
        lines: The columns.
        relative_level: r of each group, 1 for the reference; NaN where no block could be used.
        x_us: r·t of each block, (n_blocks,); NaN where r is.
        weights: Inverse variances that entered, 0 where left out, (n_blocks, n_columns).
        residual_dn: Mean minus prediction, NaN where left out.
    """

    lines: LineFit
    relative_level: Columns
    x_us: Columns
    weights: Cells
    residual_dn: Cells

    @property
    def offset(self) -> Columns:
        """DN0, (n_columns,)."""
        return np.asarray(self.lines.offset, np.float64)

    @property
    def slope(self) -> Columns:
        """Slope, (n_columns,)."""
        return np.asarray(self.lines.slope, np.float64)

    @property
    def freedom(self) -> int:
        """Degrees of freedom of all residuals together."""
        used = self.weights > 0
        columns = int(np.isfinite(self.lines.slope).sum())
        levels = int(np.isfinite(self.relative_level).sum()) - 1
        return int(used[:, np.isfinite(self.lines.slope)].sum()) - 2 * columns - levels

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
    """Fit columns and levels in turn until the levels stand still.

    Every third turn leaps ahead to where the turns are heading; a plain turn has the last word.

    Args:
        mean_dn: (n_blocks, n_columns).
        weights: Inverse variances, 0 where a cell is left out.
        exposure_us: (n_blocks,).
        group: Level group of each block.
        start: First guess of r per group; the reference, where it is 1, stays.
    """
    relative = np.where(_groups_in_use(weights, group, len(start)), start, np.nan)
    reference = int(np.flatnonzero(relative == 1.0)[0])
    members = (np.arange(len(start))[:, None] == group).astype(np.float64)
    steps: list[Columns] = []
    for _ in range(ROUNDS):
        x = relative[group] * exposure_us
        used = np.where(np.isfinite(x)[:, None], weights, 0.0)
        lines = fit_lines(mean_dn, used, np.nan_to_num(x))
        updated = _relative_levels(mean_dn, used, lines, exposure_us, members)
        updated[~np.isfinite(relative)] = np.nan
        updated[reference] = 1.0
        steps.append(updated - relative)
        moved = np.nanmax(np.abs(steps[-1] / relative))
        relative = updated
        if moved < TOLERANCE:
            break
        if len(steps) == 3:
            relative = relative + _still_to_go(*steps[1:])
            steps.clear()
    x = relative[group] * exposure_us
    used = np.where(np.isfinite(x)[:, None] & np.isfinite(lines.slope), weights, 0.0)
    lines = fit_lines(mean_dn, used, np.nan_to_num(x))
    left = mean_dn - lines.offset - np.outer(x, lines.slope)
    return JointFit(lines, relative, x, used, np.where(used > 0, left, np.nan))


def _still_to_go(step: Columns, next_step: Columns) -> Columns:
    """Return where steps that shrink by a constant factor lead after `next_step`: Aitken's rule."""
    factor = float(np.nansum(step * next_step) / np.nansum(step * step))
    factor = min(max(factor, 0.0), 0.95)
    return next_step * factor / (1.0 - factor)


def _groups_in_use(weights: Cells, group: NDArray[np.intp], n_groups: int) -> NDArray[np.bool_]:
    return np.array([(weights[group == g] > 0).any() for g in range(n_groups)])


def _relative_levels(
    mean_dn: Cells,
    weights: Cells,
    lines: LineFit,
    exposure_us: Columns,
    members: Cells,
) -> Columns:
    """Return the weighted ratio of signal to s·t over all cells of each group, (n_groups,)."""
    sums = level_sums(mean_dn, weights, exposure_us, lines.offset, lines.slope)
    above, below = (members @ each for each in sums)
    return np.where(below > 0, above / np.where(below > 0, below, 1.0), np.nan)
