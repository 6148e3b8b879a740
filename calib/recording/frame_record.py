"""What is known of one frame when it is committed: the camera's count, clocks, read-backs."""

from dataclasses import asdict, dataclass, fields
from typing import Any


@dataclass(frozen=True)
class FrameRecord:
    """Read back around one frame; None is unknown, not 0.

    Attributes:
        frame_id: The camera's own count.
        device_timestamp_ns: The camera's clock.
        host_timestamp_ns: The host's clock when the frame was complete, Unix time.
        exposure_us: Exposure time read back from the camera.
        gain_db: The camera's gain setting read back.
        level: The number of lamps that burn or the LED's setting, read back.
        lamp_currents_a: Each lamp's current, read back; empty where not read.
        monitor_a: The monitor photodiode's current.
        sensor_temperature_c: The sensor's temperature.
    """

    frame_id: int | None = None
    device_timestamp_ns: int | None = None
    host_timestamp_ns: int | None = None
    exposure_us: float | None = None
    gain_db: float | None = None
    level: float | None = None
    lamp_currents_a: tuple[float, ...] = ()
    monitor_a: float | None = None
    sensor_temperature_c: float | None = None

    def to_json(self) -> dict[str, Any]:
        """Return the fields as JSON knows them, in their order."""
        return asdict(self)

    @classmethod
    def from_json(cls, entry: dict[str, Any]) -> "FrameRecord":
        """Return the record in `entry`; keys of the commit itself are left out."""
        known = {f.name: entry[f.name] for f in fields(cls) if f.name in entry}
        return cls(**{**known, "lamp_currents_a": tuple(known.get("lamp_currents_a") or ())})


@dataclass(frozen=True)
class CommittedFrame:
    """One frame whose line stands in the commit record.

    Attributes:
        index: Where it lies in the file's `frames`.
        block: Its block's name.
        lines: How many of its lines (an area sensor's frames) are real; the last may be short.
        crc32: CRC-32 of the codes of these lines, little-endian, in C order.
        record: What was read back.
    """

    index: int
    block: str
    lines: int
    crc32: int
    record: FrameRecord
