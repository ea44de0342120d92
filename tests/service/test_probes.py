"""What is made to cost much, or to reach what it should not: sent to a server as it runs, and harmless."""

from __future__ import annotations

import os
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from tests.service.served import Served, most_memory, served
from tests.service.working import FAMILY, QUICK

pytestmark = pytest.mark.slow
MEMORY = 500_000_000  # bytes
TRIED = ("check", "synthesis", "whatif", "explain", "compare", "rate", "batch")


@pytest.fixture(scope="module")
def server(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Served]:
    """Yield a server whose engine process is warm."""
    with served(tmp_path_factory.mktemp("probes"), "--workers", "1") as found:
        found.warm()
        yield found


def with_table(place: str) -> dict[str, Any]:
    return {**QUICK, "catalogs": {"friction_materials": place}}


def with_limit(value: Any) -> dict[str, Any]:
    return {**QUICK, "limits": {"mass": value}}


def nested(depth: int) -> Any:
    value: Any = 1
    for _ in range(depth):
        value = {"a": value}
    return value


STEPS = {"from": "1 N*m", "to": "1000 N*m", "count": 100_000_000}
PROBES: dict[str, dict[str, Any]] = {
    "a table that never ends": with_table("/dev/zero"),
    "a table of the machine": with_table("/etc/passwd"),
    "a table beside": with_table("../../friction_materials.csv"),
    "a table that waits": with_table("FIFO"),
    "a table by another name": with_table("LINK"),
    "a table elsewhere": with_table("http://169.254.169.254/latest/meta-data"),
    "a table among others": {**QUICK, "catalogs": {"friction_materials": ["+", "file:///etc/passwd"]}},
    "steps without end": {**QUICK, "vary": {"load_torque": STEPS}, "breaks": False},
    "steps without end as text": {**QUICK, "vary": {"load_torque": "0:1000:0.00001 N*m"}, "breaks": False},
    "limits without end": with_limit(["<= 20 kg"] * 20_000),
    "a limit too many": with_limit([f"<= {k} kg" for k in range(1, 202)]),
    "as many limits as may be": with_limit([f"<= {k} kg" for k in range(1, 201)]),
    "points without end": {**QUICK, "points": 10**9, "time_limit": 2},
    "a megabyte of digits": with_limit("<= " + "9" * 990_000 + " kg"),
    "brackets": {**QUICK, "conditions": ["(" * 5_000 + "mass" + ")" * 5_000 + " < 1 kg"]},
    "brackets in a limit": with_limit("(" * 5_000 + "1 kg" + ")" * 5_000),
    "negations": {**QUICK, "where": "not " * 100_000 + "true"},
    "infinity": {**QUICK, "requirements": {**QUICK["requirements"], "load_torque": "1e400 N*m"}},
    "a unit without end": {
        **QUICK,
        "requirements": {**QUICK["requirements"], "load_torque": "6 " + "*".join(["kg"] * 9_000)},
    },
    "other digits": {**QUICK, "requirements": {**QUICK["requirements"], "load_torque": "\u0666\u0660\u0660 N*m"}},
    "objects in objects": {**QUICK, "fix": nested(900)},
    "no gap at all": {**QUICK, "gap": 1e-300},
    "an odd family": {"family": "../" * 50 + "\u202e\u2066" + "x" * 1_000},
    "an odd option": {**QUICK, "options": {"__class__": "__init__", "lubrication": "{0.__class__}"}},
    "a family as a list": {"family": [FAMILY] * 1_000},
    "designs that are none": {**QUICK, "design": {"values": {"mass": "__import__('os').system('true')"}}},
}
HARMLESS = ("other digits", "as many limits as may be")  # these may be asked


@pytest.mark.parametrize("name", PROBES)
def test_what_is_made_to_cost_much_is_refused_or_harmless(server: Served, name: str, tmp_path: Path) -> None:
    spec = dict(PROBES[name])
    if name == "a table that waits":
        os.mkfifo(tmp_path / "fifo")
        spec = with_table(str(tmp_path / "fifo"))
    elif name == "a table by another name":
        (tmp_path / "link").symlink_to("/etc/passwd")
        spec = with_table(str(tmp_path / "link"))
    for kind in TRIED:
        path = "check" if kind == "check" else "jobs"
        asked = spec if kind == "check" else {"kind": kind, "request": spec}
        answer = server.ask("POST", path, json=asked)
        assert len(answer.content) < 50_000, kind
        if answer.status_code == 202:
            assert name in HARMLESS, (kind, answer.text)
            assert server.ask("DELETE", f"jobs/{answer.json()['id']}").status_code == 204
        elif kind == "check" and answer.status_code == 200:
            assert answer.json()["problems"] or name in HARMLESS, answer.text
        else:
            assert answer.status_code in (413, 422), (kind, answer.text)
    assert most_memory(server.pid) < MEMORY
    assert server.ask("GET", "/healthz").status_code == 200


def test_the_server_stays_small(server: Served) -> None:
    """After all that was sent to it, and with a body as large as may be."""
    body = b'{"family": "' + b"x" * 999_000 + b'"}'
    for _ in range(20):
        server.ask("POST", "check", content=body, headers={"Content-Type": "application/json"})
    assert most_memory(server.pid) < MEMORY / 2
