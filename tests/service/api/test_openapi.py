"""The description of the interface: complete, true, and of no use to whoever asks for what is not his."""

from __future__ import annotations

import re
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
import sqlalchemy as sa
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from synth.queue.models import Tenant, Token
from synth.workers.engine_process import Engines, EngineTimeoutError
from tests.repetitions import repetitions
from tests.service.calling import Answering, Service, code_of
from tests.service.working import API, BATCH, DUTY, FAMILY, FRONT, LONG, QUICK, Client, working

pytestmark = pytest.mark.slow
METHODS = ("get", "post", "patch", "delete", "put")
WITHOUT_SCOPE = {"/version", "/session"}  # of whoever asks, or of nobody
FOR_ADMINISTRATORS = ("/tokens", "/tenants/jobs")


@pytest.fixture(scope="module")
def described(client: Client) -> dict[str, Any]:
    answer = client.get("openapi.json")
    assert answer.status_code == 200
    found: dict[str, Any] = answer.json()
    return found


def operations(described: dict[str, Any]) -> Iterator[tuple[str, str, dict[str, Any]]]:
    for path, methods in described["paths"].items():
        for method in METHODS:
            if method in methods:
                yield method.upper(), path, methods[method]


def test_every_route_is_described(described: dict[str, Any]) -> None:
    found = list(operations(described))
    assert len(found) >= 35
    for method, path, operation in found:
        where = f"{method} {path}"
        assert operation["summary"], where
        assert operation.get("description"), where
        codes = set(operation["responses"])
        assert codes & {"200", "201", "202", "204"}, where
        assert {"400", "401", "403", "404", "405", "421", "422", "429", "500", "503"} <= codes, where
        assert not re.search(r" [A-Z]", operation["summary"]), where  # words for people, not names of functions
        assert operation["operationId"], where
        body = operation.get("requestBody")
        if body is not None and "application/json" in body["content"]:
            assert examples_of(described, body["content"]["application/json"]), where


def examples_of(described: dict[str, Any], content: dict[str, Any]) -> list[Any]:
    """Return the examples of a body, beside it or in its schema."""
    found = [one["value"] for one in content.get("examples", {}).values()]
    schema = content["schema"]
    if "$ref" in schema:
        schema = described["components"]["schemas"][schema["$ref"].rsplit("/", 1)[1]]
    return found + list(schema.get("examples", ()))


def test_every_example_of_a_body_is_taken(client: Client, described: dict[str, Any], front: str) -> None:
    taken = 0
    for method, path, operation in operations(described):
        content = operation.get("requestBody", {}).get("content", {}).get("application/json")
        if content is None or path.startswith(f"{API}/tokens"):  # a token would ask everybody for one
            continue
        for example in examples_of(described, content):
            answer = client(method, path.replace("{job}", front), json=example)
            assert 200 <= answer.status_code < 300, (method, path, answer.text)
            taken += 1
    assert taken >= 7
    (form,) = described["paths"][f"{API}/uploads"]["post"]["requestBody"]["content"]["multipart/form-data"][
        "examples"
    ].values()
    brought = client.post("uploads", files={name: ("rows.csv", text) for name, text in form["value"].items()})
    assert brought.status_code == 201
    checked = client.post("batches/check", {"family": FAMILY, "upload": brought.json()["id"]}).json()
    assert (checked["rows"], checked["bad"]) == (2, 0)


def test_the_description_says_where_and_what_is_said_twice(described: dict[str, Any]) -> None:
    assert described["servers"][0]["url"] == "/"
    keyed = {
        (method, path.removeprefix(API))
        for method, path, operation in operations(described)
        if any(one["name"].lower() == "idempotency-key" for one in operation.get("parameters", ()))
    }
    assert keyed == {("POST", "/jobs"), ("POST", "/batches")}
    assert all(f"`{method} {path}`" in described["info"]["description"] for method, path in keyed)
    signing_in = described["paths"][f"{API}/session"]["post"]
    assert "Authorization" in signing_in["description"]
    assert "requestBody" not in signing_in
    assert "Set-Cookie" in signing_in["responses"]["201"]["headers"]


# ---- tenants --------------------------------------------------------------------------------------------------------


def test_nobody_sees_what_is_another_s(engines: Engines, tmp_path: Path) -> None:
    with working(tmp_path, engines) as service:
        mine, theirs = (Client(service, service.token(tenant=name)) for name in ("a", "b"))
        job, table = mine.submit("synthesis", FRONT, title="secret"), mine.submit("batch", BATCH)
        mine.ended(job)
        mine.ended(table)
        rows = {"file": ("rows.csv", b"load_torque\n600\n")}
        upload = mine.post("uploads", files=rows).json()["id"]
        body = service.app.openapi()["components"]["schemas"]["CatalogueRequest"]["examples"][0]
        assert mine.post("catalogues", body).status_code == 201
        names = {"job": job, "line": "2", "name": "my_linings", "version": "1", "token": "1"}
        seen = 0
        for method, path, _ in operations(service.app.openapi()):
            if "{" not in path or "/families/" in path:
                continue
            for job_named in (job, table):
                given = {**names, "job": job_named, **({"name": "front.json"} if "/files/" in path else {})}
                place = path.replace("{name:path}", "{name}").format(**given)
                asked = {"json": {"title": "mine now"}} if method == "PATCH" else {}
                query = "?since=1" if path.endswith("/changes") else ""
                answer = theirs(method, place + query, **asked)
                expected = 403 if "/tokens" in path else 404
                assert (answer.status_code, method) == (expected, method), place
                assert "secret" not in answer.text
                seen += 1
        assert seen >= 30
        for path in ("jobs", "catalogues", f"jobs?parent={job}", f"jobs?q={job}"):
            (found,) = [value for value in theirs.get(path).json().values() if isinstance(value, list)]
            assert found == [], path
        refused = [
            theirs.post("jobs", {"kind": "report", "request": {"of": job}}),
            theirs.post("jobs", {"kind": "synthesis", "request": {"of": job, "points": 1}}),
            theirs.post("jobs", {"kind": "size_range", "request": {"of": table}}),
            theirs.post("jobs", {"kind": "synthesis", "request": QUICK, "parent": job}),
            theirs.post("jobs", {"kind": "synthesis", "request": {**QUICK, "catalogs": {"x": "my_linings@1"}}}),
            theirs.post("batches", {"family": FAMILY, "upload": upload}),
            theirs.post("batches/check", {"family": FAMILY, "upload": upload}),
        ]
        for answer in refused:
            assert (answer.status_code, code_of(answer)) == (422, "bad_input"), answer.text
            assert "secret" not in answer.text
        assert theirs.post("check", {"of": job}).json()["ready"] is False
        assert theirs.get(f"events?jobs={job}").status_code == 404
        key = {"Idempotency-Key": "k"}
        first = mine.post("jobs", {"kind": "synthesis", "request": QUICK}, headers=key)
        second = theirs.post("jobs", {"kind": "synthesis", "request": QUICK}, headers=key)
        assert (first.status_code, second.status_code) == (202, 202)
        assert first.json()["id"] != second.json()["id"]
        same = theirs.post("batches", BATCH)
        assert same.status_code == 202
        assert same.json()["id"] != table
        assert mine.get(f"jobs/{job}").json()["title"] == "secret"


def test_scopes_are_needed(works: Service, described: dict[str, Any]) -> None:
    none, reader = Client(works, works.token("admin")), Client(works, works.token("read"))
    try:
        for method, path, _ in operations(described):
            place = path.removeprefix(API)
            if place in WITHOUT_SCOPE or place.startswith(FOR_ADMINISTRATORS):
                continue
            filled = path.replace("{name:path}", "x").format(job="j", name="n", line=1, version=1)
            answer = none(method, f"{filled}{'?since=1&jobs=j' if method == 'GET' else ''}", json={})
            assert answer.status_code in (403, 404, 422), place
            assert answer.status_code != 404 or "{job}" in place
            if method != "GET" and place not in ("/check", "/evaluate", "/batches/check"):
                assert reader(method, filled, json={}).status_code in (403, 404, 422)
            assert Client(works)(method, filled).status_code == 401
        assert reader.post("jobs", {"kind": "synthesis", "request": QUICK}).status_code == 403
        assert reader.post("uploads", files={"file": ("a.csv", b"a\n1\n")}).status_code == 403
    finally:
        with works.store.engine.begin() as connection:
            connection.execute(sa.delete(Token))


EVIL = ("..%2f..%2fetc%2fpasswd", "%2e%2e", "%2Fetc%2Fpasswd", "a%00b", "http:%2f%2fexample.com%2fx", "a" * 3000, "%ff")


def test_no_place_of_a_machine_or_a_network_is_taken(client: Client, described: dict[str, Any]) -> None:
    seen = 0
    for method, path, _ in operations(described):
        names = re.findall(r"{(\w+)}", path)
        for wrong in names:
            for evil in EVIL:
                place = path
                for name in names:
                    place = place.replace(f"{{{name}}}", evil if name == wrong else "1")
                asked = {"json": {}} if method == "PATCH" else {}
                answer = client(method, f"{place}{'?since=1' if place.endswith('changes') else ''}", **asked)
                assert answer.status_code in (404, 405, 422), (method, place, answer.text)
                seen += 1
    assert seen >= 100


# ---- every status ---------------------------------------------------------------------------------------------------


def test_every_status_of_the_interface_is_seen(client: Client, front: str, tmp_path: Path) -> None:
    state = client.get(f"jobs/{front}")
    job = client.submit("synthesis", LONG)
    seen = {
        200: state,
        201: client.post("uploads", files={"file": ("rows.csv", b"load_torque\n600\n")}),
        202: client.post(f"jobs/{job}/cancel"),
        204: client("DELETE", f"jobs/{job}"),
        304: client.get(f"jobs/{front}", headers={"If-None-Match": state.headers["etag"]}),
        400: client.post("jobs", content=b"{", headers={"Content-Type": "application/json"}),
        404: client.get(f"jobs/{job}"),
        405: client("PUT", f"jobs/{front}"),
        409: client.post(f"jobs/{front}/cancel"),
        413: client.post("check", content=b" " * 1_100_000, headers={"Content-Type": "application/json"}),
        415: client.post("jobs", content=b"family: x", headers={"Content-Type": "application/yaml"}),
        422: client.post("jobs", {"kind": "synthesis", "request": {}}),
    }
    assert {status: answer.status_code for status, answer in seen.items()} == {status: status for status in seen}

    def late(task: str, payload: Any) -> Any:
        raise EngineTimeoutError("later")

    with Service(tmp_path, Answering(late)) as service:
        busy = Client(service).post("evaluate", {})
        assert (busy.status_code, code_of(busy), int(busy.headers["retry-after"]) >= 1) == (503, "unavailable", True)


def test_the_server_imports_nothing_heavy() -> None:
    program = (
        "import sys, tempfile; from pathlib import Path\n"
        "from tests.service.calling import Service\n"
        "with tempfile.TemporaryDirectory() as folder, Service(Path(folder)) as service:\n"
        "    for path in ('openapi.json', 'jobs', 'catalogues', 'families', 'jobs/x/rows'):\n"
        "        service('GET', f'/api/v1/{path}')\n"
        "    service('POST', '/api/v1/jobs', json={'kind': 'synthesis', 'request': {}})\n"
        "print([name for name in ('casadi', 'numpy', 'pandas', 'cvxpy', 'scipy') if name in sys.modules])\n"
    )
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"


# ---- anything at all ------------------------------------------------------------------------------------------------

WORDS = st.one_of(
    st.text(st.characters(exclude_categories=("Cs",), exclude_characters="\0"), max_size=30),
    st.sampled_from(["600 N*m", "1e400", "<= 20 kg", "((((", "not not x", "+", "any", "/etc/passwd", "200:300:1 mm"]),
)
VALUES = st.recursive(
    st.one_of(st.none(), st.booleans(), st.integers(), st.floats(allow_nan=False, allow_infinity=False), WORDS),
    lambda inner: st.one_of(st.lists(inner, max_size=4), st.dictionaries(WORDS, inner, max_size=4)),
    max_leaves=8,
)
KEYS = ("family", "requirements", "limits", "fix", "parts", "objectives", "points", "gap", "options", "robust")
SPECS = st.one_of(
    st.dictionaries(st.sampled_from([*KEYS, "catalogs", "of", "grid", "seed", "time_limit", "vary", "values"]), VALUES),
    st.builds(lambda more: {**QUICK, **more}, st.dictionaries(st.sampled_from(KEYS), VALUES, max_size=2)),
    st.builds(lambda name, value: {**QUICK, "requirements": {**DUTY, name: value}}, st.sampled_from([*DUTY]), VALUES),
)
KINDS = ("synthesis", "whatif", "explain", "compare", "prices", "rate", "verify", "report", "batch", "size_range", "x")
FEW = settings(
    max_examples=repetitions(25, 1000), deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture]
)


@FEW
@given(SPECS)
def test_any_spec_can_be_checked(client: Client, spec: dict[str, Any]) -> None:
    answer = client.post("check", spec)
    assert answer.status_code in (200, 422), answer.text


@FEW
@given(st.sampled_from(KINDS), SPECS, VALUES)
def test_any_job_can_be_asked(client: Client, kind: str, spec: dict[str, Any], title: Any) -> None:
    answer = client.post("jobs", {"kind": kind, "request": spec, "title": title})
    assert answer.status_code in (200, 202, 422), answer.text
    if answer.status_code == 202:
        assert client("DELETE", f"jobs/{answer.json()['id']}").status_code == 204


def test_limits_of_a_tenant_that_is_gone_are_none(works: Service) -> None:
    with works.store.engine.connect() as connection:
        assert connection.scalar(sa.select(sa.func.count()).select_from(Tenant)) == 1
