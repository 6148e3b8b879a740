"""What an effect is: one link of the chain from light to DN."""

from enum import IntEnum
from typing import ClassVar, Protocol

from numpy.random import Generator

from calib.arrays import Lines
from calib.forward.conditions import Conditions


class Stage(IntEnum):
    """Where an effect acts; the chain runs in this order. The signal's unit changes on the way."""

    SOURCE = 1  # radiance
    EXPOSURE = 2  # radiance x us
    PHOTONS = 3  # radiance x us in, expected electrons out
    CHARGE = 4  # electrons
    TRANSFER = 5  # electrons
    VOLTS = 6  # electrons in, DN out, not yet rounded
    CODES = 7  # codes
    TRANSPORT = 8  # codes


class Effect(Protocol):
    """A frozen dataclass: its parameters are its fields, with units, bounds and source."""

    name: ClassVar[str]
    """The name in the catalogue and in model files."""
    stage: ClassVar[Stage]
    stochastic: ClassVar[bool]
    """True where `apply` draws random numbers; left out of the noise-free signal."""

    def apply(self, signal: Lines, at: Conditions, rng: Generator) -> Lines:
        """Return the signal after this effect, (n_lines, n_columns); never change `signal`."""
        ...
