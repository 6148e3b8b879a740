import numpy as np
import pytest
from numpy.random import default_rng

from calib.kernels.column_fit import fit_lines
from calib.kernels.level_sums import level_equations


def drawn(n_blocks: int, n_groups: int, n_columns: int):
    rng = default_rng([n_blocks, n_columns])
    mean, weights = rng.uniform(10, 4000, (2, n_blocks, n_columns))
    group = np.arange(n_blocks) % n_groups
    return mean, weights, rng.uniform(10, 500, n_blocks), group, rng.uniform(1, 3, n_groups)


def equations(mean, weights, exposure, group, level):
    lines = fit_lines(mean, weights, level[group] * exposure)
    return level_equations(
        mean, weights, exposure_us=exposure, group=group, relative_level=level, lines=lines
    )


def numpy_twin(mean, weights, exposure, group, level):
    """Gauss-Newton's normal equations of each column, its line eliminated by projection."""
    n_groups = len(level)
    curvature, gradient, told = np.zeros((n_groups, n_groups)), np.zeros(n_groups), 0.0
    x = level[group] * exposure
    for i in range(mean.shape[1]):
        used = weights[:, i] > 0
        if len(np.unique(x[used])) < 2:
            continue
        root = np.sqrt(weights[used, i])[:, None]
        line = np.stack([np.ones(used.sum()), x[used]], axis=1)
        (offset, slope), *_ = np.linalg.lstsq(root * line, root[:, 0] * mean[used, i], rcond=None)
        own = root * slope * exposure[used, None] * (group[used, None] == np.arange(n_groups))
        away = np.eye(len(own)) - (root * line) @ np.linalg.pinv(root * line)
        curvature += own.T @ away @ own
        gradient += own.T @ (root[:, 0] * (mean[used, i] - offset - slope * x[used]))
        told += np.diag(own.T @ own)
    return curvature, gradient, told


@pytest.mark.parametrize("shape", [(4, 2, 7), (5, 2, 1), (6, 3, 513), (25, 5, 1003)])
def test_equations_are_those_of_projection(shape: tuple[int, int, int]) -> None:
    given = drawn(*shape)
    for ours, twin in zip(equations(*given), numpy_twin(*given), strict=True):
        np.testing.assert_allclose(ours, twin, rtol=1e-9, atol=1e-9 * np.abs(twin).max())


def test_what_has_no_weight_and_what_has_no_line_is_left_out() -> None:
    mean, weights, exposure, group, level = drawn(6, 2, 60)
    weights[1, 5:20] = 0.0
    mean[1, 5:20] = np.nan
    weights[1:, 40:] = 0.0
    got = equations(mean, weights, exposure, group, level)
    for ours, twin in zip(got, numpy_twin(mean, weights, exposure, group, level), strict=True):
        np.testing.assert_allclose(ours, twin, rtol=1e-9, atol=1e-9 * np.abs(twin).max())


def test_a_level_that_no_column_tells_has_nothing_in_its_equation() -> None:
    mean, weights, exposure, group, level = drawn(6, 3, 50)
    weights[group == 2] = 0.0
    level[2] = np.nan
    lines = fit_lines(mean, weights, np.nan_to_num(level[group] * exposure))
    curvature, gradient, told = level_equations(
        mean, weights, exposure_us=exposure, group=group, relative_level=level, lines=lines
    )
    assert (told[2], gradient[2]) == (0.0, 0.0)
    assert (curvature[2] == 0).all()
    assert (told[:2] > 0).all()
