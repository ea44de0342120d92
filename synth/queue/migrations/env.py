"""How Alembic reaches the job database: over the connection that opens it."""

from __future__ import annotations

from alembic import context

from synth.queue.models import VERSION_TABLE, Base

connection = context.config.attributes["connection"]
context.configure(
    connection=connection,
    target_metadata=Base.metadata,
    version_table=VERSION_TABLE,
    transactional_ddl=False,  # whoever opens the database holds the transaction, and a lock
)
context.run_migrations()
