"""The page's answers carry headers that browsers obey."""

import asyncio
from typing import Any

import pytest
from starlette.types import Message, Receive, Scope, Send

from service.page.page_headers import PageHeaders


def headers_of(path: str, **own: str) -> dict[str, str]:
    """Return the headers of the answer where what is behind gives those of `own`."""
    sent: list[Message] = []

    async def app(scope: Scope, receive: Receive, send: Send) -> None:
        headers = [(k.encode(), v.encode()) for k, v in own.items()]
        await send({"type": "http.response.start", "status": 200, "headers": headers})
        await send({"type": "http.response.body", "body": b""})

    async def receive() -> Message:
        raise AssertionError

    async def send(message: Message) -> None:
        sent.append(message)

    scope: dict[str, Any] = {"type": "http", "path": path, "method": "GET", "headers": []}
    asyncio.run(PageHeaders(app)(scope, receive, send))
    return {k.decode(): v.decode() for k, v in sent[0]["headers"]}


@pytest.mark.parametrize("path", ["/page", "/page/", "/page/audit"])
def test_the_page_is_all_from_here(path: str) -> None:
    policy = headers_of(path)["content-security-policy"]
    assert "default-src 'self'" in policy
    assert "frame-ancestors 'none'" in policy
    assert "http" not in policy


def test_a_stricter_policy_of_what_is_shown_stays() -> None:
    own = {"content-security-policy": "sandbox"}
    assert headers_of("/page/jobs/0/files/report.html", **own) == {
        **own,
        "referrer-policy": "same-origin",
    }


@pytest.mark.parametrize("path", ["/v1/runs", "/pages", "/"])
def test_others_are_left_alone(path: str) -> None:
    assert headers_of(path) == {}
