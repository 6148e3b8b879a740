"""The highpass filter that keeps uneven light out of the nonuniformities.

Source: EMVA Standard 1288, Release 4.0 Linear, section 8.1: a lowpass of a 7 × 7 box, an 11 × 11
box and a 3 × 3 binomial filter is subtracted from the averaged image.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import convolve1d

from calib.transfer.emva1288.block_image import Image

_LOWPASS = np.convolve(np.convolve(np.ones(7) / 7, np.ones(11) / 11), np.array([1, 2, 1]) / 4)
REACH = len(_LOWPASS) // 2
"""So many pixels at each edge lack a neighbour and are left out."""
LEAST = 2 * REACH + 8
"""A side shorter than this is not filtered."""


@dataclass(frozen=True)
class Loss:
    """What the filter leaves of white patterns.

    Attributes:
        power: Share of the variance that is left.
        spread: By how much the variance of a sum of squares is above that of as many
            independent numbers, since neighbours are correlated afterwards.
    """

    power: float
    spread: float


def highpass(image: Image) -> Image:
    """Return the image less its lowpass, without the edges; along the line for one row.

    (n_rows − 18, n_columns − 18), or (1, n_columns − 18) of a line sensor.
    """
    low: Image = convolve1d(image, _LOWPASS, axis=1, mode="nearest")
    inner = slice(REACH, -REACH)
    if image.shape[0] == 1:
        return image[:, inner] - low[:, inner]
    low = convolve1d(low, _LOWPASS, axis=0, mode="nearest")
    return image[inner, inner] - low[inner, inner]


def _loss(lowpass: NDArray[np.float64]) -> Loss:
    reach = tuple(side // 2 for side in lowpass.shape)
    kernel = -lowpass
    kernel[reach] += 1.0
    roomy = np.pad(kernel, [(0, side) for side in lowpass.shape])  # so that nothing wraps
    power = np.abs(np.fft.fftn(roomy)) ** 2
    return Loss(float(np.mean(power)), float(np.mean(power**2) / np.mean(power) ** 2))


ALONG = _loss(_LOWPASS.copy())
"""Of a pattern along one axis: a line sensor's, or columns and rows."""
ACROSS = _loss(np.outer(_LOWPASS, _LOWPASS))
"""Of a pattern that differs from pixel to pixel."""
UNTOUCHED = Loss(1.0, 1.0)
"""Of a pattern that is not filtered."""
