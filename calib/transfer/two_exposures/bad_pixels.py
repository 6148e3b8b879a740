"""A bad-pixel map from the maps of gain, bias and read noise.

A value is an outlier where it lies far from its fellows in units of what it may differ by: the
uncertainty that a pixel so lit has, and the pixels' true scatter, which the median absolute
deviation tells. The uncertainty is the median over pixels of the same signal, not the pixel's own:
of a noisy pixel that is large, and would excuse it; one that came out small by chance would accuse
a good one. A gain that is merely noisy makes no pixel bad; many frames make finer faults visible.
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
_GROUP = 200  # pixels of about the same signal, or more


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
    lit = maps.signal_dn
    gain = robust_z(maps.system_gain_dn_per_e, maps.system_gain_dn_per_e_std, lit)
    bias = robust_z(maps.bias_dn, maps.bias_dn_std, lit)
    noise = robust_z(maps.read_noise_variance_dn2, maps.read_noise_variance_dn2_std, lit)
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


def robust_z(values: Pixels, std: Pixels, signal_dn: Pixels) -> Pixels:
    """Return how far values lie from their median, by uncertainty and true scatter together.

    Where there is no value, 0.
    """
    known = np.isfinite(values) & np.isfinite(std) & np.isfinite(signal_dn)
    z = np.zeros_like(values)
    if not known.any():
        return z
    typical = _typical(std[known], signal_dn[known])
    off = values[known] - np.median(values[known])
    spread = float(median_abs_deviation(values[known], scale="normal"))
    true2 = max(spread**2 - float(np.median(typical)) ** 2, 0.0)
    z[known] = off / np.sqrt(typical**2 + true2)
    return z


def _typical(std: Pixels, signal_dn: Pixels) -> Pixels:
    """Return the median of `std` over the pixels of about the same signal."""
    n_groups = int(np.clip(std.size // _GROUP, 1, 64))
    order = np.argsort(signal_dn, kind="stable")
    typical = np.empty_like(std)
    for group in np.array_split(order, n_groups):
        typical[group] = np.median(std[group])
    return typical
