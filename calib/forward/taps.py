"""Which output tap reads which column."""

import numpy as np
from numpy.typing import NDArray

from calib.errors import InputError
from calib.recording.header import CameraHeader

LINE_LAYOUTS = ("single", "odd_even", "halves", "quarters")
"""The layouts that a line sensor can have; `quadrants` belongs to area sensors."""

_TAPS = {"single": 1, "odd_even": 2, "halves": 2, "quarters": 4}


def tap_count(layout: str) -> int:
    """Return how many taps `layout` has; InputError where a line sensor cannot have it."""
    if layout not in _TAPS:
        raise InputError(
            f"tap layout {layout!r} is not one of a line sensor; give one of "
            f"{', '.join(LINE_LAYOUTS)}.",
            code="unknown-tap-layout",
        )
    return _TAPS[layout]


def tap_of_column(layout: str, n_columns: int) -> NDArray[np.intp]:
    """Return the tap, from 0, that reads each column, (n_columns,).

    >>> tap_of_column("odd_even", 4), tap_of_column("quarters", 8)
    (array([0, 1, 0, 1]), array([0, 0, 1, 1, 2, 2, 3, 3]))
    """
    taps = tap_count(layout)
    columns = np.arange(n_columns, dtype=np.intp)
    return columns % taps if layout == "odd_even" else columns * taps // n_columns


def columns_of_tap(layout: str, n_columns: int, tap: int) -> NDArray[np.intp]:
    """Return the columns that `tap` reads, ascending.

    >>> columns_of_tap("halves", 6, 1)
    array([3, 4, 5])
    """
    return np.flatnonzero(tap_of_column(layout, n_columns) == tap)


def by_tap(values: tuple[float, ...], layout: str, n_columns: int) -> NDArray[np.float64]:
    """Return each column's value where `values` holds one per tap, (n_columns,)."""
    return np.asarray(values, dtype=np.float64)[tap_of_column(layout, n_columns)]


def check_taps(values: tuple[float, ...], layout: str, camera: CameraHeader, where: str) -> None:
    """Raise InputError unless `values` is empty or has one value per tap of the camera."""
    if not values:
        return
    if layout != camera.tap_layout:
        raise InputError(
            f"{where}: tap_layout is {layout!r}, but the camera's is {camera.tap_layout!r}; "
            "give one for both.",
            code="tap-layout-mismatch",
        )
    if len(values) != tap_count(layout):
        raise InputError(
            f"{where} has {len(values)} values; give one for each of the {tap_count(layout)} taps "
            f"of layout {layout!r}.",
            code="wrong-length",
        )
