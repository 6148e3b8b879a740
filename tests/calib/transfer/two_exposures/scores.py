"""What z-scores have to be like: mean 0 and spread 1, within multiples of their standard errors."""

import numpy as np
from numpy.typing import NDArray

Z = NDArray[np.float64]


def spread_of(z: Z) -> tuple[float, float]:
    """Return the standard deviation of z and its standard error, which tails enlarge."""
    centred = z - z.mean()
    spread = float(z.std(ddof=1))
    return spread, float(np.std(centred**2) / (2.0 * spread * np.sqrt(z.size)))


def mean_of(z: Z) -> tuple[float, float]:
    """Return the mean of z and its standard error."""
    return float(z.mean()), float(z.std(ddof=1) / np.sqrt(z.size))
