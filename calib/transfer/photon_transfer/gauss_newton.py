"""Weighted least squares of a smooth model, by Gauss and Newton with halved steps."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Vector = NDArray[np.float64]
Matrix = NDArray[np.float64]

_STEPS = 40
_SMALL = 1e-9


@dataclass(frozen=True)
class Solution:
    """Where the sum of squares is least.

    Attributes:
        parameters: (n_parameters,).
        residual: Weighted, (n_data,).
        jacobian: Of the weighted residuals, (n_data, n_parameters).
    """

    parameters: Vector
    residual: Vector
    jacobian: Matrix

    @property
    def covariance(self) -> Matrix:
        """Of the parameters, for residuals of unit variance; what is not determined is infinite."""
        scale = np.linalg.norm(self.jacobian, axis=0)
        scale = np.where(scale > 0, scale, 1.0)
        normal = (self.jacobian / scale).T @ (self.jacobian / scale)
        if np.linalg.cond(normal) > 1e14:
            return np.full(normal.shape, np.inf)
        return np.asarray(np.linalg.inv(normal) / np.outer(scale, scale))


def solve(residual: Callable[[Vector], Vector], start: Vector, scale: Vector) -> Solution:
    """Minimise Σ residual².

    Args:
        residual: Weighted residuals of parameters.
        start: Near enough that steps which are halved where they do not help lead there.
        scale: A typical size of each parameter, for the differences that make the derivative.
    """
    at, value = np.array(start, np.float64), residual(start)
    jacobian = _jacobian(residual, at, scale)
    for _ in range(_STEPS):
        if not np.isfinite(jacobian).all():
            break
        step = np.linalg.lstsq(jacobian / _norms(jacobian), -value, rcond=1e-13)[0]
        step = step / _norms(jacobian)
        taken, before = 1.0, value @ value
        while taken > 1e-4:
            trial = residual(at + taken * step)
            if np.isfinite(trial).all() and trial @ trial <= before * (1.0 + 1e-12):
                break
            taken /= 2.0
        else:
            break
        at, value = at + taken * step, trial
        jacobian = _jacobian(residual, at, scale)
        if before - value @ value <= _SMALL * (1.0 + before):
            break
    return Solution(at, value, jacobian)


def _norms(jacobian: Matrix) -> Vector:
    norms = np.linalg.norm(jacobian, axis=0)
    return np.where(norms > 0, norms, 1.0)


def _jacobian(residual: Callable[[Vector], Vector], at: Vector, scale: Vector) -> Matrix:
    columns = []
    for k, size in enumerate(scale):
        step = np.zeros(len(at))
        step[k] = 1e-4 * size
        columns.append((residual(at + step) - residual(at - step)) / (2e-4 * size))
    return np.stack(columns, axis=1)
