"""Times in the store: always UTC, always aware."""

from datetime import UTC, datetime
from typing import Any

from sqlalchemy import DateTime, Dialect
from sqlalchemy.types import TypeDecorator

from calib.errors import InputError


class UtcDateTime(TypeDecorator[datetime]):
    """An aware datetime in, UTC out; SQLite keeps it as text that sorts by time."""

    impl = DateTime(timezone=True)
    cache_ok = True

    def process_bind_param(self, value: datetime | None, dialect: Dialect) -> datetime | None:
        """Return UTC, without its zone where the database cannot keep one."""
        if value is None:
            return None
        utc = aware(value, "a time")
        return utc.replace(tzinfo=None) if dialect.name == "sqlite" else utc

    def process_result_value(self, value: Any | None, dialect: Dialect) -> datetime | None:  # noqa: ARG002
        """Return an aware time in UTC."""
        if value is None:
            return None
        read: datetime = value
        return read.replace(tzinfo=UTC) if read.tzinfo is None else read.astimezone(UTC)


def aware(at: datetime, name: str) -> datetime:
    """Return `at` in UTC; InputError `naive-time` when it does not say its zone."""
    if at.tzinfo is None:
        msg = f"{name} {at.isoformat()} does not say its time zone: write {at.isoformat()}Z"
        raise InputError(msg, code="naive-time")
    return at.astimezone(UTC)
