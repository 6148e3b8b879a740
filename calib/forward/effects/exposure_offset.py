"""Exposure offset: the sensor is exposed longer, or shorter, than it was told.

Source: Stetson, Some factors affecting the accuracy of stellar photometry with CCDs, Highlights of
Astronomy 8, 635 (1989), and Galadi-Enriquez, Jordi and Trullols, Effects of shutter timing on CCD
photometry (1995), for t -> t + delta, constant at all exposures.

In those cameras a shutter in front of the sensor is late, and the dark charge keeps its time. The
cameras modelled here have an electronic shutter: one pair of edges, the end of the reset and the
transfer, gates the charge of a pixel wherever it comes from. So the dark charge gathers for
t + delta, too, and later links see that exposure.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import ClassVar

from numpy.random import Generator

from calib.arrays import Lines
from calib.forward.conditions import Conditions
from calib.forward.departure import Departure, Statistic, Variable
from calib.forward.effect import Stage
from calib.forward.parameter import parameter
from calib.forward.plan_needs import any_of, darks, first_lack, flats_at_exposures, flats_at_levels
from calib.recording.header import Block, CameraHeader


@dataclass(frozen=True)
class ExposureOffset(Departure):
    """Scale radiance x us by (t + delta) / t; an exposure never falls below 0.

    Attributes:
        offset_us: delta, what is added to every exposure; negative where it is cut short.
    """

    name: ClassVar[str] = "exposure_offset"
    stage: ClassVar[Stage] = Stage.EXPOSURE
    stochastic: ClassVar[bool] = False
    separable: ClassVar[bool] = True
    physics: ClassVar[str] = "Each exposure lasts longer than was asked for: t -> t + delta."
    shows_in: ClassVar[Statistic] = "mean"
    depends_on: ClassVar[tuple[Variable, ...]] = ("exposure", "level")
    any_law: ClassVar[Variable | None] = "exposure"

    offset_us: float = parameter(0.5, unit="us", low=-1e6, high=1e6, neutral=0.0)

    def apply(self, signal: Lines, at: Conditions, rng: Generator) -> Lines:  # noqa: ARG002
        """Radiance x us in and out, (n_lines, *sample)."""
        return signal * (self.conditions_after(at).exposure_us / at.exposure_us)

    def conditions_after(self, at: Conditions) -> Conditions:
        """Return the conditions with the exposure as it really is."""
        return replace(at, exposure_us=max(at.exposure_us + self.offset_us, 0.0))

    @classmethod
    def why_not_testable(cls, blocks: Sequence[Block], camera: CameraHeader) -> str | None:  # noqa: ARG003
        """Return what `blocks` lack: exposures, and the offset apart from light at exposure 0."""
        apart = any_of(darks(blocks), flats_at_levels(blocks, 2))
        return first_lack(flats_at_exposures(blocks, 2), apart)
