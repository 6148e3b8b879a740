"""Sums over the pixels that nowhere clip, and how many clip, in one pass."""

from typing import NamedTuple

import numpy as np
from numba import njit

from calib.kernels.exposure_arrays import PairArrays
from calib.kernels.in_parts import in_parts


class UnclippedSums(NamedTuple):
    """Of two exposures' pixels.

    Attributes:
        n_at_zero: Pixels of which a sample stood at code 0.
        n_at_full_scale: Pixels of which one stood at the highest code.
        n_pixels: Pixels of which none stood at either; the sums are over these.
        means_dn: ΣD̄ of both exposures, DN.
        variances_dn2: Σk₂ of both, DN².
    """

    n_at_zero: int
    n_at_full_scale: int
    n_pixels: int
    means_dn: tuple[float, float]
    variances_dn2: tuple[float, float]


def unclipped_sums(pair: PairArrays) -> UnclippedSums:
    """Return them."""
    first, second = pair.first, pair.second

    def part(some: slice) -> tuple[float, ...]:
        found: tuple[float, ...] = _sums(
            *(
                e[some]
                for x in (first, second)
                for e in (x.mean, x.variance, x.at_zero, x.at_full_scale)
            )
        )
        return found

    sums = np.sum(list(in_parts(first.mean.size, part)) or [(0.0,) * 7], axis=0)
    n_zero, n_full, n, m1, m2, v1, v2 = (float(each) for each in sums)
    return UnclippedSums(int(n_zero), int(n_full), int(n), (m1, m2), (v1, v2))


@njit(cache=True, nogil=True, fastmath={"reassoc"})
def _sums(mean1, variance1, zero1, full1, mean2, variance2, zero2, full2):  # type: ignore[no-untyped-def]  # noqa: PLR0917 - compiled
    n_zero, n_full, n, m1, m2, v1, v2 = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    for i in range(len(mean1)):
        zero = 1.0 if (zero1[i] | zero2[i]) > 0 else 0.0
        full = 1.0 if (full1[i] | full2[i]) > 0 else 0.0
        counts = (1.0 - zero) * (1.0 - full)
        n_zero, n_full, n = n_zero + zero, n_full + full, n + counts
        m1, m2 = m1 + counts * mean1[i], m2 + counts * mean2[i]
        v1, v2 = v1 + counts * variance1[i], v2 + counts * variance2[i]
    return n_zero, n_full, n, m1, m2, v1, v2
