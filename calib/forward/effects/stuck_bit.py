"""Stuck bit: one bit of the code reads 0, or 1, always or at times.

Source: the stuck-at fault of digital testing, Abramovici, Breuer and Friedman, Digital Systems
Testing and Testable Design, IEEE Press (1990), chapter 4: a line keeps one value whatever drives
it; an intermittent fault does so at times. A bit at fault shows in the histogram, as the fourth of
16 does in an EMCCD's: Harpsoe et al., A&A 537, A50 (2012), figure 3.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from numpy.random import Generator

from calib.arrays import Lines
from calib.errors import InputError
from calib.forward.code_fault import CodeFault
from calib.forward.conditions import Conditions
from calib.forward.departure import Statistic, Variable
from calib.forward.effect import Stage
from calib.forward.parameter import parameter
from calib.forward.plan_needs import lines
from calib.recording.header import Block, CameraHeader


@dataclass(frozen=True)
class StuckBit(CodeFault):
    """Set one bit of the converter's codes to a value, each pixel's by chance of its own.

    Attributes:
        probability: With which the bit sticks; 1 for always.
        bit: Which one, from 0, the lowest.
        value: At which it sticks, 0 or 1.
        only_tap: The tap that has it, from 0; left out, all have.
        tap_layout: Which pixels a tap reads; that of the camera.
    """

    name: ClassVar[str] = "stuck_bit"
    stage: ClassVar[Stage] = Stage.CODES
    stochastic: ClassVar[bool] = True
    by_signal: ClassVar[bool] = True
    physics: ClassVar[str] = "One bit of the code sticks at 0 or 1, always or at times."
    shows_in: ClassVar[Statistic] = "histogram"
    depends_on: ClassVar[tuple[Variable, ...]] = ("code",)

    probability: float = parameter(0.5, unit="1", low=0.0, high=1.0, neutral=0.0)
    bit: int = parameter(3, unit="bit", low=0, high=15)
    value: int = parameter(0, unit="1", low=0, high=1)

    def apply(self, signal: Lines, at: Conditions, rng: Generator) -> Lines:  # noqa: ARG002
        """Whole codes in and out, (n_lines, *sample)."""
        sticks = rng.random(signal.shape) < self.probability * self.acting(signal.shape[1:])
        return np.where(sticks, self.faulty(signal), signal)

    @property
    def chance(self) -> float:
        """With which a sample has the fault."""
        return self.probability

    def faulty(self, codes: Lines) -> Lines:
        """Return what codes are where the bit sticks, of any shape."""
        whole, mask = codes.astype(np.int64), 1 << self.bit
        return (whole | mask if self.value else whole & ~mask).astype(np.float64)

    def check_camera(self, camera: CameraHeader) -> None:
        """Raise InputError unless the camera's codes have that bit, and the camera the tap."""
        super().check_camera(camera)
        if self.bit >= camera.bit_depth:
            raise InputError(
                f"effect {self.name}: bit is {self.bit}, but the camera's codes have bits 0 to "
                f"{camera.bit_depth - 1}; give one of those.",
                code="no-such-code",
            )

    @classmethod
    def why_not_testable(cls, blocks: Sequence[Block], camera: CameraHeader) -> str | None:  # noqa: ARG003
        """Return what `blocks` lack: lines to make a histogram of."""
        return lines(blocks, 2)
