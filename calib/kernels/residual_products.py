"""Products of residuals between columns, rows and lines of a block, in one pass.

A residual is what a sample differs by from its pixel's mean, less what its line's pixels of the
same tap have in common. Samples farther than a pixel's cut from where their line
stands count as outliers and are left out.
"""

from dataclasses import dataclass, fields

import numpy as np
from numba import njit
from numpy.typing import NDArray

from calib.arrays import Columns
from calib.kernels.line_levels import deviations

COLUMN_LAGS = 4
"""Neighbours at 1 to so many columns."""
LINE_LAGS = 2
"""Likewise of lines, or frames."""

Floats = NDArray[np.float64]


@dataclass(frozen=True)
class ResidualProducts:
    """Sums over the lines (frames) of a block; a pixel stands where its row and column are.

    Attributes:
        total: Sum of deviations from the reference, (n_rows, n_columns).
        squares, fourths: Of the residuals, (n_rows, n_columns).
        columns: Residual times that k columns on, (4, n_rows, n_columns); the last k are 0.
        rows: Residual times that one row on, (n_rows, n_columns); the last row is 0.
        lines: Residual times that of the same pixel k lines on, (2, n_rows, n_columns).
        partners: Residual times the partner's, (n_partners, n_rows, n_columns).
        line_means: Each line's mean deviation by tap, (n_lines, n_rows, n_taps).
        outliers: Samples left out, (n_rows, n_columns).
    """

    total: Floats
    squares: Floats
    fourths: Floats
    columns: Floats
    rows: Floats
    lines: Floats
    partners: Floats
    line_means: Floats
    outliers: NDArray[np.int64]


def residual_products(  # noqa: PLR0917 - sums take what they take
    samples: NDArray[np.generic],
    reference: Floats,
    cut: Floats,
    tap: NDArray[np.intp],
    n_taps: int,
    partner: NDArray[np.intp],
) -> ResidualProducts:
    """Return the sums of `samples`, (n_lines, n_rows, n_columns); a line sensor has one row.

    Args:
        samples: Codes or DN.
        reference: What is taken off each pixel, (n_rows, n_columns); its mean, for residuals.
        cut: A deviation beyond this from the line's level is an outlier, (n_rows, n_columns).
        tap: Which tap reads each pixel, (n_rows, n_columns).
        n_taps: How many there are.
        partner: The column with which each is paired, (n_partners, n_columns), -1 for none.
    """
    stack = stacked_products(samples[None], reference[None], cut[None], tap, n_taps, partner)
    return ResidualProducts(*(getattr(stack, each.name)[0] for each in fields(stack)))


def stacked_products(  # noqa: PLR0917 - likewise
    samples: NDArray[np.generic],
    reference: Floats,
    cut: Floats,
    tap: NDArray[np.intp],
    n_taps: int,
    partner: NDArray[np.intp],
) -> ResidualProducts:
    """Return the sums of several blocks, (n_blocks, n_lines, n_rows, n_columns) of `samples`.

    Everything that belongs to a block, also of what is returned, has a first axis of blocks.
    """
    n_blocks, n, *shape = samples.shape
    sums = ResidualProducts(
        np.zeros((n_blocks, *shape)),
        np.zeros((n_blocks, *shape)),
        np.zeros((n_blocks, *shape)),
        np.zeros((n_blocks, COLUMN_LAGS, *shape)),
        np.zeros((n_blocks, *shape)),
        np.zeros((n_blocks, LINE_LAGS, *shape)),
        np.zeros((n_blocks, len(partner), *shape)),
        np.zeros((n_blocks, n, shape[0], n_taps)),
        np.zeros((n_blocks, *shape), np.int64),
    )
    for b in range(n_blocks):
        _add(
            samples[b], reference[b], cut[b], tap, partner, sums.total[b], sums.squares[b],
            sums.fourths[b], sums.columns[b], sums.rows[b], sums.lines[b], sums.partners[b],
            sums.line_means[b], sums.outliers[b],
        )  # fmt: skip
    return sums


def tap_sizes(tap: NDArray[np.intp], n_taps: int) -> Columns:
    """Return how many pixels of a row belong to each tap, (n_rows, n_taps)."""
    return np.stack([(tap == t).sum(axis=1) for t in range(n_taps)], axis=1).astype(np.float64)


@njit(cache=True, nogil=True, fastmath={"reassoc", "contract"})
def _add(  # type: ignore[no-untyped-def]  # noqa: C901, PLR0917 - compiled
    samples, reference, cut, tap, partner,
    total, squares, fourths, columns, rows, lines, partners, line_means, outliers,
):  # fmt: skip
    n, n_rows, n_columns = samples.shape
    n_taps = line_means.shape[2]
    recent = np.zeros((3, n_rows, n_columns))
    size = np.zeros((n_rows, n_taps))
    for r in range(n_rows):
        for c in range(n_columns):
            size[r, tap[r, c]] += 1.0
    for t in range(n):
        for r in range(n_rows):
            now = recent[t % 3, r]
            deviations(samples[t, r], reference[r], cut[r], now, total[r], outliers[r])
            _take_common(now, tap[r], size[r], line_means[t, r])
            _own(now, squares[r], fourths[r])
            for k in range(1, columns.shape[0] + 1):
                _product(now[: n_columns - k], now[k:], columns[k - 1, r])
            if r > 0:
                _product(recent[t % 3, r - 1], now, rows[r - 1])
            for k in range(1, min(t, lines.shape[0]) + 1):
                _product(recent[(t - k) % 3, r], now, lines[k - 1, r])
            for p in range(partner.shape[0]):
                for c in range(n_columns):
                    if partner[p, c] >= 0:
                        partners[p, r, c] += now[c] * now[partner[p, c]]


@njit(cache=True, nogil=True, fastmath={"reassoc", "contract"})
def _take_common(now, tap, size, means):  # type: ignore[no-untyped-def]  # compiled
    for k in range(means.shape[0]):
        level = 0.0
        for c in range(now.shape[0]):
            level += now[c] if tap[c] == k else 0.0
        means[k] = level / max(size[k], 1.0)
    for c in range(now.shape[0]):
        now[c] -= means[tap[c]]


@njit(cache=True, nogil=True, fastmath={"reassoc", "contract"})
def _own(now, squares, fourths):  # type: ignore[no-untyped-def]  # compiled
    for c in range(now.shape[0]):
        square = now[c] * now[c]
        squares[c] += square
        fourths[c] += square * square


@njit(cache=True, nogil=True, fastmath={"reassoc", "contract"})
def _product(left, right, into):  # type: ignore[no-untyped-def]  # compiled
    for c in range(left.shape[0]):
        into[c] += left[c] * right[c]
