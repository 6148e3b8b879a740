"""Exact sums over lines, column by column: codes, squares, clipped samples, lagged products.

Eight lines are added up per visit of a column's sums, which saves memory traffic. Clipped samples
are counted only where the eight lines' lowest or highest code says that there are any. Sums of
codes run in 32 bits, counts in 16, and both are flushed every 65,528 lines, before they overflow
at full scale; squares and products run in 64 bits (a single full-scale 16-bit square takes all of
32). Threads are Python's: the kernels release the interpreter, every thread takes its own run of
lines, and no threading layer of Numba's is started, which would be unsafe to fork.
"""

from concurrent.futures import Executor

import numpy as np
from numba import njit, uint16, uint32, uint64

from calib.arrays import RawLines
from calib.kernels.line_sums import LaggedSums, LineSums

# Columns whose sums fit the second-level cache together.
_TILE = 8192
_FLUSH_LINES = 65528


def line_sums(
    dn: RawLines,
    full_scale_dn: int,
    *,
    first: int = 0,
    step: int = 1,
    pool: Executor | None = None,
    n_threads: int = 2,
) -> LineSums:
    """Return the sums over the lines first, first + step, … of `dn`, (n_lines, n_columns).

    Args:
        dn: Codes, best several frames at once; one C-contiguous array.
        full_scale_dn: Codes from here on count as clipped.
        first: The first line.
        step: From one line to the next.
        pool: Where given, its threads share the lines, `n_threads` runs of them.
        n_threads: How many runs.
    """
    lines = range(first, len(dn), step)
    runs = 1 if pool is None else n_threads
    edges = [lines.start + step * (len(lines) * k // runs) for k in range(runs + 1)]

    def run(k: int) -> LineSums:
        stop = len(dn) if k + 1 == runs else edges[k + 1]
        sums = LineSums.zero(dn.shape[1])
        _add_lines(
            dn, full_scale_dn, edges[k], stop, step,
            sums.codes, sums.squares, sums.at_zero, sums.at_full_scale,
        )  # fmt: skip
        n_lines = len(range(edges[k], stop, step))
        return LineSums(n_lines, sums.codes, sums.squares, sums.at_zero, sums.at_full_scale)

    parts = map(run, range(runs)) if pool is None else pool.map(run, range(runs))
    return sum(parts, LineSums.zero(dn.shape[1]))


def lagged_sums(dn: RawLines, full_scale_dn: int) -> LaggedSums:
    """Return sums and lagged products of consecutive lines, (n_lines, n_columns)."""
    columns, lines = (np.zeros(dn.shape[1], np.uint64) for _ in range(2))
    _add_products(dn, columns, lines)
    return LaggedSums(line_sums(dn, full_scale_dn), columns[:-1], lines)


@njit(cache=True, nogil=True)
def _add_lines(dn, full_scale, first, last, step, codes, squares, at_zero, at_full):  # type: ignore[no-untyped-def]  # noqa: PLR0917 - compiled
    top = uint16(full_scale)
    for left in range(0, dn.shape[1], _TILE):
        right = min(left + _TILE, dn.shape[1])
        square = squares[left:right]
        total = np.zeros(right - left, np.uint32)
        zeros, fulls = np.zeros(right - left, np.uint16), np.zeros(right - left, np.uint16)
        line = first
        while line < last:
            stop = min(last, line + _FLUSH_LINES * step)
            while line + 7 * step < stop:
                rows = _eight_rows(dn, line, step, left, right)
                lowest, highest = _add_eight(rows, total, square)
                if lowest == 0 or highest >= top:
                    _count_eight(rows, top, zeros, fulls)
                line += 8 * step
            while line < stop:
                _add_one(dn[line, left:right], top, total, square, zeros, fulls)
                line += step
            codes[left:right] += total
            at_zero[left:right] += zeros
            at_full[left:right] += fulls
            total[:], zeros[:], fulls[:] = 0, 0, 0


@njit(cache=True, nogil=True, inline="always")
def _eight_rows(dn, line, step, left, right):  # type: ignore[no-untyped-def]
    return (
        dn[line, left:right], dn[line + step, left:right],
        dn[line + 2 * step, left:right], dn[line + 3 * step, left:right],
        dn[line + 4 * step, left:right], dn[line + 5 * step, left:right],
        dn[line + 6 * step, left:right], dn[line + 7 * step, left:right],
    )  # fmt: skip


@njit(cache=True, nogil=True, inline="always")
def _add_eight(rows, total, squares):  # type: ignore[no-untyped-def]
    """Add eight lines; return the lowest and the highest code in them."""
    row0, row1, row2, row3, row4, row5, row6, row7 = rows
    lowest, highest = uint32(65535), uint32(0)
    for i in range(len(total)):
        a, b, c, d = uint32(row0[i]), uint32(row1[i]), uint32(row2[i]), uint32(row3[i])
        e, f, g, h = uint32(row4[i]), uint32(row5[i]), uint32(row6[i]), uint32(row7[i])
        total[i] += a + b + c + d + e + f + g + h
        squares[i] += (
            uint64(a * a) + uint64(b * b) + uint64(c * c) + uint64(d * d)
            + uint64(e * e) + uint64(f * f) + uint64(g * g) + uint64(h * h)
        )  # fmt: skip
        lowest = min(lowest, a, b, c, d, e, f, g, h)
        highest = max(highest, a, b, c, d, e, f, g, h)
    return lowest, highest


@njit(cache=True, nogil=True, inline="always")
def _count_eight(rows, top, zeros, fulls):  # type: ignore[no-untyped-def]
    row0, row1, row2, row3, row4, row5, row6, row7 = rows
    for i in range(len(zeros)):
        a, b, c, d = uint16(row0[i]), uint16(row1[i]), uint16(row2[i]), uint16(row3[i])
        e, f, g, h = uint16(row4[i]), uint16(row5[i]), uint16(row6[i]), uint16(row7[i])
        zeros[i] += (
            uint16(a == 0) + uint16(b == 0) + uint16(c == 0) + uint16(d == 0)
            + uint16(e == 0) + uint16(f == 0) + uint16(g == 0) + uint16(h == 0)
        )  # fmt: skip
        fulls[i] += (
            uint16(a >= top) + uint16(b >= top) + uint16(c >= top) + uint16(d >= top)
            + uint16(e >= top) + uint16(f >= top) + uint16(g >= top) + uint16(h >= top)
        )  # fmt: skip


@njit(cache=True, nogil=True, inline="always")
def _add_one(row, top, total, squares, zeros, fulls):  # type: ignore[no-untyped-def]  # noqa: PLR0917 - compiled
    for i in range(len(total)):
        a = uint32(row[i])
        total[i] += a
        squares[i] += uint64(a * a)
        zeros[i] += uint16(a == 0)
        fulls[i] += uint16(a >= top)


@njit(cache=True, nogil=True)
def _add_products(dn, columns, lines):  # type: ignore[no-untyped-def]
    n_lines, n_columns = dn.shape
    for left in range(0, n_columns, _TILE):
        right = min(left + _TILE, n_columns)
        beyond = min(right, n_columns - 1) + 1
        along, below = columns[left : beyond - 1], lines[left:right]
        line = 0
        while line + 4 < n_lines:
            _below_four(
                dn[line, left:right], dn[line + 1, left:right], dn[line + 2, left:right],
                dn[line + 3, left:right], dn[line + 4, left:right], below,
            )  # fmt: skip
            _along_four(
                dn[line, left:beyond], dn[line + 1, left:beyond],
                dn[line + 2, left:beyond], dn[line + 3, left:beyond], along,
            )  # fmt: skip
            line += 4
        while line < n_lines:
            for i in range(len(along)):
                a, b = uint32(dn[line, left + i]), uint32(dn[line, left + i + 1])
                along[i] += uint64(a * b)
            if line + 1 < n_lines:
                for i in range(len(below)):
                    a, b = uint32(dn[line, left + i]), uint32(dn[line + 1, left + i])
                    below[i] += uint64(a * b)
            line += 1


@njit(cache=True, nogil=True, inline="always")
def _below_four(line0, line1, line2, line3, line4, products):  # type: ignore[no-untyped-def]  # noqa: PLR0917 - compiled
    for i in range(len(products)):
        a, b, c = uint32(line0[i]), uint32(line1[i]), uint32(line2[i])
        d, e = uint32(line3[i]), uint32(line4[i])
        products[i] += uint64(a * b) + uint64(b * c) + uint64(c * d) + uint64(d * e)


@njit(cache=True, nogil=True, inline="always")
def _along_four(line0, line1, line2, line3, products):  # type: ignore[no-untyped-def]
    for i in range(len(products)):
        a = uint32(line0[i]) * uint32(line0[i + 1])
        b = uint32(line1[i]) * uint32(line1[i + 1])
        c = uint32(line2[i]) * uint32(line2[i + 1])
        d = uint32(line3[i]) * uint32(line3[i + 1])
        products[i] += uint64(a) + uint64(b) + uint64(c) + uint64(d)
