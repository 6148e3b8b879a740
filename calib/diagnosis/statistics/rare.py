"""What is counted: single samples that stand out, pixels that often do, lines that come twice.

Each sample that stands out is counted once: as part of a track where a neighbour stands out with
it, as a flipped bit where it lies a power of two away from where its pixel is, and so far that few
others do, else by its sign. Sizes are not told apart: charges have tails of their own, and what is
left of a few events would be taken for something else.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from calib.diagnosis.statistics.noisy import MOST_NOISY

Floats = NDArray[np.float64]
Whole = NDArray[np.intp]

SINGLE = ("above", "below", "tracks")
FLIPS = 16
"""Bits that may flip; those that a camera does not have never do."""
RARE = (
    *SINGLE,
    "noisy_pixels",
    "identical_lines",
    *(f"raised_{bit}" for bit in range(FLIPS)),
    *(f"lowered_{bit}" for bit in range(FLIPS)),
)
"""Names of the counts."""
FAR_SIGMA = 6.0
"""Samples farther out than this are counted."""
VERY_FAR_SIGMA = 12.0
"""Flipped bits are told from others only where few others lie, farther out than this."""
BESIDE_SIGMA = 4.5
"""A neighbour beyond this belongs to the same track."""
FLIP_SIGMA = 2.5
"""A sample is one flipped bit away from where its pixel is to within so much."""
OFTEN = 3
"""Outliers in one pixel and block that make it a noisy one: no accident of single samples."""


@dataclass(frozen=True)
class RareEvents:
    """What is counted in a block.

    Attributes:
        often: How many pixels often stand out.
        repeated: How many lines come twice.
        pixel: Where each single sample is that stands out, flat, (n,).
        kind: Which of `RARE` it is, likewise.
    """

    often: int
    repeated: int
    pixel: Whole
    kind: Whole

    @classmethod
    def none(cls, repeated: int = 0) -> "RareEvents":
        """Return that nothing but repeated lines happened."""
        return cls(0, repeated, np.zeros(0, np.intp), np.zeros(0, np.intp))

    def counts(self, noisy: Sequence[int] = ()) -> Floats:
        """Return how often each of `RARE` happens, (n_rare,).

        What a pixel does that is noisy in all of a recording is no accident of single samples,
        though it may stand out but once in a block: single samples of `noisy` pixels do not count.
        """
        if len(self.kind) == 0:
            counts = np.zeros(len(RARE))
            counts[len(SINGLE) : len(SINGLE) + 2] = self.often, self.repeated
            return counts
        single = self.kind[~np.isin(self.pixel, noisy)] if len(noisy) else self.kind
        counts = np.bincount(single, minlength=len(RARE)).astype(np.float64)
        counts[len(SINGLE) : len(SINGLE) + 2] = self.often, self.repeated
        return counts


def rare_events(
    samples: NDArray[np.generic],
    mean: Floats,
    sigma: Floats,
    outliers: NDArray[np.int64],
    repeated: int,
) -> RareEvents:
    """Return what is counted in a block.

    Args:
        samples: (n_lines, n_rows, n_columns).
        mean: Of each pixel without outliers, (n_rows, n_columns).
        sigma: Its standard deviation, likewise.
        outliers: How many samples of each pixel are beyond the cut, likewise.
        repeated: Lines that were left out since they repeat one before.
    """
    often = _often(outliers.ravel())
    single = np.flatnonzero((outliers.ravel() > 0) & ~often)
    flat = samples.reshape(len(samples), -1)
    off_dn = flat[:, single].astype(np.float64) - mean.ravel()[single]
    line, k = np.nonzero(np.abs(off_dn) > FAR_SIGMA * sigma.ravel()[single])
    off_dn, pixel = off_dn[line, k], single[k]
    size = off_dn / sigma.ravel()[pixel]
    track = _has_neighbour(samples, mean, sigma, line, pixel)
    bit, flipped = _flipped(off_dn, sigma.ravel()[pixel])
    far = np.abs(size) > VERY_FAR_SIGMA
    kind = np.where(size > 0, 0, 1)
    kind = np.where(far & flipped, len(SINGLE) + 2 + bit + np.where(size > 0, 0, FLIPS), kind)
    kind = np.where(track, RARE.index("tracks"), kind)
    return RareEvents(int(often.sum()), repeated, pixel, kind.astype(np.intp))


def rare_trials(n_lines: float, n_pixels: int) -> Floats:
    """Return how often each of `RARE` could have happened, (n_rare,)."""
    trials = np.full(len(RARE), n_lines * n_pixels)
    trials[len(SINGLE) : len(SINGLE) + 2] = n_pixels, max(n_lines - 1, 1)
    return trials


def _often(outliers: NDArray[np.int64]) -> NDArray[np.bool_]:
    """Return which pixels, (n_pixels,), have more outliers than any would by chance of all."""
    typical = float(np.minimum(outliers, np.median(outliers) + OFTEN).mean())
    often = outliers >= OFTEN + typical + 6.0 * np.sqrt(typical)
    # Where samples of many pixels stand out, as those with a bit set that sticks, all are counted.
    return np.asarray(often & (often.mean() <= MOST_NOISY))


def _flipped(off_dn: Floats, sigma: Floats) -> tuple[Whole, NDArray[np.bool_]]:
    """Return the bit nearest to each deviation, and whether it alone explains it."""
    size = np.maximum(np.abs(off_dn), 1.0)
    bit = np.clip(np.rint(np.log2(size)), 0, FLIPS - 1).astype(np.intp)
    flipped = np.abs(size - np.exp2(bit)) < FLIP_SIGMA * sigma
    return bit, np.asarray(flipped)


def _has_neighbour(
    samples: NDArray[np.generic], mean: Floats, sigma: Floats, line: Whole, pixel: Whole
) -> NDArray[np.bool_]:
    """Return which samples have a neighbour in their line, or frame, that is raised with them."""
    n_rows, n_columns = mean.shape
    row, column = np.divmod(pixel, n_columns)
    found = np.zeros(len(line), bool)
    for down in (-1, 0, 1):
        for along in (-1, 0, 1):
            r, c = row + down, column + along
            inside = (
                (r >= 0) & (r < n_rows) & (c >= 0) & (c < n_columns) & ((down, along) != (0, 0))
            )
            r, c = np.where(inside, r, 0), np.where(inside, c, 0)
            beside = samples[line, r, c].astype(np.float64) - mean[r, c]
            found |= inside & (beside > BESIDE_SIGMA * sigma[r, c])
    return found
