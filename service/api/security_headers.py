"""What browsers are told of every answer: to take nothing from elsewhere, and to show it nowhere.

Source: OWASP HTTP Security Response Headers Cheat Sheet; Content Security Policy Level 3.
"""

from typing import Final

from starlette.datastructures import MutableHeaders
from starlette.types import ASGIApp, Message, Receive, Scope, Send

DATA_POLICY: Final = "default-src 'none'; frame-ancestors 'none'"
"""Answers of the API are data: nothing in them is ever run or loaded."""
PAGE_POLICY: Final = (
    "object-src 'none'; base-uri 'self'; form-action 'self'; frame-ancestors 'none'"
)
"""Of everything else: the page."""

_DATA_PATHS: Final = ("/v1/", "/healthz", "/readyz", "/metrics", "/openapi.json")
_ALWAYS: Final = {
    "X-Content-Type-Options": "nosniff",
    "X-Frame-Options": "DENY",
    "Referrer-Policy": "no-referrer",
    "Cross-Origin-Opener-Policy": "same-origin",
    "Cross-Origin-Resource-Policy": "same-origin",
    "Permissions-Policy": "camera=(), microphone=(), geolocation=(), usb=(), serial=()",
}


class SecurityHeaders:
    """Adds what an answer does not say itself."""

    def __init__(self, app: ASGIApp) -> None:
        self._app = app

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Pass on the request, and mark its answer."""
        is_data = scope["type"] == "http" and scope["path"].startswith(_DATA_PATHS)

        async def marked(message: Message) -> None:
            if message["type"] == "http.response.start":
                headers = MutableHeaders(scope=message)
                policy = DATA_POLICY if is_data else PAGE_POLICY
                for name, value in {**_ALWAYS, "Content-Security-Policy": policy}.items():
                    headers.setdefault(name, value)
                if is_data:  # a bench's state is of now, and who may read it depends on the key
                    headers.setdefault("Cache-Control", "no-store")
            await send(message)

        await self._app(scope, receive, marked)
