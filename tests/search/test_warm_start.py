"""Designs of a similar question as ideas: what is taken from them, and that they prove nothing."""

from __future__ import annotations

import numpy as np
import pytest

import synth
from synth.results import Design
from synth.search.question import Question
from synth.search.warm_start import warm_start
from tests.asking import pose
from tests.sample_problems.strut import NEEDED, RODS, Strut

PROBLEM = Strut()
CATALOGS = {"rods": RODS}


def question(load: str = "20 kN", **more: object) -> Question:
    settings = {"catalogs": CATALOGS, "points": 4, "parts": {"plate": ["core 2", "core 1"]}, **more}
    return pose(PROBLEM, {**NEEDED, "load": load}, **settings)


@pytest.fixture(scope="module")
def designs() -> list[Design]:
    return question().answer().designs


def test_a_combination_is_found_by_its_parts_counts_and_choices(designs: list[Design]) -> None:
    instance = question("30 kN").instance
    for design in designs:
        number = instance.combinations.find(design)
        assert number is not None
        parts, counts, choices = instance.combinations.describe(number)
        assert {s: table.designations[row] for s, (table, row) in parts.items()} == {
            s: str(row) for s, row in design.parts.items()
        }
        assert counts == {"plates": design.values["plates"]}
        assert choices == dict(design.choices)


@pytest.mark.slow
@pytest.mark.parametrize(
    "more",
    [{"parts": {"material": ["odd"]}}, {"limits": {"plates": ">= 4"}}, {"fix": {"end": "hook"}}],
    ids=["part", "count", "choice"],
)
def test_what_is_not_offered_here_is_no_idea(designs: list[Design], more: dict[str, object]) -> None:
    instance = question(**{"parts": {}, **more}).instance
    gone = [d for d in designs if instance.combinations.find(d) is None]
    assert gone
    form = question(**{"parts": {}, **more}).search().state.form
    assert not warm_start(form, question().search().state.rule, gone, np.random.default_rng(0))
    assert len(form.archive) == 0


def test_ideas_are_solved_again_for_the_new_question(designs: list[Design]) -> None:
    heavier = question("90 kN")
    search = heavier.search().state
    assert warm_start(search.form, search.rule, designs, np.random.default_rng(0))
    known = search.form.archive
    fresh = heavier.answer().designs
    lightest = min(d.values["mass"] for d in fresh)
    assert np.exp(known.phi[:, 0].min()) == pytest.approx(lightest, rel=0.05)
    # What is put into the archive keeps the limits of this question, not of the one it comes from.
    result = search.form.points.evaluate(known.variables, known.combination)
    assert result.feasible.all()
    assert not search.form.points.evaluate(
        np.array([[d.values["width"], d.values["length"]] for d in designs]),
        np.array([heavier.instance.combinations.find(d) for d in designs]),
    ).feasible.all()


@pytest.mark.slow
def test_a_search_that_begins_with_ideas_proves_the_same(designs: list[Design]) -> None:
    fresh, helped = question("30 kN").answer(), question("30 kN").answer(known=designs)
    assert helped.certificate.kind == fresh.certificate.kind == "global"
    assert helped.verify().holds
    for name in ("mass", "flexibility"):
        best = [min(d.values[name] for d in front.designs) for front in (fresh, helped)]
        assert best[1] == pytest.approx(best[0], rel=1e-6)
    again = question("30 kN").answer(known=designs)
    assert [d.values for d in again.designs] == [d.values for d in helped.designs]


def test_bad_ideas_do_no_harm(designs: list[Design]) -> None:
    # Nothing of a light bar holds four times the load at that mass; nor is a problem without variables in the way.
    front = question("80 kN", limits={"mass": "<= 0.5 kg"}, parts={"material": ["soft", "hard"]}).answer(known=designs)
    assert front.status == synth.order.feasibility.Status.INFEASIBLE
    pinned = question(fix={"width": "60 mm", "length": "200 mm"})
    assert pinned.answer(known=designs).certificate.kind == "global"
