"""System gain, bias, photo-electrons and read noise of many pixels together.

A sum of per-pixel estimates does not become right by summing: each K̄ᵢ = Dᵢ²/Vᵢ is too high by the
squared relative error of Vᵢ on average, 10/(n−1) in the limit of shot noise, 10 % at 100 frames,
and more with its tails. Here numbers are averaged first and divided once (`weights` says how):

    G  = Σ aᵢVᵢ / Σ aᵢDᵢ           B  = mean(D̄₁ᵢ − Dᵢ/ρ)
    K̄  = mean(Dᵢ)/(ρG)             σ² = Σ βᵢ(σ₁ᵢ² − Vᵢ/ρ)/Σ βᵢ − 1/12

for SANUC; S3NUC takes K̄ = mean(Tᵢ)/G³, B = mean(D̄₁ᵢ) − mean(Tᵢ)/G², σ² = mean(σ₁ᵢ²) − mean(Tᵢ)/G.
K̄ takes the gains of the pixels for independent of how they are lit.
"""

from dataclasses import dataclass, fields
from typing import Any

import numpy as np

from calib.errors import NotDeterminedError
from calib.kernels.pooled_sums import GAIN, WEIGHT
from calib.transfer.estimate import Estimate
from calib.transfer.two_exposures.common_mode import CommonMode
from calib.transfer.two_exposures.frame_series import FrameSeries
from calib.transfer.two_exposures.pixel_maps import ROUNDING_DN2, Method
from calib.transfer.two_exposures.pooled_moments import PooledMoments, pooled_moments
from calib.transfer.two_exposures.propagation import Vector, propagate
from calib.transfer.two_exposures.tap_sums import TapSums

FEWEST_PIXELS = 16
SEEN_SIGMA = 3.0
"""The gain has to exceed so many of its standard uncertainties."""


@dataclass(frozen=True)
class PooledEstimates:
    """Of the pixels of one tap, or of all.

    Attributes:
        n_pixels: How many pixels are in it.
        system_gain_dn_per_e: Mean of the pixels' gains.
        bias_dn: Mean of their biases.
        photoelectrons: Mean over the pixels, of the first exposure.
        photoelectrons_step: By how many more the second exposure has.
        read_noise_variance_dn2: Without rounding, without what the frame's pixels have in common.
        read_noise_e: Its root, in electrons.
        common_offset_dn2: Variance of an offset that a frame's pixels share.
        flicker_relative2: Relative variance of the light from frame to frame.
        dispersion: By how much the variances scatter more than independent pixels' would.
    """

    n_pixels: int
    system_gain_dn_per_e: Estimate
    bias_dn: Estimate
    photoelectrons: Estimate
    photoelectrons_step: Estimate
    read_noise_variance_dn2: Estimate
    read_noise_e: Estimate
    common_offset_dn2: Estimate
    flicker_relative2: Estimate
    dispersion: tuple[float, float]

    def answer(self) -> dict[str, Any]:
        """Return it as JSON has it."""
        told: dict[str, Any] = {"pixels": self.n_pixels, "dispersion": list(self.dispersion)}
        estimates = {f.name: getattr(self, f.name) for f in fields(self)}
        return told | {n: e.answer() for n, e in estimates.items() if isinstance(e, Estimate)}


def pooled(
    sums: TapSums, of_tap: int, series: list[FrameSeries], method: Method = "sanuc"
) -> PooledEstimates:
    """Return the estimates over the pixels that have weights.

    Args:
        sums: Of all pixels.
        of_tap: One tap, or `ALL_TAPS`.
        series: Frame means of the first and of the second exposure, over the tap's pixels.
        method: Which equations.

    Raises:
        NotDeterminedError: `too-few-pixels`.
    """
    n_pixels = sums.n_usable(of_tap)
    if n_pixels < FEWEST_PIXELS or not sums.over(of_tap)[GAIN, WEIGHT] > 0:
        message = f"only {n_pixels} usable pixels, of which pooled estimates need {FEWEST_PIXELS}"
        raise NotDeterminedError(f"{message} with light: brighten it", code="too-few-pixels")
    moments = pooled_moments(sums, of_tap, series)
    values = np.array([*moments.values.ravel(), sums.pair.ratio])
    covariance = np.zeros((11, 11))
    covariance[:5, :5], covariance[5:10, 5:10] = moments.covariance
    covariance[10, 10] = sums.pair.ratio_std**2
    function = _sanuc if method == "sanuc" else _s3nuc
    with np.errstate(all="ignore"):
        found, of_found = propagate(function, values, covariance)
    return _estimates(n_pixels, found, np.sqrt(np.diag(of_found)), moments)


def _sanuc(x: Vector) -> Vector:
    """Return (G, B, K̄, ΔK̄, σ², σ/G)."""
    (m1a, v1a, m1, v1b, _), (m2a, v2a, m2, v2b, _), ratio = x[:5], x[5:10], x[10]
    rho = ratio - 1.0
    gain, step = (v2a - v1a) / (m2a - m1a), m2 - m1
    read = v1b - (v2b - v1b) / rho - ROUNDING_DN2
    electrons = step / gain
    return np.array([gain, m1 - step / rho, electrons / rho, electrons, read, np.sqrt(read) / gain])


def _s3nuc(x: Vector) -> Vector:
    """Return the same from the third moment."""
    (m1a, v1a, m1, v1b, t), (m2a, v2a, m2, _, _) = x[:5], x[5:10]
    gain = (v2a - v1a) / (m2a - m1a)
    read = v1b - t / gain - ROUNDING_DN2
    return np.array(
        [gain, m1 - t / gain**2, t / gain**3, (m2 - m1) / gain, read, np.sqrt(read) / gain]
    )


def _estimates(
    n_pixels: int, found: Vector, std: Vector, moments: PooledMoments
) -> PooledEstimates:
    units = ("DN/e-", "DN", "e-", "e-", "DN^2", "e-")
    ratio_bias = 1.0 + (std[0] / found[0]) ** 2  # of 1/G, as in `sanuc`
    values = found / np.array([1.0, 1.0, ratio_bias, ratio_bias, 1.0, 1.0])
    each = [Estimate(float(v), float(s), u) for v, s, u in zip(values, std, units, strict=True)]
    if not found[0] > SEEN_SIGMA * std[0]:
        why = "the variance does not grow with the signal by more than its uncertainty"
        each[2:4] = [Estimate.unknown("e-", why)] * 2
        each[5] = Estimate.unknown("e-", why)
    elif not found[4] > 0:
        why = "the read noise variance is not above 0: shot noise hides it"
        each[5] = Estimate.unknown("e-", why)
    gain, bias, electrons, step, read, read_e = each
    offset, flicker = _common(moments.common)
    return PooledEstimates(
        n_pixels, gain, bias, electrons, step, read, read_e, offset, flicker, moments.dispersion
    )


def _common(common: CommonMode) -> tuple[Estimate, Estimate]:
    """Return the offset's variance and the flicker's, from the excess at both exposures."""

    def function(x: Vector) -> Vector:
        lever = (common.ratio**2 - 1.0) * common.mean_signal_dn**2
        flicker = (x[1] - x[0]) / lever if lever > 0 else 0.0
        return np.array([x[0] - flicker * common.mean_signal_dn**2, flicker])

    covariance = np.diag(np.square(common.excess_std_dn2))
    values, of_values = propagate(function, np.array(common.excess_dn2), covariance)
    std = np.sqrt(np.diag(of_values))
    return (
        Estimate(float(values[0]), float(std[0]), "DN^2"),
        Estimate(float(values[1]), float(std[1]), "1"),
    )
