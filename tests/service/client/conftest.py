from collections.abc import Iterator
from pathlib import Path

import pytest

from service.app import create_app
from service.client import Client
from service.settings import Settings
from service.store.store import Store
from tests.service.cli.a_recording import plan_file, recording_file
from tests.service.client.answering import asking

__all__ = ["plan_file", "recording_file"]


@pytest.fixture
def store_url() -> str:
    """SQLite's; modules whose tests hold on both stores ask for each `url` in its place."""
    return ""


@pytest.fixture
def settings(tmp_path: Path, store_url: str) -> Settings:
    return Settings(home=tmp_path / "home", store_url=store_url)


@pytest.fixture
def client(settings: Settings) -> Iterator[Client]:
    """A client of a service without a bench."""
    with asking(create_app(settings)) as asked:
        yield asked


@pytest.fixture
def store(client: Client, settings: Settings) -> Iterator[Store]:
    """The same store by another way in."""
    with Store.open(settings) as opened:
        yield opened
