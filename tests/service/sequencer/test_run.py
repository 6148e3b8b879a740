"""A run that nothing disturbs, and what its recording says of it."""

import numpy as np
import pytest

from calib.forward.model import Model
from calib.recording.file_recording import FileRecording
from service.plan.expand import expand
from service.plan.model import Plan
from service.sequencer.run import run_plan
from tests.service.sequencer.benches import assert_dark, short_plan, whole_blocks


def test_every_step_becomes_a_whole_block_and_the_lamps_are_off(bench, out):
    plan = short_plan()
    result = run_plan(bench, plan, out)
    assert result.state == "succeeded"
    assert (result.blocks_done, result.blocks_total, result.frames) == (4, 4, 16)
    assert whole_blocks(out) == {step.block.block: 32 for step in expand(plan)}
    assert_dark(bench.world)


def test_a_recording_has_nothing_odd_about_it(bench, out):
    run_plan(bench, short_plan(), out)
    assert FileRecording(out).warnings == ()


def test_conditions_are_those_read_back(bench, out):
    run_plan(bench, short_plan(), out)
    dark, flat = FileRecording(out).header.blocks[:2]
    assert (dark.kind, dark.level, flat.kind, flat.level) == ("dark", 0.0, "flat", 1.0)
    assert flat.exposure_us == 50.0
    assert flat.sensor_temperature_c == bench.camera.temperature_c()
    assert flat.monitor == pytest.approx(2e-7, rel=0.05)
    assert flat.model_extra["lamp_currents_a"][0] > 0
    assert flat.model_extra["lamp_currents_a"][1:] == [0.0, 0.0]
    assert flat.started_s > dark.started_s > 0


def test_frames_keep_who_they_are(bench, out):
    run_plan(bench, short_plan(), out)
    frames = FileRecording(out).commits.every_frame
    ids = [frame.record.frame_id for frame in frames]
    assert len(set(ids)) == 16
    assert all(frame.record.lamp_currents_a for frame in frames)
    assert all(frame.record.exposure_us in {50.0, 100.0} for frame in frames)


def test_the_cap_is_on_in_darks_and_off_in_flats(bench, out):
    seen = {}

    def look(columns):
        seen[columns.block] = bench.world.state().capped

    run_plan(bench, short_plan(), out, on_columns=look)
    assert seen == {"000": True, "001": False, "002": True, "003": False}


def test_flats_are_brighter_than_darks_and_grow_with_exposure(bench, out):
    run_plan(bench, short_plan(), out)
    recording = FileRecording(out)
    means = [np.mean(list(recording.frames(b.block))) for b in recording.header.blocks]
    dark_50, flat_50, dark_100, flat_100 = means
    assert flat_100 - dark_100 == pytest.approx(2 * (flat_50 - dark_50), rel=0.1)
    assert flat_50 > dark_50 + 50


def test_the_recording_keeps_the_plan_and_who_the_devices_were(bench, out):
    plan = short_plan(source={"identity": "sphere 7"})
    run_plan(bench, plan, out)
    recording = FileRecording(out)
    assert Plan.loads(recording.provenance.plan) == plan
    assert recording.provenance.features["bench"] == bench.id
    assert "MockLight" in recording.provenance.features["bench.light"]
    assert recording.header.camera.serial == bench.camera.identity.serial


def test_progress_counts_blocks_and_ends_with_the_lamps_off(bench, out):
    said = []

    def listen(progress):
        said.append(progress)
        if progress.state == "succeeded":
            assert_dark(bench.world)

    run_plan(bench, short_plan(), out, on_progress=listen)
    done = [progress.blocks_done for progress in said]
    assert done == sorted(done)
    assert (said[0].blocks_done, said[-1].blocks_done) == (0, 4)
    assert [p.state for p in said if p.state != "running"] == ["succeeded"]
    assert said[-1].seconds_left == 0.0
    assert all(p.seconds_left is not None for p in said if p.blocks_done > 0)


def test_lost_frames_are_recorded_and_taken_again(bench, out):
    bench.camera.faults.to_lose = 2
    result = run_plan(bench, short_plan(), out)
    assert (result.frames, result.lost_frames) == (16, 2)
    assert len(FileRecording(out).commits.lost) == 2
    assert set(whole_blocks(out).values()) == {32}


def test_lamps_go_off_between_blocks_where_the_plan_says_so(bench, out):
    levels = []

    def listen(progress):
        if "lamps off, as the plan says" in progress.doing:
            return
        levels.append((progress.blocks_done, bench.light.state().level))

    plan = short_plan(lamps={"mode": "off_between_blocks"}, darks="none")
    run_plan(bench, plan, out, on_progress=listen)
    assert (1, 0.0) in levels  # when level 1 is set for the second block, nothing burns
    assert set(whole_blocks(out).values()) == {32}


def test_all_columns_are_taken_where_the_plan_names_none(bench, out):
    run_plan(bench, short_plan(camera={"line_period_us": 1000.0}), out)
    assert FileRecording(out).header.camera.columns == Model.preset("demo").camera.columns


def test_the_region_is_recorded_with_the_sensor_that_it_is_a_part_of(bench, out):
    wanted = {"line_period_us": 1000.0, "first_column": 32, "columns": 64}
    run_plan(bench, short_plan(camera=wanted), out)
    camera = FileRecording(out).header.camera
    assert camera.region == "32:96"
    assert camera.sensor_columns == Model.preset("demo").camera.columns


class CountedLight:
    """A light that counts how often it was asked for its state from outside."""

    def __init__(self, light):
        self._light = light
        self.asked = 0

    def __getattr__(self, name):
        return getattr(self._light, name)

    def state(self):
        self.asked += 1
        return self._light.state()


def test_lamps_are_read_back_once_per_block_and_once_the_light_is_steady(bench, out):
    """A chain of supplies on one line takes seconds, each time."""
    bench.light = CountedLight(bench.light)
    levels = {"type": "factorial", "exposures_us": [50.0, 100.0], "levels": [1, 2, 3]}
    result = run_plan(bench, short_plan(sweep=levels, order="level_major"), out)
    assert bench.light.asked == result.blocks_total + 3


def test_lamps_are_read_back_again_after_a_wait_of_the_plan(bench, out):
    bench.light = CountedLight(bench.light)
    blocks = [{"exposure_us": 50.0, "level": 1, "wait_s": 0.01}] * 3
    run_plan(bench, short_plan(sweep={"type": "listed", "blocks": blocks}), out)
    assert bench.light.asked == 2 * 3
