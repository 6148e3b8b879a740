"""Names for the arrays that travel through the project.

Axes are `(n_lines, n_columns)`; a name ending in `_dn`, `_e`, `_us` carries its unit.

What one exposure gives is a sample: a line, (n_columns,), or an area sensor's frame, (n_rows,
n_columns). What is said of lines and columns then holds of frames and their pixels: a signal is
(n_lines, *sample), and what belongs to a pixel has the shape of a sample.
"""

import numpy as np
from numpy.typing import NDArray

Columns = NDArray[np.float64]
"""One number per column, shape (n_columns,)."""

Pixels = NDArray[np.float64]
"""One number per pixel of a sample, shape (n_columns,) or (n_rows, n_columns)."""

SampleShape = int | tuple[int, ...]
"""Of a line, n_columns or (n_columns,); of a frame, (n_rows, n_columns)."""

Lines = NDArray[np.floating]
"""A signal by line and column, shape (n_lines, n_columns); of frames, (n_lines, *sample)."""

RawLines = NDArray[np.uint8] | NDArray[np.uint16]
"""Codes as a camera sends them, of the shape of `Lines`, 0 .. 2**bit_depth - 1."""


def by_line(values: Columns, n_axes: int) -> NDArray[np.float64]:
    """Return one value per line, (n_lines,), with axes of length 1 up to `n_axes`.

    >>> by_line(np.ones(4), 3).shape
    (4, 1, 1)
    """
    return values.reshape(-1, *(1,) * (n_axes - 1))
