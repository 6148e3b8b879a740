"""Adds up one band of rows: codes, and differences of consecutive exposures."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from calib.arrays import RawLines
from calib.kernels.difference_sums import STEPS_PER_DN, Lag, LagSums, RowSums, Steps, TapRuns
from calib.kernels.line_sums import LineSums
from calib.kernels.pair_sums import first_row_sums, lag_sums, row_sums
from calib.kernels.sums import line_sums


@dataclass(frozen=True)
class BandSums:
    """Sums over a band's rows, column by column.

    Attributes:
        codes: Of the codes.
        lags: Of the products of differences.
    """

    codes: LineSums
    lags: LagSums

    @classmethod
    def zero(cls, n_lags: int, n_columns: int) -> "BandSums":
        """Return the sums over no rows."""
        return cls(LineSums.zero(n_columns), LagSums.zero(n_lags, n_columns))

    def with_codes(self, rows: RawLines, full_scale_dn: int) -> "BandSums":
        """Return the sums with the codes of `rows` added."""
        return BandSums(self.codes + line_sums(rows, full_scale_dn), self.lags)

    def with_products(self, products: LagSums) -> "BandSums":
        """Return the sums with `products` added."""
        return BandSums(self.codes, self.lags + products)


@dataclass(frozen=True)
class Difference:
    """Rows of an exposure and of the one before it, what their columns are, and where they end.

    Attributes:
        later: Codes, (n_rows, n_columns).
        earlier: As `later`.
        taps: Of the columns.
        limit: How far a difference may be off, (n_columns,).
    """

    later: RawLines
    earlier: RawLines
    taps: TapRuns
    limit: Steps

    def first_sums(self) -> RowSums:
        """Return sums that no outlier can pull far, (n_rows, n_taps)."""
        return first_row_sums(self.later, self.earlier, self.taps, self.limit)

    def sums_about(self, centre: Steps) -> RowSums:
        """Return sums without what is far from `centre`, (n_rows, n_taps)."""
        return row_sums(self.later, self.earlier, self.taps, self.limit, centre)

    def products_about(self, centre: Steps, lags: tuple[Lag, ...]) -> LagSums:
        """Return the products of what is left once `centre` is taken off."""
        return lag_sums(self.later, self.earlier, self.taps, self.limit, centre, lags=lags)


def centres(sums: RowSums, before: Steps | None = None) -> Steps:
    """Return the rows' means in 1/64 DN; where nothing was left to average, those of before."""
    means = STEPS_PER_DN * sums.differences / np.maximum(sums.counts, 1)
    rounded = np.rint(means).astype(np.int32)
    return rounded if before is None else np.where(sums.counts > 0, rounded, before)


def in_steps(limit_dn: NDArray[np.float64]) -> Steps:
    """Return limits in 1/64 DN; what is infinite becomes more than any difference."""
    return np.minimum(np.floor(limit_dn * STEPS_PER_DN), 2.0**30).astype(np.int32)
