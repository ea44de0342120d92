"""Studies of questions in which something scatters: each step is what its question has alone, and stands the range."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

import pytest

import synth
import synth.robust.robust_front
from synth.question.request import Request
from synth.question.settings import SearchSettings
from synth.results import ParetoFront
from synth.results.rating_tables import COLUMNS
from synth.studies.whatif.break_points import NOT_ROBUST
from synth.studies.whatif.run import study_of
from synth.studies.whatif.steps import Steps
from synth.studies.whatif.study import Study
from tests.asking import steps_of
from tests.sample_problems.shaft_brake import CATALOGS, NEEDED, ShaftBrake
from tests.tuned import tuned

RANGES = {"friction": "catalogue range", "torque": "+-10 %", "wear": "new and worn", "tolerance": {"radius": "+-1 mm"}}
DUTY = {**NEEDED, "torque_limit": "400 N*m"}
# Searched again because a limit fails between the corners: see the tests of robust fronts.
WIDE = {"speed": "+-30 %", "samples": 512}
HUMMING: Mapping[str, Any] = {
    "fix": {"force": "3 kN"},
    "objectives": ["size"],
    "points": 1,
    "limits": {"size": ">= 200 mm"},
}
PROBLEM = ShaftBrake()


def study(vary: Mapping[str, Any], robust: Any = RANGES, requirements: Any = DUTY, **more: Any) -> Study:
    settings = {"catalogs": CATALOGS, "breaks": False, "points": 3, **more}
    return synth.whatif(PROBLEM, requirements, vary, robust=robust, **settings)


def steps(vary: Mapping[str, Any], robust: Any = None) -> Steps:
    return steps_of(PROBLEM, DUTY, vary, CATALOGS, robust=robust)


def check_same(step: ParetoFront | None, requirements: Mapping[str, Any], robust: Any, **more: Any) -> ParetoFront:
    """Check that the front of a step is that of the same question asked alone; return the latter."""
    own = synth.synthesize(PROBLEM, requirements, robust=robust, **{"catalogs": CATALOGS, "points": 3, **more})
    assert step is not None
    assert (step.status, step.certificate.kind) == (own.status, own.certificate.kind)
    assert step.frame == own.frame
    assert step.settings == own.settings
    assert len(step.designs) == len(own.designs)
    for objective in own.frame.objectives:
        mine, alone = (sorted(d.values[objective] for d in front.designs) for front in (step, own))
        # What lies between the ends may lie elsewhere on the front.
        assert (mine[0], mine[-1]) == pytest.approx((alone[0], alone[-1]), rel=1e-3)
    return own


@pytest.mark.slow
@pytest.mark.parametrize("objectives", [["force"], ["force", "size"]])
def test_steps_are_those_asked_alone_and_stand_the_range(objectives: list[str]) -> None:
    found = study({"torque": "90, 100, 110 N*m"}, objectives=objectives)
    for step, torque in zip(found.steps, (90, 100, 110), strict=True):
        own = check_same(step.front, {**DUTY, "torque": f"{torque} N*m"}, RANGES, objectives=objectives)
        assert own.designs
        assert step.front is not None
        assert all(d.robust["holds"] and d.robust["proof"] == "proven" for d in step.front.designs)
        assert step.front.statistics["robust"]["searches"] == 1
        assert step.front.verify().holds


@pytest.mark.slow
def test_what_scatters_may_be_varied() -> None:
    found = study(
        {"robust.friction": "none, +-10:20:10 %, catalogue range"}, {"torque": "+-10 %"}, objectives=["force"]
    )
    assert [x.shown(v) for x in found.varied for v in x.values] == ["none", "+-10 %", "+-20 %", "catalogue range"]
    for step in found.steps:
        friction = {} if step.values == ("none",) else {"friction": step.values[0]}
        check_same(step.front, DUTY, {"torque": "+-10 %", **friction}, objectives=["force"])
    force = [f.designs[0].values["force"] for f in found.fronts]
    # At the largest radius, mu (1 - x) F (200 mm - 2 mm) = 110 N*m. Of equal scatter the soft lining is best; over the
    # range of the table it is the firm one.
    assert force == pytest.approx([110 / (mu * 0.198) for mu in (0.40, 0.36, 0.32, 0.24)], rel=1e-6)
    assert [str(f.designs[0].parts["pair"]) for f in found.fronts] == ["soft", "soft", "soft", "firm"]
    assert found.along is None


def test_nothing_scatters_at_one_step_alone() -> None:
    found = study({"robust.friction": "none, +-10 %"}, None, objectives=["force"])
    plain, robust = found.fronts
    assert "robust" not in plain.settings
    assert plain.designs[0].robust == {}
    assert robust.designs[0].robust["holds"]
    columns = found.to_frame()
    assert columns["robust"].tolist()[-1] == "yes"
    assert columns["robust"].isna().tolist() == [True, False]


@pytest.mark.slow
def test_the_end_of_what_is_feasible_is_that_of_the_worst_corner() -> None:
    # Firm: mu_min F (r - 3 mm) >= 110 N*m and 1.1 mu_max F (r + 1 mm) <= limit, at the largest radius of 200 mm.
    least = 110 * 1.1 * 0.36 / 0.24 * 0.201 / 0.197
    found = study({"torque_limit": "180, 200 N*m"}, objectives=["force"], breaks=True)
    assert [len(f.designs) for f in found.fronts] == [0, 1]
    (end,) = found.breaks
    assert end.kind == "feasible"
    assert end.proven
    assert end.low <= least <= end.high * (1 + 1e-6)  # the tolerance of limits
    assert end.high - end.low <= 1e-3 * end.high


@pytest.mark.slow
def test_limits_that_fail_between_corners_are_posed_at_all_steps_and_between() -> None:
    vary = {"torque": "100, 130, 190 N*m"}
    found = study(vary, WIDE, NEEDED, breaks=True, **HUMMING)
    for step, torque in zip(found.steps, (100, 130, 190), strict=True):
        check_same(step.front, {**NEEDED, "torque": f"{torque} N*m"}, WIDE, **HUMMING)
        assert step.front is not None
        assert step.front.verify().holds
    radius = [f.designs[0].values["radius"] for f in found.fronts]
    assert radius == pytest.approx([0.11 / 0.7, 0.11 / 0.7, 0.002 + 190 / 1200], rel=1e-6)
    assert found.fronts[0].statistics["robust"]["searches"] > 1
    assert all(b.proven for b in found.breaks)


def test_a_break_between_designs_that_do_not_stand_the_range_is_not_proven() -> None:
    asked = {key: given for key, given in HUMMING.items() if key != "points"}
    request = Request.of(PROBLEM, NEEDED, CATALOGS, WIDE, **asked)
    one_search = tuned(robust={"searches": 1, "searches_for_first": 1})
    found = study_of(request, SearchSettings(points=1), {"torque": "90, 190 N*m"}, tuning=one_search)
    assert found.steps[0].reason == "no design was found that keeps its limits over the whole range"
    assert found.steps[0].front is not None
    assert found.steps[0].front.statistics["robust"]["taken_off"] == 1
    assert [(b.proven, b.remark) for b in found.breaks if b.before is not None] == [(False, NOT_ROBUST)]


def test_designs_may_be_rated_alone() -> None:
    plain = study({"torque": "90, 110 N*m"}, None)
    rated = study({"torque": "90, 110 N*m"}, {**RANGES, "mode": "rate"})
    for one, other in zip(plain.fronts, rated.fronts, strict=True):
        assert [d.values for d in one.designs] == [d.values for d in other.designs]
        assert not any(d.robust["holds"] for d in other.designs)
    table = rated.to_frame()
    assert list(table.columns)[-len(COLUMNS) - 3 : -3] == list(COLUMNS)
    assert set(table["robust"]) == {"no"}
    assert table["worst at"].notna().all()


def test_weights_change_the_order_alone() -> None:
    found = study({"weights.size": "0.1, 5"}, points=4)
    first, last = found.fronts
    assert {d.values["force"] for d in first.designs} == {d.values["force"] for d in last.designs}
    assert all(d.robust["holds"] for front in found.fronts for d in front.designs)
    assert last.settings["weights"]["size"] == 5
    assert last.settings["robust"] == first.settings["robust"]


@pytest.mark.slow
def test_what_is_kept_is_kept_for_its_range_alone(tmp_path: Path) -> None:
    vary = {"torque": "90, 110 N*m"}
    first = study(vary, WIDE, NEEDED, folder=tmp_path, **HUMMING)
    again = study(vary, WIDE, NEEDED, folder=tmp_path, **HUMMING)
    assert (first.statistics["kept"], again.statistics["kept"]) == (0, 2)
    assert again.to_frame().equals(first.to_frame())
    assert all(f.verify().holds for f in again.fronts)
    rated = {**WIDE, "mode": "rate"}
    assert study(vary, rated, NEEDED, folder=tmp_path, **HUMMING).statistics["kept"] == 0
    assert study(vary, {**rated, "samples": 1024}, NEEDED, folder=tmp_path, **HUMMING).statistics["kept"] == 0


def interrupted_at(stage: str, count: int) -> Callable[[Mapping[str, Any]], None]:
    seen = []

    def tell(state: Mapping[str, Any]) -> None:
        seen.extend([1] if state["stage"].endswith(stage) else [])
        if len(seen) == count:
            raise KeyboardInterrupt

    return tell


@pytest.mark.slow
def test_a_step_that_was_not_rated_to_the_end_is_not_kept(tmp_path: Path) -> None:
    vary = {"torque": "90, 100, 110 N*m"}
    found = study(vary, folder=tmp_path, progress=interrupted_at("rating", 5))
    assert found.interrupted == "interrupted"
    assert [s.front is None for s in found.steps] == [False, True, True]
    again = study(vary, folder=tmp_path)
    assert again.statistics["kept"] == 1
    assert again.to_frame().equals(study(vary).to_frame())


# ---- what is asked --------------------------------------------------------------------------------------------------


def test_what_scatters_takes_the_place_of_what_was_said() -> None:
    def scattering(vary: Mapping[str, Any]) -> dict[str, str]:
        (rater,) = steps(vary, {**RANGES, "samples": 128}).raters
        assert rater is not None
        assert rater.uncertainty.samples == 128
        return {x.name: x.text for x in rater.quantities}

    every = {"friction": "catalogue range", "torque": "+-10 %", "wear": "new and worn", "radius": "+-1 mm"}
    assert scattering({"robust.wear": "none"}) == {n: text for n, text in every.items() if n != "wear"}
    # By symbol, and a size that stands among the tolerances.
    assert scattering({"robust.r": "+-2 mm"}) == {**every, "radius": "+-2 mm"}
    assert scattering({"robust.T": "+-5 %"}) == {**every, "torque": "+-5 %"}
    assert scattering({"robust.pair.pressure_allow": ["+-5 %"]}) == {**every, "pair.pressure_allow": "+-5 %"}
    assert [r is None for r in steps({"robust.friction": "none, +-5 %"}).raters] == [True, False]


def test_a_unit_counts_for_the_ranges_before_it() -> None:
    def values(key: str, given: Any) -> list[Any]:
        return [v for (v,) in steps({key: given}).values]

    assert values("robust.torque", "+-5, +-10 %") == ["+-5 %", "+-10 %"]
    assert values("robust.torque", "+-5, +-10 N*m, none, +-20 %") == ["+-5 N*m", "+-10 N*m", "none", "+-20 %"]
    assert values("robust.torque", "90 .. 110, 80 .. 120 N*m") == ["90 .. 110 N*m", "80 .. 120 N*m"]
    assert values("robust.torque", ["+- 5 %", "± 10.0%"]) == ["+-5 %", "+-10 %"]
    assert values("robust.friction", "+-0.05, +-0.1") == ["+-0.05", "+-0.1"]
    assert values("robust.friction", "+-0.05:0.15:0.05, Catalogue Range") == [
        "+-0.05",
        "+-0.1",
        "+-0.15",
        "Catalogue Range",
    ]


def test_wear_is_varied_by_its_own_name() -> None:
    found = steps({"robust.wear": "none, new and worn"}, {"wear": "0 .. 1 mm", "torque": "+-5 %"})
    assert found.varied[0].label == "robust.wear"
    scattering = [{x.name: x.text for x in r.quantities} for r in found.raters if r is not None]
    assert scattering == [{"torque": "+-5 %"}, {"torque": "+-5 %", "wear": "new and worn"}]


@pytest.mark.slow
def test_none_is_no_scatter_wherever_a_block_stands() -> None:
    plain = synth.synthesize(PROBLEM, DUTY, catalogs=CATALOGS, points=3)
    none = synth.synthesize(PROBLEM, DUTY, catalogs=CATALOGS, points=3, robust={"friction": "None"})
    assert [d.values for d in none.designs] == [d.values for d in plain.designs]
    assert not any(d.robust for d in none.designs)
    some = {"friction": "none", "tolerance": {"radius": "none"}, "torque": "+-5 %"}
    (design, *_) = synth.synthesize(PROBLEM, DUTY, catalogs=CATALOGS, points=3, robust=some).designs
    assert list(design.robust["units"]) == ["torque"]


def test_ranges_that_no_row_offered_fits_are_refused() -> None:
    def asked(**more: Any) -> ParetoFront:
        return synth.synthesize(PROBLEM, DUTY, catalogs=CATALOGS, points=1, robust={"friction": "0.25 .. 0.35"}, **more)

    assert asked().designs
    with pytest.raises(synth.InputError, match=r"holds the nominal mu_dynamic, 0\.4"):
        asked(parts={"pair": ["soft"]})


def test_what_a_longer_study_has_left_behind_is_removed(tmp_path: Path) -> None:
    study({"torque": "90, 100, 110 N*m"}, None, folder=tmp_path)
    again = study({"torque": "90, 100 N*m"}, None, folder=tmp_path)
    assert len(again.steps) == 2
    again.save(tmp_path)  # until then the earlier study stays
    assert sorted(p.name for p in (tmp_path / "steps").iterdir()) == ["step_0001.json", "step_0002.json"]
    assert "step 3" not in (tmp_path / "study.json").read_text()
    assert study({"torque": "90, 100 N*m"}, None, folder=tmp_path).statistics["kept"] == 2


def test_limits_posed_alike_are_traced_once() -> None:
    found = steps({"torque": "90:110:5 N*m", "robust.friction": "+-5 %, +-10 %"})
    assert len({id(q.instance.model) for q in found.questions}) == 2


@pytest.mark.parametrize(
    ("vary", "robust", "words"),
    [
        ({"robust.friktion": "+-5 %"}, None, ["vary, robust.friktion = +-5 %", "did you mean friction"]),
        ({"robust.friction": "+-200 %, +-5 %"}, None, ["vary, robust.friction = +-200 %"]),
        ({"robust.mode": "rate"}, RANGES, ["robust.mode", "what scatters"]),
        ({"robust.tolerance": "+-1 mm"}, RANGES, ["robust.tolerance", "what scatters"]),
        ({"robust.friction": "+-5:x:5 %"}, None, ["robust.friction", "from, to and step"]),
        ({"robust.friction": "+-5 %:10:5 mm"}, None, ["robust.friction", "one unit"]),
        ({"robust.friction": "+-5:20 %"}, None, ["robust.friction", "+-5:20 %", "from, to and step"]),
        ({"robust.friction": "+-10 %, +-10.0 %"}, None, ["each value once"]),
        ({"robust.friction": "5:20:5 %"}, None, ["got '5:20:5 %'"]),
        ({"robust.friction": "0.2 .. 0.4:0.5:0.05"}, None, ["got '0.2 .. 0.4:0.5:0.05'"]),
        ({"robust.friction": ("+-5 %", "+-15 %", 3)}, None, ["ranges as text", "'none'"]),
        ({"robust.friction": [None, "+-5 %"]}, None, ["ranges as text", "'none'"]),
        ({"robust.friction": []}, None, ["at least one range"]),
        ({"robust.friction": "+-5"}, None, ["robust: friction", "above zero"]),
        ({"robust.friction": "-0.2 .. 0.4"}, None, ["robust: friction", "above zero"]),
        ({"robust.friction": "0.5 .. 0.6"}, None, ["holds the nominal mu_dynamic, one from 0.3 to 0.4"]),
        ({"robust.pair.pressure_allow": "2 .. 3 N/mm2"}, None, ["holds the nominal pressure_allow"]),
        ({"robust": "none, +-5 %"}, None, ["robust.NAME"]),
        ({"robust.friction": "+-5:10:-5 %"}, None, ["a step that leads"]),
        ({"robust.friction": "+-5:10:5 %, +-10 %"}, None, ["each value once"]),
        ({"robust.friction <=": "+-5 %"}, None, ["without <="]),
        ({"robust.torque": "120 .. 130 N*m"}, None, ["vary, robust.torque", "holds the nominal 100 N*m"]),
        ({"torque": "100, 120 N*m"}, {"torque": "90 .. 110 N*m"}, ["vary, torque = 120 N*m", "holds the nominal"]),
        ({"torque": "100 N*m"}, {"torque": "5 N*m"}, ["robust: torque"]),
    ],
)
def test_ranges_that_cannot_be_meant(vary: Mapping[str, Any], robust: Any, words: list[str]) -> None:
    with pytest.raises(synth.InputError) as fault:
        steps(vary, robust)
    assert all(word in str(fault.value) for word in words), str(fault.value)


def test_what_a_step_has_learned_holds_between_steps_as_well() -> None:
    found = steps({"torque": "90, 110 N*m"}, WIDE)
    (rater, _) = found.raters
    assert rater is not None

    def names() -> list[str]:
        question = found.one_best((100.0,), {"size": "min"}, 1e-5, {}, {})
        return [x.name for x in question.instance.model.limits]

    before = names()
    for share in (0.25, 0.75):
        found.learn(rater.uncertainty.with_scenarios({"hum": ((share,),)}))
    assert [n for n in names() if n not in before] == [f"hum (speed at {x} of its range)" for x in (0.25, 0.75)]
    assert [x.name for x in found.questions[0].instance.model.limits] == before
