import numpy as np
import pytest
from numpy.random import default_rng
from numpy.typing import NDArray

from calib.kernels.rounding import mean_square_bias, moments

Cells = NDArray[np.float64]

SPANS = [(0.1, 0.3), (0.25, 0.6), (0.5, 1.2), (0.1, 5.0)]
SIZES = [1, 7, 1023, 1025, 5000]


def harmonics(mean: Cells, sigma: Cells) -> tuple[Cells, Cells, Cells]:
    """Bias, the variance's cosine terms and the bias' derivative, by NumPy's own functions."""
    k = np.arange(1, 9)[:, None]
    phase, sign = 2 * np.pi * k * (mean - np.rint(mean)), (-1.0) ** k
    q = np.exp(-2 * np.pi**2 * k**2 * sigma**2)
    bias = (sign / (np.pi * k) * q * np.sin(phase)).sum(axis=0)
    extra = (sign * q * np.cos(phase) * (1 / (np.pi * k) ** 2 + 4 * sigma**2)).sum(axis=0)
    return bias, extra, (2 * sign * q * np.cos(phase)).sum(axis=0)


def numpy_moments(mean: Cells, sigma: Cells) -> tuple[Cells, Cells, Cells]:
    bias, extra, slope = harmonics(mean, sigma)
    return mean + bias, sigma**2 + 1 / 12 + extra - bias**2, 1 + slope


def drawn(n: int, span: tuple[float, float]) -> tuple[Cells, Cells]:
    rng = default_rng([n, round(100 * span[1])])
    return rng.uniform(-20.0, 70_000.0, n), rng.uniform(*span, n)


@pytest.mark.parametrize("span", SPANS)
@pytest.mark.parametrize("n", SIZES)
def test_moments_agree_with_their_series(n: int, span: tuple[float, float]) -> None:
    mean, sigma = drawn(n, span)
    got = moments(mean, sigma, smallest_dn=0.1, negligible_dn=1.2)
    for ours, twin in zip(got, numpy_moments(mean, sigma), strict=True):
        np.testing.assert_allclose(ours, twin, rtol=1e-13, atol=1e-10)


@pytest.mark.parametrize("n", SIZES)
def test_the_mean_square_agrees_with_its_series(n: int) -> None:
    sigma = default_rng(n).uniform(0.0, 2.0, n)
    k = np.arange(1, 9)[:, None]
    twin = (np.exp(-4 * np.pi**2 * k**2 * sigma**2) / (2 * np.pi**2 * k**2)).sum(axis=0)
    np.testing.assert_allclose(mean_square_bias(sigma, negligible_dn=1.2), twin, rtol=0, atol=1e-13)


def test_below_the_smallest_noise_the_harmonics_are_those_of_the_smallest() -> None:
    mean = np.linspace(20.0, 21.0, 11)
    small, least = (np.full(11, s) for s in (0.02, 0.1))
    got = moments(mean, small, smallest_dn=0.1, negligible_dn=1.2)
    bias, extra, slope = harmonics(mean, least)
    np.testing.assert_allclose(got[0], mean + bias, atol=1e-12)
    np.testing.assert_allclose(
        got[1], np.maximum(0.02**2 + 1 / 12 + extra - bias**2, 0), atol=1e-12
    )
    np.testing.assert_allclose(got[2], 1 + slope, atol=1e-12)


def test_an_unknown_mean_stays_unknown_and_leaves_its_neighbours_alone() -> None:
    mean, sigma = np.array([20.3, np.nan, 20.3]), np.full(3, 0.3)
    got = moments(mean, sigma, smallest_dn=0.1, negligible_dn=1.2)[0]
    assert np.isnan(got[1])
    assert np.isfinite(got[[0, 2]]).all()


def test_what_is_given_is_left_alone() -> None:
    code, sigma = drawn(30, SPANS[0])
    code.flags.writeable = sigma.flags.writeable = False
    moments(code, sigma, smallest_dn=0.1, negligible_dn=1.2)
    mean_square_bias(sigma, negligible_dn=1.2)
