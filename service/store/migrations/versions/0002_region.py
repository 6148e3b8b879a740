"""The region of the sensor that a coefficient set is for."""

from collections.abc import Sequence

import sqlalchemy as sa
from alembic import op

revision: str = "0002"
down_revision: str | None = "0001"
branch_labels: Sequence[str] | None = None
depends_on: Sequence[str] | None = None


def upgrade() -> None:
    """Sets that are there already are taken to begin at the sensor's first column."""
    op.add_column(
        "coefficient_sets", sa.Column("region", sa.String(), nullable=False, server_default="")
    )
    op.execute("UPDATE coefficient_sets SET region = '0:' || columns")


def downgrade() -> None:
    """Undo it."""
    op.drop_column("coefficient_sets", "region")
