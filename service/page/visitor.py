"""Who looks at a page, and what the page may do for them: asked anew at every action."""

from collections.abc import Callable
from typing import TypeVar, cast

from fastapi import Request
from nicegui import ui
from starlette.concurrency import run_in_threadpool

from calib.errors import DarkflatError
from service.api.access import AccessError, who_asks
from service.api.dependencies import Parts
from service.page.live import Live
from service.page.page_headers import PLACE
from service.page.sessions import COOKIE, Sessions
from service.runs.commands import RunCommands
from service.store.actor import Actor
from service.store.errors import StoreError
from service.store.keys import Scope

SIGN_IN = f"{PLACE}/sign-in"
Found = TypeVar("Found")


def parts_of(request: Request) -> Parts:
    """Return what the service was started with."""
    return cast("Parts", request.app.state.parts)


def sessions_of(request: Request) -> Sessions:
    """Return who has signed in."""
    return cast("Sessions", request.app.state.sessions)


class Visitor:
    """One browser's look at one view.

    Attributes:
        parts: Of the service.
        live: What the bench has seen lately; None where there is no bench.
    """

    def __init__(self, request: Request) -> None:
        self.parts = parts_of(request)
        self.live = cast("Live | None", request.app.state.live)
        self._sessions = sessions_of(request)
        self._token = request.cookies.get(COOKIE)
        self._address = request.client.host if request.client else ""
        self._asked = request.query_params

    def asked(self, name: str) -> str:
        """Return what the address says behind `?name=`; empty where nothing."""
        return self._asked.get(name, "")

    @property
    def has_session(self) -> bool:
        """Whether a key was shown."""
        return self._sessions.key(self._token) is not None

    async def actor(self, scope: Scope) -> Actor:
        """Return who this is; AccessError where they do not hold `scope` now."""
        key = self._sessions.key(self._token)
        try:
            return await who_asks(self.parts, self._address, key, scope)
        except AccessError as error:
            if error.code == "key-refused":  # over meanwhile: not a try, and not to be tried again
                self._sessions.end(self._token)
            raise

    def commands(self) -> RunCommands:
        """Return what may be asked of the bench; StoreError `no-bench` where there is none."""
        if self.parts.keeper is None:
            msg = "this service has no bench; start it with --bench bench.toml"
            raise StoreError(msg, code="no-bench")
        return RunCommands(self.parts.store, self.parts.keeper)

    async def act(self, scope: Scope, work: Callable[[Actor], Found]) -> Found | None:
        """Do `work` in a thread where `scope` is held; what goes wrong is shown, and gives None."""
        try:
            return await run_in_threadpool(work, await self.actor(scope))
        except DarkflatError as error:
            say(error)
            return None

    async def read(self, look: Callable[[], Found]) -> Found | None:
        """Do `look` in a thread; what goes wrong is shown, and gives None."""
        return await self.act(Scope.READ, lambda _: look())


def say(what: DarkflatError | str) -> None:
    """Show one sentence for a while; an error until it is closed."""
    if isinstance(what, DarkflatError):
        ui.notify(str(what), type="negative", multi_line=True, timeout=0, close_button="Close")
    else:
        ui.notify(what, type="positive", multi_line=True, timeout=6000)
