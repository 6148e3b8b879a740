"""Exact sums of differences between two exposures: squares, and products of neighbours.

Everything is counted in whole numbers of 1/64 DN, so that what the columns of a tap share can be
taken off to that resolution and the sums stay exact: products of at most 2⁴⁴ over at most 128 rows
fit double precision (2⁵³), and are added up over stretches of rows in 64-bit integers.
"""

import numpy as np
from numba import njit
from numpy.typing import NDArray

from calib.arrays import RawLines
from calib.kernels.difference_sums import STEPS_PER_DN, Lag, LagSums, RowSums, Steps, TapRuns

_ROWS = 128
_TILE = 2048
_FIRST_CUT = 4  # in limits: how far a difference may pull the first estimate of a row's mean


def first_row_sums(later: RawLines, earlier: RawLines, taps: TapRuns, limit: Steps) -> RowSums:
    """Return sums in which no difference counts for more than four limits.

    Args:
        later: Codes, (n_rows, n_columns).
        earlier: As `later`.
        taps: Of the columns.
        limit: (n_columns,).
    """
    sums = RowSums.zero(len(later), len(taps.runs))
    cut = limit // (STEPS_PER_DN // _FIRST_CUT)
    _add_cut(later, earlier, taps.runs, cut.astype(np.int32), sums.differences)
    sums.counts[:] = -(-(taps.runs[:, 1] - taps.runs[:, 0]) // taps.runs[:, 2])
    return sums


def row_sums(
    later: RawLines, earlier: RawLines, taps: TapRuns, limit: Steps, centre: Steps
) -> RowSums:
    """Return sums over the differences within `limit` of `centre`, (n_rows, n_taps)."""
    sums = RowSums.zero(*centre.shape)
    _add_within(later, earlier, taps.runs, limit, centre, sums.differences, sums.counts)
    return sums


def lag_sums(
    later: RawLines,
    earlier: RawLines,
    taps: TapRuns,
    limit: Steps,
    centre: Steps,
    *,
    lags: tuple[Lag, ...],
) -> LagSums:
    """Return Σ of products of (later − earlier − centre) at every lag of `lags`.

    A difference farther than `limit` from its row's centre takes no part.

    Args:
        later: Codes, (n_rows, n_columns).
        earlier: As `later`.
        taps: Of the columns.
        limit: (n_columns,).
        centre: What the columns of a tap share, (n_rows, n_taps).
        lags: Products are taken inside stretches of 128 rows.
    """
    n_columns = later.shape[1]
    shape = (len(lags), n_columns)
    table = np.array(lags, np.int64).reshape(-1, 2)
    total = LagSums.zero(*shape)
    buffer = np.empty((min(_ROWS, len(later)), n_columns), np.int32)
    for first in range(0, len(later), _ROWS):
        rows = slice(first, min(first + _ROWS, len(later)))
        n_rows = rows.stop - first
        steps = buffer[:n_rows]
        any_far = _residuals(later[rows], earlier[rows], taps.runs, limit, centre[rows], steps)
        sums, missing = np.zeros(shape), np.zeros(shape, np.int64)
        if any_far.any():
            _count_missing(steps, any_far, table, missing)
            steps[steps == _FAR] = 0
        _add_products(steps, table, sums)
        total += LagSums(sums.astype(np.int64), _possible(table, n_rows, n_columns) - missing)
    return total


_FAR = np.int32(-(1 << 31))
"""Marks a difference that takes no part; no difference is as large."""


def _possible(lags: NDArray[np.int64], n_rows: int, n_columns: int) -> NDArray[np.int64]:
    """Return how many products there would be if none were left out, (n_lags, n_columns)."""
    beyond = np.arange(n_columns)[None, :] + lags[:, 1:]
    inside = (beyond >= 0) & (beyond < n_columns)
    return inside.astype(np.int64) * np.maximum(n_rows - lags[:, :1], 0)


# Loops over a row run along its columns, so that they fill vectors; taps are told apart afterwards.


@njit(cache=True, nogil=True)
def _add_cut(later, earlier, taps, cut, sums):  # type: ignore[no-untyped-def]
    kept = np.empty(later.shape[1], np.int32)
    for n in range(later.shape[0]):
        one, other = later[n], earlier[n]
        for i in range(len(kept)):
            d = np.int32(one[i]) - np.int32(other[i])
            kept[i] = min(max(np.int32(d), np.int32(-cut[i])), cut[i])
        for t in range(taps.shape[0]):
            sums[n, t] = _sum(kept, taps[t, 0], taps[t, 1], taps[t, 2])


@njit(cache=True, nogil=True)
def _add_within(later, earlier, taps, limit, centre, sums, counts):  # type: ignore[no-untyped-def]  # noqa: PLR0917 - compiled
    # A difference and a count of one in the upper half: one sum for both, exact up to 2³¹.
    kept = np.empty(later.shape[1], np.int64)
    shared = np.empty(later.shape[1], np.int32)
    for n in range(later.shape[0]):
        one, other = later[n], earlier[n]
        _fill(shared, taps, centre[n])
        for i in range(len(kept)):
            d = np.int32(np.int32(one[i]) - np.int32(other[i]))
            rest = np.int32(np.int32(64) * d - shared[i])
            inside = (rest <= limit[i]) & (rest >= -limit[i])
            kept[i] = (np.int64(d) + (np.int64(1) << 32)) if inside else np.int64(0)
        for t in range(taps.shape[0]):
            total = _sum(kept, taps[t, 0], taps[t, 1], taps[t, 2])
            counts[n, t] = (total + (np.int64(1) << 31)) >> 32
            sums[n, t] = total - (counts[n, t] << 32)


@njit(cache=True, nogil=True)
def _residuals(later, earlier, taps, limit, centre, steps):  # type: ignore[no-untyped-def]  # noqa: PLR0917 - compiled
    any_far = np.zeros(later.shape[0], np.bool_)
    shared = np.empty(later.shape[1], np.int32)
    for n in range(later.shape[0]):
        one, other, left = later[n], earlier[n], steps[n]
        _fill(shared, taps, centre[n])
        lowest = np.int32(0)
        for i in range(len(shared)):
            d = np.int32(np.int32(one[i]) - np.int32(other[i]))
            rest = np.int32(np.int32(64) * d - shared[i])
            inside = (rest <= limit[i]) & (rest >= -limit[i])
            rest = rest if inside else _FAR
            left[i] = rest
            lowest = min(lowest, rest)
        any_far[n] = lowest == _FAR
    return any_far


@njit(cache=True, nogil=True, inline="always")
def _fill(shared, taps, centre):  # type: ignore[no-untyped-def]
    for t in range(taps.shape[0]):
        for i in range(taps[t, 0], taps[t, 1], taps[t, 2]):
            shared[i] = centre[t]


@njit(cache=True, nogil=True, inline="always")
def _sum(values, first, stop, step):  # type: ignore[no-untyped-def]
    total = np.int64(0)
    if step == 1:
        for i in range(first, stop):
            total += values[i]
    elif step == 2:
        for i in range((stop - first + 1) // 2):
            total += values[first + 2 * i]
    else:
        for i in range(first, stop, step):
            total += values[i]
    return total


@njit(cache=True, nogil=True, fastmath={"contract"})
def _add_products(steps, lags, sums):  # type: ignore[no-untyped-def]
    """Add products up four rows at a time, turned into numbers of double precision once."""
    n_rows, n_columns = steps.shape
    reach, deepest = np.abs(lags[:, 1]).max(), lags[:, 0].max()
    wide = np.empty((4 + deepest, _TILE + 2 * reach))
    for left in range(0, n_columns, _TILE):
        right = min(left + _TILE, n_columns)
        start, stop = max(0, left - reach), min(n_columns, right + reach)
        for n in range(0, n_rows, 4):
            last = min(n + 4 + deepest, n_rows)
            for k in range(n, last):
                _widen(steps[k, start:stop], wide[k - n])
            for k in range(lags.shape[0]):
                down, along = lags[k, 0], lags[k, 1]
                here, beyond = max(left, -along), min(right, n_columns - along)
                one = wide[:, here - start : beyond - start]
                other = wide[down:, here - start + along : beyond - start + along]
                total = sums[k, here:beyond]
                if n + 4 + down <= n_rows:
                    _add_four(one[:4], other[:4], total)
                else:
                    for r in range(n_rows - n - down):
                        _add_row(one[r], other[r], total)


@njit(cache=True, nogil=True, inline="always")
def _widen(steps, wide):  # type: ignore[no-untyped-def]
    for i in range(len(steps)):
        wide[i] = np.float64(steps[i])


@njit(cache=True, nogil=True, fastmath={"contract"}, inline="always")
def _add_row(one, other, total):  # type: ignore[no-untyped-def]
    for i in range(len(total)):
        total[i] += one[i] * other[i]


@njit(cache=True, nogil=True, fastmath={"contract"}, inline="always")
def _add_four(ones, others, total):  # type: ignore[no-untyped-def]
    a, b, c, d = ones[0], ones[1], ones[2], ones[3]
    e, f, g, h = others[0], others[1], others[2], others[3]
    for i in range(len(total)):
        total[i] += (a[i] * e[i] + b[i] * f[i]) + (c[i] * g[i] + d[i] * h[i])


@njit(cache=True, nogil=True)
def _count_missing(steps, any_far, lags, missing):  # type: ignore[no-untyped-def]
    n_rows, n_columns = steps.shape
    for k in range(lags.shape[0]):
        down, along = lags[k, 0], lags[k, 1]
        for n in range(n_rows - down):
            if any_far[n] or any_far[n + down]:
                for i in range(max(0, -along), min(n_columns, n_columns - along)):
                    missing[k, i] += steps[n, i] == _FAR or steps[n + down, i + along] == _FAR
