"""Mean of D = D̄₂ − D̄₁ over the neighbours that count, by sums that run along rows and columns.

Rows and columns beyond the edge repeat those at the edge.
"""

import numpy as np
from numba import njit
from numpy.typing import NDArray

from calib.kernels.in_parts import in_parts
from calib.kernels.pixel_sums import Pixels

_FEWEST = 0.5  # neighbours: where none counts the mean is 0
_BAND = 1 << 19  # pixels: sums start anew with each, so that rounding errors do not pile up


def neighbour_means(
    first_dn: Pixels,
    second_dn: Pixels,
    where: NDArray[np.bool_],
    shape: tuple[int, ...],
    n_neighbours: int,
) -> Pixels:
    """Return the mean of D over a square around each pixel, (n_pixels,).

    Args:
        first_dn: D̄₁, (n_pixels,).
        second_dn: D̄₂, (n_pixels,).
        where: The pixels that count, (n_pixels,).
        shape: (n_rows, n_columns), or (n_columns,) of a line sensor.
        n_neighbours: Along each axis, odd.
    """
    columns, half = shape[-1], n_neighbours // 2
    first, second = first_dn.reshape(-1, columns), second_dn.reshape(-1, columns)
    counts, means = where.reshape(-1, columns), np.empty(first.shape)
    half_rows = half if len(shape) > 1 else 0

    def fill(rows: slice) -> None:
        _fill(first, second, counts, half_rows, half, rows.start, rows.stop, means)

    for _ in in_parts(len(means), fill, at_once=max(_BAND // columns, 1)):
        pass
    return means.ravel()


@njit(cache=True, nogil=True)
def _fill(first, second, where, half_rows, half, start, stop, means):  # type: ignore[no-untyped-def]  # noqa: PLR0917 - compiled
    n_rows, n = means.shape
    total, count = np.zeros(n), np.zeros(n)
    for row in range(start - half_rows, start + half_rows):
        k = min(max(row, 0), n_rows - 1)
        _add_row(first[k], second[k], where[k], 1.0, total, count)
    for row in range(start, stop):
        k = min(row + half_rows, n_rows - 1)
        _add_row(first[k], second[k], where[k], 1.0, total, count)
        _along(total, count, half, means[row])
        k = max(row - half_rows, 0)
        _add_row(first[k], second[k], where[k], -1.0, total, count)


@njit(cache=True, nogil=True)
def _add_row(first, second, where, sign, total, count):  # type: ignore[no-untyped-def]  # noqa: PLR0917 - compiled
    for i in range(len(total)):
        weight = sign if where[i] else 0.0
        total[i] += weight * (second[i] - first[i])
        count[i] += weight


@njit(cache=True, nogil=True)
def _along(total, count, half, means):  # type: ignore[no-untyped-def]
    last = len(total) - 1
    s, c = 0.0, 0.0
    for i in range(-half, half):
        s += total[min(max(i, 0), last)]
        c += count[min(max(i, 0), last)]
    for i in range(last + 1):
        s += total[min(i + half, last)]
        c += count[min(i + half, last)]
        means[i] = s / max(c, _FEWEST)
        s -= total[max(i - half, 0)]
        c -= count[max(i - half, 0)]
