"""One pass over a recording: consecutive exposures differenced, memory a constant.

All consecutive differences are used, lines n + 1 and n of a line sensor, frames n + 1 and n of an
area sensor. Half their mean square is the variance, whatever the light does slowly. With n white
exposures and the fourth cumulant κ4 its own variance is

    all consecutive differences   ((3n − 4)·V² + (n − 3/2)·κ4) / (n − 1)²     3V²/n
    pairs that do not overlap     (4V² + κ4) / n                              4V²/n
    variance about the mean       2V²/(n − 1) + κ4/n                          2V²/n

of which the last would count slow drifts of the light as noise. The first, which is von Neumann's,
is as safe as the second and worth a third more exposures; with two exposures all three are one.

What all pixels of a tap share (an offset of the line, an unsteady exposure) is taken off each line,
or frame, as its mean over the tap; the share of the pixels' own noise that goes with it, of the
order of 1/m with m pixels, is put back.

Source: von Neumann, Kent, Bellinson and Hart (1941), Ann. Math. Stat. 12, 153; κ4 rederived.
"""

from collections.abc import Callable
from typing import cast

import numpy as np
from numpy.typing import NDArray

from calib.arrays import RawLines
from calib.kernels.difference_sums import Lag, Steps
from calib.recording.header import Block
from calib.recording.protocol import Recording
from calib.recording.statistics import CancelledError, Progress, never
from calib.transfer.photon_transfer.band_sums import BandSums, Difference, centres, in_steps
from calib.transfer.photon_transfer.cells import BlockCells, CellLayout, lags_of
from calib.transfer.photon_transfer.clipping import first_limits
from calib.transfer.photon_transfer.from_pairs import CommonSums, block_cells
from calib.transfer.photon_transfer.truncation import CLIP_SIGMA

FARTHEST_LAG = 2


def pair_statistics(
    recording: Recording,
    *,
    farthest_lag: int = FARTHEST_LAG,
    clip_sigma: float = CLIP_SIGMA,
    progress: Progress | None = None,
    cancelled: Callable[[], bool] = never,
) -> tuple[BlockCells, ...]:
    """Return the statistics of every block of darks and flats, in the order of acquisition.

    Args:
        recording: Is read once.
        farthest_lag: Covariances are taken out to so many columns (and rows).
        clip_sigma: Differences farther off are left out.
        progress: Called with the share done, 0 to 1.
        cancelled: Asked before each stretch; True ends in CancelledError.
    """
    layout = CellLayout.of(recording.header.camera)
    full_scale = recording.header.camera.full_scale_dn
    blocks = [b for b in recording.header.blocks if b.kind != "scene"]
    found = []
    for number, block in enumerate(blocks):
        sums = _BlockPairs(layout, full_scale, lags_of(layout, farthest_lag), clip_sigma)
        for dn in recording.frames(block.block):
            if cancelled():
                raise CancelledError(f"stopped in block {block.block}", code="cancelled")
            sums.add(dn)
            if progress is not None:
                done = min(1.0, sums.n_exposures / (block.lines or np.inf))
                progress((number + done) / len(blocks))
        found.append(sums.cells(block))
        if progress is not None:
            progress((number + 1) / len(blocks))
    return tuple(found)


class _BlockPairs:
    """Adds a block up, stretch by stretch; the last exposure is kept for the next difference."""

    def __init__(
        self, layout: CellLayout, full_scale_dn: int, lags: tuple[Lag, ...], clip_sigma: float
    ) -> None:
        self._layout, self._full_scale, self._lags = layout, full_scale_dn, lags
        self._clip_sigma = clip_sigma
        self._bands = [BandSums.zero(len(lags), layout.columns) for _ in range(layout.n_bands)]
        self._runs = [layout.tap_runs(band) for band in range(layout.n_bands)]
        self._common = CommonSums.zero(layout.n_taps)
        self._last: RawLines | None = None
        self._limit_dn: NDArray[np.float64] | None = None
        self.n_exposures = 0

    def add(self, dn: RawLines) -> None:
        """Add consecutive lines, (n, columns), or frames, (n, rows, columns)."""
        self.n_exposures += len(dn)
        for band in range(self._layout.n_bands):
            rows = dn if not self._layout.is_area else self._rows(dn, band)
            codes = rows.reshape(-1, self._layout.columns)
            self._bands[band] = self._bands[band].with_codes(codes, self._full_scale)
        joined = dn if self._last is None else np.concatenate([self._last, dn])
        self._last = dn[-1:].copy()
        if len(joined) < 2:
            return
        if self._limit_dn is None:
            self._limit_dn = first_limits(joined, self._layout, self._clip_sigma)
        if self._layout.is_area:
            for later, earlier in zip(joined[1:], joined[:-1], strict=True):
                self._add_frame(later[None], earlier[None])
        else:
            self._add_lines(joined[1:], joined[:-1])

    def _rows(self, dn: RawLines, band: int) -> RawLines:
        first, stop = self._layout.edges[band], self._layout.edges[band + 1]
        return cast("RawLines", np.ascontiguousarray(dn[..., first:stop, :]))

    def _difference(self, later: RawLines, earlier: RawLines, band: int) -> Difference:
        assert self._limit_dn is not None  # noqa: S101 - set before the first difference
        return Difference(later, earlier, self._runs[band], in_steps(self._limit_dn[band]))

    def _add_lines(self, later: RawLines, earlier: RawLines) -> None:
        difference = self._difference(later, earlier, 0)
        centre = centres(difference.first_sums())
        centre = centres(difference.sums_about(centre), centre)
        products = difference.products_about(centre, self._lags)
        self._bands[0] = self._bands[0].with_products(products)
        self._common += CommonSums.of(centre)

    def _add_frame(self, later: RawLines, earlier: RawLines) -> None:
        """Add the difference of two frames, whose taps reach over several bands."""
        bands = range(self._layout.n_bands)
        parts = [
            self._difference(self._rows(later, b)[0], self._rows(earlier, b)[0], b) for b in bands
        ]
        shared: Steps | None = None
        for _ in range(2):
            shared = self._frame_centre(parts, shared)
        assert shared is not None  # noqa: S101 - two rounds were made
        for b, part in enumerate(parts):
            centre = np.tile(shared[:, self._layout.taps_of(b)], (len(part.later), 1))
            products = part.products_about(np.ascontiguousarray(centre), self._lags)
            self._bands[b] = self._bands[b].with_products(products)
        self._common += CommonSums.of(shared)

    def _frame_centre(self, parts: list[Difference], before: Steps | None) -> Steps:
        """Return the taps' mean difference in a frame, (1, n_taps)."""
        total = np.zeros((2, self._layout.n_taps), np.int64)
        for b, part in enumerate(parts):
            taps = self._layout.taps_of(b)
            if before is None:
                sums = part.first_sums()
            else:
                sums = part.sums_about(
                    np.ascontiguousarray(np.tile(before[:, taps], (len(part.later), 1)))
                )
            total[0, taps] += sums.differences.sum(axis=0)
            total[1, taps] += sums.counts.sum(axis=0)
        return centres_of(total, before)

    def cells(self, block: Block) -> BlockCells:
        """Return what the sums say."""
        limit = self._limit_dn
        if limit is None:
            limit = np.full((self._layout.n_bands, self._layout.columns), np.inf)
        return block_cells(
            block,
            self.n_exposures,
            layout=self._layout,
            bands=self._bands,
            common=self._common,
            lags=self._lags,
            limit_dn=limit,
        )


def centres_of(total: NDArray[np.int64], before: Steps | None) -> Steps:
    """Return the means of sums of differences and counts, (2, n_taps), in 1/64 DN."""
    means = np.rint(64.0 * total[0] / np.maximum(total[1], 1)).astype(np.int32)[None, :]
    return means if before is None else np.where(total[1] > 0, means, before)
