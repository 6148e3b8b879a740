"""What the store says of what it holds: frozen, detached from the database."""

from dataclasses import dataclass
from datetime import datetime
from typing import Any, Literal

from service.store.state import SetState

JobState = Literal["queued", "running", "succeeded", "failed", "cancelled", "interrupted"]
"""`interrupted`: found running after the service had died."""


@dataclass(frozen=True)
class Transition:
    """One step of a set's life; `before` is None for the first."""

    before: SetState | None
    after: SetState
    at: datetime
    by: str
    reason: str


@dataclass(frozen=True)
class Certification:
    """For which times a set was certified, `valid_until` excluded.

    From `superseded_from` on, `superseded_by` holds instead, for good.
    """

    valid_from: datetime
    valid_until: datetime | None
    superseded_from: datetime | None = None
    superseded_by: str | None = None

    @property
    def until(self) -> datetime | None:
        """When it stops to hold, by its own end or by its successor; None is open."""
        ends = [end for end in (self.valid_until, self.superseded_from) if end is not None]
        return min(ends, default=None)


@dataclass(frozen=True)
class SetRecord:
    """A coefficient set as the store knows it; `id` names its content.

    `summary` is `CoefficientSet.summary()`, `transitions` its life so far.
    """

    id: str
    sequence: int
    state: SetState
    camera_serial: str
    band: str
    gain_db: float
    bit_depth: int
    columns: int
    region: str
    radiance_unit: str
    recording_digest: str
    added_at: datetime
    added_by: str
    summary: dict[str, Any]
    certification: Certification | None
    transitions: tuple[Transition, ...]

    @property
    def version(self) -> str:
        """Changes whenever the record does; for ETags."""
        return f"{self.id[:16]}-{self.state}-{len(self.transitions)}"


@dataclass(frozen=True)
class RecordingRecord:
    """A recording that was registered; `header` is that of the file, `path` where it is."""

    digest: str
    sequence: int
    name: str
    path: str
    camera_serial: str
    band: str
    started_at: datetime | None
    registered_at: datetime
    registered_by: str
    header: dict[str, Any]
    warnings: tuple[str, ...]


@dataclass(frozen=True)
class JobRecord:
    """Long work: what was asked, and what came of it."""

    id: str
    sequence: int
    kind: str
    state: JobState
    request: dict[str, Any]
    result: dict[str, Any] | None
    error_code: str | None
    error_message: str | None
    submitted_at: datetime
    started_at: datetime | None
    finished_at: datetime | None
