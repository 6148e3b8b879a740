"""SANUC of every pixel in one loop; `two_exposures.sanuc` has the equations and their source."""

from math import sqrt

from numba import njit

from calib.kernels.moment_sampling import factors, two_moments
from calib.kernels.pixel_states import masks_of, state_of


@njit(cache=True, nogil=True, error_model="numpy")
def sanuc_maps(pair, rounding_dn2, codes, maps, reason):  # type: ignore[no-untyped-def]
    """Fill `maps`, in the order of the fields of `PixelMaps`, and `reason`."""
    first, second, ratio, ratio_std, typical = pair
    (
        system_gain, system_gain_std, bias, bias_std, photoelectrons, photoelectrons_std,
        step, step_std, read, read_std, gain_bias, signal,
    ) = maps  # fmt: skip
    rho = ratio - 1.0
    own, other = 1.0 + 1.0 / rho, 1.0 / rho  # B and σ² are own·first − other·second
    relative_of_ratio, of_ratio = (ratio_std / rho) ** 2, ratio_std / rho**2
    of_first, of_second = factors(first), factors(second)
    # Arrays by themselves: taken from a tuple pixel by pixel they would be counted each time.
    mean1, variance1, zero1, full1 = first.mean, first.variance, first.at_zero, first.at_full_scale
    mean2, variance2, zero2, full2 = (
        second.mean,
        second.variance,
        second.at_zero,
        second.at_full_scale,
    )
    for i in range(len(reason)):
        m1, m2, v1, v2 = mean1[i], mean2[i], variance1[i], variance2[i]
        d, v = m2 - m1, v2 - v1
        q = max(d, 0.0) * other
        var_m1, cov1, var_v1 = two_moments(of_first, v1, q, typical)
        var_m2, cov2, var_v2 = two_moments(of_second, v2, ratio * q, typical)
        var_d, var_v, cov = var_m1 + var_m2, var_v1 + var_v2, cov1 + cov2
        extremes = v1 + v2, zero1[i] + zero2[i], full1[i] + full2[i]
        state = state_of(d, v, (var_d, var_v), extremes, codes)
        reason[i] = state
        always, with_gain, with_shot_noise = masks_of(state, codes)
        per_d, per_v = 1.0 / d, 1.0 / v
        g = v * per_d
        var_g = (var_v + g * g * var_d - 2.0 * g * cov) * per_d * per_d
        electrons = d * d * per_v * other
        relative = var_v * per_v * per_v + 4.0 * per_d * (var_d * per_d - cov * per_v)
        unbiased = electrons * (g * g / (g * g + var_g))
        var_bias = own * own * var_m1 + other * other * var_m2 + (d * of_ratio) ** 2
        var_read = own * own * var_v1 + other * other * var_v2 + (v * of_ratio) ** 2
        cov_v, cov_d = -own * cov1 - other * cov2, -own * var_m1 - other * var_m2
        system_gain[i] = g + with_gain
        system_gain_std[i] = sqrt(var_g) + with_gain
        bias[i] = m1 - d * other + always
        bias_std[i] = sqrt(var_bias) + always
        photoelectrons[i] = unbiased + with_shot_noise
        photoelectrons_std[i] = electrons * sqrt(relative + relative_of_ratio) + with_shot_noise
        step[i] = rho * unbiased + with_shot_noise
        step_std[i] = rho * electrons * sqrt(relative) + with_shot_noise
        read[i] = own * v1 - other * v2 - rounding_dn2 + always
        read_std[i] = sqrt(var_read) + always
        gain_bias[i] = (cov_v - g * cov_d) * per_d + with_gain
        signal[i] = d * other + always
