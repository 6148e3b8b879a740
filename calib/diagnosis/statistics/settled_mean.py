"""Means of pixels of which some samples are far out, which would move the mean and all else."""

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]


def settled_mean(
    samples: NDArray[np.generic], mean: Floats, cut: Floats, outliers: NDArray[np.int64]
) -> Floats:
    """Return `mean`, (n_rows, n_columns), without what is far from the median of its pixel.

    Args:
        samples: (n_lines, n_rows, n_columns).
        mean: Of each pixel; kept where it has no outliers.
        cut: How far is far, likewise.
        outliers: How many samples of each pixel are that far from `mean`.
    """
    found = mean.copy()
    which = np.flatnonzero(outliers)
    values = samples.reshape(len(samples), -1)[:, which].astype(np.float64)
    near = np.abs(values - np.median(values, axis=0)) <= cut.ravel()[which]
    found.ravel()[which] = (values * near).sum(axis=0) / np.maximum(near.sum(axis=0), 1)
    return found
