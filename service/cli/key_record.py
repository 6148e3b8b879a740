"""How commands answer with a key: never with its secret."""

from collections.abc import Callable, Sequence
from dataclasses import asdict
from datetime import UTC, datetime
from typing import Any

from rich.console import Console

from service.cli.tables import table
from service.store.keys import KeyRecord


def told(record: KeyRecord) -> dict[str, Any]:
    """Return a key's record, ready for JSON."""
    return {**asdict(record), "good": record.is_good_at(datetime.now(UTC))}


def show_keys(records: Sequence[KeyRecord]) -> Callable[[Console], None]:
    """Return what prints keys as a table."""

    def to(console: Console) -> None:
        rows = [
            (each.id, each.name, each.scope.value, f"{each.created_at:%Y-%m-%d}", _end(each))
            for each in records
        ]
        table(console, ("id", "name", "scope", "made", "good"), rows)

    return to


def _end(record: KeyRecord) -> str:
    """Return until when a key is good, as a person reads it."""
    if record.revoked_at is not None:
        return f"revoked {record.revoked_at:%Y-%m-%d %H:%M} UTC"
    if record.expires_at is None:
        return "until revoked"
    is_over = not record.is_good_at(datetime.now(UTC))
    return f"{'ended' if is_over else 'until'} {record.expires_at:%Y-%m-%d %H:%M} UTC"
