import numpy as np
import pytest
from numpy.random import default_rng

from calib.kernels.level_sums import level_sums


def numpy_twin(mean, weights, exposures, offset, slope):
    expected = exposures[:, None] * np.nan_to_num(slope)
    signal = np.where(weights > 0, mean - np.nan_to_num(offset), 0.0)
    above = np.einsum("bi,bi,bi->b", weights, expected, signal)
    return above, np.einsum("bi,bi,bi->b", weights, expected, expected)


def drawn(n_blocks: int, n_columns: int):
    rng = default_rng([n_blocks, n_columns])
    mean, weights = rng.uniform(10, 4000, (2, n_blocks, n_columns))
    return mean, weights, rng.uniform(10, 500, n_blocks), rng.normal(30, 2, n_columns), mean[0] / 99


@pytest.mark.parametrize("shape", [(1, 1), (3, 7), (5, 1003), (25, 6144)])
def test_sums_agree_with_einsum(shape: tuple[int, int]) -> None:
    given = drawn(*shape)
    for ours, twin in zip(level_sums(*given), numpy_twin(*given), strict=True):
        np.testing.assert_allclose(ours, twin, rtol=1e-12)


def test_what_has_no_weight_and_what_has_no_line_is_left_out() -> None:
    mean, weights, exposures, offset, slope = drawn(4, 60)
    weights[1, 5:20] = 0.0
    mean[1, 5:20] = np.nan
    offset[40:], slope[40:] = np.nan, np.nan
    got = level_sums(mean, weights, exposures, offset, slope)
    twin = numpy_twin(
        np.nan_to_num(mean[:, :40]), weights[:, :40], exposures, offset[:40], slope[:40]
    )
    np.testing.assert_allclose(got, twin, rtol=1e-12)


def test_the_ratio_is_the_level_that_the_means_were_made_with() -> None:
    mean, weights, exposures, offset, slope = drawn(3, 50)
    levels = np.array([1.0, 2.5, 0.3])
    mean = offset + levels[:, None] * exposures[:, None] * slope
    above, below = level_sums(mean, weights, exposures, offset, slope)
    np.testing.assert_allclose(above / below, levels, rtol=1e-12)
