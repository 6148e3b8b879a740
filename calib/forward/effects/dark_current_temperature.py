"""Dark current that follows the temperature: it doubles every few kelvins.

Source: EMVA Standard 1288, Release 4.0 Linear, the doubling temperature of the dark current;
about 7 K for silicon near room temperature.
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
from calib.forward.plan_needs import temperatures
from calib.recording.header import Block, CameraHeader


@dataclass(frozen=True)
class DarkCurrentTemperature(Departure):
    """Add rate x 2^((T - reference) / doubling) x exposure time to the expected electrons.

    Thermal generation grows as T^n exp(-E / kT), and so doubles every ln 2 k T^2 / (E + n k T):
    between -30 and 50 degree Celsius every 3 K where diffusion rules in silicon (E = 1.12 eV,
    n = 3), up to 16 K where generation at half the gap does in InGaAs (0.37 eV, 1.5). What grows
    more slowly is no thermal dark current. (Sze and Ng, Physics of Semiconductor Devices, sections
    1.4 and 2.3.)

    It is the whole dark current of a sensor whose temperature varies; together with
    `dark_current` the two add, as those of two layers do.

    Attributes:
        electrons_per_us: Mean rate at the reference temperature.
        dsnu_std_e_per_us: Standard deviation of that rate among pixels; the rate stops at 0.
        dsnu_seed: Which sensor of that kind it is.
        reference_c: The temperature at which the rates hold.
        doubling_k: The rise that doubles them.
        rates_e_per_us: Rate of each pixel at that temperature, (*sample,); where given, in place of
            the drawn one.
    """

    name: ClassVar[str] = "dark_current_temperature"
    stage: ClassVar[Stage] = Stage.CHARGE
    stochastic: ClassVar[bool] = False
    separable: ClassVar[bool] = True
    physics: ClassVar[str] = (
        "Dark current grows with the sensor's temperature, double every few kelvin."
    )
    shows_in: ClassVar[Statistic] = "mean"
    depends_on: ClassVar[tuple[Variable, ...]] = ("temperature", "exposure")
    smooth_law: ClassVar[Variable | None] = "temperature"

    electrons_per_us: float = parameter(0.01, unit="e-/us", low=0.0, high=1e6, neutral=0.0)
    dsnu_std_e_per_us: float = parameter(0.001, unit="e-/us", low=0.0, high=1e6, neutral=0.0)
    dsnu_seed: int = parameter(0, unit="1", low=0)
    reference_c: float = parameter(25.0, unit="degree Celsius", low=-200.0, high=150.0)
    doubling_k: float = parameter(7.0, unit="K", low=3.0, high=16.0)
    rates_e_per_us: tuple[float, ...] = parameter((), unit="e-/us", low=0.0, high=1e6)

    def apply(self, signal: Lines, at: Conditions, rng: Generator) -> Lines:  # noqa: ARG002
        """Expected electrons in and out, (n_lines, *sample)."""
        rates = self.rates(signal.shape[1:], at.sensor_temperature_c)
        return signal + rates * at.exposure_us

    def rates(self, sample: SampleShape, temperature_c: float) -> Pixels:
        """Return the rate of each pixel at a temperature, e-/us, (*sample,)."""
        if self.rates_e_per_us:
            reference = explicit_pattern(self.rates_e_per_us, sample)
        else:
            pattern = normal_pattern(self.dsnu_seed, self.name, sample)
            reference = np.maximum(self.electrons_per_us + self.dsnu_std_e_per_us * pattern, 0.0)
        return np.asarray(reference * 2.0 ** ((temperature_c - self.reference_c) / self.doubling_k))

    def check_camera(self, camera: CameraHeader) -> None:
        """Raise InputError unless `rates_e_per_us` has one value per pixel."""
        check_length(
            self.rates_e_per_us, pixel_count(camera), f"effect {self.name}: rates_e_per_us"
        )

    @classmethod
    def why_not_testable(cls, blocks: Sequence[Block], camera: CameraHeader) -> str | None:  # noqa: ARG003
        """Return what `blocks` lack: temperatures that differ."""
        return temperatures(blocks, 1.0)
