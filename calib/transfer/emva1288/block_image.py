"""One block of a recording, reduced in one pass to what the standard asks of it."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from calib.arrays import RawLines
from calib.recording.header import Block, CameraHeader, RecordingHeader
from calib.recording.protocol import Recording
from calib.recording.statistics import Progress, column_statistics

Image = NDArray[np.float64]
"""One number per pixel, (n_rows, n_columns); a line sensor has one row."""


@dataclass(frozen=True)
class BlockImage:
    """The temporal statistics of a block of L frames, pixel by pixel.

    Attributes:
        block: The conditions.
        n_frames: L; a line sensor's line is a frame of one row.
        mean_dn: Averaged image, (n_rows, n_columns).
        variance_dn2: Unbiased temporal variance, (n_rows, n_columns).
        row_variance_dn2: Temporal variance of a row's mean, averaged over the rows.
        frame_variance_dn2: Temporal variance of the frame's mean.
        share_at_full_scale: Share of the samples at the highest code.
        share_at_zero: Share of the samples at code 0.
    """

    block: Block
    n_frames: int
    mean_dn: Image
    variance_dn2: Image
    row_variance_dn2: float
    frame_variance_dn2: float
    share_at_full_scale: float
    share_at_zero: float


def read_block(
    recording: Recording,
    block: Block,
    progress: Progress | None,
    cancelled: Callable[[], bool],
) -> BlockImage:
    """Read one block once; memory grows with neither frames nor blocks."""
    tapped = _Tapped(recording, block)
    found = column_statistics(tapped, progress=progress, cancelled=cancelled).fit[0]
    shape = tapped.shape
    samples = max(1, found.n_lines * found.mean_dn.size)
    return BlockImage(
        block=block,
        n_frames=found.n_lines,
        mean_dn=found.mean_dn.reshape(shape),
        variance_dn2=found.variance_dn2.reshape(shape),
        row_variance_dn2=float(np.mean(tapped.rows.variance())),
        frame_variance_dn2=float(tapped.frames_.variance()[0]),
        share_at_full_scale=float(found.n_at_full_scale.sum()) / samples,
        share_at_zero=float(found.n_at_zero.sum()) / samples,
    )


class _Tapped:
    """One block of a recording, whose rows' and frames' means are noted as they pass."""

    def __init__(self, recording: Recording, block: Block) -> None:
        self._recording = recording
        self.header: RecordingHeader = recording.header.model_copy(update={"blocks": (block,)})
        self.shape = image_shape(recording.header.camera)
        self.rows = _Spread(self.shape[0])
        self.frames_ = _Spread(1)

    @property
    def path(self) -> Path:
        return self._recording.path

    @property
    def warnings(self) -> tuple[str, ...]:
        return self._recording.warnings

    def frames(self, block: str) -> Iterator[RawLines]:
        for dn in self._recording.frames(block):
            means = dn.reshape(len(dn), *self.shape).mean(axis=2)
            self.rows.add(means)
            self.frames_.add(means.mean(axis=1, keepdims=True))
            yield dn

    def digest(self) -> str:
        return self._recording.digest()


class _Spread:
    """The variance of numbers that pass by, n at a time; about the first, lest it cancel."""

    def __init__(self, n: int) -> None:
        self._about: Image | None = None
        self._count = 0
        self._sum, self._squares = np.zeros(n), np.zeros(n)

    def add(self, values: Image) -> None:
        """Take in (k, n) values."""
        if self._about is None:
            self._about = values[0].copy()
        off = values - self._about
        self._count += len(off)
        self._sum += off.sum(axis=0)
        self._squares += (off**2).sum(axis=0)

    def variance(self) -> Image:
        """Return the unbiased variance, (n,); NaN of fewer than two."""
        if self._count < 2:
            return np.full(len(self._sum), np.nan)
        return (self._squares - self._sum**2 / self._count) / (self._count - 1)


def image_shape(camera: CameraHeader) -> tuple[int, int]:
    """Return (n_rows, n_columns); a line sensor has one row."""
    return (camera.rows or 1, camera.columns)
