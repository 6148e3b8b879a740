"""Each effect obeys its formula."""

import numpy as np
import pytest

from calib.errors import InputError
from calib.forward.conditions import Conditions
from calib.forward.effects.banding import Banding
from calib.forward.effects.dark_current import DarkCurrent
from calib.forward.effects.dark_current_temperature import DarkCurrentTemperature
from calib.forward.effects.illumination import Illumination
from calib.forward.effects.lamp_drift import LampDrift
from calib.forward.effects.line_noise import LineNoise
from calib.forward.effects.nonlinearity import Nonlinearity
from calib.forward.effects.offset import Offset
from calib.forward.effects.responsivity import Responsivity
from calib.forward.effects.system_gain import SystemGain
from calib.forward.effects.vignette import Vignette
from calib.forward.parameter import parameters_of
from calib.recording.header import CameraHeader

RNG = np.random.default_rng(0)


def at(n_lines: int = 4, **changed: float) -> Conditions:
    given: dict[str, float] = {"exposure_us": 30.0, "line_period_us": 100.0} | changed
    return Conditions.steady(n_lines, **given)  # type: ignore[arg-type]


def test_lamps_add_and_a_cap_shuts_out_lamps_and_scene() -> None:
    lamps = Illumination(radiance=(3.0, 5.0, 7.0))
    lit = Conditions.steady(2, exposure_us=1.0, line_period_us=1.0, lamps=(1.0, 0.5))
    capped = Conditions.steady(2, exposure_us=1.0, line_period_us=1.0, lamps=(1.0,), capped=True)
    scene = np.full((2, 3), 10.0)
    assert np.all(lamps.apply(scene, lit, RNG) == 10.0 + 3.0 + 2.5)
    assert not lamps.apply(scene, capped, RNG).any()


def test_a_lamp_warms_exponentially_from_where_it_was() -> None:
    lamp = Illumination(radiance=(1.0,), warm_up_s=(20.0,))
    assert lamp.emission(0, 0.0, 1.0, 20.0) == pytest.approx(1 - np.exp(-1))
    assert lamp.emission(0, 1.0, 0.0, 40.0) == pytest.approx(np.exp(-2))
    assert Illumination(radiance=(1.0,)).emission(0, 0.0, 1.0, 0.0) == 1.0


def test_cos4_falls_by_the_angle_and_is_one_on_the_axis() -> None:
    lens = Vignette(axis_column=100.0, focal_length_columns=400.0)
    profile = lens.profile(401)
    assert profile[100] == 1.0
    for column in (0, 250, 400):
        angle = np.arctan((column - 100) / 400)
        assert profile[column] == pytest.approx(np.cos(angle) ** 4, rel=1e-12)


def test_the_measured_polynomial_counts_x_from_the_axis_to_the_farther_end() -> None:
    profile = Vignette(axis_column=300.0, coefficients=(-0.3, 0.1)).profile(401)
    assert profile[0] == pytest.approx(1 - 0.3 - 0.1)
    assert profile[400] == pytest.approx(1 - 0.3 / 9 + 0.1 / 27)
    assert np.argmax(profile) == 300


def test_prnu_has_its_scatter_and_another_seed_is_another_sensor() -> None:
    n = 20_000
    one, two = (Responsivity(prnu_std=0.03, prnu_seed=seed).relative(n) for seed in (1, 2))
    assert np.std(one) == pytest.approx(0.03, abs=4 * 0.03 / np.sqrt(2 * n))
    assert np.mean(one) == pytest.approx(1.0, abs=4 * 0.03 / np.sqrt(n))
    assert abs(np.corrcoef(one, two)[0, 1]) < 4 / np.sqrt(n)


def test_patterns_of_different_effects_with_one_seed_are_independent() -> None:
    n = 20_000
    prnu = Responsivity(prnu_seed=5).relative(n)
    offset = Offset(pattern_seed=5).pixels(n, 0.0)
    dark = DarkCurrent(dsnu_seed=5).rates(n)
    assert abs(np.corrcoef(prnu, offset)[0, 1]) < 4 / np.sqrt(n)
    assert abs(np.corrcoef(prnu, dark)[0, 1]) < 4 / np.sqrt(n)


def test_dark_current_grows_with_exposure_and_never_falls_below_zero() -> None:
    dark = DarkCurrent(electrons_per_us=0.1, dsnu_std_e_per_us=0.2)
    short, long = (dark.apply(np.zeros((1, 500)), at(exposure_us=t), RNG) for t in (10.0, 30.0))
    assert np.allclose(long, 3 * short)
    assert short.min() == 0.0


def test_dark_current_doubles_with_the_doubling_temperature() -> None:
    dark = DarkCurrentTemperature(reference_c=20.0, doubling_k=7.0)
    cold, warm = dark.rates(64, 20.0), dark.rates(64, 34.0)
    assert np.allclose(warm, 4 * cold)


def test_rates_of_pixels_that_are_told_double_too() -> None:
    dark = DarkCurrentTemperature(reference_c=20.0, doubling_k=5.0, rates_e_per_us=(0.1, 0.0, 0.3))
    assert np.allclose(dark.rates(3, 30.0), [0.4, 0.0, 1.2])
    with pytest.raises(InputError, match="rates_e_per_us has 3 values; give 64") as caught:
        dark.check_camera(CameraHeader(columns=64, bit_depth=12))
    assert caught.value.code == "wrong-length"


def test_dark_current_may_double_as_semiconductors_do_and_no_more_slowly() -> None:
    boltzmann_ev, doubling = 8.617e-5, []
    for energy_ev, power in ((1.12, 3.0), (0.56, 1.5), (0.365, 1.5)):
        for kelvin in (243.0, 323.0):
            thermal_ev = boltzmann_ev * kelvin
            doubling.append(np.log(2.0) * thermal_ev * kelvin / (energy_ev + power * thermal_ev))
    told = parameters_of(DarkCurrentTemperature)["doubling_k"]
    # The bounds are round numbers.
    assert told.low == pytest.approx(min(doubling), abs=0.5)
    assert told.high == pytest.approx(max(doubling), abs=1.0)


def test_camera_gain_is_an_amplitude_ratio_and_taps_have_their_own() -> None:
    gain = SystemGain(dn_per_e=0.5, tap_gain=(1.0, 1.1), tap_layout="odd_even")
    assert np.allclose(gain.pixels(4, 20.0), [5.0, 5.5, 5.0, 5.5])


def test_offset_has_its_mean_taps_and_black_level() -> None:
    offset = Offset(
        mean_dn=40.0,
        pattern_std_dn=2.0,
        low_share=0.1,
        low_depth_dn=5.0,
        tap_offset_dn=(1.0, -3.0),
        tap_layout="halves",
    )
    columns = offset.pixels(1000, 8.0)
    plain = Offset(mean_dn=40.0, pattern_std_dn=2.0, low_share=0.1, low_depth_dn=5.0)
    assert plain.pixels(1000, 0.0).mean() == pytest.approx(40.0)
    assert np.allclose(columns[:500] - plain.pixels(1000, 0.0)[:500], 9.0)
    assert np.allclose(columns[500:] - plain.pixels(1000, 0.0)[500:], 5.0)


def test_nonlinearity_depends_on_the_signal_alone() -> None:
    bent = Nonlinearity(beta_per_dn=1e-4).apply(np.array([[0.0, 1000.0]]), at(1), RNG)
    assert bent.tolist() == [[0.0, 900.0]]


def test_drift_follows_wall_time_not_the_line_number() -> None:
    drift = LampDrift(amplitude=0.2, time_constant_s=10.0)
    early = drift.line_factor(at(2, started_s=0.0), RNG)
    late = drift.line_factor(at(2, started_s=10.0), RNG)
    assert early[0] == 1.0
    assert late[0] == pytest.approx(1 + 0.2 * (1 - np.exp(-1)))


def test_line_noise_moves_all_columns_of_a_line_together() -> None:
    noise = LineNoise(std_dn=2.0).apply(np.zeros((5000, 3)), at(5000), np.random.default_rng(3))
    assert np.all(noise == noise[:, :1])
    assert noise[:, 0].std() == pytest.approx(2.0, abs=4 * 2.0 / np.sqrt(2 * 5000))


@pytest.mark.parametrize("started_s", [0.0, 3.0])
def test_banding_is_one_peak_of_the_plane_of_lines_and_columns(started_s: float) -> None:
    n_lines, n_columns, period_us = 64, 128, 100.0
    cycles_per_line = 5 + 8 / n_lines
    tone = Banding(amplitude_dn=2.0, frequency_hz=cycles_per_line / (period_us * 1e-6))
    plane = tone.apply(np.zeros((n_lines, n_columns)), at(n_lines, started_s=started_s), RNG)
    lines = np.abs(np.fft.fft(plane[:, 0])) / n_lines
    assert np.argmax(lines[1 : n_lines // 2]) + 1 == 8
    assert plane.std() == pytest.approx(2.0 / np.sqrt(2), rel=1e-3)
    # The tone runs on from the last column of a line to the first of the next.
    step_end = np.abs(plane[1:, 0] - plane[:-1, -1]).max()
    step_within = np.abs(np.diff(plane, axis=1)).max()
    assert step_end <= step_within * 1.01
