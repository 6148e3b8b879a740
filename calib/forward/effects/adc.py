"""Analogue-to-digital conversion: rounding to whole codes and clipping to their range.

Source: EMVA Standard 1288, Release 4.0 Linear, quantisation as the last link of the chain.

Here alone DN become whole: a converter's errors of its input (`adc_inl`) and of its code widths
(`adc_dnl`) come before this link, faults of its codes (`stuck_bit`, `black_clip`) after it.
"""

from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from numpy.random import Generator

from calib.arrays import Lines
from calib.errors import InputError
from calib.forward.conditions import Conditions
from calib.forward.effect import Effect, Stage
from calib.forward.parameter import parameter
from calib.recording.header import CameraHeader


@dataclass(frozen=True)
class Adc(Effect):
    """Round to the nearest code and clip to 0 .. 2^bit_depth - 1.

    Attributes:
        bit_depth: That of the camera.
    """

    name: ClassVar[str] = "adc"
    stage: ClassVar[Stage] = Stage.CODES
    stochastic: ClassVar[bool] = False
    by_signal: ClassVar[bool] = True

    bit_depth: int = parameter(12, unit="bit", low=8, high=16)

    @property
    def full_scale_dn(self) -> int:
        """The highest code."""
        return (1 << self.bit_depth) - 1

    def apply(self, signal: Lines, at: Conditions, rng: Generator) -> Lines:  # noqa: ARG002
        """DN in, whole codes out, (n_lines, *sample)."""
        return np.asarray(np.clip(np.floor(signal + 0.5), 0.0, float(self.full_scale_dn)))

    def check_camera(self, camera: CameraHeader) -> None:
        """Raise InputError unless the camera has this bit depth."""
        check_bit_depth(self.bit_depth, camera, "effect adc")


def check_bit_depth(bit_depth: int, camera: CameraHeader, where: str) -> None:
    """Raise InputError unless the camera has this bit depth."""
    if bit_depth != camera.bit_depth:
        raise InputError(
            f"{where}: bit_depth is {bit_depth}, but the camera's is {camera.bit_depth}; "
            "give one for both.",
            code="bit-depth-mismatch",
        )
