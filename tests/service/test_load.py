"""A server that is busy: nothing is begun in vain, and no tenant keeps another one out.

Engine processes answer when the test lets them, so that what is judged is what happens, not how fast.
"""

from __future__ import annotations

import asyncio
from collections.abc import Awaitable
from pathlib import Path
from typing import Any

import httpx
import pytest
import sqlalchemy as sa

from synth.plugins import family_names
from synth.queue.job_table import Ending, NewJob
from synth.queue.models import Job
from synth.queue.records import Record
from synth.workers.engine_tasks import (
    CHECK_TASK,
    DECLARATION_TASK,
    EXAMPLES_TASK,
    FAMILIES_TASK,
    READ_TASK,
    TABLES_TASK,
)
from tests.service.calling import HOME, Service, bearer, code_of
from tests.service.gated import Gated, settled, until

pytestmark = pytest.mark.slow
API = "/api/v1"
SPEC = {"family": "cone_clutch"}
TOLD = {"ready": False, "problems": [], "remarks": [], "read": {}, "combinations": None}
READ = {
    "request": SPEC,
    "title": "A cone clutch",
    "families": ["cone_clutch"],
    "bulk": False,
    "code": "c",
    "fingerprint": "f",
    "kept": [],
    "steps": 0,
    "rows": 0,
}
FACTS = {
    FAMILIES_TASK: {"families": [{"name": name} for name in family_names()], "code": "c"},
    EXAMPLES_TASK: {"examples": [], "code": "c"},
    TABLES_TASK: {"tables": [], "contents": {"metals": {"name": "metals"}}, "code": "c"},
    DECLARATION_TASK: {"declaration": {"rows": []}, "code": "c"},
    CHECK_TASK: TOLD,
    READ_TASK: READ,
}
PATHS = ("families", "examples", "tables", "tables/metals", "families/cone_clutch")


def answer(task: str, payload: Any) -> Any:
    return FACTS[task]


def figure(service: Service, name: str, **labels: str) -> float:
    return service.context.metrics.registry.get_sample_value(f"clutchsynth_{name}", labels) or 0.0


# ---- what is late ---------------------------------------------------------------------------------------------------


def test_a_question_that_is_late_goes_on_and_answers_the_next_try(tmp_path: Path) -> None:
    engines = Gated(answer)
    with Service(tmp_path, engines, engines=1, small_deadline=0.1) as service:
        first = service("POST", f"{API}/check", json=SPEC)
        assert (first.status_code, code_of(first)) == (503, "unavailable")
        assert int(first.headers["retry-after"]) >= 1
        assert "ask the same again" in first.json()["error"]["message"]
        again = service("POST", f"{API}/check", json=SPEC)
        assert again.status_code == 503
        assert len(engines.begun) == 1  # the same question is not begun twice
        assert figure(service, "questions_now", pool="small", state="late") == 1
        engines.gate.set()
        service.runner.run(until(lambda: not service.context.small.late))
        assert service("POST", f"{API}/check", json=SPEC).json() == TOLD
        assert (len(engines.begun), engines.ended) == (1, 1)
        assert figure(service, "questions_total", pool="small", outcome="late") == 2
        assert figure(service, "questions_total", pool="small", outcome="answered") == 1


def test_a_job_that_is_read_late_is_made_once_by_the_next_try(tmp_path: Path) -> None:
    engines = Gated(answer)
    asked = {"kind": "synthesis", "request": SPEC}
    with Service(tmp_path, engines, engines=1, small_deadline=0.1) as service:
        assert service("POST", f"{API}/jobs", json=asked).status_code == 503
        engines.gate.set()
        service.runner.run(until(lambda: not service.context.small.late))
        assert service("POST", f"{API}/jobs", json=asked).status_code == 202
        assert len(service("GET", f"{API}/jobs").json()["jobs"]) == 1
    assert [task for task, _ in engines.begun] == [READ_TASK]


def test_nobody_has_the_late_answer_to_a_question_of_another_tenant(tmp_path: Path) -> None:
    engines = Gated(answer)
    with Service(tmp_path, engines, engines=2, small_deadline=0.1) as service:
        ours, theirs = (bearer(service.token(tenant=tenant)) for tenant in ("ours", "theirs"))
        for who in (ours, theirs):
            assert service("POST", f"{API}/check", json=SPEC, headers=who).status_code == 503
        assert len(engines.begun) == 2
        engines.gate.set()


def test_a_server_whose_processes_are_all_late_says_so(tmp_path: Path) -> None:
    engines = Gated(answer)
    with Service(tmp_path, engines, engines=1, file_engines=1, small_deadline=0.1) as service:
        service.store.sign("host/1/2/3", "host", "code", {"slots": 1, "busy": 0})
        assert service("GET", "/readyz").status_code == 200
        service("POST", f"{API}/check", json=SPEC)
        assert service("GET", "/readyz").json()["reasons"] == ["every process that answers small questions is late"]
        engines.gate.set()
        service.runner.run(until(lambda: not service.context.small.late))
        assert service("GET", "/readyz").status_code == 200


def test_who_finds_no_process_in_time_is_asked_to_come_again(tmp_path: Path) -> None:
    engines = Gated(answer)

    async def story(service: Service) -> None:
        first = asyncio.ensure_future(service.ask("POST", f"{API}/check", json=SPEC))
        await engines.until_begun(1)
        second = await service.ask("POST", f"{API}/check", json={})
        assert (second.status_code, code_of(second)) == (503, "unavailable")
        assert "others are being answered" in second.json()["error"]["message"]
        engines.gate.set()
        assert (await first).status_code == 200

    with Service(tmp_path, engines, engines=1, queue_wait=0.05, small_deadline=60.0) as service:
        service.runner.run(story(service))
        assert figure(service, "questions_total", pool="small", outcome="busy") == 1


# ---- what depends on the code ---------------------------------------------------------------------------------------


def test_what_depends_on_the_code_is_found_by_the_start_and_waits_for_no_request(tmp_path: Path) -> None:
    engines = Gated(answer)

    async def story(service: Service) -> None:
        async with service.app.router.lifespan_context(service.app):
            await engines.until_begun(1)
            listed = await service.ask("GET", f"{API}/jobs?family=cone_clutch")
            assert (listed.status_code, listed.json()["jobs"]) == (200, [])  # waits for nothing
            early = [await service.ask("GET", f"{API}/{path}") for path in PATHS]
            assert [one.status_code for one in early] == [503] * len(PATHS)
            reasons = (await service.ask("GET", "/readyz")).json()["reasons"]
            assert any(reason.startswith("families, examples and tables are being read: 0 of ") for reason in reasons)
            engines.gate.set()
            await until(lambda: not service.context.facts.missing)
            begun = len(engines.begun)
            for _ in range(3):
                found = [await service.ask("GET", f"{API}/{path}") for path in PATHS]
                assert [one.status_code for one in found] == [200] * len(PATHS)
            assert len(engines.begun) == begun  # served by the server itself
            assert (await service.ask("GET", "/readyz")).status_code == 200
            families = (await service.ask("GET", f"{API}/families/no_such_family")).status_code
            assert families == 404

    with Service(tmp_path, engines, small_deadline=0.1, engines=1) as service:
        service.store.sign("host/1/2/3", "host", "code", {"slots": 1, "busy": 0})
        service.runner.run(story(service))
        assert figure(service, "code_facts", state="kept") == 3 + len(family_names())
    asked = [task for task, _ in engines.begun]
    assert {task: asked.count(task) for task in (FAMILIES_TASK, EXAMPLES_TASK, TABLES_TASK)} == {
        FAMILIES_TASK: 1,
        EXAMPLES_TASK: 1,
        TABLES_TASK: 1,
    }
    assert asked.count(DECLARATION_TASK) == len(family_names())


def test_what_could_not_be_found_at_the_start_is_tried_again(tmp_path: Path) -> None:
    from synth.workers.engine_process import EngineCrashedError

    engines = Gated()
    engines.gate.set()

    def second_time(task: str, payload: Any) -> Any:
        if len(engines.begun) < 3:
            raise EngineCrashedError("the process ended with code 1")
        return answer(task, payload)

    engines.answer = second_time

    async def story(service: Service) -> None:
        async with service.app.router.lifespan_context(service.app):
            await until(lambda: service.context.facts.wanted > 0 and not service.context.facts.missing)

    with Service(tmp_path, engines) as service:
        service.context.facts._pause = 0.0
        service.runner.run(story(service))


# ---- tenants --------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("processes", [1, 2])
def test_a_tenant_that_asks_without_end_keeps_no_other_out(tmp_path: Path, processes: int) -> None:
    """Six connections that loop on checks: the job of another tenant is among the next questions that are begun."""
    engines = Gated(answer)
    engines.gate.set()

    async def story(service: Service) -> None:
        over = asyncio.Event()
        codes: list[int] = []

        async def loop() -> None:
            while not over.is_set():
                codes.append((await service.ask("POST", f"{API}/check", json=SPEC, headers=crowd)).status_code)

        loops = [asyncio.ensure_future(loop()) for _ in range(6)]
        await engines.until_begun(20)
        for _ in range(5):
            before = len(engines.begun)
            made = await service.ask("POST", f"{API}/jobs", json={"kind": "synthesis", "request": SPEC}, headers=other)
            assert made.status_code == 202
            after = [task for task, _ in engines.begun[before:]]
            # begun while the request was recognised and its place found, and no more than the processes since
            assert after.index(READ_TASK) <= 6 + processes
        over.set()
        await asyncio.gather(*loops)
        assert set(codes) == {200}  # a bounded wait, no refusal

    with Service(tmp_path, engines, engines=processes) as service:
        crowd, other = (bearer(service.token(tenant=tenant)) for tenant in ("crowd", "other"))
        service.runner.run(story(service))


def test_a_long_file_of_one_tenant_delays_no_file_of_another(tmp_path: Path) -> None:
    files = Gated(lambda task, payload: {"reading": "", "header": ["a"], "rows": []})
    rows = {"file": ("rows.csv", b"load_torque [N*m]\n100\n")}

    async def story(service: Service) -> None:
        held = [
            asyncio.ensure_future(service.ask("POST", f"{API}/uploads", files=rows, headers=ours)) for _ in range(6)
        ]
        await files.until_begun(1)
        await settled()
        assert len(files.begun) == 1  # of two processes one is kept for others
        theirs = asyncio.ensure_future(service.ask("POST", f"{API}/uploads", files=rows, headers=other))
        await files.until_begun(2)
        files.gate.set()
        assert (await theirs).status_code == 201
        assert {one.status_code for one in await asyncio.gather(*held)} <= {201, 429}

    with Service(tmp_path, Gated(), files=files) as service:
        ours, other = (bearer(service.token(tenant=tenant)) for tenant in ("ours", "theirs"))
        service.runner.run(story(service))


def test_a_long_file_delays_no_check_of_what_is_typed(tmp_path: Path) -> None:
    files, engines = Gated(), Gated(answer)
    engines.gate.set()

    async def story(service: Service) -> None:
        held = [asyncio.ensure_future(service.ask("POST", f"{API}/batches/check", json={"rows": []})) for _ in range(6)]
        await files.until_begun(service.settings.file_engines)
        assert (await service.ask("POST", f"{API}/check", json=SPEC)).status_code == 200
        files.gate.set()
        await asyncio.gather(*held)

    with Service(tmp_path, engines, files=files) as service:
        service.runner.run(story(service))


# ---- bodies ---------------------------------------------------------------------------------------------------------


def test_a_late_file_of_a_batch_is_none_of_a_later_state(tmp_path: Path) -> None:
    files = Gated(lambda task, payload: Record.of("batch.json", "{}"))
    new = NewJob(kind="batch", title="", request={}, fingerprint="f", code="c", task="plan")
    with Service(tmp_path, Gated(), files=files, file_deadline=0.1) as service:
        job = service.store.submit(new)[0]
        with service.store.engine.begin() as connection:
            connection.execute(sa.update(Job).values(rows=1))
        where = f"{API}/jobs/{job}/result"
        assert service("GET", where).status_code == 409  # it has not ended
        service.store.end(job, Ending(state="failed"))
        assert service("GET", where).status_code == 503
        service.store.change(job, title="another")  # whatever changes it
        files.gate.set()
        service.runner.run(until(lambda: files.ended == 1 and not service.context.files.late))
        assert service("GET", where).status_code == 200
        assert len(files.begun) == 2


@pytest.mark.parametrize("path", ["/healthz", "/readyz", "/metrics"])
@pytest.mark.parametrize("media", ["application/json", "multipart/form-data; boundary=a"])
def test_who_watches_brings_no_body(tmp_path: Path, path: str, media: str) -> None:
    async def story(service: Service) -> None:
        asked = Unfinished(service, {}, media, path)
        await asked.task
        assert (asked.status, asked.read) == (401, 0)
        assert (await service.ask("GET", "/healthz")).status_code == 200

    with Service(tmp_path) as service:
        service.token()
        service.runner.run(story(service))


class Unfinished:
    """A request whose body does not go on after its first byte."""

    def __init__(
        self, service: Service, headers: dict[str, str], media: str = "application/json", path: str = f"{API}/check"
    ) -> None:
        self.read = 0
        self.sent: list[dict[str, Any]] = []
        pairs = {"host": "127.0.0.1:8350", "content-type": media, "content-length": "1000", **headers}
        scope = {
            "type": "http",
            "method": "POST",
            "path": path,
            "query_string": b"",
            "client": ("192.0.2.1", 50_000),
            "headers": [(key.lower().encode(), value.encode()) for key, value in pairs.items()],
        }
        self.task = asyncio.ensure_future(self._run(service.app(scope, self._receive, self._send)))

    async def _run(self, answered: Awaitable[None]) -> None:
        await answered

    async def _receive(self) -> dict[str, Any]:
        self.read += 1
        if self.read == 1:
            return {"type": "http.request", "body": b"{", "more_body": True}
        await asyncio.Event().wait()
        raise AssertionError

    async def _send(self, message: Any) -> None:
        self.sent.append(message)

    @property
    def status(self) -> int | None:
        return self.sent[0]["status"] if self.sent else None


MEDIA = ("application/json", "multipart/form-data; boundary=a")


@pytest.mark.parametrize("headers", [{}, bearer("cs_wrong"), {"cookie": "clutchsynth_session=x", "origin": HOME}])
@pytest.mark.parametrize("media", MEDIA)
def test_no_byte_of_a_body_is_read_before_its_sender_is_known(
    tmp_path: Path, headers: dict[str, str], media: str
) -> None:
    async def story(service: Service) -> None:
        crowd = [Unfinished(service, headers, media) for _ in range(230)]
        await asyncio.gather(*(one.task for one in crowd))
        assert {one.status for one in crowd} <= {401, 429}  # who shows too many wrong tokens has to wait
        assert sum(one.read for one in crowd) == 0
        assert all((b"connection", b"close") in one.sent[0]["headers"] for one in crowd)
        assert (await service.ask("GET", f"{API}/jobs", headers=known)).status_code == 200
        assert service.context.requests.held == 0

    with Service(tmp_path) as service:
        known = bearer(service.token())
        service.runner.run(story(service))


@pytest.mark.parametrize("media", MEDIA)
def test_bodies_of_one_tenant_that_do_not_arrive_keep_no_other_out(tmp_path: Path, media: str) -> None:
    async def story(service: Service) -> None:
        crowd = [Unfinished(service, who, media) for who in ours for _ in range(20)]
        await settled()
        assert service.context.requests.held == 10  # half of all
        assert (await service.ask("GET", f"{API}/jobs", headers=other)).status_code == 200
        for one in crowd:
            one.task.cancel()
        await asyncio.gather(*(one.task for one in crowd), return_exceptions=True)
        assert (service.context.requests.held, service.context.uploads.held) == (0, 0)

    with Service(tmp_path, requests_at_once=20, queue_wait=60.0) as service:
        ours = [bearer(service.token(tenant="ours")) for _ in range(3)]
        other = bearer(service.token(tenant="theirs"))
        service.runner.run(story(service))


@pytest.mark.parametrize("media", MEDIA)
def test_a_body_that_arrives_too_slowly_is_given_up(tmp_path: Path, media: str) -> None:
    """Nothing arrives after the first byte: what is due by then is told, long before the time of a whole body."""

    async def trickle() -> Any:
        yield b"{" if media == MEDIA[0] else b"--a\r\n"
        await asyncio.Event().wait()

    with Service(tmp_path, body_grace=0.05, body_timeout=3_600.0) as service:
        answered: httpx.Response = service("POST", f"{API}/uploads", content=trickle(), headers={"content-type": media})
        assert (answered.status_code, code_of(answered)) == (408, "too_slow")
        assert "10000 bytes per s" in answered.json()["error"]["message"]


def test_files_of_a_tenant_that_arrive_at_a_time_are_its_share(tmp_path: Path) -> None:
    async def story(service: Service) -> None:
        crowd = [Unfinished(service, ours, MEDIA[1]) for _ in range(30)]
        await settled()
        assert service.context.uploads.held == 2  # a quarter, of one token
        for one in crowd:
            one.task.cancel()
        await asyncio.gather(*(one.task for one in crowd), return_exceptions=True)

    with Service(tmp_path, queue_wait=60.0) as service:
        ours = bearer(service.token(tenant="ours"))
        service.runner.run(story(service))


def test_who_has_as_many_requests_as_one_may_is_told_so(tmp_path: Path) -> None:
    go = asyncio.Event()

    async def wait() -> None:
        await go.wait()

    async def story(service: Service) -> None:
        held = [asyncio.ensure_future(service.ask("GET", "/wait", headers=ours)) for _ in range(2)]
        await until(lambda: service.context.requests.held == 2)
        more = await service.ask("GET", "/wait", headers=ours)
        assert (more.status_code, code_of(more)) == (429, "too_many")
        assert int(more.headers["retry-after"]) >= 1
        assert (await service.ask("GET", f"{API}/jobs", headers=other)).status_code == 200
        go.set()
        assert {one.status_code for one in await asyncio.gather(*held)} == {200}

    with Service(tmp_path, requests_at_once=8, queue_wait=0.05) as service:
        service.app.add_api_route("/wait", wait, methods=["GET"])
        ours, other = (bearer(service.token(tenant=tenant)) for tenant in ("ours", "theirs"))
        service.runner.run(story(service))
        assert figure(service, "http_requests_refused_total", reason="own") == 1
