"""Example benches that are simulated can be opened, and measure."""

import os
from pathlib import Path

import pytest

from drivers.mock.world import World
from service.bench import Bench, BenchSettings, open_bench
from service.plan.model import Plan
from service.sequencer.run import run_plan
from tests.contracts.simulated_camera import ADDRESS_WAIT_S

EXAMPLES = Path(__file__).parents[3] / "examples" / "benches"

LEVEL_1 = Plan.parse(
    {
        "sweep": {"type": "level", "levels": [1], "exposure_us": 40.0},
        "camera": {"line_period_us": 100.0},
        "lines": 32,
        "settle": {"tolerance_percent": 5.0, "stable_for_s": 0.1, "interval_s": 0.05},
    }
)

SIMULATED = [
    "in-process",
    "led",
    pytest.param("simulated", marks=pytest.mark.aravis),
]


def opened(name: str) -> Bench:
    """Open the example under a name of its own, since others may use it at the same time."""
    settings = BenchSettings.load(EXAMPLES / f"{name}.toml")
    quick = {"camera_wait_s": ADDRESS_WAIT_S, "lamps": 1}  # one lamp is enough here
    simulation = settings.simulation.model_copy(update=quick)
    mine = {"id": f"example-{os.getpid()}-{name}", "simulation": simulation}
    return open_bench(settings.model_copy(update=mine))


def targets(world: World) -> set[float]:
    return {lamp.target for lamp in world.state().lamps}


@pytest.mark.parametrize("name", SIMULATED)
def test_an_example_bench_takes_a_dark_and_a_flat(tmp_path: Path, name: str):
    with opened(name) as bench:
        result = run_plan(bench, LEVEL_1, tmp_path / "sweep.h5")
        assert (result.state, result.blocks_done) == ("succeeded", 2)
        assert targets(bench.world) == {0.0}


def test_every_simulated_example_is_opened_here():
    named = {getattr(each, "values", (each,))[0] for each in SIMULATED}
    simulated = {p.stem for p in EXAMPLES.glob("*.toml") if BenchSettings.load(p).simulation}
    assert named == simulated
