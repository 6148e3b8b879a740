"""Names for the arrays that travel through the project.

Axes are always `(n_lines, n_columns)`; a name ending in `_dn`, `_e`, `_us` carries its unit.
"""

import numpy as np
from numpy.typing import NDArray

Columns = NDArray[np.float64]
"""One number per column, shape (n_columns,)."""

Lines = NDArray[np.floating]
"""A signal by line and column, shape (n_lines, n_columns)."""

RawLines = NDArray[np.uint8] | NDArray[np.uint16]
"""Codes as a camera sends them, shape (n_lines, n_columns), 0 .. 2**bit_depth - 1."""
