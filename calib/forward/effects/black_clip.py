"""Black clip: codes stop, or count more coarsely, below a level above 0.

Source: EMVA Standard 1288, Release 4.0 Linear, which asks for an offset high enough that the dark
signal is not clipped, for clipping raises its mean and lowers its variance. Cameras that subtract
a black level clamp what falls below it to a lowest code of their own. A soft stop lets a part of
the distance through: the transfer curve's slope falls, but not to nothing.
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
    """Raise codes below a level towards it. It acts last, on the codes that the camera sends.

    Attributes:
        level_dn: The lowest code, or that from which on codes are as they were.
        keeps: Part of its distance from the level that a lower code keeps, whole codes of it.
        only_tap: The tap that has it, from 0; left out, all have.
        tap_layout: Which pixels a tap reads; that of the camera.
    """

    name: ClassVar[str] = "black_clip"
    stage: ClassVar[Stage] = Stage.CODES
    stochastic: ClassVar[bool] = False
    by_signal: ClassVar[bool] = True
    physics: ClassVar[str] = (
        "Codes stop at a level b above 0: DN -> max(DN, b); or DN -> b - k (b - DN) below it."
    )
    shows_in: ClassVar[Statistic] = "histogram"
    depends_on: ClassVar[tuple[Variable, ...]] = ("code",)

    level_dn: int = parameter(60, unit="DN", low=0, high=65_535, neutral=0)
    keeps: float = parameter(0.0, unit="1", low=0.0, high=1.0)

    def apply(self, signal: Lines, at: Conditions, rng: Generator) -> Lines:  # noqa: ARG002
        """Whole codes in and out, (n_lines, *sample)."""
        return np.where(self.acting(signal.shape[1:]), self.faulty(signal), signal)

    @property
    def chance(self) -> float:
        """All samples have the fault."""
        return 1.0

    def faulty(self, codes: Lines) -> Lines:
        """Return what becomes of codes of any shape."""
        below = np.maximum(float(self.level_dn) - codes, 0.0)
        return np.asarray(codes + below - np.floor(self.keeps * below))

    def slope(self, codes: Lines) -> Lines:
        """Return 1 above the level, and what comes through below."""
        return np.where(codes > self.level_dn, 1.0, self.keeps)

    def check_camera(self, camera: CameraHeader) -> None:
        """Raise InputError unless the camera has codes above the level, and the tap."""
        super().check_camera(camera)
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
