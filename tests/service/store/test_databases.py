"""Where a store may be, and what its database says when it cannot be used."""

from collections.abc import Callable
from pathlib import Path

import pytest
from sqlalchemy import NullPool, create_engine, text

from calib.errors import DarkflatError, InputError
from service.settings import Settings
from service.store.actor import Actor
from service.store.engine import reading_session, writing_session
from service.store.errors import StoreError
from service.store.keys import Scope
from service.store.state import SetState
from service.store.store import Store
from tests.service.store.a_store import a_set

OpenStore = Callable[[], Store]


def test_sqlite_is_set_up_for_several_writers(tmp_path: Path) -> None:
    with (
        Store(f"sqlite:///{tmp_path / 'store.sqlite3'}", tmp_path / "sets") as store,
        reading_session(store._engine) as session,
    ):
        answers = {
            name: session.scalar(text(f"PRAGMA {name}"))
            for name in ("journal_mode", "foreign_keys", "synchronous", "busy_timeout")
        }
    assert answers == {
        "journal_mode": "wal", "foreign_keys": 1, "synchronous": 2, "busy_timeout": 10_000,
    }  # fmt: skip


@pytest.mark.parametrize("unkept", ["half \ud800 of a pair", "nul \0"])
def test_what_a_database_cannot_hold_is_refused_in_a_sentence_and_leaves_nothing(
    store: Store, url: str, unkept: str
) -> None:
    if "\0" in unkept and url.startswith("sqlite"):
        return  # it keeps such a text
    for ask in (
        lambda: store.keys.create(unkept, Scope.READ, expires_at=None, by=Actor("ada")),
        lambda: store.audit.record(Actor("ada"), "note", unkept),
        lambda: store.sets.list(serial=unkept),
    ):
        with pytest.raises(InputError) as refused:
            ask()
        assert refused.value.code == "not-storable"
    assert store.audit.verify()[0] == 0


def test_a_server_that_is_not_there_is_named_without_its_password(tmp_path: Path) -> None:
    for url, code in (
        (f"postgresql+psycopg://ada:s3cret@/store?host={tmp_path}", "store-not-writable"),
        ("postgresql+nonsense://ada:s3cret@localhost/store", "bad-store-url"),
        ("postgresql+psycopg://ada:s3cret@localhost:port/store", "bad-store-url"),
    ):
        with pytest.raises(StoreError) as refused:
            Store(url, tmp_path / "sets")
        assert refused.value.code == code
        assert "s3cret" not in str(refused.value)


def test_a_server_that_was_restarted_is_connected_to_anew(store: Store, url: str) -> None:
    """What is told to a store that lost its connections is kept all the same."""
    store.audit.record(Actor("ada"), "note", "before")
    if url.startswith("postgresql"):
        with create_engine(url, poolclass=NullPool).connect() as other:
            other.execute(text(
                "SELECT pg_terminate_backend(pid) FROM pg_stat_activity"
                " WHERE datname = current_database() AND pid <> pg_backend_pid()"
            ))  # fmt: skip
    store.audit.record(Actor("ada"), "note", "after")
    assert store.audit.verify()[0] == 2


def test_bad_places_are_named(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    (tmp_path / "junk.sqlite3").write_bytes(b"this is no database, whatever its name says" * 99)
    for url, code in (
        ("nonsense", "bad-store-url"),
        ("mysterysql://x/y", "bad-store-url"),
        (f"sqlite:///{tmp_path}/file/store.sqlite3", "store-not-writable"),
        (f"sqlite:///{tmp_path}/junk.sqlite3", "store-damaged"),
    ):
        with pytest.raises(StoreError) as refused:
            Store(url, tmp_path / "sets")
        assert refused.value.code == code, url


def test_a_writer_that_waits_too_long_says_so(
    open_store: OpenStore, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("service.store.engine.BUSY_TIMEOUT_MS", 50)
    with open_store() as store, open_store() as other:
        with writing_session(other._engine) as session:
            session.execute(text("SELECT 1"))
            with pytest.raises(StoreError) as refused:
                store.sets.add(a_set(), by=Actor("ada"))
        assert refused.value.code == "store-busy"
        assert store.sets.add(a_set(), by=Actor("ada")).state is SetState.DRAFT


def test_the_settings_say_where_the_store_is(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("DARKFLAT_HOME", str(tmp_path))
    assert Settings.load().url == f"sqlite:///{tmp_path}/store.sqlite3"
    with Store.open(Settings.load()) as store:
        store.check_writable()
    monkeypatch.setenv("DARKFLAT_PORT", "many")
    with pytest.raises(DarkflatError, match="DARKFLAT_PORT"):
        Settings.load()
