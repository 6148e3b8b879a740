"""kill -9 at random moments loses no acknowledged frame, and the sweep goes on where it was.

What comes out in the end is what an undisturbed sweep gives: every block whole, every CRC right,
and the same coefficients within their uncertainty.
"""

import json
import os
import random
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest
import tomli_w

from calib.forward.model import Model
from calib.recording.open import open_recording
from drivers.mock.world import World
from service.plan.expand import expand
from service.plan.model import Plan
from tests.contracts.simulated_camera import ADDRESS_WAIT_S
from tests.service.sequencer.benches import SETTLES, assert_dark, in_process, whole_blocks
from tests.service.sequencer.comparing import Agreement, compare
from tests.service.sequencer.killing import Sweep
from tests.service.sequencer.sweep_plans import whole_sweep

PLAN = whole_sweep(
    Model.preset("demo"),
    (25.0, 50.0, 75.0, 100.0),
    (1, 2),
    columns=256,
    lines=128,
    frame_lines=8,
    settle=SETTLES,
)


def files_for(folder: Path, bench: dict[str, Any], plan: Plan, **more: Any) -> Sweep:
    """Write bench and plan, and return the sweep into `folder`/sweep.h5."""
    bench_file, plan_file = folder / "bench.toml", folder / "plan.toml"
    bench_file.write_text(tomli_w.dumps(bench))
    plan_file.write_text(plan.dumps())
    return Sweep(bench_file, plan_file, folder / "sweep.h5", **more)


@pytest.fixture
def sweep(tmp_path: Path) -> Sweep:
    settings = in_process(f"kill-{os.getpid()}", tmp_path / "world")
    return files_for(tmp_path, settings.model_dump(mode="json", exclude_none=True), PLAN)


def assert_survived(before: list[bytes], after: list[bytes]) -> None:
    """Fail where a line that was acknowledged is gone, or an unfinished block was kept."""
    assert after[: len(before)] == before
    entries = [json.loads(line) for line in after]
    begun = [e["block"]["block"] for e in entries if e["kind"] == "begin"]
    ended = [e["block"]["block"] for e in entries if e["kind"] == "end"]
    superseded = [e["block"] for e in entries if e["kind"] == "superseded"]
    assert len(ended) == len(set(ended))
    assert sorted(begun) == sorted(ended + superseded)


def kill_and_resume(sweep: Sweep, kills: int, *, starting_s: float, most_frames: int) -> None:
    """Kill the sweep at random moments, then let it end, checking after each.

    Every second kill comes while devices start and lamps settle, which takes about `starting_s`,
    the others while frames arrive or between two blocks; all of them before the end of the sweep.
    """
    rng = random.Random()
    record: list[bytes] = []
    for i in range(kills):
        if i % 2:
            now = sweep.kill_after(0, rng.uniform(0.0, starting_s))
        else:
            now = sweep.kill_after(rng.randrange(1, most_frames), rng.uniform(0.0, 0.1))
        assert now[: len(record)] == record
        record = now
    sweep.finish()
    assert_survived(record, sweep.acknowledged())


def as_if_undisturbed(sweep: Sweep, plan: Plan) -> Agreement:
    """Check that the sweep is whole and dark, and compare it with one that nobody killed."""
    lines = {step.block.block: step.lines for step in expand(plan)}
    assert whole_blocks(sweep.out) == lines
    undisturbed = replace(sweep, out=sweep.out.with_name("undisturbed.h5"))
    undisturbed.finish()
    assert whole_blocks(undisturbed.out) == lines
    world = World(sweep.out.with_name("world"))
    assert_dark(world)
    world.close()
    agreement = compare(open_recording(undisturbed.out), open_recording(sweep.out))
    agreement.check(light_percent=plan.settle.tolerance_percent)
    return agreement


def test_a_killed_sweep_is_in_the_end_what_an_undisturbed_one_is(sweep: Sweep):
    kill_and_resume(sweep, kills=2, starting_s=1.5, most_frames=100)
    as_if_undisturbed(sweep, PLAN)


def test_sigterm_leaves_the_lamps_off(sweep: Sweep):
    process = sweep.start(ends=False)
    try:
        sweep.wait_for(12, process)
        process.terminate()
        assert process.wait(sweep.deadline_s) == 128 + 15
    finally:
        process.kill()
        process.wait()
    world = World(sweep.out.with_name("world"))
    assert_dark(world)
    world.close()


FULL_SIZE = whole_sweep(
    Model.preset("agcam-nir"),
    (20.0, 40.0, 60.0, 80.0, 100.0),
    (1, 2, 3, 4, 5),
    lines=714,
    frame_lines=102,
    settle={"tolerance_percent": 1.0, "stable_for_s": 0.5, "timeout_s": 60.0},
)


@pytest.mark.soak
@pytest.mark.aravis
def test_a_full_size_sweep_over_protocols_survives_ten_kills(tmp_path: Path):
    """31 blocks of 714 lines of 6,144 columns, over loopback and pseudo-terminals."""
    assert len(expand(FULL_SIZE)) == 31
    simulation = {
        "model": "agcam-nir",
        "lamps": 5,
        "world": "world",
        "camera_wait_s": ADDRESS_WAIT_S,
    }
    bench = {
        "id": f"kill-{os.getpid()}",
        "camera": {"driver": "aravis"},
        "light": {"driver": "gen"},
        "monitor": {"driver": "keithley6485"},
        "shutter": {"driver": "rly16"},
        "simulation": simulation,
    }
    sweep = files_for(tmp_path, bench, FULL_SIZE, deadline_s=900.0)
    kill_and_resume(sweep, kills=10, starting_s=10.0, most_frames=35)
    print(as_if_undisturbed(sweep, FULL_SIZE))  # noqa: T201  shown by pytest -rP
