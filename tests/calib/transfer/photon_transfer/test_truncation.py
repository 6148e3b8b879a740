import numpy as np
import pytest

from calib.transfer.photon_transfer.clipping import limits
from calib.transfer.photon_transfer.truncation import kept_share_of_variance, untruncated_share


@pytest.mark.parametrize("cut", [1.5, 2.0, 3.0, 4.0])
def test_what_a_cut_leaves_of_the_variance_is_what_an_integral_says(cut: float) -> None:
    z = np.linspace(-cut, cut, 200_001)
    density = np.exp(-(z**2) / 2)
    wanted = np.trapezoid(z**2 * density, z) / np.trapezoid(density, z)
    assert abs(float(kept_share_of_variance(np.array(cut))) - wanted) < 1e-9


@pytest.mark.parametrize("sigma", [0.3, 1.0, 40.0])
@pytest.mark.parametrize("cut", [2.0, 3.0, 5.0])
def test_the_share_is_found_back_from_what_is_left(sigma: float, cut: float) -> None:
    share = kept_share_of_variance(np.array(cut))
    found = untruncated_share(np.array(sigma**2 * share), np.array(cut * sigma))
    assert abs(float(found / share) - 1) < 1e-9


@pytest.mark.parametrize("seed", range(4))
def test_limits_follow_the_noise_of_the_signal_and_no_outlier(seed: int) -> None:
    rng = np.random.default_rng(seed)
    mean = rng.permutation(np.linspace(100.0, 3000.0, 800))
    sigma = np.sqrt(2 * (0.25 * mean + 9.0))
    differences = sigma * rng.standard_normal((60, 800))
    differences[rng.random(differences.shape) < 1e-3] += 4000.0
    found = limits(differences, mean, np.zeros(800, np.intp), 5.0) / (5.0 * sigma)
    # 48,000 differences in 11 groups: 1.1 % each; the steps between groups bend by 2 % at most.
    assert np.abs(found - 1).max() < 0.02 + 5 * 0.011


def test_codes_that_do_not_change_have_a_limit_all_the_same() -> None:
    found = limits(np.zeros((5, 10)), np.full(10, 7.0), np.zeros(10, np.intp), 5.0)
    assert (found == 5 * 0.75).all()
