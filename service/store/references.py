"""What still needs a recording."""

from collections.abc import Iterator
from typing import Any

from sqlalchemy import select
from sqlalchemy.orm import Session

from service.store.errors import StoreError
from service.store.tables import JobRow, RunRow, SetRow


def check_unreferenced(session: Session, digest: str) -> None:
    """Raise StoreError `recording-in-use` where a set, a run, or a job to be done refers to it.

    Sets and runs are never deleted, and what they were made of has to be there for whoever doubts
    them. A job that is over needs nothing any more.
    """
    first = next(_references(session, digest), None)
    if first is not None:
        msg = f"recording {digest[:12]} is needed by {first}; it stays"
        raise StoreError(msg, code="recording-in-use")


def _references(session: Session, digest: str) -> Iterator[str]:
    for set_id in session.scalars(select(SetRow.id).where(SetRow.recording_digest == digest)):
        yield f"coefficient set {set_id[:12]}"
    for run_id in session.scalars(select(RunRow.id).where(RunRow.recording_digest == digest)):
        yield f"run {run_id}"
    to_be_done = select(JobRow).where(JobRow.state.in_(["queued", "running"]))
    for job in session.scalars(to_be_done):
        if _holds(job.request, digest):
            yield f"job {job.id}"


def _holds(value: Any, digest: str) -> bool:
    """Tell whether `digest` stands anywhere in what a job was asked."""
    if isinstance(value, dict):
        return any(_holds(each, digest) for each in value.values())
    if isinstance(value, list):
        return any(_holds(each, digest) for each in value)
    return bool(value == digest)
