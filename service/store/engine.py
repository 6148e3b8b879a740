"""Opening the database: SQLite made fit for several writers, any other by its URL."""

import sqlite3
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from sqlalchemy import Connection, Engine, create_engine, event
from sqlalchemy.engine import make_url
from sqlalchemy.exc import ArgumentError, DatabaseError, NoSuchModuleError, OperationalError
from sqlalchemy.orm import Session

from service.store.errors import StoreError

BUSY_TIMEOUT_MS = 10_000
"""How long a writer waits for another one."""

_WRITES = "darkflat_writes"


def open_engine(url: str) -> Engine:
    """Return an engine for `url`; StoreError `bad-store-url` where there is none."""
    try:
        parsed = make_url(url)
        engine = create_engine(parsed)
    except (ArgumentError, NoSuchModuleError, ImportError) as error:
        msg = f"the store's URL {url!r} cannot be used ({error}); write sqlite:////path/to/file"
        raise StoreError(msg, code="bad-store-url") from error
    if parsed.get_backend_name() == "sqlite":
        if parsed.database:
            _make_folder(Path(parsed.database).parent)
        event.listen(engine, "connect", _prepare)
        event.listen(engine, "begin", _begin)
    return engine


def _make_folder(folder: Path) -> None:
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        msg = f"{folder} cannot be made ({error.strerror}); set DARKFLAT_HOME to another folder"
        raise StoreError(msg, code="store-not-writable") from error


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
    """Take the write lock at once where writing is meant.

    A transaction that reads first and then wants to write fails when another wrote in between;
    one that takes the lock first waits, and what it has read stays true.
    """
    writes = connection.get_execution_options().get(_WRITES, False)
    connection.exec_driver_sql("BEGIN IMMEDIATE" if writes else "BEGIN")


def writing(engine: Engine) -> Engine:
    """Return `engine` for transactions that write: one after the other."""
    if engine.dialect.name == "sqlite":
        return engine.execution_options(**{_WRITES: True})
    return engine.execution_options(isolation_level="SERIALIZABLE")


@contextmanager
def store_errors() -> Iterator[None]:
    """Turn what the database says into one sentence."""
    try:
        yield
    except OperationalError as error:
        text = str(error.orig)
        if "locked" in text or "busy" in text:
            msg = "another process has been writing to the store for too long; try again"
            raise StoreError(msg, code="store-busy") from error
        if "full" in text:
            msg = "no space left for the store; free some, or set DARKFLAT_HOME elsewhere"
            raise StoreError(msg, code="disk-full") from error
        msg = f"the store cannot be used ({text}); look at DARKFLAT_HOME and its rights"
        raise StoreError(msg, code="store-not-writable") from error
    except DatabaseError as error:
        if isinstance(error.orig, sqlite3.DatabaseError) and "not a database" in str(error.orig):
            msg = f"the store's file is not a database ({error.orig}); restore it from a copy"
            raise StoreError(msg, code="store-damaged") from error
        raise


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
