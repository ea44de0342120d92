"""Jobs, units, questions, rows, results, layouts and events."""

from __future__ import annotations

import sqlalchemy as sa
from alembic import op

revision = "1"
down_revision = None
branch_labels = None
depends_on = None


def upgrade() -> None:
    """Make the tables."""
    op.create_table(
        "batch_job",
        sa.Column("id", sa.String(64), primary_key=True),
        sa.Column("basis", sa.String(64), nullable=False),
        sa.Column("state", sa.String(16), nullable=False),
        sa.Column("source", sa.Text, nullable=False),
        sa.Column("folder", sa.Text, nullable=False),
        sa.Column("created", sa.Float, nullable=False),
        sa.Column("updated", sa.Float, nullable=False),
        sa.Column("rows", sa.Integer, nullable=False),
        sa.Column("content", sa.JSON, nullable=False),
    )
    op.create_table(
        "batch_unit",
        sa.Column("id", sa.Integer, primary_key=True, autoincrement=True),
        sa.Column("job", sa.String(64), sa.ForeignKey("batch_job.id", ondelete="CASCADE"), nullable=False),
        sa.Column("state", sa.String(16), nullable=False),
        sa.Column("owner", sa.String(120), nullable=True),
        sa.Column("lease", sa.Float, nullable=True),
        sa.Column("token", sa.Integer, nullable=False),
        sa.Column("attempts", sa.Integer, nullable=False),
    )
    op.create_index("batch_unit_open", "batch_unit", ["job", "state", "id"])
    op.create_table(
        "batch_question",
        sa.Column("job", sa.String(64), sa.ForeignKey("batch_job.id", ondelete="CASCADE"), primary_key=True),
        sa.Column("key", sa.String(64), primary_key=True),
        sa.Column("structure", sa.String(64), nullable=False),
        sa.Column("position", sa.LargeBinary, nullable=False),
        sa.Column("unit", sa.Integer, nullable=True),
        sa.Column("content", sa.JSON, nullable=False),
    )
    op.create_index("batch_question_unit", "batch_question", ["unit"])
    op.create_table(
        "batch_row",
        sa.Column("job", sa.String(64), sa.ForeignKey("batch_job.id", ondelete="CASCADE"), primary_key=True),
        sa.Column("line", sa.BigInteger, primary_key=True, autoincrement=False),
        sa.Column("position", sa.LargeBinary, nullable=False),
        sa.Column("key", sa.String(64), nullable=True),
        sa.Column("family", sa.Text, nullable=False),
        sa.Column("cells", sa.JSON, nullable=False),
        sa.Column("remarks", sa.Text, nullable=False),
        sa.Column("faults", sa.JSON, nullable=False),
    )
    op.create_index("batch_row_key", "batch_row", ["job", "key"])
    op.create_table(
        "batch_result",
        sa.Column("job", sa.String(64), sa.ForeignKey("batch_job.id", ondelete="CASCADE"), primary_key=True),
        sa.Column("key", sa.String(64), primary_key=True),
        sa.Column("status", sa.String(16), nullable=False),
        sa.Column("seconds", sa.Float, nullable=False),
        sa.Column("layout", sa.String(64), nullable=True),
        sa.Column("content", sa.JSON, nullable=False),
    )
    op.create_table(
        "batch_layout",
        sa.Column("job", sa.String(64), sa.ForeignKey("batch_job.id", ondelete="CASCADE"), primary_key=True),
        sa.Column("key", sa.String(64), primary_key=True),
        sa.Column("content", sa.JSON, nullable=False),
    )
    op.create_table(
        "batch_event",
        sa.Column("id", sa.Integer, primary_key=True, autoincrement=True),
        sa.Column("job", sa.String(64), sa.ForeignKey("batch_job.id", ondelete="CASCADE"), nullable=False),
        sa.Column("time", sa.Float, nullable=False),
        sa.Column("kind", sa.String(32), nullable=False),
        sa.Column("text", sa.Text, nullable=False),
    )
    op.create_index("batch_event_job", "batch_event", ["job", "id"])


def downgrade() -> None:
    """Remove the tables."""
    for table in ("event", "layout", "result", "row", "question", "unit", "job"):
        op.drop_table(f"batch_{table}")
