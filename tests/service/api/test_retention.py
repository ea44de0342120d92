"""How long jobs are kept, over the interface."""

from __future__ import annotations

import time
from pathlib import Path
from typing import Any

import pytest
import sqlalchemy as sa

from synth.queue.job_table import NewJob
from synth.queue.models import Job, moment
from tests.service.calling import Service, code_of

DAY = 86_400.0
JOBS = "/api/v1/jobs"


@pytest.fixture
def made(service: Service) -> dict[str, str]:
    """Return a cancelled job, and an open one that needs it."""
    front, _ = service.store.submit(
        NewJob(kind="synthesis", title="front", request={}, fingerprint="a", code="c", keep=DAY)
    )
    service.store.cancel(front)
    report, _ = service.store.submit(
        NewJob(kind="report", title="report", request={"of": front}, fingerprint="b", code="c", keep=DAY)
    )
    return {"front": front, "report": report}


def refused(service: Service, job: str) -> str:
    answer = service("DELETE", f"{JOBS}/{job}")
    assert answer.status_code == 409
    assert service("GET", f"{JOBS}/{job}").status_code == 200
    return code_of(answer)


def test_what_is_kept_for_good_is_not_removed_without_taking_that_back(service: Service, made: dict[str, str]) -> None:
    report = f"{JOBS}/{made['report']}"
    service("PATCH", report, json={"pinned": True})
    assert refused(service, made["report"]) == "pinned"
    assert service("GET", report).json()["state"] == "open"  # not even cancelled
    service("PATCH", report, json={"pinned": False})
    assert service("DELETE", report).status_code == 204


def test_what_an_open_job_needs_is_not_removed(service: Service, made: dict[str, str]) -> None:
    assert refused(service, made["front"]) == "in_use"
    service("POST", f"{JOBS}/{made['report']}/cancel")
    assert service("DELETE", f"{JOBS}/{made['front']}").status_code == 204


@pytest.mark.parametrize("path", ["", "/request", "/result", "/designs"])
def test_who_looks_at_a_job_keeps_it(service: Service, made: dict[str, str], path: str) -> None:
    with service.store.engine.begin() as connection:
        connection.execute(sa.update(Job).values(expires=moment() + 60.0))
    service("GET", JOBS)  # a list is no use
    left = {name: _left(service, job) for name, job in made.items()}
    assert max(left.values()) < 61.0
    service("GET", f"{JOBS}/{made['front']}{path}")
    assert _left(service, made["front"]) > 0.99 * DAY
    assert _left(service, made["report"]) < 61.0


def test_a_use_is_noted_once_in_a_while(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    with Service(tmp_path, keep_days=1.0) as service:
        job, _ = service.store.submit(
            NewJob(kind="synthesis", title="front", request={}, fingerprint="a", code="c", keep=DAY)
        )
        noted: list[Any] = []
        monkeypatch.setattr(service.store, "note_use", lambda *told: noted.append(told))
        service("GET", f"{JOBS}/{job}")
        assert noted == []
        with service.store.engine.begin() as connection:
            connection.execute(sa.update(Job).values(expires=Job.expires - 2 * 3600.0))
        service("GET", f"{JOBS}/{job}")
        assert noted == [([job], DAY)]


def _left(service: Service, job: str) -> float:
    found = service.store.job(job)
    assert found is not None
    assert found.expires is not None
    return found.expires - time.time()
