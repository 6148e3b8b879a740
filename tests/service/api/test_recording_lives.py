"""Recordings go out as they came in, and go for good only where nothing needs them."""

import io
import zipfile
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from fastapi.testclient import TestClient

from calib.radiometric.coefficients.provenance import Provenance
from calib.recording.open import open_recording
from service.settings import Settings
from service.store.actor import Actor
from service.store.store import Store
from tests.calib.radiometric.example_set import example_set
from tests.service.api.packing import as_files, as_folder
from tests.service.api.test_recordings import upload

ADA = Actor("ada")


@pytest.fixture
def store_url(url: str) -> str:
    """Each test on SQLite and on PostgreSQL."""
    return url


@pytest.fixture
def imported(client: TestClient, recording_file: Path) -> str:
    return str(upload(client, as_files(recording_file), name="sweep 3").json()["digest"])


def exported(client: TestClient, digest: str) -> bytes:
    answer = client.get(f"/v1/recordings/{digest}/file")
    assert (answer.status_code, answer.headers["Content-Type"]) == (200, "application/zip")
    return bytes(answer.content)


def test_what_goes_out_comes_in_again_as_the_same(
    client: TestClient, settings: Settings, imported: str
) -> None:
    body = exported(client, imported)
    with zipfile.ZipFile(io.BytesIO(body)) as archive:
        assert archive.testzip() is None
        assert archive.namelist() == [f"{imported[:12]}.h5", f"{imported[:12]}.frames.jsonl"]
    assert client.delete(f"/v1/recordings/{imported}").status_code == 204
    assert upload(client, body).json()["digest"] == imported
    assert (
        open_recording(settings.recordings_folder / imported / "recording.h5").digest() == imported
    )


def test_a_folder_that_is_known_where_it_is_goes_out_too_and_stays_when_deleted(
    client: TestClient, store: Store, recording_file: Path, tmp_path: Path
) -> None:
    as_folder(recording_file, tmp_path)
    folder = tmp_path / "exported"
    digest = store.recordings.register(open_recording(folder), name="folder", by=ADA).digest
    body = exported(client, digest)
    assert client.delete(f"/v1/recordings/{digest}").status_code == 204
    assert open_recording(folder).digest() == digest
    assert upload(client, body).json()["digest"] == digest


def test_what_is_deleted_is_gone_and_on_record(
    client: TestClient, settings: Settings, store: Store, imported: str
) -> None:
    assert client.delete(f"/v1/recordings/{imported}").status_code == 204
    assert client.get(f"/v1/recordings/{imported}").status_code == 404
    assert client.get(f"/v1/recordings/{imported}/file").status_code == 404
    assert client.delete(f"/v1/recordings/{imported}").status_code == 404
    assert list(settings.recordings_folder.iterdir()) == []
    assert list(settings.work_folder.iterdir()) == []
    entries = store.audit.list().items
    assert [(e.action, e.who, e.subject) for e in entries] == [
        ("recording.delete", "local", imported), ("recording.import", "local", imported),
    ]  # fmt: skip
    assert entries[0].before == {"name": "sweep 3"}


def refer_by_set(store: Store, digest: str) -> None:
    store.sets.add(example_set(provenance=Provenance(digest)), by=ADA)


def refer_by_run(store: Store, digest: str) -> None:
    run, _ = store.runs.submit({}, "ab", blocks_total=1, by=ADA)
    store.runs.move(run.id, "running")
    store.runs.move(run.id, "succeeded", recording_digest=digest)


def refer_by_job(store: Store, digest: str) -> None:
    store.jobs.submit("compare", {"of": [{"recording": digest}]}, max_waiting=9)


@pytest.mark.parametrize("refer", [refer_by_set, refer_by_run, refer_by_job])
def test_what_is_needed_stays(
    client: TestClient, store: Store, imported: str, refer: Callable[[Store, str], None]
) -> None:
    refer(store, imported)
    before = store.audit.verify()
    refused: Any = client.delete(f"/v1/recordings/{imported}")
    assert (refused.status_code, refused.json()["code"]) == (409, "recording-in-use")
    assert exported(client, imported)
    assert store.audit.verify() == before


def test_a_job_that_is_over_needs_nothing(client: TestClient, store: Store, imported: str) -> None:
    job = store.jobs.submit("calibrate", {"recording": imported}, max_waiting=9)
    store.jobs.finish(job.id, "failed", error=("defect", "no"))
    assert client.delete(f"/v1/recordings/{imported}").status_code == 204


def test_a_recording_whose_file_is_gone_is_said_to_be(
    client: TestClient, settings: Settings, imported: str
) -> None:
    (settings.recordings_folder / imported / "recording.frames.jsonl").unlink()
    answer = client.get(f"/v1/recordings/{imported}/file")
    assert (answer.status_code, answer.json()["code"]) == (404, "not-found")
