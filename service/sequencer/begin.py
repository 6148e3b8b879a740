"""Begin a run or go on with one: do plan, bench and recording fit together?"""

from datetime import UTC, datetime
from pathlib import Path

from calib.recording.file_recording import FileRecording
from calib.recording.writer import RecordingWriter
from drivers.ports import CameraSettings
from service.bench.bench import Bench
from service.plan.header import recording_header
from service.plan.model import Plan
from service.sequencer.clock import Clock
from service.sequencer.errors import RunRefusedError

_WIDTHS = ("WidthMax", "SensorWidth", "Width")
"""Features that tell how many columns a camera has; the first that is there counts."""


def camera_settings(plan: Plan, bench: Bench, exposure_us: float) -> CameraSettings:
    """Return what `plan` asks of the bench's camera for a block of `exposure_us`."""
    wanted = plan.camera
    return CameraSettings(
        exposure_us=exposure_us,
        line_period_us=wanted.line_period_us,
        frame_lines=plan.lines_per_frame,
        n_columns=wanted.columns or _all_columns(bench) - wanted.first_column,
        first_column=wanted.first_column,
        pixel_format=wanted.pixel_format,
        gain_db=wanted.gain_db,
        black_level_dn=wanted.black_level_dn,
    )


def check_bench(plan: Plan, bench: Bench) -> None:
    """Raise RunRefusedError when this bench cannot do what `plan` asks."""
    highest = max(plan.levels())
    if highest > bench.light.max_level:
        msg = (
            f"the plan asks for level {highest:g}, but the light of bench {bench.id!r} goes to"
            f" {bench.light.max_level:g}"
        )
        raise RunRefusedError(msg, code="level-out-of-range")
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
    if not out.exists():
        msg = f"{out} does not exist, so there is nothing to resume; run the plan without --resume"
        raise RunRefusedError(msg, code="nothing-to-resume")
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
    if bench.sensor_columns is not None:
        return bench.sensor_columns
    features = bench.camera.features()
    for name in _WIDTHS:
        if features.get(name, "").isdecimal():
            return int(features[name])
    msg = "this camera does not tell how many columns it has; put camera.columns into the plan"
    raise RunRefusedError(msg, code="columns-unknown")


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
    if camera.columns != used.n_columns or begun.frame_lines != used.frame_lines:
        msg = (
            f"{out} has {camera.columns} columns and {begun.frame_lines} lines per frame, but the"
            f" camera now gives {used.n_columns} and {used.frame_lines}"
        )
        raise RunRefusedError(msg, code="wrong-camera")
