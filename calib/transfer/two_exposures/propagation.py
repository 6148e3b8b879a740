"""Propagation of uncertainty through a function of a few correlated numbers."""

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

Vector = NDArray[np.float64]


def propagate(
    function: Callable[[Vector], Vector], values: Vector, covariance: NDArray[np.float64]
) -> tuple[Vector, NDArray[np.float64]]:
    """Return the function's values and their covariance, J·C·Jᵀ.

    Source: JCGM 102:2011, 6.2. J is taken by central differences of a thousandth of each standard
    uncertainty, over which the functions here are straight.

    >>> value, cov = propagate(lambda x: x[:1] / x[1:], np.array([6.0, 2.0]), np.diag([0.04, 0.01]))
    >>> value.item(), round(cov.item(), 6)
    (3.0, 0.0325)
    """
    steps = 1e-3 * np.sqrt(np.diag(covariance))
    columns = []
    for k, step in enumerate(steps):
        moved = np.zeros_like(values)
        moved[k] = step
        rise = function(values + moved) - function(values - moved)
        columns.append(rise / (2.0 * step) if step > 0 else np.zeros_like(rise))
    jacobian = np.stack(columns, axis=1)
    return function(values), jacobian @ covariance @ jacobian.T
