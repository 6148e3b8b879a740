"""Exact sums and squares of 16-bit frames by column, with the counts of clipped samples."""

from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor

import numpy as np

from benchmarks.limits import bare_sums
from benchmarks.peer import race_with_peers
from benchmarks.race import Figure, race
from benchmarks.row import Row
from benchmarks.size import Size
from calib.arrays import RawLines
from calib.kernels.noise import draw_codes
from calib.kernels.sums import lagged_sums, line_sums

FULL_SCALE_DN = 4095
LONGEST_TIMES_LIMIT = 1.3
LONGEST_WITH_COVARIANCES = 4.0


def one_thread(size: Size) -> Row:
    """Add frames up on one core."""
    dn = _codes(size)
    ours = _ours(dn, None)
    figures = race(
        _mpix(dn),
        {"ours": ours, "numpy": lambda: _with_numpy(dn), "limit": _limit(dn, None)},
        rounds=size.rounds,
    )
    # The peer adds up one frame.
    frame = dn[: size.n_lines]
    peers = race_with_peers(size, _mpix(frame), _ours(frame, None), {"Welford": "sums-welford"})
    return _row(f"exact sums and squares, u16 {size.frame}, one thread", figures, peers)


def two_threads(size: Size) -> Row:
    """Add frames up on two cores, several frames per call."""
    dn = _codes(size)
    with ThreadPoolExecutor(2) as pool:
        figures = race(
            _mpix(dn),
            {
                "ours": _ours(dn, pool),
                "numpy": lambda: _with_numpy(dn),
                "limit": _limit(dn, pool),
            },
            rounds=size.rounds,
        )
    return _row(f"exact sums and squares, u16 {size.frame}, two threads", figures, {})


def with_covariances(size: Size) -> Row:
    """Add up neighbours' and lines' products as well, on one core."""
    dn = _codes(size)
    figures = race(
        _mpix(dn),
        {
            "ours": lambda: lagged_sums(dn, FULL_SCALE_DN),
            "numpy": lambda: _products_with_numpy(dn),
            "limit": _limit(dn, None),
        },
        rounds=size.rounds,
    )
    what = f"the same with neighbour and line covariances, u16 {size.frame}, one thread"
    return _row(what, figures, {}, LONGEST_WITH_COVARIANCES)


def _codes(size: Size) -> RawLines:
    """Return flats of a 12-bit camera in which nothing is clipped."""
    ones = np.ones(size.n_columns)
    return draw_codes(
        10_000.0 * ones[None],
        np.ones(size.n_frames * size.n_lines),
        0 * ones,
        read_std_e=10.0,
        gain_dn_per_e=0.2 * ones,
        offset_dn=0 * ones,
        full_scale_dn=FULL_SCALE_DN,
        full_well_e=40_000.0,
        key=1,
    )


def _mpix(dn: RawLines) -> float:
    return dn.size / 1e6


def _ours(dn: RawLines, pool: ThreadPoolExecutor | None) -> Callable[[], object]:
    return lambda: line_sums(dn, FULL_SCALE_DN, pool=pool)


def _with_numpy(dn: RawLines) -> None:
    dn.sum(axis=0, dtype=np.uint64)
    np.einsum("ij,ij->j", dn, dn, dtype=np.uint64, casting="unsafe")


def _products_with_numpy(dn: RawLines) -> None:
    _with_numpy(dn)
    np.einsum("ij,ij->j", dn[:, :-1], dn[:, 1:], dtype=np.uint64, casting="unsafe")
    np.einsum("ij,ij->j", dn[:-1], dn[1:], dtype=np.uint64, casting="unsafe")


def _limit(dn: RawLines, pool: ThreadPoolExecutor | None) -> Callable[[], object]:
    """Return the bare loop over `dn`, its lines shared by two threads where there is a pool."""
    edges = (0, len(dn)) if pool is None else (0, len(dn) // 2, len(dn))

    def run(first: int, stop: int) -> None:
        codes, squares = (np.zeros(dn.shape[1], dtype) for dtype in (np.uint32, np.uint64))
        bare_sums(dn, first, stop, codes, squares)

    if pool is None:
        return lambda: run(*edges)
    return lambda: list(pool.map(run, edges[:-1], edges[1:]))


def _row(
    what: str,
    figures: dict[str, Figure],
    peers: dict[str, Figure],
    longest: float = LONGEST_TIMES_LIMIT,
) -> Row:
    slower = 1 / figures["limit"].ours_is
    return Row(
        work=what,
        unit="Mpix/s",
        ours=figures["ours"].rate,
        numpy=figures["numpy"],
        peers=peers,
        limit=figures["limit"],
        limit_is="a bare loop of 32-bit sums and 64-bit squares",
        bound=f"<= {longest:g} x the limit's time",
        reached=slower <= longest,
        notes=(f"takes {slower:.2f} x the limit's time",),
    )
