"""Hot pixels: a few have a dark current far above all others'.

Source: Baer, A model for dark current characterization and simulation, Proc. SPIE 6068, 606805
(2006): the dark current's histogram has a long tail, from generation centres that few pixels have;
here the tail is exponential.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache
from typing import ClassVar

import numpy as np
from numpy.random import Generator

from calib.arrays import Lines, Pixels, SampleShape
from calib.errors import InputError
from calib.forward.conditions import Conditions
from calib.forward.departure import Departure, Statistic, Variable
from calib.forward.effect import Stage
from calib.forward.parameter import parameter
from calib.forward.pattern import check_length, pattern_generator, pixel_count
from calib.forward.plan_needs import dark_growth
from calib.recording.header import Block, CameraHeader


@dataclass(frozen=True)
class HotPixels(Departure):
    """Add rate x exposure time to the expected electrons of a few pixels.

    Attributes:
        share: Of the pixels that are hot, each by chance.
        electrons_per_us: Mean excess rate of those; exponentially distributed among them.
        seed: Which sensor of that kind it is.
        pixels: Which pixels are hot, from 0, row by row; where given, in place of drawn ones.
        rates_e_per_us: The excess rate of each of `pixels`.
    """

    name: ClassVar[str] = "hot_pixels"
    stage: ClassVar[Stage] = Stage.CHARGE
    stochastic: ClassVar[bool] = False
    separable: ClassVar[bool] = True
    physics: ClassVar[str] = (
        "A few pixels gather charge without light, far faster than most: + d t."
    )
    shows_in: ClassVar[Statistic] = "mean"
    depends_on: ClassVar[tuple[Variable, ...]] = ("column", "exposure")

    share: float = parameter(0.003, unit="1", low=0.0, high=0.5, neutral=0.0)
    electrons_per_us: float = parameter(2.0, unit="e-/us", low=0.0, high=1e6)
    seed: int = parameter(0, unit="1", low=0)
    pixels: tuple[int, ...] = parameter((), unit="pixel", low=0)
    rates_e_per_us: tuple[float, ...] = parameter((), unit="e-/us", low=0.0, high=1e6)

    def apply(self, signal: Lines, at: Conditions, rng: Generator) -> Lines:  # noqa: ARG002
        """Expected electrons in and out, (n_lines, *sample)."""
        return signal + self.rates(signal.shape[1:]) * at.exposure_us

    def rates(self, sample: SampleShape) -> Pixels:
        """Return the excess rate of each pixel, e-/us, (*sample,), read-only."""
        return _drawn(self, sample)

    def check_camera(self, camera: CameraHeader) -> None:
        """Raise InputError unless each of `pixels` is one of the camera's and has a rate."""
        where = "effect hot_pixels: rates_e_per_us"
        check_length(self.rates_e_per_us, len(self.pixels), where)
        last = pixel_count(camera) - 1
        if self.pixels and (max(self.pixels) > last or not self.rates_e_per_us):
            raise InputError(
                f"effect hot_pixels: pixels are {min(self.pixels)} to {max(self.pixels)} with "
                f"{len(self.rates_e_per_us)} rates; give pixels up to {last}, a rate for each.",
                code="bad-pixels",
            )

    @classmethod
    def why_not_testable(cls, blocks: Sequence[Block], camera: CameraHeader) -> str | None:  # noqa: ARG003
        """Return what `blocks` lack: a dark signal that can grow."""
        return dark_growth(blocks)


@lru_cache(maxsize=16)
def _drawn(hot: HotPixels, sample: SampleShape) -> Pixels:
    """Return the excess rates."""
    rng = pattern_generator(hot.seed, hot.name)
    rates = np.where(rng.random(sample) < hot.share, hot.electrons_per_us, 0.0)
    rates *= rng.standard_exponential(sample)
    if hot.pixels:
        rates[...] = 0.0
        rates.flat[list(hot.pixels)] = hot.rates_e_per_us
    rates.flags.writeable = False
    return rates
