"""A store that is opened, on SQLite and on PostgreSQL: the same tests on both."""

from collections.abc import Callable, Iterator
from pathlib import Path

import pytest

from service.store.store import Store


@pytest.fixture
def open_store(url: str, tmp_path: Path) -> Callable[[], Store]:
    """Open the store, once more each time."""
    return lambda: Store(url, tmp_path / "sets")


@pytest.fixture
def store(open_store: Callable[[], Store]) -> Iterator[Store]:
    with open_store() as opened:
        yield opened
