"""A table of jobs that stays as they are, beside the one that was chosen."""

from collections.abc import Awaitable, Callable, Container
from typing import Final

from nicegui import ui

from service.page.frame import keep_fresh
from service.page.tables import fill
from service.page.visitor import Visitor
from service.store.records import JobRecord

_REFRESH_S: Final = 2.0


async def keep_listed(
    visitor: Visitor,
    listed: ui.table,
    kinds: Container[str],
    row: Callable[[JobRecord], dict[str, object]],
    show: Callable[[str], Awaitable[None]],
) -> None:
    """Keep in `listed` a row of each job of `kinds`; show the one that the page's address names."""

    async def refresh() -> None:
        found = await visitor.read(lambda: visitor.parts.store.jobs.list(limit=500).items)
        fill(listed, [row(job) for job in found or () if job.kind in kinds])

    if visitor.asked("job"):
        await show(visitor.asked("job"))
    await refresh()
    keep_fresh(visitor, refresh, _REFRESH_S)
