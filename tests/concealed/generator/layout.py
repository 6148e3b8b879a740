"""Which tap reads which column, and how far each column is from its output."""

import numpy as np
from numpy.typing import NDArray

TAPS = {"single": 1, "odd_even": 2, "halves": 2, "quarters": 4, "quadrants": 4}


def tap_map(layout: str, rows: int, columns: int) -> NDArray[np.intp]:
    """Return the tap, from 0, that reads each pixel, (rows, columns).

    >>> tap_map("quadrants", 2, 4).tolist()
    [[0, 0, 1, 1], [2, 2, 3, 3]]
    >>> tap_map("odd_even", 1, 4).tolist()
    [[0, 1, 0, 1]]
    """
    column, row = np.arange(columns), np.arange(rows)[:, np.newaxis]
    along = {
        "single": np.zeros_like(column),
        "odd_even": column % 2,
        "halves": 2 * column // columns,
        "quarters": 4 * column // columns,
        "quadrants": 2 * column // columns,
    }[layout]
    down = 2 * (2 * row // rows) if layout == "quadrants" else np.zeros_like(row)
    return np.asarray(along + down)


def registers(layout: str, readout: str, columns: int) -> list[NDArray[np.intp]]:
    """Return the columns of each register, its output's neighbour first.

    >>> [register.tolist() for register in registers("halves", "both", 6)]
    [[0, 1, 2], [5, 4, 3]]
    >>> [register.tolist() for register in registers("odd_even", "right", 4)]
    [[2, 0], [3, 1]]
    """
    taps = tap_map("halves" if layout == "quadrants" else layout, 1, columns)[0]
    n_taps = int(taps.max()) + 1
    each = [np.flatnonzero(taps == tap) for tap in range(n_taps)]
    if readout == "both" and n_taps == 1:
        each = list(np.array_split(np.arange(columns), 2))
        n_taps = 2
    rightwards = [
        readout == "right" or (readout == "both" and tap >= n_taps // 2) for tap in range(n_taps)
    ]
    return [one[::-1] if right else one for one, right in zip(each, rightwards, strict=True)]


def partner(layout: str, readout: str, columns: int) -> NDArray[np.intp]:
    """Return the column that is read at the same moment by the neighbouring tap, (columns,).

    >>> partner("odd_even", "left", 4).tolist()
    [1, 0, 3, 2]
    """
    own = np.arange(columns)
    each = registers(layout, readout, columns)
    for one, other in zip(each[0::2], each[1::2], strict=True):
        n = min(len(one), len(other))
        own[one[:n]], own[other[:n]] = other[:n], one[:n]
    return own
