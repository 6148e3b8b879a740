"""Mean, k₂ and k₃ of every pixel from exact sums modulo 2⁶⁴ (`pixel_moments` says why these do)."""

from collections import deque

import numpy as np
from numba import njit, uint64

from calib.kernels.in_parts import in_parts
from calib.kernels.pixel_sums import Moments, Pixels, PixelSums, Sums


def central_moments(sums: PixelSums) -> Moments:
    """Return mean, k₂ and k₃ of every pixel, correct to rounding in double precision.

    k₃ = n·Σ(x−m)³ / ((n−1)(n−2)); its rounding error is below 10⁻¹⁵ of Σ|x−c|³ + Σ(x−c)².
    """
    each = (sums.codes, sums.squares, sums.cubes)
    return moments_into(sums.n_frames, each, tuple(np.empty(sums.codes.size) for _ in each))


def moments_into(n_frames: int, sums: tuple[Sums, ...], out: tuple[Pixels, ...]) -> Moments:
    """Fill `out`, which may be the memory of the sums: a pixel's are read before it is written."""

    def fill(some: slice) -> None:
        _moments(n_frames, *(array[some] for array in (*sums, *out)))

    deque(in_parts(len(out[0]), fill), maxlen=0)
    return Moments(*out)


@njit(cache=True, nogil=True)
def _moments(n, codes, squares, cubes, mean, variance, third):  # type: ignore[no-untyped-def]  # noqa: PLR0917 - compiled
    if n < 3:
        third[:] = np.nan
    if n < 2:
        variance[:] = np.nan
    if n < 1:
        mean[:] = np.nan
        return
    count = uint64(n)
    for i in range(len(codes)):
        # The sum of codes itself fits: n is below 2⁴⁷.
        c = (codes[i] + count // uint64(2)) // count
        s1 = np.int64(codes[i] - count * c)
        s2 = np.int64(squares[i] - uint64(2) * c * codes[i] + count * c * c)
        s3 = np.int64(
            cubes[i] - uint64(3) * c * squares[i] + uint64(3) * c * c * codes[i] - count * c * c * c
        )
        off = s1 / n
        mean[i] = c + off
        if n > 1:
            variance[i] = (s2 - s1 * off) / (n - 1)
        if n > 2:
            third[i] = (s3 - 3.0 * off * s2 + 2.0 * s1 * off * off) * n / ((n - 1.0) * (n - 2.0))
