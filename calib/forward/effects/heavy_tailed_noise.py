"""Heavy-tailed noise: now and then a pixel's reading is far noisier than usual.

Source: Tukey, A survey of sampling from contaminated distributions (1960), for a normal mixture;
its variance and kurtosis exist and are simple, which no Student distribution has at all degrees of
freedom.
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
from calib.forward.parameter import parameter
from calib.forward.plan_needs import lines
from calib.recording.header import Block, CameraHeader


@dataclass(frozen=True)
class HeavyTailedNoise(Departure):
    """Add, on top of the read noise, Gaussian noise to a share of all readings.

    It adds the variance share std^2 and the fourth cumulant 3 share (1 - share) std^4.

    Attributes:
        share: Of readings that are noisier, drawn anew for each line and pixel.
        std_e: Standard deviation of what is added to them.
    """

    name: ClassVar[str] = "heavy_tailed_noise"
    stage: ClassVar[Stage] = Stage.VOLTS
    stochastic: ClassVar[bool] = True
    by_signal: ClassVar[bool] = True
    physics: ClassVar[str] = "Read noise has outliers: a small share of readings is far noisier."
    shows_in: ClassVar[Statistic] = "tail"
    depends_on: ClassVar[tuple[Variable, ...]] = ("line",)

    share: float = parameter(0.01, unit="1", low=0.0, high=1.0, neutral=0.0)
    std_e: float = parameter(50.0, unit="e-", low=0.0, high=1e6, neutral=0.0)

    @classmethod
    def why_not_testable(cls, blocks: Sequence[Block], camera: CameraHeader) -> str | None:  # noqa: ARG003
        """Return what a recording lacks to show outliers; a fourth moment takes four lines."""
        return lines(blocks, 4)

    def apply(self, signal: Lines, at: Conditions, rng: Generator) -> Lines:  # noqa: ARG002
        """Electrons in and out, (n_lines, *sample)."""
        noisy = np.array(signal, np.float64)
        outliers = rng.random(signal.shape) < self.share
        noisy[outliers] += self.std_e * rng.standard_normal(int(outliers.sum()))
        return noisy
