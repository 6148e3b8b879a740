"""Stray light: light of other origin than the source reaches the lens whenever it is not capped.

Source: EMVA Standard 1288, Release 4.0 Linear, whose dark images are taken with no light at all on
the sensor, which switching the source off does not ensure; Fest, Stray Light Analysis and Control,
SPIE Press (2013), chapter 1.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import ClassVar

from numpy.random import Generator

from calib.arrays import Lines
from calib.forward.conditions import Conditions
from calib.forward.departure import Departure, Statistic, Variable
from calib.forward.effect import Stage
from calib.forward.parameter import parameter
from calib.forward.plan_needs import first_lack, flats_at_levels, offset_known
from calib.recording.header import Block, CameraHeader


@dataclass(frozen=True)
class StrayLight(Departure):
    """Add a steady radiance, whatever the level; a cap shuts it out.

    It comes in behind what the lamps do: it neither drifts nor flickers with them, and no spot of
    the source bounds it.

    Attributes:
        radiance: Of the stray light, in the source's unit.
    """

    name: ClassVar[str] = "stray_light"
    stage: ClassVar[Stage] = Stage.SOURCE
    stochastic: ClassVar[bool] = False
    separable: ClassVar[bool] = True
    adds_light: ClassVar[bool] = True
    physics: ClassVar[str] = (
        "Light from elsewhere reaches the uncapped lens, whatever the level: L -> L + L_s."
    )
    shows_in: ClassVar[Statistic] = "mean"
    depends_on: ClassVar[tuple[Variable, ...]] = ("level", "exposure")
    smooth_law: ClassVar[Variable | None] = "column"

    radiance: float = parameter(0.1, unit="radiance", low=0.0, high=1e9, neutral=0.0)

    def apply(self, signal: Lines, at: Conditions, rng: Generator) -> Lines:  # noqa: ARG002
        """Radiance in, radiance out, (n_lines, *sample)."""
        return signal + (0.0 if at.capped else self.radiance)

    @classmethod
    def why_not_testable(cls, blocks: Sequence[Block], camera: CameraHeader) -> str | None:  # noqa: ARG003
        """Return what `blocks` lack: levels, and the offset apart from light at level 0."""
        return first_lack(flats_at_levels(blocks, 2), offset_known(blocks))
