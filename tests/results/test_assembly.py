"""How fronts are put together: rank, status, and statistics that are typed and read like a dictionary."""

from __future__ import annotations

import copy
import json
import pickle
from dataclasses import replace
from typing import Any

import pytest
from msgspec import structs

import synth
from synth.order.pareto import rank
from synth.results import ParetoFront
from synth.results.assembly import front_of, ranked
from synth.results.design import PartRow
from synth.results.ratings import RatingCounts
from synth.results.record import UNSET
from synth.results.statistics import SearchStatistics
from tests.sample_problems.strut import NEEDED, RODS, Strut


@pytest.fixture(scope="module")
def front() -> ParetoFront:
    return synth.synthesize(Strut(), NEEDED, catalogs={"rods": RODS}, points=5)


def test_designs_are_ranked_as_the_search_has_ranked_them(front: ParetoFront) -> None:
    chosen, mixed = dict(front.frame.objectives), front.designs[::-1]
    blank = [replace(d, rank=None, score=None, note="") for d in mixed]
    order, designs = ranked(blank, chosen, [1.0] * len(chosen), front.complete, front.scale)
    assert designs == front.designs
    assert [mixed[k] for k in order] == front.designs
    assert ranked([], chosen, [1.0, 1.0]) == ([], [])
    heavy = ranked(front.designs, chosen, [0.0, 1.0])[1]
    by_hand = rank(chosen, [[d.values[n] for n in chosen] for d in front.designs], [0.0, 1.0])  # type: ignore[arg-type]
    assert [d.score for d in heavy] == [by_hand.scores[k] for k in by_hand.order]


@pytest.mark.parametrize(
    ("kind", "any_design", "interrupted", "status"),
    [
        ("global", True, "", "optimal"),
        ("exhaustive", True, "", "feasible"),
        ("heuristic", True, "time limit", "feasible"),
        ("global", False, "", "infeasible"),
        ("heuristic", False, "", "not_found"),
        ("exhaustive", False, "", "not_found"),
        ("heuristic", False, "time limit", "not_solved"),
    ],
)
def test_the_status_follows_from_designs_and_proof(
    front: ParetoFront, kind: str, any_design: bool, interrupted: str, status: str
) -> None:
    certificate = replace(front.certificate, kind=kind)
    made = front_of(
        front.question,
        front.frame,
        front.designs if any_design else [],
        certificate,
        front.statistics,
        front.settings,
        complete=True,
        interrupted=interrupted,
    )
    assert made.status.value == status
    assert made.complete == (not interrupted)


def test_statistics_have_names_and_keys(front: ParetoFront) -> None:
    told = front.statistics
    assert told.combinations == told["combinations"] == front.certificate.combinations
    assert told.robust is UNSET
    assert "robust" not in told
    assert told.get("robust", "none") == "none"
    assert list(told) == [f.name for f in structs.fields(told) if f.name in told]
    assert told == dict(told)
    assert {**told, "mine": 1}["mine"] == 1
    more = structs.replace(told, robust=RatingCounts(searches=1), nlp_solves_to_find=None)
    assert (more["robust"], more["nlp_solves_to_find"]) == ({"searches": 1}, None)
    assert {**told, "robust": more.robust, "nlp_solves_to_find": None} == more


def test_statistics_go_through_files_and_processes(front: ParetoFront) -> None:
    told = front.statistics
    assert SearchStatistics.from_json(json.loads(json.dumps(told.to_json()))) == told
    for again in (pickle.loads(pickle.dumps(told)), copy.copy(told), copy.deepcopy(told)):
        assert type(again) is SearchStatistics
        assert again == told
        assert again.boxes == told.boxes
    foreign = SearchStatistics.from_json({"boxes": 3, "of another version": [1], "nlp_solves_to_find": None})
    assert foreign == {"boxes": 3, "nlp_solves_to_find": None}
    assert (foreign.boxes, foreign.nlp_solves_to_find, foreign.combinations) == (3, None, UNSET)


@pytest.mark.parametrize(
    "change", [lambda x: x.__setitem__("boxes", 1), lambda x: x.__delitem__("boxes"), lambda x: setattr(x, "boxes", 1)]
)
def test_statistics_cannot_be_changed(front: ParetoFront, change: Any) -> None:
    before = dict(front.statistics)
    with pytest.raises((TypeError, AttributeError)):
        change(front.statistics)
    assert front.statistics == before


def test_designs_of_the_same_parts_that_hardly_differ_are_a_group(front: ParetoFront, tmp_path: Any) -> None:
    first = next(d for d in front.designs if d.parts)
    names, near = list(front.frame.objectives), []
    for share in (1.0, 1.01, 1.03, 1.015):
        values = {**first.values, **{n: share * first.values[n] for n in names}}
        near.append(replace(first, values=values, objectives={n: values[n] for n in names}))
    other = {slot: replace_row(row) for slot, row in first.parts.items()}
    near.append(replace(near[1], parts=other))
    order, designs = ranked(near, {n: "min" for n in names}, [1.0] * len(names))
    assert order == [0, 1, 4, 3, 2]
    assert [d.group for d in designs] == [None, 1, None, 1, None]
    assert [d.group for d in ranked([designs[1], designs[4]], {n: "min" for n in names}, [1.0] * len(names))[1]] == [
        None,
        1,
    ]
    saved = synth.load_front(replace(front, designs=designs).save(tmp_path / "front"))
    assert [d.group for d in saved.designs] == [d.group for d in designs]


def replace_row(row: Any) -> Any:
    """Return the row of a part under another designation."""
    return PartRow(row["table"], row["hash"], {**row, "designation": "another"})
