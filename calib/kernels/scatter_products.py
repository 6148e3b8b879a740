"""Sums of products over a block's lines that are weighted sums of a few: no line is made itself."""

import numpy as np
from numba import njit
from numpy.typing import NDArray

from calib.kernels.residual_products import COLUMN_LAGS

Floats = NDArray[np.float64]


def scatter_products(
    few: Floats, gram: Floats, times: Floats, partner: NDArray[np.intp]
) -> tuple[Floats, Floats, Floats, Floats, Floats, Floats]:
    """Return squares, fourth powers, and products with columns, lines, rows and partners.

    Line n is sum_i B_ni r_i; the sum of products of lines d apart is sum_ij G_dij r_i r_j, with
    G_d the sum over n of B_ni B_(n+d)j. Shapes are those of `ResidualProducts`, with a first axis
    of blocks.

    Args:
        few: The few lines r of each block, (n_blocks, k, n_rows, n_columns).
        gram: G, (1 + lags, k, k).
        times: For how many lines each stands in fourth powers, (k,).
        partner: The column with which each is paired, (n_partners, n_columns), -1 for none.
    """
    n_blocks, k, *shape = few.shape
    squares, fourths, rows = np.zeros((3, n_blocks, *shape))
    columns = np.zeros((n_blocks, COLUMN_LAGS, *shape))
    lines = np.zeros((n_blocks, len(gram) - 1, *shape))
    partners = np.zeros((n_blocks, len(partner), *shape))
    for b, own in enumerate(few):
        along = np.dot(gram.reshape(-1, k), own.reshape(k, -1)).reshape(len(gram), k, *shape)
        _add(
            own, along, times, partner, squares[b], fourths[b], columns[b], lines[b], rows[b],
            partners[b],
        )  # fmt: skip
    return squares, fourths, columns, lines, rows, partners


@njit(cache=True, nogil=True)
def _add(few, along, times, partner, squares, fourths, columns, lines, rows, partners):  # type: ignore[no-untyped-def]  # noqa: PLR0917 - compiled
    n_rows = squares.shape[0]
    for i in range(few.shape[0]):
        for r in range(n_rows):
            now, summed = few[i, r], along[0, i, r]
            _own(now, summed, times[i], squares[r], fourths[r])
            for d in range(1, columns.shape[0] + 1):
                n = max(now.shape[0] - d, 0)
                _product(summed[:n], now[d:], columns[d - 1, r])
            for d in range(1, along.shape[0]):
                _product(now, along[d, i, r], lines[d - 1, r])
            if r + 1 < n_rows:
                _product(summed, few[i, r + 1], rows[r])
            for p in range(partner.shape[0]):
                _pairs(summed, now, partner[p], partners[p, r])


@njit(cache=True, nogil=True)
def _own(now, summed, times, squares, fourths):  # type: ignore[no-untyped-def]  # compiled
    for c in range(now.shape[0]):
        squares[c] += summed[c] * now[c]
        square = now[c] * now[c]
        fourths[c] += times * square * square


@njit(cache=True, nogil=True)
def _product(left, right, into):  # type: ignore[no-untyped-def]  # compiled
    for c in range(left.shape[0]):
        into[c] += left[c] * right[c]


@njit(cache=True, nogil=True)
def _pairs(summed, now, partner, into):  # type: ignore[no-untyped-def]  # compiled
    for c in range(now.shape[0]):
        if partner[c] >= 0:
            into[c] += summed[c] * now[partner[c]]
