"""A generator whose counts are their mean, or their mean and smooth noise."""

import numpy as np
import pytest
from numpy.typing import NDArray

from calib.forward.moments import Moments

N = 200_000


@pytest.mark.parametrize(
    ("draw", "mean", "variance"),
    [
        (lambda rng: rng.poisson(np.full(N, 40.0)), 40.0, 40.0),
        (lambda rng: rng.poisson(7.0, N), 7.0, 7.0),
        (lambda rng: rng.binomial(np.full(N, 300), 0.2), 60.0, 48.0),
        (lambda rng: rng.standard_normal(N), 0.0, 1.0),
    ],
    ids=["poisson", "poisson of a size", "binomial", "normal"],
)
def test_numbers_have_the_mean_and_variance_of_what_they_stand_for(
    draw, mean: float, variance: float
) -> None:
    drawn: NDArray[np.float64] = draw(Moments(np.random.SeedSequence().entropy % 2**32, noise=1.0))
    assert abs(drawn.mean() - mean) < 5 * np.sqrt(variance / N)
    assert abs(drawn.var(ddof=1) / variance - 1) < 5 * np.sqrt(2 / N)
    expected = draw(Moments(0, noise=0.0))
    np.testing.assert_array_equal(expected, np.full(N, mean))


def test_a_small_change_of_the_mean_changes_each_number_a_little() -> None:
    one, other = (Moments(5, noise=1.0).poisson(np.full(1000, m)) for m in (100.0, 101.0))
    # The mean by 1, and sqrt(101) - sqrt(100) = 0.05 of a normal number below 5.
    assert np.abs(other - one - 1.0).max() < 0.25


def test_what_is_not_a_count_is_drawn_as_ever() -> None:
    plain, moments = np.random.default_rng(3), Moments(3, noise=0.0)
    np.testing.assert_array_equal(moments.random(8), plain.random(8))
