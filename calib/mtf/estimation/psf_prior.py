"""What is assumed of a PSF before it is measured: where it ends, and that it is no noise.

A Gaussian process on the support: covariance a²·e(u)·e(u')·k(|u − u'|), k Matérn's of order 3/2
with length ℓ and envelope e(x, y) = (1 − (2x/S)²)^p·(1 − (2y/S)²)^p on the support's side S. p =
0 says no more than the support does; p = 1 and 2 say that a pixel collects most near its centre.
a, ℓ and p are those under which the harmonics that were measured are most probable (marginal
likelihood), so that nothing is set by hand.

Source: Rasmussen and Williams, Gaussian Processes for Machine Learning (2006), sections 4.2.1 and
5.4.1.
"""

from dataclasses import dataclass
from itertools import product

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import solve_triangular
from scipy.optimize import minimize_scalar

from calib.mtf.estimation.compact_basis import CompactBasis

Matrix = NDArray[np.floating]
_POWERS = (0, 1, 2)
_LENGTHS = (1 / 12, 1 / 6, 1 / 3, 2 / 3)  # of the support's side
_LOG_RANGE = (-6.0, 12.0)


@dataclass(frozen=True)
class PsfPrior:
    """One choice of a, p and ℓ.

    Attributes:
        power: p of the envelope.
        length_um: ℓ, µm.
        variance: a², of a cell's share of the signal.
        log_likelihood: Of the measured harmonics, up to a constant that all choices share.
    """

    power: int
    length_um: float
    variance: float = 1.0
    log_likelihood: float = -np.inf

    def covariance(self, basis: CompactBasis) -> Matrix:
        """Return the cells' covariance, (n², n²)."""
        reach = np.sqrt(3) * basis.distances_um() / self.length_um
        inside = np.prod(1 - (2 * basis.places_um / basis.side_um) ** 2, axis=0) ** self.power
        share = basis.cell_um**2 * inside
        return np.asarray(
            self.variance * np.multiply.outer(share, share) * (1 + reach) * np.exp(-reach)
        )


def most_probable(basis: CompactBasis, design: Matrix, seen: Matrix, noise: Matrix) -> PsfPrior:
    """Return the prior under which `seen` is most probable.

    Args:
        basis: The cells.
        design: What the cells make of the data, (n_data, n²).
        seen: The data, (n_data,).
        noise: Their covariance.
    """
    root = np.linalg.cholesky(noise)
    white = solve_triangular(root, np.column_stack([design, seen]), lower=True)
    tried = [
        _with_variance(PsfPrior(power, share * basis.side_um), basis, white)
        for power, share in product(_POWERS, _LENGTHS)
    ]
    return max(tried, key=lambda each: each.log_likelihood)


def _with_variance(prior: PsfPrior, basis: CompactBasis, white: Matrix) -> PsfPrior:
    """Return the prior with its most probable variance; data and design are whitened."""
    design, seen = white[:, :-1], white[:, -1]
    values, vectors = np.linalg.eigh(design @ prior.covariance(basis) @ design.T)
    values, power = np.maximum(values, 0), (vectors.T @ seen) ** 2

    def deviance(log_variance: float) -> float:
        total = np.exp(log_variance) * values + 1
        return float((power / total + np.log(total)).sum())

    middle = float(np.log(max(power.sum(), 1e-300) / max(values.sum(), 1e-300)))
    bounds = (middle + _LOG_RANGE[0], middle + _LOG_RANGE[1])
    best = minimize_scalar(deviance, bounds=bounds, method="bounded")
    return PsfPrior(prior.power, prior.length_um, float(np.exp(best.x)), -0.5 * float(best.fun))
