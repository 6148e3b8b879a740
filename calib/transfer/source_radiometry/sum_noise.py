"""How far sums over pixels scatter: of the means' step and of the variances' rise."""

from dataclasses import dataclass
from typing import Self

import numpy as np

from calib.recording.block_statistics import BlockStatistics
from calib.transfer.source_radiometry.region_sums import Mask, RegionSums


@dataclass(frozen=True)
class SumNoise:
    """Variances of D = sum (D2 - D1) and R = sum (V2 - V1) over a region, and their covariance.

    For n frames of variance s^2, the mean scatters by s^2 / n, the variance by 2 s^4 / (n - 1) +
    k4 / n, and the two together by k3 / n. Poisson electrons have k3 = G^2 S and k4 = G^3 S with
    their signal S in DN; Gaussian noise has neither.

    Source: Kendall and Stuart, The Advanced Theory of Statistics, volume 1, chapter 12
    (k-statistics).

    Attributes:
        step: Variance of D, DN^2.
        rise: Variance of R, DN^4.
        both: Their covariance, DN^3.
    """

    step: float
    rise: float
    both: float

    @classmethod
    def of(
        cls, first: BlockStatistics, second: BlockStatistics, region: Mask, sums: RegionSums
    ) -> Self:
        """Return the noise of `sums`, which are those of `region`."""
        signals_dn = (sums.per_step * sums.step_dn, (1 + sums.per_step) * sums.step_dn)
        step = rise = both = 0.0
        for block, signal_dn in zip((first, second), signals_dn, strict=True):
            n, variance = block.n_lines, block.variance_dn2[region]
            # The square of a sample variance is too large by 2 / (n - 1) of it.
            fourth = float(np.square(variance).sum()) * (n - 1) / (n + 1)
            step += float(variance.sum()) / n
            rise += 2 * fourth / (n - 1) + sums.gain**3 * signal_dn / n
            both += sums.gain**2 * signal_dn / n
        return cls(step, rise, both)

    def of_gain(self, sums: RegionSums) -> float:
        """Return the relative variance of R / D."""
        step, rise = sums.step_dn, sums.rise_dn2
        return self.rise / rise**2 + self.step / step**2 - 2 * self.both / (rise * step)

    def of_charge(self, sums: RegionSums, light_dn: float, ground: float) -> float:
        """Return the relative variance of L D / R, where L is D less what the ground gives.

        `ground` is the variance of what the ground gives, DN^2.
        """
        of_light = (self.step + ground) / light_dn**2 + 2 * self.step / (light_dn * sums.step_dn)
        with_rise = 2 * self.both / (light_dn * sums.rise_dn2)
        return self.of_gain(sums) + of_light - with_rise
