"""A run as the store knows it, and the ways that its life may go."""

from dataclasses import dataclass
from datetime import datetime
from typing import Any, Final, Literal, cast

from service.store.errors import IllegalTransitionError
from service.store.tables import RunEventRow, RunRow

RunState = Literal[
    "queued", "running", "pausing", "paused", "aborting",
    "succeeded", "failed", "cancelled", "interrupted",
]  # fmt: skip
"""`interrupted`: found after a crash; it may be resumed. A final one is published only once the
bench is dark and free."""
FINAL: Final[frozenset[str]] = frozenset({"succeeded", "failed", "cancelled", "interrupted"})

_ENDS: Final = frozenset({"succeeded", "failed", "cancelled", "interrupted"})
MOVES: Final[dict[str, frozenset[str]]] = {
    "queued": frozenset({"running", "cancelled"}),
    "running": _ENDS | {"pausing", "aborting"},
    "pausing": _ENDS | {"paused", "aborting"},
    "paused": _ENDS | {"running", "aborting"},
    "aborting": _ENDS,
    "interrupted": frozenset({"queued", "cancelled"}),
    "failed": frozenset({"queued"}),
    "cancelled": frozenset({"queued"}),
    "succeeded": frozenset(),
}
"""What was recorded of a failed or cancelled run can be gone on with: it is queued again."""


@dataclass(frozen=True)
class RunRecord:
    """A run; `plan` and `result` as JSON knows them."""

    id: str
    sequence: int
    state: RunState
    plan: dict[str, Any]
    request_digest: str
    attempts: int
    blocks_done: int
    blocks_total: int
    recording_digest: str | None
    result: dict[str, Any] | None
    error_code: str | None
    error_message: str | None
    submitted_at: datetime
    submitted_by: str
    started_at: datetime | None
    finished_at: datetime | None


@dataclass(frozen=True)
class RunEvent:
    """What a run said; `number` counts from 1 within the run."""

    run_id: str
    number: int
    at: datetime
    kind: str
    content: dict[str, Any]


def check_move(run_id: str, before: str, after: str) -> None:
    """Raise IllegalTransitionError unless a run may go from `before` to `after`."""
    if after in MOVES[before]:
        return
    possible = " or ".join(sorted(MOVES[before])) or "nothing else"
    raise IllegalTransitionError(
        f"run {run_id} is {before} and cannot become {after}; from here it can become {possible}"
    )


def run_record(row: RunRow) -> RunRecord:
    """Return a run's row as a record."""
    return RunRecord(
        id=row.id,
        sequence=row.sequence,
        state=cast("RunState", row.state),
        plan=row.plan,
        request_digest=row.request_digest,
        attempts=row.attempts,
        blocks_done=row.blocks_done,
        blocks_total=row.blocks_total,
        recording_digest=row.recording_digest,
        result=row.result,
        error_code=row.error_code,
        error_message=row.error_message,
        submitted_at=row.submitted_at,
        submitted_by=row.submitted_by,
        started_at=row.started_at,
        finished_at=row.finished_at,
    )


def event_record(row: RunEventRow) -> RunEvent:
    """Return an event's row as a record."""
    return RunEvent(row.run_id, row.number, row.at, row.kind, row.content)
