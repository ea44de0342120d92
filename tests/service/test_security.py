"""What a request must pass: names, sites, bodies, numbers of requests; and what every answer carries."""

from __future__ import annotations

import asyncio
import json
import logging
import re
from pathlib import Path
from typing import Annotated, Any

import httpx
import pytest
from fastapi import Request
from hypothesis import given, settings
from hypothesis import strategies as st
from pydantic import Field, TypeAdapter, ValidationError

from synth.errors import InputError
from synth.queue.accounts import NAME_PATTERN
from synth.service.errors import ServiceError
from synth.service.recording import LOG
from synth.service.security import SESSION_COOKIES, check_json
from synth.service.wording import LINE, TITLE
from synth.text.plain_text import UNSAFE
from synth.workers.engine_process import EngineCrashedError, EngineFailedError, EngineTimeoutError, Failure
from tests.repetitions import repetitions
from tests.service.calling import HOME, Service, bearer, code_of

TOKENS = "/api/v1/tokens"


# ---- one form of refusal --------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("method", "path", "status", "code"),
    [
        ("GET", "/nothing", 404, "not_found"),
        ("GET", "/api/v1/tokens/../../etc/passwd", 404, "not_found"),
        ("GET", "/api/v1/%2e%2e/%00", 404, "not_found"),
        ("GET", "//etc/passwd", 404, "not_found"),
        ("PUT", TOKENS, 405, "method_not_allowed"),
        ("DELETE", f"{TOKENS}/one", 422, "bad_input"),
        ("DELETE", f"{TOKENS}/99999999999999999999", 422, "bad_input"),
        ("DELETE", f"{TOKENS}/7", 404, "not_found"),
        ("POST", TOKENS, 422, "bad_input"),
    ],
)
def test_every_refusal_has_one_form(service: Service, method: str, path: str, status: int, code: str) -> None:
    answer = service(method, path)
    assert (answer.status_code, code_of(answer)) == (status, code)


def test_what_is_not_allowed_says_what_is(service: Service) -> None:
    assert service("PUT", "/healthz").headers["allow"] == "GET"
    for method, path, allowed in (
        ("PUT", TOKENS, "GET, POST"),
        ("PUT", "/api/v1/jobs/x", "DELETE, GET, PATCH"),
        ("HEAD", "/api/v1/session", "DELETE, GET, POST"),
        ("GET", "/api/v1/jobs/x/cancel", "POST"),
        ("DELETE", "/api/v1/openapi.json", "GET, HEAD"),
        ("POST", "/jobs/x", "GET"),
    ):
        answer = service(method, path)
        assert (answer.status_code, answer.headers["allow"]) == (405, allowed), path
    assert service("PUT", TOKENS).json()["error"]["message"] == "this cannot be done here; expected GET, POST"


def test_every_address_tells_all_its_methods(service: Service) -> None:
    seen = 0
    for path, described in service.app.openapi()["paths"].items():
        methods = {method.upper() for method in described} & {"GET", "POST", "PUT", "PATCH", "DELETE"}
        answer = service("TRACE", re.sub(r"{\w+(:path)?}", "1", path))
        assert (answer.status_code, code_of(answer)) == (405, "method_not_allowed"), path
        assert set(answer.headers["allow"].split(", ")) == methods, path
        seen += len(methods) > 1
    assert seen >= 5


@pytest.mark.parametrize(
    ("body", "media", "status", "code"),
    [
        ("{", "application/json", 400, "not_json"),
        ('{"name": NaN}', "application/json", 422, "bad_input"),
        ("\xff", "application/json", 400, "not_json"),
        ("name: x", "application/yaml", 415, "unsupported_media"),
        ("x", "", 415, "unsupported_media"),
        ('{"name": "a", "scopes": ["admin"]}', "application/json; charset=utf-8", 201, ""),
        ('{"name": ""}', "application/json", 422, "bad_input"),
        ('{"name": "a", "scope": "read"}', "application/json", 422, "bad_input"),
        ('{"name": "a\\u0000"}', "application/json", 422, "bad_input"),
        ('{"name": "a\\ud800"}', "application/json", 422, "bad_input"),
        ('{"name": "a", "days": 1e999}', "application/json", 422, "bad_input"),
        ("[" * 100_000, "application/json", 422, "bad_input"),
        ("[" * 30 + "]" * 30, "application/json", 422, "bad_input"),
        (json.dumps(dict.fromkeys(map(str, range(2001)))), "application/json", 422, "bad_input"),
        ('{"days": ' + "9" * 10_000 + "}", "application/json", 422, "bad_input"),
    ],
)
def test_bodies_are_looked_at(service: Service, body: str, media: str, status: int, code: str) -> None:
    headers = {"content-type": media} if media else {}
    answer = service("POST", TOKENS, content=body.encode("latin-1"), headers=headers)
    assert answer.status_code == status
    if code:
        assert code_of(answer) == code
        assert len(answer.content) < 5_000


def test_problems_name_the_place(service: Service) -> None:
    (problem,) = service("POST", TOKENS, json={"name": "a", "scopes": ["read", "write"]}).json()["error"]["problems"]
    assert problem["path"] == ["scopes", 1]
    assert problem["value"] == "write"
    assert problem["expected"] == "'read', 'submit' or 'admin'"
    assert problem["message"] == "scopes: entry 2: got 'write'; expected 'read', 'submit' or 'admin'"


def added(service: Service, raised: BaseException) -> None:
    """Add a route that fails."""

    async def fail() -> None:
        raise raised

    service.app.add_api_route("/fail", fail, methods=["GET"])


@pytest.mark.parametrize(
    ("raised", "status", "code"),
    [
        (InputError("load_torque", "much", "a number", ("requirements", "load_torque")), 422, "bad_input"),
        (InputError("--database", "jobs.sqlite", "a job database that is whole"), 503, "unavailable"),
        (EngineTimeoutError("check: more than 5 s"), 503, "unavailable"),
        (EngineCrashedError("the process ended with code 1"), 503, "unavailable"),
        (EngineFailedError(Failure("KeyError", "secret", ("small.py:7 check",))), 500, "engine_failed"),
        (ServiceError(409, "it has ended", "ended"), 409, "ended"),
        (RuntimeError("the answer is secret"), 500, "internal"),
    ],
)
def test_what_goes_wrong_inside_has_the_same_form(
    service: Service, raised: BaseException, status: int, code: str
) -> None:
    added(service, raised)
    answer = service("GET", "/fail")
    assert (answer.status_code, code_of(answer)) == (status, code)
    assert ("retry-after" in answer.headers) is (status == 503 and not isinstance(raised, InputError))


def test_an_error_tells_its_number_alone_and_the_log_where_it_was(
    service: Service, caplog: pytest.LogCaptureFixture
) -> None:
    added(service, RuntimeError("the answer is secret"))
    with caplog.at_level(logging.INFO, LOG.name):
        answer = service("GET", "/fail?spec=secret")
    (line,) = [json.loads(record.message) for record in caplog.records]
    assert "secret" not in answer.text
    assert "secret" not in json.dumps(line)
    assert line["request_id"] == answer.headers["x-request-id"]
    assert line["error"] == "RuntimeError"
    assert any("test_security" in place for place in line["where"])


def test_an_error_of_what_computes_is_told_by_its_number_and_logged_with_its_place(
    service: Service, caplog: pytest.LogCaptureFixture
) -> None:
    added(service, EngineFailedError(Failure("KeyError", "the answer is secret", ("small.py:7 check",))))
    with caplog.at_level(logging.INFO, LOG.name):
        answer = service("GET", "/fail?spec=secret")
    (line,) = [json.loads(record.message) for record in caplog.records]
    assert "secret" not in answer.text + json.dumps(line)
    assert (line["error"], line["where"]) == ("KeyError", ["small.py:7 check"])
    assert line["request_id"] == answer.json()["error"]["request_id"]


def test_a_database_that_is_away_is_waited_for(service: Service) -> None:
    service.store.engine.dispose()
    service.file.unlink()
    service.file.mkdir()
    answer = service("GET", TOKENS)
    assert (answer.status_code, code_of(answer)) == (503, "unavailable")
    assert int(answer.headers["retry-after"]) >= 1


# ---- names and sites ------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("host", "public", "status"),
    [
        ("127.0.0.1:8350", False, 200),
        ("localhost", False, 200),
        ("[::1]:8350", False, 200),
        ("evil.example", False, 421),
        ("192.0.2.1:8350", False, 421),
        ("localhost.evil.example", False, 421),
        ("", False, 421),
        ("192.0.2.1:8350", True, 200),
        ("[2001:db8::1]", True, 200),
        ("clutch.example", True, 200),
        ("CLUTCH.example:443", True, 200),
        ("evil.example", True, 421),
        ("2130706433", True, 421),
    ],
)
def test_only_own_names_are_answered(tmp_path: Path, host: str, public: bool, status: int) -> None:
    hosts = ("clutch.example",) if public else ()
    with Service(tmp_path, hosts=hosts) as service:
        assert service("GET", "/healthz", headers={"host": host}).status_code == status


FOREIGN = {"origin": "https://evil.example"}


@pytest.mark.parametrize(
    ("headers", "cookie", "status"),
    [
        ({}, False, 201),
        ({"origin": HOME}, True, 201),
        ({"sec-fetch-site": "same-origin"}, True, 201),
        ({"sec-fetch-site": "same-origin", "origin": HOME}, True, 201),
        ({}, True, 403),
        (FOREIGN, False, 403),
        (FOREIGN, True, 403),
        ({"origin": "null"}, False, 403),
        ({"origin": "http://127.0.0.1:9999"}, False, 403),
        ({"origin": "http://[::1"}, False, 403),
        ({"sec-fetch-site": "cross-site"}, False, 403),
        ({"sec-fetch-site": "same-site"}, True, 403),
        ({"sec-fetch-site": "same-origin", **FOREIGN}, True, 403),
    ],
)
def test_pages_of_other_sites_change_nothing(
    service: Service, headers: dict[str, str], cookie: bool, status: int
) -> None:
    own = {"cookie": f"{SESSION_COOKIES[0]}=x"} if cookie else {}
    asked = {"name": "a", "scopes": ["admin"]}
    answer = service("POST", TOKENS, json=asked, headers={**headers, **own})
    assert answer.status_code == status
    assert len(service.accounts.tokens()) == (status == 201)


def test_reading_is_not_hindered_by_where_it_comes_from(service: Service) -> None:
    answer = service("GET", TOKENS, headers=FOREIGN)
    assert answer.status_code == 200
    assert "access-control-allow-origin" not in answer.headers


@pytest.mark.parametrize("path", ["/healthz", "/nothing", "/fail", TOKENS])
def test_every_answer_keeps_browsers_from_doing_more_than_showing_it(service: Service, path: str) -> None:
    added(service, RuntimeError())
    found = service("GET", path).headers
    assert found["x-content-type-options"] == "nosniff"
    assert found["referrer-policy"] == "no-referrer"
    policy = dict(part.strip().split(" ", 1) for part in found["content-security-policy"].split(";"))
    assert policy["default-src"] == "'none'"
    assert policy["script-src"] == policy["style-src"] == policy["connect-src"] == "'self'"
    assert policy["frame-ancestors"] == policy["base-uri"] == "'none'"
    assert "unsafe" not in found["content-security-policy"]


def test_there_is_no_page_that_loads_from_elsewhere(service: Service) -> None:
    assert service("GET", "/docs").status_code == service("GET", "/redoc").status_code == 404
    assert service("GET", "/api/v1/openapi.json").json()["openapi"].startswith("3.")


# ---- sizes and times ------------------------------------------------------------------------------------------------


async def chunks(count: int, size: int) -> Any:
    for _ in range(count):
        yield b"x" * size


@pytest.mark.parametrize("media", ["application/json", "multipart/form-data"])
def test_a_body_is_counted_while_it_arrives(tmp_path: Path, media: str) -> None:
    with Service(tmp_path, body_limit=10_000, upload_limit=10_000) as service:
        read = 0

        async def take(request: Request) -> dict[str, int]:
            nonlocal read
            async for part in request.stream():
                read += len(part)
            return {"read": read}

        service.app.add_api_route("/take", take, methods=["POST"])
        headers = {"content-type": media}
        answer = service("POST", "/take", content=chunks(50, 1_000), headers=headers)
        assert (answer.status_code, code_of(answer)) == (413, "too_large")
        assert answer.headers.get("connection") in ("close", None)
        assert read <= 10_000
        stated = service("POST", "/take", content=b"x" * 10_001, headers=headers)
        assert stated.status_code == 413
        assert service("POST", "/take", content=b'"' + b"x" * 9_998 + b'"', headers=headers).status_code == 200


def test_uploads_may_be_larger_than_other_bodies(tmp_path: Path) -> None:
    with Service(tmp_path, body_limit=1_000, upload_limit=100_000) as service:

        async def take(request: Request) -> int:
            async with request.form() as form:
                return int(getattr(form["file"], "size", 0))

        service.app.add_api_route("/take", take, methods=["POST"])
        assert service("POST", "/take", files={"file": b"x" * 50_000}).json() == 50_000
        assert service("POST", "/take", files={"file": b"x" * 150_000}).status_code == 413


def test_a_body_that_does_not_come_is_not_waited_for(tmp_path: Path) -> None:
    async def slow() -> Any:
        yield b"{"
        await asyncio.sleep(30)

    with Service(tmp_path, body_timeout=0.1) as service:
        answer = service("POST", TOKENS, content=slow(), headers={"content-type": "application/json"})
        assert (answer.status_code, code_of(answer)) == (408, "too_slow")


def test_too_many_requests_are_asked_to_come_again(tmp_path: Path) -> None:
    with Service(tmp_path, requests_at_once=3, queue_wait=0.05) as service:
        go = asyncio.Event()

        async def wait() -> None:
            await go.wait()

        service.app.add_api_route("/wait", wait, methods=["GET"])

        async def many() -> tuple[list[httpx.Response], httpx.Response, httpx.Response]:
            waiting = [asyncio.ensure_future(service.ask("GET", "/wait")) for _ in range(3)]
            await asyncio.sleep(0.05)
            more, probe = await service.ask("GET", "/api/v1/version"), await service.ask("GET", "/healthz")
            go.set()
            return await asyncio.gather(*waiting), more, probe

        served, more, probe = service.runner.run(many())
        assert [answer.status_code for answer in served] == [200] * 3
        assert (more.status_code, code_of(more)) == (503, "unavailable")
        assert int(more.headers["retry-after"]) >= 1
        assert probe.status_code == 200
        assert service("GET", "/api/v1/version").status_code == 200


# ---- JSON -----------------------------------------------------------------------------------------------------------

TREES = st.recursive(
    st.none() | st.booleans() | st.integers() | st.floats(allow_nan=False, allow_infinity=False) | st.text(max_size=5),
    lambda inner: st.lists(inner, max_size=3) | st.dictionaries(st.text(max_size=3), inner, max_size=3),
    max_leaves=8,
)


def levels(tree: Any) -> int:
    if isinstance(tree, dict):
        return 1 + max(map(levels, tree.values()), default=0)
    return 1 + max(map(levels, tree), default=0) if isinstance(tree, list) else 0


def keys(tree: Any) -> int:
    if isinstance(tree, dict):
        return len(tree) + sum(map(keys, tree.values()))
    return sum(map(keys, tree)) if isinstance(tree, list) else 0


def texts(tree: Any) -> list[str]:
    if isinstance(tree, dict):
        return [*tree, *(text for value in tree.values() for text in texts(value))]
    if isinstance(tree, list):
        return [text for value in tree for text in texts(value)]
    return [tree] if isinstance(tree, str) else []


@pytest.mark.parametrize(
    ("body", "faults"),
    [
        ('{"a": NaN}', [(["a"], "a: got 'NaN'; expected a finite number")]),
        (
            '{"a": {"b": [1, -Infinity]}, "c": 1e999}',
            [
                (["a", "b", 1], "a: b: entry 2: got '-Infinity'; expected a finite number"),
                (["c"], "c: got '1e999'; expected a finite number"),
            ],
        ),
        ('{"a": 1, "b": 2, "a": 3}', [(["a"], "a: got several values; expected each key once")]),
        ('[{"a": {"b": 1, "b": 3}}]', [([0, "a", "b"], "entry 1: a: b: got several values; expected each key once")]),
        ("NaN", [([], "body: got 'NaN'; expected a finite number")]),
    ],
)
def test_what_readers_of_json_do_not_agree_upon_is_told_with_its_place(
    service: Service, body: str, faults: list[tuple[list[Any], str]]
) -> None:
    answer = service("POST", "/api/v1/jobs", content=body, headers={"content-type": "application/json"})
    assert (answer.status_code, code_of(answer)) == (422, "bad_input")
    assert [(one["path"], one["message"]) for one in answer.json()["error"]["problems"]] == faults


@pytest.mark.parametrize(
    ("path", "message"),
    [
        (
            "jobs?foo=1",
            "parameter: got 'foo'; expected one of state, kind, family, q, parent, follows, pinned, limit, cursor",
        ),
        ("jobs?state=bar", "state: entry 1: got 'bar'; expected 'open', 'running', "),
        ("jobs?kind=foo", "kind: got 'foo'; expected one of synthesis, compare, "),
        ("jobs?family=xx", "family: got 'xx'; expected one of centrifugal_ball_ramp, centrifugal_lever, "),
        ("version?x=1", "parameter: got 'x'; expected an address without parameters"),
        ("events?job=1", "parameter: got 'job'; expected one of jobs"),
    ],
)
def test_what_a_list_cannot_be_asked_is_refused(service: Service, path: str, message: str) -> None:
    answer = service("GET", f"/api/v1/{path}")
    assert (answer.status_code, code_of(answer)) == (422, "bad_input")
    assert answer.json()["error"]["message"].startswith(message)
    assert service("GET", "/api/v1/jobs?kind=synthesis&family=disc_clutch&state=done").status_code == 200


def test_bodies_of_another_kind_are_told_what_is_taken(service: Service) -> None:
    form = service("POST", "/api/v1/jobs", data={"kind": "synthesis"})
    assert (form.status_code, code_of(form)) == (415, "unsupported_media")
    assert form.json()["error"]["message"].endswith(
        "expected application/json, or multipart/form-data where a file is brought"
    )
    parts = service("POST", "/api/v1/jobs", files={"file": ("a.csv", b"a")})
    assert (parts.status_code, code_of(parts)) == (415, "unsupported_media")
    other = service("PUT", "/api/v1/version")
    assert (other.status_code, other.json()["error"]["message"]) == (405, "this cannot be done here; expected GET")
    nothing = service("POST", "/api/v1/jobs", content="null", headers={"content-type": "application/json"})
    assert nothing.json()["error"]["message"] == "body: got null; expected a JSON object"


LIBRARIES = re.compile(r"(input|string|list) should|value error|validation|pydantic|\.\d+:|'JSON'", re.IGNORECASE)


@pytest.mark.parametrize(
    ("method", "path", "body", "message"),
    [
        ("POST", TOKENS, {"name": "a", "scopes": []}, "scopes: got an empty list; expected a list that is not empty"),
        (
            "POST",
            TOKENS,
            {"name": "a", "scopes": ["read"] * 4},
            "scopes: got a list; expected a list of at most 3 entries",
        ),
        (
            "POST",
            TOKENS,
            {"name": ""},
            "name: got ''; expected a name in one line, which does not begin with a blank, "
            "without marks that turn the direction of writing",
        ),
        (
            "POST",
            TOKENS,
            {"name": "a", "scopes": ["x"]},
            "scopes: entry 1: got 'x'; expected 'read', 'submit' or 'admin'",
        ),
        ("POST", TOKENS, {"name": "a", "scopes": "read"}, "scopes: got 'read'; expected a list"),
        ("POST", TOKENS, {"name": "a", "days": 0}, "days: got 0; expected more than 0"),
        ("POST", TOKENS, {"name": "a", "days": 1e6}, "days: got 1000000.0; expected at most 36500"),
        ("POST", TOKENS, {"name": {}}, "name: got an empty object; expected a text"),
        (
            "POST",
            "/api/v1/jobs",
            {"kind": "synthesis", "request": {}, "title": " "},
            "title: got ' '; expected words in one line, not blanks alone, "
            "without marks that turn the direction of writing",
        ),
        ("GET", "/api/v1/jobs?limit=0", None, "limit: got '0'; expected 1 or more"),
        ("GET", "/api/v1/jobs?q=%00", None, "q: got '\\x00'; expected a text without the character 0"),
    ],
)
def test_what_schemas_refuse_is_told_in_words_for_people(
    service: Service, method: str, path: str, body: Any, message: str
) -> None:
    answer = service(method, path, **({} if body is None else {"json": body}))
    assert (answer.status_code, code_of(answer)) == (422, "bad_input")
    assert answer.json()["error"]["message"] == message


VALUES = (None, True, 0, -1, 1.5, 1e300, "", " ", "x", "x" * 400, "\n", [], [None], ["x"] * 9, {}, {"x": 1})


def test_no_word_of_a_library_is_in_a_refusal(service: Service) -> None:
    described = service.app.openapi()
    seen = 0
    for path, operations in described["paths"].items():
        for method, operation in operations.items():
            content = operation.get("requestBody", {}).get("content", {}).get("application/json", {}).get("schema", {})
            if "$ref" not in content:
                continue
            schema = described["components"]["schemas"][content["$ref"].rsplit("/", 1)[1]]
            if "examples" not in schema:  # of what engines read: schemas of the framework refuse nothing there
                continue
            right = schema["examples"][0]
            for name in schema["properties"]:
                for value in VALUES:
                    where = re.sub(r"{\w+}", "x", path)
                    answer = service(method.upper(), where, json={**right, name: value})
                    if answer.status_code == 422:
                        assert not LIBRARIES.search(answer.text), answer.text
                        seen += 1
    assert seen >= 80


@settings(max_examples=repetitions(50, 5_000), deadline=None, derandomize=True)
@given(tree=TREES, depth=st.integers(1, 4), most=st.integers(0, 6))
def test_json_is_refused_for_its_form_alone(tree: Any, depth: int, most: int) -> None:
    right = levels(tree) <= depth and keys(tree) <= most and not any("\0" in text for text in texts(tree))
    body = json.dumps(tree).encode()
    if right:
        check_json(body, depth, most)
        return
    with pytest.raises(ServiceError) as refused:
        check_json(body, depth, most)
    assert refused.value.status == 422


@pytest.mark.slow
def test_no_body_brings_the_service_down(service: Service) -> None:
    kinds = st.sampled_from(["application/json", "text/plain", "multipart/form-data; boundary=a"])

    @settings(max_examples=repetitions(100, 10_000), deadline=None, derandomize=True)
    @given(body=st.binary(max_size=300), media=kinds)
    def check(body: bytes, media: str) -> None:
        answer = service("POST", TOKENS, content=body, headers={"content-type": media})
        assert answer.status_code < 500
        if answer.status_code >= 400:
            code_of(answer)

    check()


def test_a_log_line_tells_who_and_what_but_neither_content_nor_secret(
    service: Service, caplog: pytest.LogCaptureFixture
) -> None:
    token = service.token("read", "admin")
    with caplog.at_level(logging.INFO, LOG.name):
        service("GET", f"{TOKENS}?token={token}", headers=bearer(token))
        service("POST", TOKENS, headers=bearer(token), json={"name": "private name"})
        service("GET", TOKENS, headers=bearer(token[:-1]))
    told = "\n".join(record.message for record in caplog.records)
    lines = [json.loads(line) for line in told.split("\n")]
    assert token[:-1] not in told
    assert "private" not in told
    assert [line["status"] for line in lines if line["event"] == "request"] == [422, 201, 401]
    assert lines[0]["tenant"] == 1
    assert lines[0]["token"] == 1
    assert lines[0]["path"] == TOKENS


ACTS_IN_LINE = [chr(code) for code in range(0x11000) if re.match(UNSAFE, chr(code)) and not 0xD800 <= code < 0xE000]


def test_no_name_has_a_letter_that_acts_on_what_shows_it() -> None:
    taken = {pattern: TypeAdapter(Annotated[str, Field(pattern=pattern)]) for pattern in (NAME_PATTERN, TITLE, LINE)}
    for pattern, adapter in taken.items():
        assert (
            adapter.validate_python("Kran 7 \u05d0\u0628 \u6f22 \U0001f527") == "Kran 7 \u05d0\u0628 \u6f22 \U0001f527"
        )
        for letter in (*ACTS_IN_LINE, "\t", "\n", "\r"):
            for text in (letter, f"a{letter}", f"{letter}a", f"a{letter}b"):
                assert re.fullmatch(pattern, text) is None, ascii(text)  # as the command line reads it
                with pytest.raises(ValidationError):
                    adapter.validate_python(text)


@pytest.mark.parametrize("letter", ["\u202e", "\u2066", "\u200f", "\u061c", "\u2028", "\u2029", "\x85", "\n", "\x1b"])
@pytest.mark.parametrize(
    ("path", "body", "place"),
    [
        (TOKENS, {"name": "a"}, "name"),
        (TOKENS, {"name": "a", "tenant": "b"}, "tenant"),
        ("/api/v1/jobs", {"kind": "synthesis", "request": {}, "title": "a"}, "title"),
        ("/api/v1/catalogues", {"name": "a", "csv": "x", "note": "b"}, "note"),
    ],
)
def test_names_that_act_on_a_screen_are_refused(
    service: Service, path: str, body: dict[str, Any], place: str, letter: str
) -> None:
    answer = service("POST", path, json={**body, place: f"a{letter}b"})
    assert (answer.status_code, code_of(answer)) == (422, "bad_input")
    (problem,) = answer.json()["error"]["problems"]
    assert (problem["path"], "one line" in problem["expected"]) == ([place], True)
    assert letter not in problem["message"]
