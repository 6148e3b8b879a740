"""The harmonics that rounding to whole codes adds to a normal signal's moments, cell by cell.

`calib.rounding` has the formulas. Sine, cosine and exponential are
polynomials here, so that the loops over cells become vector instructions; calls of the C library
take ten times as long.
With q the first harmonic's damping exp(-2π²σ²), the k-th one's is q^(k²), by recurrence.
"""

from math import factorial, pi

import numpy as np
from numba import njit
from numpy.typing import NDArray

Cells = NDArray[np.float64]

_HARMONICS = 8
TILE = 1024
_TO_NEAREST = 1.5 * 2.0**52  # what adding and subtracting it leaves is a whole number
_SINE = tuple((-1.0) ** n / factorial(2 * n + 1) for n in range(7))
_COSINE = tuple((-1.0) ** n / factorial(2 * n) for n in range(8))
_DECAY = tuple((-1.0) ** n / factorial(n) for n in range(11))
PER_PI = tuple((-1.0) ** k / (pi * k) for k in range(1, _HARMONICS + 1))
PER_PI2 = tuple(1.0 / (pi * k) ** 2 for k in range(1, _HARMONICS + 1))


def moments(
    mean_dn: Cells, sigma_dn: Cells, *, smallest_dn: float, negligible_dn: float
) -> tuple[Cells, Cells, Cells]:
    """Return the codes' expected value, their variance and d(expected value)/dµ, (n,) each.

    Args:
        mean_dn: µ, (n,); NaN gives NaN.
        sigma_dn: (n,); the harmonics are those of `smallest_dn` at least.
        smallest_dn: Above 0.
        negligible_dn: From where on all harmonics are as small as here; 1.2 at most.
    """
    filled = np.empty((3, mean_dn.size))
    _fill_moments(mean_dn, sigma_dn, smallest_dn**2, negligible_dn**2, filled)
    expected, variance, gain = filled
    return expected, variance, gain


def mean_square_bias(sigma_dn: Cells, *, negligible_dn: float) -> Cells:
    """Return the square of the bias averaged over all phases of µ, DN², (n,)."""
    filled = np.empty(sigma_dn.size)
    _fill_mean_square_bias(sigma_dn, negligible_dn**2, filled)
    return filled


@njit(cache=True, nogil=True, inline="always")
def _polynomial(x, coefficients):  # type: ignore[no-untyped-def]
    value = coefficients[-1]
    for n in range(len(coefficients) - 2, -1, -1):
        value = value * x + coefficients[n]
    return value


@njit(cache=True, nogil=True, inline="always")
def turn(cycles):  # type: ignore[no-untyped-def]
    """Return cosine and sine of 2π·cycles, from a quarter of the angle doubled twice."""
    angle = 0.5 * pi * (cycles - ((cycles + _TO_NEAREST) - _TO_NEAREST))
    square = angle * angle
    sine, cosine = angle * _polynomial(square, _SINE), _polynomial(square, _COSINE)
    sine, cosine = 2.0 * sine * cosine, 1.0 - 2.0 * sine * sine
    return 1.0 - 2.0 * sine * sine, 2.0 * sine * cosine


@njit(cache=True, nogil=True, inline="always")
def decay(x):  # type: ignore[no-untyped-def]
    """Return exp(-x) for 0 ≤ x ≤ 60 to a relative 1e-12: exp(-x/256), squared eight times."""
    value = _polynomial(x * (1.0 / 256.0), _DECAY)
    for _ in range(8):
        value = value * value
    return value


@njit(cache=True, nogil=True, error_model="numpy")
def _fill_moments(mean, sigma, smallest2, negligible2, filled):  # type: ignore[no-untyped-def]
    expected, variance, gain = filled[0], filled[1], filled[2]
    for i in range(mean.size):
        sigma2 = sigma[i] * sigma[i]
        taken2 = max(sigma2, smallest2)
        damp = decay(2.0 * pi * pi * min(taken2, negligible2))
        cosine, sine = turn(mean[i])
        cos_k, sin_k, q_k, step = cosine, sine, damp, damp
        bias, slope, extra = 0.0, 0.0, 0.0
        for k in range(_HARMONICS):
            along = (2.0 * (k % 2) - 1.0) * q_k * cos_k
            bias += PER_PI[k] * q_k * sin_k
            slope += 2.0 * along
            extra += along * (PER_PI2[k] + 4.0 * taken2)
            cos_k, sin_k = cos_k * cosine - sin_k * sine, sin_k * cosine + cos_k * sine
            step = step * (damp * damp)
            q_k = q_k * step
        expected[i] = mean[i] + bias
        variance[i] = max(sigma2 + 1.0 / 12.0 + extra - bias * bias, 0.0)
        gain[i] = 1.0 + slope


@njit(cache=True, nogil=True, inline="always")
def bias2_and_decay(sigma2, negligible2):  # type: ignore[no-untyped-def]
    """Return the mean square of the bias and minus its derivative to the noise's variance."""
    damp = decay(4.0 * pi * pi * min(sigma2, negligible2))
    q_k, step, total, falling = damp, damp, 0.0, 0.0
    for k in range(_HARMONICS):
        total += 0.5 * PER_PI2[k] * q_k
        falling += 2.0 * q_k
        step = step * (damp * damp)
        q_k = q_k * step
    return total, falling


@njit(cache=True, nogil=True, error_model="numpy")
def _fill_mean_square_bias(sigma, negligible2, filled):  # type: ignore[no-untyped-def]
    for i in range(sigma.size):
        filled[i], _ = bias2_and_decay(sigma[i] * sigma[i], negligible2)
