"""What the machine itself allows: memory copied, and loops that do nothing but the least."""

from collections.abc import Callable

import numpy as np
from numba import njit, uint32, uint64

from calib.kernels.counted_numbers import hashed, normal_number
from calib.kernels.radiance import aligned


def copying(n_bytes: int) -> Callable[[], None]:
    """Return a call that moves `n_bytes` in all: half of them are read, half are written."""
    source, target = aligned((1, n_bytes // 2), np.uint8), aligned((1, n_bytes // 2), np.uint8)
    source[:] = 7
    target[:] = 0
    return lambda: np.copyto(target, source)


@njit(cache=True, nogil=True)
def bare_sums(dn, first, stop, codes, squares):
    """Add lines to 32-bit sums and 64-bit squares, eight at once, and nothing else.

    Of at most 65,536 lines of 16-bit codes; what is left of the last eight is not added.
    """
    for n in range(first, stop - 7, 8):
        row0, row1, row2, row3 = dn[n], dn[n + 1], dn[n + 2], dn[n + 3]
        row4, row5, row6, row7 = dn[n + 4], dn[n + 5], dn[n + 6], dn[n + 7]
        for i in range(dn.shape[1]):
            a, b, c, d = uint32(row0[i]), uint32(row1[i]), uint32(row2[i]), uint32(row3[i])
            e, f, g, h = uint32(row4[i]), uint32(row5[i]), uint32(row6[i]), uint32(row7[i])
            codes[i] += a + b + c + d + e + f + g + h
            squares[i] += uint64(a * a) + uint64(b * b) + uint64(c * c) + uint64(d * d)
            squares[i] += uint64(e * e) + uint64(f * f) + uint64(g * g) + uint64(h * h)


@njit(cache=True, nogil=True, fastmath=True, error_model="numpy")
def bare_normal_codes(codes, low, high):
    """Fill `codes` with normal numbers of the counter-based generator, scaled to codes."""
    n_lines, n_columns = codes.shape
    for n in range(n_lines):
        out = codes[n]
        counter = np.uint32(np.uint32(n) * np.uint32(n_columns))
        for i in range(n_columns):
            z = normal_number(hashed(np.uint32(counter + np.uint32(i)), low, high))
            out[i] = np.int32(z * np.float32(20) + np.float32(2000))


@njit(cache=True, nogil=True)
def bare_combination(means, offset, slope):
    """Add up five rows twice, with two sets of fixed weights, in single precision."""
    a, b, c, d, e = means[0], means[1], means[2], means[3], means[4]
    w = np.float32(0.1)
    for i in range(means.shape[1]):
        offset[i] = (a[i] + b[i] + c[i] + d[i] + e[i]) * w
        slope[i] = (e[i] - a[i] + (d[i] - b[i]) * w) * w
