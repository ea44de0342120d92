"""A service with an empty database."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import pytest

from tests.queue.conftest import database, emptied  # noqa: F401  (fixtures)
from tests.service.calling import Service


@pytest.fixture
def service(tmp_path: Path) -> Iterator[Service]:
    """Yield a service at this machine that nobody has made a token for."""
    with Service(tmp_path) as found:
        yield found
