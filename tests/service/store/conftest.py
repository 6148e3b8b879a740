from collections.abc import Iterator
from pathlib import Path

import pytest

from service.store.store import Store


@pytest.fixture
def store(tmp_path: Path) -> Iterator[Store]:
    with Store(f"sqlite:///{tmp_path / 'store.sqlite3'}", tmp_path / "sets") as opened:
        yield opened
