"""What a photodiode at the sphere's wall and its picoammeter give for the lamps that burn."""

from dataclasses import dataclass
from math import sqrt

from numpy.random import Generator

_ELEMENTARY_CHARGE_C = 1.602176634e-19


@dataclass(frozen=True)
class MonitorCurrent:
    """Photocurrent with shot noise, and the meter's own noise.

    Attributes:
        amperes_per_lamp: Photocurrent of one lamp at its nominal radiance.
        dark_a: The photodiode's dark current.
        meter_std_a: The meter's noise at an integration of 1 s, standard deviation.
    """

    amperes_per_lamp: float = 2e-7
    dark_a: float = 2e-12
    meter_std_a: float = 2e-12

    def mean_a(self, emissions: tuple[float, ...]) -> float:
        """Expected current for lamps at these relative emissions."""
        return self.dark_a + self.amperes_per_lamp * sum(emissions)

    def measure_a(
        self, emissions: tuple[float, ...], integration_s: float, rng: Generator
    ) -> float:
        """One reading over `integration_s` T: shot noise 2 e I B, B = 1/(2 T), and the meter's."""
        mean_a = self.mean_a(emissions)
        shot_a2 = _ELEMENTARY_CHARGE_C * abs(mean_a) / integration_s
        meter_a2 = self.meter_std_a**2 / integration_s
        return float(rng.normal(mean_a, sqrt(shot_a2 + meter_a2)))
