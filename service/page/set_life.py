"""What may be done with a coefficient set next; each step but the first says why."""

from collections.abc import Awaitable, Callable
from datetime import UTC, datetime

from nicegui import ui

from calib.errors import InputError
from service.page.visitor import Visitor, say
from service.store.actor import Actor
from service.store.keys import Scope
from service.store.records import SetRecord
from service.store.state import NEXT, SetState

Show = Callable[[str], Awaitable[None]]
Work = Callable[[Actor], SetRecord]


def draw_life(visitor: Visitor, record: SetRecord, show: Show) -> None:
    """Draw the steps that are possible from where `record` stands; `show` is called after one."""
    sets, possible = visitor.parts.store.sets, NEXT[record.state]
    if not possible:
        return
    reason = ui.input("Reason").props('outlined dense maxlength="2000"').classes("df-wide")

    async def take(scope: Scope, work: Work) -> None:
        after = await visitor.act(scope, work)
        if after is not None:
            say(f"Set {after.id[:8]} is {after.state}")
            await show(after.id)

    async def verify() -> None:
        await take(
            Scope.OPERATE, lambda by: sets.verify(record.id, by=by, reason=reason.value or "")
        )

    async def revoke() -> None:
        await take(
            Scope.CERTIFY, lambda by: sets.revoke(record.id, by=by, reason=reason.value or "")
        )

    if SetState.VERIFIED in possible:
        ui.button("Verify", on_click=verify).props("outline no-caps")
    if SetState.CERTIFIED in possible:
        _draw_certify(visitor, record, reason, take)
    if SetState.REVOKED in possible:
        ui.button("Revoke", on_click=revoke).props('unelevated no-caps color="negative"')


def _draw_certify(
    visitor: Visitor,
    record: SetRecord,
    reason: ui.input,
    take: Callable[[Scope, Work], Awaitable[None]],
) -> None:
    today = f"{datetime.now(UTC):%Y-%m-%d}"
    with ui.row().classes("df-actions"):
        begin = ui.input("Valid from (UTC)", value=today).props('type="date" outlined dense')
        end = ui.input("until, excluded; empty: open").props(
            'type="date" outlined dense stack-label'
        )
    supersedes = ui.input("Supersedes (ids, by commas)").props("outlined dense").classes("df-wide")

    def certified(by: Actor) -> SetRecord:
        named = (each.strip() for each in (supersedes.value or "").split(","))
        return visitor.parts.store.sets.certify(
            record.id,
            valid_from=_day(begin.value, "the first day"),
            valid_until=_day(end.value, "the last day") if end.value else None,
            by=by,
            reason=reason.value or "",
            supersedes=[each for each in named if each],
        )

    async def certify() -> None:
        await take(Scope.CERTIFY, certified)

    ui.button("Certify", on_click=certify).props('unelevated no-caps color="secondary"')


def _day(written: str | None, what: str) -> datetime:
    try:
        return datetime.fromisoformat(written or "").replace(tzinfo=UTC)
    except ValueError as error:
        msg = f"{what} of the validity is not a date: {written!r}; give year-month-day"
        raise InputError(msg, code="bad-validity") from error
