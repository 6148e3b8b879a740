"""Other sites can neither open the page's socket, nor send its forms, nor frame it."""

import asyncio
from typing import Any

import pytest
from starlette.types import Message, Receive, Scope, Send

from service.page.guard import Guard

HOST = "127.0.0.1:8642"


def answered(kind: str, path: str, method: str = "GET", **headers: str) -> list[Message]:
    """Return what is sent for one request; the app behind says 200, or takes the socket."""
    sent: list[Message] = []

    async def app(scope: Scope, receive: Receive, send: Send) -> None:
        if kind == "websocket":
            await send({"type": "websocket.accept"})
            return
        await send({"type": "http.response.start", "status": 200, "headers": []})
        await send({"type": "http.response.body", "body": b""})

    async def receive() -> Message:
        raise AssertionError

    async def send(message: Message) -> None:
        sent.append(message)

    scope: dict[str, Any] = {
        "type": kind,
        "path": path,
        "headers": [(k.encode(), v.encode()) for k, v in {"host": HOST, **headers}.items()],
    }
    if kind == "http":
        scope["method"] = method
    asyncio.run(Guard(app)(scope, receive, send))
    return sent


@pytest.mark.parametrize(
    ("headers", "taken"),
    [
        ({"origin": f"http://{HOST}"}, True),
        ({"origin": f"https://{HOST}"}, True),
        ({}, False),
        ({"origin": "null"}, False),
        ({"origin": "http://evil.example"}, False),
        ({"origin": "http://127.0.0.1:9999"}, False),
        ({"origin": f"http://{HOST}.evil.example"}, False),
    ],
)
def test_a_socket_opens_for_the_page_itself_alone(headers: dict[str, str], taken: bool) -> None:
    (only,) = answered("websocket", "/page/_nicegui_ws/socket.io/", **headers)
    assert only["type"] == ("websocket.accept" if taken else "websocket.close")


@pytest.mark.parametrize(
    ("method", "headers", "status"),
    [
        ("GET", {}, 200),
        ("GET", {"origin": "http://evil.example"}, 403),
        ("POST", {"origin": f"http://{HOST}"}, 200),
        ("POST", {"origin": "http://evil.example"}, 403),
        ("POST", {"origin": "null"}, 403),
        ("POST", {}, 403),
    ],
)
def test_forms_come_from_the_page_itself(method: str, headers: dict[str, str], status: int) -> None:
    assert answered("http", "/page/sign-in", method, **headers)[0]["status"] == status


def test_the_page_has_headers_that_browsers_obey_and_the_api_is_left_alone() -> None:
    given = {k.decode(): v.decode() for k, v in answered("http", "/page/")[0]["headers"]}
    policy = given["content-security-policy"]
    assert "default-src 'self'" in policy
    assert "frame-ancestors 'none'" in policy
    assert "http" not in policy
    assert given["x-content-type-options"] == "nosniff"
    for path in ("/v1/runs", "/pages", "/"):
        assert answered("http", path, "POST", origin="http://elsewhere")[0]["headers"] == []
