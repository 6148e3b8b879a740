"""Every operation under requests that nobody would think of: no 5xx, all as documented."""

import os
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from fastapi.testclient import TestClient

from service.app import create_app
from service.settings import Settings
from service.store.actor import Actor
from service.store.store import Store
from tests.service.api.fuzzing import fuzz, operations
from tests.service.api.packing import as_files
from tests.service.api.test_runs import SHORT, until
from tests.service.sequencer.benches import in_process
from tests.service.store.a_store import a_set, verified

OPERATIONS = {each.label: each for each in operations(create_app(Settings()).openapi())}
EACH, EACH_SOAK = 6, 150


def started(home: Path, recording: Path, *, with_bench: bool) -> Iterator[tuple[TestClient, Any]]:
    """Give an app with one of everything, and the path parameters that name it."""
    bench = in_process(f"fuzz-{os.getpid()}") if with_bench else None
    settings = Settings(home=home, max_upload_bytes=1 << 20, max_frames_bytes=1 << 20)
    app = create_app(settings, bench_settings=bench)
    with TestClient(app, base_url="http://127.0.0.1", raise_server_exceptions=False) as client:
        zip_type = {"Content-Type": "application/zip"}
        answer = client.post("/v1/recordings", content=as_files(recording), headers=zip_type)
        known = {"digest": answer.json()["digest"]}
        with Store.open(settings) as store:
            known["set_id"] = verified(store, a_set()).id
            job = store.jobs.submit("diagnose", {}, max_waiting=9)
            store.jobs.finish(job.id, "succeeded", result={})
            run, _ = store.runs.submit(SHORT, "0" * 64, blocks_total=4, by=Actor("local"))
        folder = settings.jobs_folder / job.id
        folder.mkdir(parents=True)
        (folder / "answer.json").write_text("{}")
        if with_bench:
            until(client, "/v1/bench", "idle")
        yield client, {**known, "job_id": job.id, "name": "answer.json", "run_id": run.id}


@pytest.fixture(scope="module")
def alone(
    tmp_path_factory: pytest.TempPathFactory, recording_file: Path
) -> Iterator[tuple[TestClient, Any]]:
    yield from started(tmp_path_factory.mktemp("alone"), recording_file, with_bench=False)


@pytest.fixture(scope="module")
def with_bench(
    tmp_path_factory: pytest.TempPathFactory, recording_file: Path
) -> Iterator[tuple[TestClient, Any]]:
    yield from started(tmp_path_factory.mktemp("bench"), recording_file, with_bench=True)


def answered(app: tuple[TestClient, Any], label: str, examples: int, *, without_bench: bool) -> int:
    client, known = app
    operation = OPERATIONS[label]
    return fuzz(client, operation, known, examples=examples, without_bench=without_bench)


@pytest.mark.parametrize("label", OPERATIONS)
def test_an_app_without_a_bench_answers_as_documented(
    alone: tuple[TestClient, Any], label: str
) -> None:
    answered(alone, label, EACH, without_bench=True)


@pytest.mark.parametrize("label", OPERATIONS)
def test_an_app_with_a_bench_answers_as_documented(
    with_bench: tuple[TestClient, Any], label: str
) -> None:
    answered(with_bench, label, EACH, without_bench=False)


@pytest.mark.soak
def test_thousands_of_requests_are_answered_as_documented(
    alone: tuple[TestClient, Any], with_bench: tuple[TestClient, Any]
) -> None:
    sent = 0
    for label in OPERATIONS:
        sent += answered(alone, label, EACH_SOAK, without_bench=True)
        sent += answered(with_bench, label, EACH_SOAK, without_bench=False)
    assert sent > 3000
