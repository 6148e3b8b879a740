"""Runs on record: what the bench was asked to measure, how far it came, and what it said."""

import uuid
from collections.abc import Mapping
from datetime import UTC, datetime
from typing import Any

from sqlalchemy import Engine, Select, func, select
from sqlalchemy.orm import Session

from service.store.actor import Actor
from service.store.audit import append
from service.store.engine import reading_session, writing_session
from service.store.errors import StoreError
from service.store.find import find
from service.store.pages import Page, page
from service.store.plain_json import plain
from service.store.run_records import (
    FINAL,
    RunEvent,
    RunRecord,
    RunState,
    check_move,
    event_record,
    run_record,
)
from service.store.tables import RunEventRow, RunRow

UNDER_WAY: tuple[RunState, ...] = ("running", "pausing", "paused", "aborting")
"""States in which a run has the bench."""


class Runs:
    """The records and the journal; who runs them is not the store's business."""

    def __init__(self, engine: Engine) -> None:
        self._engine = engine

    def submit(
        self,
        plan: Mapping[str, Any],
        digest: str,
        *,
        blocks_total: int,
        by: Actor,
        idempotency_key: str | None = None,
    ) -> tuple[RunRecord, bool]:
        """Queue a run; return it and whether it is new.

        Args:
            plan: As JSON knows it.
            digest: `Plan.digest()`.
            blocks_total: Of the plan.
            by: Who asks.
            idempotency_key: The same key with the same plan gives the same run.

        Raises:
            StoreError: `idempotency-mismatch`, the key was used with another plan.
        """
        with writing_session(self._engine) as session:
            if idempotency_key is not None:
                known = session.scalar(
                    select(RunRow).where(RunRow.idempotency_key == idempotency_key)
                )
                if known is not None:
                    return run_record(_same(known, digest)), False
            row = RunRow(
                id=uuid.uuid4().hex, state="queued", plan=plain(plan), request_digest=digest,
                idempotency_key=idempotency_key, attempts=0, blocks_done=0,
                blocks_total=blocks_total, submitted_at=datetime.now(UTC), submitted_by=by.name,
            )  # fmt: skip
            session.add(row)
            session.flush()
            _say(session, row.id, "state", {"state": "queued"})
            append(session, by, "run.submit", row.id, after={"plan": digest})
            return run_record(row), True

    def move(
        self,
        run_id: str,
        state: RunState,
        *,
        by: Actor | None = None,
        error: tuple[str, str] | None = None,
        result: Mapping[str, Any] | None = None,
        recording_digest: str | None = None,
    ) -> RunRecord:
        """Bring a run to `state`; one that is there already stays as it is.

        Args:
            run_id: Of the run.
            state: Where to.
            by: Who asked for it, where somebody did: it goes into the audit log.
            error: Code and message, where it failed.
            result: What came of it.
            recording_digest: Of what it recorded, once that is registered.

        Raises:
            IllegalTransitionError: No run goes that way.
        """
        with writing_session(self._engine) as session:
            row = _find(session, run_id)
            before = row.state
            if before == state:
                return run_record(row)
            check_move(row.id, before, state)
            _enter(row, state)
            row.error_code, row.error_message = error or (None, None)
            row.result = plain(result) if result is not None else row.result
            row.recording_digest = recording_digest or row.recording_digest
            _say(session, run_id, "state", {"state": state, "error": error and list(error)})
            if by is not None:
                append(session, by, f"run.{state}", run_id, before={"state": before})
            return run_record(row)

    def progress(self, run_id: str, kind: str, content: Mapping[str, Any]) -> RunEvent:
        """Add to a run's journal what it said; `blocks_done` in it is kept with the run."""
        with writing_session(self._engine) as session:
            row = _find(session, run_id)
            row.blocks_done = int(content.get("blocks_done", row.blocks_done))
            return event_record(_say(session, run_id, kind, content))

    def interrupt_all(self) -> tuple[str, ...]:
        """Mark the runs that had the bench when the service died; return their ids."""
        with writing_session(self._engine) as session:
            rows = list(
                session.scalars(
                    select(RunRow).where(RunRow.state.in_(UNDER_WAY)).order_by(RunRow.sequence)
                )
            )
            for row in rows:
                _enter(row, "interrupted")
                row.error_code = "interrupted"
                row.error_message = "the service ended during the run; resume it, or abort it"
                _say(session, row.id, "state", {"state": "interrupted", "error": None})
            return tuple(row.id for row in rows)

    def events(self, run_id: str, *, after: int = 0, limit: int = 500) -> tuple[RunEvent, ...]:
        """Return what a run said after event number `after`, oldest first."""
        with reading_session(self._engine) as session:
            _find(session, run_id)
            query = (
                select(RunEventRow)
                .where(RunEventRow.run_id == run_id, RunEventRow.number > after)
                .order_by(RunEventRow.number)
                .limit(limit)
            )
            return tuple(event_record(row) for row in session.scalars(query))

    def next_queued(self) -> RunRecord | None:
        """Return the run that waits longest."""
        return self._first(select(RunRow).where(RunRow.state == "queued"))

    def under_way(self) -> RunRecord | None:
        """Return the run that has the bench."""
        return self._first(select(RunRow).where(RunRow.state.in_(UNDER_WAY)))

    def get(self, run_id: str) -> RunRecord:
        """Return a run; NotInStoreError where it is unknown."""
        with reading_session(self._engine) as session:
            return run_record(_find(session, run_id))

    def list(
        self, *, state: RunState | None = None, limit: int = 100, before: int | None = None
    ) -> Page[RunRecord]:
        """Return a page of runs, newest first."""
        query = select(RunRow) if state is None else select(RunRow).where(RunRow.state == state)
        with reading_session(self._engine) as session:
            return page(session, query, RunRow.sequence, run_record, limit=limit, before=before)

    def _first(self, query: Select[RunRow]) -> RunRecord | None:
        with reading_session(self._engine) as session:
            row = session.scalar(query.order_by(RunRow.sequence).limit(1))
            return None if row is None else run_record(row)


def _enter(row: RunRow, state: RunState) -> None:
    now = datetime.now(UTC)
    if state == "running" and row.state in {"queued", "interrupted"}:
        row.attempts += 1
        row.started_at = row.started_at or now
    row.finished_at = now if state in FINAL else None
    row.state = state


def _say(session: Session, run_id: str, kind: str, content: Mapping[str, Any]) -> RunEventRow:
    """Add an event with the next number; the transaction is the only one that writes."""
    newest = select(func.max(RunEventRow.number)).where(RunEventRow.run_id == run_id)
    row = RunEventRow(
        run_id=run_id, number=(session.scalar(newest) or 0) + 1, at=datetime.now(UTC), kind=kind,
        content=plain(content),
    )  # fmt: skip
    session.add(row)
    session.flush()
    return row


def _same(row: RunRow, digest: str) -> RunRow:
    if row.request_digest != digest:
        msg = f"this idempotency key belongs to run {row.id}, which has another plan; use a new key"
        raise StoreError(msg, code="idempotency-mismatch")
    return row


def _find(session: Session, run_id: str) -> RunRow:
    return find(session, RunRow, RunRow.id, run_id, else_=f"there is no run {run_id!r}; list them")
