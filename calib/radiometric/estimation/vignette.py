"""VE: the smooth optical profile, apart from what differs between neighbours.

AgCam (Olsen et al. 2010), section 5.2: a polynomial through the slopes, divided by its maximum.
Here in Legendre polynomials over the line scaled to −1 .. 1 (well conditioned at any order), with
weights for errors that grow with the signal: PRNU is a relative scatter ε, so that the slope's
variance about the profile p is p²(ε² + v/p²), v the slope's own variance. ε comes from the fit.

The order is chosen as `order_choice` says.

Taps of different gain put steps or a comb into the slopes. They are fitted along, as factors with
mean 1, so that the smooth profile does not bend to them; they stay in the responsivity.
"""

from dataclasses import dataclass

import numpy as np
from numpy.polynomial import legendre
from numpy.typing import NDArray

from calib.arrays import Columns
from calib.errors import NotDeterminedError
from calib.radiometric.estimation.order_choice import (
    OrderChoice,
    compare_orders,
    profiles_of_orders,
)
from calib.radiometric.estimation.whitened import Matrix, whitened_rows

ORDERS = range(2, 13)


@dataclass(frozen=True)
class ProfileFit:
    """A polynomial profile and the covariance of its coefficients.

    Attributes:
        coefficients: Of the Legendre polynomials, then of the tap contrasts.
        covariance: Of the coefficients, PRNU's scatter and the slopes' noise included.
        order: Degree.
        scatter: ε, the relative scatter of the slopes about the profile without their noise.
        columns_used: Which columns were fitted.
        choice: Comparison of the orders.
        alternatives: Coefficients of the Legendre polynomials for each of `choice.orders`, padded
            with 0 to the highest, (n_orders, highest order + 1).
    """

    coefficients: Columns
    covariance: Matrix
    order: int
    scatter: float
    columns_used: NDArray[np.bool_]
    choice: OrderChoice
    alternatives: Matrix

    def profile(self, columns: Columns) -> Columns:
        """Return the profile at (fractional) columns."""
        return self.basis(columns) @ self.coefficients[: self.order + 1]

    def basis(self, columns: Columns) -> Matrix:
        """Return the Legendre polynomials at `columns`, (n, order + 1)."""
        x = scaled(columns, len(self.columns_used))
        return np.asarray(legendre.legvander(x, self.order), np.float64)

    @property
    def smooth_covariance(self) -> Matrix:
        """Of the polynomial's coefficients alone, the taps being fitted along."""
        return self.covariance[: self.order + 1, : self.order + 1]


def scaled(columns: Columns, n_columns: int) -> Columns:
    """Return columns scaled to −1 at the first and 1 at the last."""
    return np.asarray(2.0 * columns / (n_columns - 1) - 1.0, np.float64)


def fit_profile(
    slope: Columns, slope_variance: Columns, contrasts: Matrix, order: int | None = None
) -> ProfileFit:
    """Fit the profile to the columns whose slope is finite and positive.

    Args:
        slope: (n_columns,), NaN where masked.
        slope_variance: Of the slopes, without what all columns share.
        contrasts: Tap contrasts, (n_columns, taps − 1), from `tap_contrasts`.
        order: A fixed order; None chooses among `ORDERS`.

    Raises:
        NotDeterminedError: `too-few-columns` where the columns do not bear a polynomial.
    """
    use = np.isfinite(slope) & (slope > 0)
    highest = min(ORDERS[-1], int(use.sum()) // 8)
    if highest < ORDERS[0] or (order is not None and order > int(use.sum()) // 2):
        message = (
            f"Only {int(use.sum())} of {len(slope)} columns can be used, too few for a vignette "
            "profile: look at the masked columns' reasons, then record again."
        )
        raise NotDeterminedError(message, code="too-few-columns")
    orders = tuple(o for o in ORDERS if o <= highest) if order is None else (order,)
    legend = legendre.legvander(
        scaled(np.arange(len(slope), dtype=np.float64), len(slope)), orders[-1]
    )
    design = np.hstack([contrasts, legend])
    n_taps = contrasts.shape[1]
    state = whitened_rows(design, slope, slope_variance, use, orders[-1])
    choice = compare_orders(state, orders, n_taps)
    n_smooth = choice.chosen + 1
    final = whitened_rows(
        design[:, : n_taps + n_smooth], slope, slope_variance, use, choice.chosen, start=state
    )
    covariance = np.linalg.inv(final.design.T @ final.design)
    coefficients = covariance @ (final.design.T @ final.target)
    smooth_first = np.r_[n_taps : n_taps + n_smooth, 0:n_taps]
    return ProfileFit(
        coefficients[smooth_first],
        covariance[np.ix_(smooth_first, smooth_first)],
        choice.chosen,
        final.scatter,
        final.use,
        choice,
        profiles_of_orders(state, orders, n_taps),
    )


def tap_contrasts(tap: NDArray[np.intp]) -> Matrix:
    """Return columns that carry the taps' factors with mean 1, (n_columns, taps − 1)."""
    n_taps = int(tap.max()) + 1
    one_hot = np.eye(n_taps)[tap]
    return one_hot[:, :-1] - one_hot[:, -1:]
