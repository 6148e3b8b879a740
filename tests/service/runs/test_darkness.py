"""After safe-off queued runs wait until somebody wants light; the bench here does as it is told."""

from collections.abc import Callable, Iterator
from pathlib import Path
from typing import cast

import pytest

from drivers.errors import DeviceError
from service.owner.messages import BenchLook, Ended, Measure
from service.owner.owner import BenchOwner, OwnerState
from service.runs.commands import RunCommands
from service.runs.keeper import RunKeeper
from service.sequencer.events import RunResult
from service.settings import Settings
from service.store.actor import Actor
from service.store.store import Store
from tests.service.sequencer.benches import short_plan

ADA, BOB = Actor("ada"), Actor("bob")


class ObedientBench:
    """Stands in for the bench's process; a run ends when it is told to."""

    bench_id = "obedient"

    def __init__(self) -> None:
        self.state: OwnerState = "closed"
        self.begun: list[str] = []
        self.aborted: list[str] = []
        self.while_measuring: Callable[[], object] = int
        self.is_silent = False
        self.listener: Callable[[Ended], None]

    def open(self) -> None:
        self.state = "idle"

    def close(self) -> None:
        self.state = "closed"

    def measure(self, wanted: Measure) -> None:
        self.state = "busy"
        self.begun.append(wanted.run_id)
        self.while_measuring()

    def abort(self) -> None:
        self.aborted.append(self.begun[-1])

    def end(self) -> None:
        self.state = "idle"
        ended = RunResult("cancelled", Path("run.h5"), 0, 4, (), 0, 0, (), 0.0)
        self.listener(Ended(self.begun[-1], result=ended))

    def safe_off(self) -> BenchLook:
        if self.is_silent:
            raise DeviceError("look at the lamps", device="obedient", code="bench-silent")
        return BenchLook(self.bench_id, ())


class Bench:
    """A keeper that looks for work when the test says so, and those who ask it."""

    def __init__(self, store: Store, folder: Path) -> None:
        self.owner = ObedientBench()
        self.keeper = RunKeeper(store, cast("BenchOwner", self.owner), folder)
        self.commands = RunCommands(store, self.keeper)
        self.owner.open()

    def submit(self) -> str:
        return self.commands.submit(short_plan(), ADA, idempotency_key=None)[0].id

    def look_for_work(self) -> list[str]:
        self.keeper._look_for_work()
        return self.owner.begun


@pytest.fixture
def store(tmp_path: Path) -> Iterator[Store]:
    with Store.open(Settings(home=tmp_path / "home")) as opened:
        yield opened


@pytest.fixture
def bench(store: Store, tmp_path: Path) -> Bench:
    return Bench(store, tmp_path)


def test_a_queued_run_begins_only_once_the_bench_is_released(bench: Bench) -> None:
    runs = [bench.submit(), bench.submit()]
    assert bench.look_for_work() == runs[:1]
    bench.commands.safe_off(BOB)
    bench.owner.end()
    assert bench.look_for_work() == runs[:1]
    bench.commands.release(ADA)
    assert bench.look_for_work() == runs


def test_who_asks_for_a_run_or_resumes_one_wants_light(bench: Bench) -> None:
    runs = [bench.submit(), bench.submit()]
    bench.commands.safe_off(BOB)
    assert bench.commands.submit(short_plan(), ADA, idempotency_key="once")[1]
    assert bench.look_for_work() == runs[:1]
    bench.commands.safe_off(BOB)
    bench.owner.end()
    assert not bench.commands.submit(short_plan(), ADA, idempotency_key="once")[1]
    assert bench.look_for_work() == runs[:1]
    bench.commands.resume(runs[0], ADA)
    assert bench.keeper.darkness.kept is None


def test_another_service_goes_on_keeping_the_bench_dark_and_stays_released(
    bench: Bench, store: Store, tmp_path: Path
) -> None:
    run = bench.submit()
    bench.commands.safe_off(BOB)
    (pressed,) = store.audit.list().items[:1]
    second = Bench(store, tmp_path)
    kept = second.keeper.darkness.kept
    assert kept is not None
    assert (kept.by, kept.since) == ("bob", pressed.at)
    assert second.look_for_work() == []
    second.commands.release(ADA)
    assert Bench(store, tmp_path).look_for_work() == [run]


def test_another_bench_of_the_store_is_not_kept_dark(store: Store, tmp_path: Path) -> None:
    store.audit.record(BOB, "bench.safe-off", "another bench")
    assert Bench(store, tmp_path).keeper.darkness.kept is None


def test_a_run_that_is_given_the_bench_while_safe_off_is_pressed_is_ended(bench: Bench) -> None:
    run = bench.submit()
    bench.owner.while_measuring = lambda: bench.commands.safe_off(BOB)
    assert bench.look_for_work() == [run]
    assert bench.owner.aborted == [run]


def test_a_bench_that_does_not_answer_is_kept_dark_all_the_same(bench: Bench, store: Store) -> None:
    bench.owner.is_silent = True
    bench.submit()
    with pytest.raises(DeviceError, match="look at the lamps"):
        bench.commands.safe_off(BOB)
    assert bench.look_for_work() == []
    assert "bench.safe-off" in [each.action for each in store.audit.list().items]


def test_who_presses_again_while_the_bench_is_released_keeps_it_dark(
    bench: Bench, store: Store, monkeypatch: pytest.MonkeyPatch
) -> None:
    bench.submit()
    bench.commands.safe_off(BOB)
    record = store.audit.record

    def pressed_meanwhile(by: Actor, action: str, subject: str, **states: object) -> None:
        record(by, action, subject, **states)
        bench.keeper.darkness.begin(BOB)

    monkeypatch.setattr(store.audit, "record", pressed_meanwhile)
    bench.commands.release(ADA)
    assert bench.look_for_work() == []


def test_a_bench_that_is_not_kept_dark_is_released_without_an_entry(
    bench: Bench, store: Store
) -> None:
    bench.commands.release(ADA)
    assert store.audit.list().items == ()
