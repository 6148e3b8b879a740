"""Where commands have their reports written."""

from pathlib import Path

from calib.radiometric.calibration import Calibration
from calib.radiometric.report.page import write_report
from calib.radiometric.uniformity import HELD_OUT_EVERY
from calib.recording.protocol import Recording
from calib.recording.statistics import column_statistics
from calib.recording.tone import Tone


def write_calibration_report(
    path: Path,
    recording: Recording,
    calibration: Calibration,
    tone: Tone | None = None,
    *,
    remarks: tuple[str, ...] = (),
) -> None:
    """Write the self-contained HTML report; the recording is read once more for its figures.

    Not so where departures were taken out: the figures then show what is left of it. `remarks`
    are sentences that stand below the first ones.
    """
    statistics = calibration.without_departures or column_statistics(
        recording, tone=tone, held_out_every=HELD_OUT_EVERY
    )
    write_report(path, recording, calibration, statistics, remarks)
