"""Opening the database: SQLite or PostgreSQL, made fit for several writers."""

import sqlite3
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from sqlalchemy import Connection, Engine, create_engine, event
from sqlalchemy.engine import make_url
from sqlalchemy.exc import ArgumentError, NoSuchModuleError
from sqlalchemy.orm import Session

from service.store.database_errors import store_errors
from service.store.errors import StoreError

BUSY_TIMEOUT_MS = 10_000
"""How long a writer waits for another one."""

_WRITES = "darkflat_writes"
_LOCK = int.from_bytes(b"darkflat") >> 1
"""PostgreSQL's advisory locks are known by a number of 63 bits."""
_OPTIONS: dict[str, dict[str, Any]] = {
    # A reader sees one state. A server that was restarted meanwhile is connected to anew.
    "postgresql": {"isolation_level": "REPEATABLE READ", "pool_pre_ping": True},
}


def open_engine(url: str, *, read_only: bool = False) -> Engine:
    """Return an engine for `url`, one that can change nothing where `read_only`.

    Raises:
        StoreError: `bad-store-url`; `no-store` where a file should be that may not be made.
    """
    try:
        parsed = make_url(url)
        engine = create_engine(parsed, **_OPTIONS.get(parsed.get_backend_name(), {}))
    except (ArgumentError, NoSuchModuleError, ImportError, ValueError) as error:  # a port
        msg = (
            "the store's URL cannot be used; write sqlite:////path/to/file, or"
            " postgresql+psycopg://user@host/database"
        )
        raise StoreError(msg, code="bad-store-url") from error
    if parsed.get_backend_name() == "sqlite":
        if parsed.database:
            _make_or_find(Path(parsed.database), read_only=read_only)
        event.listen(engine, "connect", _prepare_to_read if read_only else _prepare)
    elif read_only:
        engine = engine.execution_options(postgresql_readonly=True)
    event.listen(engine, "begin", _begin)
    return engine


def _make_or_find(path: Path, *, read_only: bool) -> None:
    """Make the folder of SQLite's file; where nothing may be made, find the file itself."""
    folder = path.parent
    if read_only and not path.is_file():
        raise StoreError(f"there is no store at {path}; set DARKFLAT_HOME", code="no-store")
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        msg = f"{folder} cannot be made ({error.strerror}); set DARKFLAT_HOME to another folder"
        raise StoreError(msg, code="store-not-writable") from error


def _prepare_to_read(connection: sqlite3.Connection, _record: Any) -> None:
    connection.isolation_level = None
    connection.execute(f"PRAGMA busy_timeout = {BUSY_TIMEOUT_MS}")
    connection.execute("PRAGMA query_only = ON")


def _prepare(connection: sqlite3.Connection, _record: Any) -> None:
    """Leave transactions to `_begin`; survive a crash without losing what was acknowledged."""
    connection.isolation_level = None
    connection.execute(f"PRAGMA busy_timeout = {BUSY_TIMEOUT_MS}")
    _write_ahead(connection)
    connection.execute("PRAGMA synchronous = FULL")
    connection.execute("PRAGMA foreign_keys = ON")


def _write_ahead(connection: sqlite3.Connection) -> None:
    """Switch a new file to its write-ahead log.

    Two that do so at once would wait for each other: SQLite refuses one of them at once, whatever
    the busy timeout.
    """
    deadline_s = time.monotonic() + BUSY_TIMEOUT_MS / 1000
    while True:
        try:
            connection.execute("PRAGMA journal_mode = WAL")
        except sqlite3.OperationalError as error:
            is_busy = error.sqlite_errorcode & 0xFF == sqlite3.SQLITE_BUSY
            if not is_busy or time.monotonic() >= deadline_s:
                raise
            time.sleep(0.01)
        else:
            return


def _begin(connection: Connection) -> None:
    """Let those who mean to write do so one after the other, from their first word on.

    A transaction that reads first and then wants to write fails when another wrote in between;
    one that takes the lock first waits, and what it has read stays true. So nothing has to be
    tried again: on PostgreSQL each statement after the lock sees what the writer before committed.
    """
    writes = connection.get_execution_options().get(_WRITES, False)
    if connection.dialect.name == "sqlite":
        connection.exec_driver_sql("BEGIN IMMEDIATE" if writes else "BEGIN")
    elif writes:
        connection.exec_driver_sql(f"SET LOCAL lock_timeout = {BUSY_TIMEOUT_MS}")
        connection.exec_driver_sql(f"SELECT pg_advisory_xact_lock({_LOCK})")


def writing(engine: Engine) -> Engine:
    """Return `engine` for transactions that write: one after the other."""
    if engine.dialect.name == "sqlite":
        return engine.execution_options(**{_WRITES: True})
    # A snapshot taken at the start would be older than the lock.
    return engine.execution_options(**{_WRITES: True}, isolation_level="READ COMMITTED")


@contextmanager
def reading_session(engine: Engine) -> Iterator[Session]:
    """Give a session that sees one state of the store."""
    with store_errors(), Session(engine) as session:
        yield session


@contextmanager
def writing_session(engine: Engine) -> Iterator[Session]:
    """Give a session whose changes are committed together at the end, or not at all."""
    with (
        store_errors(),
        Session(writing(engine), expire_on_commit=False) as session,
        session.begin(),
    ):
        yield session
