from collections.abc import Iterator
from pathlib import Path

import pytest
from fastapi.testclient import TestClient

from service.app import create_app
from service.client import Client
from service.settings import Settings
from service.store.store import Store
from tests.service.cli.a_recording import plan_file, recording_file

__all__ = ["plan_file", "recording_file"]


@pytest.fixture
def settings(tmp_path: Path) -> Settings:
    return Settings(home=tmp_path / "home")


@pytest.fixture
def client(settings: Settings) -> Iterator[Client]:
    """A client whose requests are answered in this process: Starlette's is one of httpx2."""
    app = create_app(settings)
    with (
        TestClient(app, base_url="http://127.0.0.1", raise_server_exceptions=False) as answering,
        Client() as asking,
    ):
        asking._link._http.close()
        asking._link._http = answering
        yield asking


@pytest.fixture
def store(client: Client, settings: Settings) -> Iterator[Store]:
    """The same store by another way in."""
    with Store.open(settings) as opened:
        yield opened
