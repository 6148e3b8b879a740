"""A GigE Vision or USB3 Vision linescan camera behind the camera's port."""

import time
from collections.abc import Iterator, Mapping
from threading import RLock
from typing import Self

from drivers.aravis.arrived_frame import ArrivedFrame
from drivers.aravis.connection import Connection
from drivers.aravis.dump import all_features
from drivers.aravis.frame_stream import FrameStream, StreamOptions
from drivers.aravis.gi_errors import speaking
from drivers.aravis.settings import UNKNOWN_STEPS, RawSteps, SettingsWriter
from drivers.aravis.slow_reading import SlowReading
from drivers.aravis.stream_report import StreamReport
from drivers.errors import DeviceError, DeviceTimeoutError
from drivers.frame_losses import LossLimit
from drivers.ports import (
    CameraSettings,
    Cancelled,
    CapturedFrame,
    DeviceIdentity,
    LostFrame,
    never,
)

_SLICE_S = 0.1  # how soon a cancelled or broken acquisition is noticed


class AravisCamera:
    """One camera, one owner, one lock: Aravis' objects are not thread-safe.

    After `DeviceLostError`, `configure` tries to take control anew.
    """

    def __init__(
        self,
        address: str,
        *,
        packet_size: int | None = None,
        n_buffers: int = 16,
        frame_timeout_s: float = 2.0,
        raw_steps: RawSteps = UNKNOWN_STEPS,
    ) -> None:
        """Take control; see `open`."""
        self._address = address
        self._device = f"camera {address}"
        self._packet_size = packet_size
        self._n_buffers = n_buffers
        self._frame_timeout_s = frame_timeout_s
        self._raw_steps = raw_steps
        self._lock = RLock()
        self._settings: CameraSettings | None = None
        self._stream: FrameStream | None = None
        self._report = StreamReport()
        self._connection: Connection | None = Connection(address, self._device)
        self._identity = self._connection.identity
        self._temperature = SlowReading(self._read_temperature)
        self._stop_quietly(self._connection)

    @classmethod
    def open(
        cls,
        address: str,
        *,
        packet_size: int | None = None,
        n_buffers: int = 16,
        frame_timeout_s: float = 2.0,
        raw_steps: RawSteps = UNKNOWN_STEPS,
    ) -> Self:
        """Take control of the camera at `address`: an IP address, a host name or `Vendor-Serial`.

        Args:
            address: Where the camera is, or who.
            packet_size: GigE Vision packet size in bytes; None: what the link carries.
            n_buffers: Frames that may wait for the consumer.
            frame_timeout_s: How long beyond its period a frame may take.
            raw_steps: What steps of `GainRaw` and `BlackLevelRaw` are worth, where it has no other.

        Raises:
            DeviceNotFoundError: Nothing answers there.
            DeviceBusyError: Somebody else controls it.
            DeviceError: Aravis is not installed (code `aravis-missing`), or the user may not use
                the USB device (code `usb-permission`).
        """
        return cls(
            address,
            packet_size=packet_size,
            n_buffers=n_buffers,
            frame_timeout_s=frame_timeout_s,
            raw_steps=raw_steps,
        )

    @property
    def identity(self) -> DeviceIdentity:
        """Vendor, model, serial number, firmware."""
        return self._identity

    @property
    def stream_report(self) -> StreamReport:
        """What the receiving end counted over all acquisitions since the camera was opened."""
        return self._report

    def configure(self, wanted: CameraSettings) -> CameraSettings:
        """Apply `wanted`; return what the camera really uses, read back.

        Takes control anew where it was lost.

        Raises:
            SettingRefusedError: Names the feature, what was wanted and what was got.
            DeviceError: Code `camera-acquiring`, while frames are being taken.
        """
        with self._lock:
            self._must_be_idle()
            if self._connection is not None and self._connection.lost:
                self._connection.close()
                self._connection = Connection(self._address, self._device)
            connection = self._held()
            self._settings = None
            self._stop_quietly(connection)
            writer = SettingsWriter(connection.features, self._raw_steps)
            self._settings = writer.apply(wanted)
            return self._settings

    def frames(
        self, n_frames: int, cancelled: Cancelled = never
    ) -> Iterator[CapturedFrame | LostFrame]:
        """Yield frames until `n_frames` whole ones came; see `LinescanCamera.frames`."""
        settings, stream = self._start()
        limit = LossLimit(n_frames, self._device)
        whole = 0
        patience_s = settings.frame_lines * settings.line_period_us * 1e-6 + self._frame_timeout_s
        give_up_s = time.monotonic() + patience_s
        try:
            while whole < n_frames and not cancelled():
                with self._lock:
                    self._held()
                    arrived = stream.pop(_SLICE_S)
                if arrived is None:
                    if time.monotonic() > give_up_s:
                        raise self._no_frame(stream, patience_s)
                    continue
                for frame in arrived:
                    if isinstance(frame, LostFrame):
                        yield frame
                        limit.count_lost(_loss_hint(stream.report()))
                    else:
                        whole += 1
                        yield self._captured(frame, settings)
                give_up_s = time.monotonic() + patience_s
        finally:
            self._stop(stream)

    def temperature_c(self) -> float | None:
        """The sensor's temperature now, None where the camera does not tell."""
        with self._lock:
            self._held()
            return self._temperature.now()

    def features(self) -> Mapping[str, str]:
        """Every feature and its value, for provenance."""
        with self._lock:
            return all_features(self._held().camera)

    def close(self) -> None:
        """Release the camera; safe to call twice."""
        with self._lock:
            if self._stream is not None:
                self._stop(self._stream)
            if self._connection is not None:
                self._connection.close()
                self._connection = None

    def _start(self) -> tuple[CameraSettings, FrameStream]:
        with self._lock:
            self._must_be_idle()
            connection = self._held()
            if self._settings is None:
                raise self._error("is not configured; configure it first", "camera-not-configured")
            size = self._packet_size or connection.default_packet_size
            options = StreamOptions(size, self._n_buffers, connection.byte_order)
            stream = FrameStream(connection.camera, self._settings, options, self._device)
            self._stream = stream
            self._temperature.now()
            connection.set_locked(True)
            with speaking(self._device, "start its acquisition"):
                connection.camera.start_acquisition()
            return self._settings, stream

    def _stop(self, stream: FrameStream) -> None:
        """Stop the camera where it can still hear it, and close the stream; once only."""
        with self._lock:
            if self._stream is not stream:
                return
            self._stream = None
            if self._connection is not None:
                self._stop_quietly(self._connection)
            self._report += stream.close()

    def _stop_quietly(self, connection: Connection) -> None:
        """Stop an acquisition, ours or one that a dead client left; a lost camera has none."""
        if connection.lost:
            return
        try:
            with speaking(self._device, "stop its acquisition"):
                connection.camera.stop_acquisition()
            connection.set_locked(False)
        except DeviceTimeoutError as error:
            connection.lost_error(str(error))

    def _no_frame(self, stream: FrameStream, patience_s: float) -> DeviceError:
        """Tell a camera that is gone from one that answers but sends nothing."""
        with self._lock:
            connection = self._held()
            if not connection.answers():
                return connection.lost_error("it no longer answers")
        return DeviceTimeoutError(
            f"{self._device}: no frame within {patience_s:.1f} s, though it answers; does the "
            "firewall let its UDP stream pass, does the link carry the packet size, is a trigger "
            f"awaited? {_loss_hint(stream.report())}",
            device=self._device,
            code="frame-timeout",
        )

    def _captured(self, frame: ArrivedFrame, settings: CameraSettings) -> CapturedFrame:
        with self._lock:
            temperature_c = self._temperature.recent()
        return CapturedFrame(
            dn=frame.dn,
            frame_id=frame.frame_id,
            device_timestamp_ns=frame.device_timestamp_ns,
            host_timestamp_ns=frame.host_timestamp_ns,
            exposure_us=settings.exposure_us,
            gain_db=settings.gain_db,
            sensor_temperature_c=temperature_c,
        )

    def _read_temperature(self) -> float | None:
        connection = self._held()
        name = connection.temperature_name
        return None if name is None else connection.features.number(name)

    def _held(self) -> Connection:
        if self._connection is None:
            raise self._error("is closed; open it again", "device-closed")
        self._connection.must_hold()
        return self._connection

    def _must_be_idle(self) -> None:
        if self._stream is not None:
            raise self._error("is acquiring; end the acquisition first", "camera-acquiring")

    def _error(self, what: str, code: str) -> DeviceError:
        return DeviceError(f"{self._device}: {what}", device=self._device, code=code)


def _loss_hint(report: StreamReport) -> str:
    return (
        f"{report.missing_packets} packets missing after {report.resend_requests} resend requests, "
        f"{report.underruns} underruns"
    )
