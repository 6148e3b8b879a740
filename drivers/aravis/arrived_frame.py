"""A frame that came whole, before the settings read back are put beside it."""

from dataclasses import dataclass

from calib.arrays import RawLines


@dataclass(frozen=True)
class ArrivedFrame:
    """Pixels and times of one frame.

    Attributes:
        dn: (frame_lines, n_columns), our own copy.
        frame_id: The camera's own count.
        device_timestamp_ns: The camera's clock.
        host_timestamp_ns: This machine's clock when the frame began to arrive, Unix time.
    """

    dn: RawLines
    frame_id: int
    device_timestamp_ns: int
    host_timestamp_ns: int
