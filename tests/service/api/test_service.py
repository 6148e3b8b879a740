"""What holds for every route: problems, names, the document, health."""

import json
import socket
import subprocess
import sys
import time
from pathlib import Path
from typing import Any
from urllib.error import URLError
from urllib.request import urlopen

import pytest
from fastapi import FastAPI
from fastapi.testclient import TestClient
from jsonschema_rs import Draft202012Validator

from service.api.dependencies import Parts
from service.api.problems import Problem
from service.settings import Settings
from service.store.store import Store


def test_health_and_readiness(client: TestClient, settings: Settings) -> None:
    assert client.get("/healthz").json() == {"status": "alive"}
    assert client.get("/readyz").json() == {
        "status": "ready", "store": "writable", "bench": "none",
    }  # fmt: skip


def test_a_store_that_cannot_be_written_is_not_ready(
    client: TestClient, monkeypatch: pytest.MonkeyPatch
) -> None:
    from service.store.errors import StoreError

    def busy(_: Store) -> None:
        raise StoreError("the disk is gone; look at it", code="store-not-writable")

    monkeypatch.setattr(Store, "check_writable", busy)
    answer = client.get("/readyz")
    assert (answer.status_code, answer.json()["code"]) == (503, "store-not-writable")


@pytest.mark.parametrize("place", ["/healthz", "/readyz"])
def test_a_service_that_does_no_jobs_any_more_says_so(
    client: TestClient, monkeypatch: pytest.MonkeyPatch, place: str
) -> None:
    runner = parts_of(client).runner
    runner._queue.put(None)
    runner._thread.join(timeout=10)
    answer = client.get(place)
    assert (answer.status_code, answer.json()["code"]) == (503, "jobs-stopped")


def parts_of(client: TestClient) -> Parts:
    assert isinstance(client.app, FastAPI)
    parts: Parts = client.app.state.parts
    return parts


def test_every_error_is_a_problem(client: TestClient) -> None:
    for method, place, status in (
        ("GET", "/nowhere", 404),
        ("DELETE", "/v1/recordings", 405),
        ("GET", "/v1/recordings?limit=0", 422),
        ("GET", "/v1/jobs/nobody", 404),
        ("GET", "/v1/coefficient-sets?before=99999999999999999999999", 422),
    ):
        answer = client.request(method, place)
        assert answer.status_code == status
        assert answer.headers["Content-Type"] == "application/problem+json"
        told = answer.json()
        assert told["type"] == f"urn:darkflat:problem:{told['code']}"
        assert told["status"] == status
        assert told["detail"]


def test_a_defect_shows_no_trace(client: TestClient, monkeypatch: pytest.MonkeyPatch) -> None:
    def surprise(_: Store) -> None:
        raise KeyError("secret inner state")

    monkeypatch.setattr(Store, "check_writable", surprise)
    answer = client.get("/readyz")
    assert (answer.status_code, answer.json()["code"]) == (500, "internal-error")
    assert "secret" not in answer.text
    assert "Traceback" not in answer.text


def test_a_foreign_name_is_not_answered(client: TestClient) -> None:
    """A page that lets its own name point at this machine gets nothing."""
    for host, status in (
        ("evil.example", 421), ("evil.example:8642", 421), ("127.0.0.1.evil.example", 421),
        ("", 421), ("localhost:8642", 200), ("[::1]:8642", 200), ("LOCALHOST", 200),
    ):  # fmt: skip
        assert client.get("/healthz", headers={"Host": host}).status_code == status, host


def test_the_document_is_complete(client: TestClient) -> None:
    document: dict[str, Any] = client.get("/openapi.json").json()
    assert "Problem" in document["components"]["schemas"]
    assert "HTTPValidationError" not in str(document)
    for path, operations in document["paths"].items():
        for method, operation in operations.items():
            assert operation.get("summary"), (method, path)
            assert operation.get("description"), (method, path)
            good = next(code for code in operation["responses"] if code.startswith("2"))
            has_content = bool(operation["responses"][good].get("content"))
            assert has_content == (good != "204"), (method, path)
            assert bool(operation.get("security")) == (path not in {"/healthz", "/readyz"}), path
            for status, response in operation["responses"].items():
                if int(status) >= 400:
                    assert set(response["content"]) == {"application/problem+json"}, (path, status)
                    check_problem(response["content"]["application/problem+json"], status)
    schemes = document["components"]["securitySchemes"]
    assert [(each["type"], each["scheme"]) for each in schemes.values()] == [("http", "bearer")]


def check_problem(content: dict[str, Any], status: str) -> None:
    assert content["examples"]
    for code, each in content["examples"].items():
        told = Problem.model_validate(each["value"])
        assert (told.code, str(told.status)) == (code, status)


def test_every_example_of_the_document_is_allowed_by_its_schema(client: TestClient) -> None:
    document: dict[str, Any] = client.get("/openapi.json").json()
    checked = 0
    for operations in document["paths"].values():
        for operation in operations.values():
            bodies = [operation.get("requestBody", {}), *operation["responses"].values()]
            for content in (body.get("content", {}).get("application/json") for body in bodies):
                if content is None or not content.get("schema"):
                    continue
                schema = {**content["schema"], "components": document["components"]}
                examples = [content["example"]] if "example" in content else body_examples(schema)
                assert examples, operation["operationId"]
                for example in examples:
                    Draft202012Validator(schema).validate(example)
                    checked += 1
    assert checked > 30


def body_examples(schema: dict[str, Any]) -> list[Any]:
    """Return the examples of the model that a request's schema refers to."""
    model = schema["components"]["schemas"][schema["$ref"].rpartition("/")[2]]
    found: list[Any] = model.get("examples", [])
    return found


def test_serve_answers_on_loopback_until_it_is_stopped(tmp_path: Path) -> None:
    errors = tmp_path / "errors"
    command = "import signal; signal.signal(signal.SIGINT, signal.default_int_handler);"
    command += "from service.cli import main; main()"
    with errors.open("w") as log:
        process = subprocess.Popen(
            [sys.executable, "-c", command, "serve", "--port", "0", "--log", "json", "--json", "-"],
            stdout=subprocess.PIPE,
            stderr=log,
            env={"DARKFLAT_HOME": str(tmp_path), "PATH": "/usr/bin"},
            text=True,
        )
    try:
        assert process.stdout is not None
        told = "".join(process.stdout.readline() for _ in range(5))
        url = told.partition('"url": "')[2].partition('"')[0]
        assert url.startswith("http://127.0.0.1:")
        until = time.monotonic() + 120
        while True:
            try:
                with urlopen(f"{url}/healthz", timeout=5) as answered:  # noqa: S310
                    assert answered.status == 200
                break
            except URLError:
                assert time.monotonic() < until
                time.sleep(0.1)
        process.send_signal(2)
        assert process.wait(timeout=120) == 0
        for line in errors.read_text().splitlines():
            assert {"at", "level", "message"} <= set(json.loads(line)), line
    finally:
        process.kill()
        process.wait()
        assert process.stdout is not None
        process.stdout.close()


def test_a_port_that_is_taken_is_one_line(tmp_path: Path) -> None:
    from service.cli.listening import listen

    with socket.create_server(("127.0.0.1", 0)) as taken:
        from calib.errors import InputError

        with pytest.raises(InputError) as refused:
            listen("127.0.0.1", taken.getsockname()[1])
        assert refused.value.code == "port-in-use"
    for host in ("0.0.0.0", "192.168.1.5", "example.org", "::"):  # noqa: S104
        with pytest.raises(InputError) as refused:
            listen(host, 0)
        assert refused.value.code == "keys-needed"
