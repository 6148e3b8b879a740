"""First schema: coefficient sets and their lives, recordings, jobs."""

from collections.abc import Sequence

import sqlalchemy as sa
from alembic import op

revision: str = "0001"
down_revision: str | None = None
branch_labels: Sequence[str] | None = None
depends_on: Sequence[str] | None = None


def upgrade() -> None:
    """First schema."""
    op.create_table(
        "coefficient_sets",
        sa.Column("sequence", sa.Integer(), nullable=False),
        sa.Column("id", sa.String(length=64), nullable=False),
        sa.Column("state", sa.String(length=16), nullable=False),
        sa.Column("camera_serial", sa.String(), nullable=False),
        sa.Column("band", sa.String(), nullable=False),
        sa.Column("gain_db", sa.Double(), nullable=False),
        sa.Column("bit_depth", sa.Integer(), nullable=False),
        sa.Column("columns", sa.Integer(), nullable=False),
        sa.Column("radiance_unit", sa.String(), nullable=False),
        sa.Column("recording_digest", sa.String(), nullable=False),
        sa.Column("added_at", sa.DateTime(timezone=True), nullable=False),
        sa.Column("added_by", sa.String(), nullable=False),
        sa.Column("summary", sa.JSON(), nullable=False),
        sa.CheckConstraint(
            "state IN ('draft', 'verified', 'certified', 'superseded', 'revoked')",
            name=op.f("ck_coefficient_sets_state"),
        ),
        sa.PrimaryKeyConstraint("sequence", name=op.f("pk_coefficient_sets")),
        sa.UniqueConstraint("id", name=op.f("uq_coefficient_sets_id")),
    )
    with op.batch_alter_table("coefficient_sets", schema=None) as batch_op:
        batch_op.create_index(
            batch_op.f("ix_coefficient_sets_camera_serial"), ["camera_serial"], unique=False
        )
        batch_op.create_index(
            batch_op.f("ix_coefficient_sets_recording_digest"), ["recording_digest"], unique=False
        )
        batch_op.create_index(batch_op.f("ix_coefficient_sets_state"), ["state"], unique=False)

    op.create_table(
        "jobs",
        sa.Column("sequence", sa.Integer(), nullable=False),
        sa.Column("id", sa.String(length=32), nullable=False),
        sa.Column("kind", sa.String(), nullable=False),
        sa.Column("state", sa.String(length=16), nullable=False),
        sa.Column("request", sa.JSON(), nullable=False),
        sa.Column("result", sa.JSON(), nullable=True),
        sa.Column("error_code", sa.String(), nullable=True),
        sa.Column("error_message", sa.String(), nullable=True),
        sa.Column("submitted_at", sa.DateTime(timezone=True), nullable=False),
        sa.Column("started_at", sa.DateTime(timezone=True), nullable=True),
        sa.Column("finished_at", sa.DateTime(timezone=True), nullable=True),
        sa.PrimaryKeyConstraint("sequence", name=op.f("pk_jobs")),
        sa.UniqueConstraint("id", name=op.f("uq_jobs_id")),
    )
    with op.batch_alter_table("jobs", schema=None) as batch_op:
        batch_op.create_index(batch_op.f("ix_jobs_state"), ["state"], unique=False)

    op.create_table(
        "recordings",
        sa.Column("sequence", sa.Integer(), nullable=False),
        sa.Column("digest", sa.String(length=64), nullable=False),
        sa.Column("name", sa.String(), nullable=False),
        sa.Column("path", sa.String(), nullable=False),
        sa.Column("camera_serial", sa.String(), nullable=False),
        sa.Column("band", sa.String(), nullable=False),
        sa.Column("started_at", sa.DateTime(timezone=True), nullable=True),
        sa.Column("registered_at", sa.DateTime(timezone=True), nullable=False),
        sa.Column("registered_by", sa.String(), nullable=False),
        sa.Column("header", sa.JSON(), nullable=False),
        sa.Column("warnings", sa.JSON(), nullable=False),
        sa.PrimaryKeyConstraint("sequence", name=op.f("pk_recordings")),
        sa.UniqueConstraint("digest", name=op.f("uq_recordings_digest")),
    )
    with op.batch_alter_table("recordings", schema=None) as batch_op:
        batch_op.create_index(
            batch_op.f("ix_recordings_camera_serial"), ["camera_serial"], unique=False
        )

    op.create_table(
        "certifications",
        sa.Column("sequence", sa.Integer(), nullable=False),
        sa.Column("set_id", sa.String(length=64), nullable=False),
        sa.Column("valid_from", sa.DateTime(timezone=True), nullable=False),
        sa.Column("valid_until", sa.DateTime(timezone=True), nullable=True),
        sa.Column("superseded_from", sa.DateTime(timezone=True), nullable=True),
        sa.Column("superseded_by", sa.String(length=64), nullable=True),
        sa.ForeignKeyConstraint(
            ["set_id"], ["coefficient_sets.id"], name=op.f("fk_certifications_set_id")
        ),
        sa.ForeignKeyConstraint(
            ["superseded_by"], ["coefficient_sets.id"], name=op.f("fk_certifications_superseded_by")
        ),
        sa.PrimaryKeyConstraint("sequence", name=op.f("pk_certifications")),
        sa.UniqueConstraint("set_id", name=op.f("uq_certifications_set_id")),
    )
    op.create_table(
        "transitions",
        sa.Column("sequence", sa.Integer(), nullable=False),
        sa.Column("set_id", sa.String(length=64), nullable=False),
        sa.Column("before", sa.String(length=16), nullable=True),
        sa.Column("after", sa.String(length=16), nullable=False),
        sa.Column("at", sa.DateTime(timezone=True), nullable=False),
        sa.Column("by", sa.String(), nullable=False),
        sa.Column("reason", sa.String(), nullable=False),
        sa.ForeignKeyConstraint(
            ["set_id"], ["coefficient_sets.id"], name=op.f("fk_transitions_set_id")
        ),
        sa.PrimaryKeyConstraint("sequence", name=op.f("pk_transitions")),
    )
    with op.batch_alter_table("transitions", schema=None) as batch_op:
        batch_op.create_index(batch_op.f("ix_transitions_set_id"), ["set_id"], unique=False)


def downgrade() -> None:
    """Undo it."""
    with op.batch_alter_table("transitions", schema=None) as batch_op:
        batch_op.drop_index(batch_op.f("ix_transitions_set_id"))

    op.drop_table("transitions")
    op.drop_table("certifications")
    with op.batch_alter_table("recordings", schema=None) as batch_op:
        batch_op.drop_index(batch_op.f("ix_recordings_camera_serial"))

    op.drop_table("recordings")
    with op.batch_alter_table("jobs", schema=None) as batch_op:
        batch_op.drop_index(batch_op.f("ix_jobs_state"))

    op.drop_table("jobs")
    with op.batch_alter_table("coefficient_sets", schema=None) as batch_op:
        batch_op.drop_index(batch_op.f("ix_coefficient_sets_state"))
        batch_op.drop_index(batch_op.f("ix_coefficient_sets_recording_digest"))
        batch_op.drop_index(batch_op.f("ix_coefficient_sets_camera_serial"))

    op.drop_table("coefficient_sets")
