"""The loop on a bench without a transport, and what it says when it cannot go on."""

import json
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path

import pytest
from numpy.random import default_rng

from calib.diagnosis.deciding.bench import BenchTime
from calib.diagnosis.deciding.family import options
from calib.diagnosis.deciding.plan_text import plan_of
from calib.forward.effects.exposure_offset import ExposureOffset
from calib.recording.header import Block, RecordingHeader
from calib.recording.open import open_recording
from drivers.mock.world import World
from service.bench import BenchSettings, open_bench
from service.investigation.first_plan import first_plan
from service.investigation.investigate import investigate
from service.plan.expand import expand
from service.plan.model import Plan
from tests.calib.diagnosis.investigations import CASES, hidden, investigated, is_settled
from tests.calib.diagnosis.recordings import plain_model, recorded
from tests.service.cli.answers import Ran
from tests.service.cli.benches import bench_file as paced_bench_file
from tests.service.cli.benches import plan_for_bench
from tests.service.cli.conftest import home, run

__all__ = ["home", "run"]
Run = Callable[..., Ran]
STRAY = CASES["stray light or exposure offset"]


def test_every_plan_that_may_be_asked_for_is_one_that_a_sweep_runs() -> None:
    blocks = [
        Block(block=str(k), kind="flat" if level else "dark", exposure_us=t, level=level, lines=50,
              sensor_temperature_c=30.0)
        for k, (t, level) in enumerate([(200.0, 0.0), (200.0, 1.0), (900.0, 1.0), (400.0, 2.0)])
    ]  # fmt: skip
    model = plain_model(32)
    evidence = recorded(model, blocks, default_rng())
    header = RecordingHeader(camera=model.camera, source=model.source, blocks=evidence.table.blocks)
    family = options(evidence, BenchTime(1400.0, max_level=4.0))
    assert len(family) > 15
    for option in family:
        text = plan_of(option.plan, header, name=option.what, monitor=option.monitor)
        steps = expand(Plan.parse(text))
        planned = [(t.block.kind, t.block.exposure_us, t.block.level) for t in option.plan]
        assert [(s.block.kind, s.block.exposure_us, s.block.level) for s in steps] == planned
        assert [s.burning for s in steps] == [t.burning for t in option.plan]
        assert (Plan.parse(text).interlocks.monitor_a is None) != option.monitor


def test_an_open_name_is_settled_by_one_more_sweep() -> None:
    done = investigated(STRAY, ExposureOffset(-0.8))
    assert [len(each.answer()["names"]) for each in done.rounds] == [1] * len(done.rounds)
    assert len(done.rounds[0].diagnosis.findings[0].candidates) > 1
    following = done.rounds[0].diagnosis.next_measurement
    assert following is not None
    assert done.rounds[1].plan.name == following.plan["name"]
    assert done.rounds[1].plan.settle == done.rounds[0].plan.settle
    assert is_settled(done, ExposureOffset(-0.8)) or len(done.rounds) > 2


def test_no_second_sweep_begins_where_there_is_no_time_for_it() -> None:
    done = investigated(STRAY, ExposureOffset(-0.8), sweeps_s=0.0)
    assert done.outcome == "budget-spent"
    assert len(done.rounds) == 1


def test_what_a_sweep_raises_ends_it_and_keeps_what_was_recorded(tmp_path: Path) -> None:
    plan = Plan.parse(
        {"lines": 4, "sweep": {"type": "exposure", "exposures_us": [9.0], "level": 1},
         "camera": {"line_period_us": 99.0}}
    )  # fmt: skip

    def take(_plan: Plan, recording: Path) -> None:
        recording.write_bytes(b"")
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        investigate(take, BenchTime(99.0), plan, tmp_path)
    assert {each.name for each in tmp_path.iterdir()} == {"1.h5", "1.toml"}
    assert Plan.load(tmp_path / "1.toml") == plan


def bench_file(folder: Path) -> Path:
    plain_model(32).save(folder / "model.toml")
    text = f"""
id = "investigate-{abs(hash(str(folder)))}"
[camera]
driver = "mock"
paced = false
[light]
driver = "mock"
tau_s = 0.004
ramp_s = 0.0
[monitor]
driver = "mock"
integration_s = 0.001
[shutter]
driver = "mock"
[simulation]
model = "./model.toml"
lamps = 4
world = "world"
"""
    (folder / "bench.toml").write_text(text)
    return folder / "bench.toml"


def test_a_simulated_bench_needs_no_plan_and_nothing_is_found_where_nothing_is(
    run: Run, tmp_path: Path
) -> None:
    out = tmp_path / "found"
    ran = run("investigate", "--bench", bench_file(tmp_path), "--out", out, "--budget-s", 0,
              "--json", "-")  # fmt: skip
    assert ran.status == 0, ran.stderr
    assert ran.json["outcome"] in {"decided", "budget-spent"}
    assert len(ran.json["rounds"]) == 1
    header = open_recording(out / "1.h5").header
    assert {block.kind for block in header.blocks} == {"dark", "flat"}
    assert len({block.level for block in header.blocks if block.kind == "flat"}) == 3
    world = World(tmp_path / "world")
    assert all(lamp.target == 0 for lamp in world.state().lamps)
    world.close()


def test_the_first_plan_does_not_saturate(tmp_path: Path) -> None:
    settings = BenchSettings.load(bench_file(tmp_path))
    with open_bench(settings) as bench:
        plan = first_plan(bench)
    truth = plain_model(32).truth()
    top = max(plan.exposures_us()) * plan.source.radiance[max(plan.levels())]
    brightest = (truth.dark_offset_dn + truth.responsivity * truth.vignette * top).max()
    assert 0.5 * 4095 < brightest < 0.9 * 4095


def test_a_signal_leaves_the_lamps_off_and_what_was_recorded_in_place(tmp_path: Path) -> None:
    bench, plan = paced_bench_file(tmp_path, paced=True), plan_for_bench(tmp_path, lines=3200)
    out, answer = tmp_path / "out", tmp_path / "answer.json"
    program = "from service.cli import main; main()"
    process = subprocess.Popen(
        [sys.executable, "-c", program, "investigate", "--bench", str(bench), "--plan", str(plan),
         "--out", str(out), "--json", str(answer)], stderr=subprocess.PIPE, text=True,
    )  # fmt: skip
    commits, until = out / "1.frames.jsonl", time.monotonic() + 120
    while not (commits.exists() and commits.read_text().count('"frame"') > 3):
        assert process.poll() is None, process.stderr and process.stderr.read()
        assert time.monotonic() < until
        time.sleep(0.02)
    process.send_signal(signal.SIGTERM)
    _, errors = process.communicate(timeout=120)
    assert process.returncode == 1
    assert json.loads(answer.read_text())["error"]["code"] == "cancelled"
    assert "lamps off" in errors.strip().splitlines()[-1]
    assert commits.read_text().count('"frame"') > 3
    world = World(tmp_path / "world")
    assert all(lamp.target == 0 for lamp in world.state().lamps)
    world.close()


@pytest.mark.soak
@pytest.mark.parametrize("name", CASES)
def test_sixteen_of_twenty_are_settled_by_one_added_sweep(name: str) -> None:
    rng = default_rng()
    drawn = [hidden(CASES[name], rng) for _ in range(20)]
    assert sum(is_settled(investigated(CASES[name], e), e) for e in drawn) >= 16


def test_bad_input_is_told_in_a_sentence(run: Run, tmp_path: Path) -> None:
    bench, out = bench_file(tmp_path), tmp_path / "out"
    out.mkdir()
    (out / "mine").write_text("")
    for arguments, code in (
        (("--bench", bench, "--out", out), "output-exists"),
        (("--bench", tmp_path / "none.toml", "--out", tmp_path / "a"), "bench-unreadable"),
        (("--bench", bench, "--plan", tmp_path / "none.toml", "--out", tmp_path / "b"),
         "plan-unreadable"),
    ):  # fmt: skip
        ran = run("investigate", *arguments, "--json", "-")
        assert (ran.status, ran.error_code) == (1, code), ran.stderr
        assert len(ran.stderr.strip().splitlines()) == 1
    assert not (tmp_path / "a").exists()
    assert not (tmp_path / "b").exists()
