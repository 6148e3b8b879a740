"""That the bench is kept dark since safe-off, and the button that ends it."""

from collections.abc import Callable

from nicegui import ui

from service.page.tables import text
from service.page.visitor import Visitor, say
from service.runs.darkness import Darkness
from service.store.actor import Actor
from service.store.keys import Scope


def draw_kept_dark(visitor: Visitor, darkness: Darkness) -> Callable[[], None]:
    """Draw it here, to be seen while it is so; return what looks whether it is."""

    def release(by: Actor) -> bool:
        visitor.commands().release(by)
        return True

    async def press() -> None:
        if await visitor.act(Scope.OPERATE, release):
            refresh()
            say("The bench is released: runs begin")

    def refresh() -> None:
        kept = darkness.kept
        shown.set_visibility(kept is not None)
        if kept is not None:
            says.set_text(f"Kept dark since {text(kept.since)}, by {kept.by}: queued runs wait.")

    with ui.element("div") as shown:
        says = ui.label().classes("df-warn").props('role="status"')
        ui.button("Release the bench", on_click=press).props("outline no-caps")
    refresh()
    return refresh
