"""Take one block: its frames to the recording, its conditions read back."""

from collections.abc import Callable, Iterator
from contextlib import closing, nullcontext
from dataclasses import dataclass
from typing import Any

from calib.recording.frame_record import FrameRecord
from calib.recording.header import Block
from calib.recording.writer import RecordingWriter
from drivers.errors import DeviceError
from drivers.ports import CameraSettings, Cancelled, CapturedFrame, LinescanCamera, LostFrame
from service.plan.step import Step
from service.sequencer.columns import ColumnLook, column_mean
from service.sequencer.errors import RunCancelledError
from service.sequencer.events import LiveColumns, OnColumns
from service.sequencer.look_ahead import BRIGHTEST_KEY
from service.sequencer.read_back import ReadBack, mean

_LOST_UNJUDGED = 3
"""So few lost frames say nothing about the link."""


@dataclass
class Counts:
    """Frames of this attempt."""

    frames: int = 0
    lost: int = 0


class Exposure:
    """Takes blocks with one camera into one recording."""

    def __init__(
        self,
        camera: LinescanCamera,
        writer: RecordingWriter,
        *,
        cancelled: Cancelled,
        max_lost_percent: float,
        on_frame: Callable[[], None],
        on_columns: OnColumns | None,
    ) -> None:
        self._camera = camera
        self._writer = writer
        self._cancelled = cancelled
        self._max_lost = max_lost_percent / 100
        self._on_frame = on_frame
        self._on_columns = on_columns
        self._is_area = writer.header.camera.rows is not None
        self.counts = Counts()

    def take(self, step: Step, settings: CameraSettings, before: ReadBack) -> ColumnLook:
        """Commit every frame of `step`; the block stays open for what is read back after it.

        Raises:
            RunCancelledError: Cancelled; what is committed of the block will be done again.
            DeviceError: What the camera raises, or `frames-lost`.
        """
        look = ColumnLook()
        wanted = -(-step.lines // settings.frame_lines)
        whole = lost = 0
        self._writer.begin_block(step.block)
        stream = self._camera.frames(wanted, self._cancelled)
        with _closed_afterwards(stream):
            for frame in stream:
                if isinstance(frame, LostFrame):
                    lost += 1
                    self._lose(step, frame, lost, whole)
                else:
                    whole += 1
                    self._keep(step, frame, before, look)
                self._on_frame()
        if whole < wanted:
            if self._cancelled():
                raise RunCancelledError
            raise self._too_few(step, whole, wanted)
        return look

    def _keep(self, step: Step, frame: CapturedFrame, before: ReadBack, look: ColumnLook) -> None:
        mean_dn = column_mean(frame.dn)
        self._writer.append(frame.dn, _record(frame, before))
        self.counts.frames += 1
        look.add(frame.dn if self._is_area else mean_dn)
        if self._on_columns is not None:
            self._on_columns(LiveColumns(step.block.block, mean_dn))

    def _lose(self, step: Step, frame: LostFrame, lost: int, whole: int) -> None:
        self._writer.lost(step.block.block, frame.reason, frame.frame_id)
        self.counts.lost += 1
        if lost > _LOST_UNJUDGED and lost > self._max_lost * (lost + whole):
            raise DeviceError(
                f"{lost} of {lost + whole} frames of block {step.block.block} were lost"
                f" (the last: {frame.reason}); mend the link or lower the rate, then resume",
                device=self._camera.identity.address or "camera",
                code="frames-lost",
            )

    def _too_few(self, step: Step, whole: int, wanted: int) -> DeviceError:
        return DeviceError(
            f"the camera ended after {whole} of {wanted} frames of block {step.block.block};"
            " look at the camera, then resume",
            device=self._camera.identity.address or "camera",
            code="frames-missing",
        )


def conditions(
    step: Step,
    used: CameraSettings,
    before: ReadBack,
    after: ReadBack,
    *,
    started_s: float,
    brightest_dn: float,
) -> Block:
    """Return the block as it was: read back, not as planned."""
    more: dict[str, Any] = {
        "gain_db": used.gain_db,
        "lamp_currents_a": list(after.lamp_currents_a),
        "level_read_back": after.light.level,
        "monitor_before_a": before.monitor_a,
        "monitor_after_a": after.monitor_a,
        BRIGHTEST_KEY: brightest_dn,
    }
    known: dict[str, Any] = {
        **step.block.model_dump(),
        "exposure_us": used.exposure_us,
        "started_s": started_s,
        "sensor_temperature_c": mean(before.temperature_c, after.temperature_c),
        "monitor": mean(before.monitor_a, after.monitor_a),
        "lines": step.lines,
    }
    return Block(**known, **more)


def _record(frame: CapturedFrame, before: ReadBack) -> FrameRecord:
    return FrameRecord(
        frame_id=frame.frame_id,
        device_timestamp_ns=frame.device_timestamp_ns,
        host_timestamp_ns=frame.host_timestamp_ns,
        exposure_us=frame.exposure_us,
        gain_db=frame.gain_db,
        level=before.light.level,
        lamp_currents_a=before.lamp_currents_a,
        monitor_a=before.monitor_a,
        sensor_temperature_c=frame.sensor_temperature_c,
    )


def _closed_afterwards(stream: Iterator[Any]) -> Any:
    return closing(stream) if hasattr(stream, "close") else nullcontext()
