"""Lamp flicker: a source fed with alternating current flickers at twice the mains frequency.

Source: IEEE Std 1789-2015, on lamps whose light follows the power, and so the square of a mains
voltage: twice its frequency. What an exposure sees of it is its mean over the exposure; the line
period samples that, so a frequency above half the line rate appears as its alias.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from math import pi
from typing import ClassVar

import numpy as np
from numpy.random import Generator

from calib.arrays import Columns, Lines, by_line
from calib.forward.conditions import Conditions
from calib.forward.departure import Departure, Statistic, Variable
from calib.forward.effect import Stage
from calib.forward.parameter import parameter
from calib.forward.plan_needs import flats
from calib.recording.header import Block, CameraHeader


@dataclass(frozen=True)
class LampFlicker(Departure):
    """Scale the radiance by the exposure's mean of 1 + amplitude sin(2 pi 2 f time + phase).

    That mean is 1 + amplitude sinc(2 f t) sin(2 pi 2 f (time + t/2) + phase), with sinc(x) =
    sin(pi x) / (pi x): an exposure of whole periods of the flicker sees none of it.

    Attributes:
        amplitude: Half of its peak-to-peak height, relative to the mean.
        mains_hz: The mains frequency f.
        phase_rad: Its phase at the recording's start.
    """

    name: ClassVar[str] = "lamp_flicker"
    stage: ClassVar[Stage] = Stage.SOURCE
    stochastic: ClassVar[bool] = False
    separable: ClassVar[bool] = True
    physics: ClassVar[str] = (
        "The lamp flickers at twice the mains frequency f: L -> L (1 + a sin(2 pi 2 f time))."
    )
    shows_in: ClassVar[Statistic] = "spectrum"
    depends_on: ClassVar[tuple[Variable, ...]] = ("line", "signal", "level")

    amplitude: float = parameter(0.005, unit="1", low=0.0, high=1.0, neutral=0.0)
    mains_hz: float = parameter(50.0, unit="Hz", low=1.0, high=1e6)
    phase_rad: float = parameter(0.0, unit="rad", low=-2 * pi, high=2 * pi)

    def apply(self, signal: Lines, at: Conditions, rng: Generator) -> Lines:
        """Radiance in, radiance out, (n_lines, *sample)."""
        return signal * by_line(self.line_factor(at, rng), signal.ndim)

    def line_factor(self, at: Conditions, rng: Generator) -> Columns:  # noqa: ARG002
        """Return the relative radiance during each line's exposure, (n_lines,)."""
        exposure_s = at.exposure_us * 1e-6
        # The cycles since the start are cut to one, lest a long recording lose its phase.
        cycles = np.mod(2 * self.mains_hz * (at.line_times_s + exposure_s / 2), 1.0)
        seen = self.amplitude * np.sinc(2 * self.mains_hz * exposure_s)
        return np.asarray(1.0 + seen * np.sin(2 * pi * cycles + self.phase_rad))

    @classmethod
    def why_not_testable(cls, blocks: Sequence[Block], camera: CameraHeader) -> str | None:  # noqa: ARG003
        """Return what `blocks` lack: a spectrum of a flat's lines."""
        return flats(blocks, lines=8)
