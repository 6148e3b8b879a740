"""A bad-pixel map from the maps of gain, bias and read noise.

A value is an outlier where it lies far from its fellows in units of what it may differ by: its
uncertainty and the pixels' true scatter, which the median absolute deviation tells. A gain that is
merely noisy does not make a pixel bad; many frames make finer faults visible.
"""

from dataclasses import dataclass
from enum import IntFlag

import numpy as np
from numpy.typing import NDArray
from scipy.stats import median_abs_deviation

from calib.kernels.pixel_sums import Pixels
from calib.transfer.two_exposures.pixel_maps import PixelMaps
from calib.transfer.two_exposures.pixel_state import PixelState

OUTLIER_SIGMA = 6.0


class Defect(IntFlag):
    """What is wrong with a pixel; several may be."""

    NONE = 0
    DEAD = 1
    """One code whatever happens, or no response to light."""
    CLIPPED = 2
    """Stands at an end of the code range at these exposures: hot, or too brightly lit."""
    GAIN = 4
    """Its system gain differs."""
    BIAS = 8
    """Its bias differs."""
    NOISY = 16
    """Its read noise variance is larger."""
    HOT = 32
    """Its bias is larger, and so is its read noise variance: it leaks."""


@dataclass(frozen=True)
class BadPixels:
    """The map.

    Attributes:
        defect: `Defect` of each pixel, uint8, (n_pixels,).
    """

    defect: NDArray[np.uint8]

    @property
    def bad(self) -> NDArray[np.bool_]:
        """Which pixels have any defect, (n_pixels,)."""
        return np.not_equal(self.defect, Defect.NONE)

    def counts(self) -> dict[str, int]:
        """Return how many pixels have each defect that occurs.

        >>> BadPixels(np.array([0, 1, 24], np.uint8)).counts()
        {'dead': 1, 'bias': 1, 'noisy': 1}
        """
        number = {d: int(np.count_nonzero(self.defect & d)) for d in Defect if d}
        return {str(d.name).lower(): n for d, n in number.items() if n}


def bad_pixels(maps: PixelMaps, outlier_sigma: float = OUTLIER_SIGMA) -> BadPixels:
    """Return which pixels are bad, and why.

    Args:
        maps: Of `sanuc` or `s3nuc`.
        outlier_sigma: From how many standard deviations on a value is an outlier; 6 leaves one
            good Gaussian pixel in 10⁹ behind.
    """
    gain = robust_z(maps.system_gain_dn_per_e, maps.system_gain_dn_per_e_std)
    bias = robust_z(maps.bias_dn, maps.bias_dn_std)
    noise = robust_z(maps.read_noise_variance_dn2, maps.read_noise_variance_dn2_std)
    reason = maps.reason
    dead = np.isin(reason, (PixelState.DEAD, PixelState.NO_RESPONSE))
    clipped = np.isin(reason, (PixelState.CLIPPED_AT_ZERO, PixelState.CLIPPED_AT_FULL_SCALE))
    above, noisy = bias > outlier_sigma, noise > outlier_sigma
    defect = np.zeros(reason.size, np.uint8)
    for flag, where in (
        (Defect.DEAD, dead),
        (Defect.CLIPPED, clipped),
        (Defect.GAIN, np.abs(gain) > outlier_sigma),
        (Defect.BIAS, np.abs(bias) > outlier_sigma),
        (Defect.NOISY, noisy),
        (Defect.HOT, above & noisy),
    ):
        defect[where] |= np.uint8(flag)
    return BadPixels(defect)


def robust_z(values: Pixels, std: Pixels) -> Pixels:
    """Return how far values lie from the median, by their uncertainty and true scatter together.

    The true scatter is what the median absolute deviation holds beside the typical uncertainty.
    A pixel's uncertainty counts as no less than the typical one: one that came out small by chance
    makes no outlier. Where there is no value, 0.
    """
    known = np.isfinite(values) & np.isfinite(std)
    if not known.any():
        return np.zeros_like(values)
    middle, typical = np.median(values[known]), np.median(std[known])
    spread = median_abs_deviation(values[known], scale="normal")
    true2 = max(float(spread) ** 2 - float(typical) ** 2, 0.0)
    z = (values - middle) / np.sqrt(np.maximum(std, typical) ** 2 + true2)
    return np.where(known, z, 0.0)
