"""Long work, as the service tells it."""

from datetime import datetime
from typing import Any

from pydantic import BaseModel, Field

from service.api.jobs.files import JobFile
from service.store.records import JobRecord, JobState


class JobError(BaseModel):
    """Why a job failed."""

    code: str
    message: str

    @classmethod
    def of(cls, code: str | None, message: str | None) -> "JobError | None":
        """Return the answer for what is on record of an error; None where there was none."""
        return None if code is None else cls(code=code, message=message or "")


class JobFileAnswer(BaseModel):
    """A file that a job left; get it at `place`."""

    name: str = Field(examples=["report.html"])
    media_type: str = Field(examples=["text/html"])
    bytes: int
    place: str = Field(examples=["/v1/jobs/0f8fad5bd9cb469fa16570867728950e/files/report.html"])

    @classmethod
    def of(cls, job_id: str, file: JobFile) -> "JobFileAnswer":
        """Return the answer for a file."""
        return cls(
            name=file.name,
            media_type=file.media_type,
            bytes=file.n_bytes,
            place=f"/v1/jobs/{job_id}/files/{file.name}",
        )


class JobAnswer(BaseModel):
    """A job; follow it at its `Location` until its state is final."""

    id: str
    kind: str = Field(examples=["calibrate"])
    state: JobState
    progress: float | None = Field(ge=0, le=1, description="The share done, while it runs.")
    request: dict[str, Any]
    result: dict[str, Any] | None
    files: tuple[JobFileAnswer, ...]
    error: JobError | None
    submitted_at: datetime
    started_at: datetime | None
    finished_at: datetime | None

    @classmethod
    def of(
        cls, record: JobRecord, progress: float | None = None, files: tuple[JobFile, ...] = ()
    ) -> "JobAnswer":
        """Return the answer for a record, with what the worker says of its progress."""
        return cls(
            id=record.id,
            kind=record.kind,
            state=record.state,
            progress=progress if record.state == "running" else None,
            request=record.request,
            result=record.result,
            files=tuple(JobFileAnswer.of(record.id, each) for each in files),
            error=JobError.of(record.error_code, record.error_message),
            submitted_at=record.submitted_at,
            started_at=record.started_at,
            finished_at=record.finished_at,
        )


class JobPage(BaseModel):
    """Some jobs, newest first."""

    items: tuple[JobAnswer, ...]
    next_before: int | None = Field(description="Ask with `before` for those that follow.")
