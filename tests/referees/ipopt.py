"""The referee: one continuous problem of one combination of parts and counts, solved by IPOPT.

No search uses it. Tests and benchmarks ask it what the engine's own solvers (:mod:`synth.nlp.batch`) should have found:
it shares the rows with them, but neither derivatives nor method. Positive variables and positive quantities enter by
their logarithm, as there. All scalar problems are one problem with different parameters:

    minimise  weights . phi + t_weight t + variable_weights . y
    over y, t such that  limits(y) - elastic t <= 0,  phi_k(y) - slope_k t <= cutoff_k

``min``, ``max`` and ``where`` never reach IPOPT: a branch fixes which piece is used and carries the piece's condition
as a row of its own.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import casadi as ca
import numpy as np

from synth.model.program import OP_SELECT, Program
from synth.nlp.rows import GUARD_MARGIN, Rows

IPOPT: dict[str, Any] = {
    "print_time": False,
    "ipopt.print_level": 0,
    "ipopt.sb": "yes",
    "ipopt.tol": 1e-10,
    "ipopt.constr_viol_tol": 1e-10,
    "ipopt.compl_inf_tol": 1e-10,
    "ipopt.bound_relax_factor": 0.0,
    "ipopt.max_iter": 150,
    "ipopt.mu_strategy": "adaptive",
    "error_on_fail": False,
    "show_eval_warnings": False,
    "calc_lam_p": False,
}
ACTIVE = 1e-6  # in the units of the solver: so close to its border a piece is exchanged for its neighbour
MAX_FLIPS = 6  # pieces that are tried; the referee of the tests, which asks one problem at a time


@dataclass(frozen=True)
class Solution:
    """Where the solver ended; nothing in it is trusted before it is re-evaluated."""

    variables: np.ndarray
    phi: np.ndarray
    t: float
    constraint_multipliers: np.ndarray
    goal_multipliers: np.ndarray
    converged: bool


@dataclass(frozen=True)
class Task:
    """One scalar problem: parameters of the NLP.

    Objectives enter as phi: logarithm, or value over ``goal_scales`` where they may be zero or negative.
    """

    weights: np.ndarray
    slopes: np.ndarray
    cutoffs: np.ndarray
    goal_scales: np.ndarray
    t_weight: float = 1.0
    elastic: float = 0.0
    variable_weights: np.ndarray | None = None


class Branches:
    """The pieces of min, max, abs and where in a program, and the smooth program of each choice of pieces."""

    def __init__(self, program: Program, n_variables: int, wanted: Sequence[int]) -> None:
        self.program = program
        self.wanted = list(wanted)
        dependent = program.dependence(range(n_variables))
        self.decisions = [
            k
            for k in program.needed(wanted)
            if dependent[k] and program.nodes[k].op in (ca.OP_LT, ca.OP_LE, ca.OP_FMIN, ca.OP_FMAX, ca.OP_FABS)
        ]
        sides = [a for k in self.decisions for a in self._sides(k)]
        self._evaluate = program.compile(sides) if sides else None

    def _sides(self, k: int) -> tuple[int, int]:
        node = self.program.nodes[k]
        return (node.args[0], node.args[1]) if len(node.args) == 2 else (node.args[0], node.args[0])

    def at(self, inputs: Sequence[Any]) -> tuple[tuple[bool, ...], np.ndarray]:
        """Pieces that hold at a point, and the size of both sides of every condition."""
        if self._evaluate is None:
            return (), np.empty(0)
        with np.errstate(all="ignore"):
            values = [float(np.asarray(x).ravel()[0]) for x in self._evaluate(inputs)]
        chosen, size = [], []
        for position, k in enumerate(self.decisions):
            a, b = values[2 * position : 2 * position + 2]
            op = self.program.nodes[k].op
            chosen.append(bool(a >= 0) if op == ca.OP_FABS else bool(a < b))
            size.append(max(abs(a), abs(b), 1e-12))
        return tuple(chosen), np.array(size)

    def smooth(self, pieces: tuple[bool, ...], inputs: Sequence[Any]) -> tuple[list[Any], list[tuple[int, Any]]]:
        """Return the wanted nodes as expressions of one branch, and the conditions of its live pieces.

        Conditions are ``(position, expression)`` with expression <= 0 where the piece is the right one.
        """
        nodes, values = self.program.nodes, dict[int, Any]()
        chosen = dict(zip(self.decisions, pieces, strict=True))
        live = self._live(chosen)
        for k in sorted(live):
            node = nodes[k]
            values[k] = self._expression(k, node, values, chosen, inputs)
        conditions = []
        for position, k in enumerate(self.decisions):
            if k in live:
                a, b = self._sides(k)
                difference = -values[a] if nodes[k].op == ca.OP_FABS else values[a] - values[b]
                conditions.append((position, difference if pieces[position] else -difference))
        return [values[k] for k in self.wanted], conditions

    def _live(self, chosen: Mapping[int, bool]) -> set[int]:
        live: set[int] = set()
        stack = list(self.wanted)
        while stack:
            k = stack.pop()
            if k in live:
                continue
            live.add(k)
            stack += self._reads(k, chosen)
        return live

    def _reads(self, k: int, chosen: Mapping[int, bool]) -> list[int]:
        node = self.program.nodes[k]
        if node.op in (OP_SELECT, ca.OP_IF_ELSE_ZERO):
            truth = self._truth(node.args[0], chosen)
            if truth is True:
                return [node.args[0], node.args[1]]
            if truth is False:
                return [node.args[0], *node.args[2:]]
        return list(node.args)

    def _truth(self, k: int, chosen: Mapping[int, bool]) -> bool | None:
        node = self.program.nodes[k]
        if k in chosen:
            return chosen[k]
        if node.op == ca.OP_NOT:
            inner = self._truth(node.args[0], chosen)
            return None if inner is None else not inner
        if node.op in (ca.OP_AND, ca.OP_OR):
            inner_truths = [self._truth(a, chosen) for a in node.args]
            stop = node.op == ca.OP_OR
            if stop in inner_truths:
                return stop
            return None if None in inner_truths else not stop
        return None

    def _expression(
        self, k: int, node: Any, values: Mapping[int, Any], chosen: Mapping[int, bool], inputs: Sequence[Any]
    ) -> Any:
        if node.op == ca.OP_CONST:
            return ca.SX(node.constant)
        if node.op == ca.OP_INPUT:
            return inputs[int(node.constant)]
        if k in chosen:
            if node.op in (ca.OP_LT, ca.OP_LE):
                return ca.SX(float(chosen[k]))
            if node.op == ca.OP_FABS:
                return values[node.args[0]] if chosen[k] else -values[node.args[0]]
            first_smaller = chosen[k]
            keep_first = first_smaller if node.op == ca.OP_FMIN else not first_smaller
            return values[node.args[0 if keep_first else 1]]
        if node.op in (OP_SELECT, ca.OP_IF_ELSE_ZERO):
            truth = self._truth(node.args[0], chosen)
            if truth is True:
                return values[node.args[1]]
            if truth is False:
                return values[node.args[2]] if node.op == OP_SELECT else ca.SX(0.0)
            other = values[node.args[2]] if node.op == OP_SELECT else ca.SX(0.0)
            return ca.if_else(values[node.args[0]], values[node.args[1]], other)
        return self.program.apply(node, [values[a] for a in node.args])


class ParametricNlp:
    """The NLP of one set of rows; solvers of its branches are built when first needed."""

    def __init__(self, program: Program, n_variables: int, rows: Rows) -> None:
        self.program = program
        self.n = n_variables
        self.rows = rows
        wanted = [c.value for c in rows.constraints]
        wanted += [c.limit for c in rows.constraints if c.limit is not None]
        wanted += [g.node for g in rows.goals]
        self.branches = Branches(program, n_variables, wanted)
        self._solvers: dict[tuple[bool, ...], tuple[Any, list[int]]] = {}
        self.solves = 0
        self._sizes = program.compile(wanted)

    def _build(self, pieces: tuple[bool, ...]) -> tuple[Any, list[int]]:
        rows, n = self.rows, self.n
        y, t = ca.SX.sym("y", n), ca.SX.sym("t")
        data = ca.SX.sym("data", self.program.n_inputs - n)
        bounds = ca.SX.sym("bounds", len(rows.constraints))
        sizes = ca.SX.sym("sizes", len(rows.constraints) + len(rows.goals))
        weights, slopes = ca.SX.sym("weights", len(rows.goals)), ca.SX.sym("slopes", len(rows.goals))
        variable_weights = ca.SX.sym("variable_weights", n)
        t_weight, elastic = ca.SX.sym("t_weight"), ca.SX.sym("elastic")
        variables = [ca.exp(y[i]) if rows.log_variables[i] else y[i] for i in range(n)]
        inputs = variables + [data[i] for i in range(self.program.n_inputs - n)]
        outputs, conditions = self.branches.smooth(pieces, inputs)
        sides = iter(outputs)
        values = [next(sides) for _ in rows.constraints]
        limits = [bounds[j] if c.limit is None else next(sides) for j, c in enumerate(rows.constraints)]
        goals = [next(sides) for _ in rows.goals]
        constraint_rows = []
        for j, constraint in enumerate(rows.constraints):
            form = ca.log(values[j] / limits[j]) if rows.log_constraints[j] else (values[j] - limits[j]) / sizes[j]
            # A guard never gives way, and holds only strictly: beyond it the other formulas do not exist.
            give = -GUARD_MARGIN if constraint.guard else elastic * t
            constraint_rows.append((-form if constraint.sense == "at_least" else form) - give)
        phi = []
        for j, goal in enumerate(rows.goals):
            form = ca.log(goals[j]) if rows.log_goals[j] else goals[j] / sizes[len(rows.constraints) + j]
            phi.append(goal.sign * form)
        goal_rows = [phi[j] - slopes[j] * t for j in range(len(phi))]
        condition_sizes = ca.SX.sym("condition_sizes", len(self.branches.decisions))
        condition_rows = [expression / condition_sizes[position] for position, expression in conditions]
        cost = ca.dot(weights, ca.vertcat(*phi)) + t_weight * t + ca.dot(variable_weights, y)
        parameters = ca.vertcat(
            data, bounds, sizes, weights, slopes, variable_weights, t_weight, elastic, condition_sizes
        )
        g = ca.vertcat(*constraint_rows, *goal_rows, *condition_rows)
        problem = {"x": ca.vertcat(y, t), "p": parameters, "f": cost, "g": g}
        solver = ca.nlpsol("nlp", "ipopt", problem, IPOPT)
        objectives = ca.Function("objectives", [problem["x"], parameters], [ca.vertcat(*phi)])
        return (solver, objectives), [position for position, _ in conditions]

    def to_search(self, variables: np.ndarray) -> np.ndarray:
        """Return SI variables as the solver sees them (logarithm where positive)."""
        logs = np.array(self.rows.log_variables)
        with np.errstate(all="ignore"):
            return np.where(logs, np.log(np.where(logs, variables, 1.0)), variables)

    def solve(
        self,
        task: Task,
        data: Sequence[float],
        start: np.ndarray,
        low: np.ndarray,
        high: np.ndarray,
        bounds: Sequence[float],
        void: np.ndarray,
    ) -> Solution | None:
        """Solve from one start, moving to a neighbouring branch when the solution lies on the border of its own.

        Parameters
        ----------
        task : Task
        data : list of float
            Data inputs of the combination; void columns as NaN.
        start, low, high : array (variables,)
            SI.
        bounds : list of float
            Constant right sides, in the order of the constraints.
        void : array of bool
            Constraints that do not count for this combination.

        Returns
        -------
        Solution, or None when no branch gave a finite point.
        """
        clean = [1.0 if np.isnan(x) else float(x) for x in data]
        x0 = np.clip(start, low, high)
        best: Solution | None = None
        tried: set[tuple[bool, ...]] = set()
        waiting = [(self.branches.at([*x0, *clean])[0], x0)]
        while waiting and len(tried) < MAX_FLIPS:
            pieces, x0 = waiting.pop(0)
            if pieces in tried:
                continue
            tried.add(pieces)
            solution, border = self._solve_branch(pieces, task, clean, x0, low, high, bounds, void)
            if solution is None:
                continue
            if best is None or (solution.converged, -self._cost(task, solution)) > (
                best.converged,
                -self._cost(task, best),
            ):
                best = solution
            for position in border:
                flipped = tuple(p != (k == position) for k, p in enumerate(pieces))
                waiting.append((flipped, solution.variables))
        return best

    def _cost(self, task: Task, solution: Solution) -> float:
        cost = float(task.weights @ solution.phi) + task.t_weight * solution.t
        if task.variable_weights is not None:
            cost += float(task.variable_weights @ self.to_search(solution.variables))
        return cost

    def _solve_branch(
        self,
        pieces: tuple[bool, ...],
        task: Task,
        data: Sequence[float],
        x0: np.ndarray,
        low: np.ndarray,
        high: np.ndarray,
        bounds: Sequence[float],
        void: np.ndarray,
    ) -> tuple[Solution | None, list[int]]:
        if pieces not in self._solvers:
            self._solvers[pieces] = self._build(pieces)
        (solver, objectives), positions = self._solvers[pieces]
        rows, n = self.rows, self.n
        _, condition_sizes = self.branches.at([*x0, *data])
        sizes = self._row_sizes(task, x0, data, bounds)
        variable_weights = np.zeros(n) if task.variable_weights is None else task.variable_weights
        parameters = np.concatenate(
            [
                data,
                bounds,
                sizes,
                task.weights,
                task.slopes,
                variable_weights,
                [task.t_weight, task.elastic],
                condition_sizes,
            ]
        )
        equal = np.array([c.sense == "equal" for c in rows.constraints], dtype=bool)
        upper_g = np.zeros(len(rows.constraints))
        lower_g = np.where(void | ~equal, -np.inf, 0.0)
        upper_g[void] = np.inf
        lower = np.concatenate([lower_g, np.full(len(rows.goals) + len(positions), -np.inf)])
        upper = np.concatenate([upper_g, task.cutoffs, np.zeros(len(positions))])
        free_t = task.t_weight != 0.0 or task.elastic != 0.0
        t_bound = np.inf if free_t else 0.0
        low_y, high_y = self.to_search(low), self.to_search(high)
        answer = solver(
            x0=[*self.to_search(x0), 1.0 if free_t else 0.0],
            p=parameters,
            lbx=[*low_y, -t_bound],
            ubx=[*high_y, t_bound],
            lbg=lower,
            ubg=upper,
        )
        self.solves += 1
        x = np.asarray(answer["x"]).ravel()
        if not np.all(np.isfinite(x)):
            return None, []
        y = np.clip(x[:n], low_y, high_y)
        variables = np.where(rows.log_variables, np.exp(np.where(rows.log_variables, y, 0.0)), y)
        variables = np.clip(variables, low, high)
        multipliers = np.asarray(answer["lam_g"]).ravel()
        phi = objectives(x, parameters)
        g = np.asarray(answer["g"]).ravel()
        first = len(rows.constraints) + len(rows.goals)
        border = [p for k, p in enumerate(positions) if abs(g[first + k]) < ACTIVE]
        solution = Solution(
            variables=variables,
            phi=np.asarray(phi).ravel(),
            t=float(x[n]),
            constraint_multipliers=multipliers[: len(rows.constraints)],
            goal_multipliers=multipliers[len(rows.constraints) : first],
            converged=bool(solver.stats()["success"]),
        )
        return solution, border

    def _row_sizes(self, task: Task, x0: np.ndarray, data: Sequence[float], bounds: Sequence[float]) -> np.ndarray:
        with np.errstate(all="ignore"):
            raw = [abs(float(np.asarray(v).ravel()[0])) for v in self._sizes([*x0, *data])]
        constraints = self.rows.constraints
        values = raw[: len(constraints)]
        moving = iter(raw[len(constraints) : len(raw) - len(self.rows.goals)])
        limits = [abs(bounds[j]) if c.limit is None else next(moving) for j, c in enumerate(constraints)]
        sizes = [max(v, b, c.scale) for v, b, c in zip(values, limits, constraints, strict=True)]
        return np.array([*(s if np.isfinite(s) else 1.0 for s in sizes), *task.goal_scales])
