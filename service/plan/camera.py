"""How the camera is set for the whole run, and what only a person knows of it."""

from pydantic import Field

from calib.recording.header import MOST_PIXELS, TapLayout
from drivers.ports import PixelFormat
from service.plan.part import PlanPart

_BITS: dict[PixelFormat, int] = {
    "Mono8": 8,
    "Mono10": 10,
    "Mono12": 12,
    "Mono12Packed": 12,
    "Mono12p": 12,
    "Mono14": 14,
    "Mono16": 16,
}


class PlanCamera(PlanPart):
    """Settings are applied and read back; the rest goes into the recording's header."""

    line_period_us: float = Field(gt=0)
    """From line to line; from frame to frame of an area camera, whose lines are its frames."""
    pixel_format: PixelFormat = "Mono12"
    columns: int | None = Field(default=None, gt=0, le=MOST_PIXELS)
    """How many are read out; None: all that the camera has."""
    first_column: int = Field(default=0, ge=0, lt=MOST_PIXELS)
    rows: int | None = Field(default=None, gt=0, le=MOST_PIXELS)
    """How many an area camera reads out; None: all that it has. A linescan camera has none."""
    first_row: int = Field(default=0, ge=0, lt=MOST_PIXELS)
    gain_db: float = 0.0
    black_level_dn: float = 0.0
    model: str = ""
    """Free text; empty: what the camera says of itself."""
    serial: str = ""
    """If given, the run refuses every other camera."""
    band: str = ""
    """Of its filter; empty: what the bench knows, as a simulated one does from its model."""
    taps: int = Field(default=1, ge=1)
    tap_layout: TapLayout = "single"

    @property
    def bit_depth(self) -> int:
        """Codes run 0 .. 2**bit_depth - 1."""
        return _BITS[self.pixel_format]
