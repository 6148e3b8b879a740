"""What browsers are told of the page: more than of data, for it runs scripts; all of them ours.

Which sites may ask anything of the page is for `OnlyOwnPages` to see, as of all of the service.
"""

from starlette.datastructures import MutableHeaders
from starlette.types import ASGIApp, Message, Receive, Scope, Send

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
    # With `no-referrer`, as of data, browsers would not say in `Origin` that a form is ours.
    "Referrer-Policy": "same-origin",
}


class PageHeaders:
    """Adds them to the page's answers; what is told of every answer, `SecurityHeaders` adds."""

    def __init__(self, app: ASGIApp) -> None:
        self._app = app

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Pass on the request, and mark its answer where it is the page's."""
        is_ours = scope["type"] == "http" and f"{scope['path']}/".startswith(f"{PLACE}/")

        async def marked(message: Message) -> None:
            if is_ours and message["type"] == "http.response.start":
                headers = MutableHeaders(scope=message)
                for name, value in _HEADERS.items():
                    headers.setdefault(name, value)
            await send(message)

        await self._app(scope, receive, marked)
