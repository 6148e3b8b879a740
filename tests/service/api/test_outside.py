"""What may come from outside: which names, which pages, how much, and what browsers are told."""

import socket
from collections.abc import Iterator
from pathlib import Path

import pytest
from fastapi import WebSocket
from fastapi.testclient import TestClient
from starlette.websockets import WebSocketDisconnect

from calib.errors import InputError
from service.app import create_app
from service.cli.listening import listen
from service.settings import Settings

ASKED_BY = "http://bench-3.lab:8642"
HOST = {"Host": "bench-3.lab:8642"}
EVERYWHERE = "0.0.0.0"  # noqa: S104


@pytest.fixture
def client(tmp_path: Path) -> Iterator[TestClient]:
    settings = Settings(
        home=tmp_path, host="10.0.0.3", hosts="Bench-3.lab, fd00::3", max_json_bytes=1000
    )
    app = create_app(settings)

    @app.websocket("/socket")
    async def socket(connected: WebSocket) -> None:
        await connected.accept()
        await connected.send_text("hello")

    with TestClient(app, base_url=ASKED_BY, client=("127.0.0.1", 50_000)) as started:
        yield started


@pytest.mark.parametrize(
    ("host", "status"),
    [
        ("bench-3.lab", 200), ("BENCH-3.LAB:8642", 200), ("10.0.0.3", 200), ("[fd00::3]:80", 200),
        ("localhost", 200), ("[::1]:8642", 200), ("bench-3.lab.evil.example", 421),
        ("10.0.0.4", 421), (EVERYWHERE, 421), ("", 421),
    ],
)  # fmt: skip
def test_it_goes_by_the_names_that_it_was_told(client: TestClient, host: str, status: int) -> None:
    answer = client.get("/healthz", headers={"Host": host})
    assert answer.status_code == status
    if status == 421:
        assert answer.json()["code"] == "unknown-host"


@pytest.mark.parametrize(
    ("origin", "is_ours"),
    [
        (ASKED_BY, True), (None, True), ("https://bench-3.lab:8642", True),
        ("http://bench-3.lab", False), ("https://evil.example", False), ("null", False),
    ],
)  # fmt: skip
def test_a_page_of_another_site_moves_nothing_and_opens_no_socket(
    client: TestClient, origin: str | None, is_ours: bool
) -> None:
    headers = HOST if origin is None else {**HOST, "Origin": origin}
    answer = client.post("/v1/jobs/0123/cancel", headers=headers)
    assert answer.json()["code"] == ("not-found" if is_ours else "foreign-page")
    assert client.get("/v1/jobs", headers=headers).status_code == 200
    if is_ours:
        with client.websocket_connect("/socket", headers=headers) as opened:
            assert opened.receive_text() == "hello"
    else:
        with (
            pytest.raises(WebSocketDisconnect),
            client.websocket_connect("/socket", headers=headers),
        ):
            pass


def test_a_socket_by_a_foreign_name_is_refused(client: TestClient) -> None:
    with (
        pytest.raises(WebSocketDisconnect),
        client.websocket_connect("/socket", headers={"Host": "evil.example"}),
    ):
        pass


def test_what_is_held_in_memory_is_limited_however_it_is_announced(client: TestClient) -> None:
    body = b'{"recording": "' + b"0" * 1000 + b'"}'
    json = {"Content-Type": "application/json"}
    announced = client.post("/v1/calibrations", content=body, headers=json)
    unannounced = client.post(
        "/v1/calibrations", content=iter([body[:500], body[500:]]), headers=json
    )
    unlabelled = client.post(
        "/v1/calibrations", content=body, headers={"Content-Type": "text/plain"}
    )
    for answer in (announced, unannounced, unlabelled):
        assert (answer.status_code, answer.json()["code"]) == (413, "too-large")
    small = client.post("/v1/calibrations", json={"recording": "0" * 64})
    assert small.json()["code"] == "not-found"
    streamed = client.post(
        "/v1/recordings", content=bytes(2000), headers={"Content-Type": "application/zip"}
    )
    assert streamed.json()["code"] == "not-a-zip"


def test_browsers_are_told_to_take_nothing_from_elsewhere(client: TestClient) -> None:
    for answer in (client.get("/v1/jobs"), client.get("/v1/jobs/0123"), client.get("/nowhere")):
        assert answer.headers["X-Content-Type-Options"] == "nosniff"
        assert answer.headers["X-Frame-Options"] == "DENY"
        assert "frame-ancestors 'none'" in answer.headers["Content-Security-Policy"]
    data = client.get("/v1/jobs").headers
    assert data["Content-Security-Policy"].startswith("default-src 'none'")
    assert data["Cache-Control"] == "no-store"
    refused = client.get("/v1/jobs", headers={"Host": "evil.example"})
    assert refused.headers["X-Content-Type-Options"] == "nosniff"


def test_every_operation_with_a_body_says_that_it_may_be_too_large(client: TestClient) -> None:
    paths = client.get("/openapi.json").json()["paths"]
    with_body = [o for methods in paths.values() for o in methods.values() if "requestBody" in o]
    assert with_body
    assert all("413" in operation["responses"] for operation in with_body)


def test_others_than_this_machine_are_listened_to_once_there_is_a_key() -> None:
    with pytest.raises(InputError) as refused:
        listen(EVERYWHERE, 0, has_keys=False)
    assert refused.value.code == "keys-needed"
    with listen(EVERYWHERE, 0, has_keys=True) as listening:
        assert listening.getsockname()[0] == EVERYWHERE
    with listen("127.0.0.1", 0, has_keys=False) as listening:
        assert listening.family is socket.AF_INET
