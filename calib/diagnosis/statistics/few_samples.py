"""Variances and covariances of few samples: how many numbers tell them, and how they scatter.

Chi-squared of few degrees of freedom is skewed: variances are made normal numbers.

Source: Wilson and Hilferty, The distribution of chi-square, PNAS 17, 684 (1931): its cube root is
normal, nearly.
"""

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]

FEW = 64
"""Degrees of freedom from which on a variance's own excess is normal enough."""


def excess_as_normal(ratio: Floats, freedom: float) -> Floats:
    """Return the excess of variances over what is expected, such that chance is normal.

    Args:
        ratio: Variance over the expected one.
        freedom: Degrees of freedom of each.

    Returns:
        What times sqrt(freedom / 2) has mean 0 and standard deviation 1 by chance; of many degrees
        of freedom ratio - 1.
    """
    if freedom >= FEW or freedom <= 0:
        return np.asarray(ratio - 1.0)
    spread = 2.0 / (9.0 * freedom)
    z = (np.cbrt(ratio) - (1.0 - spread)) / np.sqrt(spread)
    return np.asarray(z / np.sqrt(freedom / 2.0))


def pairs_of(n: int, lag: int) -> int:
    """Return how many pairs of `n` lines are `lag` apart; 1 where there is none."""
    return max(n - lag, 1)


def lagged_covariance(values: Floats, lag: int) -> Floats:
    """Return the covariance of lines, or frames, `lag` apart, of residuals (..., n_lines)."""
    products = values[..., lag:] * values[..., :-lag]
    return np.asarray(products.sum(axis=-1) / pairs_of(values.shape[-1], lag))


def lagged_variance(n: int, lag: int) -> float:
    """Return the variance of a covariance between lines `lag` apart, of unit variance each.

    `lagged_covariance` of residuals about the mean of `n` lines is a quadratic form, whose variance
    is 2 tr((S P)^2), S the shift's symmetric part and P what takes the mean off. Of many lines that
    is 1 / (n - lag).
    """
    if n >= FEW:
        return 1.0 / (n - lag)
    shift = (np.eye(n, k=lag) + np.eye(n, k=-lag)) / 2.0
    form = shift @ (np.eye(n) - 1.0 / n)
    return float(2.0 * np.trace(form @ form) / (n - lag) ** 2)
