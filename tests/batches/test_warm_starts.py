"""Teachers of a job: who they are depends on what the rows ask alone, and what they tell proves nothing."""

from __future__ import annotations

import random
from collections.abc import Callable
from pathlib import Path

import pytest

import synth
from synth.batches.settings import BatchSettings, WarmStartSettings
from synth.batches.solve import LIKE
from synth.batches.store import Store
from synth.batches.warm_starts import WarmStarts, place
from synth.queue.database import digest
from tests.batches.asked import batch
from tests.sample_problems.rod import Rod

Question = tuple[str, tuple[float, ...], dict[str, int]]


def questions(count: int) -> list[Question]:
    return [(digest({"force": k}), place([10.0 + k, 5.0]), {"force": k}) for k in range(count)]


def taught(
    asked: list[Question], structure: Callable[[int], str] = lambda k: "rods", one_in: int = 10
) -> dict[int, tuple[str, int | None]]:
    """Return, per question, its key and whose experience it has."""
    own = WarmStarts(WarmStartSettings(one_in=one_in))
    for key, where, question in asked:
        own.show(structure(question["force"]), key, where, question)
    result = {}
    for key, where, question in asked:
        new, content, _ = own.taught(structure(question["force"]), key, where, question)
        result[question["force"]] = (new, content[LIKE]["force"] if LIKE in content else None)
    return result


def test_teachers_do_not_depend_on_the_order_of_rows() -> None:
    asked = questions(200)
    shuffled = list(asked)
    random.Random(0).shuffle(shuffled)
    assert taught(asked) == taught(shuffled)


def test_the_nearest_teacher_is_asked_and_asks_nobody() -> None:
    found = taught(questions(200))
    teachers = {k for k, (_, teacher) in found.items() if teacher is None}
    assert 5 < len(teachers) < 60
    for k, (key, teacher) in found.items():
        assert teacher is None or teacher in teachers
        if teacher is not None:
            assert abs(place([10.0 + teacher])[0] - place([10.0 + k])[0]) == pytest.approx(
                min(abs(place([10.0 + t])[0] - place([10.0 + k])[0]) for t in teachers)
            )
            assert key == digest({"force": k, LIKE: {"force": teacher}})


def test_only_questions_of_one_structure_teach_each_other() -> None:
    found = taught(questions(200), lambda k: "even" if k % 2 == 0 else "odd")
    assert all(teacher is None or (teacher - k) % 2 == 0 for k, (_, teacher) in found.items())


def test_without_a_teacher_a_question_stays_as_it_is() -> None:
    found = taught(questions(20), one_in=1 << 60)
    assert all(key == digest({"force": k}) and teacher is None for k, (key, teacher) in found.items())


@pytest.mark.slow
@pytest.mark.parametrize("points", [1, 5])
def test_rows_with_teachers_give_the_same_bytes_in_any_order_and_what_they_give_alone_to_the_gap(
    tmp_path: Path, points: int
) -> None:
    numbers = BatchSettings(warm_starts=WarmStartSettings(one_in=4))
    table = [
        {"id": f"R{k}", "force [kN]": 10 + k, "diameter_limit [mm]": 30 + k % 3}
        for k in range(24 if points == 1 else 12)
    ]
    shuffled = list(table)
    random.Random(1).shuffle(shuffled)
    objectives = ["mass"] if points == 1 else ["mass", "diameter"]
    settings = {"objectives": objectives, "points": points}
    first = batch(numbers, Rod, table, tmp_path / "first", **settings)
    other = batch(numbers, Rod, shuffled, tmp_path / "other", workers=2 if points == 1 else 1, **settings)
    assert (first.folder / "designs.csv").read_bytes() == (other.folder / "designs.csv").read_bytes()
    with Store(f"sqlite:///{first.folder / 'jobs.sqlite'}") as store:
        contents = [content for _, _, content in store.questions(first.job)]
    assert sum(LIKE in content for content in contents) > len(table) / 2
    designs = first.designs().set_index("id")
    for k in (0, 7, 11):
        alone = synth.synthesize(Rod, {"force": f"{10 + k} kN", "diameter_limit": f"{30 + k % 3} mm"}, **settings)
        least = min(d.objectives["mass"] for d in alone.designs)
        assert designs.loc[[f"R{k}"], "mass [kg]"].min() == pytest.approx(least, rel=1e-3)
        assert set(designs.loc[[f"R{k}"], "status"]) == {"optimal"}


def test_a_teacher_that_has_no_design_teaches_nothing() -> None:
    numbers = BatchSettings(warm_starts=WarmStartSettings(one_in=3))
    table = [{"force [kN]": 10 + k, "diameter_limit [mm]": 1 if k % 2 else 40} for k in range(20)]
    counts = batch(numbers, Rod, table, objectives=["mass"], points=1).counts
    assert counts == {"optimal": 10, "infeasible": 10}
