"""S3NUC of every pixel in one loop; `two_exposures.s3nuc` has the equations and their source."""

from math import sqrt

from numba import njit

from calib.kernels.moment_sampling import factors, third_moment, two_moments
from calib.kernels.pixel_states import masks_of, state_of


@njit(cache=True, nogil=True, error_model="numpy")
def s3nuc_maps(pair, rounding_dn2, codes, maps, reason):  # type: ignore[no-untyped-def]
    """Fill `maps`, in the order of the fields of `PixelMaps`, and `reason`."""
    first, second, ratio, _, typical = pair
    (
        system_gain, system_gain_std, bias, bias_std, photoelectrons, photoelectrons_std,
        step, step_std, read, read_std, gain_bias, signal,
    ) = maps  # fmt: skip
    of_first, of_second, other = factors(first), factors(second), 1.0 / (ratio - 1.0)
    # Arrays by themselves: taken from a tuple pixel by pixel they would be counted each time.
    mean1, variance1, zero1, full1 = first.mean, first.variance, first.at_zero, first.at_full_scale
    mean2, variance2, zero2, full2 = (
        second.mean,
        second.variance,
        second.at_zero,
        second.at_full_scale,
    )
    third1 = first.third
    for i in range(len(reason)):
        m1, v1, v2, t = mean1[i], variance1[i], variance2[i], third1[i]
        d, v = mean2[i] - m1, v2 - v1
        q = max(d, 0.0) * other
        one = (*two_moments(of_first, v1, q, typical), *third_moment(of_first, v1, q, typical))
        two = two_moments(of_second, v2, ratio * q, typical)
        var_d, var_v, cov = one[0] + two[0], one[2] + two[2], one[1] + two[1]
        extremes = v1 + v2, zero1[i] + zero2[i], full1[i] + full2[i]
        state = state_of(d, v, (var_d, var_v), extremes, codes)
        reason[i] = state
        always, with_gain, with_shot_noise = masks_of(state, codes)
        per_d, per_v = 1.0 / d, 1.0 / v
        g, per_g = v * per_d, d * per_v
        by_v, by_d = per_d, -g * per_d
        of_d, of_v, together = var_d * per_d * per_d, var_v * per_v * per_v, cov * per_d * per_v
        relative = of_v + of_d - 2.0 * together
        # −cov(ln T, ln G): T meets V by −σ₁² and D by −D̄₁; 6κ₂κ₃ leads, and κ₃ cancels.
        tied = max(6.0 * v1 * of_first[1] * per_v, 0.0)
        per_g2, per_g3 = per_g * per_g, per_g * per_g * per_g
        third = t * per_g, t * per_g2, t * per_g3  # T/G^p
        # Derivatives by (D̄₁, σ₁², T, D̄₂, σ₂²) of G, and of what T/G^p is taken off.
        b1, b2, b3 = third[1], 2.0 * third[2], 3.0 * third[2] * per_g
        of_g = -by_d, -by_v, 0.0, by_d, by_v
        of_read = -b1 * by_d, 1.0 - b1 * by_v, -per_g, b1 * by_d, b1 * by_v
        of_bias = 1.0 - b2 * by_d, -b2 * by_v, -per_g2, b2 * by_d, b2 * by_v
        of_electrons = -b3 * by_d, -b3 * by_v, -per_g3, b3 * by_d, b3 * by_v
        electrons = d * per_g
        system_gain[i] = g + with_gain
        system_gain_std[i] = sqrt(_covariance(of_g, of_g, one, two)) + with_gain
        bias[i] = m1 - third[1] / (1.0 + 3.0 * relative + 2.0 * tied) + with_shot_noise
        bias_std[i] = sqrt(_covariance(of_bias, of_bias, one, two)) + with_shot_noise
        photoelectrons[i] = third[2] / (1.0 + 6.0 * relative + 3.0 * tied) + with_shot_noise
        var_electrons = _covariance(of_electrons, of_electrons, one, two)
        photoelectrons_std[i] = sqrt(var_electrons) + with_shot_noise
        step[i] = electrons / (1.0 + relative) + with_shot_noise
        of_step = relative + 3.0 * of_d - 2.0 * together
        step_std[i] = electrons * sqrt(of_step) + with_shot_noise
        without = third[0] / (1.0 + relative + tied)
        read[i] = v1 - without - rounding_dn2 + with_shot_noise
        read_std[i] = sqrt(_covariance(of_read, of_read, one, two)) + with_shot_noise
        gain_bias[i] = _covariance(of_g, of_bias, one, two) + with_shot_noise
        signal[i] = d * other + always


@njit(cache=True, nogil=True, inline="always")
def _covariance(a, b, first, second):  # type: ignore[no-untyped-def]
    """Return that of two quantities with these derivatives by D̄₁, σ₁², T, D̄₂ and σ₂²."""
    var_m1, cov_mv1, var_v1, cov_mt, cov_vt, var_t = first
    var_m2, cov_mv2, var_v2 = second
    return (
        a[0] * b[0] * var_m1
        + a[1] * b[1] * var_v1
        + a[2] * b[2] * var_t
        + (a[0] * b[1] + a[1] * b[0]) * cov_mv1
        + (a[0] * b[2] + a[2] * b[0]) * cov_mt
        + (a[1] * b[2] + a[2] * b[1]) * cov_vt
        + a[3] * b[3] * var_m2
        + a[4] * b[4] * var_v2
        + (a[3] * b[4] + a[4] * b[3]) * cov_mv2
    )
