"""Photon transfer of a recording: system gain and read noise, per tap and pooled.

Sources: EMVA Standard 1288, Release 4.0 Linear, section 2; Janesick, Photon Transfer (2007);
Astier et al. 2019, A&A 629, A36. What is done, and why, is in docs/photon-transfer/curve.md.
"""

from collections.abc import Callable, Sequence

from calib.errors import NotDeterminedError
from calib.recording.block_statistics import BlockStatistics, RecordingStatistics
from calib.recording.folder_recording import FolderRecording
from calib.recording.header import CameraHeader
from calib.recording.protocol import Recording
from calib.recording.statistics import Progress, never
from calib.transfer.photon_transfer.pair_pass import FARTHEST_LAG, pair_statistics
from calib.transfer.photon_transfer.points import curve_of
from calib.transfer.photon_transfer.recorded_cells import (
    RecordedCells,
    from_column_statistics,
    from_pairs,
    from_sums,
)
from calib.transfer.photon_transfer.result import PhotonTransfer
from calib.transfer.photon_transfer.tap_transfer import tap_transfer
from calib.transfer.photon_transfer.truncation import CLIP_SIGMA
from calib.transfer.photon_transfer.turn_off import used_range


def photon_transfer(
    recording: Recording,
    *,
    most_dn: float | None = None,
    farthest_lag: int = FARTHEST_LAG,
    clip_sigma: float = CLIP_SIGMA,
    progress: Progress | None = None,
    cancelled: Callable[[], bool] = never,
) -> PhotonTransfer:
    """Measure system gain and read noise.

    Args:
        recording: Flats of several exposures (best of one level), and darks; from frames, or from
            what `statistics.csv` kept.
        most_dn: The highest mean code that is used; None for all below clipping and turn-off.
        farthest_lag: Covariances of neighbours are taken out to so many columns and rows.
        clip_sigma: Differences so many standard deviations off are left out.
        progress: Called with the share that is done, 0 to 1.
        cancelled: Asked before each stretch of frames; True ends in CancelledError.

    Raises:
        NotDeterminedError: `no-temporal-noise` without flats of two exposures or more,
            `photon-transfer-range` where nothing is left between the ends of the code range.
    """
    camera = recording.header.camera
    if isinstance(recording, FolderRecording) and recording.statistics:
        recorded = from_sums(recording.header, recording.statistics)
    else:
        blocks = pair_statistics(
            recording,
            farthest_lag=farthest_lag,
            clip_sigma=clip_sigma,
            progress=progress,
            cancelled=cancelled,
        )
        recorded = from_pairs(camera, blocks)
    return _measured(recorded, most_dn, recording.warnings)


def gain_and_noise(
    statistics: RecordingStatistics | Sequence[BlockStatistics],
    camera: CameraHeader,
    *,
    most_dn: float | None = None,
) -> PhotonTransfer:
    """Measure the same from column statistics that somebody has already: no second reading.

    The variances are those about the mean, which are surer than differences by a third, but count
    what all columns of a line share, and slow drifts of the light, as noise of the pixels.

    Args:
        statistics: Of a recording of darks and flats (`calib.recording.statistics`).
        camera: Its header.
        most_dn: As of `photon_transfer`.
    """
    blocks = statistics.fit if isinstance(statistics, RecordingStatistics) else statistics
    return _measured(from_column_statistics(camera, blocks), most_dn, ())


def _measured(
    recorded: RecordedCells, most_dn: float | None, warnings: tuple[str, ...]
) -> PhotonTransfer:
    curve = curve_of(recorded)
    ranges = [used_range(points, most_dn) for points in curve.taps]
    for points, used in zip(curve.taps, ranges, strict=True):
        if not (used.use & ~points.is_dark).any():
            message = (
                f"Tap {points.tap} has no flat between the ends of its code range: record flats "
                "of less light, or raise the upper limit."
            )
            raise NotDeterminedError(message, code="photon-transfer-range")
    taps = tuple(
        tap_transfer(p, u, curve.dark.is_known) for p, u in zip(curve.taps, ranges, strict=True)
    )
    return PhotonTransfer(taps, curve, recorded, warnings)
