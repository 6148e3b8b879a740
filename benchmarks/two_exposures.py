"""Moments of every pixel of an area sensor, and what SANUC and S3NUC make of them."""

from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from time import perf_counter

import numpy as np

from benchmarks.limits import bare_sums
from benchmarks.race import race
from benchmarks.row import Row
from benchmarks.size import Size
from benchmarks.timing import OwnTime
from calib.arrays import RawLines
from calib.kernels.noise import draw_codes
from calib.kernels.pixel_moments import PixelAccumulator
from calib.recording.header import Block, CameraHeader, RecordingHeader
from calib.transfer.two_exposures.s3nuc import s3nuc
from calib.transfer.two_exposures.sanuc import sanuc
from calib.transfer.two_exposures.two_exposures import two_exposure_moments

BITS = 14
LONGEST_TIMES_SUMS = 2.0
LONGEST_TIMES_PASS = 2.0
_CACHED = 16_384
_PASSES = 5  # the frames at hand are shown so many times


def moments(size: Size) -> Row:
    """Add up codes, squares and cubes, with every frame's and every eight frames' sums."""
    dn = _frames(size, 1)
    with ThreadPoolExecutor(2) as pool:
        figures = race(
            dn.size / 1e6,
            {
                "ours": _pass(dn, pool),
                "numpy": lambda: _with_numpy(dn),
                "limit": _bare(dn, pool),
            },
            rounds=size.rounds,
        )
    slower = 1.0 / figures["limit"].ours_is
    return Row(
        work=f"moments to the third of every pixel, u16 {_size(size)}, two threads",
        unit="Mpix/s",
        ours=figures["ours"].rate,
        numpy=figures["numpy"],
        peers={},
        limit=figures["limit"],
        limit_is="a bare loop of sums and squares alone",
        bound=f"<= {LONGEST_TIMES_SUMS:g} x the limit's time",
        reached=slower <= LONGEST_TIMES_SUMS,
        notes=(f"takes {slower:.2f} x the limit's time",),
    )


def reduction(size: Size) -> Row:
    """Reduce stacks at t and 2t to maps and pooled estimates, by SANUC; S3NUC beside it."""
    recording = _Stacks(size)
    pixels = 2 * _PASSES * size.stack_frames * size.stack_pixels / 1e6
    results = {"sanuc": two_exposure_moments(recording, "sanuc")}
    with ThreadPoolExecutor(2) as pool:
        figures = race(
            pixels,
            {
                "ours": lambda: two_exposure_moments(recording, "sanuc"),
                "s3nuc": lambda: two_exposure_moments(recording, "s3nuc"),
                "limit": lambda: recording.only_pass(pool),
            },
            rounds=min(3, size.rounds),
        )
    pair = results["sanuc"].pair
    maps = race(
        1.0, {"ours": lambda: sanuc(pair), "s3nuc": lambda: s3nuc(pair)}, rounds=min(3, size.rounds)
    )
    slower = 1.0 / figures["limit"].ours_is
    frames = _PASSES * size.stack_frames
    return Row(
        work=f"SANUC of 2 x {frames} frames of {_size(size)}, {BITS} bit, in memory",
        unit="Mpix/s",
        ours=figures["ours"].rate,
        numpy=None,
        peers={},
        limit=figures["limit"],
        limit_is="its pass over the frames alone",
        bound=f"<= {LONGEST_TIMES_PASS:g} x the pass",
        reached=slower <= LONGEST_TIMES_PASS,
        notes=(
            f"takes {slower:.2f} x the pass, {pixels / figures['ours'].rate:.2f} s",
            f"S3NUC takes {figures['s3nuc'].ours_is:.2f} x the time of SANUC, its maps alone"
            f" {maps['s3nuc'].ours_is:.2f} x",
        ),
    )


class _Stacks:
    """A recording of two stacks in memory, whose frames come again and again."""

    def __init__(self, size: Size) -> None:
        self.path = Path("in-memory")
        self.warnings: tuple[str, ...] = ()
        self._shown = {str(k): _frames(size, k) for k in (1, 2)}
        frames = _PASSES * size.stack_frames
        blocks = tuple(
            Block(block=str(k), kind="flat", exposure_us=100.0 * k, level=1, lines=frames)
            for k in (1, 2)
        )
        camera = CameraHeader(columns=size.stack_columns, rows=size.stack_rows, bit_depth=BITS)
        self.header = RecordingHeader(camera=camera, blocks=blocks)
        self._shape = (size.stack_frames, size.stack_rows, size.stack_columns)

    def frames(self, block: str) -> Iterator[RawLines]:
        for _ in range(_PASSES):
            yield self._shown[block].reshape(self._shape)

    def digest(self) -> str:
        return ""

    def only_pass(self, pool: ThreadPoolExecutor) -> OwnTime:
        started = perf_counter()
        for dn in self._shown.values():
            accumulator = _accumulator(dn, pool)
            for _ in range(_PASSES):
                accumulator.add(dn)
        return OwnTime(perf_counter() - started)


def _frames(size: Size, exposure: int) -> RawLines:
    """Return flats of 3,000 electrons at the first exposure, (n_frames, n_pixels)."""
    ones = np.ones(size.stack_pixels)
    return draw_codes(
        3000.0 * exposure * ones[None],
        np.ones(size.stack_frames),
        0 * ones,
        read_std_e=10.0,
        gain_dn_per_e=ones,
        offset_dn=100 * ones,
        full_scale_dn=(1 << BITS) - 1,
        full_well_e=np.inf,
        key=exposure,
    )


def _accumulator(dn: RawLines, pool: ThreadPoolExecutor) -> PixelAccumulator:
    return PixelAccumulator(np.zeros(dn.shape[1], np.uint8), (1 << BITS) - 1, pool=pool)


def _pass(dn: RawLines, pool: ThreadPoolExecutor) -> Callable[[], None]:
    accumulator = _accumulator(dn, pool)
    return lambda: accumulator.add(dn)


def _with_numpy(dn: RawLines) -> None:
    dn.sum(axis=0, dtype=np.uint64)
    np.einsum("ij,ij->j", dn, dn, dtype=np.uint64, casting="unsafe")
    np.einsum("ij,ij,ij->j", dn, dn, dn, dtype=np.uint64, casting="unsafe")


def _bare(dn: RawLines, pool: ThreadPoolExecutor) -> Callable[[], object]:
    """Return the bare loop, each thread over half of the pixels, a cacheful of sums at a time."""
    codes, squares = (np.zeros(dn.shape[1], dtype) for dtype in (np.uint32, np.uint64))
    half = dn.shape[1] // 2

    def run(first: int, stop: int) -> None:
        for left in range(first, stop, _CACHED):
            some = slice(left, min(left + _CACHED, stop))
            bare_sums(dn[:, some], 0, len(dn), codes[some], squares[some])

    return lambda: list(pool.map(run, (0, half), (half, dn.shape[1])))


def _size(size: Size) -> str:
    return f"{size.stack_columns} x {size.stack_rows}"
