"""A service that works, once for each file of tests, and what it has found."""

from __future__ import annotations

from collections.abc import Iterator

import pytest

from synth.workers.engine_process import Engines
from synth.workers.engine_tasks import FAMILIES_TASK
from synth.workers.settings import INTERACTIVE
from tests.service.calling import Service
from tests.service.working import BATCH, FRONT, Client, working

WARM = 120.0  # s


@pytest.fixture(scope="session")
def engines() -> Iterator[Engines]:
    """Yield one engine process."""
    found = Engines(1, INTERACTIVE)
    found.call(FAMILIES_TASK, {}, WARM)  # what a test asks first is not to wait for a process that begins
    yield found
    found.close()


@pytest.fixture(scope="module")
def works(engines: Engines, tmp_path_factory: pytest.TempPathFactory) -> Iterator[Service]:
    """Yield a service at this machine whose jobs are worked at."""
    with working(tmp_path_factory.mktemp("service"), engines) as service:
        yield service


@pytest.fixture(scope="module")
def client(works: Service) -> Client:
    """Yield whoever is at this machine."""
    return Client(works)


@pytest.fixture(scope="module")
def front(client: Client) -> str:
    """Yield a job that has found a front."""
    job = client.submit("synthesis", FRONT)
    assert client.ended(job)["state"] == "done"
    return job


@pytest.fixture(scope="module")
def table(client: Client) -> str:
    """Yield a batch of three rows, of which one cannot be asked."""
    job = client.submit("batch", BATCH)
    assert client.ended(job)["state"] == "done"
    return job
