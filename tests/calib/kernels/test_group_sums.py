import numpy as np

from calib.kernels.group_sums import group_sums


def test_sums_are_those_of_plain_numpy_and_leave_out_pixels_of_no_group() -> None:
    rng = np.random.default_rng()
    values, group = rng.normal(3.0, 5.0, (7, 60)), rng.integers(0, 5, 60)
    plain = np.stack([values[:, group == g].sum(axis=1) for g in range(4)], axis=1)
    # Up to 60 terms of at most some 25 round off by 1e-16 of their sum each.
    np.testing.assert_allclose(group_sums(values, group, 4), plain, rtol=0, atol=1e-12)


def test_a_group_without_pixels_sums_to_nothing() -> None:
    found = group_sums(np.ones((2, 3)), np.array([0, 2, 2]), 3)
    assert found.tolist() == [[1.0, 0.0, 2.0]] * 2
