"""The order of the vignette's polynomial.

The order is the one that predicts columns which the fit did not see best. The columns are held
out in interleaved strips: interleaved, because a polynomial cannot extrapolate and a contiguous
fifth of the line would ask it to; strips of several columns, because neighbours that share charge
or taps would give each other away; narrow, because the finest order allowed must resolve them.
The paper's criterion, the variance of the residuals, falls with every order that is added unless
divided by the degrees of freedom left; that one is kept beside it.
"""

from dataclasses import dataclass

import numpy as np

from calib.arrays import Columns
from calib.radiometric.estimation.whitened import Matrix, Whitened

FOLDS = 10


@dataclass(frozen=True)
class OrderChoice:
    """How well each order did.

    Attributes:
        orders: Polynomial degrees that were tried.
        held_out_rms: Relative error of predicting held-out columns, by order.
        residual_std: Relative residual over the degrees of freedom left, the paper's, by order.
        weights: What each order is worth by its prediction, summing to 1.
        chosen: The order that predicts best.
        by_residual: The order of the smallest residual.
    """

    orders: tuple[int, ...]
    held_out_rms: tuple[float, ...]
    residual_std: tuple[float, ...]
    weights: tuple[float, ...]
    chosen: int
    by_residual: int


def compare_orders(state: Whitened, orders: tuple[int, ...], n_taps: int) -> OrderChoice:
    """Predict each strip from the others, for every order."""
    design, target = state.design, state.target
    n = len(target)
    width = max(1, n // 128)
    fold = (np.arange(n) // width) % FOLDS
    gram, moment = design.T @ design, design.T @ target
    terms = n_taps + np.array(orders)  # the last term of each order
    missed = np.zeros(len(orders))
    for f in range(FOLDS):
        out, seen = design[fold == f], target[fold == f]
        basis, along = _orthogonal(gram - out.T @ out, moment - out.T @ seen)
        off = seen[:, None] - np.cumsum((out @ basis) * along, axis=1)[:, terms]
        missed += (off**2).sum(axis=0)
    _, along = _orthogonal(gram, moment)
    rest = np.maximum(target @ target - np.cumsum(along**2)[terms], 0.0)
    left = np.sqrt(rest / np.maximum(n - terms - 1, 1))
    typical = float(np.median(state.relative_sigma[state.use]))
    return OrderChoice(
        orders=orders,
        held_out_rms=tuple(float(v) for v in typical * np.sqrt(missed / n)),
        residual_std=tuple(float(v) for v in typical * left),
        weights=_weights(missed),
        chosen=orders[int(np.argmin(missed))],
        by_residual=orders[int(np.argmin(left))],
    )


def _orthogonal(gram: Matrix, moment: Columns) -> tuple[Matrix, Columns]:
    """Return what makes the terms orthonormal, (n, n), and the target's share along each, (n,).

    Each orthonormal term is made of the terms up to it, so that one basis serves all orders: the
    fit of the first m terms is the sum of the first m shares. With gram = R'R (Cholesky) the basis
    is R⁻¹.
    """
    basis = np.linalg.inv(np.linalg.cholesky(gram)).T
    return basis, basis.T @ moment


def _weights(missed: Columns) -> tuple[float, ...]:
    """Return the orders' weights: their predictive likelihood, exp(−deviance / 2), scaled."""
    likelihood = np.exp(-0.5 * (missed - missed.min()))
    return tuple(float(w) for w in likelihood / likelihood.sum())


def profiles_of_orders(state: Whitened, orders: tuple[int, ...], n_taps: int) -> Matrix:
    """Return the polynomial of every order, (n_orders, highest order + 1)."""
    basis, along = _orthogonal(state.design.T @ state.design, state.design.T @ state.target)
    return np.array([basis[n_taps:, : n_taps + o + 1] @ along[: n_taps + o + 1] for o in orders])
