"""Reading an exposure's blocks once: moments of every pixel, means of every frame."""

from collections.abc import Callable, Iterable, Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from calib.arrays import RawLines
from calib.errors import NotDeterminedError
from calib.kernels.pixel_moments import FRAMES_AT_ONCE, PixelAccumulator
from calib.recording.header import Block
from calib.recording.protocol import Recording
from calib.recording.statistics import CancelledError
from calib.transfer.two_exposures.exposure_pair import ExposureMoments
from calib.transfer.two_exposures.frame_series import BlockSeries
from calib.transfer.two_exposures.static_scene import PatternChange, looked_at, pattern_change

FEWEST_FRAMES = 3
"""Of a block; a third moment needs as many."""


@dataclass(frozen=True)
class ReadExposure:
    """What is left of one exposure's frames.

    Attributes:
        moments: Of every pixel, all blocks together.
        series: Of every block.
        changes: By how much the scene changed within each block.
    """

    moments: ExposureMoments
    series: tuple[BlockSeries, ...]
    changes: tuple[PatternChange, ...]


def read_exposure(
    recording: Recording,
    blocks: Sequence[Block],
    tap_of_pixel: NDArray[np.uint8],
    told: Callable[[float], None],
    cancelled: Callable[[], bool],
) -> ReadExposure:
    """Read `blocks` once; memory is that of the sums, and 8 bytes for each frame and tap.

    Args:
        recording: The recording.
        blocks: Repeats of one exposure.
        tap_of_pixel: Which tap reads each pixel, (n_pixels,).
        told: Called after each stretch of frames with the share of `blocks` that is read.
        cancelled: Asked before each stretch; True ends in CancelledError.
    """
    moments: ExposureMoments | None = None
    series, changes = [], []
    for number, block in enumerate(blocks):

        def done(share: float, number: int = number) -> None:
            told((number + share) / len(blocks))

        accumulator, early = _accumulated(recording, block, tap_of_pixel, done, cancelled)
        codes = accumulator.sums.codes[looked_at(tap_of_pixel.size)].copy()
        of_block = ExposureMoments.finished(accumulator)
        changes.append(pattern_change(block.block, codes, early, of_block))
        moments = of_block if moments is None else moments.merged(of_block)
        series.append(
            BlockSeries(
                block.block,
                accumulator.frame_sums,
                accumulator.chunk_sizes,
                accumulator.chunk_squares,
            )
        )
    if moments is None:
        raise NotDeterminedError("no block was given to read", code="two-flats-missing")
    return ReadExposure(moments, tuple(series), tuple(changes))


def _accumulated(
    recording: Recording,
    block: Block,
    tap_of_pixel: NDArray[np.uint8],
    done: Callable[[float], None],
    cancelled: Callable[[], bool],
) -> tuple[PixelAccumulator, NDArray[np.uint64]]:
    """Return all frames' sums, and some pixels' (`looked_at`) over the first eight alone."""
    early: NDArray[np.uint64] | None = None
    n_frames = 0
    with ThreadPoolExecutor(2) as pool:
        accumulator = PixelAccumulator(
            tap_of_pixel, recording.header.camera.full_scale_dn, pool=pool
        )
        for frames in by_eights(recording.frames(block.block)):
            if cancelled():
                raise CancelledError(f"stopped in block {block.block}", code="cancelled")
            rest = frames
            if early is None:
                accumulator.add(frames[:FRAMES_AT_ONCE])
                early = accumulator.sums.codes[looked_at(tap_of_pixel.size)].copy()
                rest = frames[FRAMES_AT_ONCE:]
            if len(rest):
                accumulator.add(rest)
            n_frames += len(frames)
            done(min(1.0, n_frames / (block.lines or np.inf)))
    if early is None or n_frames < FEWEST_FRAMES:
        raise NotDeterminedError(
            f"block {block.block} of {recording.path} has {n_frames} frames, of which moments need "
            f"{FEWEST_FRAMES}: record more",
            code="few-frames",
        )
    done(1.0)
    return accumulator, early


def by_eights(stretches: Iterable[RawLines]) -> Iterator[RawLines]:
    """Yield the frames, pixels flattened, in stretches of multiples of eight but for the last.

    >>> [len(s) for s in by_eights([np.zeros((n, 2, 3), np.uint8) for n in (3, 6, 8, 1)])]
    [8, 8, 2]
    """
    held: list[RawLines] = []
    for stretch in stretches:
        lines: RawLines = stretch.reshape(len(stretch), -1)
        held.append(lines)
        n = sum(map(len, held))
        if n >= FRAMES_AT_ONCE:
            joined = _joined(held)
            whole = n - n % FRAMES_AT_ONCE
            yield joined[:whole]
            held = [joined[whole:].copy()] if n > whole else []
    if held:
        yield _joined(held)


def _joined(stretches: list[RawLines]) -> RawLines:
    """Return them as one C-contiguous array, without a copy where there is one already."""
    if len(stretches) == 1 and stretches[0].flags.c_contiguous:
        return stretches[0]
    joined: Any = np.concatenate(stretches)
    whole: RawLines = joined
    return whole
