"""What the service asks of devices. Blocking by design: the service moves calls to a thread.

Every device has one owner. A method may be called from any thread, one at a time; each adapter
holds a lock. Errors are those of `drivers.errors`.
"""

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field
from typing import Literal, Protocol

from calib.arrays import RawLines

PixelFormat = Literal["Mono8", "Mono10", "Mono12", "Mono12Packed", "Mono12p", "Mono14", "Mono16"]

Cancelled = Callable[[], bool]
"""Asked between steps of long work; True ends it early."""


def never() -> bool:
    """Return False: work that nobody cancels."""
    return False


@dataclass(frozen=True)
class DeviceIdentity:
    """Who a device says it is."""

    vendor: str
    model: str
    serial: str
    firmware: str = ""
    address: str = ""


@dataclass(frozen=True)
class CameraSettings:
    """What a camera can be asked for.

    A frame is `frame_lines` lines; `n_columns` from `first_column` on are read out. An area camera
    exposes `n_rows` rows from `first_row` on all at once: a frame is then one exposure, as a line
    is, so that `frame_lines` is 1 and `line_period_us` the time from frame to frame.
    """

    exposure_us: float
    line_period_us: float
    frame_lines: int
    n_columns: int
    first_column: int = 0
    n_rows: int | None = None
    """Of an area camera; None of a linescan camera."""
    first_row: int = 0
    pixel_format: PixelFormat = "Mono12"
    gain_db: float = 0.0
    black_level_dn: float = 0.0

    @property
    def frame_shape(self) -> tuple[int, int]:
        """(frame_lines, n_columns), or (n_rows, n_columns) of an area camera."""
        height = self.frame_lines if self.n_rows is None else self.n_rows
        return (height, self.n_columns)


@dataclass(frozen=True)
class CapturedFrame:
    """One whole frame as the camera sent it.

    Attributes:
        dn: Of the settings' `frame_shape`, uint8 or uint16, the caller's own copy.
        frame_id: The camera's own count.
        device_timestamp_ns: The camera's clock.
        host_timestamp_ns: This machine's clock when the frame was complete, Unix time.
        exposure_us, gain_db: Read back from the camera.
        sensor_temperature_c: None where the camera does not tell.
    """

    dn: RawLines
    frame_id: int
    device_timestamp_ns: int
    host_timestamp_ns: int
    exposure_us: float
    gain_db: float
    sensor_temperature_c: float | None = None


@dataclass(frozen=True)
class LostFrame:
    """A frame that did not arrive whole; it is never padded, and another is taken for it."""

    frame_id: int | None
    reason: str


class LinescanCamera(Protocol):
    """A camera that delivers frames of lines."""

    @property
    def identity(self) -> DeviceIdentity:
        """Vendor, model, serial number."""
        ...

    def configure(self, wanted: CameraSettings) -> CameraSettings:
        """Apply `wanted`; return what the camera really uses, read back."""
        ...

    def frames(
        self, n_frames: int, cancelled: Cancelled = never
    ) -> Iterator[CapturedFrame | LostFrame]:
        """Yield frames until `n_frames` whole ones came; lost ones are named and taken again.

        Closing the iterator stops the acquisition. Raises DeviceTimeoutError when no frame comes
        in time, DeviceLostError when the camera is gone, DeviceError with code `frames-lost` when
        more are lost than a sound link loses.
        """
        ...

    def temperature_c(self) -> float | None:
        """The sensor's temperature, None where the camera does not tell."""
        ...

    def features(self) -> Mapping[str, str]:
        """Every feature and its value, for provenance."""
        ...

    def close(self) -> None:
        """Release the device; safe to call twice."""
        ...


@dataclass(frozen=True)
class LampState:
    """One lamp or LED channel, read back."""

    on: bool
    current_a: float
    voltage_v: float | None = None
    hours: float | None = None
    """Lamp hours counted so far, where counted."""


@dataclass(frozen=True)
class LightState:
    """The source, read back. `level` is the number of lamps that burn or the LED's setting."""

    level: float
    lamps: tuple[LampState, ...] = field(default=())


class LightSource(Protocol):
    """A source with levels: N lamps in steps, or an LED's setting."""

    @property
    def identity(self) -> DeviceIdentity:
        """Vendor, model, serial number of the controller (the first of several)."""
        ...

    @property
    def max_level(self) -> float:
        """The number of lamps, or the LED's highest setting."""
        ...

    def set_level(self, level: float, cancelled: Cancelled = never) -> LightState:
        """Burn at `level`, ramping as the lamps need; return what was read back."""
        ...

    def state(self) -> LightState:
        """Read every lamp back; DeviceError `switched-off` where an order to go off ends it."""
        ...

    def order_off(self) -> None:
        """Tell everything to go off at once, at any moment, and wait for no answer.

        Whoever calls it reads back by `off`, which tells it once more: this may have been lost.
        """
        ...

    def off(self) -> LightState:
        """Switch everything off at once, at any moment, and read it back.

        Raises DeviceError naming every lamp that could not be read back as off.
        """
        ...

    def close(self) -> None:
        """Release the line; the lamps stay as they are. Safe to call twice."""
        ...


@dataclass(frozen=True)
class MonitorReading:
    """The monitor photodiode's current."""

    current_a: float
    host_timestamp_ns: int


class Monitor(Protocol):
    """Watches the source."""

    @property
    def identity(self) -> DeviceIdentity:
        """Vendor, model, serial number."""
        ...

    def read(self) -> MonitorReading:
        """Measure once; raises DeviceError with code `monitor-overflow` when out of range."""
        ...

    def close(self) -> None:
        """Release the line; safe to call twice."""
        ...


class Shutter(Protocol):
    """Caps the camera for darks."""

    @property
    def identity(self) -> DeviceIdentity:
        """Vendor, model, serial number."""
        ...

    def set_capped(self, capped: bool) -> None:
        """Move, return once it is there; SettingRefusedError when it reads back otherwise."""
        ...

    def close(self) -> None:
        """Release the line; safe to call twice."""
        ...
