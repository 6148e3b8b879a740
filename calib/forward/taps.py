"""Which output tap reads which pixel."""

import numpy as np
from numpy.typing import NDArray

from calib.arrays import Pixels, SampleShape
from calib.errors import InputError
from calib.recording.header import CameraHeader

LINE_LAYOUTS = ("single", "odd_even", "halves", "quarters")
"""The layouts that go by columns: a line sensor's, or every row's of an area sensor."""
LAYOUTS = (*LINE_LAYOUTS, "quadrants")
"""All of them; `quadrants` are of area sensors alone."""

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


def taps_of_camera(camera: CameraHeader) -> NDArray[np.intp]:
    """Return the tap, from 0, that reads each pixel of what was read out, (*sample,).

    Taps are counted on the whole sensor, of which a camera may read out a part.

    >>> camera = CameraHeader(
    ...     columns=4, first_column=1, bit_depth=8, taps=2, tap_layout="halves", sensor_columns=8
    ... )
    >>> taps_of_camera(camera)
    array([0, 0, 0, 1])
    """
    layout = camera.tap_layout if camera.taps > 1 else "single"
    columns = slice(camera.first_column, camera.first_column + camera.columns)
    n_columns = max(camera.sensor_columns or 0, columns.stop)
    if camera.rows is None:
        return tap_of_column(layout, n_columns)[columns]
    rows = slice(camera.first_row, camera.first_row + camera.rows)
    n_rows = max(camera.sensor_rows or 0, rows.stop)
    return tap_of_pixel(layout, (n_rows, n_columns))[rows, columns]


def columns_of_tap(layout: str, n_columns: int, tap: int) -> NDArray[np.intp]:
    """Return the columns that `tap` reads, ascending.

    >>> columns_of_tap("halves", 6, 1)
    array([3, 4, 5])
    """
    return np.flatnonzero(tap_of_column(layout, n_columns) == tap)


def tap_of_pixel(layout: str, sample: SampleShape) -> NDArray[np.intp]:
    """Return the tap, from 0, that reads each pixel, (*sample,).

    Quadrants count along the rows: top left, top right, bottom left, bottom right.

    >>> tap_of_pixel("quadrants", (2, 4)).tolist()
    [[0, 0, 1, 1], [2, 2, 3, 3]]
    """
    shape = (sample,) if isinstance(sample, int) else sample
    if layout != "quadrants" or len(shape) == 1:
        return np.broadcast_to(tap_of_column(layout, shape[-1]), shape)
    rows, columns = (tap_of_column("halves", n) for n in shape)
    return 2 * rows[:, np.newaxis] + columns


def by_tap(values: tuple[float, ...], layout: str, sample: SampleShape) -> Pixels:
    """Return each pixel's value where `values` holds one per tap, (*sample,)."""
    return np.asarray(values, dtype=np.float64)[tap_of_pixel(layout, sample)]


def check_layout(layout: str, camera: CameraHeader, where: str) -> None:
    """Raise InputError unless `layout` is that of the camera."""
    if layout != camera.tap_layout:
        raise InputError(
            f"{where}: tap_layout is {layout!r}, but the camera's is {camera.tap_layout!r}; "
            "give one for both.",
            code="tap-layout-mismatch",
        )


def check_taps(values: tuple[float, ...], layout: str, camera: CameraHeader, where: str) -> None:
    """Raise InputError unless `values` is empty or has one value per tap of the camera."""
    if not values:
        return
    check_layout(layout, camera, where)
    taps = 4 if layout == "quadrants" and camera.rows is not None else tap_count(layout)
    if len(values) != taps:
        raise InputError(
            f"{where} has {len(values)} values; give one for each of the {taps} taps "
            f"of layout {layout!r}.",
            code="wrong-length",
        )
