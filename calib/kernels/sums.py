"""Exact sums over lines, column by column: codes, squares, clipped samples, lagged products.

Four lines are added up per visit of a column's sums, which halves the memory traffic. Sums of
codes run in 32 bits inside the loop and are flushed every 65,536 lines, before full-scale 16-bit
codes overflow them; squares and products run in 64 bits (a single full-scale 16-bit square takes
all of 32). Threads are Python's: the kernels release the interpreter, every thread takes its own
run of lines, and no threading layer of Numba's is started, which would be unsafe to fork.
"""

from concurrent.futures import Executor

import numpy as np
from numba import njit, uint32, uint64

from calib.arrays import RawLines
from calib.kernels.line_sums import LaggedSums, LineSums

# Columns whose sums fit the second-level cache together.
_TILE = 8192
_FLUSH_LINES = 65536


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
    top = uint32(full_scale)
    for left in range(0, dn.shape[1], _TILE):
        width = min(_TILE, dn.shape[1] - left)
        right = left + width
        total = np.zeros(width, np.uint32)
        line = first
        while line < last:
            stop = min(last, line + _FLUSH_LINES * step)
            q, z, f = squares[left:right], at_zero[left:right], at_full[left:right]
            while line + 3 * step < stop:
                _add_four(
                    dn[line, left:right], dn[line + step, left:right],
                    dn[line + 2 * step, left:right], dn[line + 3 * step, left:right],
                    top, total, q, z, f,
                )  # fmt: skip
                line += 4 * step
            while line < stop:
                _add_one(dn[line, left:right], top, total, q, z, f)
                line += step
            for i in range(width):
                codes[left + i] += total[i]
                total[i] = 0


@njit(cache=True, nogil=True, inline="always")
def _add_four(line0, line1, line2, line3, top, total, squares, at_zero, at_full):  # type: ignore[no-untyped-def]  # noqa: PLR0917 - compiled
    for i in range(len(total)):
        a, b, c, d = uint32(line0[i]), uint32(line1[i]), uint32(line2[i]), uint32(line3[i])
        total[i] += a + b + c + d
        squares[i] += uint64(a * a) + uint64(b * b) + uint64(c * c) + uint64(d * d)
        at_zero[i] += uint32(a == 0) + uint32(b == 0) + uint32(c == 0) + uint32(d == 0)
        at_full[i] += uint32(a >= top) + uint32(b >= top) + uint32(c >= top) + uint32(d >= top)


@njit(cache=True, nogil=True, inline="always")
def _add_one(line, top, total, squares, at_zero, at_full):  # type: ignore[no-untyped-def]  # noqa: PLR0917 - compiled
    for i in range(len(total)):
        a = uint32(line[i])
        total[i] += a
        squares[i] += uint64(a * a)
        at_zero[i] += uint32(a == 0)
        at_full[i] += uint32(a >= top)


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
