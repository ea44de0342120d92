"""The design that comes first: the same however many are listed, and the nearest to the ideal that there is."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

import synth
from synth.order.pareto import NEAR, rank, senses_of
from synth.question.spec import read_spec
from synth.search.front_state import FrontState
from synth.search.settings import TUNING
from synth.search.stages.first_by_rank import find_first
from synth.search.synthesize import find_front
from tests.asking import pose
from tests.repetitions import repetitions

EXAMPLES = [
    path
    for path in sorted((Path(__file__).parents[2] / "examples").glob("*.yaml"))
    if read_spec(path).values is None and not read_spec(path).compares
]
POINTS = (3, 6, 20, 30, 100) if repetitions(0, 1) else (3, 6, 20)
EQUAL = 1e-3  # relative; half of what a gap lets two designs differ by


@pytest.mark.slow
@pytest.mark.parametrize("example", EXAMPLES, ids=lambda path: path.stem)
def test_the_first_design_of_an_example_is_the_same_however_many_are_asked_for(example: Path) -> None:
    first: list[list[float]] = []
    for points in POINTS:
        asked = read_spec(example).merged(points=points)
        front = find_front(asked.request(), asked.settings())
        first.append([front.designs[0].values[name] for name in front.frame.objectives])
    assert np.allclose(first, first[0], rtol=EQUAL, atol=0.0), first


QUICK = ["cone_drive", "automobile_disc", "wrap_spring_freewheel"]
SCATTERED = {"cone_drive": {"friction": "catalogue range"}, "automobile_disc": {"load_torque": "+-10 %"}}


@pytest.mark.slow
@pytest.mark.parametrize(("name", "robust"), [*((name, None) for name in QUICK), *SCATTERED.items()])
def test_the_first_design_is_the_same_from_few_points_to_many(name: str, robust: Mapping[str, str] | None) -> None:
    (example,) = (path for path in EXAMPLES if path.stem == name)
    first: list[list[float]] = []
    for points in (3, 6, 20, 100):
        asked = read_spec(example).merged(points=points, robust=robust)
        front = find_front(asked.request(), asked.settings())
        first.append([front.designs[0].values[name] for name in front.frame.objectives])
    assert np.allclose(first, first[0], rtol=EQUAL, atol=0.0), first


@pytest.mark.slow
def test_the_first_design_of_shipped_families_is_the_same_from_few_points_to_many() -> None:
    families = [{"family": "disc_clutch", "parts": {"friction_pair": ["moulded_dry", "woven_dry"]}}, "roller_coupling"]
    duty = {"load_torque": "200 N*m", "driver_speed": "700 1/min", "driven_inertia": "2 kg*m2"}
    first: list[list[float]] = []
    for points in (3, 6, 20, 100):
        found = synth.compare(families, duty, ["mass", "outer_diameter"], points, fix={"ramp_time": "0.3 s"})
        first.append(list(found.designs[0].objectives.values()))
    assert np.allclose(first, first[0], rtol=EQUAL, atol=0.0), first


# ---- beside brute force ---------------------------------------------------------------------------------------------


def lattice(rows: Sequence[Sequence[float]], senses: Mapping[str, str]) -> synth.DesignProblem:
    """Return a problem whose designs are some points, one per count."""

    class Lattice(synth.DesignProblem):
        name = "lattice"

        def declare(self, d: synth.Declaration) -> None:
            n = d.count("number", 1, len(rows))
            for k, (name, sense) in enumerate(senses.items()):
                value = rows[-1][k]
                for j, row in enumerate(rows[:-1]):
                    value = np.where(n == j + 1, row[k], value)
                d.derive(name, "-", value + 0 * n)
                d.objective(name, sense)

    return Lattice()


def scores_by_hand(rows: np.ndarray, senses: Mapping[str, str], weights: Sequence[float]) -> np.ndarray:
    """Scores of all points: ratios to the best, or ln 2 at what an objective costs for another to be nearly best."""
    signed = rows * senses_of(senses)
    best, worst = signed.min(axis=0), np.array([-np.inf] * len(senses))
    ends = [np.min([row for row in signed if row[k] == best[k]], axis=0) for k in range(len(senses))]
    for k in range(len(senses)):
        room = NEAR * (best[k] if best[k] > 0 else max(end[k] for end in ends) - best[k])
        worst[k] = max(worst[k], best[k] + room)
        as_good = [row for row in signed if row[k] <= best[k] + room]
        for j in range(len(senses)):
            worst[j] = max(worst[j], min(row[j] for row in as_good))
    share = np.array(weights) / sum(weights)
    units = np.where(worst > best, np.maximum(signed - best, 0) / np.where(worst > best, worst - best, 1), 0)
    for k in np.flatnonzero((best > 0) | (worst < 0)):
        units[:, k] = np.abs(np.log(np.maximum(signed[:, k] / best[k], 1e-9))) / np.log(2)
    return np.log(2) * np.sqrt(units**2 @ share)


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(repetitions(4, 60)))
@pytest.mark.parametrize("count", [2, 3])
def test_the_first_design_is_the_nearest_to_the_ideal(seed: int, count: int) -> None:
    rng = np.random.default_rng(seed)
    senses = {f"objective_{k}": "min" if seed % 3 or k else "max" for k in range(count)}
    weights = [1.0, 1.0, 1.0][:count] if seed % 2 else list(rng.uniform(0.2, 3.0, count))
    shift = 0.0 if seed % 4 == 3 else 1.0  # without it objectives are small, and may be next to nothing
    rows = np.round(shift + rng.random((60, count)) ** 3, 4)
    problem, scores = lattice(rows.tolist(), senses), scores_by_hand(rows, senses, weights)
    for points in (count + 1, 8, 60):
        front = synth.synthesize(problem, {}, points=points, weights=dict(zip(senses, weights, strict=True)))
        first = [front.designs[0].values[name] for name in senses]
        own = scores[np.argmin(np.abs(rows - first).sum(axis=1))]
        if shift:  # what may be next to nothing is told apart by a share of the range alone, ends too
            assert own <= scores.min() * (1 + 2 * TUNING.tree.first_share)
        assert front.verify(problem).holds


def test_an_end_that_costs_much_for_little_is_not_first_and_is_told_to() -> None:
    rows = [(1.0, 40.0), (1.0004, 7.0), (1.2, 5.0), (1.5, 4.0), (1.45, 4.6)]
    front = synth.synthesize(lattice(rows, {"diameter": "min", "mass": "min"}), {}, points=10)
    assert [front.designs[0].values[n] for n in ("diameter", "mass")] == pytest.approx([1.2, 5.0])
    dear = next(d for d in front.designs if d.values["mass"] > 30)
    assert dear.note == "smallest diameter, whose last 0.5 % costs much"
    assert dear.rank == len(front.designs)
    told = front.scale.as_record(front.frame.objectives)  # type: ignore[union-attr]
    assert told["mass"] == pytest.approx([4.0, 7.0])


class Row(synth.DesignProblem):
    """A design is a row of a table."""

    name = "row"

    def declare(self, d: synth.Declaration) -> None:
        part = d.part("part", "rows")
        for name in ("diameter", "mass"):
            d.derive(name, "-", getattr(part, name))
            d.objective(name)


def test_the_ends_are_best_in_the_other_objective_too_whatever_was_known() -> None:
    # Of equal ends the worse is known, and much that is almost as good is better than either.
    rows = [(1.0, 40.0), (1.0, 12.0), *((1.004, mass) for mass in np.linspace(7.0, 11.9, 3000)), (1.5, 4.0), (1.8, 4.0)]
    table = pd.DataFrame(rows, columns=["diameter [-]", "mass [-]"])
    table.insert(0, "designation", [f"row {k}" for k in range(len(rows))])
    state = FrontState(pose(Row(), {}, points=6, catalogs={"rows": table}).search().state.task)
    state.set_pool()
    form, worse = state.form, np.array([0, len(rows) - 1])
    nowhere = np.zeros((2, 0))
    form.archive.add(worse, nowhere, form.points.feasible_rows(nowhere, worse)[1])
    find_first(state, [1.0, 1.0])
    known = set(form.archive.combination.tolist())
    assert {1, 2, len(rows) - 2} <= known
    assert not known & set(worse.tolist())


def test_a_front_that_is_saved_is_ranked_again_by_its_own_scale(tmp_path: Path) -> None:
    rows = [(1.0, 40.0), (1.0004, 7.0), (1.2, 5.0), (1.5, 4.0)]
    problem = lattice(rows, {"diameter": "min", "mass": "min"})
    front = synth.synthesize(problem, {}, points=4)
    again = synth.load_front(front.save(tmp_path / "front"))
    assert again.scale is not None
    assert again.scale.as_record(again.frame.objectives) == front.scale.as_record(front.frame.objectives)  # type: ignore[union-attr]
    values = np.array([[d.values[n] for n in again.frame.objectives] for d in again.designs])
    ranking = rank(again.frame.objectives, values, [1.0, 1.0], scale=again.scale)
    assert ranking.order == list(range(len(again.designs)))
    assert ranking.scores.tolist() == [d.score for d in again.designs]
