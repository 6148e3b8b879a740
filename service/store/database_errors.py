"""What a database says when something is wrong, in one sentence."""

import sqlite3
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Final

from sqlalchemy.exc import DatabaseError, DataError, OperationalError

from calib.errors import DarkflatError, InputError
from service.store.errors import StoreError

# PostgreSQL's manual, appendix A: error codes.
_BUSY: Final = frozenset({"55P03", "40001", "40P01"})
"""Lock not available, serialization failure, deadlock: nothing was done, and may be tried again."""
_FULL: Final = frozenset({"53100"})
_NO_RIGHT: Final = frozenset({"42501", "25006"})
"""Insufficient privilege, read-only transaction."""


@contextmanager
def store_errors() -> Iterator[None]:
    """Turn what the database says into a DarkflatError; a defect of ours stays what it is."""
    try:
        yield
    except DatabaseError as error:
        told = _told(error)
        if told is None:
            raise
        raise told from error
    except (UnicodeEncodeError, OverflowError) as error:  # half a surrogate pair, 2^63
        raise _not_storable(str(error)) from error


def _told(error: DatabaseError) -> DarkflatError | None:
    text = " ".join(str(error.orig).split())
    state = getattr(error.orig, "sqlstate", None)
    if state in _BUSY or (_is_sqlite(error) and ("locked" in text or "busy" in text)):
        msg = "another process has been writing to the store for too long; try again"
        return StoreError(msg, code="store-busy")
    if state in _FULL or (_is_sqlite(error) and "full" in text):
        msg = "no space left for the store; free some, or set DARKFLAT_HOME elsewhere"
        return StoreError(msg, code="disk-full")
    if isinstance(error, OperationalError) or state in _NO_RIGHT:
        msg = f"the store cannot be used ({text}); {_where_to_look(error)}"
        return StoreError(msg, code="store-not-writable")
    if _is_sqlite(error) and "not a database" in text:
        msg = f"the store's file is not a database ({text}); restore it from a copy"
        return StoreError(msg, code="store-damaged")
    if isinstance(error, DataError):
        return _not_storable(text)
    return None


def _not_storable(why: str) -> InputError:
    return InputError(f"the store cannot keep that ({why}); correct it", code="not-storable")


def _is_sqlite(error: DatabaseError) -> bool:
    return isinstance(error.orig, sqlite3.Error)


def _where_to_look(error: DatabaseError) -> str:
    if _is_sqlite(error):
        return "look at DARKFLAT_HOME and its rights"
    return "look at DARKFLAT_STORE_URL, at the server, and at its user's rights"
