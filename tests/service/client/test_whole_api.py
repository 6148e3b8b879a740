"""The client can ask for all that the service can do, with every option that it takes."""

import json
import re
from collections.abc import Callable, Iterator
from contextlib import suppress
from dataclasses import dataclass
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

import httpx2
import numpy as np
import pytest

from calib.recording.tone import Tone
from service.app import create_app
from service.client import Client, ProblemError
from service.settings import Settings

AT = datetime(2026, 6, 1, tzinfo=UTC)
PAGED = {"limit", "before"}
"""What the client asks for by itself."""


@dataclass(frozen=True)
class Asked:
    """What was asked for by a call."""

    method: str
    path: str
    query: frozenset[str]
    body: frozenset[str]


def folder_with(name: str, folder: Path) -> Path:
    folder.mkdir()
    (folder / name).write_text("")
    return folder


def runs(client: Client, _: Path) -> Iterator[Callable[[], Any]]:
    yield lambda: client.runs.validate({"lines": 3})
    yield lambda: client.runs.start({"lines": 3}, idempotency_key="nightly")
    yield lambda: list(client.runs.all(state="queued"))
    yield lambda: client.runs.get("r")
    yield lambda: list(client.runs.follow("r"))
    yield lambda: list(client.runs.journal("r"))
    yield lambda: client.runs.pause("r")
    yield lambda: client.runs.resume("r")
    yield lambda: client.runs.abort("r")
    yield lambda: client.runs.wait("r")


def recordings(client: Client, folder: Path) -> Iterator[Callable[[], Any]]:
    recording = folder_with("recording.toml", folder / "recording")
    yield lambda: client.recordings.upload(recording, name="sweep")
    yield lambda: client.recordings.get("d")
    yield lambda: list(client.recordings.all(serial="B0001", band="NIR"))
    yield lambda: client.recordings.download("d", folder / "recording.zip")
    yield lambda: client.recordings.delete("d")


def jobs(client: Client, folder: Path) -> Iterator[Callable[[], Any]]:
    scan = folder_with("mtf.toml", folder / "scan")
    yield lambda: client.jobs.calibrate(
        "d", radiances={2: 20.1}, relative=True, order=4, darks_required=False,
        tone=Tone(0.1, 300.0), model="",
    )  # fmt: skip
    yield lambda: client.jobs.photon_transfer("d", method="sanuc")
    yield lambda: client.jobs.diagnose("d", second_recording="e", model="")
    yield lambda: client.jobs.transfer_function(scan, method="filter", support=5)
    yield lambda: client.jobs.get("j")
    yield lambda: list(client.jobs.all())
    yield lambda: client.jobs.cancel("j")
    yield lambda: client.jobs.wait("j")
    yield lambda: client.jobs.download("j", "answer.json", folder / "answer.json")
    yield lambda: client.jobs.download_all("j", folder)


def sets(client: Client, folder: Path) -> Iterator[Callable[[], Any]]:
    sets = client.coefficient_sets
    yield lambda: sets.get("s")
    yield lambda: list(sets.all(state="draft", serial="B0001", band="NIR", recording="d"))
    yield lambda: sets.lookup(
        serial="B0001", bit_depth=12, band="NIR", gain_db=6.0, region="0:32", at=AT
    )
    yield lambda: sets.verify("s", reason="curves look right")
    yield lambda: sets.certify(
        "s", valid_from=AT, valid_until=AT, reason="due", supersedes=["other"]
    )
    yield lambda: sets.revoke("s", reason="lamp 2 was aged")
    yield lambda: sets.download("s", folder / "set.h5")
    yield lambda: sets.apply(
        "s", np.zeros((2, 32), np.uint16), exposure_us=60.0, at=AT, serial="B0001", band="NIR",
        gain_db=6.0, black_level_dn=0.0, bit_depth=12, first_column=0, temperature_c=20.0,
        force=True,
    )  # fmt: skip


def others(client: Client, _: Path) -> Iterator[Callable[[], Any]]:
    yield client.bench.get
    yield client.bench.look
    yield client.bench.safe_off
    yield client.bench.release
    yield client.safe_off
    yield lambda: list(client.audit.all())
    yield client.audit.verify
    yield client.health.alive
    yield client.health.ready
    yield client.health.metrics


def refusing(asked: list[Asked]) -> httpx2.MockTransport:
    """Note what is asked, and refuse it."""

    def refuse(request: httpx2.Request) -> httpx2.Response:
        content = request.read()
        is_json = request.headers.get("Content-Type") == "application/json"
        body = frozenset(json.loads(content)) if is_json else frozenset()
        query = frozenset(request.url.params.keys())
        asked.append(Asked(request.method, request.url.path, query, body))
        return httpx2.Response(404, json={"code": "not-found", "detail": "there is none"})

    return httpx2.MockTransport(refuse)


@pytest.fixture
def asked(tmp_path: Path) -> list[Asked]:
    """Everything that the client asks for, each refused and left nothing half done."""
    found: list[Asked] = []
    with Client(patience_s=0.0) as client:
        client._link._http.close()
        client._link._http = httpx2.Client(base_url="http://bench", transport=refusing(found))
        for each in (runs, recordings, jobs, sets, others):
            for call in each(client, tmp_path):
                with pytest.raises(ProblemError):
                    call()
    assert sorted(path.name for path in tmp_path.iterdir()) == ["recording", "scan"]
    return found


@pytest.fixture
def document(tmp_path: Path) -> dict[str, Any]:
    found: dict[str, Any] = create_app(Settings(home=tmp_path / "home")).openapi()
    return found


def operation_of(document: dict[str, Any], asked: Asked) -> tuple[str, str]:
    """Return which operation of the document it is: a path without a gap goes first."""
    for path in sorted(document["paths"], key=lambda each: "{" in each):
        pattern = re.sub(r"\{[^}]+\}", "[^/]+", path)
        has = asked.method.lower() in document["paths"][path]
        if has and re.fullmatch(pattern, asked.path):
            return asked.method.lower(), path
    raise AssertionError(asked)


def test_every_operation_of_the_document_is_asked_for(
    document: dict[str, Any], asked: list[Asked]
) -> None:
    expected = {(method, path) for path, found in document["paths"].items() for method in found}
    assert {operation_of(document, each) for each in asked} == expected


def test_every_option_of_an_operation_can_be_given(
    document: dict[str, Any], asked: list[Asked]
) -> None:
    given: dict[tuple[str, str], set[str]] = {}
    for each in asked:
        given.setdefault(operation_of(document, each), set()).update(each.query | each.body)
    for (method, path), names in given.items():
        operation = document["paths"][path][method]
        options = {p["name"] for p in operation.get("parameters", ()) if p["in"] == "query"}
        with suppress(KeyError):
            schema = operation["requestBody"]["content"]["application/json"]["schema"]
            model = schema["$ref"].rpartition("/")[2]
            options |= set(document["components"]["schemas"][model]["properties"])
        if path == "/v1/runs" and method == "post":  # a plan is given whole, as in its file
            assert {"validate", "lines"} <= names
            continue
        assert names - PAGED == options - PAGED, (method, path)
