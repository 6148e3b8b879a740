"""Which names the service answers to: none that a foreign page could point at this machine."""

from starlette.types import ASGIApp, Receive, Scope, Send

from service.api.problems import problem
from service.api.refusing import refuse
from service.api.request_headers import header, host_of

LOOPBACK = frozenset({"127.0.0.1", "localhost", "[::1]"})


class OnlyKnownHosts:
    """Refuses requests whose `Host` is another one: a defence against DNS rebinding."""

    def __init__(self, app: ASGIApp, hosts: frozenset[str] = frozenset()) -> None:
        self._app = app
        self._hosts = LOOPBACK | hosts

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Pass on what is addressed to a known host."""
        if scope["type"] in {"http", "websocket"} and host_of(scope) not in self._hosts:
            detail = "this service does not go by that name: ask it by 127.0.0.1, localhost or one"
            answer = problem(421, f"{detail} of DARKFLAT_HOSTS", "unknown-host")
            await refuse(answer, scope, receive, send)
            return
        await self._app(scope, receive, send)


class OnlyOwnPages:
    """Refuses what another site's page has a browser do here: no form, no script, no socket of it.

    A browser says in `Origin` whose page asks for anything but a plain GET; programs send none.
    """

    _HARMLESS = frozenset({"GET", "HEAD", "OPTIONS"})

    def __init__(self, app: ASGIApp) -> None:
        self._app = app

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Pass on what comes from no page, or from one of ours."""
        origin = header(scope, b"origin").lower()
        own = {f"{scheme}://{header(scope, b'host').lower()}" for scheme in ("http", "https")}
        acts = scope["type"] == "websocket" or scope.get("method") not in self._HARMLESS
        if scope["type"] in {"http", "websocket"} and acts and origin and origin not in own:
            answer = problem(403, "a page of another site may not do this here", "foreign-page")
            await refuse(answer, scope, receive, send)
            return
        await self._app(scope, receive, send)
