"""Each column's exact statistics, block by block, in one pass over the recording."""

from collections.abc import Callable, Iterator
from functools import partial

import numpy as np

from calib.arrays import RawLines
from calib.errors import DarkflatError, InputError
from calib.kernels.line_sums import LineSums
from calib.kernels.sums import line_sums
from calib.recording.behind import Behind
from calib.recording.block_statistics import BlockStatistics, RecordingStatistics
from calib.recording.gathered import gathered
from calib.recording.header import Block, CameraHeader
from calib.recording.protocol import Recording
from calib.recording.tone import Tone
from calib.recording.tone_removal import ToneSums, check_tone, tone_sums, without_tone

_FRAMES_BEHIND = 2

Progress = Callable[[float], None]
"""Called with the fraction done, 0 … 1."""


class CancelledError(DarkflatError):
    """Somebody asked to stop."""


def never() -> bool:
    """Return False: work that nobody cancels."""
    return False


def column_statistics(
    recording: Recording,
    *,
    tone: Tone | None = None,
    held_out_every: int = 0,
    progress: Progress | None = None,
    cancelled: Callable[[], bool] = never,
) -> RecordingStatistics:
    """Return mean, variance and clip counts of every column of every block.

    Sums are whole numbers and exact; memory does not grow with the number of lines. A frame is
    added up while the next one is read. An area sensor's pixels are flattened, its frames counted
    as lines.

    Args:
        recording: Is read once.
        tone: A known synchronous tone that is estimated frame by frame (in a folder: stretch by
            stretch of consecutive lines) and removed; clip counts are those of the raw codes.
        held_out_every: Every so many lines of a block, one goes to `held_out` and not to `fit`;
            0 holds none out. A block with fewer lines has no part in `held_out`.
        progress: Called after each frame; of an area sensor, after some.
        cancelled: Asked before each frame, likewise; True ends in CancelledError.
    """
    if held_out_every < 0 or held_out_every == 1:
        raise InputError(
            f"held_out_every = {held_out_every} leaves nothing to fit: give 0, or 2 or more",
            code="held-out-invalid",
        )
    if tone is not None:
        check_tone(tone, recording.header.camera.rows)
    blocks = recording.header.blocks
    collected = _Collected()
    with Behind(_FRAMES_BEHIND) as adder:
        for number, block in enumerate(blocks):
            sums, n_lines = _BlockSums(recording.header.camera, tone, held_out_every), 0
            frames = recording.frames(block.block)
            for dn in gathered(frames) if recording.header.camera.rows else frames:
                if cancelled():
                    raise CancelledError(f"stopped in block {block.block}", code="cancelled")
                adder.submit(sums.add, dn)
                n_lines += len(dn)
                if progress is not None:
                    progress((number + min(1.0, n_lines / (block.lines or np.inf))) / len(blocks))
            adder.submit(partial(collected.close, sums), block)
            if progress is not None:
                progress((number + 1) / len(blocks))
        adder.catch_up()
    return RecordingStatistics(tuple(collected.fit), tuple(collected.held_out))


class _Collected:
    """The blocks' statistics, in order, each from when its last frame is added up."""

    def __init__(self) -> None:
        self.fit: list[BlockStatistics] = []
        self.held_out: list[BlockStatistics] = []

    def close(self, sums: "_BlockSums", block: Block) -> None:
        self.fit.append(sums.fit(block))
        self.held_out.extend(sums.held_out(block))


class _BlockSums:
    """Adds a block up, frame by frame: over all lines, and over the held-out ones among them."""

    def __init__(self, camera: CameraHeader, tone: Tone | None, held_out_every: int) -> None:
        n_columns = camera.columns * (camera.rows or 1)
        self._full_scale_dn = camera.full_scale_dn
        self._tone = tone
        self._step = held_out_every
        self._every = self._held = LineSums.zero(n_columns)
        self._tone_every = self._tone_held = ToneSums.zero(n_columns)

    @property
    def n_lines(self) -> int:
        return self._every.n_lines

    def add(self, dn: RawLines) -> None:
        lines = dn.reshape(len(dn), -1)
        first = self._step - 1 - self.n_lines % self._step if self._step else len(lines)
        step = self._step or 1
        if self._tone is not None:
            every, held = tone_sums(lines, self._tone, slice(first, len(lines), step))
            self._tone_every += every
            self._tone_held += held
        self._every += line_sums(lines, self._full_scale_dn)
        if first < len(lines):
            self._held += line_sums(lines, self._full_scale_dn, first=first, step=step)

    def fit(self, block: Block) -> BlockStatistics:
        return self._statistics(block, self._every - self._held, self._tone_every - self._tone_held)

    def held_out(self, block: Block) -> Iterator[BlockStatistics]:
        if self._held.n_lines:
            yield self._statistics(block, self._held, self._tone_held)

    def _statistics(self, block: Block, sums: LineSums, tone: ToneSums) -> BlockStatistics:
        mean, variance = (
            (sums.mean_dn, sums.variance_dn2) if self._tone is None else without_tone(sums, tone)
        )
        return BlockStatistics(
            block,
            sums.n_lines,
            mean,
            variance,
            sums.at_zero.astype(np.int64),
            sums.at_full_scale.astype(np.int64),
        )
