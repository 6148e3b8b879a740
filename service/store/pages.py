"""Lists in pages: by sequence, newest first, so that what is added meanwhile moves no page."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Generic, TypeVar

from sqlalchemy import Select
from sqlalchemy.orm import InstrumentedAttribute, Session

LARGEST = 500

Row = TypeVar("Row")
Item = TypeVar("Item")


@dataclass(frozen=True)
class Page(Generic[Item]):
    """Some items; `next_before` asks for those that follow, None where there are none."""

    items: tuple[Item, ...]
    next_before: int | None


def page(
    session: Session,
    query: Select[Row],
    sequence: InstrumentedAttribute[int],
    record: Callable[[Row], Item],
    *,
    limit: int,
    before: int | None,
) -> Page[Item]:
    """Return at most `limit` items of `query`, newest first, older than `before`."""
    if before is not None:
        query = query.where(sequence < before)
    limit = max(1, min(limit, LARGEST))
    rows: list[Any] = list(session.scalars(query.order_by(sequence.desc()).limit(limit + 1)))
    more = getattr(rows[limit - 1], sequence.key) if len(rows) > limit else None
    return Page(tuple(record(row) for row in rows[:limit]), more)
