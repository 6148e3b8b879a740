"""An area sensor's frames: what a line sensor's lines are, pixel by pixel, and their geometry."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from calib.errors import InputError
from calib.forward.chain import expected_electrons
from calib.forward.conditions import Conditions
from calib.forward.draw import draw_link_by_link
from calib.forward.effects.banding import Banding
from calib.forward.effects.dark_current import DarkCurrent
from calib.forward.effects.lamp_drift import LampDrift
from calib.forward.effects.line_noise import LineNoise
from calib.forward.effects.nonlinearity import Nonlinearity
from calib.forward.effects.offset import Offset
from calib.forward.effects.responsivity import Responsivity
from calib.forward.effects.spot import Spot
from calib.forward.effects.system_gain import SystemGain
from calib.forward.effects.vignette import Vignette
from calib.forward.fused import can_fuse, draw_fused
from calib.forward.model import Model
from calib.forward.simulate import simulate
from calib.recording.header import Block
from tests.calib.kernels.numpy_noise import two_sample_p

ROWS, COLUMNS = 24, 40
SAMPLE = (ROWS, COLUMNS)
RNG = np.random.default_rng(0)


def area(rows: int = ROWS, columns: int = COLUMNS, layout: str = "single") -> Model:
    """The demo's sensor, cut to a small frame, its taps laid out anew."""
    demo = Model.preset("demo")
    quadrants = layout == "quadrants"
    gains = (1.0, 1.1, 0.9, 1.2) if quadrants else ()
    taps = {"taps": 4 if quadrants else 1, "tap_layout": layout}
    camera = demo.camera.model_copy(update={"rows": rows, "columns": columns, **taps})
    new = (
        Vignette(focal_length_columns=60.0),
        DarkCurrent(electrons_per_us=0.5),
        SystemGain(dn_per_e=0.15, tap_gain=gains, tap_layout=layout),
        Offset(mean_dn=64.0, pattern_std_dn=1.5, pattern_seed=3),
    )
    kept = (e for e in demo.effects if e.name not in {effect.name for effect in new})
    return replace(demo, camera=camera, effects=(*kept, *new))


def at(n_frames: int, lamps: int = 3, **given: Any) -> Conditions:
    set_up = {"exposure_us": 50.0, "line_period_us": 100.0, "lamps": (1.0,) * lamps} | given
    return Conditions.steady(n_frames, **set_up)


BENT = (
    area(layout="quadrants")
    .with_effect(Nonlinearity(beta_per_dn=1e-6))
    .with_effect(Banding(amplitude_dn=2.0))
    .with_effect(LineNoise(std_dn=0.2))
    .with_effect(LampDrift(amplitude=0.3, time_constant_s=0.01))
)


@pytest.mark.parametrize("model", [area(layout="quadrants"), BENT], ids=["fused", "link by link"])
def test_frames_scatter_about_the_noise_free_signal(model: Model) -> None:
    n_frames = 300
    drawn = model.draw(at(n_frames), np.random.default_rng(4))
    assert drawn.dn.shape == drawn.noise_free_dn.shape == (n_frames, *SAMPLE)
    assert drawn.dn.dtype == np.uint16
    system_gain = model.effect("system_gain")
    assert isinstance(system_gain, SystemGain)
    gain = system_gain.pixels(SAMPLE, 0.0)
    variance = gain**2 * (drawn.electrons + 12.0**2) + 1 / 12
    variance += 0.2**2 * (model.effect("line_noise") is not None)
    score = (drawn.dn - drawn.noise_free_dn) / np.sqrt(variance)
    assert abs(score.mean()) < 5 / np.sqrt(score.size)
    pixels = score.mean(0) * np.sqrt(n_frames)
    assert abs(pixels.std() - 1) < 5 / np.sqrt(2 * pixels.size)
    assert abs(score.std() - 1) < 0.01


def test_the_compiled_pass_and_the_links_one_by_one_draw_from_one_distribution() -> None:
    model = area(layout="quadrants")
    split = [effect.name for effect in model.effects].index("shot_noise")
    before, after = model.effects[:split], model.effects[split:]
    assert can_fuse(after)
    expected = expected_electrons(before, np.zeros((1, *SAMPLE)), at(400), RNG)
    assert expected.light.shape == (1, *SAMPLE)
    fused = draw_fused(after, expected, at(400), np.random.default_rng(1))
    linked, _ = draw_link_by_link(after, expected, at(400), np.random.default_rng(2), 12)
    assert two_sample_p(fused.reshape(400, -1), linked.reshape(400, -1)) > 1e-4
    score = (fused.mean(0) - linked.mean(0)) / np.sqrt((fused.var(0) + linked.var(0)) / 400)
    assert abs(score.mean()) < 5 / np.sqrt(score.size)
    assert np.abs(score).max() < 6


@pytest.mark.parametrize("effect", [None, LineNoise(), Banding(), LampDrift()], ids=str)
def test_a_sensor_of_one_row_gives_a_line_sensors_lines(effect: Any) -> None:
    frame = area(rows=1)
    line = replace(frame, camera=frame.camera.model_copy(update={"rows": None}))
    if effect is not None:
        frame, line = frame.with_effect(effect), line.with_effect(effect)
    frames, lines = (m.draw(at(30), np.random.default_rng(6)).dn for m in (frame, line))
    assert np.array_equal(frames[:, 0], lines)


def test_the_vignette_is_round_about_its_axis() -> None:
    lens = Vignette(axis_row=3.0, axis_column=7.0, focal_length_columns=50.0, coefficients=(-0.2,))
    profile = lens.profile((20, 30))
    assert profile[3, 7] == 1.0
    assert profile[3 + 4, 7 + 3] == pytest.approx(profile[3, 7 + 5], rel=1e-12)
    farthest = np.hypot(16, 22)
    cos = 50.0 / np.hypot(50.0, farthest)
    assert profile[19, 29] == pytest.approx(cos**4 * 0.8, rel=1e-12)
    assert profile.min() == profile[19, 29]


def test_an_even_vignette_is_the_same_along_a_line_and_along_a_row_through_the_axis() -> None:
    lens = Vignette(axis_row=0.0, axis_column=10.0, focal_length_columns=30.0)
    assert np.allclose(lens.profile((1, 64))[0], lens.profile(64), rtol=1e-12)


def test_quadrants_have_their_own_gain_and_offset() -> None:
    gain = SystemGain(dn_per_e=1.0, tap_gain=(1.0, 1.1, 0.9, 1.2), tap_layout="quadrants")
    pixels = gain.pixels((4, 6), 0.0)
    corners = pixels[0, 0], pixels[1, 3], pixels[2, 2], pixels[3, 5]
    assert corners == (1.0, 1.1, 0.9, 1.2)
    offset = Offset(
        mean_dn=0.0, pattern_std_dn=0.0, tap_offset_dn=(1, 2), tap_layout="odd_even"
    ).pixels((3, 4), 5.0)
    assert offset.tolist() == [[6.0, 7.0, 6.0, 7.0]] * 3


def test_an_explicit_pattern_runs_row_by_row() -> None:
    prnu = Responsivity(electrons_per_radiance_us=1.0, prnu=(1.0, 2.0, 3.0, 4.0, 5.0, 6.0))
    assert prnu.pixels((2, 3)).tolist() == [[1.0, 2.0, 3.0], [4.0, 5.0, 6.0]]


def test_line_noise_moves_a_row_together_and_each_row_by_itself() -> None:
    n = 400
    noise = LineNoise(std_dn=2.0).apply(np.zeros((n, 12, 5)), at(n), np.random.default_rng(3))
    assert np.all(noise == noise[..., :1])
    rows = noise[..., 0]
    assert rows.std() == pytest.approx(2.0, abs=5 * 2.0 / np.sqrt(2 * rows.size))
    apart = np.corrcoef(rows.T)[np.triu_indices(12, 1)]
    assert np.abs(apart).max() < 5 / np.sqrt(n)


def test_banding_runs_on_from_row_to_row_and_from_frame_to_frame() -> None:
    period_us = 100.0
    tone = Banding(amplitude_dn=2.0, frequency_hz=3.3 / (period_us * 1e-6))
    frames = tone.apply(np.zeros((5, 16, 32)), at(5, line_period_us=period_us), RNG)
    in_time = np.arange(frames.size) / (16 * 32)
    assert np.allclose(frames.ravel(), 2.0 * np.sin(2 * np.pi * 3.3 * in_time), atol=1e-9)


@pytest.mark.parametrize("edge", [0.0, 2.5])
def test_a_spot_sends_as_much_light_as_its_formula_says(edge: float) -> None:
    spot = Spot(diameter_columns=60.0, edge_std_columns=edge, centre_row=44.3, centre_column=51.8)
    profile = spot.profile((90, 110))
    wanted = np.pi * (30.0**2 + edge**2)
    # The rim of a sharp disc cuts pixels; their error scatters like the rim's length to the half.
    assert profile.sum() == pytest.approx(wanted, abs=5 * np.sqrt(60.0) if edge == 0 else 0.01)
    row, column = np.indices((90, 110))
    assert np.average(row, weights=profile) == pytest.approx(44.3, abs=0.2 if edge == 0 else 1e-4)
    assert np.average(column, weights=profile) == pytest.approx(
        51.8, abs=0.2 if edge == 0 else 1e-4
    )
    assert profile[44, 52] == pytest.approx(1.0, abs=1e-12)
    assert profile[0, 0] == pytest.approx(0.0, abs=1e-12)


def test_a_simulated_recording_holds_frames_and_their_scene() -> None:
    model = area()
    scene = np.zeros(SAMPLE)
    scene[5, 7] = 40.0
    blocks = [
        Block(block="0", kind="dark", exposure_us=50.0, lines=5),
        Block(block="1", kind="flat", exposure_us=50.0, level=2, lines=5),
        Block(block="2", kind="scene", exposure_us=50.0, lines=5, scene="star"),
    ]
    drawn = simulate(model, blocks, np.random.default_rng(1), frame_lines=2, scenes={"star": scene})
    taken = {block.block: list(frames) for block, frames in drawn}
    assert [dn.shape for dn in taken["1"]] == [(2, *SAMPLE), (2, *SAMPLE), (1, *SAMPLE)]
    star = np.concatenate(taken["2"]).mean(0)
    assert np.unravel_index(star.argmax(), SAMPLE) == (5, 7)
    assert np.concatenate(taken["1"]).mean() > np.concatenate(taken["0"]).mean() + 50


def test_a_frame_of_scenes_that_does_not_fit_is_refused() -> None:
    for scene in (np.ones(COLUMNS), np.ones((3, *SAMPLE)), np.ones((COLUMNS, ROWS))):
        with pytest.raises(InputError) as caught:
            area().draw(at(4), RNG, scene)
        assert caught.value.code == "scene-shape"


def test_the_truth_has_the_shape_of_a_frame() -> None:
    truth = area(layout="quadrants").truth()
    for values in (truth.dark_offset_dn, truth.vignette, truth.responsivity):
        assert values.shape == SAMPLE
    assert truth.dark_signal_dn_per_us.shape == SAMPLE
    assert truth.axis_column == (COLUMNS - 1) / 2
    drawn = area(layout="quadrants").draw(at(2), np.random.default_rng(5))
    light = (10.2 + 9.9 + 10.0) * 50.0 * truth.vignette * truth.responsivity
    dark = truth.dark_offset_dn + 50.0 * truth.dark_signal_dn_per_us
    assert np.allclose(drawn.noise_free_dn, light + dark)
