"""A simulated recording keeps time, lamps and blocks as a bench would."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from calib.arrays import RawLines
from calib.errors import InputError
from calib.forward.effects.illumination import Illumination
from calib.forward.model import Model
from calib.forward.simulate import simulate
from calib.recording.header import Block, SourceHeader

DEMO = Model.preset("demo")


def block(name: str, kind: str = "flat", **given: Any) -> Block:
    return Block(block=name, kind=kind, **({"exposure_us": 50.0, "lines": 30} | given))  # type: ignore[arg-type]


def taken(
    blocks: list[Block], model: Model = DEMO, seed: int = 1, **given: Any
) -> list[tuple[Block, list[RawLines]]]:
    rng = np.random.default_rng(seed)
    options = {"frame_lines": 20} | given
    return [(b, list(frames)) for b, frames in simulate(model, blocks, rng, **options)]


def test_unknowns_are_filled_in_and_knowns_kept() -> None:
    dark, flat, kept = (
        b
        for b, _ in taken(
            [
                block("0", "dark"),
                block("1", level=2, lines=None),
                block("2", level=1, started_s=9.0, radiance=7.0, sensor_temperature_c=31.0),
            ]
        )
    )
    assert (dark.started_s, dark.radiance, dark.lines) == (0.0, 0.0, 30)
    assert flat.started_s == pytest.approx(30 * 100e-6)
    assert flat.radiance == pytest.approx(10.2 + 9.9)
    assert (flat.lines, flat.sensor_temperature_c) == (20, 25.0)
    assert (kept.started_s, kept.radiance, kept.sensor_temperature_c) == (9.0, 7.0, 31.0)


def test_frames_hold_all_lines_and_the_last_what_is_left() -> None:
    ((_, frames),) = taken([block("0", level=1, lines=50)])
    assert [frame.shape for frame in frames] == [(20, 1024), (20, 1024), (10, 1024)]
    assert not np.array_equal(frames[0], frames[1])


def test_a_block_does_not_depend_on_the_frames_read_before_it() -> None:
    blocks = [block("0", level=1), block("1", level=2)]
    whole = taken(blocks)
    rng = np.random.default_rng(1)
    skipped = list(simulate(DEMO, blocks, rng, frame_lines=20))[1]
    assert np.array_equal(whole[1][1][0], next(skipped[1]))
    assert not np.array_equal(whole[1][1][0], taken(blocks, seed=2)[1][1][0])


def test_the_level_lights_as_many_lamps_and_a_dark_is_capped() -> None:
    means = [np.mean(frames[0]) for _, frames in taken([block("0", "dark"), block("1", level=3)])]
    truth = DEMO.truth()
    flat = 30.1 * 50.0 * truth.vignette * truth.responsivity + truth.dark_offset_dn
    assert means[0] == pytest.approx(truth.dark_offset_dn.mean(), abs=0.1)
    assert means[1] == pytest.approx(flat.mean(), abs=0.5)


def test_lamps_warm_up_from_the_switch_on_and_stay_warm_through_a_dark() -> None:
    slow = DEMO.with_effect(Illumination(radiance=(10.0,) * 6, warm_up_s=(5.0,) * 6))
    long = 50_000  # 5 s: one time constant
    blocks = [
        block("0", level=1, lines=long),
        block("1", "dark", lines=long),
        block("2", level=1, lines=20),
    ]
    rng = np.random.default_rng(1)
    first, mid, last = ([next(frames)] for _, frames in simulate(slow, blocks, rng, frame_lines=20))
    lit = 10.0 * 50.0 * DEMO.truth().vignette * DEMO.truth().responsivity
    share = [
        (np.mean(f[0]) - DEMO.truth().dark_offset_dn.mean()) / lit.mean()
        for f in (first, mid, last)
    ]
    assert share[0] == pytest.approx(0.0, abs=0.005)
    assert share[1] == pytest.approx(0.0, abs=0.005)
    assert share[2] == pytest.approx(1 - np.exp(-2), abs=0.005)


def test_settling_delays_a_block_after_a_switch_only() -> None:
    blocks = [block("0", level=1), block("1", level=1), block("2", level=2)]
    started = [b.started_s for b, _ in taken(blocks, settle_s=60.0)]
    assert started == pytest.approx([60.0, 60.003, 120.006])


def test_an_led_takes_its_setting_as_emission() -> None:
    led = replace(DEMO, source=SourceHeader(kind="led", lamps=1))
    led = led.with_effect(Illumination(radiance=(20.0,)))
    ((filled, _),) = taken([block("0", level=0.35)], led)
    assert filled.radiance == pytest.approx(7.0)


def test_a_scene_runs_through_the_frames() -> None:
    image = np.linspace(0, 30, 30)[:, np.newaxis] * np.ones(1024)
    ((filled, frames),) = taken([block("0", "scene", scene="sky")], scenes={"sky": image})
    lines = np.vstack(frames).mean(1)
    assert filled.radiance is None
    assert np.all(np.diff(lines) > 0)


BAD = {
    "out of order": ([block("0", started_s=5.0), block("1", started_s=1.0)], "blocks-out-of-order"),
    "exposure too long": ([block("0", exposure_us=101.0)], "exposure-too-long"),
    "half a lamp": ([block("0", level=1.5)], "bad-level"),
    "too many lamps": ([block("0", level=7)], "bad-level"),
    "scene missing": ([block("0", "scene", scene="sky")], "scene-missing"),
}


@pytest.mark.parametrize(("blocks", "code"), BAD.values(), ids=BAD)
def test_blocks_that_cannot_be_taken_are_refused_at_once(blocks: list[Block], code: str) -> None:
    with pytest.raises(InputError, match="block ") as caught:
        simulate(DEMO, blocks, np.random.default_rng(1), frame_lines=20)
    assert caught.value.code == code


def test_a_model_without_a_line_period_is_refused() -> None:
    camera = DEMO.camera.model_copy(update={"line_period_us": None})
    with pytest.raises(InputError, match="line_period_us is missing"):
        simulate(replace(DEMO, camera=camera), [], np.random.default_rng(1), frame_lines=20)
