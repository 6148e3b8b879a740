"""Keys open what they may, for as long as they may."""

from datetime import UTC, datetime, timedelta

import pytest
from sqlalchemy import text, update

from calib.errors import InputError
from service.store.actor import Actor
from service.store.engine import reading_session, writing_session
from service.store.errors import NotInStoreError
from service.store.keys import Scope
from service.store.store import Store
from service.store.tables import KeyRow

ROOT = Actor("root")


def later(hours: float) -> datetime:
    return datetime.now(UTC) + timedelta(hours=hours)


def test_a_key_is_known_and_its_secret_is_nowhere(store: Store) -> None:
    assert not store.keys.any()
    record, key = store.keys.create("control PC", Scope.OPERATE, expires_at=later(1), by=ROOT)
    assert store.keys.known(key) == record
    assert store.keys.any()
    secret = key.split("_", 2)[2]
    with reading_session(store._engine) as session:
        rows = [str(row) for table in ("keys", "audit") for row in session.execute(
            text(f"SELECT * FROM {table}")  # noqa: S608
        )]  # fmt: skip
    assert rows
    assert not any(secret in row for row in rows)


@pytest.mark.parametrize("change", ["x", "", "_"])
def test_another_secret_is_not_known(store: Store, change: str) -> None:
    _, key = store.keys.create("pc", Scope.READ, expires_at=None, by=ROOT)
    assert store.keys.known(key[:-1] + change) is None
    assert store.keys.known(key.replace("dfk_", "xxx_")) is None
    assert store.keys.known(key.rpartition("_")[2]) is None
    assert store.keys.known("") is None


def test_a_key_is_over_when_it_expires_or_is_revoked(store: Store) -> None:
    record, key = store.keys.create("pc", Scope.READ, expires_at=later(1), by=ROOT)
    with writing_session(store._engine) as session:
        session.execute(update(KeyRow).values(expires_at=later(-0.001)))
    assert store.keys.known(key) is None
    _, other = store.keys.create("pc", Scope.READ, expires_at=None, by=ROOT)
    revoked = store.keys.revoke(store.keys.list()[1].id, by=ROOT)
    assert store.keys.known(other) is None
    assert store.keys.revoke(revoked.id, by=ROOT) == revoked
    assert store.keys.any()
    assert [each.id for each in store.keys.list()] == [record.id, revoked.id]
    actions = [entry.action for entry in store.audit.list().items]
    assert actions == ["key.revoke", "key.create", "key.create"]


def test_what_makes_no_key(store: Store) -> None:
    with pytest.raises(InputError) as nameless:
        store.keys.create(" ", Scope.READ, expires_at=None, by=ROOT)
    with pytest.raises(InputError) as over:
        store.keys.create("pc", Scope.READ, expires_at=later(-1), by=ROOT)
    with pytest.raises(NotInStoreError):
        store.keys.revoke("0123", by=ROOT)
    assert (nameless.value.code, over.value.code) == ("no-name", "bad-validity")
    assert not store.keys.any()


def test_a_scope_includes_those_below_it() -> None:
    allowed = [[held.includes(wanted) for wanted in Scope] for held in Scope]
    assert allowed == [
        [True, False, False, False],
        [True, True, False, False],
        [True, True, True, False],
        [True, True, True, True],
    ]
