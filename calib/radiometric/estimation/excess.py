"""How much more numbers scatter than their known covariance says.

Contrasts z, free of what was fitted, have the covariance S + τ²·M with S known. τ² is what makes

    Q(τ²) = zᵀ (S + τ²·M)⁻¹ z

equal to its expectation, the number of contrasts ν; 0 where Q(0) is below it already (Paule and
Mandel 1982, J. Res. Natl. Bur. Stand. 87, 377, here for correlated errors). Where S is nothing, τ²
is the plain variance; where S is all, it does not follow the noisiest contrasts.

With few degrees of freedom, τ² is not well known itself. `variance_factor` widens it so that a
standard uncertainty is what it is taken for: ν/(ν − 2), the variance of Student's t (JCGM
101:2008, 6.4.9), makes it the standard deviation of what happens; for ν = 1 and 2, where t has no
variance, twice it covers 95.45 % as with a normal number (JCGM 100:2008, G.3 and table G.2).
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import eigh, null_space
from scipy.optimize import brentq
from scipy.stats import t as student

from calib.arrays import Columns

COVERED = 0.9545
"""By ±2 standard deviations of a normal number."""


@dataclass(frozen=True)
class Excess:
    """What the scatter has beyond the known covariance.

    Attributes:
        variance: τ².
        chi_squared: Q(0) or, where τ² was given, Q(τ²); infinite where nothing is known to scatter.
        freedom: ν.
    """

    variance: float
    chi_squared: float
    freedom: int

    @property
    def sigma(self) -> float:
        """How unlikely `chi_squared` is, as standard deviations of a normal number.

        Its cube root is nearly normal (Wilson and Hilferty 1931).
        """
        width = 2.0 / (9.0 * self.freedom)
        return float((np.cbrt(self.chi_squared / self.freedom) - (1.0 - width)) / np.sqrt(width))


def free_of(design: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return contrasts that no combination of the design's columns moves, (n_contrasts, n)."""
    return np.asarray(null_space(design.T).T)


def excess(
    contrasts: Columns,
    known: NDArray[np.float64],
    moved: NDArray[np.float64],
    stated: float | None = None,
) -> Excess:
    """Find τ².

    Args:
        contrasts: z, (ν,), one or more.
        known: S, (ν, ν), no negative eigenvalue.
        moved: M, (ν, ν), all eigenvalues positive.
        stated: τ² where it is known; None finds it.
    """
    freedom = len(contrasts)
    eigenvalues, vectors = eigh(known, moved)
    eigenvalues = np.maximum(eigenvalues, 0.0)
    square = (vectors.T @ contrasts) ** 2
    largest = (1.0 + 1e-9) * float(square.sum()) / freedom

    def chi_squared(tau2: float) -> float:
        total, some = eigenvalues + tau2, square > 0
        if (total[some] <= 0).any():
            return float("inf")
        return float((square[some] / total[some]).sum())

    if stated is not None:
        return Excess(stated, chi_squared(stated), freedom)
    at_nothing = chi_squared(0.0)
    if at_nothing <= freedom:
        return Excess(0.0, at_nothing, freedom)
    lowest = 0.0 if np.isfinite(at_nothing) else 1e-12 * largest
    if chi_squared(lowest) <= freedom:
        return Excess(lowest, at_nothing, freedom)
    found = brentq(lambda tau2: chi_squared(tau2) - freedom, lowest, largest, xtol=1e-12 * largest)
    return Excess(float(found), at_nothing, freedom)


def variance_factor(freedom: int) -> float:
    """Return by how much a variance that `freedom` degrees of freedom tell is to be widened."""
    if freedom < 1:
        return 1.0
    if freedom > 2:
        return freedom / (freedom - 2.0)
    return float(student.ppf(0.5 * (1.0 + COVERED), freedom) / 2.0) ** 2
