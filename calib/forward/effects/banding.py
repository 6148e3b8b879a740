"""Banding: a tone from the electronics runs through the pixels as they are read out.

Source: Olsen et al., Radiometric calibration for AgCam (2010), section 5, where a known
synchronous noise is removed before the lines are averaged. A tone with an integer number of cycles
a line looks alike on every line and is a part of DN0.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from math import pi, prod
from typing import ClassVar

import numpy as np
from numpy.random import Generator

from calib.arrays import Lines, by_line
from calib.forward.conditions import Conditions
from calib.forward.departure import Departure, Statistic, Variable
from calib.forward.effect import Stage
from calib.forward.parameter import parameter
from calib.forward.plan_needs import lines
from calib.recording.header import Block, CameraHeader


@dataclass(frozen=True)
class Banding(Departure):
    """Add a sine of the pixel's read-out time; a line's columns take one line period to read.

    So do a frame's pixels, row by row: of an area sensor that is the time from frame to frame.

    Attributes:
        amplitude_dn: Half of its peak-to-peak height.
        frequency_hz: Its frequency; times the line period, its cycles a line.
        phase_rad: Its phase at the recording's start.
    """

    name: ClassVar[str] = "banding"
    stage: ClassVar[Stage] = Stage.VOLTS
    stochastic: ClassVar[bool] = False
    physics: ClassVar[str] = (
        "A tone of the electronics runs through the pixels as they are read out."
    )
    shows_in: ClassVar[Statistic] = "spectrum"
    depends_on: ClassVar[tuple[Variable, ...]] = ("line", "column")

    amplitude_dn: float = parameter(1.0, unit="DN", low=0.0, high=1e5, neutral=0.0)
    frequency_hz: float = parameter(12_345.0, unit="Hz", low=0.0, high=1e9)
    phase_rad: float = parameter(0.0, unit="rad", low=-2 * pi, high=2 * pi)

    @classmethod
    def why_not_testable(cls, blocks: Sequence[Block], camera: CameraHeader) -> str | None:  # noqa: ARG003
        """Return what a recording lacks to show it; None where it could."""
        return lines(blocks, 2)

    def apply(self, signal: Lines, at: Conditions, rng: Generator) -> Lines:  # noqa: ARG002
        """DN in and out, (n_lines, *sample)."""
        sample = signal.shape[1:]
        n_pixels = prod(sample)
        lines = 2 * pi * np.mod(self.frequency_hz * at.line_times_s, 1.0) + self.phase_rad
        within_line_s = np.arange(n_pixels) * (at.line_period_us * 1e-6 / n_pixels)
        pixels = (2 * pi * self.frequency_hz * within_line_s).reshape(sample)
        # sin(a + b) of what lines and pixels say takes a sine of each, not one of each sample.
        sine, cosine = (
            by_line(self.amplitude_dn * f(lines), signal.ndim) for f in (np.sin, np.cos)
        )
        return np.asarray(signal + sine * np.cos(pixels) + cosine * np.sin(pixels))
