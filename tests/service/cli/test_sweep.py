"""`sweep` on a bench without transport; stopped by Ctrl-C in a process of its own."""

import json
import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path

import pytest

from calib.recording.open import open_recording
from drivers.mock.world import World
from tests.service.cli.answers import Ran
from tests.service.cli.benches import bench_file, plan_for_bench

Run = Callable[..., Ran]


def test_a_sweep_records_every_block(run: Run, tmp_path: Path) -> None:
    plan, out = plan_for_bench(tmp_path), tmp_path / "rec.h5"
    ran = run("sweep", plan, "--out", out, "--bench", bench_file(tmp_path), "--json", "-")
    assert ran.status == 0, ran.stderr
    assert ran.json["state"] == "succeeded"
    assert (ran.json["blocks_done"], ran.json["blocks_total"]) == (9, 9)
    assert len(open_recording(out).header.blocks) == 9


def test_the_bench_beside_is_taken_where_none_is_named(
    run: Run, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    plan = plan_for_bench(tmp_path)
    bench_file(tmp_path)
    monkeypatch.chdir(tmp_path)
    ran = run("sweep", plan, "--out", tmp_path / "rec.h5")
    assert ran.status == 0
    assert "simulated bench" not in ran.stderr


def test_a_recording_that_is_there_is_not_overwritten(run: Run, tmp_path: Path) -> None:
    plan, bench, out = plan_for_bench(tmp_path), bench_file(tmp_path), tmp_path / "rec.h5"
    run("sweep", plan, "--out", out, "--bench", bench)
    before = out.read_bytes()
    ran = run("sweep", plan, "--out", out, "--bench", bench, "--json", "-")
    assert (ran.status, ran.error_code) == (1, "output-exists")
    assert "--resume" in ran.stderr
    assert out.read_bytes() == before


def test_a_recording_that_is_there_is_refused_before_the_bench_is_opened(
    run: Run, tmp_path: Path
) -> None:
    plan, out = plan_for_bench(tmp_path), tmp_path / "rec.h5"
    out.touch()
    ran = run("sweep", plan, "--out", out, "--bench", tmp_path / "none.toml", "--json", "-")
    assert (ran.status, ran.error_code) == (1, "output-exists")


def test_a_dry_run_knows_how_many_lamps_the_bench_has(run: Run, tmp_path: Path) -> None:
    plan, bench = plan_for_bench(tmp_path), bench_file(tmp_path)
    assert run("sweep", plan, "--dry-run", "--bench", bench).status == 0
    bench.write_text(bench.read_text().replace("[simulation]", "[simulation]\nlamps = 1"))
    ran = run("sweep", plan, "--dry-run", "--bench", bench, "--json", "-")
    assert (ran.status, ran.error_code) == (1, "level-out-of-range")


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_a_sweep_that_is_stopped_leaves_the_lamps_off_and_can_go_on(
    tmp_path: Path, number: int
) -> None:
    plan, bench = plan_for_bench(tmp_path, lines=3200), bench_file(tmp_path, paced=True)
    out, answer = tmp_path / "rec.h5", tmp_path / "answer.json"
    program = "import signal; signal.signal(signal.SIGINT, signal.default_int_handler);"
    program += "from service.cli import main; main()"
    command = [
        sys.executable, "-c", program, "sweep", str(plan), "--out", str(out),
        "--bench", str(bench), "--json", str(answer),
    ]  # fmt: skip
    process = subprocess.Popen(command, stderr=subprocess.PIPE, text=True)
    commits = tmp_path / "rec.frames.jsonl"
    until = time.monotonic() + 120
    while not (commits.exists() and commits.read_text().count('"frame"') > 3):
        assert process.poll() is None, process.stderr and process.stderr.read()
        assert time.monotonic() < until
        time.sleep(0.02)
    process.send_signal(number)
    _, errors = process.communicate(timeout=120)
    assert process.returncode == 1
    assert json.loads(answer.read_text())["error"]["code"] == "cancelled"
    assert "lamps off" in errors.strip().splitlines()[-1]
    world = World(tmp_path / "world")
    assert all(lamp.target == 0 for lamp in world.state().lamps)
    world.close()
    resumed = subprocess.run(
        [*command, "--resume"], env=dict(os.environ), check=False, capture_output=True, text=True
    )
    assert resumed.returncode == 0, resumed.stderr
    assert json.loads(answer.read_text())["blocks_done"] == 9
