"""The client says what the service says, with its codes, and asks twice only what may be."""

import json
import subprocess
import sys
from pathlib import Path
from typing import Any

import httpx2
import pytest

from calib.errors import DarkflatError, InputError
from calib.recording.folder import export_folder
from calib.recording.open import open_recording
from service.client import Client, ProblemError, ServiceLostError, WorkFailedError
from service.store.actor import Actor
from service.store.store import Store
from tests.service.api.packing import as_files
from tests.service.client.answering import answered_by
from tests.service.store.a_store import a_set, certified, day, verified


def test_a_refusal_is_an_error_with_the_service_s_code(client: Client, store: Store) -> None:
    with pytest.raises(ProblemError) as refused:
        client.coefficient_sets.get("0" * 64)
    assert (refused.value.code, refused.value.status) == ("not-found", 404)
    assert isinstance(refused.value, DarkflatError)
    standing = certified(store, a_set(30.0), day(1)).id
    other = verified(store, a_set(31.0)).id
    with pytest.raises(ProblemError) as refused:
        client.coefficient_sets.certify(other, valid_from=day(2), reason="due")
    assert refused.value.code == "overlapping-certification"
    assert refused.value.standing == (standing,)
    made = client.coefficient_sets.certify(
        other, valid_from=day(2), reason="due", supersedes=refused.value.standing
    )
    assert made.state == "certified"
    assert client.coefficient_sets.get(standing).state == "superseded"


def test_a_recording_is_the_same_however_it_is_packed(
    client: Client, recording_file: Path, tmp_path: Path
) -> None:
    folder, archive = tmp_path / "folder", tmp_path / "recording.zip"
    export_folder(open_recording(recording_file), folder)
    archive.write_bytes(as_files(recording_file))
    digest = open_recording(recording_file).digest()
    assert client.recordings.upload(recording_file, name="by hand").digest == digest
    assert client.recordings.upload(archive).name == "by hand"
    assert client.recordings.upload(folder).camera_serial
    assert digest in {each.digest for each in client.recordings.all()}
    with pytest.raises(InputError) as refused:
        client.recordings.upload(tmp_path / "nothing.h5")
    assert refused.value.code == "not-a-recording"


def test_all_goes_through_every_page(client: Client, store: Store) -> None:
    for n in range(230):
        store.audit.record(Actor("ada"), "bench.safe-off", f"bench {n}")
    assert [each.number for each in client.audit.all()] == list(range(230, 0, -1))
    assert client.audit.verify().entries == 230


def test_a_service_without_a_bench_says_so(client: Client) -> None:
    with pytest.raises(ProblemError) as refused:
        client.safe_off()
    assert refused.value.code == "no-bench"


RUN: dict[str, Any] = {
    "id": "r", "state": "queued", "plan": {}, "attempts": 0, "blocks_done": 0, "blocks_total": 1,
    "recording": None, "result": None, "error": None, "submitted_at": "2026-01-01T00:00:00Z",
    "submitted_by": "ada", "started_at": None, "finished_at": None,
}  # fmt: skip


def test_a_run_is_started_once_although_the_answer_is_lost() -> None:
    keys: list[str] = []

    def service(request: httpx2.Request) -> httpx2.Response:
        keys.append(request.headers["Idempotency-Key"])
        if len(keys) < 3:
            raise httpx2.ReadError("reset by peer")
        return httpx2.Response(202, json=RUN)

    assert answered_by(service).runs.start({}).id == "r"
    assert len(keys) == 3
    assert len(set(keys)) == 1


JOB: dict[str, Any] = {
    "id": "j", "kind": "calibrate", "state": "running", "progress": None, "request": {},
    "files": [],
    "result": None, "error": None, "submitted_at": "2026-01-01T00:00:00Z", "started_at": None,
    "finished_at": None,
}  # fmt: skip


def test_a_job_is_waited_for_with_its_progress_and_says_why_it_failed() -> None:
    error = {"code": "no-darks", "message": "there are no darks; record some"}
    answers = [
        {**JOB, "state": "queued"}, {**JOB, "progress": 0.25}, {**JOB, "progress": 0.25},
        {**JOB, "progress": 0.75}, {**JOB, "state": "failed", "error": error},
    ]  # fmt: skip
    client = answered_by(lambda _: httpx2.Response(200, json=answers.pop(0)))
    shares: list[float] = []
    with pytest.raises(WorkFailedError, match="record some") as failed:
        client.jobs.wait("j", on_progress=shares.append, every_s=0.0)
    assert (failed.value.code, failed.value.state) == ("no-darks", "failed")
    assert shares == [0.25, 0.75]


def test_a_certification_is_not_asked_for_twice() -> None:
    asked: list[str] = []

    def service(request: httpx2.Request) -> httpx2.Response:
        asked.append(request.url.path)
        raise httpx2.ReadError("reset by peer")

    with pytest.raises(ServiceLostError) as lost:
        answered_by(service).coefficient_sets.certify("s", valid_from=day(1), reason="due")
    assert lost.value.code == "service-lost"
    assert len(asked) == 1


def test_an_answer_that_is_no_problem_document_is_an_error_all_the_same() -> None:
    client = answered_by(lambda _: httpx2.Response(502, text="<html>a proxy</html>"))
    with pytest.raises(ProblemError) as refused:
        client.runs.get("r")
    assert (refused.value.code, refused.value.status) == ("http-502", 502)


def events(*numbers: int, broken: bool = False) -> httpx2.Response:
    def body() -> Any:
        for n in numbers:
            told = {"number": n, "at": "2026-01-01T00:00:00Z", "kind": "progress", "content": {}}
            yield f"id: {n}\nevent: progress\ndata: {json.dumps(told)}\n\n".encode()
        if broken:
            yield b'id: 99\nevent: progress\ndata: {"num'  # half an event is none
            raise httpx2.ReadError("reset by peer")

    return httpx2.Response(200, headers={"Content-Type": "text/event-stream"}, content=body())


def test_following_goes_on_after_the_last_whole_event() -> None:
    streams = [events(1, 2, broken=True), events(3), events(4, 5)]
    states = iter(["running", "succeeded"])
    asked: list[str] = []

    def service(request: httpx2.Request) -> httpx2.Response:
        if not request.url.path.endswith("/events"):
            return httpx2.Response(200, json={**RUN, "state": next(states)})
        asked.append(request.headers["Last-Event-ID"])
        return streams.pop(0)

    followed = answered_by(service).runs.follow("r")
    assert [event.number for event in followed] == [1, 2, 3, 4, 5]
    assert asked == ["0", "2", "3"]


def test_a_service_that_stays_away_is_lost_once_patience_is_over() -> None:
    def service(request: httpx2.Request) -> httpx2.Response:
        raise httpx2.ConnectError("refused")

    client = answered_by(service)
    client._link.patience_s = 0.5
    with pytest.raises(ServiceLostError):
        list(client.runs.follow("r"))


def test_the_client_does_not_import_the_service() -> None:
    code = "import sys; from service.client import Client; print(*sys.modules)"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert "service.client.client" in done.stdout.split()
    heavy = {"fastapi", "uvicorn", "numba", "scipy", "matplotlib", "nicegui", "h5py"}
    assert heavy.isdisjoint(done.stdout.split())
