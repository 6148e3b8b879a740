"""From a recording to its data sheet."""

from collections.abc import Callable
from dataclasses import dataclass
from itertools import chain

import numpy as np

from calib.errors import InputError
from calib.recording.header import Block, RecordingHeader
from calib.recording.protocol import Recording
from calib.recording.statistics import Progress, never
from calib.recording.statistics_csv import StatisticsRow
from calib.transfer.emva1288.block_figures import BlockFigures, figures_of, figures_of_sums
from calib.transfer.emva1288.block_image import BlockImage, read_block
from calib.transfer.emva1288.choices import spatial_blocks
from calib.transfer.emva1288.clipping import carrier_of, clipped_point
from calib.transfer.emva1288.findings import findings
from calib.transfer.emva1288.fits import fits_of
from calib.transfer.emva1288.formulas import Formulas
from calib.transfer.emva1288.inputs import vector_of
from calib.transfer.emva1288.misfits import misfits, with_unrest
from calib.transfer.emva1288.nonuniformity import SpatialInputs, mean_squares
from calib.transfer.emva1288.propagation import propagate
from calib.transfer.emva1288.reasons import estimates
from calib.transfer.emva1288.saturation import SaturationPoint, find_saturation
from calib.transfer.emva1288.series import Series, series_of
from calib.transfer.emva1288.sheet import DataSheet
from calib.transfer.emva1288.spatial_curves import SpatialCurves, can_filter, curves_of
from calib.transfer.emva1288.temporal_curves import dark_curve, transfer_curve
from calib.transfer.estimate import Estimate


def data_sheet(
    recording: Recording,
    *,
    progress: Progress | None = None,
    cancelled: Callable[[], bool] = never,
) -> DataSheet:
    """Return every figure of the linear model, each with its standard uncertainty or a reason.

    Every block is read once, those that saturation and the nonuniformities are from twice; memory
    holds a few images, however many frames and blocks there are.

    Args:
        recording: Flats at several exposures or levels, and capped darks at the same exposures;
            a line or an area sensor's. Scenes are left alone.
        progress: Called with the fraction done.
        cancelled: Asked before each frame; True ends in CancelledError.

    Raises:
        NotDeterminedError: `no-flats`, `no-darks`, `too-few-frames`, `one-exposure`,
            `all-saturated`.
        InputError: `flat-without-light`, `image-too-small`.
    """
    header = recording.header
    reader = _Reader(recording, progress, cancelled)
    sums: tuple[StatisticsRow, ...] = getattr(recording, "statistics", ())
    wanted = [b for b in header.blocks if b.kind != "scene"]
    blocks = _of_sums(wanted, sums) if sums else [figures_of(reader.read(b)) for b in wanted]
    series = series_of(blocks, header, str(recording.path))
    full_scale_dn = header.camera.full_scale_dn
    point = find_saturation(series, full_scale_dn)
    if point.by_share:
        carrier = carrier_of(point, series)
        image = reader.read(series.flats[carrier].block).mean_dn
        point = clipped_point(point, series, carrier, image, full_scale_dn)
    spatial = None if sums else _spatial(reader, series, point)
    sheet = _assemble(recording, series, point, spatial)
    if progress is not None:
        progress(1.0)
    return sheet


@dataclass(frozen=True)
class _Spatial:
    inputs: SpatialInputs
    curves: SpatialCurves
    filtered: bool


class _Reader:
    """Reads blocks, and tells how far along it is: three of them are read a second time."""

    def __init__(
        self, recording: Recording, progress: Progress | None, cancelled: Callable[[], bool]
    ) -> None:
        self._recording, self._progress, self._cancelled = recording, progress, cancelled
        self._total = sum(b.kind != "scene" for b in recording.header.blocks) + 3
        self._done = 0

    def read(self, block: Block) -> BlockImage:
        """Return the block's images."""

        def inside(fraction: float) -> None:
            if self._progress is not None:
                self._progress((self._done + fraction) / self._total)

        found = read_block(self._recording, block, inside, self._cancelled)
        self._done += 1
        return found


def _of_sums(wanted: list[Block], sums: tuple[StatisticsRow, ...]) -> list[BlockFigures]:
    rows = {row.block: row for row in sums}
    return [figures_of_sums(b, rows[b.block]) for b in wanted if b.block in rows]


def _spatial(reader: _Reader, series: Series, point: SaturationPoint) -> _Spatial:
    """Read the two blocks that the nonuniformities are from."""
    index = spatial_blocks(series, point)
    of_flat, of_dark = series.flats[index], series.darks[series.dark_of[index]]
    flat = reader.read(of_flat.block).mean_dn
    dark = reader.read(of_dark.block).mean_dn
    if flat.shape[1] < 3 or flat.shape[0] == 2:
        raise InputError(
            f"an image of {flat.shape[0]} × {flat.shape[1]} pixels has no rows and columns to "
            "speak of: record three or more of each",
            code="image-too-small",
        )
    filtered = can_filter(flat.shape)
    inputs = SpatialInputs(
        dark=mean_squares(dark, of_dark, filtered=filtered),
        flat=mean_squares(flat, of_flat, filtered=filtered),
        dark_unfiltered=mean_squares(dark, of_dark, filtered=False),
        flat_unfiltered=mean_squares(flat, of_flat, filtered=False),
        flat_index=index,
    )
    return _Spatial(inputs, curves_of(dark, flat, of_dark, of_flat), filtered)


def _assemble(
    recording: Recording, series: Series, point: SaturationPoint, spatial: _Spatial | None
) -> DataSheet:
    header = recording.header
    fits = fits_of(series, point)
    series, unrest = with_unrest(series, fits)
    rate = header.source.photons_per_pixel_per_us
    inputs = None if spatial is None else spatial.inputs
    formulas = Formulas(series, point, fits, rate, inputs)
    relative = misfits(series, fits)
    found = propagate(formulas, *vector_of(series, point, relative, inputs))
    figures = estimates(found, formulas, header.camera, header.source)
    said = findings(formulas, relative, found, spatial is None or spatial.filtered)
    return DataSheet(
        header=header,
        recording=recording.path.name,
        figures=figures,
        response_dn_per_light=Estimate(*found["response_dn_per_light"], "DN/µs"),
        photon_scale_relative_std=_photon_scale(header),
        transfer=transfer_curve(formulas, found),
        darks=dark_curve(series, found),
        spatial=None if spatial is None else spatial.curves,
        warnings=tuple(chain(recording.warnings, series.warnings, unrest, said)),
    )


def _photon_scale(header: RecordingHeader) -> float | None:
    """Return the photon scale's relative standard uncertainty, as far as it is stated."""
    source = header.source
    stated = (source.certificate_relative_std, source.monitor_relative_std)
    known = [each for each in stated if each is not None]
    return float(np.sqrt(np.sum(np.square(known)))) if known else None
