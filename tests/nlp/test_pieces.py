"""Random problems with kinks: what the solver calls an optimum, against IPOPT on every regime with its conditions."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any, Literal

import casadi as ca
import numpy as np
import pytest
import yaml

import synth
from synth.kernels.loading import best_variant
from synth.model.constraint import Goal, NodeConstraint, void_limits
from synth.model.program import Program
from synth.nlp.batch import BatchNlp, ProblemInputs, Solutions, Tasks
from synth.nlp.pieces import KinkedNlp, PiecedNlp, Pieces, decisions
from synth.nlp.rows import Rows
from synth.order.feasibility import residual
from synth.search.settings import TUNING
from tests.asking import pose
from tests.referees.ipopt import ParametricNlp, Task
from tests.regimes import best_in_any_regime, referee
from tests.repetitions import repetitions

ROOT = Path(__file__).parents[2]
Code = Literal["arrays", "kernel"]
CODES: tuple[Code, ...] = ("arrays", "kernel") if best_variant("solver") else ("arrays",)
EVERY = pytest.mark.parametrize("code", CODES)

Row = tuple[str, Any, Any]  # sense, value and limit
Formula = Callable[[Sequence[Any]], Any]
Written = tuple[Callable[[Sequence[Any]], list[Row]], Formula, bool]  # limits, objective, whether by logarithm


class Kinked:
    """One problem, and its referee."""

    def __init__(self, n: int, written: Written, code: Code = "arrays") -> None:
        limits, goal, logs = written
        x = [ca.SX.sym(f"x{k}") for k in range(n)]
        rows = limits(x)
        self.program = Program(x, [ca.SX(s) for s in [*(side for _, a, b in rows for side in (a, b)), goal(x)]])
        nodes = iter(self.program.outputs)
        constraints = tuple(NodeConstraint(sense, next(nodes), next(nodes), 1e-9) for sense, _, _ in rows)
        log_constraints = tuple(logs and c.sense != "equal" for c in constraints)
        self.rows = Rows(constraints, (Goal(next(nodes)),), log_constraints, (logs,), (logs,) * n)
        self.n, self.logs = n, logs
        self.low, self.high = np.full(n, 0.2 if logs else -3.0), np.full(n, 5.0 if logs else 3.0)
        self.bounds, self.void = [0.0] * len(constraints), np.zeros(len(constraints), dtype=bool)
        kinks = decisions(self.program, n, self.rows)
        self.pieces = Pieces(self.program, n, self.rows, kinks)
        # As the search does it: rounded off first where both sides of a max or min move.
        moving, nodes = self.program.dependence(range(n)), self.program.nodes
        edges = [nodes[k] for k in kinks if nodes[k].op in (ca.OP_FMAX, ca.OP_FMIN)]
        edged = any(moving[list(node.args)].all() for node in edges)
        with pytest.MonkeyPatch.context() as patch:
            patch.setenv("CLUTCHSYNTH_NATIVE", "0" if code == "arrays" else "1")
            first = BatchNlp(self.program, n, self.rows, TUNING.nlp.edge if edged else 0.0)
            self.solver = KinkedNlp(first, PiecedNlp(self.pieces))
            assert first.compiled == self.solver.pieced.nlp.compiled == (code == "kernel")
        self.referee = ParametricNlp(self.program, n, self.rows)
        self._sides = self.program.compile()

    def solve(self, start: np.ndarray, tasks: Tasks | None = None) -> Solutions:
        count = len(start)
        if tasks is None:
            tasks = Tasks(np.ones((count, 1)), np.zeros((count, 1)), np.full((count, 1), np.inf), np.ones(1), 0.0)
        ends = (np.tile(x, (count, 1)) for x in (self.low, self.high))
        inputs = ProblemInputs([], *ends, self.bounds, np.tile(self.void, (count, 1)))
        return self.solver.solve(tasks, inputs, start)

    def judged(self, points: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return cost and largest violation at points, by the formulas as they were written."""
        with np.errstate(all="ignore"):
            sides = [np.broadcast_to(v, len(points)) for v in self._sides(list(points.T))]
            cost = np.log(sides[-1]) if self.logs else sides[-1]
        worst = np.zeros(len(points))
        for j, constraint in enumerate(self.rows.constraints):
            worst = np.fmax(worst, residual(sides[2 * j], sides[2 * j + 1], constraint.sense, constraint.scale))
        return cost, worst

    def best(self, starts: np.ndarray, low: np.ndarray, high: np.ndarray, allowed: float) -> float:
        """Return the least cost that IPOPT finds in any regime, from any of the starts."""

        def cost_of(point: np.ndarray) -> float:
            (cost,), (worst,) = self.judged(point[None, :])
            return float(cost) if worst <= allowed else np.inf

        task = Task(np.ones(1), np.zeros(1), np.full(1, np.inf), np.ones(1), 0.0)
        return best_in_any_regime(self.referee, task, [], starts, (low, high), self.bounds, self.void, cost_of)


def _monomial(rng: np.random.Generator, n: int) -> Formula:
    powers, factor = rng.uniform(-1.5, 1.5, n), np.exp(rng.uniform(-0.5, 0.5))
    return lambda x: factor * np.prod([a**b for a, b in zip(x, powers, strict=True)])


def _posynomial(rng: np.random.Generator, n: int) -> Formula:
    terms = [_monomial(rng, n) for _ in range(rng.integers(2, 4))]
    return lambda x: sum(f(x) for f in terms)


def _line(rng: np.random.Generator, n: int) -> Formula:
    slopes, constant = rng.normal(size=n), rng.normal()
    return lambda x: sum(k * y for k, y in zip(slopes, x, strict=True)) + constant


def _bowl(rng: np.random.Generator, n: int) -> Formula:
    middle, width = rng.uniform(-2, 2, n), rng.uniform(0.3, 2, n)
    return lambda x: sum(w * (y - m) ** 2 for w, y, m in zip(width, x, middle, strict=True))


def convex(rng: np.random.Generator, n: int) -> Written:
    a, b, c, d, e = (_posynomial(rng, n) for _ in range(5))
    room = 5 * np.exp(rng.uniform(0.5, 2))
    return lambda x: [("at_most", ca.fmax(a(x), b(x)), room)], lambda x: ca.fmax(c(x), ca.fmax(d(x), e(x))), True


def either_limit(rng: np.random.Generator, n: int) -> Written:
    (a, b, c, d), cost = (_monomial(rng, n) for _ in range(4)), _posynomial(rng, n)
    return (lambda x: [("at_most", ca.fmin(a(x), b(x)), 0.5), ("at_least", ca.fmax(c(x), d(x)), 2.0)], cost, True)


def least_of_both(rng: np.random.Generator, n: int) -> Written:
    (a, b, c), room = (_posynomial(rng, n) for _ in range(3)), _monomial(rng, n)
    return lambda x: [("at_most", room(x), 1.0)], lambda x: ca.fmin(a(x), ca.fmax(b(x), c(x))), True


def absolute(rng: np.random.Generator, n: int) -> Written:
    (a, b, c), cost = (_line(rng, n) for _ in range(3)), _bowl(rng, n)
    limits: list[Callable[[Any], Row]] = [
        lambda x: ("at_most", ca.fabs(a(x)), 0.3),
        lambda x: ("at_least", ca.fabs(b(x)), 0.5),
    ]
    return lambda x: [f(x) for f in limits], lambda x: cost(x) + ca.fabs(c(x)), False


def ramps(rng: np.random.Generator, n: int) -> Written:
    (a, b, c), cost = (_line(rng, n) for _ in range(3)), _bowl(rng, n)
    return (
        lambda x: [("at_most", ca.fmax(a(x), 0.0) + ca.fmax(b(x), 0.2), 1.5)],
        lambda x: cost(x) + 2 * ca.fmax(c(x), 0.0) - ca.fmin(x[0], 0.5),
        False,
    )


def bent(rng: np.random.Generator, n: int) -> Written:
    (a, b), cost, more = (_line(rng, n) for _ in range(2)), _bowl(rng, n), rng.uniform(-3, 3)
    return (lambda x: [("at_most", b(x), 0.5)], lambda x: cost(x) + ca.if_else(a(x) < 0, 0.0, more * a(x)), False)


def step(rng: np.random.Generator, n: int) -> Written:
    (a, b), cost, more = (_line(rng, n) for _ in range(2)), _bowl(rng, n), rng.uniform(-2, 2)
    return lambda x: [("at_most", b(x), 0.5)], lambda x: cost(x) + ca.if_else(a(x) < 0, 0.0, more), False


def nested(rng: np.random.Generator, n: int) -> Written:
    (a, b, c, d), cost = (_line(rng, n) for _ in range(4)), _bowl(rng, n)
    return (
        lambda x: [("at_most", ca.fmax(ca.fmin(a(x), b(x)), c(x)), 0.4)],
        lambda x: cost(x) + ca.fabs(ca.fmax(a(x), d(x)) - 0.3),
        False,
    )


def behind_conditions(rng: np.random.Generator, n: int) -> Written:
    (a, b, c, d), cost = (_line(rng, n) for _ in range(4)), _bowl(rng, n)

    def chosen(x: Sequence[Any]) -> Any:
        return ca.if_else(ca.logic_and(a(x) < 0, b(x) < 0), ca.fmax(c(x), d(x)), ca.fabs(c(x)))

    return lambda x: [("at_least", chosen(x), 0.2)], cost, False


def equality(rng: np.random.Generator, n: int) -> Written:
    (a, b, c), cost = (_line(rng, n) for _ in range(3)), _bowl(rng, n)
    return lambda x: [("equal", ca.fmax(a(x), b(x)), 0.3)], lambda x: cost(x) + ca.fabs(c(x)), False


def clipped(rng: np.random.Generator, n: int) -> Written:
    (a, b), cost = (_line(rng, n) for _ in range(2)), _bowl(rng, n)
    return (lambda x: [("at_most", b(x), 0.5)], lambda x: cost(x) + 3 * ca.fmin(ca.fmax(a(x), -0.5), 0.5), False)


CONVEX = (convex, ramps)
KINDS = (convex, either_limit, least_of_both, absolute, ramps, bent, step, nested, behind_conditions, equality, clipped)
QUICK = (either_limit, bent, step, clipped)  # for the referee
STARTS = 6


@pytest.mark.slow
@pytest.mark.parametrize(
    "kind", [pytest.param(k, marks=[] if k in QUICK else [pytest.mark.slow]) for k in KINDS], ids=lambda k: k.__name__
)
def test_answers_to_random_problems_are_optima_and_no_regime_has_a_better_one(kind):
    feasible, best, solved = 0, 0, []
    seeds = 6 if kind in QUICK else repetitions(2, 6)
    for seed in range(seeds):
        known: float | None = None
        for code in CODES:
            rng = np.random.default_rng([seed, KINDS.index(kind)])
            n = int(rng.integers(2, 4))
            problem = Kinked(n, kind(rng, n), code)
            start = rng.uniform(problem.low, problem.high, (STARTS, problem.n))
            found = problem.solve(start)
            cost, worst = problem.judged(found.variables)
            # What is called an optimum keeps the limits as they were written ...
            assert np.all(worst[found.converged & (found.violation <= TUNING.nlp.missed)] <= 1e-7)
            holds = found.converged & (worst <= 1e-7)
            np.testing.assert_allclose(found.phi[holds, 0], cost[holds], atol=1e-7)
            # ... and in none of the regimes around it there is a better one.
            _, first = np.unique(np.round(cost[holds], 6), return_index=True)
            for k in np.flatnonzero(holds)[first]:
                point = found.variables[k]
                low, high = np.maximum(problem.low, point - 1e-3), np.minimum(problem.high, point + 1e-3)
                assert problem.best(point[None, :], low, high, 1e-9) >= cost[k] - 1e-6
            if known is None:
                known = problem.best(start[:2], problem.low, problem.high, 1e-7)
            if np.isfinite(known):
                feasible += 1
                solved.append(holds.mean())
                best += bool(np.min(cost[holds], initial=np.inf) <= known + 1e-6)
                if kind in CONVEX:
                    np.testing.assert_allclose(cost[holds], known, atol=1e-6)
    assert feasible > 0.5 * seeds * len(CODES)
    assert np.mean(solved) > 0.9
    # From these few starts; the search goes on where such an answer is not the best.
    assert best >= (1.0 if kind in CONVEX else 0.75) * feasible


# -- known answers -----------------------------------------------------------------------------


@EVERY
def test_an_optimum_on_an_edge_is_met_exactly(code):
    valley = Kinked(1, (lambda x: [("at_most", x[0], 50.0)], lambda x: ca.fmax(x[0], 4.0 / x[0]), True), code)
    found = valley.solve(np.array([[0.3], [2.0], [4.9]]))
    np.testing.assert_allclose(found.phi[:, 0], np.log(2.0), atol=2e-9)
    np.testing.assert_allclose(found.variables, 2.0, rtol=2e-9)
    assert found.converged.all()


@EVERY
def test_an_edge_that_holds_back_is_left_to_the_side_that_goes_further(code):
    # The lesser of both falls to either side of 0, steeper to the right; only 0 itself is a place to be stuck at.
    roof = Kinked(1, (lambda x: [("at_most", x[0], 9.0)], lambda x: ca.fmin(-2 * x[0], x[0]), False), code)
    np.testing.assert_allclose(roof.solve(np.array([[0.0], [1e-9], [0.5]])).phi[:, 0], -6.0, atol=1e-7)
    either = (
        lambda x: [("at_most", ca.fmin(x[0] + x[1], 1 - x[0]), 0.5)],
        lambda x: (x[0] + 1) ** 2 + x[1] ** 2,
        False,
    )
    found = Kinked(2, either, code).solve(np.array([[2.0, 2.0], [-1.0, 0.3], [0.25, 0.25]]))
    np.testing.assert_allclose(found.phi[:, 0], 0.0, atol=1e-7)


@EVERY
def test_elastic_limits_give_way_and_the_conditions_of_pieces_do_not(code):
    # Half of the way between both limits on max(x, 1 - x), of which only x >= 1/2 is within reach.
    written = (
        lambda x: [("at_most", ca.fmax(x[0], 1 - x[0]), 0.1), ("at_least", x[0], 0.9)],
        lambda x: x[0] + 9,
        False,
    )
    problem = Kinked(1, written, code)
    tasks = Tasks(np.zeros((2, 1)), np.zeros((2, 1)), np.full((2, 1), np.inf), np.ones(1), 1.0, 1.0)
    found = problem.solve(np.array([[-2.0], [2.5]]), tasks)
    assert found.converged.all()
    # Sizes of rows are those at the start of the last solve, so the share may differ, but not the compromise.
    assert np.all((found.variables > 0.11) & (found.variables < 0.89))
    _, worst = problem.judged(found.variables)
    assert worst.max() < 0.9


def test_a_branch_that_is_not_taken_does_not_count():
    written = (
        lambda x: [("at_most", ca.if_else(x[0] < 0, ca.fmax(x[1], x[0]), ca.fabs(x[1] - 1)), 2.0)],
        lambda x: x[0] + x[1],
        False,
    )
    pieces = Kinked(2, written).pieces
    kinds = [pieces.program.nodes[k].op for k in pieces.decisions]
    assert sorted(kinds) == sorted([ca.OP_LT, ca.OP_FMAX, ca.OP_FABS])
    ways, apart, _ = pieces.at([np.array([-1.0, 1.0]), np.array([0.5, 1.0])])
    live = pieces.live(ways)
    for op, expected in ((ca.OP_LT, [True, True]), (ca.OP_FMAX, [True, False]), (ca.OP_FABS, [False, True])):
        assert live[:, kinds.index(op)].tolist() == expected
    assert apart[1, kinds.index(ca.OP_FABS)] == 0
    assert ways[:, kinds.index(ca.OP_LT)].tolist() == [True, False]


def test_no_point_at_all_decides_nothing_although_other_numbers_are_given_once():
    written = (lambda x: [("at_most", ca.fmax(x[1], x[0]), 2.0)], lambda x: x[0] + x[1], False)
    ways, apart, size = Kinked(2, written).pieces.at([np.empty(0), np.array([0.5])])
    assert ways.shape == apart.shape == size.shape == (0, 1)


# -- the two-spring clutch ---------------------------------------------------------------------


def _two_springs(gap: float) -> dict[str, Any]:
    """Return how one combination of the example is asked for."""
    spec = yaml.safe_load((ROOT / "examples" / "centrifugal_two_spring.yaml").read_text())
    parts = {"ball": ["ball 30"], "return_spring": ["CS-1.25x6.3x5.5"], "clamp_spring": ["CS-2.5x12.5x5.5"]}
    fix = {"balls": 4, "return_springs": 3, "clamp_springs": 3}
    return {
        "p": synth.load(spec["family"], practice="off"),
        "requirements": spec["requirements"],
        "objectives": ["mass"],
        "grid": False,
        "gap": gap,
        "points": 4,
        "parts": {**spec["parts"], **parts},
        "fix": {**spec["fix"], **fix, "friction_surfaces": 8},
    }


@pytest.mark.slow
@pytest.mark.parametrize("native", ["1", "0"])
def test_a_pinned_two_spring_clutch_is_as_light_as_in_its_best_regime_from_every_start(monkeypatch, native):
    monkeypatch.setenv("CLUTCHSYNTH_NATIVE", native)
    form = pose(**_two_springs(0.1)).search().state.form
    goals, rng, own = len(form.goals), np.random.default_rng(1), np.zeros(12, dtype=np.int64)
    start = form.lower * (form.upper / form.lower) ** rng.random((len(own), form.n))
    weights = np.eye(goals)[:1]
    free = np.full((1, goals), np.inf)
    tasks = Tasks(*(np.tile(x, (len(own), 1)) for x in (weights, 0 * weights, free)), form.objectives.scales, 0.0)
    found = form.continuous.solve_batch(tasks, own, start)
    rows, phi = form.points.feasible_rows(found.variables, own)
    data = [float(np.asarray(x).ravel()[0]) for x in form.instance.data(own[:1])]
    task = Task(weights[0], 0 * weights[0], free[0], form.objectives.scales, 0.0)

    def mass_of(point: np.ndarray) -> float:
        kept, values = form.points.feasible_rows(point[None, :], own[:1])
        return float(values[0, 0]) if len(kept) else np.inf

    ends, void = (form.lower, form.upper), void_limits(form.constraints, data, 1)[0]
    starts = np.array([*start[:3], found.variables[rows[0]]])
    least = best_in_any_regime(referee(form), task, data, starts, ends, form.bounds, void, mass_of)
    assert found.converged.sum() >= 11
    assert np.isfinite(least)
    np.testing.assert_allclose(phi[rows, 0][found.converged[rows]], least, atol=1e-7)


@pytest.mark.slow
def test_fronts_of_a_two_spring_clutch_do_not_become_worse_with_a_smaller_gap():
    best = []
    for gap in (1e-3, 1e-4, 1e-5):
        front = synth.synthesize(**_two_springs(gap))
        assert front.certificate.kind == "global"
        best.append(front.designs[0].values["mass"])
    np.testing.assert_allclose(best, best[-1], rtol=1e-8)
