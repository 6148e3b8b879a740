"""What sets a linescan camera and an area camera apart: by which features they go."""

from collections.abc import Sequence
from dataclasses import dataclass

from drivers.aravis import feature_names as names


@dataclass(frozen=True)
class ScanKind:
    """A linescan camera is paced by its line rate, an area camera by its frame rate.

    Attributes:
        rate_hz: Names of the rate.
        rate_switch: What lets the camera follow it, where it has such a switch.
    """

    rate_hz: Sequence[str]
    rate_switch: str


LINESCAN = ScanKind(names.LINE_RATE_HZ, "AcquisitionLineRateEnable")
AREASCAN = ScanKind(names.FRAME_RATE_HZ, "AcquisitionFrameRateEnable")
