"""The batched solver against known optima, against IPOPT, and its three ways to solve against each other."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import fields, replace
from typing import Any, Literal

import casadi as ca
import numpy as np
import pytest

import synth
from synth.kernels.loading import LEVELS, best_variant, processor_level, variant
from synth.model.constraint import Goal, NodeConstraint
from synth.model.program import Program
from synth.nlp import kernel_solver
from synth.nlp.batch import BatchNlp, ProblemInputs, Solutions, Tasks
from synth.nlp.rows import GUARD_MARGIN, Rows
from synth.nlp.settings import InteriorPointSettings, NlpSettings
from synth.question.catalogs import as_catalogs
from synth.search.settings import TUNING
from tests.asking import instance_of
from tests.referees.ipopt import ParametricNlp, Task

BUILT = pytest.mark.skipif(best_variant("solver") is None, reason="no kernel was built")
Code = Literal["arrays", "kernel"]


# -- small problems with known answers ---------------------------------------------------------


def solver_of(program: Program, n: int, rows: Rows, code: Code, settings: NlpSettings = TUNING.nlp) -> BatchNlp:
    """Solver over arrays or by the kernel."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("CLUTCHSYNTH_NATIVE", "0" if code == "arrays" else "1")
        return BatchNlp(program, n, rows, settings=settings)


Row = tuple[str, Any, Any]  # sense, value and limit: expressions, or a number as the right side


class Small:
    """A problem written down in a few lines.

    Parameters
    ----------
    n, n_data : int
        Variables and data inputs.
    write : callable
        Takes the symbols of both; returns limits and objectives.
    logs : bool
        Whether limits, objectives and variables enter by logarithm.
    guards : tuple of int
        Which limits are guards.
    """

    def __init__(
        self,
        n: int,
        n_data: int,
        write: Callable[[Sequence[Any], Sequence[Any]], tuple[list[Row], list[Any]]],
        logs: bool = True,
        guards: tuple[int, ...] = (),
        code: Code = "arrays",
        settings: NlpSettings = TUNING.nlp,
    ) -> None:
        x, d = [ca.SX.sym(f"x{k}") for k in range(n)], [ca.SX.sym(f"d{k}") for k in range(n_data)]
        limits, goals = write(x, d)
        sides = [s for _, value, limit in limits for s in (value, limit)]
        self.program = Program([*x, *d], [ca.SX(s) for s in [*sides, *goals]])
        nodes = iter(self.program.outputs)
        constraints, self.bounds = [], []
        for k, (sense, _, limit) in enumerate(limits):
            value_node, limit_node = next(nodes), next(nodes)
            constant = isinstance(limit, float)
            constraints.append(
                NodeConstraint(sense, value_node, None if constant else limit_node, 1e-9, guard=k in guards)
            )
            self.bounds.append(limit if constant else 0.0)
        self.rows = Rows(
            constraints=tuple(constraints),
            goals=tuple(Goal(next(nodes)) for _ in goals),
            log_constraints=tuple(logs and c.sense != "equal" for c in constraints),
            log_goals=(logs,) * len(goals),
            log_variables=(logs,) * n,
        )
        self.solver = solver_of(self.program, n, self.rows, code, settings)
        assert self.solver.compiled == (code != "arrays")

    def solve(
        self,
        data: Sequence[Any],
        start: Any,
        low: Any,
        high: Any,
        void: Any = None,
        weights: Any = (1.0,),
        slopes: Any = (0.0,),
        cutoffs: Any = (np.inf,),
        count: int = 1,
        **more: float,
    ) -> Solutions:
        m, n = len(self.rows.goals), len(self.rows.log_variables)
        tasks = Tasks(
            *(np.broadcast_to(np.asarray(x, dtype=float), (count, m)) for x in (weights, slopes, cutoffs)),
            np.ones(m),
            **{"t_weight": 0.0, **more},
        )
        first, *ends = (np.broadcast_to(np.asarray(x, dtype=float), (count, n)) for x in (start, low, high))
        gone = np.zeros((count, len(self.rows.constraints)), dtype=bool) if void is None else np.asarray(void)
        return self.solver.solve(tasks, ProblemInputs(data, *ends, self.bounds, gone), first)


EVERY = pytest.mark.parametrize("code", ["arrays", pytest.param("kernel", marks=BUILT)])


def box(x: Sequence[Any], d: Sequence[Any]) -> tuple[list[Row], list[Any]]:
    """Sides of a box of least surface around a volume, not higher than a limit."""
    volume, surface = x[0] * x[1] * x[2], 2 * (x[0] * x[1] + x[1] * x[2] + x[2] * x[0])
    return [("at_least", volume, d[0]), ("at_most", x[2], d[1])], [surface, x[2]]


@pytest.mark.slow
@EVERY
def test_the_method_has_the_numbers_that_it_is_given(code):
    converged = {}
    for most in (4, TUNING.nlp.method.max_evaluations):
        method = InteriorPointSettings(max_evaluations=most)
        small = Small(3, 2, box, code=code, settings=NlpSettings(method=method, other_starts=()))
        found = small.solve(
            [4.0, 50.0], 1.0, 1e-2, 1e2, weights=(1.0, 0.0), slopes=(0.0, 0.0), cutoffs=(np.inf, np.inf)
        )
        converged[most] = bool(found.converged[0])
    assert list(converged.values()) == [False, True]


@EVERY
def test_optima_of_a_whole_batch_are_the_known_ones(code):
    small = Small(3, 2, box, code=code)
    count = 7000  # more than go through at once
    rng = np.random.default_rng(1)
    volume, height = rng.uniform(0.5, 8.0, count), np.where(rng.random(count) < 0.5, 50.0, 0.4)
    start = np.exp(rng.uniform(-2, 2, (count, 3)))
    solution = small.solve(
        [volume, height], start, 1e-2, 1e2, weights=(1.0, 0.0), slopes=(0.0, 0.0), cutoffs=(np.inf, np.inf), count=count
    )
    side = np.cbrt(volume)
    free = height > side
    width = np.where(free, side, np.sqrt(volume / np.minimum(height, side)))
    third = np.where(free, side, height)
    expected = np.log(2 * (width**2 + 2 * width * third))
    assert solution.converged.all()
    np.testing.assert_allclose(solution.phi[:, 0], expected, atol=1e-8)
    np.testing.assert_allclose(solution.variables[:, 2], third, rtol=1e-4)
    assert solution.violation.max() <= 1e-8
    # Elasticities: the surface grows with the volume, by 2/3 where the height is free.
    np.testing.assert_allclose(solution.constraint_multipliers[free, 0], 2 / 3, atol=1e-5)
    np.testing.assert_allclose(solution.constraint_multipliers[free, 1], 0.0, atol=1e-6)
    assert (solution.constraint_multipliers[~free, 1] > 0.01).all()


@EVERY
def test_scalar_data_and_arrays_give_the_same(code):
    small = Small(3, 2, box, code=code)
    more = {"weights": (1.0, 0.0), "slopes": (0.0, 0.0), "cutoffs": (np.inf, np.inf), "count": 3}
    scalar = small.solve([2.0, 0.9], 1.0, 1e-2, 1e2, **more)
    array = small.solve([np.full(3, 2.0), np.full(3, 0.9)], 1.0, 1e-2, 1e2, **more)
    np.testing.assert_array_equal(scalar.variables, array.variables)
    np.testing.assert_array_equal(scalar.variables, scalar.variables[:1].repeat(3, axis=0))


@EVERY
def test_a_chebyshev_task_meets_both_objectives_at_the_same_share(code):
    small = Small(3, 2, box, code=code)
    solution = small.solve(
        [1.0, 50.0],
        1.0,
        1e-2,
        1e2,
        weights=(0.0, 0.0),
        slopes=(1.0, 0.5),
        cutoffs=(np.log(6.0), np.log(0.5)),
        t_weight=1.0,
    )
    excess = (solution.phi[0] - [np.log(6.0), np.log(0.5)]) / [1.0, 0.5]
    np.testing.assert_allclose(excess, solution.t[0], atol=1e-8)
    # On this curve width**2 height = 1, so the height alone says how good a point is.
    height = solution.variables[0, 2]
    surface = 2 * (1 / height + 2 * np.sqrt(height))
    assert solution.phi[0, 0] == pytest.approx(np.log(surface), abs=1e-8)
    assert solution.goal_multipliers[0] @ [1.0, 0.5] == pytest.approx(1.0, abs=1e-6)


@EVERY
def test_pinned_variables_stay_and_the_others_move(code):
    small = Small(3, 2, box, code=code)
    more = {"weights": (1.0, 0.0), "slopes": (0.0, 0.0), "cutoffs": (np.inf, np.inf)}
    solution = small.solve([1.0, 50.0], (0.5, 1.0, 1.0), (0.5, 1e-2, 1e-2), (0.5, 1e2, 1e2), **more)
    np.testing.assert_allclose(solution.variables[0], [0.5, np.sqrt(2), np.sqrt(2)], rtol=1e-4)
    assert solution.converged[0]
    assert solution.variables[0, 0] == 0.5
    fixed = small.solve([1.0, 50.0], (0.5, 4.0, 1.0), (0.5, 4.0, 1.0), (0.5, 4.0, 1.0), **more)
    np.testing.assert_array_equal(fixed.variables[0], [0.5, 4.0, 1.0])
    assert fixed.violation[0] == 0.0
    assert fixed.phi[0, 0] == pytest.approx(np.log(2 * (2.0 + 4.0 + 0.5)))
    broken = small.solve([3.0, 50.0], (0.5, 4.0, 1.0), (0.5, 4.0, 1.0), (0.5, 4.0, 1.0), **more)
    assert broken.violation[0] == pytest.approx(np.log(1.5))


@EVERY
def test_bounds_hold_exactly(code):
    small = Small(3, 2, box, code=code)
    low, high = np.array([0.1, 0.1, 0.1]), np.array([0.7, 5.0, 5.0])
    more = {"weights": (1.0, 0.0), "slopes": (0.0, 0.0), "cutoffs": (np.inf, np.inf)}
    solution = small.solve([1.0, 50.0], 0.3, low, high, **more)
    assert np.all((solution.variables >= low) & (solution.variables <= high))
    assert solution.variables[0, 0] == pytest.approx(0.7, rel=1e-8)


@EVERY
def test_equalities_are_met_from_both_sides(code):
    def circle(x, d):
        return [("equal", x[0] ** 2 + x[1] ** 2, d[0])], [x[0] + x[1]]

    small = Small(2, 1, circle, logs=False, code=code)
    starts = np.array([[0.1, 0.1], [5.0, 3.0], [-2.0, 1.0], [-0.1, -3.0]])
    solution = small.solve([4.0], starts, -10.0, 10.0, count=4)
    np.testing.assert_allclose(solution.variables, -np.sqrt(2.0), atol=1e-6)
    np.testing.assert_allclose(solution.phi[:, 0], -2 * np.sqrt(2.0), atol=1e-8)
    assert solution.violation.max() <= 1e-9
    # d phi/d radius**2 = -1/(2 sqrt 2), times the size of the row at the start
    sizes = np.maximum((starts**2).sum(axis=1), 4.0)
    np.testing.assert_allclose(solution.constraint_multipliers[:, 0], sizes / (2 * np.sqrt(2.0)), rtol=1e-5)


@EVERY
def test_void_rows_and_columns_without_value_do_not_count(code):
    def rod(x, d):
        return [("at_least", x[0], d[0]), ("at_least", x[0], d[1])], [x[0]]

    small = Small(1, 2, rod, code=code)
    void = np.array([[False, False], [False, True], [True, False]])
    solution = small.solve([np.array([2.0, 2.0, np.nan]), np.array([3.0, np.nan, 3.0])], 9.0, 1.0, 10.0, void, count=3)
    np.testing.assert_allclose(solution.variables[:, 0], [3.0, 2.0, 3.0], rtol=1e-7)
    np.testing.assert_allclose(solution.constraint_multipliers, [[0, 1], [1, 0], [0, 1]], atol=1e-6)
    assert solution.converged.all()


@EVERY
def test_cutoffs_that_cannot_be_met_are_told_by_the_violation(code):
    small = Small(3, 2, box, code=code)
    cutoffs = np.log([[5.0, 9.0], [6.1, 9.0], [6.1, 0.5]])  # a cube of 1 has a surface of 6
    solution = small.solve([1.0, 50.0], 1.3, 1e-2, 1e2, weights=(0.0, 1.0), slopes=(0.0, 0.0), cutoffs=cutoffs, count=3)
    assert solution.converged.tolist() == [False, True, False]
    # The best that can be done lies between breaking the cap alone and breaking both rows alike.
    assert 0.5 * np.log(6 / 5) <= solution.violation[0] <= np.log(6 / 5) + 1e-6
    assert solution.violation[1] <= 1e-8
    assert solution.violation[2] > 0.1


@EVERY
def test_an_elastic_task_breaks_all_limits_alike(code):
    def squeeze(x, d):
        return [("at_least", x[0], d[0]), ("at_most", x[0], 1.0), ("at_most", x[1], 7.0)], [x[0] + x[1]]

    small = Small(2, 1, squeeze, code=code)
    solution = small.solve([np.array([2.0, 8.0])], 1.0, 1e-3, 1e3, weights=(0.0,), t_weight=1.0, elastic=1.0, count=2)
    np.testing.assert_allclose(solution.t, 0.5 * np.log([2.0, 8.0]), atol=1e-8)
    np.testing.assert_allclose(solution.variables[:, 0], np.sqrt([2.0, 8.0]), rtol=1e-7)
    assert solution.violation.max() <= 1e-9
    assert solution.converged.all()


@EVERY
def test_guards_never_give_way_and_open_the_way_to_other_formulas(code):
    def start_up(x, d):
        root = ca.sqrt(x[0] - d[0])
        return [("at_least", x[0], d[0]), ("at_most", root, 0.5)], [1 / root]

    small = Small(1, 1, start_up, guards=(0,), code=code)
    # Below 3 the other formulas are not a number; two of the searches begin there.
    solution = small.solve(
        [3.0],
        [[0.5], [2.999], [9.0]],
        0.1,
        10.0,
        weights=(0.0,),
        slopes=(1.0,),
        cutoffs=(0.0,),
        t_weight=1.0,
        elastic=1.0,
        count=3,
    )
    np.testing.assert_allclose(solution.variables, 3.5, rtol=1e-8)
    np.testing.assert_allclose(solution.t, 0.5 * np.log(2.0), atol=1e-8)
    assert solution.violation.max() <= 1e-9

    def tight(x, d):
        return [("at_least", x[0], d[0])], [x[0]]

    barely = Small(1, 1, tight, guards=(0,), code=code).solve(
        [3.0], 5.0, 0.1, 10.0, t_weight=1.0, slopes=(1.0,), cutoffs=(0.0,), elastic=5.0, weights=(0.0,)
    )
    assert barely.variables[0, 0] == pytest.approx(3.0 * np.exp(GUARD_MARGIN), rel=1e-8)


@EVERY
def test_a_kink_on_the_way_is_crossed_and_one_at_the_end_is_approached(code):
    def bent(x, d):
        cost = ca.if_else(x[0] < 2.0, 5.0 - x[0], 3.0 + (x[0] - 2.0) ** 2 - (x[0] - 2.0))
        return [("at_most", x[0], d[0])], [cost]

    small = Small(1, 1, bent, code=code)
    solution = small.solve([np.array([9.0, 2.2])], [[0.3], [1.0]], 0.1, 10.0, count=2)
    np.testing.assert_allclose(solution.variables[:, 0], [2.5, 2.2], rtol=1e-4)
    assert solution.converged.all()

    def valley(x, d):
        return [("at_most", x[0], 50.0)], [ca.fmax(x[0], d[0] / x[0])]

    end = Small(1, 1, valley, code=code).solve([4.0], [[0.3], [20.0]], 0.1, 100.0, count=2)
    np.testing.assert_allclose(end.phi[:, 0], np.log(2.0), atol=1e-3)
    assert end.violation.max() == 0.0


@EVERY
def test_rows_of_any_sign_enter_by_a_scaled_difference(code):
    def slope(x, d):
        height = (x[0] - 1.0) ** 2 + x[1]
        return [("at_most", -x[1], d[0]), ("at_least", x[0] - x[1], -3.0)], [height]

    small = Small(2, 1, slope, logs=False, code=code)
    # -x1 <= d0, so the least height is -d0, at x0 = 1 where the second limit allows
    solution = small.solve([np.array([2.0, -1.0, 0.0, -9.0])], (0.0, 0.0), -10.0, 10.0, count=4)
    np.testing.assert_allclose(solution.variables, [[1, -2], [1, 1], [1, 0], [6, 9]], atol=2e-4)
    np.testing.assert_allclose(solution.phi[:, 0], [-2.0, 1.0, 0.0, 34.0], atol=1e-7)
    assert solution.converged.all()


@EVERY
def test_objectives_with_a_sense_and_a_scale(code):
    def write(x, d):
        return [("at_most", x[0] * x[1], d[0])], [x[0] - x[1]]

    small = Small(2, 1, write, logs=False)
    upward = replace(small.rows, goals=(Goal(small.rows.goals[0].node, -1),))
    solver = solver_of(small.program, 2, upward, code)
    assert solver.compiled == (code != "arrays")
    tasks = Tasks(np.ones((1, 1)), np.zeros((1, 1)), np.full((1, 1), np.inf), np.array([4.0]), 0.0)
    low, high = np.array([[0.5, 0.5]]), np.array([[9.0, 9.0]])
    inputs = ProblemInputs([3.0], low, high, [0.0], np.zeros((1, 1), dtype=bool))
    solution = solver.solve(tasks, inputs, np.array([[1.0, 1.0]]))
    np.testing.assert_allclose(solution.variables[0], [6.0, 0.5], atol=1e-6)
    assert solution.phi[0, 0] == pytest.approx(-5.5 / 4, abs=1e-8)


@pytest.mark.parametrize("code", ["arrays", "general", "own"])
def test_without_variables_the_rows_are_evaluated(code):
    x, d = ca.SX.sym("none", 0), [ca.SX.sym("a"), ca.SX.sym("b")]
    program = Program([*x.nonzeros(), *d], [d[0] * d[1], d[0] + d[1], d[0]])
    value, goal, other = program.outputs
    rows = Rows((NodeConstraint("at_most", value, None, 1e-9),), (Goal(goal), Goal(other)), (True,), (True, False), ())
    solver = BatchNlp(program, 0, rows, code)
    nothing = np.empty((3, 0))
    data = [np.array([2.0, 3.0, 4.0]), np.array([1.0, 2.0, 3.0])]
    tasks = Tasks(np.ones((3, 2)), np.zeros((3, 2)), np.full((3, 2), np.inf), np.array([1.0, 2.0]), 0.0)
    void = np.array([[False], [False], [True]])
    solution = solver.solve(tasks, ProblemInputs(data, nothing, nothing, [4.0], void), nothing)
    np.testing.assert_allclose(solution.phi, np.stack([np.log([3.0, 5.0, 7.0]), [1.0, 1.5, 2.0]], axis=1))
    np.testing.assert_allclose(solution.violation, [0.0, np.log(6 / 4), 0.0])
    assert solution.variables.shape == (3, 0)
    moving = Tasks(np.zeros((3, 2)), np.full((3, 2), 0.5), np.zeros((3, 2)), np.array([1.0, 2.0]))
    solution = solver.solve(moving, ProblemInputs(data, nothing, nothing, [4.0], void), nothing)
    np.testing.assert_allclose(solution.t, 2 * np.maximum(np.log([3.0, 5.0, 7.0]), [1.0, 1.5, 2.0]))


@EVERY
def test_an_empty_batch_is_an_empty_answer(code):
    small = Small(3, 2, box, code=code)
    solution = small.solve(
        [2.0, 0.9], 1.0, 1e-2, 1e2, weights=(1.0, 0.0), slopes=(0.0, 0.0), cutoffs=(np.inf, np.inf), count=0
    )
    assert solution.variables.shape == (0, 3)
    assert solution.converged.shape == (0,)


FUNCTIONS = {
    "powers": lambda x: x**1.5 + x**-2 + 2.0**x + x**2,
    "roots": lambda x: ca.sqrt(x) + ca.log1p(x) + ca.expm1(0.3 * x) + ca.exp(-x),
    "circle": lambda x: 3 + ca.sin(x) + ca.cos(0.5 * x) + ca.atan(x) + ca.tan(0.1 * x) + ca.atan2(x, 2),
    "arcs": lambda x: ca.asin(0.05 * x) + ca.acos(0.05 * x) + ca.hypot(x, 1) + ca.copysign(x, 1),
    "hyperbolic": lambda x: ca.sinh(0.2 * x) + ca.cosh(0.1 * x) + ca.tanh(x) + ca.asinh(x) + ca.erf(x),
    "inverse": lambda x: ca.acosh(1 + x) + ca.atanh(0.05 * x) + 1 / x,
    "steps": lambda x: 9 + ca.floor(0.01 * x) + ca.ceil(0.01 * x) + ca.sign(x) + ca.fmod(x, 100) + ca.fabs(x),
    "choices": lambda x: ca.if_else(
        ca.logic_and(x > 1, ca.logic_not(x >= 40)), ca.fmin(x, 60), ca.if_else(ca.logic_or(x == 3, x != 5), 1 + x, 2)
    ),
}


@BUILT
def test_functions_of_the_kernel_have_the_values_of_numpy():
    def write(x, d):
        return [("at_most", x[0] * d[0], 1e3)], [function(x[0]) for function in FUNCTIONS.values()]

    pair = [Small(1, 1, write, logs=False, code=own) for own in ("arrays", "kernel")]
    points = np.linspace(0.2, 15.0, 40)[:, None]  # pinned: only evaluated
    none = np.zeros(len(FUNCTIONS))
    plain, compiled = (
        small.solve([1.0], points, points, points, None, none + 1, none, none + np.inf, count=40) for small in pair
    )
    for k, (name, function) in enumerate(FUNCTIONS.items()):
        with np.errstate(all="ignore"):
            expected = np.array([float(ca.DM(function(ca.DM(x)))) for x in points.ravel()])
        np.testing.assert_allclose(plain.phi[:, k], expected, rtol=1e-12, err_msg=name)
        np.testing.assert_allclose(compiled.phi[:, k], expected, rtol=1e-12, err_msg=name)


# -- the multi-plate clutch, with IPOPT as referee ---------------------------------------------

REQUIREMENTS = {
    "load_torque": "600 N*m",
    "driver_speed": "26.6 rad/s",
    "driven_inertia": "30 kg*m2",
    "engagements_per_hour": "50 1/h",
    "jerk_limit": "18 rad/s3",
}
OBJECTIVES = ("mass", "actuation_force")


class Clutch:
    """Random combinations of the catalogue, each with a box of the variables and a task."""

    def __init__(self, count: int, seed: int, kind: str) -> None:
        self.instance = instance_of(synth.load("multi_plate_clutch", practice="off"), REQUIREMENTS, as_catalogs(None))
        self.model = model = self.instance.model
        self.n = len(model.variables)
        self.rows = Rows(
            constraints=tuple(NodeConstraint.of(x) for x in model.constraints),
            goals=tuple(Goal(model.quantity_node[name]) for name in OBJECTIVES),
            log_constraints=tuple(x.sense != "equal" for x in model.limits),
            log_goals=(True,) * len(OBJECTIVES),
            log_variables=tuple(bool(x > 0) for x in self.instance.ranges.lower),
        )
        self.bounds = [0.0] * len(self.rows.constraints)
        rng = np.random.default_rng(seed)
        # Around most of the points, which are sound (rings of a sensible ratio), something is feasible.
        combination, point = self._points(80_000, rng)
        feasible = model.evaluate(point, self.instance.data(combination)).feasible
        chosen = np.concatenate([np.flatnonzero(feasible)[: count * 4 // 5], np.flatnonzero(~feasible)])[:count]
        assert feasible.sum() >= count * 4 // 5
        combination, point = combination[chosen], point[chosen]
        self.data = self.instance.data(combination)
        spread = rng.uniform(1.3, 2.5, (count, self.n))
        self.low = np.maximum(point / spread, self.instance.ranges.lower)
        self.high = np.minimum(point * spread, self.instance.ranges.upper)
        if kind == "pinned":
            self.low[:, 3] = self.high[:, 3] = point[:, 3]
        self.start = np.sqrt(self.low * self.high)
        phi = np.log(np.stack([model.evaluate(point, self.data).values[name] for name in OBJECTIVES], axis=1))
        cutoffs = phi + rng.normal(0.1, 0.3, (count, 2))
        if kind == "single":
            self.tasks = Tasks(np.tile([1.0, 1e-6], (count, 1)), np.zeros((count, 2)), cutoffs, np.ones(2), 0.0)
            self.tasks.cutoffs[:, 0] = np.inf
        else:
            slopes = np.exp(rng.uniform(-2.0, 0.5, (count, 2)))
            self.tasks = Tasks(np.full((count, 2), 1e-6), slopes, cutoffs, np.ones(2))
        self.void = np.stack([x.void(self.data, (count,)) for x in model.constraints], axis=1)

    def _points(self, count: int, rng: np.random.Generator) -> tuple[np.ndarray, np.ndarray]:
        outer = rng.uniform(0.15, 0.45, count)
        force, ramp = np.exp(rng.uniform(np.log([[4e3], [0.1]]), np.log([[6e4], [4.0]]), (2, count)))
        point = np.stack([outer, outer * rng.uniform(0.65, 0.78, count), force, ramp], axis=1)
        return rng.integers(0, self.instance.combinations.count, count), point

    def solve(self, code: Code, workers: int = 1) -> Solutions:
        solver = BatchNlp(self.model.program, self.n, self.rows, code)
        inputs = ProblemInputs(self.data, self.low, self.high, self.bounds, self.void)
        return solver.solve(self.tasks, inputs, self.start, workers)

    def cost(self, phi: np.ndarray, t: np.ndarray) -> np.ndarray:
        return (self.tasks.weights * phi).sum(axis=1) + self.tasks.t_weight * t

    def judged(self, variables: np.ndarray, t: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return objectives and the largest violation at points, from the model alone."""
        result = self.model.evaluate(variables, self.data)
        with np.errstate(all="ignore"):
            phi = np.log(np.stack([result.values[name] for name in OBJECTIVES], axis=1))
            worst = np.max(np.nan_to_num(phi - self.tasks.slopes * t[:, None] - self.tasks.cutoffs, nan=np.inf), axis=1)
            for j, limit in enumerate(self.model.limits):
                value, bound = result.limits[limit.name]
                form = np.log(value / bound) * (-1 if limit.sense == "at_least" else 1)
                form = np.where(self.void[:, j], -np.inf, form + (GUARD_MARGIN if limit.guard else 0.0))
                worst = np.maximum(worst, np.nan_to_num(form, nan=np.inf, posinf=np.inf, neginf=-np.inf))
        return phi, np.maximum(worst, 0.0)

    def referee(self) -> tuple[np.ndarray, np.ndarray]:
        """Return variables and t of IPOPT; not a number where it gave none."""
        nlp = ParametricNlp(self.model.program, self.n, self.rows)
        variables, t = np.full_like(self.start, np.nan), np.full(len(self.start), np.nan)
        tasks = self.tasks
        for k in range(len(t)):
            task = Task(tasks.weights[k], tasks.slopes[k], tasks.cutoffs[k], tasks.goal_scales, tasks.t_weight)
            data = [float(np.broadcast_to(x, len(t))[k]) for x in self.data]
            answer = nlp.solve(task, data, self.start[k], self.low[k], self.high[k], self.bounds, self.void[k])
            if answer is not None:
                variables[k], t[k] = answer.variables, answer.t
        return variables, t


@pytest.mark.slow
@pytest.mark.parametrize(("kind", "count"), [("chebyshev", 140), ("single", 80), ("pinned", 80)])
def test_ipopt_finds_nothing_better(kind, count):
    clutch = Clutch(count, 3, kind)
    solution = clutch.solve("arrays")
    phi, violation = clutch.judged(solution.variables, solution.t)
    np.testing.assert_allclose(np.minimum(violation, 1e3), np.minimum(solution.violation, 1e3), atol=1e-9)
    holds = violation <= 1e-8
    np.testing.assert_allclose(phi[holds], solution.phi[holds], atol=1e-9)
    with np.errstate(all="ignore"):
        other_phi, other_violation = clutch.judged(*(answer := clutch.referee()))
    other_holds = other_violation <= 1e-7
    assert other_holds.sum() > 0.3 * count
    # What the one calls infeasible and the other finds: a few per cent may be missed.
    missed = other_holds & ~holds
    assert missed.sum() <= 0.02 * other_holds.sum()
    both = holds & other_holds
    ours, theirs = clutch.cost(phi, solution.t)[both], clutch.cost(other_phi, answer[1])[both]
    assert np.sum(ours > theirs + 1e-7) <= 0.02 * both.sum()
    assert np.mean(np.abs(ours - theirs) <= 1e-7) > 0.9
    assert solution.converged[holds].mean() > 0.95


@pytest.mark.slow
@BUILT
@pytest.mark.parametrize("kind", ["chebyshev", "single", "pinned"])
def test_kernel_and_arrays_give_the_same(kind):
    clutch = Clutch(600, 4, kind)
    plain, compiled = clutch.solve("arrays"), clutch.solve("kernel")
    holds = plain.violation <= 1e-8
    assert holds.sum() > 100
    assert np.sum(holds != (compiled.violation <= 1e-8)) <= 3  # rounding decides now and then
    both = plain.converged & compiled.converged
    assert both.sum() > 0.95 * holds.sum()
    difference = np.abs(clutch.cost(plain.phi, plain.t) - clutch.cost(compiled.phi, compiled.t))[both]
    # Two optima of one problem may be reached from the same start, but hardly ever are.
    assert np.sum(difference > 1e-8) <= 2
    violation = clutch.judged(compiled.variables, compiled.t)[1]
    np.testing.assert_allclose(np.minimum(violation, 1e3), np.minimum(compiled.violation, 1e3), atol=1e-9)


@pytest.mark.slow
@EVERY
@pytest.mark.parametrize("kind", ["chebyshev", "single"])
def test_the_answers_do_not_depend_on_the_number_of_threads(code, kind):
    clutch = Clutch(600, 4, kind)  # more than one thread takes at a time
    alone = clutch.solve(code)
    for workers in (2, 3):
        together = clutch.solve(code, workers)
        for field in fields(Solutions):
            np.testing.assert_array_equal(getattr(together, field.name), getattr(alone, field.name), field.name)


@EVERY
def test_threads_may_share_a_solver(code):
    small = Small(3, 2, box, code=code)
    more = {"weights": (1.0, 0.0), "slopes": (0.0, 0.0), "cutoffs": (np.inf, np.inf), "count": 50}
    volumes = [np.linspace(0.5, 1.0 + k, 50) for k in range(6)]
    alone = [small.solve([v, 50.0], 1.0, 1e-2, 1e2, **more).variables for v in volumes]
    with ThreadPoolExecutor(3) as pool:
        together = list(pool.map(lambda v: small.solve([v, 50.0], 1.0, 1e-2, 1e2, **more).variables, volumes))
    np.testing.assert_array_equal(together, alone)


def test_starts_where_nothing_exists_find_the_way():
    clutch = Clutch(300, 5, "chebyshev")
    good = clutch.solve("arrays").violation <= 1e-8
    # From corners of the box the rings are often inside out, or the load is never moved.
    clutch.start = np.where(np.random.default_rng(6).random(clutch.start.shape) < 0.5, clutch.low, clutch.high)
    again = clutch.solve("arrays").violation <= 1e-8
    assert np.sum(good & ~again) <= 0.02 * good.sum()


# -- the kernel ----------------------------------------------------------------------------------


@BUILT
def test_what_is_too_large_for_the_kernel_is_solved_over_arrays():
    most = kernel_solver.MOST["N"]
    for n in (most, most + 1):
        small = Small(n, 1, lambda x, d: ([("at_least", sum(x), d[0])], [sum(y * y for y in x)]))
        small.solver = BatchNlp(small.program, n, small.rows)
        assert small.solver.compiled == (n == most)
        np.testing.assert_allclose(small.solve([float(n)], 2.0, 0.1, 9.0).variables, np.ones((1, n)), rtol=1e-4)


@pytest.mark.slow
@BUILT
@pytest.mark.parametrize("level", [level for level in LEVELS if level < processor_level()])
@pytest.mark.parametrize("kind", ["chebyshev", "single", "pinned"])
def test_the_kernel_gives_the_same_bits_on_every_processor(kind, level, monkeypatch):
    best = Clutch(200, 4, kind).solve("kernel")
    monkeypatch.setattr(kernel_solver, "kernel", lambda name: variant(name, level))
    other = Clutch(200, 4, kind).solve("kernel")
    for field in fields(Solutions):
        assert getattr(best, field.name).tobytes() == getattr(other, field.name).tobytes(), field.name


@BUILT
def test_settings_of_the_method_reach_the_kernel():
    method = replace(TUNING.nlp.method, max_evaluations=2)
    given_up = Small(3, 2, box, code="kernel", settings=replace(TUNING.nlp, method=method))
    more = {"weights": (1.0, 0.0), "slopes": (0.0, 0.0), "cutoffs": (np.inf, np.inf)}
    assert not given_up.solve([np.array([1.0]), 50.0], 1.0, 1e-2, 1e2, **more).converged.any()
