"""Gain drift: the system gain rises or falls with wall time.

Source: Janesick, Photon Transfer (2007), on the stability of the signal chain; first order, as
`calib.forward.drift` has it. Unlike a lamp's, the drift scales noise as it scales signal: the
ratio of variance to mean follows it.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import ClassVar

from numpy.random import Generator

from calib.arrays import Lines, by_line
from calib.forward.conditions import Conditions
from calib.forward.departure import Departure, Statistic, Variable
from calib.forward.drift import settled
from calib.forward.effect import Stage
from calib.forward.parameter import parameter
from calib.forward.plan_needs import several_flats
from calib.recording.header import Block, CameraHeader


@dataclass(frozen=True)
class GainDrift(Departure):
    """Scale signal and read noise by 1 + amplitude (1 - exp(-time / time_constant)).

    Attributes:
        amplitude: Relative change of the system gain, reached long after the recording's start.
        time_constant_s: How fast it is reached; wall time counts from the recording's start.
    """

    name: ClassVar[str] = "gain_drift"
    stage: ClassVar[Stage] = Stage.VOLTS
    stochastic: ClassVar[bool] = False
    physics: ClassVar[str] = (
        "The system gain drifts with wall time: K -> K (1 + a (1 - exp(-t/T))), noise with it."
    )
    shows_in: ClassVar[Statistic] = "mean"
    depends_on: ClassVar[tuple[Variable, ...]] = ("time", "signal")
    any_law: ClassVar[Variable | None] = "time"

    amplitude: float = parameter(0.01, unit="1", low=-0.9, high=10.0, neutral=0.0)
    time_constant_s: float = parameter(300.0, unit="s", low=1e-3, high=1e9)

    @classmethod
    def why_not_testable(cls, blocks: Sequence[Block], camera: CameraHeader) -> str | None:  # noqa: ARG003
        """Return what a recording lacks to show the drift; None where it could."""
        return several_flats(blocks, 2)

    def apply(self, signal: Lines, at: Conditions, rng: Generator) -> Lines:  # noqa: ARG002
        """DN above the offset in and out, (n_lines, *sample)."""
        share = settled(at.line_times_s, self.time_constant_s)
        return signal * by_line(1.0 + self.amplitude * share, signal.ndim)
