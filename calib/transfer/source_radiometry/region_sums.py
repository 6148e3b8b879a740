"""Two exposures of one scene, summed over a region of pixels, and how far the sums scatter."""

from dataclasses import dataclass
from typing import Self

import numpy as np
from numpy.typing import NDArray

from calib.transfer.two_exposures.exposure_pair import ExposurePair
from calib.transfer.two_exposures.sampling import sampling_covariances

Mask = NDArray[np.bool_]


@dataclass(frozen=True)
class RegionSums:
    """What the longer exposure has more than the shorter one; noise independent between pixels.

    Attributes:
        n_pixels: Of the region.
        step_dn: D, the sum of the steps of the mean, DN.
        rise_dn2: R, the sum of the rises of the variance, DN^2.
        step_variance: Of D, DN^2.
        rise_variance: Of R, DN^4.
        covariance: Of D and R, DN^3: Poisson numbers are skewed.
    """

    n_pixels: int
    step_dn: float
    rise_dn2: float
    step_variance: float
    rise_variance: float
    covariance: float

    @classmethod
    def of(cls, pair: ExposurePair, region: Mask, gain_dn_per_e: float) -> Self:
        """Return the sums over `region`, (n_pixels,); the gain is for higher cumulants alone."""
        part = pair.at(region)
        scatter = sampling_covariances(part, gain_dn_per_e)
        return cls(
            n_pixels=part.n_pixels,
            step_dn=float(part.difference_dn.sum()),
            rise_dn2=float(part.variance_difference_dn2.sum()),
            step_variance=float(sum(each.mean.sum() for each in scatter)),
            rise_variance=float(sum(each.variance.sum() for each in scatter)),
            covariance=float(sum(each.mean_variance.sum() for each in scatter)),
        )

    @property
    def gain_relative_variance(self) -> float:
        """Of the pooled system gain, R / D."""
        step, rise = self.step_dn, self.rise_dn2
        of_ratio = self.rise_variance / rise**2 + self.step_variance / step**2
        return of_ratio - 2 * self.covariance / (rise * step)

    def charge_relative_variance(self, light_dn: float, ground_variance: float) -> float:
        """Return it of L D / R, where L = `light_dn` is D less what the ground has, DN."""
        of_light = (self.step_variance + ground_variance) / light_dn**2
        with_step = 2 * self.step_variance / (light_dn * self.step_dn)
        with_rise = 2 * self.covariance / (light_dn * self.rise_dn2)
        return self.gain_relative_variance + of_light + with_step - with_rise
