"""Why nothing is feasible: what is listed helps, a little less does not, and what conflicts does so minimally."""

import json

import pytest

import synth
from synth.search.synthesize import synthesize
from synth.studies.infeasibility.explanation import rounded
from synth.units import parse_quantity
from tests.conformance.cases import CASES
from tests.repetitions import repetitions
from tests.terminal.entry import at_once

pytestmark = pytest.mark.slow

# Infeasible cases of these families, of some with fewer parts.
FAMILIES = {"wrap_spring": {}, "roller_coupling": {"parts": {"roller": ["6203"], "float_material": ["100Cr6"]}}}


@pytest.fixture(scope="module", params=FAMILIES)
def explained(request):
    case = CASES[request.param].infeasible
    problem = synth.load(request.param, **case.options)
    settings = {k: v for k, v in case.settings.items() if k in ("parts", "limits", "fix", "grid")}
    settings |= FAMILIES[request.param]
    return problem, case, settings, synth.explain(problem, case.requirements, **settings)


def feasible(problem, requirements, settings):
    front = synthesize(problem, requirements, points=1, objectives=["outer_diameter"], **settings)
    assert front.certificate.kind == "global"
    return bool(front.designs)


def test_applying_a_relaxation_is_feasible_and_one_per_cent_less_is_not(explained):
    problem, case, settings, explanation = explained
    ways = [w for w in explanation.single if w.kind == "requirement"]
    assert ways
    for way in ways[: repetitions(2, len(ways))]:
        assert way.proven
        assert not way.design.violated
        assert feasible(problem, {**case.requirements, way.name: way.requirement()}, settings), way.sentence
        less = way.given + 0.99 * (way.needed - way.given)
        unit = way.unit
        shown = rounded(less, unit, way.sense)
        assert parse_quantity(shown, unit, way.name) != pytest.approx(way.needed, rel=1e-6)
        assert not feasible(problem, {**case.requirements, way.name: shown}, settings), way.sentence


def test_every_patch_is_feasible(explained):
    problem, case, settings, explanation = explained
    spec = {"requirements": case.requirements, **settings}
    ways = [way for way in explanation.ways if way.patch is not None]
    assert {way.kind for way in explanation.ways if way.patch is None} <= {"part"}
    assert "joint" in {way.kind for way in ways}
    for way in ways:
        if way.kind != "requirement":  # those are asked above
            front = synthesize(problem, points=1, objectives=["outer_diameter"], **way.applied(spec))
            assert front.designs, way.sentence


def test_a_refusal_ends_with_amounts_and_exit_code_3(tmp_path):
    spec = tmp_path / "small.yaml"
    spec.write_text(
        "family: roller_coupling\n"
        "options: {practice: off}\n"
        "requirements: {required_torque: 300 N*m, driver_speed: 960 1/min, offset: 5 mm, outer_diameter_limit: 60 mm}\n"
        "parts: {roller: ['6203'], float_material: [100Cr6]}\n",
        encoding="utf-8",
    )
    done = at_once("explain", spec, "-o", tmp_path / "why")
    assert done.returncode == 3
    told = json.loads((tmp_path / "why" / "explanation.json").read_text(encoding="utf-8"))
    assert [guard["name"] for guard in told["refused"]] == ["envelope_too_small"]
    assert told["refused"][0]["missed_by"] == pytest.approx(0.4427, rel=1e-3)
    assert "outer diameter limit is 60 mm where at least 107.7 mm is needed" in " ".join(done.stdout.split())
    asked = {"required_torque": "300 N*m", "driver_speed": "960 1/min", "offset": "5 mm"}
    parts = {"roller": ["6203"], "float_material": ["100Cr6"]}
    first = told["ways"][0]["patch"]["requirements"]
    assert feasible(synth.load("roller_coupling", practice="off"), {**asked, **first}, {"parts": parts})


def test_the_conflict_is_one_and_every_limit_of_it_counts(explained):
    _, _, _, explanation = explained
    assert not explanation.feasible
    assert explanation.minimal
    assert len(explanation.conflict) >= 2
    # Whatever helps alone has to do with a limit of the conflict; the joint one widens all of them.
    assert explanation.joint is not None
    assert set(explanation.joint.design.violated) & set(explanation.conflict)


def test_a_value_of_a_part_that_would_do(explained):
    problem, case, settings, explanation = explained
    if problem.name != "roller_coupling":
        assert explanation.parts == []
        return
    way = next(w for w in explanation.parts if w.name == "roller.bore")
    # The next larger rollers of the table have such a bore, and with them it works.
    larger = {**settings, "parts": {**settings["parts"], "roller": "bore >= '20 mm'"}}
    assert way.needed < 0.020
    assert feasible(problem, case.requirements, larger)


def test_a_feasible_question_needs_no_explanation():
    case = CASES["wrap_spring"].infeasible
    asked = {**case.requirements, "required_torque": "10 N*m"}
    explanation = synth.explain(synth.load("wrap_spring", practice="off"), asked, parts=case.settings["parts"])
    assert explanation.feasible
    assert explanation.ways == []
    assert "nothing to explain" in explanation.message


def test_own_limits_are_explained_as_well(tmp_path):
    asked = {"required_torque": "10 N*m", "bore_diameter": "20 mm"}
    parts = {**CASES["wrap_spring"].infeasible.settings["parts"], "wire": ["square 4x4"]}
    explanation = synth.explain(
        synth.load("wrap_spring", practice="off"),
        asked,
        parts=parts,
        limits={"outer_diameter": "<= 25 mm"},
        time_limit=120,
    )
    assert explanation.conflict == ("outer_diameter <= 25 mm",)
    (way,) = explanation.single
    assert way.sentence == "limit outer_diameter <= 30 mm instead of 25 mm (20 % more)"
    files = explanation.save(tmp_path / "out")
    told = json.loads(files[1].read_text())
    assert told["conflict"] == list(explanation.conflict)
    assert len(files[0].read_text().splitlines()) == 1 + len(explanation.ways)


def test_time_that_is_over_is_said():
    case = CASES["wrap_spring"].infeasible
    explanation = synth.explain(synth.load("wrap_spring", practice="off"), case.requirements, time_limit=0.01)
    assert explanation.interrupted == "time limit"
    assert "Stopped early" in explanation.message


def test_bad_input_is_one_sentence():
    with pytest.raises(synth.InputError, match="required_torque"):
        synth.explain(
            synth.load("wrap_spring", practice="off"), {"required_torque": "-3 N*m", "bore_diameter": "20 mm"}
        )
    with pytest.raises(synth.InputError, match="time_limit"):
        synth.explain(
            synth.load("wrap_spring", practice="off"),
            {"required_torque": "3 N*m", "bore_diameter": "20 mm"},
            time_limit=-1,
        )
