"""How much of a request's body is read at all."""

from typing import Final

from starlette.exceptions import HTTPException
from starlette.types import ASGIApp, Message, Receive, Scope, Send

from service.api.request_headers import header

_LIMIT: Final = "darkflat.body_limit_bytes"


class BodyTooLargeError(HTTPException):
    """More comes than is read; `detail` says how much would be."""

    def __init__(self, limit_bytes: int) -> None:
        detail = f"the body is larger than the {limit_bytes} bytes that are read here; send less"
        super().__init__(413, detail)


class LimitedBodies:
    """Refuses to read bodies that are held in memory beyond a limit.

    What streams a body to the disk asks for more, by `allow`.
    """

    def __init__(self, app: ASGIApp, limit_bytes: int) -> None:
        self._app = app
        self._limit_bytes = limit_bytes

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Pass on the request; raise BodyTooLargeError in whoever reads too much of it."""
        if scope["type"] != "http":
            await self._app(scope, receive, send)
            return
        scope[_LIMIT] = self._limit_bytes
        stated = header(scope, b"content-length")
        n_bytes = 0

        async def limited() -> Message:
            nonlocal n_bytes
            if stated.isdecimal() and int(stated) > scope[_LIMIT]:
                raise BodyTooLargeError(scope[_LIMIT])
            message = await receive()
            n_bytes += len(message.get("body", b""))
            if n_bytes > scope[_LIMIT]:
                raise BodyTooLargeError(scope[_LIMIT])
            return message

        await self._app(scope, limited, send)


def allow(scope: Scope, limit_bytes: int) -> None:
    """Let a body be read that is not held in memory."""
    scope[_LIMIT] = max(limit_bytes, scope.get(_LIMIT, 0))
