"""Figures of merit of K and σ_r², with their covariance."""

import math

import numpy as np
from numpy.typing import NDArray

from calib.rounding import SMALLEST_SIGMA_DN
from calib.transfer.estimate import Estimate

HIDDEN = f"it is below {SMALLEST_SIGMA_DN} DN, so that rounding to whole codes hides it"
NO_DARKS = "there are no darks: the read noise is what they have, and the signal counts from them"


def gain_estimate(value: NDArray[np.float64], covariance: NDArray[np.float64]) -> Estimate:
    """Return K."""
    if not np.isfinite(covariance[0, 0]):
        reason = "the variance does not grow over the signals that were recorded"
        return Estimate.unknown("DN/e-", reason)
    return Estimate(float(value[0]), math.sqrt(covariance[0, 0]), "DN/e-")


def read_noise_dn(
    value: NDArray[np.float64], covariance: NDArray[np.float64], has_darks: bool
) -> Estimate:
    """Return σ_r."""
    if not has_darks:
        return Estimate.unknown("DN", NO_DARKS)
    if not np.isfinite(covariance[1, 1]):
        return Estimate.unknown("DN", "the darks' variance does not tell it")
    if value[1] < SMALLEST_SIGMA_DN**2:
        return Estimate.unknown("DN", HIDDEN)
    sigma = math.sqrt(value[1])
    return Estimate(sigma, math.sqrt(covariance[1, 1]) / (2.0 * sigma), "DN")


def read_noise_e(
    value: NDArray[np.float64], covariance: NDArray[np.float64], has_darks: bool
) -> Estimate:
    """Return σ_r / K, with the covariance of σ_r² and K."""
    in_dn = read_noise_dn(value, covariance, has_darks)
    gain = gain_estimate(value, covariance)
    for part in (in_dn, gain):
        if not part.is_known:
            return Estimate.unknown("e-", part.reason)
    found = in_dn.value / gain.value
    slope = np.array([-found / gain.value, 1.0 / (2.0 * in_dn.value * gain.value)])
    return Estimate(found, math.sqrt(slope @ covariance @ slope), "e-")
