"""An empirical term: what a recording showed and no effect of the catalogue explains.

Source: none. It is a description, not physics: a piecewise linear function of one variable, fitted
to the means that a diagnosis left over. It has no name of its own, is never looked for, and says
nothing beyond the range in which it was fitted, where its ends are held.
"""

from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from numpy.random import Generator

from calib.arrays import Lines, by_line
from calib.errors import InputError
from calib.forward.conditions import Conditions
from calib.forward.effect import Effect, Stage
from calib.forward.parameter import parameter

FOLLOWS = ("signal", "time", "exposure", "level", "temperature")


@dataclass(frozen=True)
class Empirical(Effect):
    """Add a piecewise linear function of what it follows, DN, to the signal above the offset.

    Attributes:
        follows: The variable: signal in DN above the offset, time in s since the recording's
            start, exposure in us, level, temperature of the sensor in degrees Celsius.
        at: Its values at the knots, ascending.
        add_dn: What is added there; none where nothing is.
    """

    name: ClassVar[str] = "empirical"
    stage: ClassVar[Stage] = Stage.VOLTS
    stochastic: ClassVar[bool] = False

    follows: str = parameter("signal", unit="", choices=FOLLOWS)
    at: tuple[float, ...] = parameter((0.0, 1000.0), unit="that of what it follows")
    add_dn: tuple[float, ...] = parameter((0.0, 1.0), unit="DN", low=-1e5, high=1e5, neutral=())

    def __post_init__(self) -> None:
        """Raise InputError where the knots are not ascending, or not as many as the values."""
        super().__post_init__()
        if not self.add_dn:
            return
        if len(self.at) != len(self.add_dn) or not np.all(np.diff(self.at) > 0):
            msg = f"effect {self.name}: give as many ascending values of at as of add_dn."
            raise InputError(msg, code="parameter-out-of-bounds")

    @property
    def depends_on(self) -> tuple[str, ...]:
        """What it follows, as departures tell it."""
        return (self.follows,)

    def apply(self, signal: Lines, at: Conditions, rng: Generator) -> Lines:  # noqa: ARG002
        """DN above the offset in and out, (n_lines, *sample)."""
        if not self.add_dn:
            return signal + 0.0
        if self.follows == "signal":
            return signal + np.interp(signal, self.at, self.add_dn)
        values = {
            "time": at.line_times_s,
            "exposure": np.full(at.n_lines, at.exposure_us),
            "level": np.full(at.n_lines, at.level),
            "temperature": np.full(at.n_lines, at.sensor_temperature_c),
        }[self.follows]
        return signal + by_line(np.interp(values, self.at, self.add_dn), signal.ndim)
