"""Black clip: codes stop at a level above 0.

Source: EMVA Standard 1288, Release 4.0 Linear, which asks for an offset high enough that the dark
signal is not clipped, for clipping raises its mean and lowers its variance. Cameras that subtract
a black level clamp what falls below it to a lowest code of their own.
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
from calib.forward.plan_needs import any_of, darks, signals
from calib.recording.header import Block, CameraHeader


@dataclass(frozen=True)
class BlackClip(CodeFault):
    """Raise codes below the level to it. It acts last, on the codes that the camera sends.

    Attributes:
        level_dn: The lowest code.
    """

    name: ClassVar[str] = "black_clip"
    stage: ClassVar[Stage] = Stage.CODES
    stochastic: ClassVar[bool] = False
    by_signal: ClassVar[bool] = True
    physics: ClassVar[str] = "Codes stop at a level b above 0: DN -> max(DN, b)."
    shows_in: ClassVar[Statistic] = "histogram"
    depends_on: ClassVar[tuple[Variable, ...]] = ("code",)

    level_dn: int = parameter(60, unit="DN", low=0, high=65_535, neutral=0)

    def apply(self, signal: Lines, at: Conditions, rng: Generator) -> Lines:  # noqa: ARG002
        """Whole codes in and out, (n_lines, *sample)."""
        return self.faulty(signal)

    @property
    def chance(self) -> float:
        """All samples have the fault."""
        return 1.0

    def faulty(self, codes: Lines) -> Lines:
        """Return what becomes of codes of any shape."""
        return np.maximum(codes, float(self.level_dn))

    def check_camera(self, camera: CameraHeader) -> None:
        """Raise InputError unless the camera has codes above the level."""
        if self.level_dn >= camera.full_scale_dn:
            raise InputError(
                f"effect {self.name}: level_dn is {self.level_dn}, but the camera's highest code "
                f"is {camera.full_scale_dn}; give a lower level.",
                code="no-such-code",
            )

    @classmethod
    def why_not_testable(cls, blocks: Sequence[Block], camera: CameraHeader) -> str | None:  # noqa: ARG003
        """Return what `blocks` lack: a signal near the bottom, or several to find one."""
        return any_of(darks(blocks), signals(blocks, 3))
