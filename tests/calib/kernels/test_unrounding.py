import numpy as np
import pytest
from numpy.typing import NDArray

from calib.kernels.unrounding import restored
from tests.calib.kernels.test_rounding import SIZES, SPANS, drawn, harmonics, numpy_moments

Cells = NDArray[np.float64]


def numpy_inverse(code: Cells, sigma: Cells) -> Cells:
    """By bisection: the expected value rises with µ, and is never half a code from it."""
    low, high = code - 0.5, code + 0.5
    for _ in range(60):
        middle = 0.5 * (low + high)
        below = middle + harmonics(middle, sigma)[0] < code
        low, high = np.where(below, middle, low), np.where(below, high, middle)
    return np.where(sigma >= 0.25, 0.5 * (low + high), code)


def numpy_twin(code: Cells, sigma: Cells) -> tuple[Cells, Cells, Cells]:
    """Mean, its variance from one sample, and the mean square of the bias that is left."""
    mean = numpy_inverse(code, sigma)
    _, variance, gain = numpy_moments(mean, sigma)
    k = np.arange(1, 9)[:, None]
    bias2 = (np.exp(-4 * np.pi**2 * k**2 * sigma**2) / (2 * np.pi**2 * k**2)).sum(axis=0)
    known = sigma >= 0.25
    of_one = np.where(known, variance / gain**2, sigma**2 + 1 / 12 - bias2)
    return mean, of_one, np.where(known, 0.0, bias2)


@pytest.mark.parametrize("span", [*SPANS, (1.2, 3.0)])
@pytest.mark.parametrize("n", SIZES)
def test_what_is_restored_agrees_with_bisection_and_series(
    n: int, span: tuple[float, float]
) -> None:
    code, sigma = drawn(n, span)
    got = restored(code, sigma, smallest_dn=0.25, negligible_dn=1.2)
    for ours, twin in zip(got, numpy_twin(code, sigma), strict=True):
        # At σ = 0.25 the variance amplifies the mean's 1e-11 by 2π/0.42³ at most.
        np.testing.assert_allclose(ours, twin, rtol=0, atol=1e-9)


def test_stretches_of_little_and_of_much_noise_do_not_disturb_each_other() -> None:
    code, _ = drawn(5000, SPANS[0])
    sigma = np.repeat([0.15, 0.3, 0.7, 2.0, 0.15], 1000)
    got = restored(code, sigma, smallest_dn=0.25, negligible_dn=1.2)
    for ours, twin in zip(got, numpy_twin(code, sigma), strict=True):
        np.testing.assert_allclose(ours, twin, rtol=0, atol=1e-9)


def test_an_unknown_mean_stays_unknown_and_leaves_its_neighbours_alone() -> None:
    code, sigma = np.array([20.3, np.nan, 20.3]), np.full(3, 0.3)
    got, _, _ = restored(code, sigma, smallest_dn=0.25, negligible_dn=1.2)
    assert np.isnan(got[1])
    np.testing.assert_allclose(got[[0, 2]], numpy_inverse(code[[0, 2]], sigma[:2]), atol=1e-10)


def test_what_is_given_is_left_alone() -> None:
    code, sigma = drawn(30, SPANS[0])
    code.flags.writeable = sigma.flags.writeable = False
    restored(code, sigma, smallest_dn=0.25, negligible_dn=1.2)
