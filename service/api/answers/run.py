"""A run, as the service tells it."""

from datetime import datetime
from typing import Any

from pydantic import BaseModel, Field

from service.api.answers.job import JobError
from service.plan.estimate import estimate
from service.plan.expand import expand
from service.plan.model import Plan
from service.store.run_records import RunEvent, RunRecord, RunState


class RunAnswer(BaseModel):
    """A run; follow it at its `Location`, or by its events."""

    id: str
    state: RunState
    plan: dict[str, Any]
    attempts: int = Field(description="How often it was given the bench.")
    blocks_done: int
    blocks_total: int
    recording: str | None = Field(description="Its recording's digest, once it is whole.")
    result: dict[str, Any] | None
    error: JobError | None
    submitted_at: datetime
    submitted_by: str
    started_at: datetime | None
    finished_at: datetime | None

    @classmethod
    def of(cls, record: RunRecord) -> "RunAnswer":
        """Return the answer for a record."""
        return cls(
            id=record.id,
            state=record.state,
            plan=record.plan,
            attempts=record.attempts,
            blocks_done=record.blocks_done,
            blocks_total=record.blocks_total,
            recording=record.recording_digest,
            result=record.result,
            error=JobError.of(record.error_code, record.error_message),
            submitted_at=record.submitted_at,
            submitted_by=record.submitted_by,
            started_at=record.started_at,
            finished_at=record.finished_at,
        )


class RunPage(BaseModel):
    """Some runs, newest first."""

    items: tuple[RunAnswer, ...]
    next_before: int | None = Field(description="Ask with `before` for those that follow.")


class EventAnswer(BaseModel):
    """What a run said."""

    number: int = Field(description="From 1 on, without gaps; the stream's `id`.")
    at: datetime
    kind: str = Field(examples=["state", "progress"])
    content: dict[str, Any]

    @classmethod
    def of(cls, event: RunEvent) -> "EventAnswer":
        """Return the answer for an event."""
        return cls(number=event.number, at=event.at, kind=event.kind, content=event.content)


class StepAnswer(BaseModel):
    """One block that a plan stands for."""

    block: str
    kind: str
    exposure_us: float
    level: float
    lines: int
    burning: float = Field(description="The level at which the lamps burn during it.")


class PlanAnswer(BaseModel):
    """What a plan would do; nothing has moved."""

    steps: tuple[StepAnswer, ...]
    exposing_s: float
    waiting_s: float
    reading_s: float
    total_s: float
    bytes: int | None = Field(description="Of the recording; null where the plan leaves it open.")

    @classmethod
    def of(cls, plan: Plan) -> "PlanAnswer":
        """Return what `plan` would do, and how long it would take."""
        steps = expand(plan)
        ahead = estimate(plan, steps, columns=plan.camera.columns or 1, rows=plan.camera.rows)
        return cls(
            steps=tuple(
                StepAnswer(
                    block=step.block.block,
                    kind=step.block.kind,
                    exposure_us=step.block.exposure_us,
                    level=step.block.level,
                    lines=step.lines,
                    burning=step.burning,
                )
                for step in steps
            ),
            exposing_s=ahead.exposing_s,
            waiting_s=ahead.waiting_s,
            reading_s=ahead.reading_s,
            total_s=ahead.total_s,
            bytes=ahead.n_bytes if plan.camera.columns else None,
        )
