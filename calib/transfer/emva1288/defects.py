"""Defect pixels: how many lie how far from the mean; what is a defect, the application decides.

Source: EMVA Standard 1288, Release 4.0 Linear, sections 4.4 and 8.8.
"""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from calib.transfer.emva1288.block_image import Image

Numbers = NDArray[np.float64]
BINS = 256


@dataclass(frozen=True)
class Histogram:
    """How many pixels lie how far from the mean.

    Attributes:
        deviation: Middles of the bins, from the mean.
        count: Pixels in each.
        distance: Absolute deviations from the mean.
        share_beyond: Share of the pixels that lie as far or farther.
    """

    deviation: Numbers
    count: NDArray[np.int64]
    distance: Numbers
    share_beyond: Numbers


def histogram_of(image: Image, grain: float = 0.0) -> Histogram:
    """Count pixels by their deviation from the mean, in at most 256 bins (Eqs. 73-77).

    Args:
        image: Averaged image, (n_rows, n_columns).
        grain: Values are whole multiples of this, so that bins are, too; 0 where they are not.
    """
    lowest, highest = float(image.min()), float(image.max())
    mean = float(image.mean())
    least = grain or (highest - lowest) / (BINS - 1) or 1.0
    width = least * math.ceil((highest - lowest + least) / (BINS * least) - 1e-9)
    # Half a grain up: a value is never taken for the one below it by rounding.
    index = np.floor((image - lowest + 0.5 * least) / width).astype(np.int64)
    count = np.bincount(index.ravel())
    steps = np.arange(len(count), dtype=np.float64)
    middle: Numbers = steps * width + (lowest + 0.5 * (width - least) - mean)
    apart = np.sort(np.abs(image - mean).ravel())
    distance = np.linspace(0.0, float(apart[-1]), BINS, dtype=np.float64)
    beyond = 1.0 - np.searchsorted(apart, distance, side="left") / apart.size
    return Histogram(middle, count, distance, beyond)
