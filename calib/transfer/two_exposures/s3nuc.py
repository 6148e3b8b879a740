"""S3NUC: gain, bias, photo-electrons and read noise from three moments at any two exposures.

Source: Yielding, Cain and Seal (2018), Eqs. 1-12 (after Catarius and Seal 2015). The skewness of
Eqs. 6 and 9 times σ³ is the third central moment; with T its unbiased estimate k₃ of the first
exposure, D = D̄₂ − D̄₁ and V = σ₂² − σ₁²:

    G  = V/D                        (8)         ΔK̄ = D/G = D²/V        (11)
    K̄  = T/G³                       (9)         B  = D̄₁ − T/G²         (10)
    σ² = σ₁² − T/G − 1/12           (12), without rounding (Sheppard)

The system is overdetermined: Eq. 7, the second exposure's skewness, is not used, as in the paper.
T/G^p is biased by G's noise, and as T and V come from the same frames; to second order by

    1 + p(p+1)/2·var(ln G) − p·cov(ln T, ln G),

which is divided by. No matter how long one records, T's noise √(6σ⁶/n) is 1 or more of its value
G³·K̄ until n reaches 6·K̄.
"""

from dataclasses import dataclass

import numpy as np

from calib.kernels.pixel_sums import Pixels
from calib.transfer.two_exposures.exposure_pair import ExposurePair
from calib.transfer.two_exposures.pixel_maps import PixelMaps, by_pixel
from calib.transfer.two_exposures.sampling import SamplingCovariance, sampling_covariances
from calib.transfer.two_exposures.sanuc import ROUNDING_DN2
from calib.transfer.two_exposures.states import Told, pixel_states


def s3nuc(pair: ExposurePair) -> PixelMaps:
    """Return the maps of Eqs. 8-12 with their standard uncertainties; `ratio` is not used."""
    return by_pixel(pair, _estimate)


def _estimate(pair: ExposurePair, gain_dn_per_e: float) -> PixelMaps:
    first, second = sampling_covariances(pair, gain_dn_per_e)
    d, v, t = pair.difference_dn, pair.variance_difference_dn2, pair.first.third_dn3
    gain = v / d
    var_d, var_v = first.mean + second.mean, first.variance + second.variance
    cov = first.mean_variance + second.mean_variance
    relative = var_v / v**2 + var_d / d**2 - 2.0 * cov / (d * v)
    # −cov(ln T, ln G): T meets V by −σ₁² and D by −D̄₁; 6κ₂κ₃ leads, and κ₃ cancels.
    tied = 6.0 * pair.first.variance_dn2 / (pair.first.n_free * v)
    reason = pixel_states(pair, np.sqrt(var_d), np.sqrt(var_v))
    told = Told(reason)

    def third_over(power: int) -> Pixels:
        bias = 1.0 + 0.5 * power * (power + 1) * relative + power * np.maximum(tied, 0.0)
        return np.asarray(t / gain**power / bias)

    def std(form: _Form) -> Pixels:
        return np.asarray(np.sqrt(form.covariance(form, first, second)))

    of_gain, of_bias = _Form.of_gain(pair), _Form.less_third(pair, 2, mean=1.0)

    step = d**2 / v
    bias_dn = pair.first.mean_dn - third_over(2)
    read = pair.first.variance_dn2 - third_over(1) - ROUNDING_DN2
    step_relative = relative + 3.0 * var_d / d**2 - 2.0 * cov / (d * v)
    return PixelMaps(
        system_gain_dn_per_e=told.with_gain(gain),
        system_gain_dn_per_e_std=told.with_gain(std(of_gain)),
        bias_dn=told.with_shot_noise(bias_dn),
        bias_dn_std=told.with_shot_noise(std(of_bias)),
        photoelectrons=told.with_shot_noise(third_over(3)),
        photoelectrons_std=told.with_shot_noise(std(_Form.less_third(pair, 3))),
        photoelectrons_step=told.with_shot_noise(step / (1.0 + relative)),
        photoelectrons_step_std=told.with_shot_noise(step * np.sqrt(step_relative)),
        read_noise_variance_dn2=told.with_shot_noise(read),
        read_noise_variance_dn2_std=told.with_shot_noise(
            std(_Form.less_third(pair, 1, variance=1.0))
        ),
        gain_bias_covariance=told.with_shot_noise(of_gain.covariance(of_bias, first, second)),
        signal_dn=told.always(d / (pair.ratio - 1.0)),
        reason=reason,
    )


@dataclass(frozen=True)
class _Form:
    """Derivatives by the five moments that S3NUC is made of."""

    m1: Pixels
    v1: Pixels
    t1: Pixels
    m2: Pixels
    v2: Pixels

    @classmethod
    def of_gain(cls, pair: ExposurePair) -> "_Form":
        """Return those of G = V/D."""
        by_v, by_d = _by_v_and_d(pair)
        return cls(-by_d, -by_v, np.zeros_like(by_v), by_d, by_v)

    @classmethod
    def less_third(
        cls, pair: ExposurePair, power: int, mean: float = 0.0, variance: float = 0.0
    ) -> "_Form":
        """Return those of mean·D̄₁ + variance·σ₁² − T/G^power."""
        gain = pair.variance_difference_dn2 / pair.difference_dn
        by_gain = power * pair.first.third_dn3 / gain ** (power + 1)
        by_v, by_d = (by_gain * each for each in _by_v_and_d(pair))
        return cls(mean - by_d, variance - by_v, -(1.0 / gain**power), by_d, by_v)

    def covariance(
        self, other: "_Form", first: SamplingCovariance, second: SamplingCovariance
    ) -> Pixels:
        """Return that of two such quantities."""
        a, b = self, other
        return np.asarray(
            a.m1 * b.m1 * first.mean
            + a.v1 * b.v1 * first.variance
            + a.t1 * b.t1 * first.third
            + (a.m1 * b.v1 + a.v1 * b.m1) * first.mean_variance
            + (a.m1 * b.t1 + a.t1 * b.m1) * first.mean_third
            + (a.v1 * b.t1 + a.t1 * b.v1) * first.variance_third
            + a.m2 * b.m2 * second.mean
            + a.v2 * b.v2 * second.variance
            + (a.m2 * b.v2 + a.v2 * b.m2) * second.mean_variance
        )


def _by_v_and_d(pair: ExposurePair) -> tuple[Pixels, Pixels]:
    """Return the derivatives of G = V/D."""
    d, v = pair.difference_dn, pair.variance_difference_dn2
    return 1.0 / d, -v / d**2
