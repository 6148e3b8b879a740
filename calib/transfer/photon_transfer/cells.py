"""Cells: the smallest patches whose statistics are kept, a column of a band of rows each.

A line sensor has one band: its cells are its columns. An area sensor's frame is cut into bands
(never across its middle, where taps meet), so that what is kept does not grow with its rows.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from calib.arrays import Columns
from calib.forward.taps import taps_of_camera
from calib.kernels.difference_sums import Lag, TapRuns
from calib.recording.header import Block, CameraHeader

BANDS = 16
SHORTEST_BAND = 8


@dataclass(frozen=True)
class CellLayout:
    """Which cells a sensor has; a cell's number is band · columns + column.

    Attributes:
        columns: Of the sensor.
        edges: Rows at which bands begin, and the number of rows; (0, 1) of a line sensor.
        tap: The tap that reads each cell, (n_bands, columns).
        is_area: Whether rows are places (an area sensor) or times (a line sensor).
        crosses_taps: Whether neighbours that different taps read are still neighbours in charge
            and not at the seam of two halves.
    """

    columns: int
    edges: tuple[int, ...]
    tap: NDArray[np.intp]
    is_area: bool
    crosses_taps: bool

    @classmethod
    def of(cls, camera: CameraHeader) -> "CellLayout":
        """Return the cells of a camera's sensor."""
        rows = camera.rows
        edges = (0, 1) if rows is None else _bands(rows)
        tap = taps_of_camera(camera).reshape(rows or 1, camera.columns)[list(edges[:-1])]
        crosses = camera.tap_layout == "odd_even"
        return cls(camera.columns, edges, tap, rows is not None, crosses)

    @property
    def n_bands(self) -> int:
        """How many bands of rows."""
        return len(self.edges) - 1

    @property
    def n_taps(self) -> int:
        """How many taps."""
        return int(self.tap.max()) + 1

    @property
    def pixels(self) -> Columns:
        """How many pixels each cell has, (n_cells,)."""
        return np.repeat(np.diff(self.edges), self.columns).astype(np.float64)

    def tap_runs(self, band: int) -> TapRuns:
        """Return the columns by tap of one band."""
        return TapRuns.of(self.tap[band])

    def taps_of(self, band: int) -> NDArray[np.intp]:
        """Return the numbers of the taps that read a band, ascending."""
        return np.unique(self.tap[band])

    def are_neighbours(self, lag: Lag) -> NDArray[np.bool_]:
        """Return where a cell's pixels have neighbours at `lag` of their own kind, (n_cells,)."""
        beyond = np.arange(self.columns) + lag[1]
        inside = (beyond >= 0) & (beyond < self.columns)
        same = self.tap[:, np.where(inside, beyond, 0)] == self.tap
        return np.asarray(((same | self.crosses_taps) & inside).ravel())


def lags_of(layout: CellLayout, farthest: int) -> tuple[Lag, ...]:
    """Return the lags that are summed up, the first being none at all.

    Of an area sensor rows and columns, on both sides; of a line sensor columns, and the next line.
    """
    along = [(0, k) for k in range(farthest + 1)]
    if not layout.is_area:
        return (*along, (1, 0))
    below = [(r, c) for r in range(1, farthest + 1) for c in range(-farthest, farthest + 1)]
    return (*along, *below)


@dataclass(frozen=True)
class BlockCells:
    """A block's temporal statistics, cell by cell; arrays (n_cells,) where nothing else is said.

    Attributes:
        block: The conditions.
        n_exposures: Lines, or frames of an area sensor.
        mean_dn: Mean code.
        variance_dn2: Temporal variance of a pixel, what is common to its tap taken off.
        covariance_dn2: Of neighbours, (n_lags, n_cells), in the order of `lags`, which leaves out
            (0, 0); NaN where there are none.
        lags: Rows and columns.
        lag_share: Products at each lag by squares at none, (n_lags,).
        square_factor: a in var(variance) = a·V² + b·κ4, with κ4 the fourth cumulant.
        cumulant_factor: b.
        clipped_share: Share of the samples at either end of the code range.
        limit_dn: Differences farther off were left out; infinite where none were.
        rejected_share: Share of the differences that were left out.
        common_dn2: Variance of what a tap's pixels share, (n_taps,); NaN where unknown.
        line_covariance_dn2: Of a line with the next less that of the next but one; NaN of an area
            sensor.
    """

    block: Block
    n_exposures: int
    mean_dn: Columns
    variance_dn2: Columns
    covariance_dn2: NDArray[np.float64]
    lags: tuple[Lag, ...]
    lag_share: Columns
    square_factor: Columns
    cumulant_factor: Columns
    clipped_share: Columns
    limit_dn: Columns
    rejected_share: float
    common_dn2: Columns
    line_covariance_dn2: Columns


def _bands(rows: int) -> tuple[int, ...]:
    each = max(1, min(BANDS // 2, rows // (2 * SHORTEST_BAND)))
    middle = (rows + 1) // 2  # where `tap_of_pixel` has the lower taps begin
    upper = np.linspace(0, middle, each + 1).round().astype(int)
    lower = np.linspace(middle, rows, each + 1).round().astype(int)
    return tuple(int(k) for k in np.unique(np.concatenate([upper, lower])))
