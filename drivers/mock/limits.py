"""What a simulated camera can be set to: ranges and steps, as a data sheet lists them.

The in-process camera and the GenICam description of the simulated GigE Vision camera are both
made from these figures, so that both refuse the same settings and round alike.
"""

from dataclasses import dataclass
from math import gcd

from drivers.pixel_formats import FORMATS, PACKED
from drivers.ports import PixelFormat


@dataclass(frozen=True)
class Span:
    """A setting runs from `low` to `high` in steps of `step`, in the setting's own unit."""

    low: float
    high: float
    step: float

    def holds(self, value: float) -> bool:
        """Whether `value` lies in the range, the ends included."""
        return self.low <= value <= self.high

    def rounded(self, value: float) -> float:
        """Return the nearest value that the device can take."""
        per_unit = round(1 / self.step) if self.step < 1 else 1 / self.step
        return round(value * per_unit) / per_unit


@dataclass(frozen=True)
class CameraLimits:
    """Ranges of a camera with `columns` pixels a line and an ADC of `bit_depth` bits.

    `rows` has an area camera alone.
    """

    columns: int
    bit_depth: int
    rows: int | None = None

    exposure_us = Span(0.1, 1_000_000.0, 0.01)
    """The line period caps it, too: a line, or frame, is read out while the next is exposed."""
    line_period_us = Span(1.0, 10_000_000.0, 0.01)
    gain_db = Span(0.0, 24.0, 0.01)
    black_level_dn = Span(0.0, 1000.0, 0.01)
    """In codes of the ADC, whatever the pixel format."""

    @property
    def frame_lines(self) -> Span:
        """An area camera's frame is one exposure."""
        return Span(1, 65535 if self.rows is None else 1, 1)

    @property
    def formats(self) -> tuple[PixelFormat, ...]:
        """Pixel formats; a frame of packed ones must have an even number of pixels."""
        even = self.column_step % 2 == 0
        return tuple(name for name in FORMATS if even or name not in PACKED)

    @property
    def column_step(self) -> int:
        """Width and offset go in steps of 8 columns where the sensor's width allows."""
        return gcd(self.columns, 8)
