import numpy as np
import pytest
from scipy.stats import norm

from calib.rounding import (
    INVERTIBLE_SIGMA_DN,
    mean_square_bias,
    rounded_moments,
    typical_variance,
    unrounded_mean,
)

PHASES = np.linspace(20.0, 21.0, 41)


def by_summing_over_codes(mean: float, sigma: float) -> tuple[float, float]:
    """Mean and variance of the nearest code, from the normal distribution itself."""
    codes = np.arange(10, 32)
    share = norm.cdf(codes + 0.5, mean, sigma) - norm.cdf(codes - 0.5, mean, sigma)
    expected = float((share * codes).sum())
    return expected, float((share * (codes - expected) ** 2).sum())


@pytest.mark.parametrize("sigma", [0.1, 0.17, 0.25, 0.4, 0.8, 1.3])
def test_moments_are_those_of_the_normal_distribution_cut_into_codes(sigma: float) -> None:
    expected = np.array([by_summing_over_codes(m, sigma) for m in PHASES])
    got = rounded_moments(PHASES, np.full(PHASES.shape, sigma))
    np.testing.assert_allclose(got.mean_dn, expected[:, 0], atol=3e-5)
    np.testing.assert_allclose(got.variance_dn2, expected[:, 1], atol=3e-5)


def test_gain_is_the_derivative_of_the_mean() -> None:
    sigma, step = np.full(PHASES.shape, 0.3), 1e-5
    above = rounded_moments(PHASES + step, sigma).mean_dn
    below = rounded_moments(PHASES - step, sigma).mean_dn
    got = rounded_moments(PHASES, sigma).gain
    np.testing.assert_allclose(got, (above - below) / (2 * step), atol=1e-6)


@pytest.mark.parametrize("sigma", [INVERTIBLE_SIGMA_DN, 0.3, 0.5, 1.0, 2.0])
def test_the_mean_comes_back_from_the_mean_code(sigma: float) -> None:
    codes = rounded_moments(PHASES, np.full(PHASES.shape, sigma)).mean_dn
    got = unrounded_mean(codes, np.full(PHASES.shape, sigma))
    np.testing.assert_allclose(got.mean_dn, PHASES, atol=1e-6)
    assert (got.variance_left_dn2 == 0).all()


@pytest.mark.parametrize("sigma", [0.12, 0.2, 0.3])
def test_the_bias_left_and_the_variance_are_means_over_all_phases(sigma: float) -> None:
    phases = np.linspace(20.0, 21.0, 200, endpoint=False)
    moments = np.array([by_summing_over_codes(m, sigma) for m in phases])
    bias2 = float(((moments[:, 0] - phases) ** 2).mean())
    assert mean_square_bias(np.array([sigma]))[0] == pytest.approx(bias2, rel=1e-3)
    typical = typical_variance(np.array([sigma]))[0]
    assert typical == pytest.approx(float(moments[:, 1].mean()), rel=1e-3)


def test_below_the_invertible_noise_the_mean_is_left_and_the_bias_counted() -> None:
    codes = np.array([20.0, 20.4])
    got = unrounded_mean(codes, np.array([0.15, 0.15]))
    np.testing.assert_array_equal(got.mean_dn, codes)
    np.testing.assert_allclose(got.variance_left_dn2, mean_square_bias(np.array([0.15, 0.15])))


def test_without_noise_the_bias_is_that_of_a_uniform_remainder() -> None:
    assert mean_square_bias(np.array([0.0]))[0] == pytest.approx(1 / 12, rel=0.1)


def test_the_stated_variance_is_that_of_restored_means() -> None:
    rng = np.random.default_rng()
    sigma, n_lines, n = 0.3, 100, 4000
    mean = 20.0 + rng.random(n)
    codes = np.rint(mean + sigma * rng.standard_normal((n_lines, n))).mean(axis=0)
    got = unrounded_mean(codes, np.full(n, sigma))
    z = (got.mean_dn - mean) / np.sqrt(got.variance_of_one_dn2 / n_lines)
    assert abs(z.mean()) < 4 / np.sqrt(n)
    assert abs(z.std() - 1) < 4 / np.sqrt(2 * n) + 0.02
