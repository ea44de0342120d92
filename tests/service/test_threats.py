"""Every threat of the table in docs/security.md has tests that exist; and tests of a running server."""

from __future__ import annotations

import ast
import gzip
import os
import re
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import httpx
import pytest
import sqlalchemy as sa

from synth.batches.store import Store
from synth.queue.accounts import Accounts
from synth.queue.models import Base
from tests.service.calling import bearer
from tests.service.served import served, watched
from tests.service.test_interface import imports_of
from tests.service.working import BATCH, FRONT, QUICK
from tests.terminal.entry import at_once
from tests.waiting import until

ROOT = Path(__file__).parents[2]
PAGE = ROOT / "docs" / "security.md"
TESTS = ROOT / "tests"
REACHED = [*sorted((ROOT / "synth" / "service").rglob("*.py")), *sorted((ROOT / "synth" / "client").rglob("*.py"))]

# ---- the table ------------------------------------------------------------------------------------------------------


def rows() -> list[tuple[str, str, list[str]]]:
    """Return the table of the page: what is feared, what is done, and the names of the tests."""
    section = PAGE.read_text(encoding="utf-8").partition("## Threats and their tests")[2].partition("\n## ")[0]
    lines = [line for line in section.splitlines() if line.startswith("| ")]
    cells = [[cell.strip() for cell in re.split(r"(?<!\\)\|", line.strip("| "))] for line in lines[1:]]
    return [(threat, measure, re.findall(r"`([^`]+)`", tests)) for threat, measure, tests in cells]


def test_every_threat_of_the_page_has_tests_that_are_there() -> None:
    found = rows()
    assert len(found) >= 23
    known: dict[str, set[str]] = {}
    for threat, measure, tests in found:
        assert measure, threat
        assert tests, threat
        for test in tests:
            file, _, name = test.partition("::")
            if file not in known:
                tree = ast.parse((TESTS / file).read_text(encoding="utf-8"))
                known[file] = {node.name for node in tree.body if isinstance(node, ast.FunctionDef)}
            assert name in known[file], test


# ---- what the code does not do --------------------------------------------------------------------------------------


@pytest.mark.parametrize("path", REACHED, ids=lambda path: str(path.relative_to(ROOT)))
def test_nothing_that_is_read_from_others_can_be_code(path: Path) -> None:
    tree = ast.parse(path.read_text(encoding="utf-8"))
    assert not imports_of(path) & {"pickle", "marshal", "shelve", "dill", "cloudpickle", "joblib"}
    for node in ast.walk(tree):
        if not isinstance(node, ast.Call):
            continue
        name = getattr(node.func, "id", getattr(node.func, "attr", ""))
        owner = getattr(getattr(node.func, "value", None), "id", "")
        assert name not in ("eval", "exec", "__import__", "import_module"), ast.unparse(node)
        assert not (name == "compile" and owner != "re"), ast.unparse(node)
        assert not (owner == "yaml" and name != "safe_load"), ast.unparse(node)
        assert not (owner == "os" and name in ("system", "popen")), ast.unparse(node)


def test_all_that_is_installed_is_locked_by_its_digest() -> None:
    for name in ("requirements.lock", "requirements-service.lock", "requirements-dev.lock"):
        text = (ROOT / name).read_text(encoding="utf-8").replace("\\\n", " ")
        wanted = [line for line in text.splitlines() if "==" in line and not line.lstrip().startswith("#")]
        assert wanted
        for line in wanted:
            assert "--hash=sha256:" in line, f"{name}: {line}"


# ---- what the server as it runs does not do -------------------------------------------------------------------------

PLACE = "http://169.254.169.254/latest/meta-data"


@pytest.mark.slow
def test_no_process_of_the_server_reaches_beyond_this_machine(tmp_path: Path) -> None:
    """Every process writes down where it wants to go, and may not."""
    with served(tmp_path, "--workers", "1") as server:
        server.warm()
        wishes: list[dict[str, Any]] = [
            {"kind": "synthesis", "request": {**QUICK, "catalogs": {"friction_materials": PLACE}}},
            {"kind": "synthesis", "request": {**QUICK, "of": PLACE}},
            {"kind": "batch", "request": {**BATCH, "upload": PLACE}},
            {"kind": "batch", "request": {**BATCH, "mapping": PLACE}},
            {"kind": "report", "request": {"of": PLACE}},
        ]
        for wish in wishes:
            assert server.ask("POST", "jobs", json=wish).status_code == 422
        table = {"name": "x", "table": "friction_materials", "csv": f"{PLACE}\n{PLACE}\n"}
        assert server.ask("POST", "catalogues", json=table).status_code == 422
        book = f'<?xml version="1.0"?><!DOCTYPE a SYSTEM "{PLACE}"><a/>'.encode()
        assert server.ask("POST", "uploads", files={"file": ("a.xlsx", book)}).status_code == 415
        assert server.ask("GET", "families", headers={"Referer": PLACE, "X-Forwarded-Host": "x.example"}).is_success
        job = server.ask(
            "POST", "jobs", json={"kind": "synthesis", "request": {**FRONT, "points": 1}, "title": PLACE}
        ).json()["id"]
        assert server.ended(job)["state"] == "done"
        for file in server.ask("GET", f"jobs/{job}/files").json()["files"]:
            assert server.ask("GET", file["href"]).status_code == 200, file
        assert server.network() == ""
        assert server.processes() >= 5  # the server, its worker, and the processes that compute


def test_the_watch_sees_who_reaches_beyond_this_machine(tmp_path: Path) -> None:
    """Else the test above could not fail."""
    program = "import socket; socket.create_connection(('192.0.2.1', 80), 1.0)"
    done = subprocess.run(
        [sys.executable, "-c", program], env={**os.environ, **watched(tmp_path)}, capture_output=True, check=False
    )
    assert b"this is not done here" in done.stderr
    assert "192.0.2.1" in (tmp_path / "watched").read_text()


@pytest.mark.slow
def test_secrets_are_neither_told_nor_logged_nor_kept(database: str, tmp_path: Path) -> None:
    url = sa.make_url(database)
    password = "Geheimnis-4711"
    if url.get_backend_name() == "postgresql":
        password = str(url.password or password)  # a server that trusts this machine takes any
        url = url.set(password=password)
    text = url.render_as_string(hide_password=False)
    with Store(text) as store:
        accounts = Accounts(store)
        tokens = [accounts.make_token(f"t{k}", 1, ["read", "submit", "admin"], 1.0).value for k in range(2)]
        told: list[str] = []
        with served(tmp_path, "--workers", "1", environment={"CLUTCHSYNTH_DATABASE": text}) as server:

            def ask(method: str, path: str, token: str = tokens[0], **more: Any) -> httpx.Response:
                answer = server.ask(method, path, headers=bearer(token), **more)
                told.append(answer.text)
                return answer

            made = ask("POST", "tokens", json={"name": "third"}).json()["value"]
            told.pop()  # it is shown this once
            cookie = ask("POST", "session").cookies["clutchsynth_session"]
            assert ask("GET", "session", tokens[1][:-1]).status_code == 401
            assert ask("DELETE", "tokens/2").status_code == 204
            assert ask("GET", "session", tokens[1]).status_code == 401  # from the next request on
            job = ask("POST", "jobs", json={"kind": "batch", "request": BATCH}).json()["id"]
            assert server.ended(job, headers=bearer(tokens[0]))["state"] == "done"
            for path in ("tokens", f"jobs/{job}", f"jobs/{job}/result", f"jobs/{job}/files/rows.csv", "openapi.json"):
                assert ask("GET", path).status_code == 200, path
            assert ask("GET", f"jobs/{tokens[0]}").status_code == 404
            assert ask("POST", "check", json={"family": tokens[0]}).status_code == 200
            told.pop()  # what was said in the body is repeated to whoever has said it
            until(lambda: ask("GET", "/readyz").status_code == 200)  # an answer may come before all has begun
            for path in ("/metrics", "/healthz"):
                assert ask("GET", path).status_code == 200
            commands = [file.read_bytes() for file in Path("/proc").glob("[0-9]*/cmdline") if file.is_file()]
            kept = b"".join(kept_of(store))
            with store.engine.begin() as connection:
                connection.execute(sa.text("ALTER TABLE job RENAME TO jobs_away"))
            assert ask("GET", "jobs").status_code in (500, 503)
            with store.engine.begin() as connection:
                connection.execute(sa.text("ALTER TABLE jobs_away RENAME TO job"))
        said = server.said()
    assert {"wrong_token", "request", "worker_begun", "said"} <= {line["event"] for line in server.log()}
    wrong = url.set(port=1) if url.get_backend_name() == "postgresql" else url.set(database="/proc/none/jobs.sqlite")
    refused = at_once("serve", "--database", wrong.render_as_string(hide_password=False), "--no-workers")
    assert refused.returncode == 2
    for secret in (tokens[0], tokens[1], made, cookie, password):
        assert secret not in "".join(told)
        assert secret not in refused.stderr + refused.stdout
        assert secret.encode() not in kept
        assert not [command for command in commands if secret.encode() in command]
        assert secret not in said


def kept_of(store: Store) -> Iterator[bytes]:
    """Yield all that a database holds."""
    with store.engine.connect() as connection:
        for table in Base.metadata.sorted_tables:
            for row in connection.execute(sa.select(table)):
                for value in row:
                    content = value if isinstance(value, bytes) else repr(value).encode()
                    yield gzip.decompress(content) if content.startswith(b"\x1f\x8b") else content
