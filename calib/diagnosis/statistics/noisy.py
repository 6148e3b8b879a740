"""Pixels that are left out of what is pooled: a few that would outweigh all others."""

import numpy as np
from numpy.typing import NDArray

NOISY_SIGMA = 6.0
"""A pixel whose variance or whose means miss by so much is left out."""
MOST_NOISY = 0.05
"""More of them than this share are no exceptions, and are kept."""


def few(pixels: NDArray[np.intp], of: int) -> NDArray[np.intp]:
    """Return `pixels` where they are a small share of all, else none."""
    return pixels if len(pixels) <= MOST_NOISY * of else pixels[:0]
