"""The queue goes on, whatever befalls the store or a job."""

import threading
import time
from collections.abc import Callable, Iterator, Mapping
from pathlib import Path
from typing import Any

import pytest

from service.api.jobs import runner as jobs_runner
from service.api.jobs.files import JobFiles
from service.api.jobs.process import Done
from service.api.jobs.runner import JobRunner
from service.api.jobs.scratch import FILES
from service.settings import Settings
from service.store.errors import StoreError
from service.store.jobs import Jobs
from service.store.records import JobRecord
from service.store.store import Store

UNTIL_S = 120.0


class Work:
    """In place of a process: leaves a file behind, and waits to be let go or killed."""

    def __init__(self, _kind: str, request: Mapping[str, Any]) -> None:
        self.scratch = scratch = Path(request["scratch"])
        scratch.mkdir(parents=True)
        (scratch / "half.h5").write_bytes(b"half")
        self._killed = threading.Event()
        self._waits: bool = request["waits"]

    def wait(self, tell: Callable[[float], None]) -> Done:
        if self._waits:
            self._killed.wait(UNTIL_S)
        return Done(error=("worker-died", "")) if self._killed.is_set() else Done(result={})

    def kill(self) -> None:
        self._killed.set()


@pytest.fixture
def store(tmp_path: Path) -> Iterator[Store]:
    with Store.open(Settings(home=tmp_path / "home")) as opened:
        yield opened


@pytest.fixture
def runner(store: Store, monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> Iterator[JobRunner]:
    monkeypatch.setattr(jobs_runner, "JobProcess", Work)
    monkeypatch.setattr(jobs_runner, "_TRY_AGAIN_S", 0.05)
    started = JobRunner(store, JobFiles(tmp_path / "jobs"), max_waiting=9)
    started.start()
    yield started
    monkeypatch.undo()
    started.close()


def kept(_: dict[str, Any]) -> dict[str, Any]:
    return {"kept": True}


@pytest.fixture
def submit(runner: JobRunner, tmp_path: Path) -> Callable[..., JobRecord]:
    def submitted(
        finish: Callable[[dict[str, Any]], dict[str, Any]] = kept, *, waits: bool = False
    ) -> JobRecord:
        scratch = tmp_path / "work" / f"{time.monotonic_ns()}"
        private = {"scratch": str(scratch), "waits": waits}
        return runner.submit("calibrate", {}, private, finish, scratch=scratch)

    return submitted


def reaches(store: Store, job: JobRecord, *states: str) -> JobRecord:
    until = time.monotonic() + UNTIL_S
    while (found := store.jobs.get(job.id)).state not in states:
        assert time.monotonic() < until, found.state
        time.sleep(0.01)
    return found


def test_a_store_that_fails_twice_ends_neither_the_queue_nor_the_wait_for_the_job(
    store: Store, submit: Callable[..., JobRecord], monkeypatch: pytest.MonkeyPatch,
    runner: JobRunner,
) -> None:  # fmt: skip
    finish, refusals = Jobs.finish, iter(range(3))

    def busy(jobs: Jobs, *arguments: Any, **named: Any) -> JobRecord:
        if next(refusals, None) is not None:
            raise StoreError("another process writes; try again", code="store-busy")
        return finish(jobs, *arguments, **named)

    monkeypatch.setattr(Jobs, "finish", busy)
    first = submit()
    failed = reaches(store, first, "failed")
    assert (failed.error_code, failed.error_message) == (
        "store-busy",
        "another process writes; try again",
    )
    reaches(store, submit(), "succeeded")
    runner.check_alive()


def test_a_job_is_either_cancelled_or_its_result_kept_never_both(
    store: Store, submit: Callable[..., JobRecord], runner: JobRunner
) -> None:
    keeping, go_on = threading.Event(), threading.Event()

    def slowly(result: dict[str, Any]) -> dict[str, Any]:
        keeping.set()
        assert go_on.wait(UNTIL_S)
        return kept(result)

    job = submit(slowly)
    assert keeping.wait(UNTIL_S)
    answers: list[JobRecord] = []
    cancelling = threading.Thread(target=lambda: answers.append(runner.cancel(job.id)))
    cancelling.start()
    cancelling.join(0.2)
    go_on.set()
    cancelling.join(UNTIL_S)
    assert answers[0].state == "succeeded"
    assert store.jobs.get(job.id).result == {"kept": True}


def test_a_result_that_comes_after_the_cancellation_is_not_kept(
    store: Store, submit: Callable[..., JobRecord], runner: JobRunner,
    monkeypatch: pytest.MonkeyPatch,
) -> None:  # fmt: skip
    results: list[dict[str, Any]] = []

    def keep(result: dict[str, Any]) -> dict[str, Any]:
        results.append(result)
        return result

    def ended_before_it_was_killed(work: Work, _tell: Callable[[float], None]) -> Done:
        work._killed.wait(UNTIL_S)
        return Done(result={})

    monkeypatch.setattr(Work, "wait", ended_before_it_was_killed)
    job = submit(keep)
    reaches(store, job, "running")
    assert runner.cancel(job.id).state == "cancelled"
    monkeypatch.setattr(Work, "wait", lambda work, tell: Done(result={}))
    reaches(store, submit(), "succeeded")
    assert results == []


@pytest.mark.parametrize(
    ("how", "names"),
    [("succeeded", ["report.html"]), ("failed", ["report.html"]), ("cancelled", [])],
)
def test_files_of_a_job_are_kept_unless_it_was_cancelled(
    store: Store, submit: Callable[..., JobRecord], runner: JobRunner,
    monkeypatch: pytest.MonkeyPatch, *, how: str, names: list[str],
) -> None:  # fmt: skip
    ends = {"succeeded": Done(result={}), "failed": Done(error=("no-flats", "add flats"))}

    def leaving(work: Work, _tell: Callable[[float], None]) -> Done:
        files = work.scratch / FILES
        files.mkdir()
        for name in ("report.html", "half.h5.partial", ".hidden.json"):
            (files / name).write_text("x")
        work._killed.wait(UNTIL_S if work._waits else 0)
        return ends.get(how, Done(error=("worker-died", "")))

    monkeypatch.setattr(Work, "wait", leaving)
    job = submit(waits=how == "cancelled")
    if how == "cancelled":
        reaches(store, job, "running")
        runner.cancel(job.id)
    assert reaches(store, job, how).state == how
    monkeypatch.setattr(Work, "wait", lambda _work, _tell: Done(result={}))
    reaches(store, submit(), "succeeded")  # so the one before is done with
    assert [each.name for each in runner.files.of(job.id)] == names


@pytest.mark.parametrize("how", ["succeeded", "failed", "cancelled"])
def test_nothing_of_a_job_stays_in_the_work_folder(
    store: Store, submit: Callable[..., JobRecord], runner: JobRunner, tmp_path: Path, how: str
) -> None:
    def defect(_: dict[str, Any]) -> dict[str, Any]:
        raise RuntimeError

    job = submit(defect if how == "failed" else kept, waits=how == "cancelled")
    if how == "cancelled":
        reaches(store, job, "running")
        runner.cancel(job.id)
    assert reaches(store, job, how).state == how
    reaches(store, submit(), "succeeded")  # so the one before is done with
    until = time.monotonic() + UNTIL_S
    while left := list((tmp_path / "work").iterdir()):
        assert time.monotonic() < until, left
        time.sleep(0.01)
