"""The vignette's fit as rows of unit variance, with the scatter that makes them so."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from calib.arrays import Columns

OUTLIER_SIGMA = 6.0
ITERATIONS = 8

Matrix = NDArray[np.float64]


@dataclass(frozen=True)
class Whitened:
    """Rows divided by their standard deviation, for the columns in use."""

    design: Matrix
    target: Columns
    scatter: float
    use: NDArray[np.bool_]
    relative_sigma: Columns


def whitened_rows(
    design: Matrix, slope: Columns, variance: Columns, use: NDArray[np.bool_], order: int
) -> Whitened:
    """Find profile, ε and outliers in turn; the last `order` + 1 columns are the polynomial."""
    n_taps = design.shape[1] - order - 1
    profile = np.where(use, slope, np.nan)
    profile = np.full_like(slope, np.nanmedian(profile))
    scatter = 0.1
    kept = following = use
    for _ in range(ITERATIONS):
        kept = following
        rows = design.copy()
        rows[:, :n_taps] *= profile[:, None]
        relative = np.sqrt(scatter**2 + np.nan_to_num(variance) / profile**2)
        sigma = relative * profile
        scaled_rows, target = rows[kept] / sigma[kept, None], slope[kept] / sigma[kept]
        solution = np.linalg.solve(scaled_rows.T @ scaled_rows, scaled_rows.T @ target)
        floor = 1e-3 * np.nanmedian(slope[use])
        profile = np.maximum(design[:, n_taps:] @ solution[n_taps:], floor)
        rest = (slope - rows @ solution) / profile
        freedom = max(int(kept.sum()) - design.shape[1], 1)
        scatter = _scatter(rest[kept], (np.nan_to_num(variance) / profile**2)[kept], freedom)
        total = np.sqrt(scatter**2 + np.nan_to_num(variance) / profile**2)
        robust = 1.4826 * np.median(np.abs(rest[kept] / total[kept]))
        following = use & (np.abs(rest) <= OUTLIER_SIGMA * max(robust, 1e-12) * total)
    return Whitened(scaled_rows, target, scatter, kept, relative)


def _scatter(rest: Columns, variance: Columns, freedom: int) -> float:
    """Return ε: what the relative residuals scatter beyond the slopes' own noise."""
    return float(np.sqrt(max((rest**2).sum() / freedom - variance.mean(), 1e-12)))
