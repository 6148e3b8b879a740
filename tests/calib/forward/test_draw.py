"""A draw has the right mean, and both ways of drawing have one distribution."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from calib.arrays import RawLines
from calib.errors import InputError
from calib.forward.chain import expected_electrons
from calib.forward.conditions import Conditions
from calib.forward.draw import draw_link_by_link
from calib.forward.effect import Effect
from calib.forward.effects.banding import Banding
from calib.forward.effects.dark_current import DarkCurrent
from calib.forward.effects.full_well import FullWell
from calib.forward.effects.lamp_drift import LampDrift
from calib.forward.effects.line_noise import LineNoise
from calib.forward.effects.nonlinearity import Nonlinearity
from calib.forward.effects.read_noise import ReadNoise
from calib.forward.fused import can_fuse, draw_fused
from calib.forward.model import Model
from tests.calib.kernels.numpy_noise import two_sample_p

DEMO = Model.preset("demo")
N_LINES = 400


def at(lamps: float = 3, n_lines: int = N_LINES, **changed: Any) -> Conditions:
    given = {"exposure_us": 50.0, "line_period_us": 100.0, "lamps": (1.0,) * int(lamps)} | changed
    return Conditions.steady(n_lines, **given)


def after_light(model: Model) -> tuple[Effect, ...]:
    names = [effect.name for effect in model.effects]
    return model.effects[names.index("shot_noise") :]


def both_ways(model: Model, conditions: Conditions) -> tuple[RawLines, RawLines]:
    names = [effect.name for effect in model.effects]
    split = names.index("shot_noise")
    before, after = model.effects[:split], model.effects[split:]
    assert can_fuse(after)
    rng = np.random.default_rng(3)
    dark_scene = np.zeros((1, model.camera.columns))
    expected = expected_electrons(before, dark_scene, conditions, rng)
    fused = draw_fused(after, expected, conditions, rng)
    linked, _ = draw_link_by_link(after, expected, conditions, rng, model.camera.bit_depth)
    return fused, linked


AGREE = {
    "capped": (DEMO, at(capped=True)),
    "half of full scale": (DEMO, at(3)),
    "converter saturates": (DEMO, at(6, exposure_us=90.0)),
    "well saturates": (DEMO.with_effect(FullWell(electrons=9000.0)), at(4)),
    "few electrons": (DEMO.with_effect(ReadNoise(std_e=1.0)), at(1, exposure_us=0.2)),
    "dark current": (DEMO.with_effect(DarkCurrent(electrons_per_us=0.5)), at(2)),
    "lamps drift": (
        DEMO.with_effect(LampDrift(amplitude=0.5, time_constant_s=0.02)),
        at(2),
    ),
    "camera gain and black level": (DEMO, at(2, gain_db=6.0, black_level_dn=40.0)),
    "eight bits": (Model.preset("agcam-nir"), at(1, n_lines=60, exposure_us=200.0)),
}


@pytest.mark.parametrize(("model", "conditions"), AGREE.values(), ids=AGREE)
def test_the_compiled_pass_and_the_links_one_by_one_draw_from_one_distribution(
    model: Model, conditions: Conditions
) -> None:
    fused, linked = both_ways(model, conditions)
    assert fused.dtype == linked.dtype
    assert two_sample_p(fused, linked) > 1e-4
    spread = np.sqrt((fused.var(0) + linked.var(0)) / conditions.n_lines + 1e-9)
    scores = (fused.mean(0) - linked.mean(0)) / spread
    alive = spread > 1e-3
    if alive.any():
        assert abs(scores[alive].mean()) < 4 / np.sqrt(alive.sum())
        assert np.abs(scores[alive]).max() < 6
    within = np.sqrt((fused.var(0).mean() + linked.var(0).mean()) / model.camera.columns + 1e-9)
    assert np.abs(fused.mean(1) - linked.mean(1)).max() < 6 * within


STEADY = {
    "plain": DEMO,
    "with dark current": DEMO.with_effect(DarkCurrent(electrons_per_us=2.0)),
    "drifting": DEMO.with_effect(LampDrift(amplitude=0.3, time_constant_s=0.01)),
    "nonlinear, line noise, banding": DEMO.with_effect(Nonlinearity(beta_per_dn=1e-6))
    .with_effect(LineNoise(std_dn=0.2))
    .with_effect(Banding(amplitude_dn=2.0)),
}


@pytest.mark.parametrize("model", STEADY.values(), ids=STEADY)
def test_codes_scatter_about_the_noise_free_signal(model: Model) -> None:
    drawn = model.draw(at(3), np.random.default_rng(4))
    off = drawn.dn - drawn.noise_free_dn
    std = np.sqrt(drawn.electrons + 144.0) * 0.15
    score = off / np.sqrt(std**2 + 1 / 12)
    line_noise = 0.2 * np.sqrt(N_LINES) if model.effect("line_noise") else 0.0
    standard_error = np.hypot(1, line_noise) / np.sqrt(off.size)
    assert abs(score.mean()) < 4 * standard_error + 2e-3 * bool(line_noise)
    assert score.std() == pytest.approx(1.0, abs=0.01)


def test_noise_free_signal_is_the_truth_times_light_plus_offset() -> None:
    truth = DEMO.truth()
    drawn = DEMO.draw(at(2), np.random.default_rng(5))
    light = (10.2 + 9.9) * 50.0 * truth.vignette * truth.responsivity
    assert np.allclose(drawn.noise_free_dn, light + truth.dark_offset_dn)
    assert np.allclose(drawn.electrons[0] * truth.system_gain_dn_per_e, light, rtol=0.004)


def test_truth_follows_the_cameras_gain_and_black_level() -> None:
    camera = DEMO.camera.model_copy(update={"gain_db": 20.0, "black_level_dn": 7.0})
    plain, set_up = DEMO.truth(), replace(DEMO, camera=camera).truth()
    assert np.allclose(set_up.responsivity, 10 * plain.responsivity)
    assert np.allclose(set_up.dark_offset_dn, plain.dark_offset_dn + 7.0)
    assert set_up.system_gain_dn_per_e == pytest.approx(1.5)
    assert plain.read_noise_e == 12.0
    assert plain.axis_column == 540.0
    assert plain.vignette[540] == 1.0


def test_dark_current_is_told_apart_from_offset_and_responsivity() -> None:
    lit = DEMO.with_effect(DarkCurrent(electrons_per_us=2.0, dsnu_std_e_per_us=0.0)).truth()
    assert np.allclose(lit.dark_signal_dn_per_us, 2.0 * 0.15, rtol=0.004)
    assert np.array_equal(lit.dark_offset_dn, DEMO.truth().dark_offset_dn)
    assert np.array_equal(lit.responsivity, DEMO.truth().responsivity)


def test_same_generator_state_gives_the_same_lines() -> None:
    first, again, other = (DEMO.draw(at(), np.random.default_rng(s)).dn for s in (1, 1, 2))
    assert np.array_equal(first, again)
    assert not np.array_equal(first, other)


def test_successive_draws_of_one_generator_are_independent() -> None:
    rng = np.random.default_rng(1)
    first, second = (DEMO.draw(at(), rng).dn.astype(float) for _ in range(2))
    off = [frame - frame.mean(0) for frame in (first, second)]
    assert abs(np.corrcoef(off[0].ravel(), off[1].ravel())[0, 1]) < 4 / np.sqrt(off[0].size)


def test_a_scene_adds_to_the_lamps_and_a_line_stands_for_all() -> None:
    dark, scene = at(0), np.linspace(0.0, 40.0, 1024)
    row = DEMO.draw(dark, np.random.default_rng(6), scene)
    full = DEMO.draw(dark, np.random.default_rng(6), np.tile(scene, (N_LINES, 1)))
    truth = DEMO.truth()
    wanted = scene * 50.0 * truth.vignette * truth.responsivity + truth.dark_offset_dn
    assert np.allclose(row.noise_free_dn, wanted)
    assert np.mean(row.dn != full.dn) < 1e-3
    lit = DEMO.draw(at(1), np.random.default_rng(6), scene)
    assert np.allclose(
        lit.noise_free_dn - row.noise_free_dn, 10.2 * 50.0 * truth.vignette * truth.responsivity
    )


BAD_SCENES = {
    "too few columns": (np.ones((N_LINES, 5)), "scene-shape"),
    "too few lines": (np.ones((3, 1024)), "scene-shape"),
    "three axes": (np.ones((1, N_LINES, 1024)), "scene-shape"),
    "negative": (np.full(1024, -1.0), "scene-radiance"),
    "not finite": (np.full(1024, np.nan), "scene-radiance"),
}


@pytest.mark.parametrize(("scene", "code"), BAD_SCENES.values(), ids=BAD_SCENES)
def test_a_scene_that_does_not_fit_is_refused(scene: NDArray[np.float64], code: str) -> None:
    with pytest.raises(InputError) as caught:
        DEMO.draw(at(), np.random.default_rng(1), scene)
    assert caught.value.code == code


def test_more_lamps_than_the_model_has_are_refused() -> None:
    with pytest.raises(InputError, match="7 lamps are lit, but the model has 6"):
        DEMO.draw(at(7), np.random.default_rng(1))


def test_uniform_light_never_needs_an_image_of_means() -> None:
    drifting = DEMO.with_effect(LampDrift()).with_effect(DarkCurrent())
    before = drifting.effects[: len(drifting.effects) - len(after_light(drifting))]
    expected = expected_electrons(before, np.zeros((1, 1024)), at(2), np.random.default_rng(1))
    assert expected.light.shape == (1, 1024)
    assert expected.line_factor.shape == (N_LINES,)
