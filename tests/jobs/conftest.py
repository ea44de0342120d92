"""A database of each kind; where there is no PostgreSQL server its tests are skipped, and say so."""

from __future__ import annotations

import os
import uuid
from collections.abc import Iterator
from pathlib import Path

import pytest
import sqlalchemy as sa
from sqlalchemy.exc import OperationalError

from synth.jobs.database import file_url


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


@pytest.fixture(params=["sqlite", "postgresql"])
def database(request: pytest.FixtureRequest, tmp_path: Path) -> Iterator[str]:
    """Yield the address of an empty database."""
    if request.param == "sqlite":
        yield file_url(tmp_path / "jobs.sqlite").render_as_string()
        return
    name = f"clutchsynth_test_{uuid.uuid4().hex[:12]}"
    engine = sa.create_engine(server(), isolation_level="AUTOCOMMIT", connect_args={"connect_timeout": 3})
    try:
        with engine.connect() as connection:
            connection.execute(sa.text(f"CREATE DATABASE {name}"))
    except OperationalError as error:
        reason = str(error.orig).splitlines()[0]
        pytest.skip(f"NO POSTGRESQL at {server().render_as_string()} ({reason}); PGHOST, PGPORT, PGUSER name another")
    try:
        yield server().set(database=name).render_as_string(hide_password=False)
    finally:
        with engine.connect() as connection:
            connection.execute(sa.text(f"DROP DATABASE {name} WITH (FORCE)"))
        engine.dispose()
