import numpy as np
import pytest

from calib.errors import NotDeterminedError
from calib.forward.taps import tap_of_column
from calib.radiometric.estimation.normalised_profile import normalise
from calib.radiometric.estimation.vignette import fit_profile, tap_contrasts
from tests.calib.radiometric.simulated import smooth_profile

NO_TAPS = np.zeros((512, 0))
QUIET = np.full(512, 1e-12)


def test_a_polynomial_without_scatter_comes_back_exactly() -> None:
    truth = smooth_profile(512)
    fit = fit_profile(0.3 * truth, np.zeros(512), NO_TAPS, order=4)
    vignette = normalise(fit, QUIET, 0.0)
    np.testing.assert_allclose(vignette.values, truth, atol=1e-5)
    assert vignette.axis_column == pytest.approx((0.1 + 1) / 2 * 511, abs=1e-2)


def test_prnu_is_found_and_stays_out_of_the_profile() -> None:
    rng = np.random.default_rng()
    slope = smooth_profile(4096) * (1 + 0.03 * rng.standard_normal(4096))
    fit = fit_profile(slope, np.full(4096, 1e-6), np.zeros((4096, 0)))
    assert fit.scatter == pytest.approx(0.03, rel=5 / np.sqrt(2 * 4096))
    vignette = normalise(fit, np.full(4096, 1e-6), 0.0)
    assert np.abs(vignette.values - smooth_profile(4096)).max() < 6 * vignette.relative_std.max()


def test_the_order_is_at_least_what_the_data_show() -> None:
    rng = np.random.default_rng()
    x = np.linspace(-1, 1, 2048)
    slope = (1 - 0.3 * x**2 - 0.15 * x**7) * (1 + 0.005 * rng.standard_normal(2048))
    choice = fit_profile(slope, np.zeros(2048), np.zeros((2048, 0))).choice
    assert choice.chosen >= 7
    assert choice.orders == tuple(range(2, 13))
    assert sum(choice.weights) == pytest.approx(1)
    assert choice.held_out_rms[choice.orders.index(choice.chosen)] == min(choice.held_out_rms)


@pytest.mark.parametrize("layout", ["odd_even", "halves", "quarters"])
def test_taps_of_different_gain_do_not_bend_the_profile(layout: str) -> None:
    rng = np.random.default_rng()
    tap = tap_of_column(layout, 2048)
    factor = 1 + np.array([0.03, -0.02, 0.01, -0.02])[tap]
    slope = smooth_profile(2048) * factor * (1 + 0.004 * rng.standard_normal(2048))
    vignette = normalise(fit_profile(slope, np.zeros(2048), tap_contrasts(tap)), slope * 0, 0.0)
    away = np.abs(vignette.values / smooth_profile(2048) - 1)
    assert away.max() < 6 * vignette.relative_std.max()
    assert away.max() < 0.01


def test_a_profile_that_only_rises_has_its_axis_at_the_end_and_no_uncertainty_of_it() -> None:
    rng = np.random.default_rng()
    slope = (1 + np.linspace(0, 1, 512)) * (1 + 0.001 * rng.standard_normal(512))
    vignette = normalise(fit_profile(slope, QUIET, NO_TAPS, order=2), QUIET, 0.0)
    assert vignette.axis_column == 511
    assert vignette.axis_column_std is None


def test_an_outlier_does_not_pull_the_profile() -> None:
    rng = np.random.default_rng()
    slope = smooth_profile(512) * (1 + 0.005 * rng.standard_normal(512))
    slope[100:104] *= 0.4
    fit = fit_profile(slope, QUIET, NO_TAPS)
    assert not fit.columns_used[100:104].any()
    assert fit.scatter < 0.007


def test_the_sources_shape_is_uncertain_away_from_the_axis_only() -> None:
    fit = fit_profile(smooth_profile(512), QUIET, NO_TAPS, order=4)
    shape = normalise(fit, QUIET, 0.01).uniformity_relative_std
    assert shape[round((0.1 + 1) / 2 * 511)] < 1e-4
    assert shape.max() == pytest.approx(0.01 / np.sqrt(3))


def test_too_few_columns_are_said() -> None:
    slope = np.full(512, np.nan)
    slope[:10] = 1.0
    with pytest.raises(NotDeterminedError) as refusal:
        fit_profile(slope, QUIET, NO_TAPS)
    assert refusal.value.code == "too-few-columns"


def test_an_order_too_low_by_chance_is_not_taken_for_certain() -> None:
    rng = np.random.default_rng()
    truth = smooth_profile(256)
    z = []
    for _ in range(150):
        slope = truth * (1 + 0.08 * rng.standard_normal(256))
        fit = fit_profile(slope, np.zeros(256), np.zeros((256, 0)))
        vignette = normalise(fit, np.zeros(256), 0.0)
        z.append(((vignette.values - truth) / vignette.std)[np.abs(np.arange(256) - 140) > 40])
    assert np.sqrt(np.mean(np.square(z))) < 1.5


def test_at_the_axis_it_is_uncertain_by_what_the_maximum_of_a_noisy_profile_is_too_high() -> None:
    """VE is 1 at the column found for the axis; the truth is 1 at another, by √3·β less here."""
    rng, n = np.random.default_rng(), 300
    truth, columns, square = smooth_profile(128), np.arange(128.0), []
    for _ in range(n):
        slope = truth * (1 + 0.03 * rng.standard_normal(128))
        fit = fit_profile(slope, np.zeros(128), np.zeros((128, 0)), order=4)
        vignette = normalise(fit, np.zeros(128), 0.0)
        lacking = 1 - np.interp(vignette.axis_column, columns, truth)
        stated = np.interp(vignette.axis_column, columns, vignette.relative_std)
        square.append((lacking / stated) ** 2)
    # 3β² is the mean of a squared chi-squared of one degree of freedom, whose variance is 96/9.
    assert abs(np.mean(square) - 1) < 4 * np.sqrt(96 / 9 / n)
    assert np.mean(square) > 0.3


def test_what_shifts_all_slopes_alike_bends_the_vignette() -> None:
    truth, shift = smooth_profile(512), 1e-4
    plain = normalise(fit_profile(truth, QUIET, NO_TAPS, order=4), QUIET, 0.0, shift)
    shifted = normalise(fit_profile(truth + shift, QUIET, NO_TAPS, order=4), QUIET, 0.0)
    away = np.abs(shifted.values / plain.values - 1.0)
    assert plain.offset_relative_std.max() > 0.5 * shift
    np.testing.assert_allclose(away, plain.offset_relative_std, atol=4 * shift**2)
