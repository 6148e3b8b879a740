"""Begin a run or go on with one: do plan, bench and recording fit together?"""

from collections.abc import Sequence
from datetime import UTC, datetime
from pathlib import Path

from calib.errors import InputError
from calib.recording.file_recording import FileRecording
from calib.recording.writer import RecordingWriter
from drivers.ports import CameraSettings
from service.bench.bench import Bench
from service.bench.level_range import check_levels
from service.plan.header import recording_header
from service.plan.model import Plan
from service.sequencer.clock import Clock
from service.sequencer.errors import RunRefusedError

_WIDTHS = ("WidthMax", "SensorWidth", "Width")
"""Features that tell how many columns a camera has; the first that is there counts."""
_HEIGHTS = ("HeightMax", "SensorHeight", "Height")
"""Likewise for the rows of an area camera."""


def check_output(out: Path, *, resume: bool) -> None:
    """Refuse a recording that is there already, or is not; best before the bench is opened."""
    if resume and not out.exists():
        msg = f"{out} does not exist, so there is nothing to resume; run the plan without --resume"
        raise RunRefusedError(msg, code="nothing-to-resume")
    if not resume and out.exists():
        msg = f"{out} exists already: go on with it by --resume, or name another output"
        raise InputError(msg, code="output-exists")


def camera_settings(plan: Plan, bench: Bench, exposure_us: float) -> CameraSettings:
    """Return what `plan` asks of the bench's camera for a block of `exposure_us`."""
    wanted, n_rows = plan.camera, _rows(plan, bench)
    return CameraSettings(
        exposure_us=exposure_us,
        line_period_us=wanted.line_period_us,
        frame_lines=plan.lines_per_frame if n_rows is None else plan.frame_lines or 1,
        n_columns=wanted.columns or _all_columns(bench) - wanted.first_column,
        first_column=wanted.first_column,
        n_rows=n_rows,
        first_row=wanted.first_row,
        pixel_format=wanted.pixel_format,
        gain_db=wanted.gain_db,
        black_level_dn=wanted.black_level_dn,
    )


def check_bench(plan: Plan, bench: Bench) -> None:
    """Raise RunRefusedError or InputError when this bench cannot do what `plan` asks."""
    check_levels(plan.levels(), bench.light.max_level, bench.id)
    serial = bench.camera.identity.serial
    if plan.camera.serial not in {"", serial}:
        msg = f"the plan is for camera {plan.camera.serial}, but camera {serial} is connected"
        raise RunRefusedError(msg, code="wrong-camera")
    if plan.interlocks.monitor_a is not None and bench.monitor is None:
        msg = "the plan has interlocks.monitor_a, but this bench has no monitor"
        raise RunRefusedError(msg, code="no-monitor")


def new_recording(
    plan: Plan, bench: Bench, out: Path, used: CameraSettings, clock: Clock
) -> RecordingWriter:
    """Start the recording of `plan`; raises InputError where `out` is there already."""
    camera = bench.camera
    header = recording_header(
        plan,
        columns=used.n_columns,
        rows=used.n_rows,
        first_column=used.first_column,
        first_row=used.first_row,
        sensor_columns=_known_columns(bench),
        sensor_rows=None if used.n_rows is None else _known_rows(bench),
        model=camera.identity.model,
        serial=camera.identity.serial,
        band=bench.camera_band,
        started_at=datetime.fromtimestamp(clock.wall(), UTC),
    )
    features = {**camera.features(), **_provenance(bench)}
    return RecordingWriter.create(
        out, header, used.frame_lines, plan=plan.dumps(), features=features
    )


def resumed_recording(plan: Plan, bench: Bench, out: Path, used: CameraSettings) -> RecordingWriter:
    """Go on with the recording `out`; raises RunRefusedError for another plan or camera."""
    _check_same(plan, bench, out, used)
    return RecordingWriter.resume(out)


def _provenance(bench: Bench) -> dict[str, str]:
    """Return who the bench's devices say they are, beside the camera's features."""
    devices = {"light": bench.light, "monitor": bench.monitor, "shutter": bench.shutter}
    who = {name: device.identity for name, device in devices.items() if device is not None}
    return {"bench": bench.id} | {
        f"bench.{name}": " ".join(part for part in (i.vendor, i.model, i.serial) if part)
        for name, i in who.items()
    }


def _all_columns(bench: Bench) -> int:
    known = _known_columns(bench)
    if known is None:
        msg = "this camera does not tell how many columns it has; put camera.columns into the plan"
        raise RunRefusedError(msg, code="columns-unknown")
    return known


def _known_columns(bench: Bench) -> int | None:
    return _told(bench, _WIDTHS) if bench.sensor_columns is None else bench.sensor_columns


def _known_rows(bench: Bench) -> int | None:
    return _told(bench, _HEIGHTS) if bench.sensor_rows is None else bench.sensor_rows


def _rows(plan: Plan, bench: Bench) -> int | None:
    """Return how many rows an area camera is to read out, None of a linescan camera."""
    rows = plan.camera.rows
    if rows is None:
        every = bench.sensor_rows
        if every is None and _is_area(bench):
            every = _told(bench, _HEIGHTS)
        rows = None if every is None else every - plan.camera.first_row
    return rows


def _is_area(bench: Bench) -> bool:
    """Ask once: a camera that was lost answers only when it is configured again."""
    if bench.is_area is None:
        bench.is_area = bench.camera.features().get("DeviceScanType") == "Areascan"
    return bench.is_area


def _told(bench: Bench, names: Sequence[str]) -> int | None:
    """Return the first of these features that holds a number."""
    features = bench.camera.features()
    numbers = (features[name] for name in names if features.get(name, "").isdecimal())
    return next(map(int, numbers), None)


def _check_same(plan: Plan, bench: Bench, out: Path, used: CameraSettings) -> None:
    begun = FileRecording(out)
    if not begun.provenance.plan:
        msg = f"{out} was not recorded by a plan, so it cannot be resumed with one"
        raise RunRefusedError(msg, code="plan-changed")
    if Plan.loads(begun.provenance.plan, where=f"the plan in {out}").digest() != plan.digest():
        msg = (
            f"{out} was begun with another plan; resume it with that one, or begin a new recording"
        )
        raise RunRefusedError(msg, code="plan-changed")
    camera = begun.header.camera
    serial = bench.camera.identity.serial
    if camera.serial != serial:
        msg = f"{out} was begun with camera {camera.serial}, but camera {serial} is connected"
        raise RunRefusedError(msg, code="wrong-camera")
    was = (camera.columns, camera.rows, begun.frame_lines)
    if was != (used.n_columns, used.n_rows, used.frame_lines):
        msg = (
            f"{out} has {_size(*was)}, but the camera now gives"
            f" {_size(used.n_columns, used.n_rows, used.frame_lines)}"
        )
        raise RunRefusedError(msg, code="wrong-camera")


def _size(columns: int, rows: int | None, frame_lines: int) -> str:
    if rows is not None:
        return f"{columns} columns and {rows} rows"
    return f"{columns} columns and {frame_lines} lines per frame"
