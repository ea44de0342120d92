"""A database of each kind; where there is no PostgreSQL server its tests are skipped, and say so."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import pytest

from synth.queue.database import file_url
from tests.queue.databases import Emptied, empty_file, nothing_yet


@pytest.fixture(params=["sqlite", "postgresql"])
def new_database(request: pytest.FixtureRequest, tmp_path: Path) -> Iterator[str]:
    """Yield the address of a database in which nothing is, not even tables."""
    if request.param == "sqlite":
        yield file_url(tmp_path / "jobs.sqlite").render_as_string()
        return
    with nothing_yet() as url:
        yield url.render_as_string(hide_password=False)


@pytest.fixture(scope="session")
def emptied() -> Iterator[Emptied]:
    """Yield a database of the PostgreSQL server for all tests of a process, one after the other."""
    with nothing_yet() as url:
        kept = Emptied(url)
        yield kept
        kept.engine.dispose()


@pytest.fixture(params=["sqlite", "postgresql"])
def database(request: pytest.FixtureRequest, tmp_path: Path) -> str:
    """Return the address of a database with its tables, and nothing in them."""
    if request.param == "postgresql":
        kept: Emptied = request.getfixturevalue("emptied")
        return kept.again()
    file = tmp_path / "jobs.sqlite"
    file.write_bytes(empty_file())
    return file_url(file).render_as_string()
