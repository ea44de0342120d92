"""Every kind of job from its request to its records."""

from __future__ import annotations

import json
import pickle
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

from synth.errors import InputError
from synth.kinds import KINDS, Sources, kind
from synth.kinds.small import check
from synth.question.spec_patch import patched
from synth.queue.records import mentioned
from synth.results.loading import front_of_record
from synth.tables.catalogs import Catalogs
from synth.tables.table_text import TableText
from synth.workers.engine_work import read
from tests.kinds.jobs import DISC, PAIR, SPECS, disc, done, earlier, pair, summary
from tests.waiting import PATIENCE

BUILT = [name for name in KINDS if name not in ("batch", "size_range")]
OF: dict[str, dict[str, Any]] = {
    "synthesis": DISC,
    "compare": PAIR,
    "whatif": {**DISC, "vary": {"load_torque": "50, 60 N*m"}, "breaks": False},
    "explain": DISC,
    "prices": {"of": "front", "design": [1]},
    "near_equals": {"of": "front", "within": "20 %"},
    "rate": {"of": "front", "design": 1, "robust": {"load_torque": "+-1 %"}},
    "verify": {"of": "front"},
    "report": {"of": "front", "formats": ["html", "json"]},
}


def span(count: int) -> dict[str, Any]:
    return {"from": "50 N*m", "to": "60 N*m", "count": count}


def posed(name: str, request: Any, sources: Sources | None = None) -> Any:
    return kind(name).load().read(request, sources or earlier())


def fault(name: str, request: Any, sources: Sources | None = None) -> InputError:
    with pytest.raises(InputError) as caught:
        posed(name, request, sources)
    return caught.value


# ---- the list -------------------------------------------------------------------------------------------------------


def test_the_list_of_kinds_loads_nothing_heavy() -> None:
    heavy = "casadi", "numpy", "pandas", "cvxpy", "scipy", "yaml"
    code = f"import sys, synth.kinds; print([m for m in {heavy} if m in sys.modules])"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True, timeout=PATIENCE)
    assert done.stdout.strip() == "[]"


def test_a_kind_that_there_is_not_is_refused_by_name() -> None:
    with pytest.raises(InputError, match="one of synthesis, compare") as caught:
        kind("dance")
    assert caught.value.path == ("kind",)
    with pytest.raises(InputError):
        kind(["synthesis"])


def test_the_kinds_tell_what_waits_behind_what() -> None:
    assert {name for name, one in KINDS.items() if one.bulk} == {"batch", "size_range"}
    assert set(OF) == set(BUILT)
    assert all(name == one.name and one.title for name, one in KINDS.items())


# ---- requests -------------------------------------------------------------------------------------------------------


@pytest.mark.slow
@pytest.mark.parametrize("name", BUILT)
def test_a_stored_request_reads_as_itself(name: str) -> None:
    first = posed(name, OF[name])
    again = posed(name, json.loads(first.text))
    assert (again.text, again.title, again.families) == (first.text, first.title, first.families)
    assert first.title[0].isupper()
    assert not set("_*") & set(first.title)
    assert first.families
    assert not first.bulk


@pytest.mark.slow
def test_the_same_meaning_is_the_same_request() -> None:
    turned = {**dict(reversed(list(DISC.items()))), "requirements": dict(reversed(list(DISC["requirements"].items())))}
    symbols = {**DISC["requirements"], "M_load": DISC["requirements"]["load_torque"]}
    del symbols["load_torque"]
    said = {**DISC, "gap": 0.001, "grid": True, "seed": 0, "workers": 1, "limits": {}}
    for other in (turned, {**DISC, "requirements": symbols}, said):
        assert posed("synthesis", other).text == posed("synthesis", DISC).text
    assert posed("synthesis", {**DISC, "gap": 0.01}).text != posed("synthesis", DISC).text


def test_a_request_of_an_earlier_job_changes_entries_of_its_own() -> None:
    changed = posed("synthesis", {"of": "front", "requirements": {"load_torque": "55 N*m"}, "points": 2}).request
    assert changed == posed("synthesis", DISC).request | {
        "requirements": {**posed("synthesis", DISC).request["requirements"], "load_torque": "55 N*m"},
        "points": 2,
    }
    assert fault("synthesis", {"of": "other"}).path == ("of",)
    assert fault("synthesis", {"of": 3}).path == ("of",)


@pytest.mark.parametrize(
    ("name", "change", "path"),
    [
        (
            "synthesis",
            {"requirements": {**DISC["requirements"], "load_torque": "6,5"}},
            ("requirements", "load_torque"),
        ),
        ("synthesis", {"colour": "red"}, ("colour",)),
        ("synthesis", {"points": 10**9}, ("points",)),
        ("synthesis", {"workers": 2}, ("workers",)),
        ("synthesis", {"limits": {"mass": ["<= 3 kg", "<= 3 s"]}}, ("limits", "mass", 1)),
        ("synthesis", {"family": "any"}, ("family",)),
        ("synthesis", {"values": {}}, ("values",)),
        ("synthesis", {"options": {"practice": "dance"}}, ("options", "practice")),
        ("synthesis", {"robust": {"friction": "wide"}}, ("robust", "friction")),
        ("explain", {"physics": "yes"}, ("physics",)),
        ("whatif", {"vary": {}}, ("vary",)),
        ("whatif", {"vary": 3}, ("vary",)),
        ("whatif", {"vary": {"load_torque": {"from": 1}}}, ("vary", "load_torque")),
        (
            "whatif",
            {"vary": {"load_torque": {"from": "1 N*m", "to": "2 N*m", "count": 10**8}}},
            ("vary", "load_torque"),
        ),
        ("whatif", {"breaks": 1}, ("breaks",)),
        ("compare", {"family": "disc_clutch"}, ("family",)),
        ("compare", {"requirements": {"dance": 3}}, ("requirements", "dance")),
        ("prices", {"design": 7}, ("design",)),
        ("prices", {"step": "90 %"}, ("step",)),
        ("prices", {"of": "other"}, ("of",)),
        ("prices", {"family": "disc_clutch"}, ("family",)),
        ("prices", {"time_limit": -1}, ("time_limit",)),
        ("near_equals", {"design": True}, ("design",)),
        ("near_equals", {"design": 7}, ("design",)),
        ("near_equals", {"within": "2 kg"}, ("within",)),
        ("near_equals", {"count": 0}, ("count",)),
        ("near_equals", {"seed": -1}, ("seed",)),
        ("rate", {"robust": {}}, ("robust",)),
        ("rate", {"robust": {"dance": "+-1 %"}}, ("robust", "dance")),
        ("rate", {"design": [1, 9]}, ("design",)),
        ("verify", {"time_limit": "soon"}, ("time_limit",)),
        ("report", {"formats": ["doc"]}, ("formats",)),
        ("report", {"design": "best"}, ("design",)),
        ("report", {"length": "long"}, ("length",)),
        ("report", {"about": {"logo": "/etc/passwd"}}, ("about", "logo")),
        ("report", {"full": -1}, ("full",)),
    ],
)
def test_a_fault_is_told_with_its_place(name: str, change: dict[str, Any], path: tuple[Any, ...]) -> None:
    assert fault(name, {**OF[name], **change}).path == path


@pytest.mark.parametrize("name", BUILT)
@pytest.mark.parametrize("request_", [None, [], "text", 3, {}, {"family": {}}, {"of": {}}])
def test_what_is_no_request_is_refused(name: str, request_: Any) -> None:
    fault(name, request_)


def test_studies_of_many_steps_wait_behind_others() -> None:
    few, many = (
        {**OF["whatif"], "vary": {"load_torque": {"from": "50 N*m", "to": "60 N*m", "count": n}}} for n in (12, 13)
    )
    assert not posed("whatif", few).bulk
    assert posed("whatif", many).bulk


def test_a_study_has_steps_that_can_be_drawn_and_few_points_each() -> None:
    found = fault("whatif", {**OF["whatif"], "vary": {"load_torque": span(201)}})
    assert (found.path, found.value) == (("vary",), "201 steps")
    asked = {"of": "front", "vary": {"load_torque": span(3)}}
    assert posed("whatif", asked).request["points"] == 3
    assert posed("whatif", {**asked, "points": 2}).request["points"] == 2


def test_what_no_file_can_hold_is_refused() -> None:
    for value in ("\ud800", float("nan"), b"x"):
        assert fault("report", {**OF["report"], "about": {"project": value}}).path == ()
    assert len(posed("whatif", {**DISC, "vary": {"parts.friction_pair": [["woven_dry"] * 99]}}).title) <= 160


# ---- tables ---------------------------------------------------------------------------------------------------------

LININGS = TableText(
    reference="my_linings@3", csv="designation,friction_minimum_dynamic [-],density [kg/m3]\nmine,0.3,1800\n"
)


def test_requests_name_tables_by_reference_and_no_path(tmp_path: Any) -> None:
    (tmp_path / "linings.csv").write_text(LININGS.csv)
    paths = [
        str(tmp_path / "linings.csv"),
        "/etc/passwd",
        "/dev/zero",
        "../x@1",
        "a/b@1",
        "x",
        "my_linings@0",
        "@1",
        "",
        3,
    ]
    for value in [*paths, *(["+", p] for p in paths), ["+"], [], {}, ["my_linings@3"]]:
        found = fault("synthesis", {**DISC, "catalogs": {"friction_materials": value}})
        assert found.path[:2] == ("catalogs", "friction_materials"), value
    assert fault("synthesis", {**DISC, "catalogs": str(tmp_path)}).path == ("catalogs",)
    assert fault("compare", {**PAIR, "catalogs": str(tmp_path)}).path == ("catalogs",)
    missing = fault("synthesis", {**DISC, "catalogs": {"friction_materials": "my_linings@3"}})
    assert "a table that there is" in str(missing)


def test_what_a_request_refers_to_is_told() -> None:
    asked = {"catalogs": {"a": "x@1", "b": ["+", "y@2", "x@1"], "c": 3}, "of": "front"}
    assert (mentioned(asked).tables, mentioned(asked).jobs) == (("x@1", "y@2"), ("front",))
    for junk in (None, [], {"catalogs": 3, "of": 3}):
        assert (mentioned(junk).tables, mentioned(junk).jobs) == ((), ())


def linings() -> str:
    """Return some of the shipped linings, as a user would keep them."""
    frame = Catalogs().table("friction_materials").to_frame()
    return str(frame[frame["designation"].isin(["woven_dry", "wound_yarn_dry", "moulded_dry"])].to_csv(index=False))


@pytest.mark.slow
def test_own_tables_are_used_and_their_digests_kept() -> None:
    text = TableText(reference="pairs@2", csv=linings())
    sources = Sources(tables={"pairs@2": text})
    request = {**DISC, "catalogs": {"friction_materials": "pairs@2"}}
    found = posed("synthesis", request, sources)
    assert read({"kind": "synthesis", "request": request, "sources": sources}, print)["tables"] == {
        "pairs@2": text.digest
    }
    assert found.request["catalogs"] == {"friction_materials": "pairs@2"}
    records = done("synthesis", request, sources)
    front = json.loads(records["front.json"])
    assert front["restated"]["catalogs"] == {"friction_materials": "pairs@2"}
    assert json.loads(records["question.json"])["tables"] == {"pairs@2": text.digest}
    whole = Sources(tables=sources.tables, records={"mine": records})
    assert summary("verify", done("verify", {"of": "mine"}, whole))["outcome"] == "holds"
    assert fault("prices", {"of": "mine"}, Sources(records={"mine": records})).path[0] == "of"
    strange = TableText(reference="pairs@2", csv=text.csv.replace("woven_dry", "wound_yarn_dry"))
    wrong = fault("synthesis", request, Sources(tables={"pairs@2": strange}))
    assert "pairs@2, line" in str(wrong)
    assert wrong.path[:2] == ("catalogs", "friction_materials")


# ---- work -----------------------------------------------------------------------------------------------------------


@pytest.mark.slow
def test_a_synthesis_finds_a_front() -> None:
    facts = summary("synthesis", disc())
    assert (facts["outcome"], facts["family"], facts["designs"], facts["certificate"]) == (
        "optimal",
        "disc_clutch",
        4,
        "global",
    )
    assert set(facts["best"]) == set(facts["objectives"]) == {"mass", "actuation_force"}
    assert facts["best"]["mass"].endswith(" kg")
    assert set(disc()) == {"front.json", "calculation.json", "offered.json", "question.json"}


@pytest.mark.slow
def test_several_families_are_compared_and_checked_again() -> None:
    facts = summary("compare", pair())
    assert set(facts["families"]) == set(PAIR["family"])
    assert facts["outcome"] == "optimal"
    assert facts["designs"] == 3
    sources = Sources(records={"pair": pair()})
    assert summary("verify", done("verify", {"of": "pair"}, sources))["outcome"] == "holds"
    assert summary("report", done("report", {"of": "pair"}, sources))["files"][0] == "report.html"
    prices = done("prices", {"of": "pair", "family": "disc_clutch", "design": 1}, sources)
    assert summary("prices", prices)["designs"] == 1
    assert fault("prices", {"of": "pair"}, sources).path == ("family",)
    changed = {
        **pair(),
        "designs.csv": b"",
        "comparison.json": pair()["comparison.json"].replace(b'"rank": 2', b'"rank": 3'),
    }
    found = done("verify", {"of": "pair"}, Sources(records={"pair": changed}))
    assert summary("verify", found)["outcome"] == "refuted"


@pytest.mark.slow
def test_a_study_keeps_the_front_of_every_step() -> None:
    records = done("whatif", OF["whatif"])
    facts = summary("whatif", records)
    assert (facts["outcome"], facts["steps"], facts["feasible_steps"]) == ("optimal", 2, 2)
    content = json.loads(records["study.json"])
    assert [step["stated"] for step in content["steps"]] == [["50 N*m"], ["60 N*m"]]
    assert [x["unit"] for x in content["varied"]] == ["N*m"]
    fronts = [front_of_record(step["front"], Path("study.json")) for step in content["steps"]]
    assert all(front.designs for front in fronts)
    assert {"whatif.csv", "breaks.csv", "whatif.svg"} <= set(records)


@pytest.mark.slow
def test_an_explanation_says_how_to_change_the_question() -> None:
    asked = {"of": "front", "limits": {"actuation_force": "<= 100 N"}}
    records = done("explain", asked, earlier())
    facts = summary("explain", records)
    assert facts["outcome"] == "infeasible"
    assert facts["ways"] > 0
    ways = [way for way in json.loads(records["explanation.json"])["ways"] if way["patch"]]
    applied = posed("synthesis", patched(asked, ways[0]["patch"]))
    assert summary("synthesis", done("synthesis", applied.request))["designs"] > 0
    assert summary("explain", done("explain", DISC))["outcome"] == "feasible"


@pytest.mark.slow
@pytest.mark.parametrize(
    ("name", "expected"),
    [
        ("prices", {"outcome": "feasible", "designs": 1, "asked": 1}),
        ("near_equals", {"outcome": "feasible", "found": 1, "complete": True}),
        ("rate", {"rated": 1, "missing": 0}),
        ("verify", {"outcome": "holds", "findings": 0}),
        ("report", {"files": ["report.html", "design_01_sheet.html", "design_01_sheet.json"]}),
    ],
)
def test_what_is_asked_of_a_front(name: str, expected: dict[str, Any]) -> None:
    facts = summary(name, done(name, OF[name], earlier()))
    assert {key: facts[key] for key in expected} == expected


@pytest.mark.parametrize("what", [OF["rate"], {**SPECS["lecture_design"], "robust": {"load_torque": "+-1 %"}}])
def test_points_of_a_rating_are_stated_beside_what_scatters(what: dict[str, Any]) -> None:
    beside = {"samples": 256, "confidence": "99 %", "seed": 3}
    stated = posed("rate", {**what, **beside}).request
    assert stated == posed("rate", {**what, "robust": {**what["robust"], **beside}}).request
    assert stated["robust"] == {"load_torque": "+-1 %", **beside}
    assert fault("rate", {**what, "samples": 0}).path == ("samples",)


@pytest.mark.slow
def test_a_given_design_is_rated() -> None:
    design = {**SPECS["lecture_design"], "robust": {"load_torque": "+-1 %"}}
    assert summary("rate", done("rate", design))["rated"] == 1
    assert fault("rate", {key: value for key, value in design.items() if key != "values"}).path == ("values",)


@pytest.mark.slow
def test_a_front_that_was_changed_is_found_out() -> None:
    content = json.loads(disc()["front.json"])
    content["designs"][0]["objectives"]["mass"] *= 0.9
    changed = Sources(records={"front": {**disc(), "front.json": json.dumps(content).encode()}})
    assert summary("verify", done("verify", {"of": "front"}, changed))["outcome"] == "refuted"
    assert fault("prices", {"of": "front"}, changed).path == ("of",)
    other = Sources(records={"front": {**disc(), "calculation.json": b"{}"}})
    found = json.loads(done("verify", {"of": "front"}, other)["verification.json"])
    assert [finding for finding in found["findings"] if "calculation.json" in finding]


def test_a_table_of_which_no_row_can_be_asked_is_refused_with_the_faults_of_its_rows() -> None:
    duty = DISC["requirements"]
    rows: list[dict[str, Any]] = [{**duty, "load_torque": "many"}, {**duty, "driver_speed": "fast"}]
    found = fault("batch", {"family": "disc_clutch", "rows": rows})
    assert [one.path for one in found.every()] == [("rows", 2, "load_torque"), ("rows", 3, "driver_speed")]
    assert "none of 2 rows can be asked" in str(found)
    accepted = posed("batch", {"family": "disc_clutch", "rows": [*rows, duty]})
    assert (accepted.rows, accepted.title) == (3, "3 rows")
    assert posed("batch", {"family": "disc_clutch", "rows": [duty]}).title == "1 row"


def test_everything_that_is_wrong_with_a_spec_is_told_when_it_is_asked() -> None:
    wrong = {**DISC, "points": 0, "limits": {"mass": "<= 3 s"}, "requirements": {"load_torque": "much"}}
    payload = {"kind": "synthesis", "request": wrong, "sources": Sources()}
    with pytest.raises(InputError) as caught:
        read(payload, lambda state: None)
    again = pickle.loads(pickle.dumps(caught.value))
    told = [fault.told() for fault in again.every()]
    assert told == check(wrong)["problems"]
    assert len(told) > 3
    assert str(again) == told[0]["message"]
    with pytest.raises(InputError) as caught:
        read({**payload, "request": {**DISC, "family": "any", "points": 0}}, lambda state: None)
    assert [fault.path for fault in caught.value.every()] == [("family",)]
    assert fault("batch", {"family": "x", "rows": [{"load_torque": "50 N*m"}]}).path == ("family",)


# ---- words ----------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    "name", ["prices", "near_equals", "rate", "verify", "report", "synthesis", "explain", "whatif"]
)
def test_an_earlier_job_that_has_not_what_is_wanted_is_not_told_as_missing(name: str) -> None:
    sources = Sources(records={"table": {"table.json": b"[]"}, "priced": {"question.json": b'{"kind": "prices"}'}})
    request = {"of": "table", **({"vary": {"load_torque": span(2)}} if name == "whatif" else {})}
    found = fault(name, request, sources)
    assert (found.path, str(found.value)) == (("of",), "a batch")
    assert str(found).startswith("request: of: got a batch; expected a job that ")
    assert "got a job of the kind prices" in str(fault(name, {**request, "of": "priced"}, sources))
    assert "question.json" not in str(found)


@pytest.mark.parametrize(
    ("rows", "path", "told"),
    [
        ([], ("rows",), "request: rows: got an empty list"),
        ({}, ("rows",), "request: rows: got an empty mapping"),
        ([{"load_torque": "50 N*m"}, 1], ("rows", 1), "request: rows: entry 2: got 1; expected an object such as"),
        ([{}, {"a": ""}], ("rows",), "request: rows: got objects without values; expected names with values in them"),
    ],
)
def test_rows_that_are_none_are_told_as_what_they_are(rows: Any, path: tuple[Any, ...], told: str) -> None:
    found = fault("batch", {"family": "disc_clutch", "rows": rows})
    assert found.path == path
    assert str(found).startswith(told)
    assert "'" not in str(found)  # examples are JSON


@pytest.mark.parametrize(
    ("change", "told"),
    [
        ({"objectives": []}, "objectives: got an empty list; expected at least one of "),
        ({"limits": {"mass": "<= "}}, "limits: mass: got '<= '; expected a comparison, for example '<= 260 kg'"),
        ({"limits": {"mass": "<="}}, "limits: mass: got '<='; expected a comparison, for example '<= 260 kg'"),
        ({"points": True}, "request: points: got true; expected a whole number"),
        ({"family": None}, "request: family: is missing; expected the name of a family: "),
        ({"family": "any"}, "one family; to ask several is a comparison"),
        ({"options": {"practice": 3}}, "one of its words, as the family declares them"),
        ({"limits": {"colour": "<= 3"}}, "a quantity of disc_clutch; its description lists them"),
    ],
)
def test_what_is_there_is_told_as_it_is_in_words_without_commands(change: dict[str, Any], told: str) -> None:
    found = str(fault("synthesis", {**DISC, **change}))
    assert told in found
    assert "clutchsynth" not in found
