"""What is asked of any family is the same after it was written as JSON and read again."""

from __future__ import annotations

import json
from dataclasses import replace
from functools import cache
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import synth
from synth.errors import InputError
from synth.question.catalogs import as_catalogs
from synth.question.request import Request
from synth.question.settings import SearchSettings
from synth.search.question import Question, pose
from synth.units import Quantity, from_si, typed_quantity
from tests.conformance.cases import CASES

SETTINGS = st.builds(
    SearchSettings,
    points=st.integers(1, 500),
    gap=st.floats(1e-6, 0.5),
    workers=st.integers(1, 1024),
    seed=st.integers(0, 2**64 - 1),
    time_limit=st.none() | st.floats(1e-3, 1e6),
)


@cache
def loaded(family: str, *options: tuple[str, str]) -> synth.DesignProblem:
    return synth.load(family, **dict(options))


@st.composite
def requests(draw: st.DrawFn, family: str) -> Request:
    """Draw what somebody may ask of a family; most of it can be asked."""
    data = CASES[family]
    case = draw(st.sampled_from([*data.feasible.values(), data.infeasible]))
    problem = loaded(family, *sorted(case.options.items()))
    tables = as_catalogs(None)
    model = problem.model(frozenset(), tables)
    d = model.declaration
    requirements: dict[str, Any] = dict(case.requirements)
    for word in case.requirements:  # the same are given: each problem is traced once
        r = d.requirements[d.names()[word]]
        if np.isfinite([r.lower, r.upper]).all() and draw(st.booleans()):
            si = draw(st.floats(r.lower, r.upper))
            ways = [Quantity(si, r.unit), typed_quantity(si, r.unit), np.float64(from_si(si, r.unit))]
            requirements[word] = draw(st.sampled_from(ways))
    quantities = draw(st.lists(st.sampled_from(list(model.quantity_sx)), max_size=2, unique=True))
    limits = {
        name: draw(st.sampled_from([f"<= {bound} {model.units[name]}", [f">= {bound / 9} {model.units[name]}"]]))
        for name in quantities
        for bound in [draw(st.floats(1e-3, 1e6))]
    }
    counts = {n: np.unique(draw(st.lists(st.sampled_from(c.values.tolist()), min_size=1))) for n, c in d.counts.items()}
    slot = draw(st.sampled_from(list(d.slots)))
    rows = list(tables.table(d.slots[slot].table).designations)
    block = {"tolerance": {n: "+-1 %" for n in list(d.variables)[:1]}, "samples": 64} if d.variables else None
    return Request.of(
        problem,
        requirements,
        objectives=draw(st.sampled_from([None, *d.objectives, dict.fromkeys(list(d.objectives)[:2], "min")])),
        limits={**case.settings.get("limits", {}), **limits},
        fix={**case.settings.get("fix", {}), **draw(st.sampled_from([{}, counts]))},
        parts={**case.settings.get("parts", {}), slot: tuple(rows[: draw(st.integers(1, len(rows)))])},
        weights=draw(st.sampled_from([{}, {next(iter(d.objectives)): 2}])),
        robust=draw(st.sampled_from([None, block])),
        grid=draw(st.booleans()),
    )


def posed(request: Request) -> Question | str:
    try:
        return pose(replace(request, robust=None), SearchSettings())
    except InputError as error:
        return str(error)


@pytest.mark.slow
@pytest.mark.parametrize("family", CASES)
@settings(max_examples=8, deadline=None)
@given(st.data())
def test_a_request_is_read_again_as_it_was(family: str, data: st.DataObject) -> None:
    request = data.draw(requests(family))
    content = request.to_json()
    again = Request.from_json(json.loads(json.dumps(content, allow_nan=False)), problem=request.problem)
    assert again.to_json() == content
    assert (again.grid, again.robust, again.weights) == (request.grid, request.robust, request.weights)
    first, second = posed(request), posed(again)
    if isinstance(first, str) or isinstance(second, str):
        assert first == second
        return
    assert first.record() == second.record()
    assert first.chosen == second.chosen
    one, two = first.instance, second.instance
    assert one.values.requirements == two.values.requirements
    assert one.problem.name == two.problem.name
    for end in ("lower", "upper", "pinned"):
        assert np.array_equal(getattr(one.ranges, end), getattr(two.ranges, end))
    assert [x.name for x in one.constraints] == [x.name for x in two.constraints]
    assert one.combinations.count == two.combinations.count


@pytest.mark.parametrize("family", CASES)
def test_a_request_names_its_family_and_options(family: str) -> None:
    for case in (*CASES[family].feasible.values(), CASES[family].infeasible):
        content = {"family": family, "options": dict(case.options), "requirements": dict(case.requirements)}
        again = Request.from_json(content)
        assert (again.problem.name, again.problem.options) == (family, dict(case.options))
        assert again.to_json() == {**{k: v for k, v in content.items() if v}, "grid": True}


@given(SETTINGS)
def test_settings_are_read_again_as_they_were(asked: SearchSettings) -> None:
    content = json.loads(json.dumps(asked.to_json()))
    assert SearchSettings.from_json(content) == asked
    # One body may hold both, what is asked and how it is searched.
    whole = {**content, "family": "disc_clutch", "requirements": {"load_torque": "1 N*m"}}
    assert SearchSettings.from_json(whole) == asked
    assert Request.from_json(whole).requirements == {"load_torque": "1 N*m"}
