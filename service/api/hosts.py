"""Which names the service answers to: none that a foreign page could point at this machine."""

from starlette.types import ASGIApp, Receive, Scope, Send

from service.api.problems import problem

LOOPBACK = frozenset({"127.0.0.1", "localhost", "[::1]"})


class OnlyKnownHosts:
    """Refuses requests whose `Host` is another one: a defence against DNS rebinding."""

    def __init__(self, app: ASGIApp, hosts: frozenset[str] = LOOPBACK) -> None:
        self._app = app
        self._hosts = hosts

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Pass on what is addressed to a known host."""
        if scope["type"] == "http" and _host(scope) not in self._hosts:
            detail = "this service answers to 127.0.0.1 and localhost only; ask it by that name"
            await problem(421, detail, "unknown-host")(scope, receive, send)
            return
        await self._app(scope, receive, send)


def _host(scope: Scope) -> str:
    """Return the name in the `Host` header without its port, in lower case."""
    given = next((value for name, value in scope["headers"] if name == b"host"), b"")
    text = given.decode("latin-1").lower()
    name, colon, port = text.rpartition(":")
    return name if colon and port.isdecimal() else text
