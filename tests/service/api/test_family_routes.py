"""What there is to ask, checks and evaluations."""

from __future__ import annotations

from pathlib import Path

import pytest

from synth.service.api.schemas import EXAMPLES
from tests.service.calling import Answering, Service, code_of
from tests.service.working import DUTY, FAMILY, QUICK, Client

pytestmark = pytest.mark.slow


def test_families_are_listed_with_their_options_and_examples(client: Client) -> None:
    found = {one["name"]: one for one in client.get("families").json()["families"]}
    assert len(found) >= 12
    assert {option["name"] for option in found[FAMILY]["options"]} >= {"lubrication", "practice"}
    assert found[FAMILY]["examples"]
    assert found[FAMILY]["line"]


@pytest.mark.parametrize("path", ["families", f"families/{FAMILY}", "examples"])
def test_what_depends_on_the_code_is_sent_once(client: Client, path: str) -> None:
    first = client.get(path)
    assert first.status_code == 200
    again = client.get(path, headers={"If-None-Match": first.headers["etag"]})
    assert (again.status_code, again.content) == (304, b"")
    assert client.get(path, headers={"If-None-Match": '"another"'}).status_code == 200


def test_a_declaration_depends_on_options(client: Client) -> None:
    usual = client.get(f"families/{FAMILY}").json()
    dry = client.get(f"families/{FAMILY}?options=lubrication:dry").json()
    assert dry["options"] == {"lubrication": "dry"}
    assert usual["rows"] != dry["rows"]
    assert {row["section"] for row in usual["rows"]} >= {"needed", "limit", "assumption", "option", "part", "objective"}


@pytest.mark.parametrize(
    ("path", "status"),
    [
        ("families/nothing", 404),
        ("families/..%2f..%2fetc", 404),
        (f"families/{FAMILY}?options=lubrication:wine", 422),
        (f"families/{FAMILY}?options=colour:red", 422),
        (f"families/{FAMILY}?options=lubrication", 422),
    ],
)
def test_what_is_no_family_or_option_is_refused(client: Client, path: str, status: int) -> None:
    answer = client.get(path)
    assert answer.status_code == status
    code_of(answer)


def test_what_depends_on_the_code_is_asked_once(tmp_path: Path) -> None:
    asked: list[str] = []

    def answer(task: str, payload: object) -> dict[str, object]:
        asked.append(task)
        return {"families": [], "declaration": {}, "code": "c"}

    own = "families/cone_clutch?options=cooling:"
    with Service(tmp_path, Answering(answer), remembered=2) as service:
        client = Client(service)
        for path in ("families", "families/cone_clutch", *(own + word for word in "aabcacbca"), "families"):
            assert client.get(path).status_code == 200
    # what there is for everybody stays, of declarations with options chosen the last two
    assert asked == ["families", "declaration", *["declaration"] * 7]


def test_a_check_tells_all_that_is_wrong(client: Client) -> None:
    found = client.post("check", EXAMPLES["incomplete"]).json()
    assert not found["ready"]
    paths = [problem["path"] for problem in found["problems"]]
    assert ["requirements", "load_torque"] in paths
    assert ["requirements", "driver_speed"] in paths
    ready = client.post("check", QUICK).json()
    assert (ready["ready"], ready["problems"]) == (True, [])
    assert ready["read"]["load_torque"] == "600 N*m"
    assert ready["combinations"] > 1000


@pytest.mark.parametrize("spec", [{}, {"family": 7}, {"of": "01"}, {"family": FAMILY, "requirements": [1]}, {"x": {}}])
def test_a_check_refuses_no_content(client: Client, spec: dict[str, object]) -> None:
    answer = client.post("check", spec)
    assert answer.status_code == 200
    assert not answer.json()["ready"]


def test_a_design_is_evaluated(client: Client) -> None:
    found = client.post("evaluate", EXAMPLES["design"]).json()
    assert found["design"]["values"]["torque"] == pytest.approx(1412, rel=0.01)
    refused = client.post("evaluate", {"family": FAMILY, "requirements": DUTY})
    assert (refused.status_code, code_of(refused)) == (422, "bad_input")
