"""Level non-additivity: n lamps together give less, or more, than n times one.

Source: Saunders and Shumaker, Automated radiometric linearity tester, Appl. Opt. 23, 3504 (1984):
fluxes add, so where levels do not, something depends on the level. Lamps that share a sphere and a
supply heat each other and lower each other's voltage; to first order each burning lamp takes the
same share of the others' light.
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
from calib.forward.plan_needs import light_against_level
from calib.recording.header import Block, CameraHeader


@dataclass(frozen=True)
class LevelNonadditivity(Departure):
    """Scale the radiance by 1 - loss (n - 1), n being what the lamps emit together.

    One lamp, or an LED at its nominal setting, n = 1, gives what it gives alone. The sum of the
    lamps' emissions stands for n, so that a lamp that warms up counts as far as it burns.

    Attributes:
        loss_per_lamp: Share of the light that each further lamp takes; negative where it gives.
    """

    name: ClassVar[str] = "level_nonadditivity"
    stage: ClassVar[Stage] = Stage.SOURCE
    stochastic: ClassVar[bool] = False
    separable: ClassVar[bool] = True
    physics: ClassVar[str] = "n lamps give less than n times one: L -> L (1 - a (n - 1))."
    shows_in: ClassVar[Statistic] = "mean"
    depends_on: ClassVar[tuple[Variable, ...]] = ("level",)
    any_law: ClassVar[Variable | None] = "level"

    loss_per_lamp: float = parameter(0.005, unit="1", low=-0.5, high=0.5, neutral=0.0)

    def apply(self, signal: Lines, at: Conditions, rng: Generator) -> Lines:  # noqa: ARG002
        """Radiance in, radiance out, (n_lines, *sample)."""
        n = sum(at.lamps)
        kept = 1.0 - self.loss_per_lamp * (n - 1.0) if n > 0 else 1.0
        return signal * max(kept, 0.0)

    @classmethod
    def why_not_testable(cls, blocks: Sequence[Block], camera: CameraHeader) -> str | None:  # noqa: ARG003
        """Return what `blocks` lack: levels whose light can be compared."""
        return light_against_level(blocks)
