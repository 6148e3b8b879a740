"""Stores on SQLite and on PostgreSQL, for all tests that hold on both."""

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import pytest
from sqlalchemy import Engine, NullPool, create_engine, text

from service.store.store import Store
from service.store.tables import Base
from tests.service.store.postgresql import programs, server

_STORE, _EMPTY = "store", "empty"
_TABLES = ", ".join(Base.metadata.tables)


@dataclass(frozen=True)
class Server:
    """A PostgreSQL server with one store."""

    url: str
    engine: Engine

    def url_of(self, database: str) -> str:
        return self.url.format(name=database)

    def do(self, statement: str) -> None:
        with self.engine.connect() as connection:
            connection.execute(text(statement))


@pytest.fixture(scope="session")
def postgresql() -> Iterator[Server]:
    """One server for all tests."""
    bin_folder = programs()
    if bin_folder is None:
        pytest.skip("PostgreSQL is not installed: docker/install-system.sh")
    with server(bin_folder) as url:
        admin = create_engine(url.format(name="postgres"), isolation_level="AUTOCOMMIT")
        Server(url, admin).do(f"CREATE DATABASE {_STORE}")
        admin.dispose()
        engine = create_engine(
            url.format(name=_STORE), isolation_level="AUTOCOMMIT", poolclass=NullPool
        )
        Store(url.format(name=_STORE), Path("sets")).close()
        yield Server(url, engine)


@pytest.fixture(params=["sqlite", "postgresql"])
def url(request: pytest.FixtureRequest, tmp_path: Path) -> Iterator[str]:
    """Where a store will be, or one without content: making one on PostgreSQL takes time."""
    if request.param == "sqlite":
        yield f"sqlite:///{tmp_path / 'store.sqlite3'}"
        return
    started: Server = request.getfixturevalue("postgresql")
    if request.param == "postgresql-empty":
        started.do(f"CREATE DATABASE {_EMPTY}")
        yield started.url_of(_EMPTY)
        started.do(f"DROP DATABASE {_EMPTY} WITH (FORCE)")
    else:
        started.do(f"TRUNCATE {_TABLES} RESTART IDENTITY")
        yield started.url_of(_STORE)
