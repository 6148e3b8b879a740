"""What an effect is: one link of the chain from light to DN.

Adding one takes two steps: a file in `calib/forward/effects/` with a frozen dataclass derived from
`Effect`, every field made by `parameter`, and one line at its physical place in
`calib/forward/effects/catalogue.py`. Reading and writing model files and the catalogue's tests
then hold for it. `apply` sees all lines of one draw, in the order of time, so an effect may carry
charge from line to line; from draw to draw, see `calib.forward.remembering`. Its zero strength is
told by the parameters' `neutral` values.

The axes of a signal are (n_lines, *sample): a line sensor's sample is a line, an area sensor's a
frame, whose pixels are all exposed at one time. An effect of single pixels need not know which; one
of rows, of taps or of the optics tells by the number of axes.
"""

from abc import ABC, abstractmethod
from enum import IntEnum
from typing import ClassVar

from numpy.random import Generator

from calib.arrays import Columns, Lines
from calib.forward.conditions import Conditions
from calib.forward.parameter import check_parameters
from calib.recording.header import CameraHeader


class Stage(IntEnum):
    """Where an effect acts; the chain runs in this order. The signal's unit changes on the way."""

    SOURCE = 1  # radiance; the chain multiplies by the exposure time on leaving this stage
    EXPOSURE = 2  # radiance x us
    PHOTONS = 3  # radiance x us in, expected electrons out
    CHARGE = 4  # electrons
    TRANSFER = 5  # electrons
    VOLTS = 6  # electrons in, DN out, not yet rounded
    CODES = 7  # codes
    TRANSPORT = 8  # codes


class Effect(ABC):
    """A frozen dataclass: its parameters are its fields, with units, bounds and source."""

    name: ClassVar[str]
    """The name in the catalogue and in model files."""
    stage: ClassVar[Stage]
    stochastic: ClassVar[bool]
    """True where `apply` draws random numbers; left out of the noise-free signal."""
    separable: ClassVar[bool] = False
    """True where `apply` is affine in the light and alike on every line but for `line_factor`.

    Such an effect also takes a single line, (1, *sample), for all. A chain of them never needs
    the expected electrons by line and pixel.
    """

    adds_light: ClassVar[bool] = False
    """True where `apply` adds light that earlier links' `line_factor` does not scale."""

    by_signal: ClassVar[bool] = False
    """True where `apply` looks at the signal alone: lines of any conditions may go together."""

    def __post_init__(self) -> None:
        """Raise InputError where a parameter lies outside its bounds."""
        check_parameters(self, f"effect {self.name}")

    @abstractmethod
    def apply(self, signal: Lines, at: Conditions, rng: Generator) -> Lines:
        """Return the signal after this effect, (n_lines, *sample); never change `signal`."""

    def line_factor(self, at: Conditions, rng: Generator) -> Columns | None:  # noqa: ARG002
        """Return the factor by which a separable effect scales each line's light, (n_lines,).

        None, the usual case, where all lines are alike. Where it is not None, the effect does
        nothing else.
        """
        return None

    def conditions_after(self, at: Conditions) -> Conditions:
        """Return the conditions that later links see: a wrong exposure also gathers dark charge."""
        return at

    def check_camera(self, camera: CameraHeader) -> None:  # noqa: B027
        """Raise InputError where the parameters do not fit `camera`; most fit any."""
