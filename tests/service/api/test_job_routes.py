"""Jobs over HTTP: asked for, listed, changed, cancelled, gone on with, removed."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest
import sqlalchemy as sa
import yaml

from synth.queue.models import Job, Tenant
from synth.workers.engine_process import Engines
from tests.kinds.jobs import DISC
from tests.service.answers import holds
from tests.service.calling import Service, code_of
from tests.service.working import BATCH, DUTY, FAMILY, FRONT, LONG, QUICK, Client, working

pytestmark = pytest.mark.slow
SHARED = {
    "load_torque": "100 N*m",
    "driver_speed": "1450 1/min",
    "driven_inertia": "0.1 kg*m2",
    "engagements_per_hour": "50 1/h",
}


def test_a_question_becomes_a_job_and_a_front(database: str, engines: Engines, tmp_path: Path) -> None:
    with working(tmp_path, engines, database) as service:
        client = Client(service)
        body = {"kind": "synthesis", "request": FRONT, "title": "A lift", "parent": None}
        answer = client.post("jobs", body, headers={"Idempotency-Key": "one"})
        assert answer.status_code == 202
        job = answer.json()
        assert answer.headers["location"] == job["links"]["self"] == f"/api/v1/jobs/{job['id']}"
        assert (job["title"], job["families"], job["priority"]) == ("A lift", [FAMILY], 1)
        done = client.ended(job["id"])
        assert (done["state"], done["outcome"], done["summary"]["designs"]) == ("done", "optimal", 3)
        again = client.post("jobs", body, headers={"Idempotency-Key": "one"})
        assert (again.status_code, again.json()["id"]) == (200, job["id"])
        other = client.post("jobs", {**body, "request": QUICK}, headers={"Idempotency-Key": "one"})
        assert (other.status_code, code_of(other)) == (409, "key_taken")
        found = client.get(f"jobs/{job['id']}/result")
        assert found.status_code == 200
        assert len(found.json()["designs"]) == 3
        assert client.get(f"jobs?family={FAMILY}&state=done").json()["jobs"][0]["id"] == job["id"]
        assert client.get("jobs?family=disc_clutch").json()["jobs"] == []
        table = client.post("batches", BATCH, headers={"Idempotency-Key": "two"}).json()["id"]
        answered = client.ended(table)
        assert holds("Summary", answered["summary"]) >= {"rows", "status"}
        assert holds("Progress", answered["progress"]) >= {"bad", "done", "rows", "status"}
        assert answered["summary"]["status"] == {"bad_input": 1, "optimal": 2}
        for key in ({"Idempotency-Key": "two"}, {}):
            same = client.post("batches", BATCH, headers=key)
            assert (same.status_code, same.json()["id"]) == (200, table)
        assert client.get(f"jobs?family={FAMILY}&kind=batch").json()["jobs"][0]["id"] == table
        assert [row["status"] for row in client.get(f"jobs/{table}/rows").json()["rows"]] == [
            "optimal",
            "optimal",
            "bad_input",
        ]
        assert client.get(f"jobs/{table}/rows?status=bad_input&limit=1").json()["rows"][0]["line"] == 4
        few = client.submit("size_range", {"of": table})
        sizes = client.ended(few)
        assert sizes["state"] == "done"
        assert holds("Summary", sizes["summary"]) >= {"objective", "total_excess", "unit", "variants"}
        assert holds("SizeRange", client.get(f"jobs/{few}/result").json())
        assert client("DELETE", f"jobs/{table}").status_code == 204


def test_every_kind_can_be_asked(client: Client, front: str) -> None:
    asked: dict[str, dict[str, Any]] = {
        "whatif": {**QUICK, "vary": {"load_torque": ["500 N*m", "600 N*m"]}, "breaks": False},
        "explain": {**DISC, "parts": {"friction_pair": ["woven_dry"]}, "limits": {"actuation_force": "<= 100 N"}},
        "prices": {"of": front, "design": 1},
        "near_equals": {"of": front, "count": 1, "time_limit": 5},
        "rate": {"of": front, "design": [1], "robust": {"friction": "catalogue range"}},
        "verify": {"of": front, "time_limit": 20},
        "report": {"of": front, "length": "summary", "full": 0},
        "compare": {**QUICK, "family": [FAMILY, "disc_clutch"], "requirements": SHARED, "fix": {}},
    }
    jobs = {kind: client.submit(kind, request) for kind, request in asked.items()}
    for kind, job in jobs.items():
        told = client.ended(job)
        assert told["state"] in ("done", "stopped"), (kind, told)
        assert client.get(f"jobs/{job}/result").status_code == 200, kind
        files = client.get(f"jobs/{job}/files").json()["files"]
        assert files, kind
        for file in files:
            if file["size"] is not None:
                assert len(client.get(file["href"]).content) == file["size"], file
    several = f"jobs/{jobs['compare']}"
    names = {file["name"] for file in client.get(f"{several}/files").json()["files"]}
    assert {f"{FAMILY}/front.json", "disc_clutch/front.json", "report.html"} <= names
    inner = client.get(f"{several}/files/disc_clutch/front.json")
    assert inner.headers["content-disposition"] == 'attachment; filename="front.json"'
    assert client.get(f"{several}/designs?family=disc_clutch").json()["total"] >= 1
    assert client.get(f"{several}/designs").status_code == 422  # of which family?


@pytest.mark.parametrize(
    ("body", "path"),
    [
        ({"kind": "magic", "request": QUICK}, ["kind"]),
        ({"kind": "synthesis"}, ["request"]),
        ({"kind": "synthesis", "request": []}, ["request"]),
        ({"kind": "synthesis", "request": {**QUICK, "requirements": {**DUTY, "load_torque": "much"}}}, None),
        ({"kind": "synthesis", "request": {**QUICK, "points": 501}}, ["points"]),
        ({"kind": "synthesis", "request": {**QUICK, "catalogs": {"friction_materials": "/etc/passwd"}}}, None),
        ({"kind": "synthesis", "request": {**QUICK, "catalogs": "/etc"}}, ["catalogs"]),
        ({"kind": "synthesis", "request": {"of": "nothing"}}, ["of"]),
        ({"kind": "synthesis", "request": QUICK, "parent": "nothing"}, ["parent"]),
        ({"kind": "synthesis", "request": QUICK, "priority": 2}, ["priority"]),
        ({"kind": "synthesis", "request": QUICK, "seconds_limit": "5"}, ["seconds_limit"]),
        ({"kind": "synthesis", "request": QUICK, "folder": "/tmp"}, ["folder"]),
        ({"kind": "synthesis", "request": QUICK, "title": " "}, ["title"]),
        ({"kind": "synthesis", "request": QUICK, "title": "\u00a0"}, ["title"]),
        ({"kind": "synthesis", "request": {**QUICK, "workers": 64}}, ["workers"]),
        ({"kind": "compare", "request": {**QUICK, "family": "any", "workers": 64}}, ["workers"]),
        ({"kind": "batch", "request": {**BATCH, "workers": 64}}, ["workers"]),
        ({"kind": "whatif", "request": {**QUICK, "vary": {"load_torque": "400:700:1 N*m"}}}, ["vary"]),
        ({"kind": "batch", "request": {"family": FAMILY, "upload": "nothing"}}, ["upload"]),
        ({"kind": "batch", "request": {"family": FAMILY, "upload": "/etc/passwd"}}, ["upload"]),
        ({"kind": "report", "request": {"of": "nothing", "about": {"logo": "/etc/passwd"}}}, None),
    ],
)
def test_what_cannot_be_asked_is_refused_with_its_place(
    client: Client, body: dict[str, Any], path: list[str] | None
) -> None:
    answer = client.post("jobs", body)
    assert (answer.status_code, code_of(answer)) == (422, "bad_input")
    (problem,) = answer.json()["error"]["problems"]
    assert path is None or problem["path"] == path


def test_more_threads_are_refused_with_the_reason_and_one_is_taken(client: Client) -> None:
    for path in ("check", "batches", "batches/check"):
        asked = QUICK if path == "check" else {**BATCH, "seed": 64}  # a batch of its own
        answer = client.post(path, {**asked, "workers": 64}).json()
        (problem,) = (answer if path == "check" else answer["error"])["problems"]
        assert problem["path"] == ["workers"], path
        assert "a job is searched by one thread" in problem["expected"]
        taken = client.post(path, {**asked, "workers": 1})
        assert taken.status_code < 300, taken.text


def test_a_title_may_have_blanks_and_is_more_than_that(client: Client, front: str) -> None:
    assert client("PATCH", f"jobs/{front}", json={"title": " "}).status_code == 422
    assert client("PATCH", f"jobs/{front}", json={"title": " a\u00a0lift "}).status_code == 200


def test_a_tenant_has_what_it_may_have(works: Service) -> None:
    limits = {"open_jobs": 2, "running": 1, "seconds_limit": 60.0, "rows": 2}
    with works.store.engine.begin() as connection:
        connection.execute(sa.insert(Tenant).values(name="small", limits=limits, created=0.0))
    token = works.token("read", "submit", "admin", tenant="small")
    client = Client(works, token)
    assert Client(works).get("jobs").status_code == 401  # now that there is a token

    def refused(body: dict[str, Any]) -> list[Any]:
        answer = client.post("jobs", body)
        assert answer.status_code == 422
        (problem,) = answer.json()["error"]["problems"]
        return list(problem["path"])

    try:
        assert refused({"kind": "synthesis", "request": QUICK, "seconds_limit": 61}) == ["seconds_limit"]
        assert refused({"kind": "synthesis", "request": {**QUICK, "time_limit": 61}}) == ["time_limit"]
        assert refused({"kind": "batch", "request": BATCH}) == ["rows"]
        first = client.submit("synthesis", LONG)
        assert client.get(f"jobs/{first}").json()["seconds_limit"] == 60
        assert client.get(f"jobs/{first}/request").json()["time_limit"] == 60
        second = client.submit("synthesis", LONG, seconds_limit=5, priority=0)
        told = client.get(f"jobs/{second}").json()
        assert (told["seconds_limit"], told["priority"]) == (5, 0)
        assert client.get(f"jobs/{second}/request").json()["time_limit"] == 5
        full = client.post("jobs", {"kind": "synthesis", "request": QUICK})
        assert (full.status_code, code_of(full)) == (429, "queue_full")
        assert int(full.headers["retry-after"]) >= 1
        assert client.post(f"jobs/{second}/cancel").status_code == 202
        table = client.submit("batch", {**BATCH, "rows": BATCH["rows"][:2]}, priority=1)
        assert client.get(f"jobs/{table}").json()["priority"] == 0  # nobody goes before others by asking for it
        assert client.get(f"jobs/{table}/request").json()["time_limit"] == 60
        again = client.post(f"jobs/{second}/resume")
        assert (again.status_code, code_of(again)) == (429, "queue_full")
        for job in (first, table):
            client.post(f"jobs/{job}/cancel")
    finally:
        with works.store.engine.begin() as connection:
            connection.execute(sa.delete(Tenant).where(Tenant.name == "small"))


def test_lists_are_paged_and_chosen_from(works: Service, client: Client, front: str) -> None:
    mine = [client.submit("synthesis", QUICK, title=f"Seite {k} 100%", parent=front) for k in range(5)]
    found: list[str] = []
    path = f"jobs?limit=2&parent={front}"
    page = client.get(path).json()
    while True:
        found += [job["id"] for job in page["jobs"]]
        if page["next"] is None:
            break
        page = client.get(f"{path}&cursor={page['next']}").json()
    assert found == mine[::-1]
    cursor = client.get(path).json()["next"]
    assert client.get(f"jobs?limit=2&cursor={cursor}").status_code == 422  # of another list
    assert client.get("jobs?cursor=nonsense").status_code == 422
    assert client.get("jobs?limit=201").status_code == 422
    assert client.get("jobs?state=asleep").status_code == 422
    assert client.get("jobs?q=seite%203%20100%25").json()["jobs"][0]["id"] == mine[3]
    assert client.get("jobs?q=%25").json()["jobs"]
    assert {job["id"] for job in client.get("jobs?limit=200&follows=true").json()["jobs"]} >= set(mine)
    apart = client.get("jobs?limit=200&follows=false").json()["jobs"]
    assert front in {job["id"] for job in apart}
    assert all(job["parent"] is None for job in apart)
    assert client.get(f"jobs?follows=false&parent={front}").json()["jobs"] == []
    assert client.get("jobs?follows=perhaps").status_code == 422
    assert client.get("jobs?q=%00").status_code == 422
    assert client.get("jobs?kind=verify&pinned=true").json() == {"jobs": [], "next": None}
    for job in mine:
        client.ended(job)


def test_the_state_is_sent_once(client: Client, front: str) -> None:
    first = client.get(f"jobs/{front}")
    again = client.get(f"jobs/{front}", headers={"If-None-Match": first.headers["etag"]})
    assert (again.status_code, again.content) == (304, b"")
    changed = client("PATCH", f"jobs/{front}", json={"title": "Another", "pinned": True})
    assert (changed.status_code, changed.json()["title"], changed.json()["pinned"]) == (200, "Another", True)
    now = client.get(f"jobs/{front}", headers={"If-None-Match": first.headers["etag"]})
    assert now.status_code == 200
    assert client("PATCH", f"jobs/{front}", json={"state": "open"}).status_code == 422
    assert client("PATCH", f"jobs/{front}", json={"title": "a\nb"}).status_code == 422


def test_the_request_is_there_as_json_and_yaml(client: Client, front: str) -> None:
    as_json = client.get(f"jobs/{front}/request")
    as_yaml = client.get(f"jobs/{front}/request", headers={"Accept": "application/yaml"})
    assert as_yaml.headers["content-type"].startswith("application/yaml")
    assert yaml.safe_load(as_yaml.text) == as_json.json()
    assert as_json.json()["requirements"] == DUTY


def test_a_job_is_cancelled_goes_on_and_is_removed(client: Client) -> None:
    job = client.submit("synthesis", LONG)
    assert client.get(f"jobs/{job}/result").status_code == 409
    assert client.get(f"jobs/{job}/designs").status_code == 409
    assert client.get(f"jobs/{job}/files/designs.csv").status_code == 409
    assert client.get(f"jobs/{job}/files").json() == {"files": []}
    assert client.post(f"jobs/{job}/resume").status_code == 409
    assert client.post(f"jobs/{job}/cancel").json()["state"] == "cancelled"
    ended = client.post(f"jobs/{job}/cancel")
    assert (ended.status_code, code_of(ended)) == (409, "ended")
    assert client.get(f"jobs/{job}/result").status_code == 404
    assert client.get(f"jobs/{job}/designs").status_code == 404
    again = client.post(f"jobs/{job}/resume")
    assert (again.status_code, again.json()["state"]) == (202, "open")
    client.until(job, lambda told: told["state"] == "running")
    assert client("DELETE", f"jobs/{job}").status_code == 204
    assert client.get(f"jobs/{job}").status_code == 404
    assert client("DELETE", f"jobs/{job}").status_code == 404


def test_only_what_has_not_been_done_can_go_on(works: Service, client: Client, front: str, table: str) -> None:
    done = client.post(f"jobs/{front}/resume")
    assert (done.status_code, code_of(done)) == (409, "ended")
    kept = works.store.job(table)
    assert kept is not None
    hashes = {**kept.content["hashes"], "code": "another", "tables": "others"}
    content = {**kept.content, "hashes": hashes}
    with works.store.engine.begin() as connection:
        connection.execute(sa.update(Job).where(Job.id == table).values(content=content, state="cancelled"))
    changed = client.post(f"jobs/{table}/resume")
    assert (changed.status_code, code_of(changed)) == (409, "changed")
    assert "code and tables" in changed.json()["error"]["message"]
    for code, status in ((None, 409), (kept.code, 202)):
        with works.store.engine.begin() as connection:
            connection.execute(sa.update(Job).where(Job.id == table).values(content=kept.content, code=code))
        answer = client.post(f"jobs/{table}/resume")
        assert answer.status_code == status, answer.text
    assert client.ended(table)["state"] == "done"


WRONG = {**QUICK, "requirements": {**DUTY, "load_torque": "much", "jerk_limit": "9 kg"}, "limits": {"mas": "< 5 kg"}}


def faults_of(client: Client, kind: str, request: dict[str, Any]) -> list[tuple[Any, ...]]:
    answer = client.post("jobs", {"kind": kind, "request": request})
    assert (answer.status_code, code_of(answer)) == (422, "bad_input")
    return [tuple(problem["path"]) for problem in answer.json()["error"]["problems"]]


@pytest.mark.parametrize(
    ("kind", "more", "paths"),
    [
        ("synthesis", {"colour": "red"}, [("colour",)]),
        ("explain", {"physics": 3}, [("physics",)]),
        ("whatif", {"vary": {"nothing": "1, 2", "weights.mass": 5}, "breaks": "yes"}, [("breaks",)]),
        (
            "whatif",
            {"vary": {"nothing": "1, 2", "wear_life_min": "a:b"}},
            [("vary", "nothing"), ("vary", "wear_life_min")],
        ),
        ("whatif", {"colour": "red", "shape": 1}, [("vary",), ("colour",), ("shape",)]),
    ],
)
def test_every_kind_that_takes_a_spec_tells_all_faults_at_once(
    client: Client, kind: str, more: dict[str, Any], paths: list[tuple[Any, ...]]
) -> None:
    found = faults_of(client, kind, {**WRONG, **more})
    spec = [tuple(one["path"]) for one in client.post("check", WRONG).json()["problems"]]
    assert len(spec) == 3
    assert {*spec, *paths} <= {*found}
    assert len(found) == len({*found})


def test_a_batch_tells_all_that_is_wrong_beside_its_rows(client: Client) -> None:
    wrong = {"points": 0, "gap": "x", "grid": 3, "family": "nothing", "mapping": [], "catalogs": {"x": "/etc"}}
    wrong |= {"seed": -1.5, "time_limit": "soon"}
    assert sorted(path[0] for path in faults_of(client, "batch", {**BATCH, **wrong})) == sorted(wrong)
    assert faults_of(client, "batch", {**BATCH, "colour": 1, "shape": 2}) == [("colour",), ("shape",)]


def test_what_varies_may_be_left_out_of_the_spec_and_is_no_fault(client: Client) -> None:
    requirements = {name: value for name, value in DUTY.items() if name != "load_torque"}
    asked = {**QUICK, "requirements": requirements, "vary": {"load_torque": "500, 600 N*m"}}
    assert faults_of(client, "whatif", {**asked, "limits": {"mas": "< 5 kg"}, "breaks": 1}) == [
        ("limits", "mas"),
        ("breaks",),
    ]
    job = client.submit("whatif", asked)
    assert client("DELETE", f"jobs/{job}").status_code == 204
