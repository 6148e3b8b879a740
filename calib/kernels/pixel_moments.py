"""Exact sums of codes, squares and cubes over frames, pixel by pixel.

Eight frames are added up per visit of a pixel's sums, three multiplications a sample. The sums run
modulo 2⁶⁴; moved to a whole number c next to the mean,

    Σ(x−c)³ = S₃ − 3c·S₂ + 3c²·S₁ − n·c³   (mod 2⁶⁴),

they are exact, since the result fits: nothing overflows, nothing cancels, and neither a pivot nor
the order of the frames matters. On the way every frame's sum and every eight frames' own squares
about their mean are taken, by tap: what the frames have in common is seen in them.

Threads are Python's: the kernels release the interpreter, and every thread takes its own pixels.
"""

from concurrent.futures import Executor
from dataclasses import replace

import numpy as np
from numba import int64, njit, uint16, uint32, uint64
from numpy.typing import NDArray

from calib.arrays import RawLines
from calib.errors import InputError
from calib.kernels.central_moments import moments_into
from calib.kernels.pixel_sums import Moments, PixelSums, most_frames

FRAMES_AT_ONCE = 8
# Pixels whose eight frames and sums fit the second-level cache together.
_TILE = 2048


class PixelAccumulator:
    """Adds frames up in place; memory is 32 bytes per pixel, 2 per tap, and 8 per frame."""

    def __init__(
        self,
        tap_of_pixel: NDArray[np.uint8],
        full_scale_dn: int,
        *,
        pool: Executor | None = None,
        n_threads: int = 2,
    ) -> None:
        """Start at nothing.

        Args:
            tap_of_pixel: Which tap reads each pixel, from 0, (n_pixels,).
            full_scale_dn: Codes from here on count as clipped.
            pool: Where given, its threads share the pixels, `n_threads` runs of them.
            n_threads: How many runs.
        """
        self._n_taps = int(tap_of_pixel.max(initial=0)) + 1
        taps = np.arange(self._n_taps)[:, None]
        self._masks = np.where(tap_of_pixel == taps, np.uint16(65535), np.uint16(0))
        self._full_scale_dn = full_scale_dn
        self._sums = PixelSums.zero(tap_of_pixel.size)
        self._pool = pool
        runs = 1 if pool is None else n_threads
        self._edges = [tap_of_pixel.size * k // runs for k in range(runs + 1)]
        self._n_frames = 0
        self._frame_sums: list[NDArray[np.uint64]] = []
        self._spreads: list[NDArray[np.float64]] = []
        self._sizes: list[int] = []

    def add(self, dn: RawLines) -> None:
        """Add frames, (n_frames, n_pixels), C-contiguous, eight by eight from the first.

        Raises:
            InputError: `too-many-frames`, more than are sure to be exact.
        """
        most = most_frames(self._full_scale_dn)
        if self._n_frames + len(dn) > most:
            message = f"more than {most} frames of codes up to {self._full_scale_dn} may not add up"
            raise InputError(f"{message} exactly: record shorter blocks.", code="too-many-frames")
        frame_sums = np.zeros((len(self._edges) - 1, len(dn), self._n_taps), np.uint64)
        n_chunks = -(-len(dn) // FRAMES_AT_ONCE)
        spreads = np.zeros((len(self._edges) - 1, n_chunks, self._n_taps), np.float64)

        def run(k: int) -> None:
            sums = self._sums
            _add_frames(
                dn, self._full_scale_dn, self._edges[k], self._edges[k + 1], self._masks,
                sums.codes, sums.squares, sums.cubes, sums.at_zero, sums.at_full_scale,
                frame_sums[k], spreads[k],
            )  # fmt: skip

        runs = range(len(self._edges) - 1)
        list(map(run, runs) if self._pool is None else self._pool.map(run, runs))
        self._n_frames += len(dn)
        self._frame_sums.append(frame_sums.sum(axis=0))
        self._spreads.append(spreads.sum(axis=0))
        firsts = range(0, len(dn), FRAMES_AT_ONCE)
        self._sizes += [min(FRAMES_AT_ONCE, len(dn) - first) for first in firsts]

    @property
    def sums(self) -> PixelSums:
        """What was added so far; the arrays go on being added to."""
        s = self._sums
        return replace(s, n_frames=self._n_frames)

    def finished(self) -> tuple[PixelSums, Moments]:
        """Return counts of clipped samples, and the moments in the memory of the sums.

        Fresh memory for millions of pixels costs as much as the moments. The sums are gone, and
        nothing can be added any more.
        """
        sums, none = self.sums, PixelSums.zero(0)
        self._sums, self._edges = none, [0]
        each = (sums.codes, sums.squares, sums.cubes)
        moments = moments_into(sums.n_frames, each, tuple(array.view(np.float64) for array in each))
        return replace(sums, codes=none.codes, squares=none.squares, cubes=none.cubes), moments

    @property
    def frame_sums(self) -> NDArray[np.uint64]:
        """Sum of codes of every frame over each tap's pixels, (n_frames, n_taps)."""
        return np.concatenate([np.zeros((0, self._n_taps), np.uint64), *self._frame_sums])

    @property
    def chunk_sizes(self) -> NDArray[np.int64]:
        """How many consecutive frames each chunk has, (n_chunks,), eight or fewer."""
        return np.array(self._sizes, np.int64)

    @property
    def chunk_squares(self) -> NDArray[np.float64]:
        """Σ(x − mean)² over a chunk's frames, each pixel's own mean, (n_chunks, n_taps), DN²."""
        spreads = np.concatenate([np.zeros((0, self._n_taps)), *self._spreads])
        return spreads / np.maximum(self.chunk_sizes, 1)[:, None]


@njit(cache=True, nogil=True)
def _add_frames(  # type: ignore[no-untyped-def]  # noqa: PLR0917 - compiled
    dn, full_scale, first, last, masks, codes, squares, cubes, at_zero, at_full, frame_sums, spreads
):
    top = uint16(full_scale)
    spread = np.empty(_TILE, np.int64)
    for left in range(first, last, _TILE):
        right = min(left + _TILE, last)
        total, square, cube = codes[left:right], squares[left:right], cubes[left:right]
        own = spread[: right - left]
        for line in range(0, len(dn), 8):
            stop = min(line + 8, len(dn))
            if stop == line + 8:
                rows = (
                    dn[line, left:right], dn[line + 1, left:right],
                    dn[line + 2, left:right], dn[line + 3, left:right],
                    dn[line + 4, left:right], dn[line + 5, left:right],
                    dn[line + 6, left:right], dn[line + 7, left:right],
                )  # fmt: skip
                lowest, highest = _add_eight(rows, total, square, cube, own)
            else:
                lowest, highest = _add_fewer(dn[line:stop, left:right], total, square, cube, own)
            if lowest == 0 or highest >= top:
                _count_clipped(
                    dn[line:stop, left:right], top, at_zero[left:right], at_full[left:right]
                )
            for tap in range(len(masks)):
                mask = masks[tap, left:right]
                spreads[line // 8, tap] += _sum_of_spread(own, mask)
                for j in range(line, stop):
                    frame_sums[j, tap] += _sum_of_row(dn[j, left:right], mask)


@njit(cache=True, nogil=True, inline="always")
def _add_eight(rows, total, square, cube, spread):  # type: ignore[no-untyped-def]
    """Add eight frames; return the lowest and the highest code in them."""
    row0, row1, row2, row3, row4, row5, row6, row7 = rows
    lowest, highest = uint32(65535), uint32(0)
    for i in range(len(total)):
        a, b, c, d = uint32(row0[i]), uint32(row1[i]), uint32(row2[i]), uint32(row3[i])
        e, f, g, h = uint32(row4[i]), uint32(row5[i]), uint32(row6[i]), uint32(row7[i])
        aa, bb, cc, dd = uint64(a * a), uint64(b * b), uint64(c * c), uint64(d * d)
        ee, ff, gg, hh = uint64(e * e), uint64(f * f), uint64(g * g), uint64(h * h)
        s1 = uint64(a + b + c + d + e + f + g + h)
        s2 = aa + bb + cc + dd + ee + ff + gg + hh
        total[i] += s1
        square[i] += s2
        cube[i] += (
            aa * uint64(a) + bb * uint64(b) + cc * uint64(c) + dd * uint64(d)
            + ee * uint64(e) + ff * uint64(f) + gg * uint64(g) + hh * uint64(h)
        )  # fmt: skip
        spread[i] = int64(uint64(8) * s2 - s1 * s1)
        lowest = min(lowest, a, b, c, d, e, f, g, h)
        highest = max(highest, a, b, c, d, e, f, g, h)
    return lowest, highest


@njit(cache=True, nogil=True)
def _add_fewer(rows, total, square, cube, spread):  # type: ignore[no-untyped-def]
    """Add fewer than eight frames; return the lowest and the highest code in them."""
    lowest, highest = uint32(65535), uint32(0)
    for i in range(len(total)):
        s1, s2 = uint64(0), uint64(0)
        for j in range(len(rows)):
            a = uint32(rows[j, i])
            aa = uint64(a * a)
            s1 += uint64(a)
            s2 += aa
            cube[i] += aa * uint64(a)
            lowest, highest = min(lowest, a), max(highest, a)
        total[i] += s1
        square[i] += s2
        spread[i] = int64(uint64(len(rows)) * s2 - s1 * s1)
    return lowest, highest


@njit(cache=True, nogil=True)
def _count_clipped(rows, top, zeros, fulls):  # type: ignore[no-untyped-def]
    for j in range(len(rows)):
        row = rows[j]
        for i in range(len(zeros)):
            zeros[i] += uint32(row[i] == 0)
            fulls[i] += uint32(row[i] >= top)


@njit(cache=True, nogil=True)
def _sum_of_row(row, mask):  # type: ignore[no-untyped-def]
    """Sum the codes of the tap's pixels; a tile of 16-bit codes fits 32 bits."""
    total = uint32(0)
    for i in range(len(row)):
        total = uint32(total + uint32(uint16(row[i] & mask[i])))
    return total


@njit(cache=True, nogil=True, fastmath={"reassoc"})
def _sum_of_spread(spread, mask):  # type: ignore[no-untyped-def]
    total = 0.0
    for i in range(len(spread)):
        total += np.float64(spread[i] & -int64(mask[i] & uint16(1)))
    return total
