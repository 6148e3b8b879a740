"""Sums of pixels by group: each pixel belongs to one, or to none."""

import numpy as np
from numba import njit
from numpy.typing import NDArray

Floats = NDArray[np.float64]


def group_sums(values: Floats, group: NDArray[np.intp], n_groups: int) -> Floats:
    """Return the sums over each group, (k, n_groups), of `values`, (k, n_pixels).

    Args:
        values: Of each pixel.
        group: The group of each, (n_pixels,); `n_groups` for none.
        n_groups: How many there are.
    """
    sums = np.zeros((len(values), n_groups + 1))
    _add(np.ascontiguousarray(values, np.float64), group, sums)
    return sums[:, :n_groups]


@njit(cache=True, nogil=True)
def _add(values, group, sums):  # type: ignore[no-untyped-def]  # compiled
    for k in range(values.shape[0]):
        for p in range(values.shape[1]):
            sums[k, group[p]] += values[k, p]
