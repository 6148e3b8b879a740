"""What every frame of an exposure says as a whole: its mean, and eight frames' own scatter."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from calib.kernels.pixel_sums import Pixels


@dataclass(frozen=True)
class BlockSeries:
    """One block, tap by tap.

    Attributes:
        block: Its name.
        frame_sums: Sum of codes, (n_frames, n_taps).
        chunk_sizes: Frames of each chunk, in their order, (n_chunks,).
        chunk_squares: Σ(x − own pixel's mean)² of each chunk, DN², (n_chunks, n_taps).
    """

    block: str
    frame_sums: NDArray[np.uint64]
    chunk_sizes: NDArray[np.int64]
    chunk_squares: NDArray[np.float64]


@dataclass(frozen=True)
class FrameSeries:
    """All blocks of one exposure, over the pixels of one tap or of several.

    Attributes:
        n_pixels: How many pixels a frame's mean is over.
        frame_means: Mean code of each frame, DN, one (n_frames,) for each block.
        chunk_sizes: Frames of each chunk, (n_chunks,).
        chunk_variances: Mean over the pixels of the variance within each chunk, without what the
            chunk's frames have in common, DN², (n_chunks,); chunks of one frame are left out.
    """

    n_pixels: int
    frame_means: tuple[Pixels, ...]
    chunk_sizes: NDArray[np.int64]
    chunk_variances: NDArray[np.float64]

    @classmethod
    def of(
        cls, blocks: Sequence[BlockSeries], tap_pixels: NDArray[np.int64], taps: Sequence[int]
    ) -> "FrameSeries":
        """Return the series over `taps`, of which each has `tap_pixels[tap]` pixels."""
        chosen = list(taps)
        n = int(tap_pixels[chosen].sum())
        means = tuple(b.frame_sums[:, chosen].sum(axis=1) / n for b in blocks)
        parts = [_chunks(b, m, chosen, n) for b, m in zip(blocks, means, strict=True)]
        sizes, variances = (np.concatenate(each) for each in zip(*parts, strict=True))
        return cls(n, means, sizes, variances)

    @property
    def n_free(self) -> int:
        """Frames less blocks."""
        return sum(len(means) - 1 for means in self.frame_means)

    @property
    def variance_of_frame_mean_dn2(self) -> float:
        """Variance of a frame's mean, about the mean of its own block, DN²."""
        squares = sum(float(np.sum((m - m.mean()) ** 2)) for m in self.frame_means)
        return squares / self.n_free


def _chunks(
    block: BlockSeries, frame_means: Pixels, taps: list[int], n_pixels: int
) -> tuple[NDArray[np.int64], NDArray[np.float64]]:
    """Return sizes and variances of the chunks of two frames or more."""
    edges = np.concatenate([[0], np.cumsum(block.chunk_sizes)])
    common = np.array(
        [float(np.sum((f - f.mean()) ** 2)) for f in np.split(frame_means, edges[1:-1])]
    )
    squares = block.chunk_squares[:, taps].sum(axis=1) - n_pixels * common
    usable = block.chunk_sizes > 1
    free = (block.chunk_sizes[usable] - 1) * max(n_pixels - 1, 1)
    return block.chunk_sizes[usable], squares[usable] / free
