"""The vignette's fit as rows of unit variance, with the scatter that makes them so."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from calib.arrays import Columns

OUTLIER_SIGMA = 6.0
ITERATIONS = 8
SETTLED = 1e-8

Matrix = NDArray[np.float64]


@dataclass(frozen=True)
class Whitened:
    """Rows divided by their standard deviation, for the columns in use."""

    design: Matrix
    target: Columns
    scatter: float
    use: NDArray[np.bool_]
    relative_sigma: Columns
    profile: Columns


def whitened_rows(
    design: Matrix,
    slope: Columns,
    variance: Columns,
    use: NDArray[np.bool_],
    order: int,
    *,
    start: Whitened | None = None,
) -> Whitened:
    """Find profile, ε and outliers in turn, until ε stands still.

    The last `order` + 1 columns of `design` are the polynomial, those before it the taps. `start`
    is where another order ended, from which few turns lead on.
    """
    n_taps = design.shape[1] - order - 1
    typical = float(np.nanmedian(slope[use]))
    floor, noise = 1e-3 * typical, np.nan_to_num(variance)
    profile, scatter, following = np.full_like(slope, typical), 0.1, use
    if start is not None:
        profile, scatter, following = start.profile, start.scatter, start.use
    for _ in range(ITERATIONS):
        last, kept = scatter, following
        rows = design
        if n_taps:
            rows = np.hstack([design[:, :n_taps] * profile[:, None], design[:, n_taps:]])
        relative = np.sqrt(scatter**2 + noise / profile**2)
        sigma = relative * profile
        scaled_rows = rows * np.where(kept, 1.0 / sigma, 0.0)[:, None]
        target = np.where(kept, slope / sigma, 0.0)
        solution = np.linalg.solve(scaled_rows.T @ scaled_rows, scaled_rows.T @ target)
        profile = np.maximum(design[:, n_taps:] @ solution[n_taps:], floor)
        rest = (slope - rows @ solution) / profile
        freedom = max(int(kept.sum()) - design.shape[1], 1)
        own = noise / profile**2
        scatter = _scatter(rest[kept], own[kept], freedom)
        total = np.sqrt(scatter**2 + own)
        robust = 1.4826 * np.median(np.abs(rest[kept] / total[kept]))
        following = use & (np.abs(rest) <= OUTLIER_SIGMA * max(robust, 1e-12) * total)
        if abs(scatter - last) < SETTLED * scatter and (following == kept).all():
            break
    return Whitened(scaled_rows[kept], target[kept], scatter, kept, relative, profile)


def _scatter(rest: Columns, variance: Columns, freedom: int) -> float:
    """Return ε: what the relative residuals scatter beyond the slopes' own noise."""
    return float(np.sqrt(max((rest**2).sum() / freedom - variance.mean(), 1e-12)))
