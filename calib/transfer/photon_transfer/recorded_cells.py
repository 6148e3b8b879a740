"""A recording's cells: from frames, from column statistics, or from what `statistics.csv` kept."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from calib.arrays import Columns
from calib.errors import NotDeterminedError
from calib.forward.taps import taps_of_camera
from calib.recording.block_statistics import BlockStatistics
from calib.recording.header import Block, CameraHeader, RecordingHeader
from calib.recording.statistics_csv import StatisticsRow
from calib.transfer.photon_transfer.cells import BlockCells, CellLayout


@dataclass(frozen=True)
class RecordedCells:
    """The cells of all blocks of darks and flats, in the order of acquisition.

    Attributes:
        tap: The tap that reads each cell, (n_cells,).
        pixels: Of each cell, (n_cells,).
        full_scale_dn: The highest code.
        blocks: The same cells in each.
        common_removed: Whether what a tap's pixels share was taken off the variances.
        source: What they come from: "pairs", "column statistics" or "statistics.csv".
    """

    tap: NDArray[np.intp]
    pixels: Columns
    full_scale_dn: int
    blocks: tuple[BlockCells, ...]
    common_removed: bool
    source: str


def from_pairs(camera: CameraHeader, blocks: tuple[BlockCells, ...]) -> RecordedCells:
    """Return the cells of a pass over frames."""
    layout = CellLayout.of(camera)
    return RecordedCells(
        layout.tap.ravel(), layout.pixels, camera.full_scale_dn, blocks, True, "pairs"
    )


def from_column_statistics(
    camera: CameraHeader, statistics: Sequence[BlockStatistics]
) -> RecordedCells:
    """Return cells that are columns (an area sensor's pixels), with variances about their mean.

    What all columns of a line share is in these variances and cannot be taken off.
    """
    chosen = [s for s in statistics if s.block.kind != "scene" and s.n_lines > 0]
    n_cells = camera.columns * (camera.rows or 1)
    tap = taps_of_camera(camera).ravel()
    blocks = tuple(
        _block(
            s.block,
            s.n_lines,
            s.mean_dn,
            s.variance_dn2,
            samples=np.full(n_cells, float(s.n_lines)),
            freedom=np.full(n_cells, s.n_lines - 1.0),
            clipped=(s.n_at_zero + s.n_at_full_scale) / s.n_lines,
        )
        for s in chosen
    )
    return RecordedCells(
        tap, np.ones(n_cells), camera.full_scale_dn, blocks, False, "column statistics"
    )


def from_sums(header: RecordingHeader, rows: Sequence[StatisticsRow]) -> RecordedCells:
    """Return one cell, the whole sensor, from the rows of `statistics.csv`.

    `lines` of a block says in how many exposures its samples were taken, n; of the samples a share
    1 − 1/n then are degrees of freedom of the temporal variance. Unknown, all are taken as such.

    Raises:
        NotDeterminedError: `no-temporal-noise` where no row has a variance.
    """
    if not any(row.variance_dn2 is not None for row in rows):
        message = "statistics.csv has no variance_dn2: photon transfer needs temporal variances"
        raise NotDeterminedError(message, code="no-temporal-noise")
    by_name = {block.block: block for block in header.blocks}
    kept = [r for r in rows if r.variance_dn2 is not None and by_name[r.block].kind != "scene"]
    pixels = max(_pixels_of(row, by_name[row.block]) for row in kept)
    blocks = tuple(
        _block(
            by_name[row.block],
            by_name[row.block].lines or 0,
            np.array([row.mean_dn]),
            np.array([row.variance_dn2]),
            samples=np.array([float(row.samples)]),
            freedom=np.array([_freedom(row, by_name[row.block])]),
            clipped=np.zeros(1),
        )
        for row in kept
    )
    return RecordedCells(
        np.zeros(1, np.intp),
        np.array([pixels]),
        header.camera.full_scale_dn,
        blocks,
        False,
        "statistics.csv",
    )


def _block(
    block: Block,
    n_exposures: int,
    mean_dn: Columns,
    variance_dn2: Columns,
    *,
    samples: Columns,
    freedom: Columns,
    clipped: Columns,
) -> BlockCells:
    nowhere = np.full(len(mean_dn), np.nan)
    with np.errstate(divide="ignore"):
        square = 2.0 / freedom
    return BlockCells(
        block=block,
        n_exposures=n_exposures,
        mean_dn=mean_dn,
        variance_dn2=variance_dn2,
        covariance_dn2=np.empty((0, len(mean_dn))),
        lags=(),
        lag_share=np.empty(0),
        square_factor=square,
        cumulant_factor=1.0 / samples,
        clipped_share=np.asarray(clipped, np.float64),
        limit_dn=np.full(len(mean_dn), np.inf),
        rejected_share=0.0,
        common_dn2=np.full(1, np.nan),
        line_covariance_dn2=nowhere,
    )


def _freedom(row: StatisticsRow, block: Block) -> float:
    n = block.lines
    return row.samples * (1.0 - 1.0 / n) if n is not None and n > 1 else float(row.samples)


def _pixels_of(row: StatisticsRow, block: Block) -> float:
    return row.samples / (block.lines or 1)
