"""What is counted: samples that stand out, pixels that often do, lines that come twice."""

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]

RARE = ("outliers_above", "outliers_below", "noisy_pixels", "identical_lines")
"""Names of the counts."""
FAR_SIGMA = 7.5
"""Samples farther out than this are counted."""
FEWEST_PIXELS = 8
"""Lines of so few pixels may be alike by chance."""
MOST_PAIRS = 64
"""Of neighbouring lines, that tell how often pixels are alike by chance."""
UNLIKELY = 1e-3
"""So many repeated lines of a block may be expected by chance."""
OFTEN = 3
"""Outliers in one pixel and block that make it a noisy one: no accident of single samples."""


def repeated_lines(samples: NDArray[np.generic]) -> NDArray[np.bool_]:
    """Return which lines, (n_lines,), repeat the one before them code for code.

    None where the noise is so low that lines are alike by chance.

    Args:
        samples: (n_lines, n_rows, n_columns).
    """
    flat = samples.reshape(len(samples), -1)
    repeated = np.zeros(len(flat), bool)
    if flat.shape[1] <= FEWEST_PIXELS:
        return repeated
    # A few pixels tell most lines apart.
    few = (flat[1:, :FEWEST_PIXELS] == flat[:-1, :FEWEST_PIXELS]).all(axis=1)
    at = np.flatnonzero(few) + 1
    at = at[[np.array_equal(flat[k], flat[k - 1]) for k in at]] if len(at) else at
    if len(at) == 0:
        return repeated
    repeated[at] = True
    different = np.flatnonzero(~repeated[1:])[:MOST_PAIRS] + 1
    alike = (flat[different] == flat[different - 1]).mean(axis=0) if len(different) else np.ones(1)
    by_chance = len(flat) * np.exp(np.log(np.maximum(alike, 1.0 / MOST_PAIRS)).sum())
    return repeated if by_chance < UNLIKELY else np.zeros(len(flat), bool)


def rare_counts(
    samples: NDArray[np.generic],
    mean: Floats,
    sigma: Floats,
    outliers: NDArray[np.int64],
    repeated: int,
) -> Floats:
    """Return how often each of `RARE` happens in a block, (4,).

    Args:
        samples: (n_lines, n_rows, n_columns).
        mean: Of each pixel, (n_rows, n_columns).
        sigma: Its standard deviation, likewise.
        outliers: How many samples of each pixel are beyond the cut, likewise.
        repeated: Lines that were left out since they repeat the one before.
    """
    flat = samples.reshape(len(samples), -1)
    often = outliers.ravel() >= OFTEN
    single = np.flatnonzero((outliers.ravel() > 0) & ~often)
    size = (flat[:, single].astype(np.float64) - mean.ravel()[single]) / sigma.ravel()[single]
    return np.array(
        [(size > FAR_SIGMA).sum(), (size < -FAR_SIGMA).sum(), often.sum(), repeated], np.float64
    )


def rare_trials(n_lines: float, n_pixels: int) -> Floats:
    """Return how often each of `RARE` could have happened, (4,)."""
    samples = n_lines * n_pixels
    return np.array([samples, samples, n_pixels, max(n_lines - 1, 1)], np.float64)
