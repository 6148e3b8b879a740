"""What is counted: samples that stand out, pixels that often do, lines that come twice."""

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]

RARE = ("outliers_above", "outliers_below", "noisy_pixels", "identical_lines")
"""Names of the counts."""
FAR_SIGMA = 7.5
"""Samples farther out than this are counted."""
OFTEN = 3
"""Outliers in one pixel and block that make it a noisy one: no accident of single samples."""


def rare_counts(
    samples: NDArray[np.generic], mean: Floats, sigma: Floats, outliers: NDArray[np.int64]
) -> Floats:
    """Return how often each of `RARE` happens in a block, (4,).

    Args:
        samples: (n_lines, n_rows, n_columns).
        mean: Of each pixel, (n_rows, n_columns).
        sigma: Its standard deviation, likewise.
        outliers: How many samples of each pixel are beyond the cut, likewise.
    """
    flat = samples.reshape(len(samples), -1)
    identical = float((flat[1:] == flat[:-1]).all(axis=1).sum()) if flat.shape[1] > 8 else 0.0
    often = outliers.ravel() >= OFTEN
    single = np.flatnonzero((outliers.ravel() > 0) & ~often)
    size = (flat[:, single].astype(np.float64) - mean.ravel()[single]) / sigma.ravel()[single]
    return np.array(
        [(size > FAR_SIGMA).sum(), (size < -FAR_SIGMA).sum(), often.sum(), identical], np.float64
    )


def rare_trials(n_lines: float, n_pixels: int) -> Floats:
    """Return how often each of `RARE` could have happened, (4,)."""
    samples = n_lines * n_pixels
    return np.array([samples, samples, n_pixels, max(n_lines - 1, 1)], np.float64)
