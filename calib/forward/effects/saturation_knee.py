"""Saturation knee: near full well a pixel keeps ever less of the charge that comes.

Source: Janesick, Scientific Charge-Coupled Devices, SPIE Press (2001), on full well: above the
onset of blooming or of surface interaction, charge spills over a barrier that it lowers itself. If
the share that stays falls linearly with the room left, dq/dQ = 1 - (q - threshold) / room, the
charge approaches threshold + room exponentially. The variance falls with the square of that slope,
the fall by which photon transfer finds full well.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from numpy.random import Generator

from calib.arrays import Lines, Pixels, SampleShape
from calib.forward.conditions import Conditions
from calib.forward.departure import Departure, Statistic, Variable
from calib.forward.effect import Stage
from calib.forward.parameter import parameter
from calib.forward.pattern import normal_pattern
from calib.forward.plan_needs import signals
from calib.recording.header import Block, CameraHeader


@dataclass(frozen=True)
class SaturationKnee(Departure):
    """Bend charge Q above a threshold to threshold + room (1 - exp(-(Q - threshold) / room)).

    Attributes:
        threshold_e: Mean charge at which the bend begins; below it, nothing changes.
        room_e: What a pixel can hold beyond it.
        relative_spread: Standard deviation of the threshold among pixels, relative to it.
        seed: Which sensor of that kind it is.
    """

    name: ClassVar[str] = "saturation_knee"
    stage: ClassVar[Stage] = Stage.CHARGE
    stochastic: ClassVar[bool] = False
    by_signal: ClassVar[bool] = True
    physics: ClassVar[str] = (
        "Above a threshold a pixel keeps ever less of its charge: "
        "q -> q_0 + r (1 - exp(-(q - q_0) / r))."
    )
    shows_in: ClassVar[Statistic] = "mean"
    depends_on: ClassVar[tuple[Variable, ...]] = ("signal", "column")

    threshold_e: float = parameter(20_000.0, unit="e-", low=0.0, neutral=np.inf)
    room_e: float = parameter(10_000.0, unit="e-", low=1.0, high=1e9)
    relative_spread: float = parameter(0.02, unit="1", low=0.0, high=0.3, neutral=0.0)
    seed: int = parameter(0, unit="1", low=0)

    def apply(self, signal: Lines, at: Conditions, rng: Generator) -> Lines:  # noqa: ARG002
        """Electrons in and out, (n_lines, *sample)."""
        threshold = self.thresholds(signal.shape[1:])
        beyond = np.maximum(signal - threshold, 0.0)
        kept = -self.room_e * np.expm1(-beyond / self.room_e)
        return np.asarray(np.minimum(signal, threshold) + kept)

    def thresholds(self, sample: SampleShape) -> Pixels:
        """Return the charge at which each pixel begins to bend, (*sample,)."""
        pattern = normal_pattern(self.seed, self.name, sample)
        return np.asarray(self.threshold_e * np.maximum(1.0 + self.relative_spread * pattern, 0.0))

    @classmethod
    def why_not_testable(cls, blocks: Sequence[Block], camera: CameraHeader) -> str | None:  # noqa: ARG003
        """Return what `blocks` lack: signals on both sides of a bend."""
        return signals(blocks, 3)
