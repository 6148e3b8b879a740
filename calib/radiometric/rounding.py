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
from numpy.typing import NDArray

Cells = NDArray[np.float64]

HARMONICS = 8
SMALLEST_SIGMA_DN = 0.1
"""Below it the first two series would need more harmonics; σ is taken as this."""
NEGLIGIBLE_SIGMA_DN = 1.2
"""From here on the first harmonic is below 1e-12 DN."""
NEWTON_STEPS = 12
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
    mean_dn, sigma_dn = np.broadcast_arrays(
        np.asarray(mean_dn, np.float64), np.asarray(sigma_dn, np.float64)
    )
    coarse = (sigma_dn < NEGLIGIBLE_SIGMA_DN) & np.isfinite(mean_dn)
    mean = mean_dn.copy()
    variance = sigma_dn**2 + 1.0 / 12.0
    gain = np.ones_like(mean)
    if coarse.any():
        bias, extra, slope = _harmonics(mean_dn[coarse], sigma_dn[coarse])
        mean[coarse] += bias
        variance[coarse] += extra - bias**2
        gain[coarse] += slope
    return RoundedMoments(mean, np.maximum(variance, 0.0), gain)


def _harmonics(mean: Cells, sigma: Cells) -> tuple[Cells, Cells, Cells]:
    """Return the bias, the variance's cosine terms and the bias' derivative, (n,).

    cos kθ, sin kθ and q_k = q_1^(k²) by recurrence: one sine, cosine and exponential per cell.
    """
    sigma2 = np.maximum(sigma, SMALLEST_SIGMA_DN) ** 2
    needed = int(np.ceil(NEGLIGIBLE_SIGMA_DN / np.sqrt(sigma2.min(initial=1.0))))
    turn = 2.0 * np.pi * (mean - np.rint(mean))
    cosine, sine = np.cos(turn), np.sin(turn)
    damp = np.exp(-2.0 * np.pi**2 * sigma2)
    step, damp2 = damp.copy(), damp**2
    cos_k, sin_k, q_k = cosine, sine, damp
    bias, extra, slope = (np.zeros_like(mean) for _ in range(3))
    for k in range(1, min(needed, HARMONICS) + 1):
        sign = -1.0 if k % 2 else 1.0
        along = sign * q_k * cos_k
        bias += (sign / (np.pi * k)) * q_k * sin_k
        slope += 2.0 * along
        extra += along * (1.0 / (np.pi * k) ** 2 + 4.0 * sigma2)
        cos_k, sin_k = cos_k * cosine - sin_k * sine, sin_k * cosine + cos_k * sine
        step = step * damp2
        q_k = q_k * step
    return bias, extra, slope


def mean_square_bias(sigma_dn: Cells) -> Cells:
    """Return B², the bias squared averaged over all phases of the mean, DN²."""
    sigma = np.asarray(sigma_dn, np.float64)
    total = np.zeros_like(sigma)
    coarse = sigma < NEGLIGIBLE_SIGMA_DN
    sigma2 = sigma[coarse] ** 2
    for k in range(1, HARMONICS + 1):
        damped = np.exp(-4.0 * (np.pi * k) ** 2 * sigma2)
        total[coarse] += damped / (2.0 * (np.pi * k) ** 2)
    return total


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
    sigma = np.broadcast_to(np.asarray(sigma_dn, np.float64), np.shape(mean_code))
    invertible = sigma >= INVERTIBLE_SIGMA_DN
    estimate = np.array(mean_code, np.float64)
    undo = invertible & (sigma < NEGLIGIBLE_SIGMA_DN) & np.isfinite(estimate)
    if undo.any():
        estimate[undo] = _invert(estimate[undo], sigma[undo])
    moments = rounded_moments(estimate, sigma)
    of_one = np.where(invertible, moments.variance_dn2 / moments.gain**2, typical_variance(sigma))
    left = np.where(invertible, 0.0, mean_square_bias(sigma))
    return UnroundedMean(estimate, of_one, left)


def _invert(code: Cells, sigma: Cells) -> Cells:
    """Solve µ + b(µ) = code by Newton's method; the left side rises with µ everywhere."""
    estimate = code.copy()
    for _ in range(NEWTON_STEPS):
        bias, _, slope = _harmonics(estimate, sigma)
        step = np.clip((code - estimate - bias) / (1.0 + slope), -0.25, 0.25)
        estimate += step
        if np.abs(step).max(initial=0.0) < 1e-7:
            break
    return estimate
