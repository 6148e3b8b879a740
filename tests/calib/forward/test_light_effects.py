"""Lamps and stray light obey formulas that are derived here anew."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from calib.forward.chain import expected_electrons
from calib.forward.effect import Effect
from calib.forward.effects.exposure_jitter import ExposureJitter
from calib.forward.effects.exposure_offset import ExposureOffset
from calib.forward.effects.lamp_drift import LampDrift
from calib.forward.effects.lamp_flicker import LampFlicker
from calib.forward.effects.level_nonadditivity import LevelNonadditivity
from calib.forward.effects.stray_light import StrayLight
from calib.forward.model import Model
from tests.calib.forward.small_sensors import (
    LAMPS,
    SENSORS,
    at,
    light_dn,
    per_radiance_us,
    sensors,
)

RNG = np.random.default_rng(0)


@pytest.mark.parametrize("exposure_us", [50.0, 1400.0, 7000.0])
@pytest.mark.parametrize("mains_hz", [50.0, 60.0])
def test_a_line_sees_the_flickers_mean_over_its_exposure(
    exposure_us: float, mains_hz: float
) -> None:
    flicker = LampFlicker(amplitude=0.1, mains_hz=mains_hz, phase_rad=0.4)
    lines = at(7, exposure_us=exposure_us, line_period_us=8000.0, started_s=3.21)
    within_s = (np.arange(20_000) + 0.5) / 20_000 * exposure_us * 1e-6
    wave = np.sin(4 * np.pi * mains_hz * (lines.line_times_s[:, np.newaxis] + within_s) + 0.4)
    assert np.allclose(flicker.line_factor(lines, RNG), 1 + 0.1 * wave.mean(axis=1), atol=1e-9)


def test_an_exposure_of_whole_periods_of_the_flicker_sees_none() -> None:
    still = at(50, exposure_us=10_000.0, line_period_us=11_234.0)
    seen = LampFlicker(amplitude=0.3).line_factor(still, RNG)
    assert np.allclose(seen, 1.0, rtol=0, atol=1e-12)


def test_flicker_above_half_the_line_rate_appears_as_its_alias() -> None:
    # 1 / 28 ms samples 100 Hz 2.8 periods apart, which looks like 0.2 periods a frame.
    n = 100
    seen = LampFlicker(amplitude=0.1).line_factor(
        at(n, exposure_us=100.0, line_period_us=28e3), RNG
    )
    spectrum = np.abs(np.fft.rfft(seen - seen.mean()))
    assert np.argmax(spectrum) == 0.2 * n
    assert np.delete(spectrum, 20).max() < 1e-6 * spectrum[20]


@sensors
@pytest.mark.parametrize("seed", [1, 2, 3])
def test_flicker_scales_the_light_of_drawn_lines_and_leaves_a_dark_alone(
    model: Model, seed: int
) -> None:
    amplitude, n = 0.02, 600
    drawn = model.with_effect(LampFlicker(amplitude=amplitude))
    lines = at(n, line_period_us=1400.0, exposure_us=50.0)
    wave = np.sin(200 * np.pi * (lines.line_times_s + 25e-6))
    for capped in (False, True):
        seen = replace(lines, capped=capped)
        dn = drawn.draw(seen, np.random.default_rng(seed)).dn.reshape(n, -1)
        plain = light_dn(model, seen)[0].ravel()
        means = dn.mean(axis=1) - dn.mean()
        height = 2 * np.mean(means * wave)
        k = model.truth().system_gain_dn_per_e
        variance = (np.mean(k * plain + (k * 12.0) ** 2) + 1 / 12) / dn.shape[1]
        wanted = amplitude * plain.mean() * np.sinc(100 * 50e-6)
        assert abs(height - wanted) < 5 * np.sqrt(2 * variance / n)


@sensors
def test_n_lamps_give_less_than_n_times_one_in_proportion_to_n_less_one(model: Model) -> None:
    lossy = model.with_effect(LevelNonadditivity(loss_per_lamp=0.02))
    for n in range(1, 6):
        wanted = sum(LAMPS[:n]) * (1 - 0.02 * (n - 1)) * 50.0
        got = light_dn(lossy, at(2, lamps=(1.0,) * n))
        assert np.allclose(got, wanted * per_radiance_us(model), rtol=1e-12)


def test_a_lamp_that_warms_up_counts_as_far_as_it_burns_and_a_scene_alone_counts_none() -> None:
    lossy = LevelNonadditivity(loss_per_lamp=0.1)
    light = np.full((1, 3), 7.0)
    assert np.allclose(lossy.apply(light, at(1, lamps=(1.0, 0.5)), RNG), 7.0 * (1 - 0.05))
    assert np.allclose(lossy.apply(light, at(1, lamps=(0.3,)), RNG), 7.0 * (1 + 0.07))
    assert np.array_equal(lossy.apply(light, at(1, lamps=()), RNG), light)


@sensors
def test_stray_light_adds_alike_at_every_level_and_never_under_a_cap(model: Model) -> None:
    stray = model.with_effect(StrayLight(radiance=0.7))
    for n in (0, 1, 4):
        for exposure_us in (20.0, 60.0):
            lit = at(2, lamps=(1.0,) * n, exposure_us=exposure_us)
            wanted = (sum(LAMPS[:n]) + 0.7) * exposure_us
            assert np.allclose(light_dn(stray, lit), wanted * per_radiance_us(model), rtol=1e-12)
    capped = at(2, capped=True)
    assert np.array_equal(light_dn(stray, capped), light_dn(model, capped))


@sensors
def test_stray_light_neither_drifts_nor_flickers_with_the_lamps_but_jitters_with_the_exposure(
    model: Model,
) -> None:
    drift, flicker = LampDrift(amplitude=0.5, time_constant_s=1e-3), LampFlicker(amplitude=0.3)
    links: tuple[Effect, ...] = (drift, flicker, StrayLight(radiance=5.0), ExposureJitter())
    full = model
    for link in links:
        full = full.with_effect(link)
    before = full.effects[: [e.name for e in full.effects].index("shot_noise")]
    lines = at(40, lamps=(1.0,))
    scene = np.zeros((1, *model.truth().vignette.shape))
    got = expected_electrons(before, scene, lines, np.random.default_rng(5)).by_line()
    since_s = np.arange(40) * 1e-4
    lamp = LAMPS[0] * (1 + 0.5 * (1 - np.exp(-since_s / 1e-3)))
    lamp *= 1 + 0.3 * np.sinc(100 * 50e-6) * np.sin(200 * np.pi * (since_s + 25e-6))
    jitter = 1 + 0.002 * np.random.default_rng(5).standard_normal(40)
    per_e = per_radiance_us(model) / full.truth().system_gain_dn_per_e
    wanted = np.multiply.outer((lamp + 5.0) * jitter * 50.0, per_e)
    assert np.allclose(got, wanted, rtol=1e-12)


STILL_FAST: dict[str, Any] = {
    "flicker": LampFlicker(),
    "jitter": ExposureJitter(),
    "stray light": StrayLight(),
    "nonadditivity": LevelNonadditivity(),
    "exposure offset": ExposureOffset(),
}


@pytest.mark.parametrize("effect", STILL_FAST.values(), ids=STILL_FAST)
def test_uniform_light_needs_no_image_of_means(effect: Effect) -> None:
    for model in SENSORS.values():
        drawn = model.with_effect(effect)
        before = drawn.effects[: [e.name for e in drawn.effects].index("shot_noise")]
        scene = np.zeros((1, *model.truth().vignette.shape))
        assert len(expected_electrons(before, scene, at(9), RNG).light) == 1
