"""Event streams: what is told, in which order, to whom, and when they end."""

from __future__ import annotations

import asyncio
import json
import threading
import time
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import httpx
import pytest
import sqlalchemy as sa

from synth.batches.store import Store
from synth.batches.views import Standing
from synth.queue.job_table import Happening
from synth.queue.models import Token, moment
from synth.service.event_hub import EventHub
from synth.service.security import SESSION_COOKIES
from synth.service.settings import ServiceSettings
from synth.workers.engine_process import Engines
from tests.service.calling import Service, bearer, code_of
from tests.service.working import API, FRONT, LIVE, LONG, QUICK, Client, listened, working
from tests.waiting import PATIENCE

pytestmark = pytest.mark.slow


def events_of(text: str) -> list[dict[str, Any]]:
    """Return the events of a stream: kind, id and data."""
    found = []
    for block in text.split("\n\n"):
        lines = [line.partition(": ")[::2] for line in block.splitlines() if not line.startswith(":")]
        fields = dict(lines)
        if "event" in fields:
            found.append({**json.loads(fields["data"]), "kind": fields["event"], "id": fields.get("id")})
    return found


def test_a_stream_tells_how_a_job_goes_and_ends_with_it(database: str, engines: Engines, tmp_path: Path) -> None:
    with working(tmp_path, engines, database) as service:
        client = Client(service)
        job = client.submit("synthesis", FRONT)
        answer = client.get(f"jobs/{job}/events")
        assert answer.status_code == 200
        assert answer.headers["content-type"].startswith("text/event-stream")
        assert answer.headers["x-accel-buffering"] == "no"
        assert answer.text.startswith("retry: 2000\n\n")
        events = events_of(answer.text)
        kinds = [event["kind"] for event in events]
        assert (kinds[0], kinds[-1]) == ("snapshot", "end")
        assert kinds.count("end") == 1
        assert "started" in kinds
        assert events[0]["state"] in LIVE  # a worker may have begun it
        assert (events[-1]["state"], events[-1]["outcome"]) == ("done", "optimal")
        assert [event["text"] for event in events if event["kind"] == "started"] == [""]  # not by which process
        numbers = [int(event["id"]) for event in events if event["id"]]
        assert numbers == sorted(set(numbers))

        again = events_of(client.get(f"jobs/{job}/events").text)
        assert [event["kind"] for event in again] == ["snapshot", "end"]
        later = events_of(client.get(f"jobs/{job}/events", headers={"Last-Event-ID": str(numbers[0])}).text)
        assert [event["id"] for event in later if event["id"]] == [str(number) for number in numbers[1:]]
        assert [event["kind"] for event in later][-1] == "end"

        others = [client.submit("synthesis", QUICK) for _ in range(2)]
        both = events_of(client.get(f"events?jobs={','.join([*others, job])}").text)
        assert {event["job"] for event in both if event["kind"] == "end"} == {*others, job}


def test_a_stream_of_a_job_that_is_removed_ends(client: Client, works: Service) -> None:
    job = client.submit("synthesis", LONG)
    thread = threading.Timer(0.3, works.store.delete, [job])
    thread.start()
    last = events_of(client.get(f"jobs/{job}/events").text)[-1]
    thread.join()
    assert (last["kind"], last["state"], last["outcome"]) == ("end", "deleted", None)


@pytest.mark.parametrize("asked", ["jobs=", "jobs=,", "jobs=" + ",".join(f"a{k}" for k in range(51)), ""])
def test_jobs_must_be_named(client: Client, asked: str) -> None:
    answer = client.get(f"events?{asked}")
    assert (answer.status_code, code_of(answer)) == (422, "bad_input")


def test_what_is_not_there_has_no_stream(client: Client, front: str) -> None:
    for path in ("jobs/nothing/events", "events?jobs=nothing", f"events?jobs={front},nothing"):
        answer = client.get(path)
        assert (answer.status_code, code_of(answer)) == (404, "not_found")
    assert client.get(f"jobs/{front}/events", headers={"Last-Event-ID": "-1"}).status_code == 422


# ---- over a wire ----------------------------------------------------------------------------------------------------


@pytest.fixture
def wire(engines: Engines, tmp_path: Path) -> Iterator[tuple[Service, str]]:
    numbers = {"streams": 2, "stream_comment": 0.2}
    with working(tmp_path, engines, called=False, **numbers) as service, listened(service) as address:
        yield service, address


@pytest.mark.parametrize("ending", ["revoked", "expired", "signed out", "another token"])
def test_a_stream_ends_with_what_has_let_it_in(wire: tuple[Service, str], ending: str) -> None:
    service, address = wire
    job = Client(service).submit("synthesis", LONG)
    place, headers, cookies = f"{API}/jobs/{job}/events", {}, {}
    if ending != "another token":  # without one anybody at this machine may listen, until there is one
        token = service.token("read", "submit")
        headers, number = bearer(token), service.accounts.tokens()[-1].id
    if ending == "signed out":
        cookie = service.accounts.sign_in(number, 1.0)
        headers, cookies = {}, {SESSION_COOKIES[0]: cookie}
    with httpx.Client(base_url=address, headers=headers, cookies=cookies, timeout=PATIENCE) as http:
        with http.stream("GET", place) as stream:
            lines = stream.iter_lines()
            assert any(line.startswith("event: snapshot") for line in lines)
            if ending == "revoked":
                service.accounts.revoke(number)
            elif ending == "expired":
                with service.store.engine.begin() as connection:
                    connection.execute(sa.update(Token).values(expires=moment() - 1.0))
            elif ending == "signed out":
                service.accounts.sign_out(cookie)
            else:
                service.token("read")
            assert "event: end" not in list(lines)  # it ends, and not as the job does
        assert http.get(place).status_code == 401
        assert service.store.job(job).state in ("open", "running")  # type: ignore[union-attr]


def test_streams_live_are_few_and_end_with_the_server(wire: tuple[Service, str]) -> None:
    service, address = wire
    token = service.token("read", "submit")
    other = service.token("read")
    with httpx.Client(base_url=address, headers=bearer(token), timeout=PATIENCE) as http:
        job = http.post(f"{API}/jobs", json={"kind": "synthesis", "request": LONG}).json()["id"]
        place = f"{API}/jobs/{job}/events"
        with http.stream("GET", place) as first, http.stream("GET", place) as second:
            lines = first.iter_lines()
            assert any(line == ":" or line == ": " for line in lines)  # a sign of life
            full = http.get(place)
            assert full.status_code == 429
            assert int(full.headers["retry-after"]) >= 1
            with http.stream("GET", place, headers=bearer(other)) as third:
                assert third.status_code == 200  # another token has its own
                text = http.get("/metrics").text
                assert "clutchsynth_event_streams 3.0" in text
                service.context.ending.set()  # in the thread of the server: its reader looks each fifth of a second
                for stream in (second, third):
                    stream.read()
                list(lines)


def test_a_client_that_goes_leaves_room(wire: tuple[Service, str]) -> None:
    _, address = wire
    with httpx.Client(base_url=address, timeout=PATIENCE) as http:
        job = http.post(f"{API}/jobs", json={"kind": "synthesis", "request": LONG}).json()["id"]
        for _ in range(5):
            with http.stream("GET", f"{API}/jobs/{job}/events") as stream:
                assert stream.status_code == 200
                next(stream.iter_lines())
            time.sleep(0.1)
        http.delete(f"{API}/jobs/{job}")


# ---- the hub --------------------------------------------------------------------------------------------------------


class LateStore:
    """A store whose events are seen in the order in which tests let them."""

    def __init__(self) -> None:
        self.seen: list[Happening] = []

    def last_event(self) -> int:
        return max((one.id for one in self.seen), default=0)

    def happenings(self, after: int, *, job: str | None = None, most: int = 1000) -> list[Happening]:
        return sorted((one for one in self.seen if one.id > after), key=lambda one: one.id)[:most]


def happening(number: int) -> Happening:
    return Happening(number, "j", 0.0, "remark", str(number), None)


def test_events_that_are_seen_late_are_told_once(monkeypatch: pytest.MonkeyPatch) -> None:
    store: Any = LateStore()
    now = [0.0]
    monkeypatch.setattr("synth.service.event_hub.time.monotonic", lambda: now[0])
    settings = replace(ServiceSettings(), stream_margin=5.0, stream_queue=10_000)
    hub = EventHub(settings, store)
    listener = hub.listen(["j"], "me")
    assert listener is not None
    told: list[int | None] = []

    def take() -> list[int | None]:
        hub.tell([], *hub.read([]))
        while listener._waiting:
            told.append(listener._waiting.popleft().id)
        return told

    take()
    store.seen = [happening(5), happening(7)]
    assert take() == [5, 7]
    store.seen.append(happening(6))  # its transaction has ended after that of 7
    assert take() == [5, 7, 6]
    now[0] = 4.0
    store.seen += [happening(3), happening(8)]
    assert take() == [5, 7, 6, 3, 8]
    now[0] = 20.0
    assert take() == [5, 7, 6, 3, 8]
    store.seen += [happening(number) for number in range(9, 2500)]
    assert len(take()) == 5 + 2491
    assert sorted(set(told), key=lambda number: number or 0) == [3, *range(5, 2500)]


def test_an_end_from_before_a_job_went_on_is_none() -> None:
    store: Any = LateStore()
    hub = EventHub(ServiceSettings(), store)
    listener = hub.listen(["j"], "me")
    assert listener is not None
    cancelled = Happening(1, "j", 0.0, "cancelled", "", {"state": "cancelled"})
    hub.tell(["j"], [cancelled], {"j": Standing("open", None, 1.0, None)})
    hub.tell([], [replace(cancelled, id=2)], {})  # it was not looked how the job stands
    hub.tell(["j"], [replace(cancelled, id=3)], {"j": Standing("cancelled", None, 2.0, None)})
    hub.tell(["j"], [], {})
    told = [(one.kind, one.id, one.data.get("state")) for one in listener._waiting]
    assert told == [
        ("remark", 1, None),
        ("remark", 2, None),
        ("end", 3, "cancelled"),
        ("end", None, "cancelled"),
        ("end", None, "deleted"),
    ]


def test_a_stream_of_a_job_that_goes_on_does_not_end_with_its_first_end(client: Client, works: Service) -> None:
    job = client.submit("synthesis", LONG)
    client.post(f"jobs/{job}/cancel")
    client.post(f"jobs/{job}/resume")
    thread = threading.Timer(0.6, works.store.cancel, [job])
    thread.start()
    begun = time.monotonic()
    events = events_of(client.get(f"jobs/{job}/events", headers={"Last-Event-ID": "0"}).text)
    thread.join()
    assert time.monotonic() - begun > 0.5
    assert [event["kind"] for event in events].count("end") == 1
    assert events[-1]["state"] == "cancelled"
    assert [event["text"] for event in events if event["kind"] == "remark"] == ["cancelled"]
    again = events_of(client.get(f"jobs/{job}/events", headers={"Last-Event-ID": "0"}).text)
    assert [event["kind"] for event in again].count("end") == 1


def test_a_slow_listener_is_told_to_read_anew() -> None:
    store: Any = LateStore()
    hub = EventHub(replace(ServiceSettings(), stream_queue=3), store)
    listener = hub.listen(["j"], "me")
    assert listener is not None
    hub.tell([], [happening(number) for number in range(1, 5)], {})
    hub.tell([], [happening(9)], {})

    async def kinds() -> list[str]:
        found = [await listener.next(0.01), await listener.next(0.01), await listener.next(0.01)]
        return [told.kind if told else "nothing" for told in found]

    assert asyncio.run(kinds()) == ["resync", "remark", "nothing"]


def test_streams_are_counted_by_who_has_them(tmp_path: Path) -> None:
    store: Any = LateStore()
    hub = EventHub(replace(ServiceSettings(), streams=1), store)
    first = hub.listen(["a"], "me")
    assert first is not None
    assert hub.listen(["b"], "me") is None
    assert hub.listen(["b"], "you") is not None
    hub.leave(first)
    hub.leave(first)
    assert hub.listened() == {"b"}
    assert hub.listen(["c"], "me") is not None


def test_the_store_tells_how_jobs_stand(database: str) -> None:
    from synth.batches.views import standings

    with Store(database) as store:
        assert standings(store, ["nothing"]) == {}
