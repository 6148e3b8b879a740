"""Sums of differences between two exposures, and which columns each tap reads."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

STEPS_PER_DN = 64
"""Differences are whole numbers of 1/64 DN."""
Steps = NDArray[np.int32]
"""Whole numbers of 1/64 DN."""
Lag = tuple[int, int]
"""Rows and columns from one pixel to the other; rows ≥ 0."""


@dataclass(frozen=True)
class TapRuns:
    """Which columns each tap reads: first, last + 1 and step, (n_taps, 3)."""

    runs: NDArray[np.int64]

    @classmethod
    def of(cls, tap: NDArray[np.intp]) -> "TapRuns":
        """Return the runs of a row whose columns are read by the taps `tap`, (n_columns,).

        >>> TapRuns.of(np.array([0, 1, 0, 1])).runs.tolist()
        [[0, 3, 2], [1, 4, 2]]
        """
        runs = []
        for number in np.unique(tap):
            columns = np.flatnonzero(tap == number)
            step = int(columns[1] - columns[0]) if len(columns) > 1 else 1
            runs.append((int(columns[0]), int(columns[-1]) + 1, step))
        return cls(np.array(runs, np.int64))


@dataclass(frozen=True)
class RowSums:
    """Sums of differences over the columns of a tap, each (n_rows, n_taps).

    Attributes:
        differences: Σ d, DN.
        counts: How many differences.
    """

    differences: NDArray[np.int64]
    counts: NDArray[np.int64]

    @classmethod
    def zero(cls, n_rows: int, n_taps: int) -> "RowSums":
        """Return the sums over no columns."""
        return cls(*(np.zeros((n_rows, n_taps), np.int64) for _ in range(2)))


@dataclass(frozen=True)
class LagSums:
    """Sums of products over rows, each (n_lags, n_columns), in units of 1/64² DN².

    Attributes:
        products: Σ d[n, i]·d[n + rows, i + columns], exact.
        counts: How many products; 0 where i + columns lies beyond the line.
    """

    products: NDArray[np.int64]
    counts: NDArray[np.int64]

    def __add__(self, other: "LagSums") -> "LagSums":
        """Return the sums over the rows of both."""
        return LagSums(self.products + other.products, self.counts + other.counts)

    @classmethod
    def zero(cls, n_lags: int, n_columns: int) -> "LagSums":
        """Return the sums over no rows."""
        return cls(*(np.zeros((n_lags, n_columns), np.int64) for _ in range(2)))
