"""Pixels that stand out of all others: by what their samples or their means miss."""

import numpy as np
from numpy.typing import NDArray

from calib.diagnosis.mean_space import MeanSpace

Floats = NDArray[np.float64]

STEPS_SIGMA = (5.0, 9.0, 16.0, 40.0)
"""Pixels beyond these are counted, of their variances and of their means' misfit."""
N_STEPS = len(STEPS_SIGMA) + 1
MAD_OF_NORMAL = 0.6745
"""Median absolute deviation of a standard normal variable."""
CHANCE_COUNT = 0.05
"""Variance of a count of pixels that should be 0."""


def steps(z: Floats) -> Floats:
    """Return how many pixels stand out of all others: what all do is in the means."""
    middle = np.median(z)
    z = (z - middle) / max(float(np.median(np.abs(z - middle))) / MAD_OF_NORMAL, 1.0)
    counts = np.array([(z > step).sum() for step in STEPS_SIGMA] + [(z < -5.0).sum()], float)
    return np.asarray(counts / np.sqrt(CHANCE_COUNT + 0.1 * counts))


def misfit(space: MeanSpace, means: Floats, exposure_us: Floats, *, observed: bool) -> Floats:
    """Return by how many standard deviations each pixel's means, DN, miss the baseline.

    What grows with the exposure is no misfit: it has a place of its own.
    """
    white, growth = space.project(means), space.project(_each(exposure_us, means))
    length2 = np.einsum("bp,bp->p", growth, growth)
    whole = (space.weight**2 * _each(exposure_us, means) ** 2).sum(axis=0)
    told = length2 > 1e-6 * np.maximum(whole, 1e-300)
    along = np.where(told, np.einsum("bp,bp->p", growth, white), 0.0)
    square = np.einsum("bp,bp->p", white, white) - along**2 / np.where(told, length2, 1.0)
    used = np.maximum((space.weight > 0).sum(axis=0) - len(space.basis) - told, 1)
    if not observed:
        return np.asarray(square / np.sqrt(2.0 * used))
    third = (np.maximum(square, 0.0) / used) ** (1 / 3)
    return np.asarray((third - (1.0 - 2.0 / (9.0 * used))) / np.sqrt(2.0 / (9.0 * used)))


def _each(exposure_us: Floats, means: Floats) -> Floats:
    return np.asarray(np.broadcast_to(exposure_us[:, None], means.shape))
