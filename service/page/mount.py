"""Puts the page into the service: once per process, since its framework holds global state."""

from collections.abc import AsyncIterator
from contextlib import asynccontextmanager

from fastapi import FastAPI
from fastapi.responses import RedirectResponse
from nicegui import app as gui
from nicegui import core, ui
from starlette.middleware import Middleware

from calib.errors import DarkflatError
from service.page import (  # noqa: F401  (each registers its view)
    audit,
    bench,
    coefficient_sets,
    correction,
    diagnosis,
    job_files,
    recordings,
    runs,
    sensor,
    sign_in,
)
from service.page.live import Live
from service.page.page_headers import PLACE, PageHeaders
from service.page.sessions import Sessions

_RECONNECT_S = 30.0
"""A browser that is not heard for so long loads its view anew; on a busy machine 10 s are short."""


def mount_page(app: FastAPI) -> None:
    """Serve the page at `/page/`, where `/` leads.

    Raises:
        DarkflatError: `page-mounted`, this process has one already.
    """
    if gui.config.has_run_config:
        msg = "this process serves a page already; start another process for a second one"
        raise DarkflatError(msg, code="page-mounted")
    app.state.sessions = Sessions()
    gui.state = app.state  # its requests find the service's parts where the API's do
    # A poll is an ordinary request, which other sites may send; sockets always say where from.
    gui.config.socket_io_js_transports = ["websocket"]
    core.sio.eio.transports = ["websocket"]
    app.include_router(sign_in.router)
    app.include_router(job_files.router)
    _watch_bench(app)

    @app.get("/", include_in_schema=False)
    def _to_page() -> RedirectResponse:
        return RedirectResponse(f"{PLACE}/")

    ui.run_with(
        app,
        title="darkflat",
        mount_path=PLACE,
        dark=None,
        language="en-US",
        tailwind=False,
        reconnect_timeout=_RECONNECT_S,
        show_welcome_message=False,
    )
    # The innermost: what guards all of the service comes first, and may say more of an answer.
    app.user_middleware.append(Middleware(PageHeaders))


def _watch_bench(app: FastAPI) -> None:
    """Keep what the bench sees from the start on, not from when somebody looks."""
    opened = app.router.lifespan_context

    @asynccontextmanager
    async def watched(of: FastAPI) -> AsyncIterator[None]:
        async with opened(of):
            keeper = of.state.parts.keeper
            of.state.live = None if keeper is None else Live(keeper.news)
            yield

    app.router.lifespan_context = watched
