"""The audit log is whole, or says where it is not."""

from concurrent.futures import ThreadPoolExecutor

import pytest
from sqlalchemy import text

from service.store.actor import Actor
from service.store.audit import START
from service.store.engine import writing_session
from service.store.errors import OverlapError, StoreError
from service.store.store import Store
from tests.service.store.a_store import a_set, certified, day, verified

ADA = Actor("ada", "0123456789abcdef")
CHANGES = {
    "a name": "UPDATE audit SET who = 'eve' WHERE number = 3",
    "a state": 'UPDATE audit SET after = \'{"state": "certified"}\' WHERE number = 2',
    "a time": "UPDATE audit SET at = '2020-01-01 00:00:00.000000' WHERE number = 4",
    "an entry gone": "DELETE FROM audit WHERE number = 3",
    "two exchanged": "UPDATE audit SET number = CASE number WHEN 2 THEN -3 ELSE 2 END"
    " WHERE number IN (2, 3)",
}


def filled(store: Store) -> None:
    for n in range(5):
        store.audit.record(ADA, "bench.safe-off", f"bench {n}", after={"level": n})


def test_an_empty_log_is_whole(store: Store) -> None:
    assert store.audit.verify() == (0, START)


def test_each_step_of_a_set_is_in_the_log_with_who_and_how_it_was(store: Store) -> None:
    record = certified(store, a_set(), day(1))
    entries = store.audit.list().items
    assert [each.action for each in reversed(entries)] == [
        "coefficient-set.draft", "coefficient-set.verified", "coefficient-set.certified",
    ]  # fmt: skip
    last = entries[0]
    assert (last.who, last.subject, last.before) == ("grace", record.id, {"state": "verified"})
    assert store.audit.verify() == (3, last.digest)


def test_what_is_refused_leaves_no_entry(store: Store) -> None:
    certified(store, a_set(30.0), day(1))
    second = verified(store, a_set(31.0))
    before = store.audit.verify()
    with pytest.raises(OverlapError):
        store.sets.certify(
            second.id, valid_from=day(2), valid_until=None, by=ADA, reason="a second one"
        )
    assert store.audit.verify() == before


@pytest.mark.parametrize("change", CHANGES.values(), ids=CHANGES)
def test_a_changed_log_is_found(store: Store, change: str) -> None:
    filled(store)
    assert store.audit.verify()[0] == 5
    with writing_session(store._engine) as session:
        session.execute(text(change))
        session.execute(text("UPDATE audit SET number = 3 WHERE number = -3"))
    with pytest.raises(StoreError) as broken:
        store.audit.verify()
    assert broken.value.code == "audit-broken"


def test_an_end_cut_off_shows_in_the_last_digest_alone(store: Store) -> None:
    filled(store)
    number, digest = store.audit.verify()
    with writing_session(store._engine) as session:
        session.execute(text("DELETE FROM audit WHERE number = 5"))
    assert store.audit.verify() == (number - 1, store.audit.list().items[0].digest)
    assert store.audit.verify()[1] != digest


def test_a_digest_that_was_written_down_proves_the_log_up_to_it(store: Store) -> None:
    filled(store)
    earlier = store.audit.verify()[1]
    store.audit.record(ADA, "bench.safe-off", "bench")
    assert store.audit.verify(expect=earlier)[0] == 6
    assert store.audit.verify(expect=START)[0] == 6
    with writing_session(store._engine) as session:
        session.execute(text("DELETE FROM audit WHERE number >= 5"))
    with pytest.raises(StoreError) as cut:
        store.audit.verify(expect=earlier)
    assert cut.value.code == "audit-cut-off"


def test_pages_of_the_log_follow_each_other(store: Store) -> None:
    filled(store)
    first = store.audit.list(limit=3)
    second = store.audit.list(limit=3, before=first.next_before)
    assert [e.number for e in (*first.items, *second.items)] == [5, 4, 3, 2, 1]
    assert second.next_before is None


def test_many_writers_make_one_chain(store: Store) -> None:
    with ThreadPoolExecutor(8) as pool:
        list(pool.map(lambda n: store.audit.record(ADA, "run.submit", f"{n}"), range(40)))
    assert store.audit.verify()[0] == 40
    assert [e.number for e in store.audit.list().items] == list(range(40, 0, -1))
