"""Databases as they are when they have just been made: their tables are made once for many tests."""

from __future__ import annotations

import os
import tempfile
import uuid
from collections.abc import Iterator
from contextlib import contextmanager
from functools import cache
from pathlib import Path

import pytest
import sqlalchemy as sa
from sqlalchemy.exc import OperationalError

from synth.batches.store import Store
from synth.queue.database import file_url


def server() -> sa.URL:
    """Return the address of the PostgreSQL server, by the variables that its own tools read."""
    return sa.URL.create(
        "postgresql+psycopg",
        username=os.environ.get("PGUSER", "postgres"),
        password=os.environ.get("PGPASSWORD"),
        host=os.environ.get("PGHOST", "127.0.0.1"),
        port=int(os.environ.get("PGPORT", "5432")),
        database=os.environ.get("PGDATABASE", "postgres"),
    )


@contextmanager
def nothing_yet() -> Iterator[sa.URL]:
    """Make a database of the PostgreSQL server; it goes with the block."""
    name = f"clutchsynth_test_{uuid.uuid4().hex[:12]}"
    engine = sa.create_engine(server(), isolation_level="AUTOCOMMIT", connect_args={"connect_timeout": 3})
    try:
        with engine.connect() as connection:
            connection.execute(sa.text(f"CREATE DATABASE {name}"))
    except OperationalError as error:
        reason = str(error.orig).splitlines()[0]
        pytest.skip(f"NO POSTGRESQL at {server().render_as_string()} ({reason}); PGHOST, PGPORT, PGUSER name another")
    try:
        yield server().set(database=name)
    finally:
        with engine.connect() as connection:
            connection.execute(sa.text(f"DROP DATABASE {name} WITH (FORCE)"))
        engine.dispose()


@cache
def empty_file() -> bytes:
    """Return a file of a database with its tables; to make one takes a third of a second."""
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "jobs.sqlite"
        with Store(file_url(file)) as store, store.engine.connect() as connection:
            connection.exec_driver_sql("PRAGMA wal_checkpoint(TRUNCATE)")
        return file.read_bytes()


class Emptied:
    """A database of the PostgreSQL server that is brought back to what it was when its tables had just been made.

    To make a database with its tables takes the server a second, of which it mostly waits for the disk.
    """

    def __init__(self, url: sa.URL) -> None:
        self.url = url
        Store(url).close()
        self.engine = sa.create_engine(url, isolation_level="AUTOCOMMIT")
        self.metadata = sa.MetaData()
        self.metadata.reflect(self.engine)
        with self.engine.connect() as connection:
            rows = {
                table: [dict(row) for row in connection.execute(sa.select(table)).mappings()]
                for table in self.metadata.sorted_tables
            }
            sequences = connection.exec_driver_sql("SELECT sequencename FROM pg_sequences").scalars().all()
            self.numbers = [
                f"SELECT setval('{name}', {last}, {called})"
                for name in sequences
                for last, called in connection.exec_driver_sql(f"SELECT last_value, is_called FROM {name}")
            ]
        self.rows = {table: found for table, found in rows.items() if found}

    def again(self) -> str:
        """Return the address of the database, with what was in it at first and nothing else."""
        away = [f"DELETE FROM {table.name}" for table in reversed(self.metadata.sorted_tables)]
        others = "FROM pg_stat_activity WHERE datname = current_database() AND pid <> pg_backend_pid()"
        with self.engine.connect() as connection:
            connection.exec_driver_sql(f"SELECT pg_terminate_backend(pid) {others}")
            connection.exec_driver_sql(";".join(["BEGIN", *away, *self.numbers, "COMMIT"]))
            for table, rows in self.rows.items():
                connection.execute(sa.insert(table), rows)
        return self.url.render_as_string(hide_password=False)
