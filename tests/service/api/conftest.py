from collections.abc import Iterator
from pathlib import Path

import pytest
from fastapi.testclient import TestClient

from service.app import create_app
from service.settings import Settings
from service.store.store import Store
from tests.service.api.here_and_now import HereAndNow
from tests.service.cli.a_recording import plan_file, recording_file

__all__ = ["plan_file", "recording_file"]


@pytest.fixture
def store_url() -> str:
    """SQLite's; modules whose tests hold on both stores ask for each `url` in its place."""
    return ""


@pytest.fixture
def settings(tmp_path: Path, store_url: str) -> Settings:
    return Settings(
        home=tmp_path / "home",
        store_url=store_url,
        max_upload_bytes=8 << 20,
        max_frames_bytes=1 << 20,
    )


@pytest.fixture
def client(settings: Settings) -> Iterator[TestClient]:
    with TestClient(
        create_app(settings), base_url="http://127.0.0.1", raise_server_exceptions=False
    ) as started:
        yield started


@pytest.fixture
def here_and_now(monkeypatch: pytest.MonkeyPatch) -> None:
    """Let jobs be done without a process of their own, which takes seconds to begin."""
    monkeypatch.setattr("service.api.jobs.runner.JobProcess", HereAndNow)


@pytest.fixture
def store(client: TestClient, settings: Settings) -> Iterator[Store]:
    """The same store by another way in."""
    with Store.open(settings) as opened:
        yield opened
