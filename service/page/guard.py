"""Who may talk to the page from a browser: itself, and no other site; and what it may load.

A foreign page cannot read what this machine answers, but it could open a socket to it or send a
form. Browsers say where such a request comes from (`Origin`, RFC 6454): it has to be here.
"""

from starlette.datastructures import MutableHeaders
from starlette.types import ASGIApp, Message, Receive, Scope, Send

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
    """Refuses what comes from another site, and adds the headers that browsers obey.

    That `Host` is a name of this service is for `OnlyKnownHosts` to see.
    """

    def __init__(self, app: ASGIApp) -> None:
        self._app = app

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Pass on what is not the page's, or comes from the page itself."""
        if scope["type"] not in {"http", "websocket"} or not _is_of_page(scope["path"]):
            await self._app(scope, receive, send)
        elif _comes_from_here(scope):
            await self._app(scope, receive, _adding_headers(send))
        elif scope["type"] == "websocket":
            await send({"type": "websocket.close", "code": 1008})
        else:
            detail = "this came from another site; open the page itself"
            await problem(403, detail, "foreign-origin")(scope, receive, send)


def _is_of_page(path: str) -> bool:
    return path == PLACE or path.startswith(f"{PLACE}/")


def _comes_from_here(scope: Scope) -> bool:
    headers = dict(scope["headers"])
    host = headers.get(b"host", b"").decode("latin-1").lower()
    origin = headers.get(b"origin", b"").decode("latin-1").lower()
    if not origin:  # browsers say it with each socket and each form
        return scope["type"] == "http" and scope["method"] in {"GET", "HEAD"}
    return origin in {f"http://{host}", f"https://{host}"}


def _adding_headers(send: Send) -> Send:
    async def sent(message: Message) -> None:
        if message["type"] == "http.response.start":
            headers = MutableHeaders(scope=message)
            for name, value in _HEADERS.items():
                headers.setdefault(name, value)
        await send(message)

    return sent
