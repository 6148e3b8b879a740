"""SANUC: gain, bias, photo-electrons and read noise from means and variances at t and 2t.

Source: Yielding, Cain and Seal (2018), Eqs. 13-20. With D = D̄₂ − D̄₁, V = σ₂² − σ₁² and r the ratio
of the exposures (2 as printed, else as read back), ρ = r − 1:

    G  = V/D                                    (17)
    K̄  = D²/(ρV) / (1 + u²(G)/G²)               (18), with its bias undone
    B  = D̄₁ − G·K̄ = D̄₁ − D/ρ                    (19)
    σ² = σ₁² − G²·K̄ = σ₁² − V/ρ − 1/12          (20), without rounding (Sheppard)

Eq. 18 is a ratio with a noisy denominator: D²/V is too high by V's squared relative uncertainty, on
average, and has no variance at all, since V comes near 0. Divided by 1 + var(ln V − ln D) it is
unbiased to second order and bounded, as V/(V² + u²) is. B and σ² are linear in the moments: neither
gain nor photo-electrons enter, and they are unbiased at any number of frames.
"""

import numpy as np

from calib.transfer.two_exposures.exposure_pair import ExposurePair
from calib.transfer.two_exposures.pixel_maps import PixelMaps, by_pixel
from calib.transfer.two_exposures.sampling import sampling_covariances
from calib.transfer.two_exposures.states import Told, pixel_states

ROUNDING_DN2 = 1.0 / 12.0
"""Sheppard's correction: what rounding to whole codes adds to a variance."""


def sanuc(pair: ExposurePair) -> PixelMaps:
    """Return the maps of Eqs. 17-20 with their standard uncertainties."""
    return by_pixel(pair, _estimate)


def _estimate(pair: ExposurePair, gain_dn_per_e: float) -> PixelMaps:
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
    told = Told(reason)
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
