"""Runs on record: the ways they may go, and a journal without gaps."""

from concurrent.futures import ThreadPoolExecutor

import pytest

from service.store.actor import Actor
from service.store.errors import IllegalTransitionError, NotInStoreError, StoreError
from service.store.run_records import MOVES, RunRecord, RunState
from service.store.store import Store

ADA = Actor("ada", "0123456789abcdef")
STEPS: dict[RunState, tuple[RunState, ...]] = {
    "queued": (),
    "running": ("running",),
    "pausing": ("running", "pausing"),
    "paused": ("running", "pausing", "paused"),
    "aborting": ("running", "aborting"),
    "succeeded": ("running", "succeeded"),
    "failed": ("running", "failed"),
    "cancelled": ("cancelled",),
    "interrupted": ("running", "interrupted"),
}


def submitted(store: Store, key: str | None = None, digest: str = "ab") -> RunRecord:
    plan = {"name": "sweep"}
    return store.runs.submit(plan, digest, blocks_total=9, by=ADA, idempotency_key=key)[0]


def brought_to(store: Store, state: RunState) -> RunRecord:
    run = submitted(store)
    for step in STEPS[state]:
        run = store.runs.move(run.id, step)
    return run


@pytest.mark.parametrize("before", STEPS)
def test_a_run_goes_where_it_may_and_nowhere_else(store: Store, before: RunState) -> None:
    for after in STEPS:
        run = brought_to(store, before)
        if before == after:
            assert store.runs.move(run.id, after) == run
        elif after in MOVES[before]:
            assert store.runs.move(run.id, after).state == after
        else:
            with pytest.raises(IllegalTransitionError):
                store.runs.move(run.id, after)
            assert store.runs.get(run.id) == run


def test_the_same_key_and_plan_give_the_same_run_and_another_plan_is_refused(store: Store) -> None:
    first = submitted(store, "key 1")
    again, is_new = store.runs.submit({}, "ab", blocks_total=9, by=ADA, idempotency_key="key 1")
    assert (again, is_new) == (first, False)
    with pytest.raises(StoreError) as other:
        submitted(store, "key 1", digest="cd")
    assert other.value.code == "idempotency-mismatch"
    assert submitted(store, "key 2").id != first.id
    assert submitted(store).id != submitted(store).id


def test_many_who_submit_at_once_with_one_key_get_one_run(store: Store) -> None:
    with ThreadPoolExecutor(8) as pool:
        ids = set(pool.map(lambda _: submitted(store, "key").id, range(24)))
    assert len(ids) == 1


def test_the_journal_has_no_gaps_and_can_be_read_from_any_event_on(store: Store) -> None:
    run = submitted(store)
    other = submitted(store)
    store.runs.move(run.id, "running")
    with ThreadPoolExecutor(4) as pool:
        list(pool.map(
            lambda n: store.runs.progress(run.id, "progress", {"blocks_done": n}), range(9)
        ))  # fmt: skip
    store.runs.progress(other.id, "note", {"text": "waits"})
    numbers = [event.number for event in store.runs.events(run.id)]
    assert numbers == list(range(1, 12))
    assert [e.number for e in store.runs.events(run.id, after=7, limit=3)] == [8, 9, 10]
    assert (
        store.runs.get(run.id).blocks_done == store.runs.events(run.id)[-1].content["blocks_done"]
    )
    assert [event.kind for event in store.runs.events(other.id)] == ["state", "note"]


def test_after_a_crash_what_had_the_bench_is_interrupted_and_can_be_gone_on_with(
    store: Store,
) -> None:
    states: tuple[RunState, ...] = ("running", "paused", "aborting", "queued", "succeeded")
    ids = {state: brought_to(store, state).id for state in states}
    assert store.runs.interrupt_all() == tuple(ids[s] for s in ("running", "paused", "aborting"))
    assert [store.runs.get(ids[s]).state for s in ("queued", "succeeded")] == list(states[3:])
    assert store.runs.interrupt_all() == ()
    again = store.runs.move(ids["running"], "queued", by=ADA)
    assert again.finished_at is None
    assert store.runs.move(again.id, "running").attempts == 2
    assert [e.content["state"] for e in store.runs.events(again.id)] == [
        "queued", "running", "interrupted", "queued", "running",
    ]  # fmt: skip


def test_first_come_first_served_and_one_has_the_bench(store: Store) -> None:
    first, second = submitted(store), submitted(store)
    assert store.runs.next_queued() == first
    assert store.runs.under_way() is None
    running = store.runs.move(first.id, "running")
    assert store.runs.under_way() == running
    assert store.runs.next_queued() == second
    assert [run.id for run in store.runs.list(state="queued").items] == [second.id]


def test_who_asked_is_in_the_audit_log(store: Store) -> None:
    run = submitted(store)
    store.runs.move(run.id, "running")
    store.runs.move(run.id, "aborting", by=ADA)
    entries = store.audit.list().items
    assert [(e.action, e.key_id) for e in entries] == [
        ("run.aborting", ADA.key_id), ("run.submit", ADA.key_id),
    ]  # fmt: skip
    assert entries[0].before == {"state": "running"}


def test_what_is_not_there(store: Store) -> None:
    for ask in (store.runs.get, store.runs.events):
        with pytest.raises(NotInStoreError):
            ask("0123")
