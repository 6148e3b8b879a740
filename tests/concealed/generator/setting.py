"""What a mechanism may know of sensor and plan when its strength is chosen."""

from dataclasses import dataclass
from math import sqrt

import numpy as np

from tests.concealed.generator.plan import Plan
from tests.concealed.generator.sensor import Sensor


@dataclass(frozen=True)
class Setting:
    """Sensor and plan, and the rough sizes that follow from them."""

    sensor: Sensor
    plan: Plan

    @property
    def top_e(self) -> float:
        """Electrons of a bright pixel in the brightest block."""
        return max(self._electrons(b.radiance, b.exposure_us) for b in self.plan.flats)

    @property
    def middle_e(self) -> float:
        """Electrons of a bright pixel in the median lit block."""
        lit = [self._electrons(b.radiance, b.exposure_us) for b in self.plan.flats]
        return float(np.median(lit))

    @property
    def noise_e(self) -> float:
        """Standard deviation of a pixel without light, rounding included, electrons."""
        rounding = 1.0 / 12 / self.sensor.gain_dn_per_e**2
        return sqrt(self.sensor.read_noise_e**2 + rounding)

    @property
    def noise_dn(self) -> float:
        """The same in DN."""
        return self.noise_e * self.sensor.gain_dn_per_e

    @property
    def lit_noise(self) -> float:
        """Relative standard deviation of a pixel in the median lit block."""
        return sqrt(self.middle_e + self.noise_e**2) / self.middle_e

    @property
    def n_lit(self) -> int:
        """Lit samples of pixels."""
        return self._pixels * sum(block.n_samples for block in self.plan.flats)

    @property
    def n_dark(self) -> int:
        """Capped samples of pixels; 1 where there is none."""
        return max(1, self._pixels * sum(block.n_samples for block in self.plan.dark_blocks))

    @property
    def n_all(self) -> int:
        """Samples of pixels."""
        return self._pixels * self.n_lines

    @property
    def n_lines(self) -> int:
        """Samples (lines or frames)."""
        return sum(block.n_samples for block in self.plan.blocks)

    @property
    def mean_limit(self) -> float:
        """Relative change of the mean over all lit pixels that equals its standard error."""
        return self.lit_noise / sqrt(self.n_lit)

    @property
    def covariance_limit(self) -> float:
        """Correlation of neighbours over all lit pixels that equals its standard error."""
        return 1.0 / sqrt(self.n_lit)

    @property
    def temperature_spread_k(self) -> float:
        """Largest minus smallest."""
        known = [block.temperature_c for block in self.plan.blocks]
        return max(known) - min(known)

    @property
    def n_levels(self) -> int:
        """Different levels of light."""
        return len({block.level for block in self.plan.flats})

    @property
    def n_exposures(self) -> int:
        """Different exposures of lit blocks."""
        return len({block.exposure_us for block in self.plan.flats})

    @property
    def top_exposure_us(self) -> float:
        """The longest."""
        return max(block.exposure_us for block in self.plan.blocks)

    @property
    def has_darks(self) -> bool:
        """Whether a block is capped."""
        return bool(self.plan.dark_blocks)

    @property
    def _pixels(self) -> int:
        return self.sensor.rows * self.sensor.columns

    def _electrons(self, radiance: float, exposure_us: float) -> float:
        return radiance * exposure_us * self.sensor.electrons_per_radiance_us
