import numpy as np
import pytest

from calib.radiometric.estimation.dark_current import DarkCurrent
from calib.radiometric.estimation.joint_fit import fit_jointly
from calib.radiometric.estimation.misfit import reduced_chi_squared
from calib.radiometric.estimation.selection import collapsed, within_range

EXPOSURE = np.array([100.0, 200.0, 300.0, 100.0, 100.0])
GROUP = np.array([0, 0, 0, 1, 2])
LEVEL = np.array([1.0, 2.1, 2.9])


def means(rng: np.random.Generator, n: int = 20) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    offset, slope = rng.normal(5.0, 2.0, n), rng.normal(0.3, 0.05, n)
    return offset, slope, offset + np.outer(LEVEL[GROUP] * EXPOSURE, slope)


def test_columns_and_levels_come_back_exactly_from_exact_means() -> None:
    rng = np.random.default_rng()
    offset, slope, mean = means(rng)
    weights = rng.uniform(0.5, 2.0, mean.shape)
    fit = fit_jointly(mean, weights, EXPOSURE, GROUP, np.array([1.0, 1.5, 3.5]))
    np.testing.assert_allclose(fit.relative_level, LEVEL, rtol=1e-7)
    np.testing.assert_allclose(fit.offset, offset, atol=1e-5)
    np.testing.assert_allclose(fit.slope, slope, rtol=1e-7)


def test_noisy_means_are_fitted_to_their_least_squares() -> None:
    rng = np.random.default_rng()
    _, _, mean = means(rng, 200)
    mean = mean + rng.normal(0.0, 0.5, mean.shape)
    weights = rng.uniform(0.5, 2.0, mean.shape)
    fit = fit_jointly(mean, weights, EXPOSURE, GROUP, np.array([1.0, 1.5, 3.5]))
    for group in (1, 2):
        for slightly in (0.999, 1.001):
            x = fit.x_us * np.where(group == GROUP, slightly, 1.0)
            off = mean - fit.offset - np.outer(x, fit.slope)
            assert (weights * off**2).sum() > (weights * fit.residual_dn**2).sum()
        s, e = fit.slope, EXPOSURE[group == GROUP][0]
        w, above = weights[group == GROUP][0], (mean - fit.offset)[group == GROUP][0]
        best = (w * s * e * above).sum() / (w * (s * e) ** 2).sum()
        assert fit.relative_level[group] == pytest.approx(best, rel=1e-9)


def test_a_cell_without_weight_counts_nothing_whatever_it_holds() -> None:
    rng = np.random.default_rng()
    offset, _, mean = means(rng)
    weights = np.ones_like(mean)
    weights[2, 4], mean[2, 4] = 0.0, np.nan
    weights[4], mean[4] = 0.0, 255.0
    fit = fit_jointly(mean, weights, EXPOSURE, GROUP, np.array([1.0, 1.5, 3.5]))
    np.testing.assert_allclose(fit.offset, offset, atol=1e-5)
    assert np.isnan(fit.relative_level[2])
    assert np.isnan(fit.residual_dn[2, 4])


def test_a_column_with_one_exposure_is_not_determined() -> None:
    _, _, mean = means(np.random.default_rng())
    weights = np.ones_like(mean)
    weights[1:, 7] = 0.0
    fit = fit_jointly(mean, weights, EXPOSURE, GROUP, np.array([1.0, 1.5, 3.5]))
    assert np.isnan(fit.slope[7])
    assert np.isfinite(np.delete(fit.slope, 7)).all()


def test_chi_squared_is_one_where_the_weights_are_right() -> None:
    rng = np.random.default_rng()
    _, _, mean = means(rng, 3000)
    sigma = rng.uniform(0.05, 0.2, mean.shape)
    noisy = mean + sigma * rng.standard_normal(mean.shape)
    fit = fit_jointly(noisy, 1 / sigma**2, EXPOSURE, GROUP, np.array([1.0, 1.5, 3.5]))
    assert fit.freedom == 5 * 3000 - 2 * 3000 - 2
    chi2 = reduced_chi_squared(fit, EXPOSURE, DarkCurrent.none(3000))
    assert abs(chi2 - 1) < 5 * np.sqrt(2 / fit.freedom)


@pytest.mark.parametrize(
    ("mean", "sigma", "inside"),
    [
        (100.0, 1.0, True),
        (3.6, 1.0, True),
        (3.4, 1.0, False),
        (-1.0, 0.2, False),
        (251.4, 1.0, True),
        (251.6, 1.0, False),
        (300.0, 1.0, False),
        (np.nan, 1.0, False),
    ],
)
def test_what_would_clip_is_left_out_by_prediction(mean: float, sigma: float, inside: bool) -> None:
    assert within_range(np.array([[mean]]), np.array([[sigma]]), 255)[0, 0] == inside


def test_noise_that_collapsed_gives_a_full_well_away() -> None:
    expected = np.full((2, 3), 10.0)
    variance = np.array([[10.0, 2.0, 7.0], [10.0, 2.0, 7.0]])
    got = collapsed(variance, expected, np.array([300.0, 20.0]))
    np.testing.assert_array_equal(got, [[False, True, False], [False, False, False]])
