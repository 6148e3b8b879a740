"""Complex demodulation along the lines: Σ x[j, i]·cos[j] and Σ x[j, i]·sin[j] by column."""

import numpy as np
from numba import njit
from numpy.typing import NDArray

from calib.arrays import RawLines

Phasors = NDArray[np.complex128]
"""cos + i·sin by line or by column."""


def demodulated(dn: RawLines, phasors: Phasors, *, first: int = 0, step: int = 1) -> Phasors:
    """Return Σ x[j, i]·conj(phasors[j]) over the lines j = first, first + step, …, (n_columns,).

    Args:
        dn: Codes, (n_lines, n_columns), C-contiguous.
        phasors: (n_lines,).
        first: The first line.
        step: From one line to the next.
    """
    cosines, sines = np.ascontiguousarray(phasors.real), np.ascontiguousarray(phasors.imag)
    real, imaginary = np.zeros(dn.shape[1]), np.zeros(dn.shape[1])
    _demodulate(dn, cosines, sines, first, step, real, imaginary)
    return real - 1j * imaginary


@njit(cache=True, nogil=True)
def _demodulate(dn, cosines, sines, first, step, real, imaginary):  # type: ignore[no-untyped-def]  # noqa: PLR0917 - compiled
    line = first
    n_lines = dn.shape[0]
    while line + step < n_lines:
        other = line + step
        c0, c1, s0, s1 = cosines[line], cosines[other], sines[line], sines[other]
        line0, line1 = dn[line], dn[other]
        for i in range(len(real)):
            a, b = np.float64(line0[i]), np.float64(line1[i])
            real[i] += a * c0 + b * c1
            imaginary[i] += a * s0 + b * s1
        line += 2 * step
    if line < n_lines:
        for i in range(len(real)):
            real[i] += dn[line, i] * cosines[line]
            imaginary[i] += dn[line, i] * sines[line]
