"""Refusing a request before any route sees it."""

from fastapi.responses import JSONResponse
from starlette.types import Receive, Scope, Send

_POLICY_VIOLATION = 1008
"""RFC 6455, section 7.4.1."""


async def refuse(answer: JSONResponse, scope: Scope, receive: Receive, send: Send) -> None:
    """Send `answer`; a websocket is closed before it was ever open."""
    if scope["type"] == "websocket":
        await send({"type": "websocket.close", "code": _POLICY_VIOLATION})
    else:
        await answer(scope, receive, send)
