"""What was done, by whom: a log to which one can only add, each entry bound to all before it.

The digest of an entry is SHA-256 over the digest before it and its own canonical JSON. Whoever
changes, removes or inserts an entry breaks the chain from there on; whoever cuts its end off must
be found by the last digest, which is worth writing down elsewhere.
"""

import hashlib
import json
from collections.abc import Collection, Generator
from contextlib import closing
from dataclasses import dataclass
from datetime import UTC, datetime
from typing import Any

from sqlalchemy import Engine, select
from sqlalchemy.orm import Session

from service.store.actor import Actor
from service.store.engine import reading_session, writing_session
from service.store.errors import StoreError
from service.store.pages import Page, page
from service.store.plain_json import plain
from service.store.tables import AuditRow

START = "0" * 64
"""What the first entry follows."""
_AT_ONCE = 1000


@dataclass(frozen=True)
class AuditEntry:
    """One thing that was done: to what, and how it was before and after."""

    number: int
    at: datetime
    who: str
    key_id: str
    action: str
    subject: str
    before: dict[str, Any] | None
    after: dict[str, Any] | None
    digest: str


def append(
    session: Session,
    actor: Actor,
    action: str,
    subject: str,
    *,
    before: dict[str, Any] | None = None,
    after: dict[str, Any] | None = None,
) -> None:
    """Add an entry in the transaction that does what it tells: both are kept, or neither.

    The session is a writing one, so nobody adds an entry in between.
    """
    last = session.scalar(select(AuditRow).order_by(AuditRow.number.desc()).limit(1))
    row = AuditRow(
        number=1 if last is None else last.number + 1,
        at=datetime.now(UTC),
        who=actor.name,
        key_id=actor.key_id,
        action=action,
        subject=subject,
        before=plain(before),
        after=plain(after),
        previous=START if last is None else last.digest,
    )
    row.digest = _digest(row)
    session.add(row)
    session.flush()


class Audit:
    """The log."""

    def __init__(self, engine: Engine) -> None:
        self._engine = engine

    def record(self, actor: Actor, action: str, subject: str, **states: Any) -> None:
        """Add an entry for what changes nothing else in the store."""
        with writing_session(self._engine) as session:
            append(session, actor, action, subject, **states)

    def list(self, *, limit: int = 100, before: int | None = None) -> Page[AuditEntry]:
        """Return a page of entries, newest first."""
        with reading_session(self._engine) as session:
            query = select(AuditRow)
            return page(session, query, AuditRow.number, _entry, limit=limit, before=before)

    def newest(self, subject: str, actions: Collection[str]) -> AuditEntry | None:
        """Return the newest entry about `subject` that tells one of these actions."""
        query = (
            select(AuditRow)
            .where(AuditRow.subject == subject, AuditRow.action.in_(actions))
            .order_by(AuditRow.number.desc())
            .limit(1)
        )
        with reading_session(self._engine) as session:
            row = session.scalar(query)
            return None if row is None else _entry(row)

    def last_actions(self) -> dict[str, str]:
        """Return, by subject, what was done to it last."""
        query = select(AuditRow.subject, AuditRow.action).order_by(AuditRow.number)
        with reading_session(self._engine) as session:
            return {row.subject: row.action for row in session.execute(query)}

    def verify(self, *, expect: str | None = None) -> tuple[int, str]:
        """Return the number of entries and the last digest, once all are proven.

        Args:
            expect: The last digest as it once was; some entry must still have it.

        Raises:
            StoreError: `audit-broken`, naming the first entry that does not follow, or
                `audit-cut-off`.
        """
        number, digest = 0, START
        found = expect in {None, START}
        with closing(self._rows()) as rows:
            for row in rows:
                number += 1
                if row.number != number or row.previous != digest or row.digest != _digest(row):
                    raise _broken(row, number)
                digest = row.digest
                found = found or digest == expect
        if not found:
            msg = (
                f"the audit log is whole up to entry {number}, but no entry has the digest"
                f" {expect}: its end was cut off, or the digest is another log's; compare with a"
                " copy"
            )
            raise StoreError(msg, code="audit-cut-off")
        return number, digest

    def _rows(self) -> Generator[AuditRow, None, None]:
        query = select(AuditRow).order_by(AuditRow.number).execution_options(yield_per=_AT_ONCE)
        with reading_session(self._engine) as session, closing(session.scalars(query)) as rows:
            yield from rows


def _broken(row: AuditRow, number: int) -> StoreError:
    msg = (
        f"audit entry {row.number} does not follow from those before it: it or entry"
        f" {number} was changed, removed or inserted; compare with a copy"
    )
    return StoreError(msg, code="audit-broken")


def _digest(row: AuditRow) -> str:
    content = [
        row.number, row.at.astimezone(UTC).isoformat(timespec="microseconds"), row.who, row.key_id,
        row.action, row.subject, row.before, row.after,
    ]  # fmt: skip
    canonical = json.dumps(content, sort_keys=True, ensure_ascii=False, allow_nan=False)
    return hashlib.sha256(f"{row.previous}{canonical}".encode()).hexdigest()


def _entry(row: AuditRow) -> AuditEntry:
    return AuditEntry(
        row.number, row.at, row.who, row.key_id, row.action, row.subject, row.before, row.after,
        row.digest,
    )  # fmt: skip
