"""Long work on record, so that nobody waits for what died with the service."""

import uuid
from datetime import UTC, datetime
from typing import Any

from sqlalchemy import Engine, func, select, update
from sqlalchemy.orm import Session

from service.store.engine import reading_session, writing_session
from service.store.errors import StoreError
from service.store.find import find
from service.store.pages import Page, page
from service.store.plain_json import plain
from service.store.records import JobRecord, JobState
from service.store.row_records import job_record
from service.store.tables import JobRow

FINAL: frozenset[JobState] = frozenset({"succeeded", "failed", "cancelled", "interrupted"})


class Jobs:
    """The records; who does the work is not the store's business."""

    def __init__(self, engine: Engine) -> None:
        self._engine = engine

    def submit(self, kind: str, request: dict[str, Any], *, max_waiting: int) -> JobRecord:
        """Queue a job; StoreError `too-many-jobs` where `max_waiting` are not done yet."""
        with writing_session(self._engine) as session:
            waiting = session.scalar(
                select(func.count()).where(JobRow.state.in_(["queued", "running"]))
            )
            if (waiting or 0) >= max_waiting:
                msg = f"{waiting} jobs wait already; come back when some are done"
                raise StoreError(msg, code="too-many-jobs")
            row = JobRow(
                id=uuid.uuid4().hex,
                kind=kind,
                state="queued",
                request=plain(request),
                submitted_at=datetime.now(UTC),
            )
            session.add(row)
            session.flush()
            return job_record(row)

    def start(self, job_id: str) -> bool:
        """Mark a queued job as running; False where it was cancelled meanwhile."""
        with writing_session(self._engine) as session:
            row = _find(session, job_id)
            if row.state != "queued":
                return False
            row.state, row.started_at = "running", datetime.now(UTC)
            return True

    def finish(
        self,
        job_id: str,
        state: JobState,
        *,
        result: dict[str, Any] | None = None,
        error: tuple[str, str] | None = None,
    ) -> JobRecord:
        """End a job with `result`, or with an error's code and message; final ones stay."""
        with writing_session(self._engine) as session:
            row = _find(session, job_id)
            if row.state not in FINAL:
                row.state, row.finished_at = state, datetime.now(UTC)
                row.result = plain(result)
                row.error_code, row.error_message = error or (None, None)
            return job_record(row)

    def interrupt_all(self) -> None:
        """Mark what an earlier process left behind, queued or running, as interrupted."""
        message = "the service ended before the job did; submit it again"
        with writing_session(self._engine) as session:
            session.execute(
                update(JobRow)
                .where(JobRow.state.in_(["queued", "running"]))
                .values(
                    state="interrupted",
                    finished_at=datetime.now(UTC),
                    error_code="interrupted",
                    error_message=message,
                )
            )

    def get(self, job_id: str) -> JobRecord:
        """Return a job; NotInStoreError where it is unknown."""
        with reading_session(self._engine) as session:
            return job_record(_find(session, job_id))

    def list(self, *, limit: int = 100, before: int | None = None) -> Page[JobRecord]:
        """Return a page of jobs, newest first."""
        with reading_session(self._engine) as session:
            query = select(JobRow)
            return page(session, query, JobRow.sequence, job_record, limit=limit, before=before)


def _find(session: Session, job_id: str) -> JobRow:
    return find(session, JobRow, JobRow.id, job_id, else_=f"there is no job {job_id!r}; list them")
