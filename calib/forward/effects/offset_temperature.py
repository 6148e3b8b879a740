"""Offset temperature: the level of no charge follows the sensor's temperature.

Source: Howell, Handbook of CCD Astronomy (2006), on bias levels that follow the temperature of the
electronics; first order about a reference.
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
from calib.forward.plan_needs import first_lack, several_blocks, temperatures
from calib.recording.header import Block, CameraHeader


@dataclass(frozen=True)
class OffsetTemperature(Departure):
    """Add dn_per_k (T - reference).

    Attributes:
        dn_per_k: Change of the offset per kelvin.
        reference_c: The temperature at which the model's offset holds.
    """

    name: ClassVar[str] = "offset_temperature"
    stage: ClassVar[Stage] = Stage.VOLTS
    stochastic: ClassVar[bool] = False
    physics: ClassVar[str] = (
        "The offset follows the sensor's temperature, in darks and flats alike: + b (T - T0)."
    )
    shows_in: ClassVar[Statistic] = "mean"
    depends_on: ClassVar[tuple[Variable, ...]] = ("temperature",)
    smooth_law: ClassVar[Variable | None] = "temperature"

    dn_per_k: float = parameter(0.2, unit="DN/K", low=-1e4, high=1e4, neutral=0.0)
    reference_c: float = parameter(25.0, unit="degree Celsius", low=-200.0, high=150.0)

    @classmethod
    def why_not_testable(cls, blocks: Sequence[Block], camera: CameraHeader) -> str | None:  # noqa: ARG003
        """Return what a recording lacks; offset and slope of the response take two blocks."""
        return first_lack(temperatures(blocks, 0.1), several_blocks(blocks, 3))

    def apply(self, signal: Lines, at: Conditions, rng: Generator) -> Lines:  # noqa: ARG002
        """DN in and out, (n_lines, *sample)."""
        return signal + self.dn_per_k * (at.sensor_temperature_c - self.reference_c)
