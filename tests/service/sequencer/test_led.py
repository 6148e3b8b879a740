"""A sweep on a bench whose light is an LED at continuous current, its level a number between."""

from collections.abc import Iterator

import numpy as np
import pytest

from calib.errors import DarkflatError
from calib.forward.model import Model
from calib.radiometric.calibrate import calibrate
from calib.recording.open import open_recording
from service.bench import Bench, open_bench
from service.sequencer.events import RunResult
from service.sequencer.run import run_plan
from tests.service.sequencer.benches import assert_dark, whole_blocks
from tests.service.sequencer.line_benches import MIGHTEX, line_plan, on_lines
from tests.service.sequencer.test_faults import at_frame

LEVELS = [0.25, 0.6, 1.4]
PLAN = line_plan(
    sweep={"type": "factorial", "exposures_us": [30.0, 60.0, 90.0], "levels": LEVELS},
    order="level_major",
    source={"kind": "led", "radiance": {str(each): 10.2 * each for each in LEVELS}},
    camera={"line_period_us": 100.0, "columns": 64},
    lines=256,
    frame_lines=64,
)
TWO_FLATS = line_plan(sweep={"type": "exposure", "exposures_us": [30.0, 60.0], "level": 0.6})


@pytest.fixture(scope="module")
def led_bench() -> Iterator[Bench]:
    with open_bench(on_lines("led", MIGHTEX)) as bench:
        yield bench


@pytest.fixture(scope="module")
def swept(led_bench, tmp_path_factory: pytest.TempPathFactory) -> RunResult:
    return run_plan(led_bench, PLAN, tmp_path_factory.mktemp("led") / "sweep.h5")


def test_an_led_is_swept_at_levels_between_and_ends_dark(led_bench, swept):
    assert (swept.state, swept.blocks_done) == ("succeeded", 12)
    assert_dark(led_bench.world)
    blocks = open_recording(swept.path).header.blocks
    assert [b.level for b in blocks if b.kind == "flat"] == [x for x in LEVELS for _ in range(3)]
    for block in blocks:
        if block.kind == "flat":
            assert block.model_extra["level_read_back"] == pytest.approx(block.level, abs=0.001)
            assert block.model_extra["lamp_currents_a"] == pytest.approx([0.5 * block.level])
            assert block.monitor == pytest.approx(2e-7 * block.level, rel=0.05)


def test_a_sweep_of_an_led_gives_the_camera_s_responsivity(swept):
    found = calibrate(open_recording(swept.path)).coefficients
    truth = Model.preset("demo").truth()
    true_slope = (truth.vignette * truth.responsivity)[: found.n_columns]
    std = np.hypot(found.slope_std, found.slope * found.scale_relative_std)
    assert np.all(np.abs(found.slope - true_slope) < 5 * std)


def test_an_led_that_restarts_in_a_block_is_seen_after_it(led_bench, out):
    def brown_out():
        led_bench.simulated.emulators.inject("led brown-out")

    with pytest.raises(DarkflatError, match="lamp 1 is off") as caught:
        run_plan(led_bench, TWO_FLATS, out, on_progress=at_frame(6, brown_out))
    assert caught.value.code == "lamp-out"
    assert_dark(led_bench.world)
    assert run_plan(led_bench, TWO_FLATS, out, resume=True).state == "succeeded"
    assert len(whole_blocks(out)) == 4


def test_a_level_that_the_controller_cannot_give_is_refused_before_anything_is_lit(led_bench, out):
    sweep = {"type": "exposure", "exposures_us": [50.0], "level": 2.5}
    with pytest.raises(DarkflatError, match=r"level 2\.5") as caught:
        run_plan(led_bench, line_plan(sweep=sweep), out)
    assert caught.value.code == "level-out-of-range"
    assert not out.exists()
