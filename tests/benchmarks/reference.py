"""Make a reference front again: ``python -m tests.benchmarks.reference --size 6k``.

Small sizes: every combination is solved at every bound on the second objective, without any bound of the search. For
makeable values, every makeable ring of every combination that comes near that front is solved as well.
Larger sizes: the search itself, to a smaller gap and with more points.
"""

from __future__ import annotations

import argparse
import itertools
import sys
import time
from collections.abc import Sequence

import numpy as np

import synth
from synth.model.constraint import Goal, NodeConstraint
from synth.model.model import Evaluation
from synth.nlp.batch import BatchNlp, ProblemInputs, Tasks
from synth.nlp.rows import Rows
from synth.question.instance import Instance
from synth.tables.catalogs import Catalogs
from tests.asking import instance_of
from tests.benchmarks import cases, hypervolume

SOLVED_ENTIRELY = ("6k", "110k", "1M")
BOUNDS = 200
POINTS = 1000
GAPS = {"6k": 1e-4, "110k": 1e-4, "1M": 1e-3, "1G": 1e-3}
# A price on the other objective, so that it is not left open where the first one does not fall any more.
SMALL_WEIGHT = 1e-6
STEP = 100_000
TIE = 1e-7
MORE_STARTS = 2
KEPT = 20  # combinations kept per bound, to begin with makeable designs near the front
MARGIN = 0.002
ROUNDING = 1e-5
SAMPLE = 20_000


class Enumeration:
    """All combinations of an instance, each with its own continuous problem.

    Parameters
    ----------
    instance : Instance
        With continuous variables.
    objectives : list of str
        Two positive quantities, both to be small.
    """

    def __init__(self, instance: Instance, objectives: Sequence[str]) -> None:
        self.instance, self.objectives = instance, list(objectives)
        self.model = model = instance.model
        self.n = len(model.variables)
        cuts = tuple(NodeConstraint.of(x) for x in model.constraints)
        goals = tuple(Goal(model.quantity_node[name]) for name in objectives)
        rows = Rows(
            cuts, goals, self._positive(), (True,) * len(goals), tuple(bool(x > 0) for x in instance.ranges.lower)
        )
        self.solver = BatchNlp(model.program, self.n, rows)
        self.bounds = [0.0] * len(cuts)
        self.solves = 0
        self.missed = 0

    def _positive(self) -> tuple[bool, ...]:
        """Return which limits have positive sides, as far as samples tell."""
        rng = np.random.default_rng(0)
        numbers = rng.integers(self.instance.combinations.count, size=SAMPLE)
        result = self._evaluate(numbers, self._between(rng.random((SAMPLE, self.n))))
        return tuple(
            x.sense != "equal" and all(not np.any(side <= 0) for side in result.limits[x.name])
            for x in self.model.limits
        )

    def _between(self, share: np.ndarray) -> np.ndarray:
        low, high = self.instance.ranges.lower, self.instance.ranges.upper
        return np.asarray(low * (high / low) ** share)

    def _evaluate(self, numbers: np.ndarray, variables: np.ndarray) -> Evaluation:
        return self.model.evaluate(variables, self.instance.data(numbers))

    def solve(
        self,
        numbers: np.ndarray,
        weights: Sequence[float],
        cap: float = np.inf,
        start: np.ndarray | None = None,
        held: Sequence[int] = (),
    ) -> tuple[np.ndarray, np.ndarray]:
        """Solve the problem of each combination; return objectives, infinite where none was found, and variables.

        Variables in ``held`` stay at their start.
        """
        found = np.full((len(numbers), 2), np.inf)
        ends = np.empty((len(numbers), self.n))
        for first in range(0, len(numbers), STEP):
            part = slice(first, first + STEP)
            some = numbers[part]
            shape = (len(some), self.n)
            begin = self._between(np.full(shape, 0.5)) if start is None else start[part]
            caps = np.broadcast_to([np.inf, np.log(cap)], (len(some), 2))
            tasks = Tasks(
                np.broadcast_to(np.asarray(weights), (len(some), 2)), np.zeros((len(some), 2)), caps, np.ones(2), 0.0
            )
            data = self.instance.data(some)
            low, high = (
                np.broadcast_to(x, shape).copy() for x in (self.instance.ranges.lower, self.instance.ranges.upper)
            )
            for k in held:
                low[:, k] = high[:, k] = begin[:, k]
            void = np.stack([x.void(data, (len(some),)) for x in self.model.constraints], axis=1)
            answer = self.solver.solve(tasks, ProblemInputs(data, low, high, self.bounds, void), begin)
            self.solves += len(some)
            ends[part] = answer.variables
            # Only what the model itself says of the point counts.
            result = self._evaluate(some, answer.variables)
            values = np.stack([result.values[name] for name in self.objectives], axis=1)
            good = result.feasible & np.isfinite(values).all(axis=1) & (values[:, 1] <= cap * (1 + 1e-9))
            found[part] = np.where(good[:, None], values, np.inf)
        return found, ends

    def _least(self, numbers: np.ndarray, weights: Sequence[float]) -> tuple[np.ndarray, np.ndarray]:
        """Solve without a bound, from more starts where nothing is found."""
        rng = np.random.default_rng(1)
        found, ends = self.solve(numbers, weights)
        for _ in range(MORE_STARTS):
            missing = np.flatnonzero(~np.isfinite(found[:, 0]))
            begin = self._between(rng.random((len(missing), self.n)))
            found[missing], ends[missing] = self.solve(numbers[missing], weights, start=begin)
        return found, ends

    def _capped(self, numbers: np.ndarray, cap: float, start: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Solve at a bound on the second objective, from the middle as well where nothing is found."""
        found, ends = self.solve(numbers, (1.0, 0.0), cap, start)
        missing = np.flatnonzero(~np.isfinite(found[:, 0]))
        found[missing], ends[missing] = self.solve(numbers[missing], (1.0, 0.0), cap)
        self.missed += int(np.sum(~np.isfinite(found[missing, 0])))
        return found, ends

    def front(self) -> np.ndarray:
        """Return the best designs for the least of each objective and for each bound on the second."""
        numbers = np.arange(self.instance.combinations.count)
        light, ends = self._least(numbers, (1.0, SMALL_WEIGHT))
        soft, _ = self._least(numbers, (SMALL_WEIGHT, 1.0))
        # A design found for one objective is known for the other as well.
        light = np.where(soft[:, :1] < light[:, :1], soft, light)
        soft = np.where(light[:, 1:] < soft[:, 1:], light, soft)
        usable = np.isfinite(soft[:, 1])
        print(f"{usable.sum()} combinations have a feasible design", file=sys.stderr)
        numbers, light, soft, ends = numbers[usable], light[usable], soft[usable], ends[usable]
        self.numbers = numbers
        ideal = soft[np.lexsort((soft[:, 0], soft[:, 1]))[0]]
        least = light[np.lexsort((light[:, 1], light[:, 0]))[0]]
        self.caps = np.geomspace(least[1], ideal[1], BOUNDS)
        self.first = np.empty((len(numbers), BOUNDS), dtype=np.float32)
        self.best: list[tuple[np.ndarray, np.ndarray]] = []
        found = [_staircase(light), _staircase(soft)]
        for k, cap in enumerate(self.caps):
            # Above the force of its lightest design a combination has that one; below its least force it has none.
            asked = (soft[:, 1] < cap) & (cap < light[:, 1])
            values, ends[asked] = self._capped(numbers[asked], float(cap), ends[asked])
            self.first[:, k] = np.where(light[:, 1] <= cap, light[:, 0], np.inf)
            # Where nothing was found although there is something, the last bound still holds from below.
            before = self.first[asked, k - 1] if k else light[asked, 0]
            self.first[asked, k] = np.where(np.isfinite(values[:, 0]), values[:, 0], before)
            best = np.argsort(self.first[:, k])[:KEPT]
            self.best.append((numbers[best], ends[best]))
            found.append(_staircase(values[np.isfinite(values).all(axis=1)]))
            print(f"{k + 1}/{BOUNDS}: {asked.sum()} problems", file=sys.stderr)
        return _staircase(np.concatenate(found))


class Makeable:
    """The makeable designs of all combinations that come near a continuous front.

    The first objective must depend on gridded variables and parts alone.

    Parameters
    ----------
    enumeration : Enumeration
        After its front was made.
    grids : list of array
        Makeable values per variable, empty where it is continuous.
    """

    def __init__(self, enumeration: Enumeration, grids: Sequence[np.ndarray]) -> None:
        self.all, self.grids = enumeration, grids
        self.stepped = [k for k, grid in enumerate(grids) if len(grid)]
        self.front_points = np.empty((0, 2))
        self.considered = 0

    def front(self) -> np.ndarray:
        """Return the front of makeable designs."""
        for numbers, ends in self.all.best:
            self._try(np.repeat(numbers, 3 ** len(self.stepped)), self._around(ends))
        margin = self._excess() + MARGIN
        near = np.isfinite(self.all.first) & (self.all.first <= (1 + margin) * self.all.first.min(axis=0))
        chosen = np.flatnonzero(near.any(axis=1))
        self.considered = len(chosen)
        print(f"{len(chosen)} combinations within {100 * margin:.1f} % of the continuous front", file=sys.stderr)
        rings = self._possible()
        for position in chosen:
            self._try_all(int(position), rings)
        return self.front_points

    def _around(self, ends: np.ndarray) -> np.ndarray:
        """Return the nearest makeable values, and one step up and down, in all combinations of them."""
        steps = np.array(list(itertools.product((-1, 0, 1), repeat=len(self.stepped))))
        result = np.repeat(ends, len(steps), axis=0)
        for column, k in enumerate(self.stepped):
            grid = self.grids[k]
            nearest = np.argmin(np.abs(grid[None, :] - ends[:, k : k + 1]), axis=1)
            places = nearest[:, None] + steps[None, :, column]
            result[:, k] = grid[np.clip(places, 0, len(grid) - 1)].ravel()
        return result

    def _excess(self) -> float:
        """Return by how much the first objective of makeable designs lies above the continuous ones, at most."""
        continuous = self.all.first.min(axis=0)
        own = np.array(
            [self.front_points[self.front_points[:, 1] <= cap, 0].min(initial=np.inf) for cap in self.all.caps]
        )
        within = np.isfinite(own)
        return float(np.max(own[within] / continuous[within])) - 1

    def _possible(self) -> np.ndarray:
        """Return all values of the gridded variables that limits on them alone allow."""
        model, instance = self.all.model, self.all.instance
        mesh = np.meshgrid(*(self.grids[k] for k in self.stepped), indexing="ij")
        rings = np.stack([m.ravel() for m in mesh], axis=1)
        others = [k for k in range(model.program.n_inputs) if k not in self.stepped]
        others = [k for k in others if k < self.all.n or model.data_inputs[k - self.all.n].kind != "requirement"]
        marked = model.program.dependence(others)
        result = model.evaluate(self._with(rings), instance.data(np.zeros(len(rings), dtype=np.int64)))
        keep = np.ones(len(rings), dtype=bool)
        for limit in model.constraints:
            if not any(marked[node] for node in limit.nodes):
                keep &= result.holds[limit.name]
        return rings[keep]

    def _with(self, rings: np.ndarray) -> np.ndarray:
        middle = np.sqrt(self.all.instance.ranges.lower * self.all.instance.ranges.upper)
        variables = np.broadcast_to(middle, (len(rings), self.all.n)).copy()
        variables[:, self.stepped] = rings
        return variables

    def _try_all(self, position: int, rings: np.ndarray) -> None:
        """Solve all makeable values of one combination that its continuous problem does not rule out."""
        number = np.full(len(rings), self.all.numbers[position])
        variables = self._with(rings)
        first = self.all.model.evaluate(variables, self.all.instance.data(number)).values[self.all.objectives[0]]
        # What is less than the continuous optimum at a cap needs more than the cap.
        curve = self.all.first[position]
        above = np.sum(curve[None, :] > first[:, None] * (1 + ROUNDING), axis=1)
        least = np.where(above > 0, self.all.caps[np.clip(BOUNDS - above, 0, BOUNDS - 1)], 0.0)
        order = np.searchsorted(self.front_points[:, 0], first, side="right") - 1
        known = np.where(order >= 0, self.front_points[np.maximum(order, 0), 1], np.inf)
        keep = least < known
        self._try(number[keep], variables[keep])

    def _try(self, numbers: np.ndarray, variables: np.ndarray) -> None:
        """Find the least of the second objective with the gridded variables held."""
        if len(numbers):
            values, _ = self.all.solve(numbers, (0.0, 1.0), start=variables, held=self.stepped)
            values = values[np.isfinite(values).all(axis=1)]
            self.front_points = _staircase(np.concatenate([self.front_points, values]))


def _staircase(points: np.ndarray) -> np.ndarray:
    """Return the non-dominated points, lightest first; what differs only in the last digits of a solver is equal."""
    ordered = points[np.lexsort((points[:, 1], points[:, 0]))]
    before = np.concatenate([[np.inf], np.minimum.accumulate(ordered[:, 1])[:-1]])
    return np.asarray(ordered[ordered[:, 1] < before * (1 - TIE)])


def enumerate_all(size: str, grid: bool) -> tuple[np.ndarray, str]:
    """Return the front of a size from all its combinations, and how it was made."""
    question = cases.question(cases.SIZES[size])
    catalogs = question["catalogs"] or Catalogs()
    instance = instance_of(cases.problem(), cases.HOIST, catalogs, question["parts"], grid=grid)
    begin = time.perf_counter()
    enumeration = Enumeration(instance, cases.OBJECTIVES)
    points = enumeration.front()
    how = (
        f"Every one of {instance.combinations.count} combinations solved for least mass, for least force and at "
        f"{BOUNDS} bounds on the force"
    )
    if grid:
        makeable = Makeable(enumeration, instance.ranges.grids())
        points = makeable.front()
        how += f",\nthen every makeable ring of the {makeable.considered} combinations that came near the best"
    took = f"{enumeration.solves} problems, {enumeration.missed} left without a solution, {_seconds_since(begin)}"
    return points, f"{how}\n({took}), every design evaluated by the model."


def _seconds_since(begin: float) -> str:
    return f"{time.perf_counter() - begin:.0f} s"


def search(size: str, grid: bool, time_limit: float) -> tuple[np.ndarray, str]:
    """Return the front of a size as the search finds it to a small gap, and how it was made."""
    question = cases.question(cases.SIZES[size])
    front = synth.synthesize(
        cases.problem(),
        cases.HOIST,
        objectives=list(cases.OBJECTIVES),
        points=POINTS,
        gap=GAPS[size],
        grid=grid,
        time_limit=time_limit,
        **question,
    )
    points = np.array([[d.values[name] for name in cases.OBJECTIVES] for d in front.designs])
    return points, f"The search with gap={GAPS[size]:g}, points={POINTS}: {front.certificate.sentence()}."


def main() -> None:
    """Make one reference front and store it."""
    parser = argparse.ArgumentParser(prog="python -m tests.benchmarks.reference", description="Make a reference front.")
    parser.add_argument("--size", required=True, choices=list(GAPS))
    parser.add_argument("--grid", action="store_true", help="for makeable values")
    parser.add_argument("--time-limit", type=float, default=3600.0, metavar="S", help="of a search (3600)")
    given = parser.parse_args()
    if given.size in SOLVED_ENTIRELY:
        points, how = enumerate_all(given.size, given.grid)
    else:
        points, how = search(given.size, given.grid, given.time_limit)
    command = f"python -m tests.benchmarks.reference --size {given.size}{' --grid' if given.grid else ''}"
    file = hypervolume.store(given.size, given.grid, points, f"{how}\nMade by: {command}")
    print(f"{len(points)} designs: {file}")


if __name__ == "__main__":
    main()
