"""What rounding to whole codes does to the mean and the variance of a noisy signal.

A normal signal of mean µ and standard deviation σ (DN), rounded to the nearest code, has

    mean      µ + b(µ),    b(µ) = Σ_k (−1)^k / (πk) · sin 2πkµ · q_k,    q_k = exp(−2π²k²σ²)
    variance  σ² + 1/12 + Σ_k (−1)^k cos 2πkµ · q_k · (1/(πk)² + 4σ²) − b(µ)²

which follows from the Fourier series of the sawtooth `round(x) − x` and the normal signal's
characteristic function. The first harmonic's amplitude is 0.0023 DN at σ = 0.5 and 0.145 DN at
σ = 0.2. Averaged over µ, b² is B² = Σ_k q_k² / (2π²k²), which is 1/12 at σ = 0.

Source: Widrow and Kollár, Quantization Noise (2008), chapters 4 and 5; the sums are rederived.
"""

from dataclasses import dataclass

import numpy as np

from calib.kernels import rounding as kernel
from calib.kernels.rounding import Cells
from calib.kernels.unrounding import restored

SMALLEST_SIGMA_DN = 0.1
"""Below it the first two series would need more harmonics; σ is taken as this."""
NEGLIGIBLE_SIGMA_DN = 1.2
"""From here on the first harmonic is below 1e-12 DN."""
INVERTIBLE_SIGMA_DN = 0.25
"""Below it the mean code hardly moves with µ (by 0.42 of it at µ whole): no way back."""


@dataclass(frozen=True)
class RoundedMoments:
    """What rounded samples show; arrays of one shape.

    Attributes:
        mean_dn: Expected code.
        variance_dn2: Variance of the codes.
        gain: d(mean_dn)/dµ.
    """

    mean_dn: Cells
    variance_dn2: Cells
    gain: Cells


def rounded_moments(mean_dn: Cells, sigma_dn: Cells) -> RoundedMoments:
    """Return the moments of the codes of a normal signal; clipping is not looked at here."""
    mean, sigma = _pairs(mean_dn, sigma_dn)
    expected, variance, gain = kernel.moments(
        mean.ravel(),
        sigma.ravel(),
        smallest_dn=SMALLEST_SIGMA_DN,
        negligible_dn=NEGLIGIBLE_SIGMA_DN,
    )
    shape = mean.shape
    return RoundedMoments(expected.reshape(shape), variance.reshape(shape), gain.reshape(shape))


def _pairs(mean_dn: Cells, sigma_dn: Cells) -> tuple[Cells, Cells]:
    """Return both in double precision and in one shape."""
    mean, sigma = np.broadcast_arrays(
        np.asarray(mean_dn, np.float64), np.asarray(sigma_dn, np.float64)
    )
    return mean, sigma


def mean_square_bias(sigma_dn: Cells) -> Cells:
    """Return B², the bias squared averaged over all phases of the mean, DN²."""
    sigma = np.asarray(sigma_dn, np.float64)
    bias2 = kernel.mean_square_bias(sigma.ravel(), negligible_dn=NEGLIGIBLE_SIGMA_DN)
    return bias2.reshape(sigma.shape)


def typical_variance(sigma_dn: Cells) -> Cells:
    """Return the variance of codes averaged over all phases of the mean, DN²."""
    return np.asarray(sigma_dn, np.float64) ** 2 + 1.0 / 12.0 - mean_square_bias(sigma_dn)


@dataclass(frozen=True)
class UnroundedMean:
    """The mean of the signal behind the codes; arrays of one shape.

    Attributes:
        mean_dn: Estimate of µ.
        variance_of_one_dn2: Variance of µ from one sample; divide by the number of samples.
        variance_left_dn2: Of the bias that could not be undone (type B); no division.
    """

    mean_dn: Cells
    variance_of_one_dn2: Cells
    variance_left_dn2: Cells


def unrounded_mean(mean_code: Cells, sigma_dn: Cells) -> UnroundedMean:
    """Undo the bias where σ ≥ INVERTIBLE_SIGMA_DN; elsewhere leave the mean and state B².

    Args:
        mean_code: Mean of many rounded samples, DN.
        sigma_dn: The signal's noise before rounding, DN, from a model and not from these samples.
    """
    code, sigma = _pairs(mean_code, sigma_dn)
    filled = restored(
        code.ravel(),
        sigma.ravel(),
        smallest_dn=INVERTIBLE_SIGMA_DN,
        negligible_dn=NEGLIGIBLE_SIGMA_DN,
    )
    return UnroundedMean(*(each.reshape(code.shape) for each in filled))
