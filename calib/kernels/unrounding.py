"""Undoing what rounding to whole codes does to a noisy signal's mean, cell by cell.

`calib.rounding` has the formulas. From 0.25 DN of noise up the mean behind
a mean code is found by Newton's method; below, the code hardly moves with the mean.
"""

from math import pi

import numpy as np
from numba import njit
from numpy.typing import NDArray

from calib.kernels.rounding import PER_PI, PER_PI2, TILE, bias2_and_decay, decay, turn

Cells = NDArray[np.float64]

_HARMONICS = 5  # the sixth is below 1e-19 at σ = 0.25, the least that is inverted
_FEW_HARMONICS, _FEW_FROM_DN2 = 2, 0.25  # the third is below 1e-19 at σ = 0.5
_NEWTON_STEPS = 12
_CONVERGED_DN = 1e-7  # each step squares the error


def restored(
    code_dn: Cells, sigma_dn: Cells, *, smallest_dn: float, negligible_dn: float
) -> tuple[Cells, Cells, Cells]:
    """Return µ of which `code_dn` is the expected value, and what it is worth, (n,) each.

    The variance of µ from one sample is that of its codes, over the square of d(code)/dµ.

    Args:
        code_dn: (n,); NaN gives NaN.
        sigma_dn: (n,); where below `smallest_dn`, 0.25 or more, the code itself is returned, with
            the variance of codes averaged over all phases of µ, and, third, the mean square of
            the bias that is left (0 elsewhere).
        smallest_dn: See `sigma_dn`.
        negligible_dn: As for `moments`; where all of a stretch have more, nothing is undone.
    """
    filled = np.empty((3, code_dn.size))
    _restore(code_dn, sigma_dn, smallest_dn**2, negligible_dn**2, filled)
    mean, of_one, left = filled
    return mean, of_one, left


@njit(cache=True, nogil=True, inline="always")
def _bias_and_slope(mean, damp, harmonics):  # type: ignore[no-untyped-def]
    cosine, sine = turn(mean)
    cos_k, sin_k, q_k, step = cosine, sine, damp, damp
    bias, slope = 0.0, 0.0
    for k in range(harmonics):
        bias += PER_PI[k] * q_k * sin_k
        slope += (4.0 * (k % 2) - 2.0) * q_k * cos_k
        cos_k, sin_k = cos_k * cosine - sin_k * sine, sin_k * cosine + cos_k * sine
        step = step * (damp * damp)
        q_k = q_k * step
    return bias, slope


@njit(cache=True, nogil=True, inline="always")
def _variance_and_gain(mean, sigma2, damp, harmonics):  # type: ignore[no-untyped-def]
    cosine, sine = turn(mean)
    cos_k, sin_k, q_k, step = cosine, sine, damp, damp
    bias, slope, extra = 0.0, 0.0, 0.0
    for k in range(harmonics):
        along = (2.0 * (k % 2) - 1.0) * q_k * cos_k
        bias += PER_PI[k] * q_k * sin_k
        slope += 2.0 * along
        extra += along * (PER_PI2[k] + 4.0 * sigma2)
        cos_k, sin_k = cos_k * cosine - sin_k * sine, sin_k * cosine + cos_k * sine
        step = step * (damp * damp)
        q_k = q_k * step
    return max(sigma2 + 1.0 / 12.0 + extra - bias * bias, 0.0), 1.0 + slope


@njit(cache=True, nogil=True, inline="always")
def _newton_step(wanted, damp, estimate, harmonics):  # type: ignore[no-untyped-def]
    """Move `estimate` on; return how many of it have not arrived."""
    moving = 0
    for i in range(wanted.size):
        bias, slope = _bias_and_slope(estimate[i], damp[i], harmonics)
        step = (wanted[i] - estimate[i] - bias) / (1.0 + slope)
        step = min(max(step, -0.25), 0.25)
        estimate[i] += step
        moving += abs(step) > _CONVERGED_DN
    return moving


@njit(cache=True, nogil=True, error_model="numpy")
def undo(code, sigma2, smallest2, negligible2, mean, variance, gain):  # type: ignore[no-untyped-def]  # noqa: PLR0917 - compiled
    """Find the `mean` behind each code, from where it is; fill what its codes vary by, and d/dµ.

    At most `TILE` codes; what has less noise than the smallest stays where it is.
    """
    damp = np.empty(code.size)
    few = True
    for i in range(code.size):
        damped = decay(2.0 * pi * pi * min(sigma2[i], negligible2))
        damp[i] = damped if sigma2[i] >= smallest2 else 0.0
        few &= sigma2[i] >= _FEW_FROM_DN2
    for _ in range(_NEWTON_STEPS):
        if few:
            moving = _newton_step(code, damp, mean, _FEW_HARMONICS)
        else:
            moving = _newton_step(code, damp, mean, _HARMONICS)
        if moving == 0:
            break
    if few:
        for i in range(code.size):
            variance[i], gain[i] = _variance_and_gain(mean[i], sigma2[i], damp[i], _FEW_HARMONICS)
    else:
        for i in range(code.size):
            variance[i], gain[i] = _variance_and_gain(mean[i], sigma2[i], damp[i], _HARMONICS)


@njit(cache=True, nogil=True, error_model="numpy")
def _restore(code, sigma, smallest2, negligible2, filled):  # type: ignore[no-untyped-def]
    variances, codes, gains = np.empty(TILE), np.empty(TILE), np.empty(TILE)
    for left in range(0, code.size, TILE):
        right = min(left + TILE, code.size)
        n = right - left
        sigma2, variance, gain = variances[:n], codes[:n], gains[:n]
        mean, of_one, bias2 = filled[0, left:right], filled[1, left:right], filled[2, left:right]
        n_low, n_high = 0, 0
        for i in range(n):
            sigma2[i] = sigma[left + i] * sigma[left + i]
            of_one[i] = sigma2[i] + 1.0 / 12.0
            n_low += sigma2[i] < smallest2
            n_high += sigma2[i] >= negligible2
        mean[:], bias2[:] = code[left:right], 0.0
        if n_high == n:
            continue
        if n_low < n:
            undo(code[left:right], sigma2, smallest2, negligible2, mean, variance, gain)
            for i in range(n):
                of_one[i] = variance[i] / (gain[i] * gain[i])
        if n_low > 0:
            _leave(sigma2, smallest2, negligible2, of_one, bias2)


@njit(cache=True, nogil=True, error_model="numpy")
def _leave(sigma2, smallest2, negligible2, of_one, bias2):  # type: ignore[no-untyped-def]
    """Fill what a code is worth whose mean cannot be found."""
    for i in range(sigma2.size):
        lost, _ = bias2_and_decay(sigma2[i], negligible2)
        is_low = sigma2[i] < smallest2
        bias2[i] = lost if is_low else 0.0
        typical = sigma2[i] + 1.0 / 12.0 - lost
        of_one[i] = typical if is_low else of_one[i]
