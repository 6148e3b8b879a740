"""Consecutive lines differenced for photon transfer: common means, outliers, products at lags."""

import numpy as np

from benchmarks.limits import bare_sums
from benchmarks.race import race
from benchmarks.row import Row
from benchmarks.size import Size
from calib.arrays import RawLines
from calib.kernels.difference_sums import TapRuns
from calib.kernels.noise import draw_codes
from calib.kernels.pair_sums import first_row_sums, lag_sums, row_sums

LAGS = ((0, 0), (0, 1), (0, 2), (1, 0))
LEAST_TIMES_NUMPY = 1.3
_LIMIT_DN = 5 * 64.0


def run(size: Size) -> Row:
    """Difference all lines of a block of two taps, as `pair_statistics` does, on one core."""
    dn = _codes(size)
    taps = TapRuns.of(np.arange(size.n_columns) % 2)
    limit = np.full(size.n_columns, int(64 * _LIMIT_DN), np.int32)
    codes, squares = np.zeros(size.n_columns, np.uint32), np.zeros(size.n_columns, np.uint64)
    figures = race(
        dn.size / 1e6,
        {
            "ours": lambda: _ours(dn, taps, limit),
            "numpy": lambda: _with_numpy(dn),
            "limit": lambda: bare_sums(dn, 0, len(dn), codes, squares),
        },
        rounds=size.rounds,
    )
    slower = 1 / figures["limit"].ours_is
    return Row(
        work=f"lines differenced, means of taps and outliers out, 4 lags, u16 {size.frame}",
        unit="Mpix/s",
        ours=figures["ours"].rate,
        numpy=figures["numpy"],
        peers={},
        limit=figures["limit"],
        limit_is="a bare loop of 32-bit sums and 64-bit squares",
        bound=f">= {LEAST_TIMES_NUMPY:g} x NumPy's rate",
        reached=figures["numpy"].ours_is >= LEAST_TIMES_NUMPY,
        notes=(f"takes {slower:.1f} x the limit's time",),
    )


def _codes(size: Size) -> RawLines:
    ones = np.ones(size.n_columns)
    return draw_codes(
        10_000.0 * ones[None],
        np.ones(size.n_lines),
        0 * ones,
        read_std_e=10.0,
        gain_dn_per_e=0.2 * ones,
        offset_dn=0 * ones,
        full_scale_dn=4095,
        full_well_e=40_000.0,
        key=1,
    )


def _ours(dn: RawLines, taps: TapRuns, limit: np.ndarray) -> None:
    later, earlier = dn[1:], dn[:-1]
    first = first_row_sums(later, earlier, taps, limit)
    centre = np.rint(64 * first.differences / first.counts).astype(np.int32)
    second = row_sums(later, earlier, taps, limit, centre)
    centre = np.rint(64 * second.differences / second.counts).astype(np.int32)
    lag_sums(later, earlier, taps, limit, centre, lags=LAGS)


def _with_numpy(dn: RawLines) -> None:
    """The same with arrays; means of taps are taken once, and outliers count as 0."""
    difference = np.diff(dn.astype(np.float32), axis=0)
    for tap in (0, 1):
        difference[:, tap::2] -= difference[:, tap::2].mean(axis=1, keepdims=True)
    difference[np.abs(difference) > _LIMIT_DN] = 0.0
    for down, along in LAGS:
        n, m = difference.shape
        one, other = difference[: n - down, : m - along], difference[down:, along:]
        np.einsum("ij,ij->j", one, other, dtype=np.float64)
