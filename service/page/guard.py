"""Who may talk to the page from a browser: itself, and no other site; and what it may load.

A foreign page cannot read what this machine answers, but it could open a socket to it or send a
form. Browsers say where such a request comes from (`Origin`, RFC 6454): it has to be here.
"""

from collections.abc import Iterable

from starlette.types import ASGIApp, Message, Receive, Scope, Send

from service.api.hosts import LOOPBACK
from service.api.problems import problem

PLACE = "/page"
"""Where the page is mounted."""

_HEADERS = {
    # Its framework compiles templates in the browser and writes styles into the document: hence
    # the two `unsafe`; nothing is loaded from, sent to, or framed by anywhere else.
    "Content-Security-Policy": (
        "default-src 'self'; script-src 'self' 'unsafe-inline' 'unsafe-eval' blob:;"
        " style-src 'self' 'unsafe-inline'; img-src 'self' data: blob:; font-src 'self' data:;"
        " connect-src 'self'; worker-src 'self' blob:; object-src 'none'; base-uri 'self';"
        " form-action 'self'; frame-ancestors 'none'"
    ),
    "X-Content-Type-Options": "nosniff",
    "X-Frame-Options": "DENY",
    "Referrer-Policy": "same-origin",
    "Cross-Origin-Opener-Policy": "same-origin",
    "Cross-Origin-Resource-Policy": "same-origin",
    "Permissions-Policy": "camera=(), microphone=(), geolocation=(), usb=(), serial=()",
}


class Guard:
    """Refuses what comes from another site, and adds the headers that browsers obey."""

    def __init__(self, app: ASGIApp, hosts: frozenset[str] = LOOPBACK) -> None:
        self._app = app
        self._hosts = hosts

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Pass on what is not the page's, or comes from the page itself."""
        if scope["type"] not in {"http", "websocket"} or not _is_of_page(scope["path"]):
            await self._app(scope, receive, send)
            return
        if not self._comes_from_here(scope):
            if scope["type"] == "websocket":
                await send({"type": "websocket.close", "code": 1008})
                return
            detail = "this came from another site; open the page itself"
            await problem(403, detail, "foreign-origin")(scope, receive, send)
            return
        await self._app(scope, receive, _adding_headers(send))

    def _comes_from_here(self, scope: Scope) -> bool:
        headers = dict(scope["headers"])
        host = headers.get(b"host", b"").decode("latin-1").lower()
        origin = headers.get(b"origin", b"").decode("latin-1").lower()
        if scope["type"] == "websocket" and _name(host) not in self._hosts:
            return False
        if not origin:  # browsers say it with each socket and each form
            return scope["type"] == "http" and scope["method"] in {"GET", "HEAD"}
        return origin in {f"http://{host}", f"https://{host}"}


def _is_of_page(path: str) -> bool:
    return path == PLACE or path.startswith(f"{PLACE}/")


def _name(host: str) -> str:
    name, colon, port = host.rpartition(":")
    return name if colon and port.isdecimal() else host


def _adding_headers(send: Send) -> Send:
    async def sent(message: Message) -> None:
        if message["type"] == "http.response.start":
            given: Iterable[tuple[bytes, bytes]] = message.get("headers", ())
            added = [(name.lower().encode(), value.encode()) for name, value in _HEADERS.items()]
            message = {**message, "headers": [*given, *added]}
        await send(message)

    return sent
