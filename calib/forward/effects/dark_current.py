"""Dark current: charge that gathers without light, in each pixel at its own rate (DSNU).

Source: EMVA Standard 1288, Release 4.0 Linear, dark current as the growth of the dark signal with
exposure time. That standard's DSNU also holds the offset's fixed pattern, which is here a part of
`offset`.
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
from calib.forward.pattern import check_length, explicit_pattern, normal_pattern, pixel_count
from calib.forward.plan_needs import dark_growth
from calib.recording.header import Block, CameraHeader


@dataclass(frozen=True)
class DarkCurrent(Departure):
    """Add rate x exposure time to the expected electrons, whatever the temperature.

    Attributes:
        electrons_per_us: Mean rate.
        dsnu_std_e_per_us: Standard deviation of the rate among pixels; the rate stops at 0.
        dsnu_seed: Which sensor of that kind it is.
        rates_e_per_us: Rate of each pixel, (*sample,); where given, in place of the drawn one.
    """

    name: ClassVar[str] = "dark_current"
    stage: ClassVar[Stage] = Stage.CHARGE
    stochastic: ClassVar[bool] = False
    separable: ClassVar[bool] = True
    physics: ClassVar[str] = "Charge gathers without light, in each pixel at its own rate: + d t."
    shows_in: ClassVar[Statistic] = "mean"
    depends_on: ClassVar[tuple[Variable, ...]] = ("exposure", "column")
    smooth_law: ClassVar[Variable | None] = "column"

    electrons_per_us: float = parameter(0.01, unit="e-/us", low=0.0, high=1e6, neutral=0.0)
    dsnu_std_e_per_us: float = parameter(0.001, unit="e-/us", low=0.0, high=1e6, neutral=0.0)
    dsnu_seed: int = parameter(0, unit="1", low=0)
    rates_e_per_us: tuple[float, ...] = parameter((), unit="e-/us", low=0.0, high=1e6)

    def apply(self, signal: Lines, at: Conditions, rng: Generator) -> Lines:  # noqa: ARG002
        """Expected electrons in and out, (n_lines, *sample)."""
        return signal + self.rates(signal.shape[1:]) * at.exposure_us

    def rates(self, sample: SampleShape) -> Pixels:
        """Return the rate of each pixel, e-/us, (*sample,)."""
        if self.rates_e_per_us:
            return explicit_pattern(self.rates_e_per_us, sample)
        pattern = normal_pattern(self.dsnu_seed, self.name, sample)
        return np.maximum(self.electrons_per_us + self.dsnu_std_e_per_us * pattern, 0.0)

    def check_camera(self, camera: CameraHeader) -> None:
        """Raise InputError unless `rates_e_per_us` has one value per pixel."""
        check_length(
            self.rates_e_per_us, pixel_count(camera), "effect dark_current: rates_e_per_us"
        )

    @classmethod
    def why_not_testable(cls, blocks: Sequence[Block], camera: CameraHeader) -> str | None:  # noqa: ARG003
        """Return what `blocks` lack: a dark signal that can grow."""
        return dark_growth(blocks)
