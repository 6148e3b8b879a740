"""Lamp drift: the source brightens or fades with wall time.

Source: the slow approach of a filament lamp or LED to its thermal equilibrium, first order; with
a time constant much longer than the recording, linear ageing.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import ClassVar

from numpy.random import Generator

from calib.arrays import Columns, Lines, by_line
from calib.forward.conditions import Conditions
from calib.forward.departure import Departure, Statistic, Variable
from calib.forward.drift import settled
from calib.forward.effect import Stage
from calib.forward.parameter import parameter
from calib.forward.plan_needs import any_of, first_lack, flats, repeated_flats, signals
from calib.recording.header import Block, CameraHeader


@dataclass(frozen=True)
class LampDrift(Departure):
    """Scale the radiance by 1 + amplitude (1 - exp(-time / time_constant)).

    Attributes:
        amplitude: Relative change, reached long after the recording's start.
        time_constant_s: How fast it is reached; wall time counts from the recording's start.
    """

    name: ClassVar[str] = "lamp_drift"
    stage: ClassVar[Stage] = Stage.SOURCE
    stochastic: ClassVar[bool] = False
    separable: ClassVar[bool] = True
    physics: ClassVar[str] = (
        "The lamp brightens or fades with wall time: L -> L (1 + a (1 - exp(-t/T)))."
    )
    shows_in: ClassVar[Statistic] = "mean"
    depends_on: ClassVar[tuple[Variable, ...]] = ("time", "level")
    any_law: ClassVar[Variable | None] = "time"

    amplitude: float = parameter(0.01, unit="1", low=-0.9, high=10.0, neutral=0.0)
    time_constant_s: float = parameter(300.0, unit="s", low=1e-3, high=1e9)

    def apply(self, signal: Lines, at: Conditions, rng: Generator) -> Lines:
        """Radiance in, radiance out, (n_lines, *sample)."""
        return signal * by_line(self.line_factor(at, rng), signal.ndim)

    def line_factor(self, at: Conditions, rng: Generator) -> Columns:  # noqa: ARG002
        """Return the relative radiance at each line's time, (n_lines,)."""
        return 1.0 + self.amplitude * settled(at.line_times_s, self.time_constant_s)

    @classmethod
    def why_not_testable(cls, blocks: Sequence[Block], camera: CameraHeader) -> str | None:  # noqa: ARG003
        """Return what `blocks` lack: light at two times that can be compared."""
        return first_lack(flats(blocks), any_of(repeated_flats(blocks), signals(blocks, 3)))
