"""Several writers, deaths in the middle, other versions, bad places."""

import os
import signal
import sqlite3
import subprocess
import sys
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import pytest
from alembic import command
from alembic.autogenerate import compare_metadata
from alembic.migration import MigrationContext
from alembic.script import ScriptDirectory
from sqlalchemy import text

from calib.errors import DarkflatError
from service.store.actor import Actor
from service.store.engine import _prepare, open_engine, writing, writing_session
from service.store.errors import OverlapError, StoreError
from service.store.migrate import HEAD, MIGRATIONS, alembic_config, migrate
from service.store.state import SetState
from service.store.store import Store
from service.store.tables import Base, SetRow
from tests.service.store.a_store import SETTING, a_set, certified, day, verified

OpenStore = Callable[[], Store]
EMPTY = pytest.mark.parametrize("url", ["sqlite", "postgresql-empty"], indirect=True)
"""Where a store is yet to be made, or is spoilt."""


def test_of_two_writers_that_certify_for_the_same_time_one_is_refused(
    open_store: OpenStore,
) -> None:
    with open_store() as one, open_store() as two:
        ids = [verified(one, a_set(30.0)).id, verified(two, a_set(31.0)).id]

        def certify(store: Store, set_id: str) -> bool:
            try:
                store.sets.certify(
                    set_id, valid_from=day(1), valid_until=None, by=Actor("ada"), reason="due"
                )
            except OverlapError:
                return False
            return True

        with ThreadPoolExecutor(2) as pool:
            done = list(pool.map(certify, (one, two), ids))
        assert sorted(done) == [False, True]
        assert one.sets.lookup(**SETTING, at=day(2)).id == ids[done.index(True)]


def test_writers_wait_for_each_other(open_store: OpenStore) -> None:
    with open_store() as one, open_store() as two:

        def add(i: int) -> str:
            return (one if i % 2 else two).sets.add(a_set(float(i)), by=Actor("ada")).id

        with ThreadPoolExecutor(4) as pool:
            added = set(pool.map(add, range(12)))
        assert {record.id for record in one.sets.list().items} == added


def test_the_database_survives_what_kills_its_writer(
    open_store: OpenStore, url: str, tmp_path: Path
) -> None:
    """SIGKILL inside the transaction that certifies: after it, nothing of it is there."""
    with open_store() as store:
        old = certified(store, a_set(30.0), day(1))
        new = verified(store, a_set(31.0))
    script = f"""
import os, signal
from datetime import datetime, UTC
from pathlib import Path
from sqlalchemy import event
from sqlalchemy.orm import Session
from service.store.actor import Actor
from service.store.store import Store
store = Store("{url}", Path("{tmp_path}/sets"))
event.listen(Session, "before_commit", lambda session: os.kill(os.getpid(), signal.SIGKILL))
store.sets.certify("{new.id}", valid_from=datetime(2026, 5, 1, tzinfo=UTC), valid_until=None,
                   by=Actor("ada"), reason="due", supersedes=["{old.id}"])
"""
    died = subprocess.run([sys.executable, "-c", script], cwd=Path.cwd(), check=False)
    assert died.returncode == -signal.SIGKILL
    with open_store() as store:
        assert store.sets.get(new.id) == new
        assert store.sets.get(old.id) == old
        assert store.sets.lookup(**SETTING, at=day(6)).id == old.id
        store.sets.certify(
            new.id,
            valid_from=day(5),
            valid_until=None,
            by=Actor("a"),
            reason="d",
            supersedes=[old.id],
        )


def test_an_error_inside_a_transaction_undoes_all_of_it(store: Store) -> None:
    record = store.sets.add(a_set(), by=Actor("ada"))

    def fail_half_way() -> None:
        with writing_session(store._engine) as session:
            session.query(SetRow).one().state = SetState.REVOKED.value
            session.flush()
            raise ZeroDivisionError

    with pytest.raises(ZeroDivisionError):
        fail_half_way()
    assert store.sets.get(record.id) == record


def test_a_file_that_cannot_be_written_leaves_no_record(
    open_store: OpenStore, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def full(*_: object) -> None:
        raise OSError(28, "No space left on device")

    with open_store() as store:
        monkeypatch.setattr(os, "fsync", full)
        with pytest.raises(DarkflatError):
            store.sets.add(a_set(), by=Actor("ada"))
        monkeypatch.undo()
        assert store.sets.list().items == ()
        assert list((tmp_path / "sets").iterdir()) == []


def test_the_migrations_make_the_schema_that_the_tables_describe(store: Store) -> None:
    with store._engine.connect() as connection:
        differences = compare_metadata(MigrationContext.configure(connection), Base.metadata)
    assert differences == []
    assert ScriptDirectory(str(MIGRATIONS)).get_current_head() == HEAD


def test_sets_of_an_older_store_keep_the_region_that_they_were_taken_for(
    open_store: OpenStore,
) -> None:
    with open_store() as store:
        kept = certified(store, a_set(), day(1))
        with writing(store._engine).begin() as connection:
            command.downgrade(alembic_config(connection), "0001")
    with open_store() as store:
        assert store.sets.get(kept.id) == kept
        assert kept.region == "0:32"


@EMPTY
def test_two_processes_may_migrate_at_once(url: str) -> None:
    engines = [open_engine(url) for _ in range(2)]
    with ThreadPoolExecutor(2) as pool:
        list(pool.map(migrate, engines))
    for engine in engines:
        engine.dispose()


class Contended(sqlite3.Connection):
    """Refused the write-ahead log twice, as SQLite does to the later of two who ask at once."""

    refusals = 2

    def execute(self, statement: str) -> sqlite3.Cursor:  # type: ignore[override]
        if "journal_mode" in statement and self.refusals:
            self.refusals -= 1
            error = sqlite3.OperationalError("database is locked")
            error.sqlite_errorcode = sqlite3.SQLITE_BUSY
            raise error
        return super().execute(statement)


def test_several_may_open_a_new_store_at_once(tmp_path: Path) -> None:
    connection = sqlite3.connect(tmp_path / "store.sqlite3", factory=Contended)
    _prepare(connection, None)
    assert connection.refusals == 0
    assert connection.execute("PRAGMA journal_mode").fetchone() == ("wal",)
    connection.close()


@EMPTY
def test_a_store_of_a_newer_version_is_refused(open_store: OpenStore) -> None:
    with open_store() as store, writing_session(store._engine) as session:
        session.execute(text("UPDATE alembic_version SET version_num = '9999'"))
    with pytest.raises(StoreError) as refused:
        open_store()
    assert refused.value.code == "store-too-new"


def test_a_certification_of_an_unknown_set_violates_the_schema(store: Store) -> None:
    statement = (
        "INSERT INTO transitions (set_id, after, at, by, reason)"
        " VALUES ('nobody', 'draft', '2026-01-01 00:00:00.000000', 'a', 'b')"
    )
    with (
        pytest.raises(Exception, match=r"(?i)foreign key"),
        writing_session(store._engine) as session,
    ):
        session.execute(text(statement))
