"""Nonlinearity: the output stage bends, DN = s (1 - beta s).

Source: the second-order term of an output amplifier's characteristic; EMVA Standard 1288, Release
4.0 Linear, section on linearity, measures it.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import ClassVar

from numpy.random import Generator

from calib.arrays import Lines
from calib.forward.conditions import Conditions
from calib.forward.departure import Departure, Statistic, Variable
from calib.forward.effect import Stage
from calib.forward.parameter import parameter
from calib.forward.plan_needs import signals
from calib.recording.header import Block, CameraHeader


@dataclass(frozen=True)
class Nonlinearity(Departure):
    """Bend the signal above the offset.

    Attributes:
        beta_per_dn: Relative loss of signal per DN of signal; negative where it gains.
    """

    name: ClassVar[str] = "nonlinearity"
    stage: ClassVar[Stage] = Stage.VOLTS
    stochastic: ClassVar[bool] = False
    by_signal: ClassVar[bool] = True
    physics: ClassVar[str] = "The output stage bends: DN = s (1 - beta s) of a signal s."
    shows_in: ClassVar[Statistic] = "mean"
    depends_on: ClassVar[tuple[Variable, ...]] = ("signal",)
    smooth_law: ClassVar[Variable | None] = "signal"

    beta_per_dn: float = parameter(2e-6, unit="1/DN", low=-1e-2, high=1e-2, neutral=0.0)

    def apply(self, signal: Lines, at: Conditions, rng: Generator) -> Lines:  # noqa: ARG002
        """DN above the offset in and out, (n_lines, *sample)."""
        return signal * (1.0 - self.beta_per_dn * signal)

    @classmethod
    def why_not_testable(cls, blocks: Sequence[Block], camera: CameraHeader) -> str | None:  # noqa: ARG003
        """Return what `blocks` lack: signals that a straight line may miss."""
        return signals(blocks, 3)
