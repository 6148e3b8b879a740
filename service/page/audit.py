"""The audit log: who did what, and the proof that nothing was changed, removed or inserted."""

import json

from nicegui import ui

from service.page.frame import keep_fresh, view
from service.page.tables import fill, table, text
from service.page.visitor import Visitor
from service.store.audit import AuditEntry

_REFRESH_S = 2.0
_SHOWN = 500


@view("/audit")
async def show(visitor: Visitor) -> None:
    """The newest entries, and a button that proves all."""
    audit = visitor.parts.store.audit
    with ui.element("section").classes("df-card").props('aria-label="Audit log"'):
        proven = ui.label("The proof goes through every entry, from the first one on.").props(
            'role="status"'
        )

        async def verify() -> None:
            found = await visitor.read(audit.verify)
            if found is None:
                proven.set_text("The log is not whole.")
                return
            number, digest = found
            proven.set_text(f"Whole: {number} entries, the last digest is {digest}")

        ui.button("Verify", on_click=verify).props("outline no-caps")
        listed = table(
            {
                "key": "no.",
                "at": "at",
                "who": "who",
                "key_id": "key",
                "action": "what",
                "subject": "to what",
                "change": "before → after",
            },
            label="Audit entries, newest first",
            rows=15,
        )
        ui.label(f"The newest {_SHOWN} entries.").classes("df-note")

    async def refresh() -> None:
        found = await visitor.read(lambda: audit.list(limit=_SHOWN).items)
        fill(listed, [_row(entry) for entry in found or ()])

    await refresh()
    keep_fresh(visitor, refresh, _REFRESH_S)


def _row(entry: AuditEntry) -> dict[str, object]:
    states = (entry.before, entry.after)
    said = [json.dumps(s, ensure_ascii=False, default=str) if s else "–" for s in states]
    return {
        "key": entry.number,
        "name": entry.number,
        "at": text(entry.at),
        "who": entry.who,
        "key_id": entry.key_id or "–",
        "action": entry.action,
        "subject": entry.subject[:16],
        "change": "" if said == ["–", "–"] else " → ".join(said),
    }
