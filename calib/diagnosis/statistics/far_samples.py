"""Single samples that lie far out, one by one: where, by how much, and what is beside them.

Counts of what is beyond a limit forget how far beyond it lies. Chance makes one sample in 2 million
lie out by `LEAST_SIGMA`, so there are few, and they are kept as they are.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Whole = NDArray[np.intp]

LEAST_SIGMA = 5.0
"""Samples farther out than this are kept."""
MOST_SHARE = 0.2
"""Where more of the pixels have some, they are no accidents of single samples: none is kept."""
WIDER = 4.0
"""A pixel is noisier than those about it by so many standard errors of its variance."""


@dataclass(frozen=True)
class FarSamples:
    """Samples of a block that lie far out, the farthest of those side by side.

    Attributes:
        pixel: Where each is, flat, (n,).
        off_dn: From its pixel's mean and its line's, (n,).
        variance_dn2: Of its pixel without it, (n,).
        beside_dn: What lies beside it in its line or frame, from their means, (n, n_beside); nan
            beyond the edge.
        code: As it is stored, (n,).
    """

    pixel: Whole
    off_dn: Floats
    variance_dn2: Floats
    beside_dn: Floats
    code: Whole

    @classmethod
    def none(cls) -> "FarSamples":
        """Return that there are none."""
        nothing, nowhere = np.zeros(0), np.zeros(0, np.intp)
        return cls(nowhere, nothing, nothing, np.zeros((0, 1)), nowhere)


def far_samples(  # noqa: PLR0917 - all that they depend on
    samples: NDArray[np.generic],
    mean: Floats,
    reach: Floats,
    variance: Floats,
    local: Floats,
    line_means: Floats,
    tap: Whole,
) -> FarSamples:
    """Return the samples of a block that lie far out.

    Args:
        samples: (n_lines, n_rows, n_columns).
        mean: Of each pixel without outliers, (n_rows, n_columns).
        reach: How far the farthest of its samples is from that, likewise.
        variance: Of all its samples, DN^2, likewise.
        local: Of the pixels about it, likewise.
        line_means: What each line's pixels of a tap have in common, (n_lines, n_rows, n_taps).
        tap: Which tap reads each pixel, (n_rows, n_columns).
    """
    cut = LEAST_SIGMA * np.sqrt(local)
    which = np.flatnonzero(reach > cut)
    if len(which) == 0 or len(which) > MOST_SHARE * mean.size or len(samples) < 3:
        return FarSamples.none()
    row, column = np.divmod(which, mean.shape[1])
    off = samples[:, row, column].astype(np.float64) - mean[row, column]
    off -= line_means[:, row, tap[row, column]]
    line, k = np.nonzero(np.abs(off) > np.maximum(cut[row, column], 1.0))
    off, pixel, code = off[line, k], which[k], samples[line, row[k], column[k]].astype(np.intp)
    rest = without_one(off, variance.ravel()[pixel], len(samples))
    usual = local.ravel()[pixel]
    wide = rest > usual * (1.0 + WIDER * np.sqrt(2.0 / len(samples)))
    held = np.where(wide, rest, usual)
    beside = _beside(samples, mean, line, pixel)
    size = np.abs(off)
    first = (size >= np.nan_to_num(np.abs(beside)).max(axis=1, initial=0.0)) & (
        size > LEAST_SIGMA * np.sqrt(held)
    )
    return FarSamples(pixel[first], off[first], held[first], beside[first], code[first])


def without_one(off: Floats, variance: Floats, n: int) -> Floats:
    """Return variances of `n` samples without the one that is off by `off` from the others."""
    # The mean of all is off / n from that of the others.
    squares = variance * (n - 1) - off**2 * (n - 1) / n
    return np.asarray(np.maximum(squares, 0.0) / max(n - 2, 1))


def _beside(samples: NDArray[np.generic], mean: Floats, line: Whole, pixel: Whole) -> Floats:
    n_rows, n_columns = mean.shape
    row, column = np.divmod(pixel, n_columns)
    found = []
    for down in (-1, 0, 1) if n_rows > 1 else (0,):
        for along in (-1, 0, 1):
            if (down, along) == (0, 0):
                continue
            r, c = row + down, column + along
            inside = (r >= 0) & (r < n_rows) & (c >= 0) & (c < n_columns)
            r, c = np.where(inside, r, 0), np.where(inside, c, 0)
            off = samples[line, r, c].astype(np.float64) - mean[r, c]
            found.append(np.where(inside, off, np.nan))
    return np.stack(found, axis=1)
