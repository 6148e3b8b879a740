"""Long work, as the service tells it."""

from datetime import datetime
from typing import Any

from pydantic import BaseModel, Field

from service.store.records import JobRecord, JobState


class JobError(BaseModel):
    """Why a job failed."""

    code: str
    message: str


class JobAnswer(BaseModel):
    """A job; follow it at its `Location` until its state is final."""

    id: str
    kind: str = Field(examples=["calibrate"])
    state: JobState
    progress: float | None = Field(ge=0, le=1, description="The share done, while it runs.")
    request: dict[str, Any]
    result: dict[str, Any] | None
    error: JobError | None
    submitted_at: datetime
    started_at: datetime | None
    finished_at: datetime | None

    @classmethod
    def of(cls, record: JobRecord, progress: float | None = None) -> "JobAnswer":
        """Return the answer for a record, with what the worker says of its progress."""
        error = None
        if record.error_code is not None:
            error = JobError(code=record.error_code, message=record.error_message or "")
        return cls(
            id=record.id,
            kind=record.kind,
            state=record.state,
            progress=progress if record.state == "running" else None,
            request=record.request,
            result=record.result,
            error=error,
            submitted_at=record.submitted_at,
            started_at=record.started_at,
            finished_at=record.finished_at,
        )


class JobPage(BaseModel):
    """Some jobs, newest first."""

    items: tuple[JobAnswer, ...]
    next_before: int | None = Field(description="Ask with `before` for those that follow.")
