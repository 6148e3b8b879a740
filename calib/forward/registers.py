"""In which order columns reach their outputs."""

import numpy as np
from numpy.typing import NDArray

from calib.errors import InputError
from calib.forward.taps import columns_of_tap, tap_count
from calib.recording.header import CameraHeader

READOUTS = ("left", "right", "both")
"""Where the register's output is: at column 0, at the last column, or one at each end."""


def registers(readout: str, n_columns: int, tap_layout: str = "single") -> tuple[slice, ...]:
    """Return each register's columns in the order in which they are read.

    >>> np.arange(5)[registers("both", 5)[1]]
    array([4, 3])
    >>> np.arange(5)[registers("right", 5, "odd_even")[0]]
    array([4, 2, 0])
    """
    # A row of quadrants is one of halves, and so is a line that is read at both of its ends.
    halved = tap_layout == "quadrants" or (tap_layout == "single" and readout == "both")
    layout = "halves" if halved else tap_layout
    n_taps = tap_count(layout)
    found = []
    for tap in range(n_taps):
        columns = columns_of_tap(layout, n_columns, tap)
        rightwards = readout == "right" or (readout == "both" and 2 * tap >= n_taps)
        step = n_taps if layout == "odd_even" else 1
        found.append(_stretch(columns, -step if rightwards else step))
    return tuple(found)


def _stretch(columns: NDArray[np.intp], step: int) -> slice:
    """Return ascending columns, `step` apart, as a slice; downwards where the step is."""
    if not columns.size:
        return slice(0, 0)
    first, last = int(columns[0]), int(columns[-1])
    if step > 0:
        return slice(first, last + 1, step)
    return slice(last, first - 1 if first else None, step)


def read_before(readout: str, n_columns: int, tap_layout: str) -> NDArray[np.intp]:
    """Return the column that each one's register reads just before it, (n_columns,), or -1.

    >>> read_before("both", 6, "halves").tolist(), read_before("right", 4, "odd_even").tolist()
    ([-1, 0, 1, 4, 5, -1], [2, 3, -1, -1])
    """
    before = np.full(n_columns, -1, np.intp)
    for register in registers(readout, n_columns, tap_layout):
        columns = np.arange(n_columns, dtype=np.intp)[register]
        before[columns[1:]] = columns[:-1]
    return before


def check_readout(readout: str, camera: CameraHeader, where: str) -> None:
    """Raise InputError unless `readout` is that of the camera."""
    if readout != camera.readout:
        raise InputError(
            f"{where}: readout is {readout!r}, but the camera's is {camera.readout!r}; "
            "give one for both.",
            code="readout-mismatch",
        )
