"""A synchronous tone: interference that keeps its frequency with the camera's pixel clock.

Source: AgCam (Olsen et al. 2010), section 5: "known synchronous electronic noise effects" are
removed before the lines of an image are averaged.
"""

from dataclasses import dataclass

from calib.errors import InputError


@dataclass(frozen=True)
class Tone:
    """cos and sin of one known frequency; amplitude and phase are estimated frame by frame.

    In line j and column i the tone's phase is 2π·cycles_per_pixel·(j·pixels_per_line + i).

    Attributes:
        cycles_per_pixel: Frequency in cycles per pixel clock.
        pixels_per_line: Pixel clocks from one line's start to the next's, blanking included.
    """

    cycles_per_pixel: float
    pixels_per_line: float

    def __post_init__(self) -> None:
        if not (0 < abs(self.cycles_per_pixel) <= 0.5 and 0 < self.pixels_per_line < 1e9):
            raise InputError(
                f"a tone of {self.cycles_per_pixel} cycles per pixel clock and "
                f"{self.pixels_per_line} pixel clocks per line cannot be: give more than 0 and at "
                "most 0.5 cycles per clock",
                code="tone-invalid",
            )

    @classmethod
    def per_line(cls, cycles_per_line: float, pixels_per_line: float) -> "Tone":
        """Return the tone of `cycles_per_line` cycles in one line period."""
        return cls(cycles_per_line / pixels_per_line, pixels_per_line)

    @property
    def cycles_per_line(self) -> float:
        """Cycles from one line's start to the next's; whole ones are a part of the offset."""
        return self.cycles_per_pixel * self.pixels_per_line
