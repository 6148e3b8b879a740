"""kill -9 at random moments loses no acknowledged frame, and the sweep goes on where it was."""

import json
import random
import time
from pathlib import Path

import pytest
import tomli_w

from drivers.mock.world import World
from service.plan.expand import expand
from service.plan.model import Plan
from tests.service.sequencer.benches import assert_dark, in_process, short_plan, whole_blocks
from tests.service.sequencer.killing import Sweep


@pytest.fixture
def sweep(tmp_path: Path) -> Sweep:
    settings = in_process(tmp_path.name, tmp_path / "world")
    bench, plan = tmp_path / "bench.toml", tmp_path / "plan.toml"
    bench.write_text(tomli_w.dumps(settings.model_dump(mode="json", exclude_none=True)))
    plan.write_text(PLAN.dumps())
    return Sweep(bench, plan, tmp_path / "sweep.h5")


PLAN = short_plan(lines=80, frame_lines=8)


def assert_survived(before: list[bytes], after: list[bytes]) -> None:
    """Fail where a line that was acknowledged is gone, or an unfinished block was kept."""
    assert after[: len(before)] == before
    entries = [json.loads(line) for line in after]
    begun = [e["block"]["block"] for e in entries if e["kind"] == "begin"]
    ended = [e["block"]["block"] for e in entries if e["kind"] == "end"]
    superseded = [e["block"] for e in entries if e["kind"] == "superseded"]
    assert len(ended) == len(set(ended))
    assert sorted(begun) == sorted(ended + superseded)


def kill_and_resume(sweep: Sweep, kills: int, most_frames: int) -> None:
    """Kill the sweep at random moments, then let it end, checking after each."""
    rng = random.Random()
    record: list[bytes] = []
    for _ in range(kills):
        now = sweep.kill_after(rng.randrange(1, most_frames), rng.uniform(0.0, 0.03))
        assert now[: len(record)] == record
        record = now
    sweep.finish()
    assert_survived(record, sweep.acknowledged())


def test_a_killed_sweep_ends_with_every_block_whole_and_dark(sweep: Sweep):
    kill_and_resume(sweep, kills=2, most_frames=12)
    wanted = {step.block.block: 80 for step in expand(PLAN)}
    assert whole_blocks(sweep.out) == wanted
    world = World(sweep.out.with_name("world"))
    assert_dark(world)
    world.close()


def test_sigterm_leaves_the_lamps_off(sweep: Sweep):
    process = sweep.start()
    while sweep.frames() < 12 and process.poll() is None:
        time.sleep(0.01)
    process.terminate()
    assert process.wait(30) == 128 + 15
    world = World(sweep.out.with_name("world"))
    assert_dark(world)
    world.close()


FULL_SIZE = Plan.parse(
    {
        "sweep": {
            "type": "factorial",
            "exposures_us": [100.0, 200.0, 300.0, 400.0, 500.0],
            "levels": [1, 2, 3, 4, 5],
        },
        "order": "level_major",
        "camera": {"line_period_us": 1400.0, "pixel_format": "Mono8"},
        "lines": 714,
        "frame_lines": 102,
        "darks": {"placement": "interleaved"},
        "settle": {"tolerance_percent": 2.0, "stable_for_s": 0.5, "timeout_s": 60.0},
    }
)


@pytest.mark.soak
@pytest.mark.aravis
def test_a_full_size_sweep_over_protocols_survives_ten_kills(tmp_path: Path):
    """30 blocks of 714 lines of 6,144 columns, over loopback and pseudo-terminals."""
    bench, plan = tmp_path / "bench.toml", tmp_path / "plan.toml"
    simulation = {"model": "agcam-nir", "lamps": 6, "world": "world", "camera_wait_s": 30.0}
    drivers = {
        "camera": {"driver": "aravis"},
        "light": {"driver": "gen"},
        "monitor": {"driver": "keithley6485"},
        "shutter": {"driver": "rly16"},
    }
    content = {"id": tmp_path.name, **drivers, "simulation": simulation}
    bench.write_text(tomli_w.dumps(content))
    plan.write_text(FULL_SIZE.dumps())
    sweep = Sweep(bench, plan, tmp_path / "sweep.h5", deadline_s=900.0)
    kill_and_resume(sweep, kills=10, most_frames=25)
    assert whole_blocks(sweep.out) == {s.block.block: 714 for s in expand(FULL_SIZE)}
    world = World(tmp_path / "world")
    assert_dark(world)
    world.close()
