"""Integral nonlinearity (INL) of the converter: its codes lie off the straight line, smoothly.

Source: IEEE Std 1241-2010, Terminology and test methods for analog-to-digital converters: INL is
the deviation of the code transitions from a straight line, here the one through both ends. The
smooth part of it is written as the first sines that vanish at both ends, three or more of them.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from numpy.random import Generator

from calib.arrays import Lines
from calib.forward.conditions import Conditions
from calib.forward.departure import Departure, Statistic, Variable
from calib.forward.effect import Stage
from calib.forward.effects.adc import check_bit_depth
from calib.forward.parameter import parameter
from calib.forward.plan_needs import signals
from calib.recording.header import Block, CameraHeader


@dataclass(frozen=True)
class AdcInl(Departure):
    """Add the sum of bow sin(pi x) + s sin(2 pi x) + w sin(3 pi x), x = DN / full scale.

    It acts on the converter's input, which `adc` then rounds. Beyond both ends it adds nothing.

    Attributes:
        bow_dn: Height of the first sine, a bow.
        s_dn: Of the second, an S.
        w_dn: Of the third, a W.
        higher_dn: Of the fourth and so on.
        bit_depth: That of the camera; full scale is 2^bit_depth - 1.
    """

    name: ClassVar[str] = "adc_inl"
    stage: ClassVar[Stage] = Stage.CODES
    stochastic: ClassVar[bool] = False
    by_signal: ClassVar[bool] = True
    physics: ClassVar[str] = (
        "The converter's codes lie off the straight line, smoothly: a sum of sines of the code."
    )
    shows_in: ClassVar[Statistic] = "mean"
    depends_on: ClassVar[tuple[Variable, ...]] = ("code",)
    any_law: ClassVar[Variable | None] = "code"

    bow_dn: float = parameter(0.0, unit="DN", low=-1e3, high=1e3, neutral=0.0)
    s_dn: float = parameter(1.0, unit="DN", low=-1e3, high=1e3, neutral=0.0)
    w_dn: float = parameter(0.5, unit="DN", low=-1e3, high=1e3, neutral=0.0)
    higher_dn: tuple[float, ...] = parameter((), unit="DN", low=-1e3, high=1e3)
    bit_depth: int = parameter(12, unit="bit", low=8, high=16)

    def apply(self, signal: Lines, at: Conditions, rng: Generator) -> Lines:  # noqa: ARG002
        """DN in and out, not yet rounded, (n_lines, *sample)."""
        x = np.pi * np.clip(signal / ((1 << self.bit_depth) - 1), 0.0, 1.0)
        heights = (self.bow_dn, self.s_dn, self.w_dn, *self.higher_dn)
        return np.asarray(signal + _sines(heights, x))

    def check_camera(self, camera: CameraHeader) -> None:
        """Raise InputError unless the camera has this bit depth."""
        check_bit_depth(self.bit_depth, camera, f"effect {self.name}")

    @classmethod
    def why_not_testable(cls, blocks: Sequence[Block], camera: CameraHeader) -> str | None:  # noqa: ARG003
        """Return what `blocks` lack: signals that a straight line may miss."""
        return signals(blocks, 3)


def _sines(heights: Sequence[float], x: Lines) -> Lines:
    """Return sum_k heights[k - 1] sin(k x) by Clenshaw's recurrence (Math. Tables 9, 118 (1955)).

    b_k = h_k + 2 cos(x) b_(k+1) - b_(k+2), and the sum is b_1 sin(x): two sines for any number.
    """
    twice = 2.0 * np.cos(x)
    one, before = np.zeros_like(x), np.zeros_like(x)
    for height in reversed(heights):
        one, before = height + twice * one - before, one
    return np.asarray(one * np.sin(x))
