"""Exact sums over lines by column, and the mean and variance that follow from them."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Counts = NDArray[np.uint64]
"""Exact counts or sums by column, (n_columns,)."""


@dataclass(frozen=True)
class LineSums:
    """Exact sums over `n_lines` lines, each (n_columns,).

    Good for 2³² lines of 16-bit codes.
    """

    n_lines: int
    codes: Counts
    squares: Counts
    at_zero: Counts
    at_full_scale: Counts

    @classmethod
    def zero(cls, n_columns: int) -> "LineSums":
        """Return the sums over no lines."""
        return cls(0, *(np.zeros(n_columns, np.uint64) for _ in range(4)))

    def __add__(self, other: "LineSums") -> "LineSums":
        """Return the sums over the lines of both."""
        return LineSums(
            self.n_lines + other.n_lines,
            self.codes + other.codes,
            self.squares + other.squares,
            self.at_zero + other.at_zero,
            self.at_full_scale + other.at_full_scale,
        )

    def __sub__(self, part: "LineSums") -> "LineSums":
        """Return the sums over the lines that are not in `part`."""
        return LineSums(
            self.n_lines - part.n_lines,
            self.codes - part.codes,
            self.squares - part.squares,
            self.at_zero - part.at_zero,
            self.at_full_scale - part.at_full_scale,
        )

    @property
    def mean_dn(self) -> NDArray[np.float64]:
        """Mean code; NaN over no lines."""
        return self.codes / self.n_lines if self.n_lines else np.full(len(self.codes), np.nan)

    @property
    def variance_dn2(self) -> NDArray[np.float64]:
        """Unbiased variance, correct to rounding; NaN where there are fewer than two lines.

        Σ(x − c)² about an integer c next to the mean: taken from the sums modulo 2⁶⁴ it is exact,
        since the result fits, and what is then subtracted is below a quarter of n.
        """
        n = self.n_lines
        if n < 2:
            return np.full(len(self.codes), np.nan)
        about = (self.codes + np.uint64(n // 2)) // np.uint64(n)
        count = np.uint64(n)
        squares = self.squares - 2 * about * self.codes + count * about * about
        rest = (self.codes - count * about).view(np.int64)
        variance: NDArray[np.float64] = (squares - rest.astype(np.float64) ** 2 / n) / (n - 1)
        return variance


@dataclass(frozen=True)
class LaggedSums:
    """Sums and lagged products over consecutive lines.

    Attributes:
        sums: As without lags.
        column_products: Σ x[j, i]·x[j, i+1] over the lines j, (n_columns − 1,).
        line_products: Σ x[j, i]·x[j+1, i] over the n_lines − 1 pairs of lines, (n_columns,).
    """

    sums: LineSums
    column_products: Counts
    line_products: Counts
