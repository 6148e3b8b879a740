"""Where a signal stands among codes of unequal widths, in codes of width 1."""

from typing import Any

import numpy as np
from numba import njit
from numpy.typing import NDArray

Floats = NDArray[np.float64]


def stretched_codes(signal: NDArray[np.floating[Any]], edges: Floats) -> Floats:
    """Return the signal with each code's interval stretched to k - 1/2 .. k + 1/2, of its shape.

    Args:
        signal: DN, of any shape.
        edges: Where code k begins, and k - 1 ends, DN, (n_codes + 1,), ascending. A code whose
            edges coincide is left out; what lies beyond the ends keeps its distance from them,
            over the width of the code there.
    """
    flat = np.asarray(signal, np.float64).ravel()
    found = np.empty_like(flat)
    _stretch(flat, edges, found)
    return found.reshape(np.shape(signal))


@njit(cache=True, nogil=True)
def _stretch(signal, edges, found):  # type: ignore[no-untyped-def]  # compiled
    for i in range(signal.shape[0]):
        code = _code_of(signal[i], edges)
        width = edges[code + 1] - edges[code]
        found[i] = code - 0.5 + (signal[i] - edges[code]) / (width if width > 0.0 else 1.0)


@njit(cache=True, nogil=True)
def _code_of(value, edges):  # type: ignore[no-untyped-def]  # compiled
    """Return the last code that begins at or below the value, looked for from its nearest on."""
    last = edges.shape[0] - 2
    low = min(max(int(min(max(value + 0.5, 0.0), last)), 0), last)
    high, step = low + 1, 1
    while low > 0 and edges[low] > value:
        high, low, step = low, max(low - step, 0), 2 * step
    while high <= last and edges[high] <= value:
        low, high, step = high, min(high + step, last + 1), 2 * step
    while high - low > 1:
        middle = (low + high) // 2
        if edges[middle] <= value:
            low = middle
        else:
            high = middle
    return low
