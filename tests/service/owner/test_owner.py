"""The bench in a process of its own: runs, pauses, safe-off, and deaths on either side."""

import os
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest

from calib.errors import DarkflatError
from drivers.mock.world import World
from service.bench import BenchSettings, open_bench
from service.owner.messages import Ended, Measure, Opened, Report, Said, Seen, Waiting
from service.owner.owner import BenchOwner
from service.plan.model import Plan
from tests.service.owner.serving import slow_plan
from tests.service.sequencer.benches import in_process, short_plan, whole_blocks

ALL = {"000": 32, "001": 32, "002": 32, "003": 32}


class Heard:
    """Keeps what the bench's process reports."""

    def __init__(self) -> None:
        self.reports: list[Report] = []
        self._changed = threading.Condition()

    def __call__(self, report: Report) -> None:
        with self._changed:
            self.reports.append(report)
            self._changed.notify_all()

    def until(self, wanted: Callable[[Report], bool], within_s: float = 60.0) -> Report:
        with self._changed:
            self._changed.wait_for(lambda: any(map(wanted, self.reports)), within_s)
            return next(filter(wanted, self.reports))

    def ended(self, run_id: str) -> Ended:
        report = self.until(lambda r: isinstance(r, Ended) and r.run_id == run_id)
        assert isinstance(report, Ended)
        return report


@pytest.fixture
def settings(request: pytest.FixtureRequest, tmp_path: Path) -> BenchSettings:
    name = f"{os.getpid()}-{abs(hash(request.node.nodeid))}"
    return in_process(name, tmp_path / "world.json")


@pytest.fixture
def heard() -> Heard:
    return Heard()


@pytest.fixture
def owner(settings: BenchSettings, heard: Heard) -> Iterator[BenchOwner]:
    owner = BenchOwner(settings, heard)
    owner.open()
    try:
        heard.until(lambda _: True)
        yield owner
    finally:
        owner.close()


def measure(owner: BenchOwner, out: Path, plan: Plan | None = None, run_id: str = "r") -> None:
    owner.measure(Measure(run_id, (plan or short_plan()).model_dump(mode="json"), out))


def test_a_run_is_recorded_and_its_progress_and_columns_are_told(
    owner: BenchOwner, heard: Heard, tmp_path: Path
) -> None:
    out = tmp_path / "a.h5"
    measure(owner, out)
    ended = heard.ended("r")
    assert ended.result is not None
    assert ended.result.state == "succeeded"
    assert whole_blocks(out) == ALL
    seen = [r for r in heard.reports if isinstance(r, Seen)]
    assert [r.block for r in seen] == [b for b in ALL for _ in range(4)]
    assert all(r.mean_dn.shape == (32,) for r in seen)
    assert owner.state == "idle"


def test_one_run_at_a_time_and_the_next_when_the_bench_is_free(
    owner: BenchOwner, heard: Heard, tmp_path: Path
) -> None:
    measure(owner, tmp_path / "a.h5", slow_plan())
    with pytest.raises(DarkflatError) as refused:
        measure(owner, tmp_path / "b.h5", run_id="s")
    assert refused.value.code == "bench-not-ready"
    owner.abort()
    heard.ended("r")
    measure(owner, tmp_path / "b.h5", run_id="s")
    assert heard.ended("s").result is not None


def test_pause_and_resume(owner: BenchOwner, heard: Heard, tmp_path: Path) -> None:
    measure(owner, tmp_path / "a.h5", slow_plan())
    heard.until(lambda r: isinstance(r, Said) and "steady" in r.progress.doing)
    owner.pause()
    heard.until(lambda r: isinstance(r, Said) and r.progress.state == "paused")
    look = owner.look_now()
    assert look.devices[1].values["level"] == 0.0
    owner.resume()
    ended = heard.ended("r")
    assert ended.result is not None
    assert whole_blocks(tmp_path / "a.h5") == ALL


def test_safe_off_ends_a_run_and_reads_every_lamp_back(
    owner: BenchOwner, heard: Heard, tmp_path: Path
) -> None:
    measure(owner, tmp_path / "a.h5", slow_plan())
    heard.until(lambda r: isinstance(r, Said) and "steady" in r.progress.doing)
    look = owner.safe_off()
    light = next(device for device in look.devices if device.role == "light")
    assert light.trouble is None
    assert [light.values[f"lamp_{n}_on"] for n in (1, 2, 3)] == [False] * 3
    ended = heard.ended("r")
    assert ended.result is not None
    assert ended.result.state == "cancelled"


def test_what_a_run_is_refused_for_is_told_with_its_code(
    owner: BenchOwner, heard: Heard, tmp_path: Path
) -> None:
    measure(owner, tmp_path / "a.h5", short_plan(camera={"line_period_us": 1e3, "serial": "X"}))
    trouble = heard.ended("r").trouble
    assert trouble is not None
    assert trouble.code == "wrong-camera"
    assert owner.state == "idle"


def test_a_bench_that_somebody_has_says_who_and_is_opened_once_they_let_go(
    settings: BenchSettings, heard: Heard
) -> None:
    owner = BenchOwner(settings, heard)
    with open_bench(settings):
        owner.open()
        heard.until(lambda r: isinstance(r, Waiting))
        with pytest.raises(DarkflatError, match=str(os.getpid())) as busy:
            owner.look_now()
        assert busy.value.code == "bench-busy"
    heard.until(lambda r: isinstance(r, Opened))
    assert owner.look_now().devices[1].values["level"] == 0.0
    owner.close()


def test_who_waits_for_a_bench_need_not_get_it_to_be_closed(
    settings: BenchSettings, heard: Heard, caplog: pytest.LogCaptureFixture
) -> None:
    owner = BenchOwner(settings, heard)
    with open_bench(settings):
        owner.open()
        heard.until(lambda r: isinstance(r, Waiting))
        owner.close()
        assert owner.state == "closed"
    assert "killed" not in caplog.text


def test_a_process_that_is_killed_ends_its_run_and_opened_again_the_lamps_are_off(
    owner: BenchOwner, heard: Heard, tmp_path: Path, settings: BenchSettings
) -> None:
    measure(owner, tmp_path / "a.h5", slow_plan())
    heard.until(lambda r: isinstance(r, Said) and "steady" in r.progress.doing)
    assert owner.pid is not None
    os.kill(owner.pid, signal.SIGKILL)
    trouble = heard.ended("r").trouble
    assert trouble is not None
    assert trouble.code == "bench-process-died"
    with pytest.raises(DarkflatError):
        owner.look_now()
    heard.reports.clear()
    owner.open()
    heard.until(lambda _: True)
    assert owner.look_now().devices[1].values["level"] == 0.0


def test_closed_it_has_heard_the_end_of_its_run_and_of_its_process(
    owner: BenchOwner, heard: Heard, tmp_path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    measure(owner, tmp_path / "a.h5", slow_plan())
    heard.until(lambda r: isinstance(r, Said) and "steady" in r.progress.doing)
    pid = owner.pid
    owner.close()
    assert owner.state == "closed"
    assert [r.run_id for r in heard.reports if isinstance(r, Ended)] == ["r"]
    assert not Path(f"/proc/{pid}").exists()
    assert "killed" not in caplog.text


def test_a_process_that_does_not_end_is_killed_and_one_that_has_ended_is_not(
    owner: BenchOwner, caplog: pytest.LogCaptureFixture, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("service.owner.owner._CLOSE_S", 0.2)
    pid = owner.pid
    assert pid is not None
    os.kill(pid, signal.SIGSTOP)
    owner.close()
    assert not Path(f"/proc/{pid}").exists()
    assert owner.state == "closed"
    assert caplog.text.count("it is killed") == 1
    owner.close()
    assert caplog.text.count("it is killed") == 1


def test_where_the_service_is_killed_the_lamps_go_off_by_themselves(tmp_path: Path) -> None:
    world = tmp_path / "world.json"
    command = [sys.executable, "-m", "tests.service.owner.serving", f"orphan-{os.getpid()}"]
    with subprocess.Popen(
        [*command, world, tmp_path / "a.h5"],
        stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True,
    ) as service:  # fmt: skip
        assert service.stdout is not None
        pid = int(service.stdout.readline())
        assert service.stdout.readline() == "lit\n"
        assert any(lamp.target for lamp in World(world).state().lamps)
        service.kill()
    until = time.monotonic() + 10.0
    while Path(f"/proc/{pid}").exists() and time.monotonic() < until:
        time.sleep(0.05)
    assert not Path(f"/proc/{pid}").exists()
    assert not any(lamp.target for lamp in World(world).state().lamps)
