"""Models of the temporal variance as a function of the signal.

With x the signal that a straight response would give (DN above the dark level), K the system gain,
σ_r the read noise (DN) and N = x/K the electrons:

    straight           V = K·x + σ_r²
    brighter_fatter    V = K²·(exp(2·a00·N) − 1) / (2·a00) + σ_r²,  a00 < 0  (Astier 2019, Eq. 16)
    nonlinear          s = x·(1 − β·x), so that the variance of the codes is (1 − 2βx)²·V(x)
    quadratic          V = K·s + q·s² + σ_r², whatever bends it

An exponent 2·a00·N of more than 1 is no sensor's: charge gathered would have to widen its pixel by
half, while it repels what follows. Trials of a fit get there all the same (a sensor that lags,
of few lines); the exponential goes on as its tangent then.

To each the rounding to whole codes adds 1/12 − B² (`calib.rounding`), averaged over all phases of
the mean; B² is nothing from half a DN of noise up. A response that bends, bends the means as well:
the mean of s over the noise is x − β·(x² + V).

Source: Astier et al. 2019, A&A 629, A36 (arXiv:1905.08677); EMVA Standard 1288, Release 4.0
Linear, section 2; the response is the forward model's `nonlinearity`.
"""

from dataclasses import dataclass

import numpy as np

from calib.arrays import Columns
from calib.rounding import mean_square_bias

ROUNDING_DN2 = 1.0 / 12.0
MOST_EXPONENT = 1.0
"""Of what charge does to its own pixel."""


@dataclass(frozen=True)
class Shape:
    """A curve's parameters; those at 0 bend nothing.

    Attributes:
        system_gain: K, DN per electron.
        read_variance_dn2: σ_r², DN², before rounding.
        beta_per_dn: β of the response, per DN.
        a00_per_e: a00, per electron.
        curvature: q of the quadratic, 1/1 (DN² per DN²).
    """

    system_gain: float
    read_variance_dn2: float
    beta_per_dn: float = 0.0
    a00_per_e: float = 0.0
    curvature: float = 0.0

    def charge_variance(self, linear_dn: Columns) -> Columns:
        """Return V(x) before the response bends it, DN²."""
        gain, a00 = self.system_gain, self.a00_per_e
        return np.asarray(
            gain * linear_dn * exponential_share(2.0 * a00 * linear_dn / gain)
            + self.curvature * linear_dn**2
            + self.read_variance_dn2
        )

    def linear(self, signal_dn: Columns) -> Columns:
        """Return x of the mean signal s: x − β(x² + V(x)) = s, on the rising branch."""
        beta = self.beta_per_dn
        if beta == 0.0:
            return signal_dn
        found = signal_dn
        for _ in range(3):
            # The root of x − βx² = t, written so that β → 0 loses no digits.
            target = signal_dn + beta * self.charge_variance(found)
            found = 2.0 * target / (1.0 + np.sqrt(np.maximum(1.0 - 4.0 * beta * target, 1e-12)))
        return np.asarray(found)

    def mean(self, linear_dn: Columns, spread: Columns) -> Columns:
        """Return the mean of s over noise, and over pixels of a relative variance `spread`."""
        square = linear_dn**2 * (1.0 + spread) + self.charge_variance(linear_dn)
        return np.asarray(linear_dn - self.beta_per_dn * square)

    def slope(self, linear_dn: Columns) -> Columns:
        """Return ds/dx."""
        return np.asarray(1.0 - 2.0 * self.beta_per_dn * linear_dn)

    def variance(self, signal_dn: Columns) -> Columns:
        """Return the variance of the codes at the mean signal s, DN²."""
        return rounded_variance(self.variance_before_rounding(signal_dn))

    def variance_before_rounding(self, signal_dn: Columns) -> Columns:
        """Return σ² at the mean signal s, DN²; a trial's may be negative."""
        x = self.linear(signal_dn)
        return np.asarray(self.slope(x) ** 2 * self.charge_variance(x))

    def fourth_cumulant(self, signal_dn: Columns) -> Columns:
        """Return κ4 of the codes, that of Poisson's law: K⁴·N, DN⁴."""
        return np.asarray(self.system_gain**3 * np.maximum(signal_dn, 0.0))


def rounded_variance(variance_dn2: Columns) -> Columns:
    """Return the variance of codes whose signal has `variance_dn2`, over all phases, DN²."""
    sigma = np.sqrt(np.maximum(variance_dn2, 0.0))
    return np.asarray(variance_dn2 + ROUNDING_DN2 - mean_square_bias(sigma))


def exponential_share(t: Columns) -> Columns:
    """Return (exp(t) − 1)/t, 1 at 0; beyond `MOST_EXPONENT` exp goes on as its tangent there."""
    small = np.abs(t) < 1e-8
    safe = np.where(small, 1.0, t)
    within = np.minimum(safe, MOST_EXPONENT)
    grown = np.expm1(within) + np.exp(within) * (safe - within)
    return np.where(small, 1.0 + 0.5 * t, grown / safe)
