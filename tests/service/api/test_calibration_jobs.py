"""The life of a calibration as a job, on both stores."""

import os
import signal
import time
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import pytest
from fastapi.testclient import TestClient

from service.api.jobs.process import JobProcess
from service.app import create_app
from service.settings import Settings
from service.store.store import Store
from tests.service.api.here_and_now import HereAndNow
from tests.service.api.packing import as_files
from tests.service.api.test_calibrations import PLACE, ZIP, digest, ended

__all__ = ["digest"]


@pytest.fixture
def store_url(url: str) -> str:
    """Each test on SQLite and on PostgreSQL."""
    return url


def test_an_unknown_recording_is_not_found(client: TestClient) -> None:
    answer = client.post(PLACE, json={"recording": "0" * 64})
    assert (answer.status_code, answer.json()["code"]) == (404, "not-found")


@pytest.mark.usefixtures("here_and_now")
def test_a_recording_that_was_lost_fails_the_job(
    client: TestClient, digest: str, settings: Settings
) -> None:
    (settings.recordings_folder / digest / "recording.h5").unlink()
    started = client.post(PLACE, json={"recording": digest})
    job = ended(client, started.headers["Location"])
    assert job["state"] == "failed"
    assert job["error"]["code"] not in {"internal-error", "worker-died"}
    assert client.get("/v1/coefficient-sets").json()["items"] == []


class Asleep(JobProcess):
    """Work that is never done before it is killed."""

    def __init__(self, kind: str, request: Mapping[str, Any]) -> None:
        super().__init__(kind, request)
        assert self._process.pid is not None
        os.kill(self._process.pid, signal.SIGSTOP)


def test_a_job_is_cancelled_for_good_whether_it_waits_or_runs(
    client: TestClient, digest: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("service.api.jobs.runner.JobProcess", Asleep)
    jobs = [client.post(PLACE, json={"recording": digest}) for _ in range(3)]
    places = [job.headers["Location"] for job in jobs]
    for place in places:
        assert client.post(f"{place}/cancel").json()["state"] == "cancelled"
    time.sleep(0.5)
    assert [client.get(place).json()["state"] for place in places] == ["cancelled"] * 3
    assert client.get("/v1/coefficient-sets").json()["items"] == []
    assert len(client.get("/v1/jobs").json()["items"]) == 3
    monkeypatch.setattr("service.api.jobs.runner.JobProcess", HereAndNow)
    last = client.post(PLACE, json={"recording": digest})  # the queue goes on
    assert ended(client, last.headers["Location"])["state"] == "succeeded"


def test_a_full_queue_says_so(
    settings: Settings, recording_file: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("service.api.jobs.runner.JobProcess", Asleep)
    small = settings.model_copy(update={"max_queued_jobs": 1})
    with TestClient(create_app(small), base_url="http://127.0.0.1") as client:
        body = as_files(recording_file)
        digest = client.post("/v1/recordings", content=body, headers=ZIP).json()["digest"]
        assert client.post(PLACE, json={"recording": digest}).status_code == 202
        full = client.post(PLACE, json={"recording": digest})
        assert (full.status_code, full.json()["code"]) == (429, "too-many-jobs")
        assert len(list(small.work_folder.glob("job-*"))) == 1  # the refused one's is gone


def test_what_the_service_left_behind_is_interrupted_at_the_next_start(settings: Settings) -> None:
    with Store.open(settings) as store:
        job = store.jobs.submit("calibrate", {}, max_waiting=9)
        store.jobs.start(job.id)
    with TestClient(create_app(settings), base_url="http://127.0.0.1") as client:
        assert client.get(f"/v1/jobs/{job.id}").json()["state"] == "interrupted"
