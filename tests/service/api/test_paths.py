"""Where problems are: of a spec by its own keys, wherever it stands; of all else by the keys of the body."""

from __future__ import annotations

import json
from typing import Any

import pytest

from tests.service.calling import code_of
from tests.service.working import BATCH, DUTY, FAMILY, QUICK, Client

pytestmark = pytest.mark.slow
TORQUE = {**QUICK, "requirements": {**DUTY, "load_torque": "much"}}
ENDLESS = json.dumps({**QUICK, "requirements": {**DUTY, "load_torque": "ENDLESS"}}).replace('"ENDLESS"', "1e400")
PLACE = ["requirements", "load_torque"]


def job(spec: str, kind: str = "synthesis", more: str = "") -> str:
    return f'{{"kind": "{kind}", "request": {spec}{more}}}'


@pytest.mark.parametrize(
    ("path", "body", "place"),
    [
        ("check", json.dumps(TORQUE), PLACE),
        ("evaluate", json.dumps({**TORQUE, "values": {"x": 1}}), None),
        ("jobs", job(json.dumps(TORQUE)), PLACE),
        ("jobs", job(json.dumps(TORQUE), "explain"), PLACE),
        ("jobs", job(json.dumps({**TORQUE, "vary": {"wear_life_min": "1, 2"}}), "whatif"), PLACE),
        ("check", ENDLESS, PLACE),
        ("evaluate", ENDLESS, PLACE),
        ("jobs", job(ENDLESS), PLACE),
        ("batches", ENDLESS, PLACE),
        ("jobs", job(ENDLESS.replace("1e400", "NaN")), PLACE),
        ("jobs", job('{"points": 1, "points": 2}'), ["points"]),
        ("check", '{"points": 1, "points": 2}', ["points"]),
        ("jobs", job(json.dumps({**QUICK, "points": 501})), ["points"]),
        ("jobs", job(json.dumps({**QUICK, "time_limit": -1})), ["time_limit"]),
        ("jobs", job(json.dumps({**BATCH, "points": 0}), "batch"), ["points"]),
        ("batches", json.dumps({**BATCH, "points": 0}), ["points"]),
        ("batches/check", json.dumps({**BATCH, "points": 0}), ["points"]),
        ("batches", json.dumps({**BATCH, "family": "nothing"}), ["family"]),
        ("jobs", job("{}", more=', "title": " "'), ["title"]),
        ("jobs", job("{}", more=', "priority": 1e400'), ["priority"]),
        ("jobs", '{"kind": "synthesis"}', ["request"]),
        ("jobs", job("1e400"), ["request"]),
        ("jobs", job("[]"), ["request"]),
        ("jobs", '{"kind": "x", "request": {}}', ["kind"]),
        ("jobs", job("{}", more=', "request": {}'), ["request"]),
        ("tokens", '{"name": "a", "scopes": ["admin", "x"]}', ["scopes", 1]),
        ("catalogues", '{"name": "a b", "csv": "x"}', ["name"]),
        ("catalogues", '{"name": "a", "csv": 1e400}', ["csv"]),
        ("check", "[]", []),
        ("jobs", "NaN", []),
    ],
)
def test_paths_begin_with_keys_of_the_spec_wherever_it_stands(
    client: Client, path: str, body: str, place: list[Any] | None
) -> None:
    answer = client("POST", path, content=body, headers={"Content-Type": "application/json"})
    told = answer.json()
    if answer.status_code != 200:
        assert (answer.status_code, code_of(answer)) == (422, "bad_input")
        told = told["error"]
    places = [problem["path"] for problem in told["problems"]]
    assert places
    assert place is None or place in places
    assert all(one[:1] != ["request"] or one == place == ["request"] for one in places)


@pytest.mark.parametrize(
    ("path", "place"),
    [
        ("jobs?limit=0", ["limit"]),
        ("jobs?nothing=1", ["nothing"]),
        ("jobs?state=x", ["state", 0]),
        ("events", ["jobs"]),
    ],
)
def test_paths_of_an_address_are_its_parameters(client: Client, path: str, place: list[Any]) -> None:
    answer = client.get(path)
    assert (answer.status_code, code_of(answer)) == (422, "bad_input")
    assert [problem["path"] for problem in answer.json()["error"]["problems"]] == [place]
    assert client.post("check", {"family": FAMILY, "of": 3}).json()["problems"][0]["path"] == ["of"]
