"""Fronts of questions searched as one: each design stands against those of the question alone, and against verify."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import cache
from typing import Any

import numpy as np
import pytest

import synth
from synth.order.feasibility import Status
from synth.results import Design, ParetoFront
from synth.search.joint.joint_fronts import JointFrontSearch, joint_answers, joint_groups
from synth.search.joint.joint_search import JointSearch
from synth.search.question import Question
from synth.search.settings import TUNING
from synth.system.deadline import Stopped
from synth.tables.catalogs import Catalogs
from tests.asking import pose
from tests.repetitions import repetitions
from tests.sample_problems.ropes import Ropes, ropes
from tests.sample_problems.strut import RODS, Strut
from tests.tuned import tuned

GAP = 1e-3
BOTH = ("mass", "flexibility")
STRUT, TABLES = Strut(), Catalogs({"rods": RODS})
CLUTCH: dict[str, Any] = {
    "driver_speed": "26.6 rad/s",
    "driven_inertia": "30 kg*m2",
    "engagements_per_hour": "50 1/h",
    "jerk_limit": "18 rad/s3",
}
SOME = {
    "friction_pair": ["graphitic_wet", "cork_wet", "paper_wet"],
    "inner_plate": ["core 1", "core 2"],
    "outer_plate": ["core 1", "core 2"],
}


def struts(points: int, *loads: float, objectives: Sequence[str] = BOTH, **more: Any) -> list[Question]:
    asked = {"parts": {"plate": ["core 1", "core 2", "core 3.5"]}, "gap": GAP, **more}
    return [
        pose(STRUT, {"load": f"{load} kN", "room": "90 mm"}, list(objectives), points, TABLES, **asked)
        for load in loads
    ]


def clutches(points: int, objectives: Sequence[str], *torques: float) -> list[Question]:
    return [
        pose(
            synth.load("multi_plate_clutch", practice="off"),
            {**CLUTCH, "load_torque": f"{t} N*m"},
            list(objectives),
            points,
            parts=SOME,
        )
        for t in torques
    ]


@cache
def answered(points: int, objectives: tuple[str, str]) -> tuple[list[Question], list[ParetoFront | None]]:
    questions = clutches(points, objectives, 450, 500, 600)
    return questions, JointFrontSearch(questions).answers()


@cache
def answered_alone(points: int, objectives: tuple[str, str]) -> list[ParetoFront]:
    return [question.answer() for question in answered(points, objectives)[0]]


def check_front(question: Question, front: ParetoFront, alone: ParetoFront) -> None:
    """Check what a front says of itself, and its designs against the front of the question alone."""
    names, points = list(question.chosen), question.settings.points
    assert len(front.designs) == points
    assert (front.status, front.complete, front.certificate.kind) == (Status.OPTIMAL, False, "global")
    assert front.certificate.gap == question.settings.gap
    certificate, statistics = front.certificate, front.statistics
    assert certificate.combinations == question.instance.combinations.count
    assert certificate.excluded_by_bound + certificate.solved == certificate.combinations
    assert statistics["nlp_solves_to_find"] <= statistics["nlp_solves"]
    assert [d.rank for d in front.designs] == list(range(1, points + 1))
    assert sorted(d.score for d in front.designs) == [d.score for d in front.designs]
    assert {f"smallest {n}" for n in names} <= {w for d in front.designs for w in d.note.split("; ")}
    found = np.array([[d.values[n] for n in names] for d in front.designs])
    assert alone.certificate.kind == "global"
    other = np.array([[d.values[n] for n in names] for d in alone.designs])
    assert found.min(axis=0) == pytest.approx(other.min(axis=0), rel=2 * GAP)
    for row in found:
        assert not np.any(np.all(other < row * (1 - 1.01 * GAP), axis=1)), "beaten by more than the gap"
        assert not np.any(np.all(found <= row, axis=1) & np.any(found < row, axis=1)), "beaten by its neighbour"
    for design in front.designs:
        assert (design.status, design.gap) == (Status.OPTIMAL, question.settings.gap)
        assert set(design.elasticity) <= set(names)


# ---- against the questions alone ------------------------------------------------------------------------------------


@pytest.mark.slow
@pytest.mark.parametrize("points", [2, 3, 5, TUNING.joint.front_points])
@pytest.mark.parametrize("grid", [True, False])
def test_fronts_of_struts_stand_against_those_asked_alone(points: int, grid: bool) -> None:
    questions = struts(points, 10, 17, 30, 44, grid=grid)
    answers = JointFrontSearch(questions).answers()
    for question, front in zip(questions, answers, strict=True):
        assert front is not None
        check_front(question, front, question.answer(known=front.designs))
        assert front.verify().holds
        assert front.statistics["searched_together"] == 4


@pytest.mark.slow
@pytest.mark.parametrize(
    ("points", "objectives"),
    [(6, ("mass", "actuation_force")), (3, ("mass", "actuation_force")), (4, ("outer_diameter", "mass"))][
        : repetitions(1, 3)
    ],
)
def test_fronts_of_clutches_stand_against_those_asked_alone(points: int, objectives: tuple[str, str]) -> None:
    questions, answers = answered(points, objectives)
    for question, front, alone in zip(questions, answers, answered_alone(points, objectives), strict=True):
        assert front is not None
        check_front(question, front, alone)
    assert answers[0] is not None
    assert answers[0].verify().holds


@pytest.mark.slow
def test_designs_spread_over_the_front() -> None:
    asked = 6, ("mass", "actuation_force")
    for front, alone in zip(answered(*asked)[1], answered_alone(*asked), strict=True):
        assert front is not None
        widest = [_widest(designs) for designs in (front.designs, alone.designs)]
        assert widest[0] < 2 * widest[1]


def _widest(designs: Sequence[Design]) -> float:
    """Return the largest step between neighbours, where the front is one wide and one high, in logarithms."""
    logs = np.log([[d.values["mass"], d.values["actuation_force"]] for d in designs])
    unit = (logs - logs.min(axis=0)) / np.ptp(logs, axis=0)
    return float(np.linalg.norm(np.diff(unit[np.argsort(unit[:, 0])], axis=0), axis=1).max())


@pytest.mark.slow
def test_the_ends_have_the_elasticities_that_they_have_alone() -> None:
    asked = 3, ("mass", "actuation_force")
    for question, front, own in zip(*answered(*asked), answered_alone(*asked), strict=True):
        assert front is not None
        for name in question.chosen:
            one, other = (min(f.designs, key=lambda d: d.values[name]) for f in (front, own))
            for target, by in other.elasticity.items():
                assert one.elasticity[target].keys() == by.keys()
                assert one.elasticity[target] == pytest.approx(by, abs=0.02)


# ---- what is better asked alone -------------------------------------------------------------------------------------


def test_a_front_with_fewer_designs_is_left_to_be_asked_alone() -> None:
    four = ropes((10, 2), (20, 1), (35, 0.5), (5, 4), most=[100, 200, 400, 20])
    questions = [pose(Ropes(thick="given"), {"load": f"{v} kN"}, ["cost", "bulk"], 6, four) for v in (4, 19, 34)]
    assert JointFrontSearch(questions).answers() == [None] * 3
    # Of two ends there are as many as are asked for.
    pairs = [pose(Ropes(thick="given"), {"load": f"{v} kN"}, ["cost", "bulk"], 2, four) for v in (4, 19, 34)]
    pairs_answered = JointFrontSearch(pairs).answers()
    assert [front is not None for front in pairs_answered] == [len(q.answer().designs) > 1 for q in pairs]
    assert any(pairs_answered)
    for question, front in zip(pairs, pairs_answered, strict=True):
        if front is not None:
            check_front(question, front, question.answer())


def test_where_one_design_is_best_in_both_there_is_no_front() -> None:
    two = ropes((10, 2), (20, 1))
    questions = [pose(Ropes(thick="given"), {"load": f"{v} kN"}, ["cost", "bulk"], 2, two) for v in (40, 60)]
    assert JointFrontSearch(questions).answers() == [None, None]
    assert [len(q.answer().designs) for q in questions] == [1, 1]


def test_objectives_that_may_be_zero_are_left_to_be_asked_alone() -> None:
    two = ropes((10, 2), (20, 1), (35, 0.5))
    questions = [pose(Ropes(), {"load": f"{v} kN"}, ["loss", "bulk"], 2, two) for v in (4, 19)]
    assert JointFrontSearch(questions).answers() == [None, None]


def test_infeasible_questions_are_left_to_be_asked_alone() -> None:
    weak: dict[str, Any] = {"parts": {"plate": ["core 1"], "material": ["soft"]}}
    questions = struts(2, 10, 89, 15, **weak)
    answers = JointFrontSearch(questions).answers()
    assert [front is not None for front in answers] == [bool(q.answer(explained=False).designs) for q in questions]
    assert [front is not None for front in answers] == [True, False, True]
    assert JointFrontSearch(struts(3, 85, 88, **weak)).answers() == [None] * 2


def test_of_questions_that_are_the_same_one_is_answered() -> None:
    answers = JointFrontSearch(struts(3, 20, 20, 30)).answers()
    assert sum(front is not None for front in answers) == 2


# ---- groups, limits of time, repeatability --------------------------------------------------------------------------


def test_few_designs_of_two_objectives_are_searched_together() -> None:
    def groups(*questions: Question) -> list[list[int]]:
        return joint_groups(questions)

    one = struts(5, 10, 20, objectives=("mass",))
    assert groups(*one) == [[0, 1]]
    assert groups(*struts(2, 10, 20, 30)) == [[0, 1, 2]]
    assert groups(*struts(TUNING.joint.front_points, 10, 20)) == [[0, 1]]
    assert (
        groups(*struts(TUNING.joint.front_points + 1, 10, 20))
        == groups(*struts(1, 10, 20))
        == groups(*struts(3, 10))
        == []
    )
    assert groups(*struts(3, 10, 20, objectives=(*BOTH, "width"))) == []
    assert groups(*struts(3, 10), *struts(4, 20), *struts(3, 30), *one) == [[3, 4], [0, 2]]
    assert groups(*struts(3, 10), *struts(3, 20, gap=0.01)) == []


def test_there_are_numbers_for_every_level_of_every_question() -> None:
    combinations = struts(3, 10, 20)[0].instance.combinations.count
    numbers = TUNING.joint.places * TUNING.joint.levels * combinations
    assert joint_groups(struts(3, 10, 20, tuning=tuned(joint={"numbers": numbers}))) == [[0, 1]]
    assert joint_groups(struts(3, 10, 20, tuning=tuned(joint={"numbers": numbers - 1}))) == []


def test_answers_are_those_of_the_kind_of_question() -> None:
    one, two = struts(1, 10, 20, objectives=("mass",)), struts(3, 10, 20)
    assert _told(joint_answers(one)) == _told(JointSearch(one).answers())
    assert _told(joint_answers(two)) == _told(JointFrontSearch(two).answers())


@pytest.mark.slow
def test_the_same_questions_have_the_same_answers_with_any_number_of_threads() -> None:
    questions, answers = answered(3, ("mass", "actuation_force"))
    threaded = [replace(q, settings=replace(q.settings, workers=2)) for q in questions]
    assert _told(JointFrontSearch(threaded).answers()) == _told(answers)


def _told(answers: Sequence[ParetoFront | None]) -> list[list[tuple[Mapping[str, float], str]]]:
    return [[(d.values, d.note) for d in f.designs] if f else [] for f in answers]


def test_time_that_is_over_stops_the_search() -> None:
    with pytest.raises(Stopped, match="time limit"):
        JointFrontSearch(struts(3, 10, 20), time_limit=0).answers()


@pytest.mark.slow
def test_a_study_asks_for_three_designs_of_each_step_together() -> None:
    study = synth.whatif(
        synth.load("multi_plate_clutch", practice="off"),
        {**CLUTCH, "load_torque": "600 N*m"},
        {"load_torque": "450, 500, 560 N*m"},
        parts=SOME,
        breaks=False,
    )
    assert [len(front.designs) for front in study.fronts] == [3, 3, 3]
    assert [front.statistics["searched_together"] for front in study.fronts] == [3, 3, 3]
    assert [step.status for step in study.steps] == [Status.OPTIMAL] * 3
