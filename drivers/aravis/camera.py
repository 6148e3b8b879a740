"""A GigE Vision or USB3 Vision linescan camera behind the camera's port."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from threading import RLock
from typing import Self

from drivers.aravis.acquisition import Acquisition
from drivers.aravis.connection import Connection
from drivers.aravis.dump import all_features
from drivers.aravis.frame_stream import StreamOptions
from drivers.aravis.settings import UNKNOWN_STEPS, RawSteps, SettingsWriter
from drivers.aravis.slow_reading import SlowReading
from drivers.aravis.stream_report import StreamReport
from drivers.errors import DeviceError, DeviceLostError, DeviceTimeoutError
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


@dataclass(frozen=True)
class Options:
    """What `AravisCamera.open` was told."""

    packet_size: int | None
    n_buffers: int | None
    frame_timeout_s: float
    raw_steps: RawSteps


class AravisCamera:
    """One camera, one owner, one lock: Aravis' objects are not thread-safe.

    After `DeviceLostError`, `configure` tries to take control anew.
    """

    def __init__(self, address: str, options: Options) -> None:
        """Take control; see `open`."""
        self._address = address
        self._device = f"camera {address}"
        self._options = options
        self._lock = RLock()
        self._settings: CameraSettings | None = None
        self._acquisition: Acquisition | None = None
        self._report = StreamReport()
        self._closed = False
        self._connection: Connection | None = Connection(address, self._device)
        self._identity = self._connection.identity
        self._temperature = SlowReading(self._read_temperature)
        self._connection.stop_acquisition()

    @classmethod
    def open(
        cls,
        address: str,
        *,
        packet_size: int | None = None,
        n_buffers: int | None = None,
        frame_timeout_s: float = 2.0,
        raw_steps: RawSteps = UNKNOWN_STEPS,
    ) -> Self:
        """Take control of the camera at `address`: an IP address, a host name or `Vendor-Serial`.

        Args:
            address: Where the camera is, or who.
            packet_size: GigE Vision packet size in bytes; None: what the link carries.
            n_buffers: Frames that may wait for the consumer; None: a second of them, if memory
                allows.
            frame_timeout_s: How long beyond its period a frame may take.
            raw_steps: What steps of `GainRaw` and `BlackLevelRaw` are worth, where it has no other.

        Raises:
            DeviceNotFoundError: Nothing answers there.
            DeviceBusyError: Somebody else controls it.
            DeviceError: Aravis is not installed (code `aravis-missing`), or the user may not use
                the USB device (code `usb-permission`).
        """
        return cls(address, Options(packet_size, n_buffers, frame_timeout_s, raw_steps))

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
            self._settings = None
            connection = self._reconnected()
            connection.stop_acquisition()
            writer = SettingsWriter(connection.features, self._options.raw_steps)
            self._settings = writer.apply(wanted)
            return self._settings

    def frames(
        self, n_frames: int, cancelled: Cancelled = never
    ) -> Iterator[CapturedFrame | LostFrame]:
        """Yield frames until `n_frames` whole ones came; see `LinescanCamera.frames`."""
        acquisition = self._start()
        limit = LossLimit(n_frames, self._device)
        whole = 0
        try:
            while whole < n_frames and not cancelled():
                with self._lock:
                    self._held()
                    arrived = acquisition.next(_SLICE_S)
                    hint = acquisition.loss_hint()
                for frame in arrived:
                    if isinstance(frame, LostFrame):
                        yield frame
                        limit.count_lost(hint)
                    else:
                        whole += 1
                        with self._lock:
                            temperature_c = self._temperature.recent()
                        yield frame.captured(acquisition.settings, temperature_c)
        finally:
            self._stop(acquisition)

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
            self._closed = True
            if self._acquisition is not None:
                self._stop(self._acquisition)
            if self._connection is not None:
                self._connection.close()
                self._connection = None

    def _start(self) -> Acquisition:
        with self._lock:
            self._must_be_idle()
            connection = self._held()
            if self._settings is None:
                raise self._error("is not configured; configure it first", "camera-not-configured")
            self._temperature.now()
            size = self._options.packet_size or connection.default_packet_size
            stream = StreamOptions(size, self._options.n_buffers, connection.byte_order)
            self._acquisition = Acquisition(
                connection, self._settings, stream, self._options.frame_timeout_s
            )
            return self._acquisition

    def _stop(self, acquisition: Acquisition) -> None:
        """Stop it, once only: the iterator and `close` both do."""
        with self._lock:
            if self._acquisition is acquisition:
                self._acquisition = None
                self._report += acquisition.stop()

    def _read_temperature(self) -> float | None:
        connection = self._held()
        name = connection.temperature_name
        if name is None:
            return None
        try:
            return connection.features.number(name)
        except DeviceTimeoutError as error:  # after five tries: there is nobody any more
            raise connection.lost_error("it no longer answers") from error

    def _reconnected(self) -> Connection:
        """Return the connection, taken anew where control was lost."""
        if self._connection is not None and self._connection.lost:
            self._connection.close()
            self._connection = None
        if self._connection is None and not self._closed:
            self._connection = Connection(self._address, self._device)
        return self._held()

    def _held(self) -> Connection:
        if self._closed:
            raise self._error("is closed; open it again", "device-closed")
        if self._connection is None:
            raise DeviceLostError(
                f"{self._device}: lost, and not found again yet; configure it to try once more",
                device=self._device,
                code="control-lost",
            )
        self._connection.must_hold()
        return self._connection

    def _must_be_idle(self) -> None:
        if self._acquisition is not None:
            raise self._error("is acquiring; end the acquisition first", "camera-acquiring")

    def _error(self, what: str, code: str) -> DeviceError:
        return DeviceError(f"{self._device}: {what}", device=self._device, code=code)
