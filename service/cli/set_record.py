"""How commands answer with a record of the store."""

from collections.abc import Callable, Sequence
from dataclasses import asdict
from datetime import UTC, datetime
from typing import Any

from rich.console import Console

from service.cli.tables import facts, table
from service.store.records import SetRecord


def told(record: SetRecord) -> dict[str, Any]:
    """Return a record, ready for JSON."""
    return asdict(record)


def show_record(record: SetRecord) -> Callable[[Console], None]:
    """Return what prints one record with its life."""

    def to(console: Console) -> None:
        facts(
            console,
            {
                "coefficient set": record.id,
                "state": record.state.value,
                "camera": f"{record.camera_serial or '–'}, band {record.band or '–'},"
                f" {record.gain_db:g} dB, {record.bit_depth} bits, {record.columns} columns",
                "holds": validity(record),
                "recording": record.recording_digest,
            },
        )
        steps = [
            (each.at.isoformat(timespec="seconds"), each.after.value, each.by, each.reason)
            for each in record.transitions
        ]
        table(console, ("when", "became", "by", "why"), steps)

    return to


def show_records(records: Sequence[SetRecord]) -> Callable[[Console], None]:
    """Return what prints a list of records."""

    def to(console: Console) -> None:
        rows = [
            (
                record.id[:12],
                record.state.value,
                record.camera_serial,
                record.band,
                f"{record.gain_db:g}",
                str(record.bit_depth),
                validity(record),
            )
            for record in records
        ]
        table(console, ("id", "state", "camera", "band", "gain dB", "bits", "holds"), rows)

    return to


def validity(record: SetRecord) -> str:
    """Return for which times a set holds, as a person reads it."""
    held = record.certification
    if held is None or record.state.value == "revoked":
        return "–"
    until = "open" if held.until is None else f"{held.until:%Y-%m-%d %H:%M}"
    return f"{held.valid_from:%Y-%m-%d %H:%M} – {until} UTC"


def utc(at: datetime | None) -> datetime | None:
    """Return a time of the command line, which means UTC where it does not say otherwise."""
    return at.replace(tzinfo=UTC) if at is not None and at.tzinfo is None else at
