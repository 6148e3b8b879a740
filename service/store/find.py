"""The one row that goes by a name."""

from typing import TypeVar

from sqlalchemy import select
from sqlalchemy.orm import InstrumentedAttribute, Session

from service.store.errors import NotInStoreError
from service.store.tables import Base

Row = TypeVar("Row", bound=Base)


def find(
    session: Session, table: type[Row], column: InstrumentedAttribute[str], name: str, *, else_: str
) -> Row:
    """Return the row of `table` whose `column` is `name`; NotInStoreError says `else_`.

    No name holds a NUL, which PostgreSQL refuses to look for and SQLite does not.
    """
    row = None if "\0" in name else session.scalar(select(table).where(column == name))
    if row is None:
        raise NotInStoreError(else_)
    return row
