"""What scatters beyond a known covariance is found, however unequal and correlated that is."""

import numpy as np
import pytest
from scipy.stats import t as student

from calib.radiometric.estimation.excess import excess, free_of, variance_factor


def test_without_known_scatter_it_is_the_variance() -> None:
    values = np.array([1.0, 3.0, 4.0, 9.0])
    contrasts = free_of(np.ones((4, 1)))
    found = excess(contrasts @ values, np.zeros((3, 3)), np.eye(3))
    assert found.variance == pytest.approx(np.var(values, ddof=1), rel=1e-8)
    assert found.freedom == 3


@pytest.mark.parametrize("tau", [0.0, 0.5, 5.0])
def test_it_is_found_under_correlated_errors(tau: float) -> None:
    rng = np.random.default_rng()
    half = rng.standard_normal((12, 12))
    known, design = half @ half.T / 12, np.column_stack([np.ones(12), np.arange(12.0)])
    root, contrasts = np.linalg.cholesky(known), free_of(design)
    still, moved = contrasts @ known @ contrasts.T, np.eye(10)
    found, sigma = [], []
    for _ in range(600):
        values = root @ rng.standard_normal(12) + tau * rng.standard_normal(12)
        result = excess(contrasts @ (values + design @ [3.0, 7.0]), still, moved)
        found.append(result.variance)
        sigma.append(result.sigma)
    if tau == 0.0:
        assert abs(np.mean(sigma)) < 4 / np.sqrt(600)
        assert abs(np.std(sigma) - 1) < 4 / np.sqrt(2 * 600)
    elif tau == 5.0:  # far above what is known, so that it is not cut off at 0
        assert abs(np.mean(found) - tau**2) < 4 * np.std(found) / np.sqrt(600)
        assert np.std(found) < 1.2 * tau**2 * np.sqrt(2 / 10)
    else:
        assert np.mean(sigma) > 8 / np.sqrt(600)


def test_what_is_stated_stays() -> None:
    found = excess(np.array([2.0]), np.eye(1), np.eye(1), stated=3.0)
    assert found.variance == 3.0
    assert found.chi_squared == 1.0


@pytest.mark.parametrize("freedom", [1, 2])
def test_where_t_has_no_variance_two_standard_deviations_cover_95_percent(freedom: int) -> None:
    widened = 2.0 * np.sqrt(variance_factor(freedom))
    assert student.cdf(widened, freedom) - student.cdf(-widened, freedom) == pytest.approx(0.9545)


@pytest.mark.parametrize("freedom", [3, 4, 11])
def test_else_it_is_the_variance_of_t(freedom: int) -> None:
    assert variance_factor(freedom) == pytest.approx(student.var(freedom))
