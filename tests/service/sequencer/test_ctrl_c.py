"""Ctrl-C at a terminal goes to every process of the foreground's group, not to one alone."""

import importlib.util
import os
import signal
from pathlib import Path

import pytest
import tomli_w

from drivers.mock.world import World
from service.bench import BenchSettings
from tests.service.sequencer.benches import assert_dark, whole_blocks
from tests.service.sequencer.killing import Sweep
from tests.service.sequencer.line_benches import GEN, line_plan, on_lines
from tests.service.sequencer.test_protocols import over_protocols

PLAN = line_plan()

BENCHES = [
    pytest.param(lambda world: on_lines("ctrl-c", GEN, world), id="emulated controllers"),
    pytest.param(
        lambda world: over_protocols("ctrl-c", world),
        id="simulated GigE Vision camera too",
        marks=[
            pytest.mark.aravis,
            pytest.mark.skipif(importlib.util.find_spec("gi") is None, reason="no PyGObject"),
        ],
    ),
]


def sweep_on(settings: BenchSettings, folder: Path) -> Sweep:
    bench, plan = folder / "bench.toml", folder / "plan.toml"
    bench.write_text(tomli_w.dumps(settings.model_dump(mode="json", exclude_none=True)))
    plan.write_text(PLAN.dumps())
    return Sweep(bench, plan, folder / "sweep.h5")


@pytest.mark.parametrize("bench", BENCHES)
def test_ctrl_c_at_the_terminal_leaves_the_lamps_off(tmp_path: Path, bench):
    sweep = sweep_on(bench(tmp_path / "world"), tmp_path)
    errors = tmp_path / "errors"
    with errors.open("w") as stderr:
        process = sweep.start(ends=False, start_new_session=True, stderr=stderr)
    try:
        sweep.wait_for(6, process)
        os.killpg(process.pid, signal.SIGINT)
        process.wait(sweep.deadline_s)
    finally:
        process.kill()
        process.wait()
    assert process.returncode != 0
    assert len(whole_blocks(sweep.out)) < 4
    assert "lamps could not be read back" not in errors.read_text()
    world = World(tmp_path / "world")
    assert_dark(world)
    world.close()
