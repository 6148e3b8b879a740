"""From codes to radiance, its standard uncertainty and its flags in one pass over memory.

With s = DN - dark, each column has radiance = s·scale and the variance of s
    c0 + s·(c1 + c2·s) + K·max(s, 0)
in single precision. `calib.radiometric.correction.apply_terms` says what the terms are made of.
"""

from typing import TypeVar

import numpy as np
from numba import njit
from numpy.typing import NDArray

from calib.arrays import RawLines

Scalar = TypeVar("Scalar", bound=np.generic)

_SATURATED = np.uint8(1)
_BELOW_BLACK = np.uint8(2)
_EXTRAPOLATED = np.uint8(8)
_NONE = np.uint8(0)
_ZERO = np.float32(0)
_INFINITE = np.float32(np.inf)
_CACHE_LINE = 64

Floats = NDArray[np.float32]
Terms = tuple[Floats, Floats, Floats, Floats, Floats, np.float32]


def correct(
    dn: RawLines,
    terms: Terms,
    limits_dn: tuple[int, int, int],
    base_flags: NDArray[np.uint8],
    out: tuple[Floats, Floats | None, NDArray[np.uint8]],
) -> None:
    """Fill `out` with radiance, its standard uncertainty (unless None) and flags.

    Args:
        dn: (n_lines, n_columns), native byte order.
        terms: dark, scale, c0, c1, c2, each (n_columns,), and K. A NaN scale gives NaN.
        limits_dn: The lowest and the highest code that is not extrapolated, and the code from
            which on a sample is saturated.
        base_flags: (n_columns,): what holds for all samples of a column.
        out: (n_lines, n_columns) each.
    """
    radiance, std, flags = out
    limits = tuple(np.clip(limits_dn, 0, 0xFFFF).astype(np.uint16))
    black = _lowest_above_black(terms[0])
    if std is None:
        _radiance(dn, terms[:2], (*limits, black), base_flags, (radiance, flags))
    else:
        _radiance_and_std(dn, terms, (*limits, black), base_flags, (radiance, std, flags))


def _lowest_above_black(dark: Floats) -> NDArray[np.uint16]:
    """Return the lowest code that is neither 0 nor below the dark level, (n_columns,)."""
    codes = np.fmin(np.fmax(np.ceil(dark), 1.0), 0xFFFF)
    return codes.astype(np.uint16)


def aligned(shape: tuple[int, int], dtype: type[Scalar]) -> NDArray[Scalar]:
    """Return uninitialised memory that starts at a cache line: stores across two are slower."""
    size = int(np.prod(shape)) * np.dtype(dtype).itemsize
    block = np.empty(size + _CACHE_LINE, np.uint8)
    start = -block.ctypes.data % _CACHE_LINE
    return block[start : start + size].view(dtype).reshape(shape)


@njit(cache=True, nogil=True, inline="always")
def _flag(codes, limits, base, flags):  # type: ignore[no-untyped-def]
    """Fill a line's flags: the base ones and those that the codes themselves raise.

    A loop of its own, of whole numbers only, takes half the time that it would beside the floats.
    """
    lowest, highest, saturated, black = limits
    for column in range(codes.size):
        code = codes[column]
        raised = base[column]
        raised |= _SATURATED if code >= saturated else _NONE
        raised |= _BELOW_BLACK if code < black[column] else _NONE
        raised |= _EXTRAPOLATED if (code < lowest) | (code > highest) else _NONE
        flags[column] = raised


@njit(cache=True, nogil=True)
def _radiance(dn, terms, limits, base, out):  # type: ignore[no-untyped-def]
    """Fill (radiance, flags)."""
    dark, scale = terms
    radiance, flags = out
    for line in range(dn.shape[0]):
        codes, corrected = dn[line], radiance[line]
        for column in range(codes.size):
            corrected[column] = (np.float32(codes[column]) - dark[column]) * scale[column]
        _flag(codes, limits, base, flags[line])


@njit(cache=True, nogil=True)
def _radiance_and_std(dn, terms, limits, base, out):  # type: ignore[no-untyped-def]
    """Fill (radiance, std, flags)."""
    dark, scale, c0, c1, c2, gain = terms
    radiance, std, flags = out
    for line in range(dn.shape[0]):
        codes, corrected, deviations = dn[line], radiance[line], std[line]
        for column in range(codes.size):
            code = codes[column]
            signal = np.float32(code) - dark[column]
            corrected[column] = signal * scale[column]
            variance = c0[column] + signal * (c1[column] + c2[column] * signal)
            variance += gain * max(signal, _ZERO)
            deviation = np.sqrt(variance) * scale[column]
            deviations[column] = deviation if code < limits[2] else deviation * _INFINITE
        _flag(codes, limits, base, flags[line])
