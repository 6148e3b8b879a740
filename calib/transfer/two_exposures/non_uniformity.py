"""Non-uniformity correction: an image in DN becomes photo-electrons, pixel by pixel.

Source: Yielding, Cain and Seal (2018), section 1 and 4: K = (D − B)/G. A noisy G makes 1/G too
large by its squared relative uncertainty on average; that is undone, as in `sanuc`.

    u²(K) = (u²(D) + u²(B) + K²·u²(G) + 2K·cov(G, B))/G²

The errors of G and B stay the same from image to image: sums over pixels average them, sums over
images do not. With a single pixel's G they are large (10 % to 30 % at 100 to 1,000 frames); where
pixels are known to differ little in gain, give the pooled one.
"""

from dataclasses import dataclass

import numpy as np

from calib.errors import InputError
from calib.kernels.pixel_sums import Pixels
from calib.transfer.estimate import Estimate
from calib.transfer.two_exposures.pixel_maps import PixelMaps


@dataclass(frozen=True)
class CorrectedImage:
    """Photo-electrons; NaN where the maps do not tell gain or bias (`PixelMaps.reason` says why).

    Attributes:
        photoelectrons: (n_pixels,).
        std: Standard uncertainty, (n_pixels,).
    """

    photoelectrons: Pixels
    std: Pixels


def corrected(
    image_dn: Pixels,
    maps: PixelMaps,
    *,
    image_variance_dn2: Pixels | None = None,
    gain: Estimate | None = None,
) -> CorrectedImage:
    """Return (D − B)/G of an image that is not among the frames that the maps were made from.

    Args:
        image_dn: A frame, or a mean of frames, any shape of n_pixels values.
        maps: Gain and bias.
        image_variance_dn2: Variance of each value of `image_dn`; None leaves it out of the std.
        gain: One system gain for all pixels in place of each pixel's own.

    Raises:
        InputError: `wrong-shape` where the image is not of the maps' pixels.
    """
    dn = np.asarray(image_dn, np.float64).ravel()
    if dn.size != maps.reason.size:
        message = (
            f"the image has {dn.size} pixels, the maps {maps.reason.size}: use the same camera"
        )
        raise InputError(message, code="wrong-shape")
    var_d = 0.0 if image_variance_dn2 is None else np.asarray(image_variance_dn2).ravel()
    if gain is None:
        g, var_g = maps.system_gain_dn_per_e, maps.system_gain_dn_per_e_std**2
        cov = maps.gain_bias_covariance
    else:
        g, var_g = np.full(dn.size, gain.value), np.full(dn.size, gain.std**2)
        cov = np.zeros(dn.size)
    with np.errstate(divide="ignore", invalid="ignore"):
        electrons = (dn - maps.bias_dn) / g
        variance = var_d + maps.bias_dn_std**2 + electrons**2 * var_g + 2.0 * electrons * cov
        std = np.sqrt(np.maximum(variance, 0.0)) / np.abs(g)
        return CorrectedImage(electrons / (1.0 + var_g / g**2), std)
