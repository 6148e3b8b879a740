"""The tables. The schema changes by a migration in `migrations/versions`, never here alone."""

from datetime import datetime
from typing import Any, ClassVar

from sqlalchemy import JSON, CheckConstraint, ForeignKey, MetaData, String, UniqueConstraint
from sqlalchemy.orm import DeclarativeBase, Mapped, mapped_column, relationship

from service.store.utc import UtcDateTime

_NAMES = {
    "ix": "ix_%(column_0_label)s",
    "uq": "uq_%(table_name)s_%(column_0_name)s",
    "ck": "ck_%(table_name)s_%(constraint_name)s",
    "fk": "fk_%(table_name)s_%(column_0_name)s",
    "pk": "pk_%(table_name)s",
}
_RUN_STATES = (
    "'queued', 'running', 'pausing', 'paused', 'aborting', 'succeeded', 'failed', 'cancelled',"
    " 'interrupted'"
)
_STATES = "'draft', 'verified', 'certified', 'superseded', 'revoked'"


class Base(DeclarativeBase):
    """What all tables share: names for constraints, times in UTC."""

    metadata = MetaData(naming_convention=_NAMES)
    type_annotation_map: ClassVar[dict[Any, Any]] = {
        datetime: UtcDateTime,
        dict[str, Any]: JSON,
        list[str]: JSON,
    }


class SetRow(Base):
    """A coefficient set; its arrays are in the file `<id>.h5`."""

    __tablename__ = "coefficient_sets"
    __table_args__ = (CheckConstraint(f"state IN ({_STATES})", name="state"),)

    sequence: Mapped[int] = mapped_column(primary_key=True)
    id: Mapped[str] = mapped_column(String(64), unique=True)
    state: Mapped[str] = mapped_column(String(16), index=True)
    camera_serial: Mapped[str] = mapped_column(index=True)
    band: Mapped[str]
    gain_db: Mapped[float]
    bit_depth: Mapped[int]
    columns: Mapped[int]
    region: Mapped[str] = mapped_column(server_default="")
    radiance_unit: Mapped[str]
    recording_digest: Mapped[str] = mapped_column(index=True)
    added_at: Mapped[datetime]
    added_by: Mapped[str]
    summary: Mapped[dict[str, Any]]
    certification: Mapped["CertificationRow | None"] = relationship(
        back_populates="certified", foreign_keys="CertificationRow.set_id", lazy="joined"
    )
    transitions: Mapped[list["TransitionRow"]] = relationship(
        order_by="TransitionRow.sequence", lazy="selectin"
    )


class CertificationRow(Base):
    """Somebody's word that a set holds from a time on; names the set by its hash."""

    __tablename__ = "certifications"

    sequence: Mapped[int] = mapped_column(primary_key=True)
    set_id: Mapped[str] = mapped_column(ForeignKey("coefficient_sets.id"), unique=True)
    valid_from: Mapped[datetime]
    valid_until: Mapped[datetime | None]
    """Excluded; None is open."""
    superseded_from: Mapped[datetime | None]
    """From here on `superseded_by` holds instead."""
    superseded_by: Mapped[str | None] = mapped_column(ForeignKey("coefficient_sets.id"))
    certified: Mapped[SetRow] = relationship(
        back_populates="certification", foreign_keys="CertificationRow.set_id"
    )


class TransitionRow(Base):
    """One step of a set's life: who, when, why. Only ever added to."""

    __tablename__ = "transitions"

    sequence: Mapped[int] = mapped_column(primary_key=True)
    set_id: Mapped[str] = mapped_column(ForeignKey("coefficient_sets.id"), index=True)
    before: Mapped[str | None] = mapped_column(String(16))
    after: Mapped[str] = mapped_column(String(16))
    at: Mapped[datetime]
    by: Mapped[str]
    reason: Mapped[str]


class RecordingRow(Base):
    """A recording, known by the digest of its content."""

    __tablename__ = "recordings"

    sequence: Mapped[int] = mapped_column(primary_key=True)
    digest: Mapped[str] = mapped_column(String(64), unique=True)
    name: Mapped[str]
    path: Mapped[str]
    camera_serial: Mapped[str] = mapped_column(index=True)
    band: Mapped[str]
    started_at: Mapped[datetime | None]
    registered_at: Mapped[datetime]
    registered_by: Mapped[str]
    header: Mapped[dict[str, Any]]
    warnings: Mapped[list[str]]


class JobRow(Base):
    """Long work that was asked for, and what came of it."""

    __tablename__ = "jobs"

    sequence: Mapped[int] = mapped_column(primary_key=True)
    id: Mapped[str] = mapped_column(String(32), unique=True)
    kind: Mapped[str]
    state: Mapped[str] = mapped_column(String(16), index=True)
    request: Mapped[dict[str, Any]]
    result: Mapped[dict[str, Any] | None]
    error_code: Mapped[str | None]
    error_message: Mapped[str | None]
    submitted_at: Mapped[datetime]
    started_at: Mapped[datetime | None]
    finished_at: Mapped[datetime | None]


class RunRow(Base):
    """A plan that the bench was asked to measure, and how far it came."""

    __tablename__ = "runs"
    __table_args__ = (CheckConstraint(f"state IN ({_RUN_STATES})", name="state"),)

    sequence: Mapped[int] = mapped_column(primary_key=True)
    id: Mapped[str] = mapped_column(String(32), unique=True)
    state: Mapped[str] = mapped_column(String(16), index=True)
    plan: Mapped[dict[str, Any]]
    request_digest: Mapped[str] = mapped_column(String(64))
    """Of the plan; the same idempotency key with another one is refused."""
    idempotency_key: Mapped[str | None] = mapped_column(unique=True)
    attempts: Mapped[int]
    blocks_done: Mapped[int]
    blocks_total: Mapped[int]
    recording_digest: Mapped[str | None] = mapped_column(String(64))
    result: Mapped[dict[str, Any] | None]
    error_code: Mapped[str | None]
    error_message: Mapped[str | None]
    submitted_at: Mapped[datetime]
    submitted_by: Mapped[str]
    started_at: Mapped[datetime | None]
    finished_at: Mapped[datetime | None]


class RunEventRow(Base):
    """What a run said; numbered from 1 within its run, only ever added to."""

    __tablename__ = "run_events"
    __table_args__ = (UniqueConstraint("run_id", "number"),)

    sequence: Mapped[int] = mapped_column(primary_key=True)
    run_id: Mapped[str] = mapped_column(ForeignKey("runs.id"), index=True)
    number: Mapped[int]
    at: Mapped[datetime]
    kind: Mapped[str] = mapped_column(String(16))
    content: Mapped[dict[str, Any]]


class KeyRow(Base):
    """Who may ask for what; the secret itself is nowhere."""

    __tablename__ = "keys"

    sequence: Mapped[int] = mapped_column(primary_key=True)
    id: Mapped[str] = mapped_column(String(16), unique=True)
    name: Mapped[str]
    scope: Mapped[str] = mapped_column(String(16))
    secret_sha256: Mapped[str] = mapped_column(String(64))
    created_at: Mapped[datetime]
    expires_at: Mapped[datetime | None]
    revoked_at: Mapped[datetime | None]


class AuditRow(Base):
    """One link of the chain of what was done; `number` has no gaps, `digest` covers all before."""

    __tablename__ = "audit"

    number: Mapped[int] = mapped_column(primary_key=True, autoincrement=False)
    at: Mapped[datetime]
    who: Mapped[str]
    key_id: Mapped[str] = mapped_column(String(16))
    action: Mapped[str] = mapped_column(String(32))
    subject: Mapped[str]
    before: Mapped[dict[str, Any] | None]
    after: Mapped[dict[str, Any] | None]
    previous: Mapped[str] = mapped_column(String(64))
    digest: Mapped[str] = mapped_column(String(64))
