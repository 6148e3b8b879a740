import numpy as np
import pytest
from numpy.random import default_rng
from numpy.typing import NDArray

from calib.kernels.noise_sums import noise_sums
from tests.calib.kernels.test_rounding import numpy_moments
from tests.calib.kernels.test_unrounding import numpy_inverse

Cells = NDArray[np.float64]

LINES = [(0.0035, 0.03), (0.009, 0.2), (0.15, 2.3), (0.0, 0.2), (0.01, 0.0)]
SIZES = [1, 1023, 1025, 3000]


def drawn(n: int, line: tuple[float, float]) -> tuple[Cells, Cells, Cells, Cells]:
    rng = default_rng([n, round(1e4 * line[0])])
    signal, freedom = rng.uniform(0.0, 250.0, n), rng.integers(20, 800, n).astype(np.float64)
    observed = line[0] * signal + line[1] + rng.uniform(0.0, 0.2, n)
    return np.sort(signal), rng.uniform(0.0, 255.0, n), observed, freedom


def numpy_twin(cells: tuple[Cells, Cells, Cells, Cells], line: tuple[float, float]) -> list[float]:
    signal, code, observed, freedom = cells
    sigma2 = line[0] * signal + line[1]
    k = np.arange(1, 9)[:, None]
    q2 = np.exp(-4 * np.pi**2 * k**2 * sigma2)
    typical = sigma2 + 1 / 12 - (q2 / (2 * np.pi**2 * k**2)).sum(axis=0)
    rise = 1 + 2 * q2.sum(axis=0)
    sigma = np.sqrt(sigma2)
    at_mean = numpy_moments(numpy_inverse(code, sigma), sigma)[1]
    variance = np.where(sigma < 0.25, typical, at_mean)
    w = freedom / (2 * typical**2)
    h, y = w * rise, sigma2 + (observed - variance) / rise
    sums = (w, w * signal, w * signal**2, h, h * signal, h * signal**2)
    return [float(v.sum()) for v in (*sums, h * y, h * signal * y, w * (observed - variance) ** 2)]


@pytest.mark.parametrize("line", LINES)
@pytest.mark.parametrize("n", SIZES)
def test_sums_agree_with_numpy(n: int, line: tuple[float, float]) -> None:
    cells = drawn(n, line)
    got = noise_sums(cells, cells[1].copy(), line, smallest_dn=0.25, negligible_dn=1.2)
    np.testing.assert_allclose(got, numpy_twin(cells, line), rtol=1e-9)


def test_a_search_that_starts_near_ends_at_the_same_sums() -> None:
    cells, near = drawn(3000, LINES[1]), drawn(3000, LINES[1])[1].copy()
    noise_sums(cells, near, (0.0085, 0.21), smallest_dn=0.25, negligible_dn=1.2)
    assert np.abs(near - cells[1]).max() > 1e-3  # it has moved, and is not yet there
    got = noise_sums(cells, near, LINES[1], smallest_dn=0.25, negligible_dn=1.2)
    np.testing.assert_allclose(got, numpy_twin(cells, LINES[1]), rtol=1e-9)


def test_the_rise_is_the_derivative_of_the_typical_variance() -> None:
    """From two lines near each other: y of the one fits the other's variance."""
    cells, step = drawn(2000, LINES[0]), 1e-7
    code = cells[1]
    low = (np.zeros(2000), code, np.full(2000, 0.1), np.ones(2000))
    here, there = (
        noise_sums(low, code.copy(), (0.0, v), smallest_dn=0.25, negligible_dn=1.2)
        for v in (0.03, 0.03 + step)
    )
    typical = [np.sqrt(1000.0 / each.w) for each in (here, there)]
    assert (typical[1] - typical[0]) / step == pytest.approx(here.h / here.w, rel=1e-5)
