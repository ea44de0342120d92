"""What a study varies: how values are read, what they take the place of, and what is refused."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import synth
from synth.errors import InputError
from synth.studies.whatif.steps import Steps
from synth.studies.whatif.vary import Varied
from synth.verbs.requests import typed_vary
from tests.asking import steps_of
from tests.sample_problems.ropes import Ropes, ropes

TABLE = ropes((10, 2), (20, 1), (35, 0.5))
PROBLEM = Ropes()


def steps(vary: Any, requirements: Any = None, **more: Any) -> Steps:
    own = {"objectives": ["cost", "bulk"], **more}
    return steps_of(PROBLEM, requirements or {"load": "10 kN"}, vary, TABLE, **own)


def one(name: str, values: Any) -> Varied:
    (varied,) = steps({name: values}).varied
    return varied


# ---- texts of the command line --------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("text", "name", "values"),
    [
        ("load=1:2:1 kN", "load", "1:2:1 kN"),
        ("load = 1,2 kN", "load", "1,2 kN"),
        ("mass<=40:60:5 kg", "mass <=", "40:60:5 kg"),
        (" mass >= 40 kg ", "mass >=", "40 kg"),
        ("mass < 40 kg", "mass <", "40 kg"),
        ("mass == 40 kg", "mass ==", "40 kg"),
        ("parts.rope=rate > 2, rope a", "parts.rope", "rate > 2, rope a"),
        ("weights.cost=1:4:1", "weights.cost", "1:4:1"),
    ],
)
def test_a_text_is_split(text: str, name: str, values: str) -> None:
    assert typed_vary("--vary", [text]) == {name: values}


@pytest.mark.parametrize("text", ["", "load", "=5 kN", "load=", "load= ", "<= 5"])
def test_a_text_that_says_nothing_is_refused(text: str) -> None:
    with pytest.raises(InputError, match="--vary"):
        typed_vary("--vary", [text])


# ---- numbers --------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("values", "unit", "numbers"),
    [
        ("5:11:3 kN", "kN", (5, 8, 11)),
        ("5:10.9:3 kN", "kN", (5, 8)),
        ("5000:11000:3000 N", "N", (5000, 8000, 11000)),
        ("11:5:-3 kN", "kN", (11, 8, 5)),
        ("5 kN: 11 kN: 3 kN", "kN", (5, 8, 11)),
        ("1:2:0.1", "kN", (1, 1.1, 1.2, 1.3, 1.4, 1.5, 1.6, 1.7, 1.8, 1.9, 2)),
        ("7:7:1 kN", "kN", (7,)),
        ("7, 5, 6 kN", "kN", (7, 5, 6)),
        ("7,5,6 kN", "kN", (7, 5, 6)),
        ("7, 5 kN", "kN", (7, 5)),
        ("5 kN, 7 kN", "kN", (5, 7)),
        ("5000,7000 N", "N", (5000, 7000)),
        ("5000,7000, 9000 N", "N", (5000, 7000, 9000)),
        ("7.5,6 kN", "kN", (7.5, 6)),
        ("7 kN,5 kN", "kN", (7, 5)),
        ("7", "kN", (7,)),
        ("1e1, 2.5e+1 kN", "kN", (10, 25)),
        ([7, 5.5], "kN", (7, 5.5)),
        (["7 N*m/m", "5501 N*m/m"][1:], "N*m/m", (5501,)),
        (["700 N", "800 N"], "N", (700, 800)),
        (["700 N", 800], "N", (700, 800)),
        (("5 kN", "11 kN", 4), "kN", (5, 7, 9, 11)),
        (("11 kN", "5 kN", 2), "kN", (11, 5)),
        (("5 kN", "11 kN", "4"), "kN", (5, 11, 4)),
        (["7500 N.m/m", "5501 N*m/m"], "N*m/m", (7500, 5501)),
        ("2 1/2 kN, 3 3/4 kN", "kN", (2.5, 3.75)),
    ],
)
def test_values_of_a_requirement(values: Any, unit: str, numbers: Sequence[float]) -> None:
    varied = one("load", values)
    assert (varied.kind, varied.name, varied.sign, varied.unit) == ("requirement", "load", "", unit)
    assert varied.values == tuple(map(float, numbers))
    assert varied.numeric
    factor = {"kN": 1e3, "N": 1.0, "N*m/m": 1.0}[unit]
    for question, number in zip(steps({"load": values}).questions, numbers, strict=True):
        assert question.instance.values.requirements["load"] == pytest.approx(number * factor)


@pytest.mark.parametrize(
    ("values", "words"),
    [
        ("5:11 kN", ["from:to:step"]),
        ("5:11:3:1 kN", ["from:to:step"]),
        ("5:11:0 kN", ["a step that leads"]),
        ("5:11:-1 kN", ["a step that leads"]),
        ("11:5:1 kN", ["a step that leads"]),
        ("1:500:0.1 kN", ["at most 1000 steps"]),
        ("5 kN, 6 N", ["one unit", "kN and N"]),
        ("5, 6 kg", ["kg"]),
        ("5, many kN", ["numbers with one unit"]),
        ("5,, 6 kN", ["numbers with one unit"]),
        ("13/2, 7 kN", ["a fraction of whole numbers with its unit"]),
        ("", ["numbers with one unit"]),
        ("5, 6, 5.0 kN", ["each value once"]),
        ("60,5 kN", ["a decimal point for one number (60.5 kN)", "a blank", "for two values (60, 5 kN)"]),
        ("60,25", ["(60.25)", "(60, 25)"]),
        ("60,05kN", ["(60.05kN)", "(60, 05kN)"]),
        ("5,7 kN", ["(5.7 kN)", "(5, 7 kN)"]),
        ("1,500 kN", ["(1.500 kN)", "(1, 500 kN)"]),
        ("7,5, 8,5 kN", ["decimal points"]),
        ("1:2:1e-320 kN", ["at most 1000 steps"]),
        (("1 kN", "2 kN", 10**8), ["100000000 steps", "at most 1000 steps"]),
        (("1 kN", "2 kN", 10**400), ["at most 1000 steps"]),
        (range(10**8), ["values such as"]),
        ([5.0] * 1001, ["1001 steps", "at most 1000 steps"]),
        ("nan kN", ["numbers"]),
        ([], ["at least one value"]),
        ([True], ["true"]),
        ([float("inf")], ["inf"]),
        (["5 kN", None], ["missing"]),
        (5, ["values such as"]),
        (None, ["values such as"]),
        ((5, 11, 4), ["a list"]),
        (("5 kN", "11 kN", 1), ["at least 2"]),
        ("0.1:1:0.1 kN", ["load = 0.1 kN", "0.5 kN to 500 kN"]),
    ],
)
def test_values_that_cannot_be_meant(values: Any, words: Sequence[str]) -> None:
    with pytest.raises(InputError) as fault:
        steps({"load": values})
    assert all(word in str(fault.value) for word in ["load", *words]), str(fault.value)


@pytest.mark.slow
@given(st.integers(-50, 50), st.integers(1, 40), st.sampled_from(["0.1", "0.25", "3", "1e-3", "0.07"]))
@settings(deadline=None, derandomize=True, max_examples=60)
def test_a_range_ends_where_its_end_is_met(first: int, count: int, step: str) -> None:
    size = float(step)
    values = [round(first + k * size, 9) for k in range(count + 1)]
    for last in (values[-1], values[-1] + 0.4 * size):
        varied = one("weights.cost" if first >= 0 else "gain >=", f"{first}:{last!r}:{step}")
        assert varied.values == pytest.approx(values, abs=1e-9)
        assert [varied.shown(v) for v in varied.values] == [f"{v:.12g}" for v in values]


@pytest.mark.parametrize(
    ("name", "values", "remark"),
    [
        ("load", "5:11:3 kN", ""),
        ("load", "1:2:0.1", ""),
        ("load", "5, 8, 12 kN", ""),
        ("load", ("5 kN", "12 kN", 3), ""),
        ("load", "5:12:3 kN", "the steps end at 11 kN: 12 kN is no whole number of steps of 3 kN from 5 kN"),
        ("load", "12:5:-3", "the steps end at 6 kN: 5 kN is no whole number of steps of 3 kN from 12 kN"),
        ("weights.cost", "1:4:2", "the steps end at 3: 4 is no whole number of steps of 2 from 1"),
        ("cost <=", "50:60:4", "the steps end at 58: 60 is no whole number of steps of 4 from 50"),
        ("parts.rope", "rope a, rate > 1", ""),
    ],
)
def test_an_end_that_no_step_meets_is_told(name: str, values: Any, remark: str) -> None:
    assert one(name, values).remark == remark


# ---- what else may be varied ----------------------------------------------------------------------------------------


def test_kinds_and_how_they_are_called() -> None:
    for key, values, kind, label, stated in (
        ("F", "5, 6 kN", "requirement", "load", "load = 5 kN"),
        ("cost <=", "50, 60", "limit", "cost <=", "cost <= 50"),
        ("cost<", "50, 60", "limit", "cost <=", "cost <= 50"),
        ("strength >", "5, 6 kN", "limit", "strength >=", "strength >= 5 kN"),
        ("strands ==", "1, 2", "limit", "strands ==", "strands == 1"),
        ("weights.cost", "1, 2", "weight", "weights.cost", "weights.cost = 1"),
        ("parts.rope", "rope a, rate > 1", "part", "parts.rope", "parts.rope = rope a"),
        ("options.thick", "free, given", "option", "options.thick", "options.thick = free"),
    ):
        varied = one(key, values)
        assert (varied.kind, varied.label) == (kind, label)
        assert varied.text(varied.values[0]) == stated
        assert varied.numeric == (kind in ("requirement", "limit", "weight"))


@pytest.mark.parametrize(
    ("vary", "words"),
    [
        ("load=5", ["names with values"]),
        ({}, ["names with values"]),
        ({"load": "5 kN", "F": "6 kN"}, ["each thing once"]),
        ({"cost <=": "50", "cost <": "60"}, ["each thing once"]),
        ({"lod": "5 kN"}, ["lod", "did you mean load"]),
        ({"cost": "50"}, ["cost <="]),
        ({"strands": "1, 2"}, ["strands <=", "count"]),
        ({"rope": "rope a"}, ["parts.rope"]),
        ({"thick": "free"}, ["options.thick"]),
        ({"options.thick": "free, fat"}, ["fat", "free, makeable, given"]),
        ({"parts.rope": "rope a, rope a"}, ["each value once"]),
        ({"parts.rope": ""}, ["a word"]),
        ({"parts.rope": '"rope, x", rope b'}, ["parts.rope = rope, x"]),
        ({"parts.rope": [[]]}, ["a word"]),
        ({"parts.rope": 5}, ["words with commas"]),
        ({"parts.rope <=": "rope a"}, ["without <="]),
        ({"weights.gain": "1, 2"}, ["gain", "a chosen objective"]),
        ({"weights.cost": "-1, 2"}, ["weights.cost = -1"]),
        ({"load <=": "5 kN"}, ["load", "a quantity"]),
        ({"a b": "5"}, ["a b"]),
        ({"load": "1:40:1 kN", "share": "0.1:3:0.1"}, ["1200 steps", "at most 1000 steps"]),
        ({"parts.rope": ["rope a"] * 1001}, ["at most 1000 steps"]),
        ({"robust.load": "+-1:1e9:1 %"}, ["at most 1000 steps"]),
    ],
)
def test_what_cannot_be_varied(vary: Any, words: Sequence[str]) -> None:
    with pytest.raises(InputError) as fault:
        steps(vary)
    assert all(word in str(fault.value) for word in words), str(fault.value)


# ---- what takes the place of what -----------------------------------------------------------------------------------


def test_a_value_takes_the_place_of_what_was_said() -> None:
    by_symbol = steps({"load": "7 kN"}, {"F": "10 kN", "share": 2}).questions[0]
    assert by_symbol.instance.values.requirements["load"] == pytest.approx(7000)
    assert by_symbol.instance.values.requirements["share"] == 2
    unset = steps({"load": "7, 9 kN"}, {"share": 2})
    assert [q.instance.values.requirements["load"] for q in unset.questions] == pytest.approx([7000, 9000])
    weights = steps({"weights.bulk": "0.5, 4"}, weights={"cost": 3, "bulk": 7})
    assert [dict(q.weights) for q in weights.questions] == [{"cost": 3, "bulk": 0.5}, {"cost": 3, "bulk": 4}]
    parts = steps({"parts.rope": [["rope a", "rope c"]]}, parts={"rope": ["rope b"]})
    (question,) = parts.questions
    (slot,) = question.instance.selection.slots
    assert [slot.table.designations[r] for r in slot.rows] == ["rope a", "rope c"]
    option = steps({"options.thick": "given, makeable", "load": "5 kN"})
    assert [q.instance.problem.options for q in option.questions] == [{"thick": "given"}, {"thick": "makeable"}]


@pytest.mark.parametrize(
    ("limits", "vary", "kept"),
    [
        ({"cost": "<= 100"}, "cost <=", []),
        ({"cost": ">= 10"}, "cost <=", [("at_least", 10)]),
        ({"cost": "10 .. 100"}, "cost <=", [("at_least", 10)]),
        ({"cost": "10 .. 100"}, "cost >=", [("at_most", 100)]),
        ({"cost": ["<= 100", ">= 10"]}, "cost >=", [("at_most", 100)]),
        ({"cost": "< 100", "gain": ">= 2"}, "cost <=", [("at_least", 2)]),
    ],
)
def test_a_limit_leaves_those_that_point_another_way(limits: Any, vary: str, kept: list[tuple[str, float]]) -> None:
    study = steps({vary: "40, 50"}, limits=limits)
    sense = "at_most" if "<" in vary else "at_least"
    for (value,), question in zip(study.values, study.questions, strict=True):
        extra = [(x.sense, x.bound) for x in question.instance.limits.judging]
        assert isinstance(value, float)
        assert sorted(extra) == sorted([*kept, (sense, value)])


def test_the_best_of_one_objective_among_given_parts() -> None:
    study = steps({"load": "5, 15 kN"}, weights={"cost": 2}, parts={"rope": ["rope a", "rope b"]})
    question = study.one_best((15.0,), {"cost": "min"}, 1e-5, {"rope": ["rope c"]}, {"strands": 2.0, "end": "clamp"})
    assert question.instance.combinations.count == 1
    assert question.settings.gap == 1e-5
    assert dict(question.chosen) == {"cost": "min"}
    (design,) = question.answer().designs
    assert design.values["cost"] == pytest.approx(35 * 2 * 1.5 + 0.5 * 15, rel=1e-4)
    assert study.one_best((15.0,), {"cost": "min"}, 1e-5, {}, {}).instance.combinations.count == 2 * 3 * 2


def test_a_fault_of_all_steps_is_no_matter_of_the_values() -> None:
    with pytest.raises(synth.InputError) as fault:
        steps({"load": "5, 15 kN"}, {"shre": 2})
    assert "vary" not in str(fault.value)
    with pytest.raises(synth.InputError, match="vary, load = 450 kN: heavy"):
        steps({"load": "5, 450 kN"})
