"""The fit's covariance N⁻¹·(Σ s·sᵀ)·N⁻¹, s the scores of groups of pixels, its correlations shrunk.

The sandwich holds whatever the noise depends on (shot noise follows the signal) as long as groups
are independent. But what is fitted to it weights harmonics with its inverse: a matrix of p unknowns
estimated from n groups is too small in the directions that its inverse favours, by some p/n, and
whatever hangs on these is overconfident. So its correlations are drawn towards those of N⁻¹, as
much as they are noise; variances stay as they are.

Source: Liang and Zeger, Biometrika 73, 13 (1986); Ledoit and Wolf, J. Multivariate Analysis 88, 365
(2004), whose weight is taken where what is expected is the identity.
"""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import blas

from calib.mtf.estimation.normal_equations import Normal
from calib.mtf.estimation.normal_solver import NormalSolver
from calib.mtf.estimation.slopes import Slopes
from calib.mtf.harmonic_sums import Frames

_GROUPS_PER_UNKNOWN = 20
_CHUNK_BYTES = 1 << 27


@dataclass(frozen=True, eq=False)
class Sandwich:
    """A covariance, and what its correlations are drawn to; (n_unknowns, n_unknowns) each.

    Attributes:
        covariance: N⁻¹·(Σ s·sᵀ)·N⁻¹.
        alone: N⁻¹.
        groups: How many equal groups are worth those that it was estimated from.
    """

    covariance: Normal
    alone: Normal
    groups: float

    def of(self, slope: Normal) -> Normal:
        """Return the covariance of slope·unknowns: its own variances, its correlations drawn.

        Args:
            slope: (n, n_first), by the first unknowns; the others have no part in it.
        """
        n = slope.shape[1]
        plain, alone = (slope @ each[:n, :n] @ slope.T for each in (self.covariance, self.alone))
        size = np.sqrt(np.diag(plain) / np.diag(alone))
        expected = alone * np.multiply.outer(size, size)
        weight = shrinkage(np.linalg.solve(expected, plain), self.groups)
        return (1 - weight) * plain + weight * np.asarray(expected)


def sandwich(slopes: Slopes, residual: Frames, normal: Normal, solver: NormalSolver) -> Sandwich:
    """Return the covariance of all unknowns.

    Args:
        slopes: The derivatives at the estimate.
        residual: (n_frames, n_rows, n_columns); 0 where a pixel is left out.
        normal: N.
        solver: Solves for it.
    """
    scatter, groups = _scatter_of_scores(slopes, residual, np.diag(normal))
    half = solver.solve(scatter)
    alone = solver.solve(np.eye(len(normal)))
    return Sandwich(solver.solve(half.T), alone, groups)


def shrinkage(whitened: Normal, groups: float) -> float:
    """Return which share of a matrix's departure from a multiple of the identity is noise.

    Args:
        whitened: A covariance of scores in coordinates in which a multiple of the identity is
            expected, or what has the same traces, (p, p).
        groups: From how many independent scores it was estimated.
    """
    trace, square = float(np.trace(whitened)), float((whitened * whitened.T).sum())
    departure = square - trace**2 / len(whitened)
    noise = (trace**2 + square) / groups  # of a Wishart matrix
    return float(np.clip(noise / departure, 0, 1)) if departure > 0 else 1.0


def scores_by_rows(slopes: Slopes, field: Frames) -> Iterator[NDArray[np.float32]]:
    """Yield the scores of a few rows of pixels at a time, (n_unknowns, n_pixels)."""
    n_rows, n_columns = field.shape[1:]
    rows = max(1, _CHUNK_BYTES // (8 * n_columns * slopes.state.layout.size))
    for first in range(0, n_rows, rows):
        these = slice(first, min(first + rows, n_rows))
        yield slopes.by_pixel(field[:, these], these)


def lower_square(scores: NDArray[np.float32]) -> Normal:
    """Return the lower triangle of scores · scoresᵀ."""
    square: Normal = blas.ssyrk(1.0, scores.T, trans=1, lower=1)
    return square


def whole(lower: Normal) -> Normal:
    """Return the symmetric matrix of a lower triangle."""
    return lower + np.tril(lower, -1).T


def _scatter_of_scores(
    slopes: Slopes, residual: Frames, scale: NDArray[np.floating]
) -> tuple[Normal, float]:
    """Return Σ s·sᵀ over groups of neighbouring pixels, and how many equal groups are worth them.

    Bright groups have larger scores: n groups are worth (Σ q)²/Σ q², q = Σ s²/N_ii.
    """
    size = slopes.state.layout.size
    total = np.zeros((size, size))
    group = max(1, residual[0].size // (_GROUPS_PER_UNKNOWN * size))
    sums = np.zeros(2)
    for scores in scores_by_rows(slopes, residual):
        grouped = np.add.reduceat(scores, np.arange(0, scores.shape[1], group), axis=1)
        total += lower_square(grouped)
        power = (1 / scale) @ np.square(grouped, dtype=np.float64)
        sums += power.sum(), (power**2).sum()
    found = whole(total) * residual.size / max(residual.size - size, 1)
    return found, float(sums[0] ** 2 / max(sums[1], 1e-300))
