"""`darkflat audit list`: what was done."""

from typing import TYPE_CHECKING

from service.cli.answering import Json, answering
from service.cli.shared_options import Before, Limit

if TYPE_CHECKING:
    from collections.abc import Sequence

    from rich.console import Console

    from service.store.audit import AuditEntry


def list_entries(
    *,
    limit: Limit = 100,
    before: Before = None,
    json: Json = None,
) -> None:
    """List what was done, newest first."""
    with answering(json) as answer:
        from dataclasses import asdict  # noqa: PLC0415

        from service.cli.opened_store import opened_store  # noqa: PLC0415

        with opened_store() as store:
            page = store.audit.list(limit=limit, before=before)
        content = {"items": [asdict(each) for each in page.items], "next_before": page.next_before}
        answer.give(content, lambda console: _show(console, page.items))


def _show(console: "Console", entries: "Sequence[AuditEntry]") -> None:
    from service.cli.tables import table  # noqa: PLC0415

    rows = [
        (
            str(each.number), f"{each.at:%Y-%m-%d %H:%M:%S}", each.who, each.key_id, each.action,
            each.subject[:16],
        )
        for each in entries
    ]  # fmt: skip
    table(console, ("number", "UTC", "who", "key", "did", "to"), rows)
