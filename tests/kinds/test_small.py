"""What forms ask: families, declarations, examples, checks and one design."""

from __future__ import annotations

import json
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import synth
from synth.errors import InputError
from synth.kinds import Sources
from synth.kinds.settings import KindSettings
from synth.kinds.small import check, declaration, evaluate, examples, families
from tests.kinds.jobs import DISC, PAIR, SPECS, earlier
from tests.question.hostile_values import ENTRIES, JUNK
from tests.shipped import FAMILIES
from tests.waiting import PATIENCE

pytestmark = pytest.mark.slow


def places(request: Any, sources: Sources | None = None) -> list[list[Any]]:
    found = check(request, sources or Sources(), KindSettings(seconds=PATIENCE))
    json.dumps(found, allow_nan=False)
    assert found["ready"] == (not found["problems"])
    return [one["path"] for one in found["problems"]]


def test_families_are_listed_with_options_and_examples() -> None:
    found = families()
    assert [one["name"] for one in found] == synth.families()
    assert all(one["title"] and one["line"] and one["examples"] for one in found)
    choices = [option for one in found for option in one["options"]]
    assert all(option["default"] in option["choices"] for option in choices)
    json.dumps(found, allow_nan=False)


def test_a_declaration_says_where_a_form_asks_for_what() -> None:
    found = declaration("disc_clutch")
    rows = {(row["kind"], row["name"]): row for row in found["rows"]}
    assert rows["requirement", "load_torque"]["section"] == "needed"
    assert rows["requirement", "outer_diameter_limit"]["section"] == "limit"
    assert rows["requirement", "safety_factor"]["section"] == "assumption"
    assert rows["slot", "friction_pair"]["section"] == "part"
    assert (rows["column", "friction_pair.p_allow"]["lower"], rows["column", "friction_pair.p_allow"]["upper"]) == (
        0.001,
        500,
    )
    assert rows["column", "friction_pair.unit_cost"]["lower"] is None
    assert rows["objective", "mass"]["section"] == "objective"
    assert len(rows) <= len(synth.describe("disc_clutch"))
    assert {row["section"] for row in found["rows"] if row["kind"] == "option"} == {"option"}
    json.dumps(found, allow_nan=False)


def test_options_change_a_declaration_and_wrong_ones_are_refused() -> None:
    (option, other) = next(
        (o["name"], next(c for c in o["choices"] if c != o["default"]))
        for o in next(f for f in families() if f["name"] == "multi_plate_clutch")["options"]
        if o["name"] == "lubrication"
    )
    plain, changed = declaration("multi_plate_clutch"), declaration("multi_plate_clutch", {option: other})
    assert [row["name"] for row in plain["rows"]] != [row["name"] for row in changed["rows"]]
    for family, options, path in [
        ("dance", {}, ("family",)),
        ("disc_clutch", {"dance": "x"}, ("options", "dance")),
        ("disc_clutch", [], ("options",)),
        (None, {}, ("family",)),
    ]:
        with pytest.raises(InputError) as caught:
            declaration(family, options)
        assert caught.value.path == path


@pytest.mark.parametrize(("torque", "ready"), [("load_torque", True), ("power", True), (None, False)])
def test_what_is_stated_decides_what_is_missing(torque: str | None, ready: bool) -> None:
    duty = {"driver_speed": "960 rpm", "offset": "5 mm"} | (
        {torque: "3 kW" if torque == "power" else 30} if torque else {}
    )
    checked = check({"family": "roller_coupling", "requirements": duty})
    faults = [fault["path"] for fault in checked["problems"]]
    assert (checked["ready"], faults) == (ready, [] if ready else [["requirements", "required_torque"]])


def test_examples_come_with_their_families_and_are_ready() -> None:
    found = examples()
    assert {one["family"] for one in found} >= set(FAMILIES)
    for one in found:
        assert one["description"]
        if one["design"]:
            assert evaluate(one["spec"])["design"]["status"] == "feasible"
        else:
            checked = check(one["spec"])
            assert (checked["ready"], checked["problems"]) == (True, []), one["name"]
            assert checked["combinations"] > 0


def test_all_faults_are_told_at_once_and_what_is_read() -> None:
    wrong = {
        **DISC,
        "requirements": {**DISC["requirements"], "load_torque": "6,5", "dance": 1, "driven_inertia": "0,7 kg"},
        "limits": {"mass": ["<= 3 kg", "<= 3 s"], "mas": "<= 3 kg"},
        "catalogs": {"friction_materials": "/etc/passwd"},
        "points": 0,
        "colour": "red",
    }
    del wrong["requirements"]["driver_speed"]
    found = check(wrong, settings=KindSettings(seconds=PATIENCE))
    assert not found["ready"]
    assert sorted(map(str, places(wrong))) == sorted(
        map(
            str,
            [
                ["colour"],
                ["points"],
                ["catalogs", "friction_materials"],
                ["requirements", "load_torque"],
                ["requirements", "dance"],
                ["requirements", "driven_inertia"],
                ["requirements", "driver_speed"],
                ["limits", "mass", 1],
                ["limits", "mas"],
            ],
        )
    )
    assert found["read"]["outer_diameter_limit"] == "240 mm"
    assert found["combinations"] is None
    assert all("expected" in one["message"] for one in found["problems"])


def test_faults_that_show_only_in_the_whole_are_told_together() -> None:
    wrong = {**DISC, "parts": {"friction_pair": ["nothing"]}, "weights": {"dance": 1.0}}
    assert sorted(map(str, places(wrong))) == ["['parts', 'friction_pair', 0]", "['weights', 'dance']"]


def test_thousands_of_faults_do_not_keep_a_form_waiting() -> None:
    many = {f"x{k}": k for k in range(2000)}
    found = check({**DISC, "requirements": {**DISC["requirements"], **many}}, Sources(), KindSettings(seconds=0.1))
    assert 1 <= len(found["problems"]) < 2000  # those that were found in time
    assert not found["ready"]


def test_units_are_read_by_the_parser_of_the_product() -> None:
    found = check(
        {"family": "multi_plate_clutch", "requirements": {"engagements_per_hour": "50 1/h", "omega_d": "26.6 rad/s"}}
    )
    assert found["read"]["engagements_per_hour"] == "50 1/h"


def test_a_question_of_several_families_is_checked_as_well() -> None:
    assert check(PAIR)["ready"]
    assert places({**PAIR, "requirements": {"dance": 1}}) == [["requirements", "dance"]]


def test_a_check_may_be_of_an_earlier_job() -> None:
    assert check({"of": "front"}, earlier())["ready"]
    assert places({"of": "front"}) == [["of"]]
    assert places({"of": "front", "requirements": {"load_torque": "x"}}, earlier()) == [["requirements", "load_torque"]]


def test_a_given_design_is_told_with_units() -> None:
    found = evaluate(SPECS["lecture_design"])
    assert found["units"]["mass"] == "kg"
    assert found["design"]["objectives"]
    assert evaluate(found["spec"])["design"] == found["design"]
    for wrong, path in [
        (None, ()),
        ({**SPECS["lecture_design"], "values": None}, ("values",)),
        ({**SPECS["lecture_design"], "catalogs": {"core_plates": "x.csv"}}, ("catalogs", "core_plates")),
    ]:
        with pytest.raises(InputError) as caught:
            evaluate(wrong)
        assert caught.value.path == path


CHANGES = st.builds(lambda entries, of: entries | of, ENTRIES, st.dictionaries(st.just("of"), JUNK, max_size=1))


@given(JUNK | CHANGES)
@settings(deadline=None, derandomize=True, max_examples=100)
def test_a_check_never_raises_whatever_it_is_given(request: Any) -> None:
    json.dumps(check(request), allow_nan=False)


@given(CHANGES)
@settings(deadline=None, derandomize=True, max_examples=150)
def test_a_check_never_raises_on_what_is_nearly_a_question(changes: dict[str, Any]) -> None:
    found = check({**DISC, **changes})
    json.dumps(found, allow_nan=False)
    assert found["ready"] == (not found["problems"])
