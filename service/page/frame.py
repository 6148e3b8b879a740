"""What every view has around it: where one can go, how the bench is, and safe-off."""

from collections.abc import Awaitable, Callable
from typing import Final

from fastapi import Request
from fastapi.responses import RedirectResponse, Response
from nicegui import ui

from service.api.access import AccessError
from service.api.answers.bench import LampsOff
from service.page.page_headers import PLACE
from service.page.sign_in import HERE
from service.page.visitor import SIGN_IN, Visitor, say
from service.store.actor import Actor
from service.store.keys import Scope

Body = Callable[[Visitor], Awaitable[None]]

VIEWS: Final = {
    "/": "Bench",
    "/runs": "Runs",
    "/recordings": "Recordings",
    "/coefficient-sets": "Coefficient sets",
    "/correction": "Correction",
    "/sensor": "Sensor",
    "/diagnosis": "Diagnosis",
    "/audit": "Audit",
}
_STATE_S = 1.0
_BUSY_S = 30.0
"""So long a view may take on a machine that measures and calculates; then the browser is told."""


def view(path: str) -> Callable[[Body], Body]:
    """Show the decorated function's view at `path`, for who may read; others are asked to sign in.

    Args:
        path: One of `VIEWS`.
    """

    def register(body: Body) -> Body:
        async def shown(request: Request) -> Response | None:
            visitor = Visitor(request)
            try:
                who = await visitor.actor(Scope.READ)
            except AccessError:
                return RedirectResponse(SIGN_IN)
            ui.add_css(HERE / "style.css")
            main = ui.element("main").classes("df-main")
            _header(visitor, who, path)
            ui.skip_link("Skip to the content", target=main)
            with main:
                with ui.element("h1").classes("df-title"):
                    ui.label(VIEWS[path])
                await body(visitor)
            return None

        title = f"{VIEWS[path]} · darkflat"
        ui.page(path, title=title, response_timeout=_BUSY_S)(shown)
        return body

    return register


def keep_fresh(visitor: Visitor, refresh: Callable[[], Awaitable[None]], every_s: float) -> None:
    """Call `refresh` again and again while the visitor may read; else they are asked to sign in."""

    async def tick() -> None:
        try:
            await visitor.actor(Scope.READ)
        except AccessError:
            ui.navigate.to(SIGN_IN.removeprefix(PLACE))
            return
        await refresh()

    ui.timer(every_s, tick)


def _header(visitor: Visitor, who: Actor, here: str) -> None:
    with ui.header().classes("df-header"):
        ui.label("darkflat").classes("df-brand")
        with ui.element("nav").props('aria-label="Views"').classes("df-nav"):
            for path, name in VIEWS.items():
                link = ui.link(name, path)
                if path == here:
                    link.props('aria-current="page"')
        ui.space()
        _bench_state(visitor)
        if visitor.has_session:
            with ui.element("form").props(f'method="post" action="{PLACE}/sign-out"'):
                ui.button(f"Sign out {who.name}").props('type="submit" flat dense no-caps')
        safe_off_button(visitor)


def _bench_state(visitor: Visitor) -> None:
    label = ui.label().classes("df-state").props('role="status"')

    async def refresh() -> None:
        keeper = visitor.parts.keeper
        if keeper is None:
            label.set_text("no bench")
            return
        run = await visitor.read(visitor.parts.store.runs.under_way)
        holder = "" if run is None else f" · held by {run.submitted_by}"
        dark = " · kept dark" if keeper.darkness.kept and not holder else ""
        label.set_text(f"bench {keeper.owner.state}{holder}{dark}")

    keep_fresh(visitor, refresh, _STATE_S)


def safe_off_button(visitor: Visitor) -> None:
    """Show the button that ends what runs and switches every lamp off, at one press."""

    async def press() -> None:
        look = await visitor.act(Scope.OPERATE, lambda by: visitor.commands().safe_off(by))
        if look is None:
            return
        off = LampsOff.of(look)
        if off.dark:
            say("Every lamp is off, and reads back as off")
            return
        silent = [d.identity or d.role for d in off.devices if d.trouble is not None]
        ui.notify(
            f"Not proven dark: {', '.join(silent)} could not be read back; look at the lamps",
            type="negative",
            timeout=0,
            close_button="Close",
        )

    ui.button("Safe-off", on_click=press).classes("df-safe-off").props(
        'color="negative" unelevated no-caps aria-label="Safe-off: switch every lamp off now"'
    )
