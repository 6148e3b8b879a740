"""Pixels that stand out of all others: by what their samples or their means miss."""

import numpy as np
from numpy.typing import NDArray

from calib.diagnosis.evidence.mean_space import MeanSpace
from calib.diagnosis.evidence.rare_space import whitened_counts

Floats = NDArray[np.float64]

NEAR_SIGMA, FAR_SIGMA = 5.0, 12.0
"""Pixels between these and beyond are counted, of their variances and of their means' misfit."""
N_STEPS = 3
MAD_OF_NORMAL = 0.6745
"""Median absolute deviation of a standard normal variable."""


def steps(z: Floats) -> Floats:
    """Return how many pixels stand out of all others: what all do is in the means."""
    middle = np.median(z)
    z = (z - middle) / max(float(np.median(np.abs(z - middle))) / MAD_OF_NORMAL, 1.0)
    far = z > FAR_SIGMA
    kinds = ((z > NEAR_SIGMA) & ~far, far, z < -NEAR_SIGMA)
    return whitened_counts(np.array([kind.sum() for kind in kinds], np.float64))


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
