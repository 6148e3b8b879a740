"""Offset drift: the level of no charge rises or falls with wall time.

Source: Olsen et al., Radiometric calibration for AgCam (2010), whose dark offset is taken anew for
each calibration; first order, as `calib.forward.drift` has it.
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
from calib.forward.plan_needs import several_blocks
from calib.recording.header import Block, CameraHeader


@dataclass(frozen=True)
class OffsetDrift(Departure):
    """Add amplitude (1 - exp(-time / time_constant)).

    Attributes:
        amplitude_dn: Reached long after the recording's start.
        time_constant_s: How fast it is reached; wall time counts from the recording's start.
    """

    name: ClassVar[str] = "offset_drift"
    stage: ClassVar[Stage] = Stage.VOLTS
    stochastic: ClassVar[bool] = False
    physics: ClassVar[str] = (
        "The offset drifts with wall time, in darks and flats alike: + a (1 - exp(-t/T))."
    )
    shows_in: ClassVar[Statistic] = "mean"
    depends_on: ClassVar[tuple[Variable, ...]] = ("time",)
    any_law: ClassVar[Variable | None] = "time"

    amplitude_dn: float = parameter(1.0, unit="DN", low=-1e5, high=1e5, neutral=0.0)
    time_constant_s: float = parameter(300.0, unit="s", low=1e-3, high=1e9)

    @classmethod
    def why_not_testable(cls, blocks: Sequence[Block], camera: CameraHeader) -> str | None:  # noqa: ARG003
        """Return what a recording lacks; offset and slope of the response take two blocks."""
        return several_blocks(blocks, 3)

    def apply(self, signal: Lines, at: Conditions, rng: Generator) -> Lines:  # noqa: ARG002
        """DN in and out, (n_lines, *sample)."""
        shift = self.amplitude_dn * settled(at.line_times_s, self.time_constant_s)
        return signal + by_line(shift, signal.ndim)
