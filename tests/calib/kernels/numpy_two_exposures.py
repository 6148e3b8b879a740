"""The equations of SANUC and S3NUC, and the weights of pooled estimates, as NumPy writes them.

Plain twins of `calib.kernels.sanuc_maps`, `s3nuc_maps` and `pixel_weights`.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from calib.kernels.pixel_sums import Pixels
from calib.kernels.pixel_weights import Typical
from calib.transfer.two_exposures.exposure_pair import ExposurePair
from calib.transfer.two_exposures.pixel_maps import ROUNDING_DN2, PixelMaps
from calib.transfer.two_exposures.pixel_state import (
    RESPONSE_SIGMA,
    SHOT_NOISE_SIGMA,
    PixelState,
)
from calib.transfer.two_exposures.sampling import SamplingCovariance, sampling_covariances


def sanuc(pair: ExposurePair) -> PixelMaps:
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        return _sanuc(pair, pair.ratio_of_sums)


def s3nuc(pair: ExposurePair) -> PixelMaps:
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        return _s3nuc(pair, pair.ratio_of_sums)


def _sanuc(pair: ExposurePair, gain_dn_per_e: float) -> PixelMaps:
    first, second = sampling_covariances(pair, gain_dn_per_e)
    d, v, rho = pair.difference_dn, pair.variance_difference_dn2, pair.ratio - 1.0
    own, other = 1.0 + 1.0 / rho, 1.0 / rho  # B and σ² are own·first − other·second
    var_d, var_v = first.mean + second.mean, first.variance + second.variance
    cov = first.mean_variance + second.mean_variance
    gain = v / d
    var_gain = (var_v + gain**2 * var_d - 2.0 * gain * cov) / d**2
    electrons = d**2 / (v * rho)
    relative = 4.0 * var_d / d**2 + var_v / v**2 - 4.0 * cov / (d * v)
    unbiased = electrons / (1.0 + var_gain / gain**2)
    read = own * pair.first.variance_dn2 - other * pair.second.variance_dn2 - ROUNDING_DN2
    var_bias = own**2 * first.mean + other**2 * second.mean + (d * pair.ratio_std / rho**2) ** 2
    var_read = own**2 * first.variance + other**2 * second.variance
    var_read += (v * pair.ratio_std / rho**2) ** 2
    cov_v = -own * first.mean_variance - other * second.mean_variance
    cov_d = -own * first.mean - other * second.mean
    reason = pixel_states(pair, np.sqrt(var_d), np.sqrt(var_v))
    told = _Told(reason)
    return PixelMaps(
        system_gain_dn_per_e=told.with_gain(gain),
        system_gain_dn_per_e_std=told.with_gain(np.sqrt(var_gain)),
        bias_dn=told.always(pair.first.mean_dn - d / rho),
        bias_dn_std=told.always(np.sqrt(var_bias)),
        photoelectrons=told.with_shot_noise(unbiased),
        photoelectrons_std=told.with_shot_noise(
            electrons * np.sqrt(relative + (pair.ratio_std / rho) ** 2)
        ),
        photoelectrons_step=told.with_shot_noise(rho * unbiased),
        photoelectrons_step_std=told.with_shot_noise(rho * electrons * np.sqrt(relative)),
        read_noise_variance_dn2=told.always(read),
        read_noise_variance_dn2_std=told.always(np.sqrt(var_read)),
        gain_bias_covariance=told.with_gain((cov_v - gain * cov_d) / d),
        signal_dn=told.always(d / rho),
        reason=reason,
    )


def _s3nuc(pair: ExposurePair, gain_dn_per_e: float) -> PixelMaps:
    first, second = sampling_covariances(pair, gain_dn_per_e)
    d, v, t = pair.difference_dn, pair.variance_difference_dn2, pair.first.third_dn3
    gain = v / d
    var_d, var_v = first.mean + second.mean, first.variance + second.variance
    cov = first.mean_variance + second.mean_variance
    relative = var_v / v**2 + var_d / d**2 - 2.0 * cov / (d * v)
    # −cov(ln T, ln G): T meets V by −σ₁² and D by −D̄₁; 6κ₂κ₃ leads, and κ₃ cancels.
    tied = 6.0 * pair.first.variance_dn2 / (pair.first.n_free * v)
    reason = pixel_states(pair, np.sqrt(var_d), np.sqrt(var_v))
    told = _Told(reason)

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


def pixel_states(
    pair: ExposurePair, difference_std: Pixels, variance_difference_std: Pixels
) -> NDArray[np.uint8]:
    """Return each pixel's `PixelState`, the gravest that holds, (n_pixels,)."""
    first, second = pair.first, pair.second
    v1, v2 = first.variance_dn2, second.variance_dn2
    shot_noise = pair.variance_difference_dn2 > SHOT_NOISE_SIGMA * variance_difference_std
    response = pair.difference_dn > RESPONSE_SIGMA * difference_std
    return np.select(
        [
            first.at_full_scale + second.at_full_scale > 0,
            first.at_zero + second.at_zero > 0,
            (v1 == 0) & (v2 == 0),
            ~response,
            ~shot_noise,
        ],
        [
            np.uint8(PixelState.CLIPPED_AT_FULL_SCALE),
            np.uint8(PixelState.CLIPPED_AT_ZERO),
            np.uint8(PixelState.DEAD),
            np.uint8(PixelState.NO_RESPONSE),
            np.uint8(PixelState.NO_SHOT_NOISE),
        ],
        np.uint8(PixelState.VALID),
    )


class _Told:
    def __init__(self, reason: NDArray[np.uint8]) -> None:
        self._nothing = (reason >= PixelState.CLIPPED_AT_ZERO) & (reason <= PixelState.DEAD)
        self._no_gain = self._nothing | (reason == PixelState.NO_RESPONSE)
        self._not_valid = reason != PixelState.VALID

    def always(self, values: Pixels) -> Pixels:
        return np.where(self._nothing, np.nan, values)

    def with_gain(self, values: Pixels) -> Pixels:
        return np.where(self._no_gain, np.nan, values)

    def with_shot_noise(self, values: Pixels) -> Pixels:
        return np.where(self._not_valid, np.nan, values)


def pixel_weights(
    pair: ExposurePair, smooth_dn: Pixels, where: NDArray[np.bool_], typical: Typical
) -> tuple[Pixels, Pixels, Pixels]:
    """The gain's a, the read noise's beta and the pixel's own signal."""
    rho, first, second = pair.ratio - 1.0, pair.first, pair.second
    shot = typical.gain_dn_per_e * np.maximum(smooth_dn, 0.0)
    v1, v2 = shot + typical.read_dn2, pair.ratio * shot + typical.read_dn2
    of_v1, of_v2 = 2.0 * v1**2 / first.n_free, 2.0 * v2**2 / second.n_free
    one, two = first.n_frames / v1, second.n_frames / v2
    mean = (one * first.mean_dn + two * second.mean_dn) / (one + two)
    signal = (mean - typical.bias_dn) * (one + two) / (one + pair.ratio * two)
    lit = np.where(where, np.maximum(smooth_dn, 0.0), 0.0)
    best, near = lit**2 / (of_v1 + of_v2), np.clip(signal, lit / 4.0, lit * 4.0)
    gain = np.divide(best, near, where=lit > 0, out=np.zeros_like(best))
    read = where / ((1.0 + 1.0 / rho) ** 2 * of_v1 + of_v2 / rho**2)
    return gain, read, signal
