"""The described interface, asked in all ways that a program finds; and what the code of the service does not do."""

from __future__ import annotations

import ast
import gc
import sys
import threading
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
import schemathesis
from hypothesis import HealthCheck, Phase, given, settings
from schemathesis import GenerationMode

from synth.batches.store import Store
from synth.queue.settings import StoreSettings
from synth.service.app import create_app
from synth.service.settings import ServiceSettings
from tests.repetitions import repetitions
from tests.service.calling import Answering, Service, bearer

ROOT = Path(__file__).parents[2]
SOURCES = sorted((ROOT / "synth" / "service").rglob("*.py"))


def imports_of(path: Path) -> set[str]:
    found: set[str] = set()
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            found |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom):
            found.add(str(node.module))
    return found


def test_the_service_opens_no_address_and_runs_nothing_that_it_was_sent() -> None:
    assert len(SOURCES) > 10
    clients = {"urllib.request", "http.client", "httpx", "requests", "aiohttp", "ftplib", "smtplib"}
    code = {"pickle", "marshal", "shelve", "dill"}
    for path in SOURCES:
        assert not imports_of(path) & (clients | code), path
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            if isinstance(node, ast.Call):
                name = getattr(node.func, "id", getattr(node.func, "attr", ""))
                assert name not in ("eval", "exec", "__import__"), path
                shell = [key for key in node.keywords if key.arg == "shell"]
                assert not shell, path


def test_no_middleware_holds_answers_back() -> None:
    for path in SOURCES:
        assert "BaseHTTPMiddleware" not in path.read_text(encoding="utf-8"), path


@pytest.fixture
def public(tmp_path: Path) -> Iterator[Service]:
    """Yield a service that others can reach, under the name that the tool takes."""
    with Service(tmp_path, hosts=("testserver",), failed_tokens=10_000) as found:
        yield found


@pytest.mark.slow
def test_the_interface_keeps_to_its_description(public: Service) -> None:
    """Operations that need neither jobs nor engines, asked with what fits their description and what does not."""
    admin = bearer(public.token("read", "submit", "admin"))
    schema = schemathesis.openapi.from_asgi("/api/v1/openapi.json", public.app)
    schema = schema.include(path_regex="/(tokens|session|version)")
    asked = 0
    for found in schema.get_all_operations():
        operation = found.ok()
        modes = (GenerationMode.POSITIVE, GenerationMode.NEGATIVE)
        for mode in modes if operation.body or operation.path_parameters or operation.query else modes[:1]:
            check(operation, mode, admin)
            asked += 1
    assert asked >= 7


def check(operation: Any, mode: GenerationMode, headers: dict[str, str]) -> None:
    """Ask an operation in many ways."""

    @settings(
        max_examples=repetitions(12, 500),
        deadline=None,
        derandomize=True,
        phases=[Phase.generate],
        suppress_health_check=list(HealthCheck),
    )
    @given(case=operation.as_strategy(generation_mode=mode))
    def ask(case: schemathesis.Case) -> None:
        case.call_and_validate(headers=headers)

    ask()


@pytest.fixture
def elsewhere(database: str, tmp_path: Path) -> Iterator[Service]:
    """Yield a service on a database of either kind."""
    own = Service(tmp_path)
    own.store.close()
    own.store = Store(database, settings=StoreSettings(patience=5.0))
    own.app = create_app(ServiceSettings(data=tmp_path), own.store, Answering())
    own.context = own.app.state.context
    own.accounts = own.context.accounts
    with own:
        yield own


def test_it_is_the_same_on_both_databases(elsewhere: Service) -> None:
    made = elsewhere("POST", "/api/v1/tokens", json={"name": "a", "scopes": ["admin", "read"], "tenant": "acme"})
    assert made.status_code == 201
    admin = bearer(made.json()["value"])
    assert elsewhere("GET", "/api/v1/session", headers=admin).json() == {"tenant": "acme", "scopes": ["admin", "read"]}
    assert elsewhere("GET", "/readyz").status_code == 503
    elsewhere.store.sign("a", "host", "code", {"slots": 1})
    assert elsewhere("GET", "/readyz").status_code == 200
    assert "clutchsynth_workers 1.0" in elsewhere("GET", "/metrics").text
    (entry,) = elsewhere("GET", "/api/v1/tokens", headers=admin).json()["tokens"]
    assert entry["used"] is not None
    assert elsewhere("DELETE", f"/api/v1/tokens/{entry['id']}", headers=admin).status_code == 204
    assert elsewhere("GET", "/api/v1/session", headers=admin).status_code == 401


@pytest.mark.slow
def test_a_database_that_others_write_into_lets_requests_wait_but_not_the_server(service: Service) -> None:
    """A writer holds the only lock of SQLite: reading goes on, writing waits until it lets go."""
    admin = bearer(service.token("admin"))
    service("GET", "/api/v1/session", headers=admin)  # its use is noted
    held, enough = threading.Event(), threading.Event()

    def write() -> None:
        with service.store.engine.begin() as connection:
            connection.exec_driver_sql("UPDATE tenant SET name = name")
            held.set()
            assert enough.wait(20.0)

    thread = threading.Thread(target=write)
    thread.start()
    held.wait()
    assert service("GET", "/api/v1/tokens", headers=admin).status_code == 200  # while the lock is held
    later = threading.Timer(0.6, enough.set)
    later.start()
    begun = time.monotonic()
    assert service("POST", "/api/v1/tokens", headers=admin, json={"name": "a"}).status_code == 201
    assert time.monotonic() - begun > 0.5
    later.join()
    thread.join()


@pytest.mark.slow
def test_requests_leave_nothing_behind(service: Service) -> None:
    admin = bearer(service.token("admin", "read"))

    def ask(count: int) -> None:
        for k in range(count):
            service("GET", "/api/v1/tokens", headers=admin)
            service("GET", f"/nothing/{k}")
            service("GET", "/api/v1/session", headers=bearer(f"cs_{k}"), address=f"192.0.2.{k % 200}")
        gc.collect()

    ask(50)
    before = len(gc.get_objects()), sys.getallocatedblocks()
    ask(150)
    after = len(gc.get_objects()), sys.getallocatedblocks()
    assert after[0] - before[0] < 2_000
    assert after[1] - before[1] < 20_000
