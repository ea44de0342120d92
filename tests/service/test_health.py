"""Whether a server is of use, and its figures."""

from __future__ import annotations

import json
import re
import subprocess
import sys
import time
from pathlib import Path
from typing import Any

import pytest
import sqlalchemy as sa
from prometheus_client.parser import text_string_to_metric_families

from synth.batches.store import Store
from synth.queue.job_table import DONE, Ending, NewJob
from synth.queue.models import Job, WorkerSign, moment
from tests.service.calling import Service, bearer, code_of


def reasons(service: Service) -> list[str]:
    """Return why a service is not ready."""
    answer = service("GET", "/readyz")
    told: list[str] = answer.json()["reasons"]
    assert (answer.status_code == 200) is (not told)
    assert ("retry-after" in answer.headers) is bool(told)
    return told


FULL = "the database cannot be used"


def test_a_server_without_room_is_not_ready_and_says_why(service: Service, tmp_path: Path) -> None:
    service.store.sign("host/1/2/3", "host", "code", {"slots": 2, "busy": 0})
    assert reasons(service) == []
    with Service(tmp_path, ready_space=10**12) as small:
        (reason,) = reasons(small)
        assert re.fullmatch(r"[0-9 .]+ MB are free where the database is; 1 000 000 MB are needed", reason)


@pytest.mark.skipif(sys.platform == "win32", reason="there are no limits of file sizes")
def test_a_server_that_cannot_write_is_not_ready_as_long(tmp_path: Path) -> None:
    import resource

    with Service(tmp_path, ready_write=0.0) as service:
        service.store.sign("host/1/2/3", "host", "code", {"slots": 2, "busy": 0})
        before = resource.getrlimit(resource.RLIMIT_FSIZE)
        resource.setrlimit(resource.RLIMIT_FSIZE, (1, before[1]))
        try:
            (reason,) = reasons(service)
        finally:
            resource.setrlimit(resource.RLIMIT_FSIZE, before)
        assert reason == f"{FULL} (disk I/O error)"
        assert reasons(service) == []


def test_what_finds_no_room_is_507_with_the_reason(service: Service) -> None:
    token = bearer(service.token("read", "admin"))
    sa.event.listen(service.store.engine, "connect", _is_full)
    service.store.engine.dispose()
    answers = [
        service("POST", "/api/v1/tokens", headers=token, json={"name": "x" * 50, "tenant": f"t{k}"}) for k in range(200)
    ]
    full = next(answer for answer in answers if answer.status_code != 201)
    assert (full.status_code, code_of(full)) == (507, "no_room")
    assert "no room on the disk" in full.json()["error"]["message"]


def _is_full(connection: Any, _: Any) -> None:
    """Let a file not grow any more."""
    pages = connection.execute("PRAGMA page_count").fetchone()[0]
    connection.execute(f"PRAGMA max_page_count={pages}")


def test_a_server_is_ready_where_somebody_works(service: Service) -> None:
    assert service("GET", "/healthz").json() == {"status": "alive"}
    (reason,) = reasons(service)
    assert reason.startswith("no worker has given a sign of life within 30 s; one that has just begun ")
    service.store.sign("host/1/2/3", "host", "code", {"slots": 2, "busy": 0})
    assert reasons(service) == []
    with service.store.engine.begin() as connection:
        connection.execute(sa.update(WorkerSign).values(seen=moment() - 31.0))
    assert len(reasons(service)) == 1


def test_a_server_with_other_tables_is_not_ready(service: Service) -> None:
    with service.store.engine.begin() as connection:
        connection.exec_driver_sql("UPDATE batch_version SET version_num = '9'")
    assert reasons(service) == ["the tables are of version 9; this server needs 2"]


def test_a_server_that_ends_is_not_ready(service: Service) -> None:
    service.context.ending.set()
    assert reasons(service) == ["the server is ending"]


def test_a_server_without_its_database_is_alive_but_not_ready(service: Service) -> None:
    service.store.close()
    service.file.unlink()
    service.file.mkdir()
    assert service("GET", "/healthz").status_code == 200
    (reason,) = reasons(service)
    assert reason.startswith("the database cannot be used")


def test_a_database_that_does_not_answer_is_not_waited_for(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    with Service(tmp_path, ready_database=0.05) as service:
        monkeypatch.setattr(Store, "version", lambda store: time.sleep(0.3))
        assert reasons(service) == ["the database does not answer in 0.05 s"]


# ---- figures --------------------------------------------------------------------------------------------------------


def figures(service: Service) -> dict[tuple[str, tuple[tuple[str, str], ...]], float]:
    """Return all figures, by name and labels."""
    text = service("GET", "/metrics").text
    return {
        (sample.name, tuple(sorted(sample.labels.items()))): sample.value
        for family in text_string_to_metric_families(text)
        for sample in family.samples
    }


def test_requests_are_counted_by_routes_not_by_what_clients_write(service: Service) -> None:
    for path in ("/api/v1/tokens/1", "/api/v1/tokens/2", "/some/thing", "/some/thing?else", "/api/v1/version"):
        service("DELETE" if "tokens" in path else "GET", path)
    service("BREW", "/healthz")
    name = "clutchsynth_http_requests_total"
    counted = {labels: count for (name_, labels), count in figures(service).items() if name_ == name}
    found = {tuple(dict(labels)[key] for key in ("method", "route", "code")): n for labels, n in counted.items()}
    assert found == {
        ("DELETE", "/api/v1/tokens/{token}", "404"): 2,
        ("GET", "none", "404"): 2,
        ("GET", "/api/v1/version", "200"): 1,
        ("other", "/healthz", "405"): 1,
    }


def test_jobs_and_workers_are_told_as_the_database_has_them(service: Service) -> None:
    figures(service)  # what has ended before the server was first asked is not counted
    store = service.store
    new = NewJob(kind="synthesis", title="", request={"family": "cone_clutch"}, fingerprint="f", code="c")
    names = [store.submit(new)[0] for _ in range(3)]
    store.end(names[0], Ending(state=DONE, outcome="optimal"))
    store.end(names[1], Ending(state="failed"))
    with store.engine.begin() as connection:
        earlier = {"created": moment() - 20.0, "started": moment() - 18.0}
        connection.execute(sa.update(Job).where(Job.id == names[0]).values(**earlier))
    store.sign("a", "host", "code", {"slots": 2, "busy": 1, "restarts": {"memory": 2}, "lost": 2})
    store.sign("b", "host", "code", {"slots": 1, "busy": 1, "restarts": {"memory": 1, "crash": 1}})
    ended = next(c for c in service.context.metrics.registry._collector_to_names if hasattr(c, "late"))
    ended.late = -1.0
    found = figures(service)
    assert found["clutchsynth_jobs", (("kind", "synthesis"), ("state", "open"))] == 1
    assert found["clutchsynth_units", (("state", "open"),)] == 3
    assert found["clutchsynth_workers", ()] == 2
    assert found["clutchsynth_slots", (("state", "busy"),)] == 2
    assert found["clutchsynth_slots", (("state", "idle"),)] == 1
    assert found["clutchsynth_engine_restarts_total", (("reason", "memory"),)] == 3
    assert found["clutchsynth_leases_lost_total", ()] == 2
    assert found["clutchsynth_queue_oldest_seconds", ()] >= 0
    assert found["clutchsynth_job_ends_total", (("kind", "synthesis"), ("outcome", "optimal"))] == 1
    assert found["clutchsynth_job_ends_total", (("kind", "synthesis"), ("outcome", "failed"))] == 1
    of_kind = (("family", "cone_clutch"), ("kind", "synthesis"))
    assert found["clutchsynth_job_run_seconds_sum", of_kind] == pytest.approx(18.0, abs=0.5)
    assert found["clutchsynth_job_wait_seconds_sum", (("kind", "synthesis"),)] == pytest.approx(2.0, abs=0.1)
    again = figures(service)
    assert again["clutchsynth_job_ends_total", (("kind", "synthesis"), ("outcome", "optimal"))] == 1


@pytest.mark.parametrize(
    ("address", "headers", "scope", "status"),
    [
        ("127.0.0.1", {}, "", 200),
        ("192.0.2.1", {}, "", 401),
        ("127.0.0.1", {"x-forwarded-for": "192.0.2.1"}, "", 401),
        ("127.0.0.1", {"host": "clutch.example"}, "", 401),
        ("192.0.2.1", {}, "read", 200),
        ("192.0.2.1", {}, "admin", 200),
        ("192.0.2.1", {}, "submit", 403),
    ],
)
def test_figures_are_for_this_machine_and_for_tokens(
    tmp_path: Path, address: str, headers: dict[str, str], scope: str, status: int
) -> None:
    with Service(tmp_path, hosts=("clutch.example",)) as service:
        own = bearer(service.token(scope)) if scope else {}
        answer = service("GET", "/metrics", address=address, headers={**headers, **own})
        assert answer.status_code == status
        if status > 200:
            code_of(answer)


# ---- the process ----------------------------------------------------------------------------------------------------


@pytest.mark.slow
def test_the_server_computes_nothing_itself() -> None:
    code = (
        "import json, sys, synth.service.app, synth.service.serve\n"
        "from pathlib import Path\n"
        "resident = next(line for line in Path('/proc/self/status').read_text().splitlines() if 'VmRSS' in line)\n"
        "print(json.dumps([sorted(sys.modules), resident]))"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    modules, resident = json.loads(done.stdout)
    heavy = {"casadi", "pandas", "cvxpy", "numpy", "scipy", "matplotlib", "alembic", "optuna"}
    assert not heavy & {name.split(".")[0] for name in modules}
    assert int(re.findall(r"\d+", resident)[0]) < 120_000


def test_the_interface_describes_what_it_answers(service: Service) -> None:
    described = service("GET", "/api/v1/openapi.json").json()
    assert {"/api/v1/tokens", "/api/v1/tokens/{token}", "/api/v1/version", "/api/v1/session"} <= set(described["paths"])
    assert "HTTPValidationError" not in described["components"]["schemas"]
    for path, methods in described["paths"].items():
        for method, told in methods.items():
            assert told["summary"], (path, method)
            assert told["description"], (path, method)
            assert {"401", "404", "422", "503"} <= set(told["responses"]), (path, method)
