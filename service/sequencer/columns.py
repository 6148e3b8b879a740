"""A cheap look at the columns, or an area sensor's pixels, while frames pass."""

import numpy as np
from numpy.typing import NDArray

from calib.arrays import Columns, RawLines

_LINES_LOOKED_AT = 32


def column_mean(dn: RawLines) -> Columns:
    """Return the mean code per column, (n_columns,), of lines or rows all over a frame."""
    few = dn[:: -(-len(dn) // _LINES_LOOKED_AT)]
    mean_dn: Columns = few.mean(axis=0, dtype=np.float64)
    return mean_dn


class ColumnLook:
    """The mean of a block's columns, from a part of each frame's lines.

    Of an area sensor, whose frames count as lines, the mean of every pixel.
    """

    def __init__(self) -> None:
        self._sum: NDArray[np.float64] | None = None
        self._n_frames = 0

    def add(self, mean_dn: Columns | RawLines) -> None:
        """Take one frame's means in: (n_columns,), or an area sensor's frame as it is."""
        if self._sum is None:
            self._sum = np.zeros(mean_dn.shape)
        self._sum += mean_dn
        self._n_frames += 1

    def mean_dn(self) -> Columns:
        """Return the mean over the frames so far, flat; empty before the first."""
        return np.empty(0) if self._sum is None else self._sum.ravel() / self._n_frames


class BrightestColumn:
    """The brightest column's mean, or pixel's; those bright in the dark say nothing of light."""

    def __init__(self, full_scale_dn: int) -> None:
        self._hot_dn = full_scale_dn / 2
        self._judged: NDArray[np.bool_] | None = None

    def of(self, mean_dn: Columns, *, dark: bool) -> float:
        """Return the mean of the brightest column that counts; 0 where none does."""
        if dark:
            self._judged = mean_dn < self._hot_dn
        counted = mean_dn if self._judged is None else mean_dn[self._judged]
        return float(np.max(counted, initial=0.0))
