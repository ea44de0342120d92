"""An independent reference for small problems: enumeration of all that is discrete, dense search of the rest.

It reads the plain NumPy formulas of a case and its own definition of a limit that holds. Nothing of the engine is used:
no trace, no bounds, no solver. What it finds are points; a point that is feasible and better than a front allows
refutes the front, so a weak search can only miss a fault and never invent one.
"""

from __future__ import annotations

import itertools
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from scipy.optimize import minimize

from tests.certificates.structures import Case, Label

TOLERANCE = 1e-6
SMALLEST = 1e-9
EXPLORED = 40_000
ROUNDS = 40
TRIES = 12
GROUPS = 3
POLISHED = 3
PER_TUPLE = 24
KEPT = 12
ENTERED = 200
SHORT = 2000
NEAREST = 12
REFUSED = 10.0  # added to the residual of a guard that fails, so that it counts before all else


def missed(value: Any, limit: Any, sense: str) -> tuple[np.ndarray, np.ndarray]:
    """Return by how much a limit is missed, and the size that this is a share of."""
    value, limit = np.asarray(value, dtype=float), np.asarray(limit, dtype=float)
    by = {"at_most": value - limit, "at_least": limit - value, "equal": np.abs(value - limit)}[sense]
    return by, np.maximum(np.maximum(np.abs(value), np.abs(limit)), SMALLEST)


@dataclass(frozen=True)
class Points:
    """Designs found: the discrete tuple of each, its free variables, signed objectives and worst residual."""

    which: np.ndarray
    x: np.ndarray
    objectives: np.ndarray
    worst: np.ndarray

    def __len__(self) -> int:
        return len(self.which)

    def take(self, rows: np.ndarray) -> Points:
        return Points(self.which[rows], self.x[rows], self.objectives[rows], self.worst[rows])

    @staticmethod
    def joined(parts: Sequence[Points]) -> Points:
        return Points(*(np.concatenate([getattr(p, n) for p in parts]) for n in ("which", "x", "objectives", "worst")))


class Reference:
    """One case: its discrete tuples (rows, counts, labels, makeable values) and the box of its free variables."""

    def __init__(self, case: Case) -> None:
        self.case = case
        self.rng = np.random.default_rng(case.seed)
        self.signs = np.array([1.0 if sense == "min" else -1.0 for sense in case.objectives.values()])
        self.bounds = {n: self._bounds(n) for n in case.variables}
        self.columns = {
            slot: {f"{slot}.{c}": case.tables[table][c].to_numpy(float) for c in self._used(slot)}
            for slot, table in case.slots.items()
        }
        discrete = {**self._rows(), **self._counts(), **self._labels()}
        self.combinations = int(np.prod([len(v) for v in discrete.values()]))
        grids = {n: self._makeable(n) for n in case.variables}
        discrete |= {n: g for n, g in grids.items() if g is not None}
        count = int(np.prod([len(v) for v in discrete.values()]))
        tuples = np.array(list(itertools.product(*discrete.values())), dtype=float).reshape(count, len(discrete))
        self.discrete = dict(zip(discrete, tuples.T, strict=True))
        self.free = [n for n, g in grids.items() if g is None and n not in case.solved]
        self.low = np.array([self.bounds[n][0] for n in self.free])
        self.high = np.array([self.bounds[n][1] for n in self.free])
        allowed = self._allowed(len(tuples))
        self.discrete = {n: v[allowed] for n, v in self.discrete.items()}
        self.tuples = int(allowed.sum())

    # -- what may be combined --------------------------------------------------------------------

    def _bounds(self, name: str) -> tuple[float, float]:
        v = self.case.variables[name]
        if name in self.case.fix:
            return self.case.fix[name] * v.factor, self.case.fix[name] * v.factor
        low = max([v.lower] + [b for n, s, b in self.case.asked if n == name and s != "at_most"])
        high = min([v.upper] + [b for n, s, b in self.case.asked if n == name and s != "at_least"])
        return low * v.factor, high * v.factor

    def _makeable(self, name: str) -> np.ndarray | None:
        v, (low, high) = self.case.variables[name], self.bounds[name]
        if low == high:
            return np.array([low])
        if not v.grid or not self.case.grid:
            return None
        values = np.array(v.grid) * v.factor
        reach = 1e-12 * np.maximum(np.abs(low), np.abs(high))
        return values[(values >= low - reach) & (values <= high + reach)]

    def _rows(self) -> dict[str, np.ndarray]:
        result = {}
        for slot, name in self.case.slots.items():
            table = self.case.tables[name]
            needed = [c for c in self._used(slot) if f"{slot}.{c}" not in self.case.optional]
            keep = table[needed].notna().all(axis=1).to_numpy(copy=True)
            if slot in self.case.fix:
                keep &= (table["designation"] == self.case.fix[slot]).to_numpy()
            rule = self.case.parts.get(slot, list(table["designation"]))
            if isinstance(rule, str):
                column, number = rule.split(" > ")
                keep &= (table[column] > float(number)).to_numpy()
            else:
                keep &= table["designation"].isin(rule).to_numpy()
            rows = np.flatnonzero(keep)
            u = {c: values[rows] for c, values in self.columns[slot].items()}
            for refusal in self.case.refusals.values():
                if refusal.over == (slot,):
                    refused = np.asarray(refusal.when(u), dtype=bool)
                    rows, u = rows[~refused], {n: v[~refused] for n, v in u.items()}
            result[slot] = rows
        return result

    def _used(self, slot: str) -> list[str]:
        columns = self.case.tables[self.case.slots[slot]].columns[1:]
        return [c for c in columns if not c.startswith("unused")]

    def _counts(self) -> dict[str, np.ndarray]:
        result = {}
        for name, counted in self.case.counts.items():
            values = np.array(counted)
            for other, sense, bound in self.case.asked:
                if other == name:
                    by, size = missed(values, bound, sense)
                    values = values[by <= 1e-9 * size]
            result[name] = values[values == self.case.fix[name]] if name in self.case.fix else values
        return result

    def _labels(self) -> dict[str, np.ndarray]:
        fixed = self.case.fix
        return {
            name: np.array([labels.index(fixed[name])]) if name in fixed else np.arange(len(labels))
            for name, labels in self.case.choices.items()
        }

    def _allowed(self, count: int) -> np.ndarray:
        keep = np.ones(count, dtype=bool)
        u = self.unknowns(np.arange(count), np.tile(self.low, (count, 1)))
        for refusal in self.case.refusals.values():
            keep &= ~np.broadcast_to(np.asarray(refusal.when(u), dtype=bool), (count,))
        return keep

    # -- evaluation ------------------------------------------------------------------------------

    def unknowns(self, which: np.ndarray, x: np.ndarray) -> dict[str, Any]:
        """Return all unknowns by name, for discrete tuples with free variables."""
        case, u = self.case, dict[str, Any](self.case.requirements)
        for name, values in self.discrete.items():
            own = values[which]
            if name in case.slots:
                rows = own.astype(int)
                u |= {c: column[rows] for c, column in self.columns[name].items()}
            else:
                u[name] = Label(case.choices[name], own) if name in case.choices else own
        u |= {name: x[:, k] for k, name in enumerate(self.free)}
        for name, formula in case.solved.items():
            u[name] = np.broadcast_to(formula(u), (len(which),))
        return u

    def missed(self, u: Mapping[str, Any]) -> dict[str, tuple[np.ndarray, np.ndarray]]:
        """Return by how much every limit is missed, and its size; minus infinity where it is void."""
        result = {}
        for name, x in self.case.limits.items():
            by, size = missed(x.value(u), x.limit(u), x.sense)
            size = size if x.terms is None else np.maximum(size, x.terms(u))
            for column in x.void_without:
                void = np.isnan(u[column])
                by, size = np.where(void, -np.inf, by), np.where(void, 1.0, size)
            result[name] = by, size
        pinned = [(name, "equal", value) for name, value in self.case.fix.items()]
        for name, sense, bound in [*self.case.asked, *pinned]:
            if name in self.case.derived:
                result[f"{name} {sense}"] = missed(self.case.derived[name].formula(u), bound, sense)
        return result

    def residuals(self, u: Mapping[str, Any]) -> dict[str, np.ndarray]:
        """Return by how much every limit is missed, as a share of its size."""
        return {name: by / size for name, (by, size) in self.missed(u).items()}

    def worst(self, u: Mapping[str, Any]) -> np.ndarray:
        """Return the worst residual; a design is feasible if that is at most the tolerance."""
        every = self.residuals(u)
        guards = [np.where(r < 0, -np.inf, REFUSED + r) for n, r in every.items() if self._guard(n)]
        worst = np.max(np.broadcast_arrays(*[r for n, r in every.items() if not self._guard(n)], -1.0), axis=0)
        for name in self.case.solved:
            low, high = self.bounds[name]
            beyond = np.maximum(low - u[name], u[name] - high) / (high - low)
            worst = np.maximum(worst, np.where(beyond > SMALLEST, beyond + 2 * TOLERANCE, -1.0))
        refused = np.max(np.broadcast_arrays(*guards, -np.inf), axis=0)
        worst = np.where(refused > -np.inf, refused, worst)
        return np.where(np.isnan(worst), np.inf, worst)

    def _guard(self, name: str) -> bool:
        return name in self.case.limits and self.case.limits[name].guard

    def objectives(self, u: Mapping[str, Any], count: int) -> np.ndarray:
        """Return the objectives (batch, objectives), those to be made large with a minus sign."""
        derived = self.case.derived
        values = [derived[n].formula(u) if n in derived else u[n] for n in self.case.objectives]
        return self.signs * np.stack([np.broadcast_to(np.asarray(v, dtype=float), (count,)) for v in values], axis=1)

    def evaluate(self, which: np.ndarray, x: np.ndarray) -> Points:
        """Return designs with what the formulas say of them."""
        with np.errstate(all="ignore"):
            u = self.unknowns(which, x)
            objectives = self.objectives(u, len(which))
            worst = np.broadcast_to(self.worst(u), (len(which),))
        return Points(which, x, objectives, np.where(np.isfinite(objectives).all(axis=1), worst, np.inf))

    # -- search ----------------------------------------------------------------------------------

    @cached_property
    def explored(self) -> Points:
        """All tuples, each with the corners of its box and random points of it; everything if nothing is free."""
        n = len(self.free)
        per = int(np.clip(EXPLORED // max(self.tuples, 1), 30, 3000)) if n else 1
        corners = np.array(list(itertools.product((0.0, 1.0), repeat=n))).reshape(2**n, n)
        share = np.concatenate([corners, self.rng.random((per, n))])[: max(per, len(corners))]
        x = self.low + share * (self.high - self.low)
        with np.errstate(all="ignore"):
            by_ratio = self.low * (self.high / self.low) ** share
        x[1::2] = np.where(self.low > 0, by_ratio, x)[1::2]
        which = np.repeat(np.arange(self.tuples), len(x))
        found = self.evaluate(which, np.tile(x, (self.tuples, 1)))
        return Points.joined([found, self._entered(found, len(x))]) if n else found

    def _entered(self, found: Points, per: int) -> Points:
        """Return the points that random steps reach in the tuples where no random point is feasible."""
        nearest = np.argmin(found.worst.reshape(self.tuples, per), axis=1) + per * np.arange(self.tuples)
        missed = found.take(nearest[found.worst[nearest] > 0.0])
        missed = missed.take(np.argsort(missed.worst, kind="stable")[:ENTERED])
        nothing = np.zeros((len(missed), len(self.signs)))
        return self._descend(missed, nothing, nothing, ROUNDS // 2)

    @cached_property
    def extremes(self) -> Points:
        """The best points found for each objective alone and for some mixtures, beside all that is known."""
        if not (self.free and self.tuples):
            return self.explored
        m = len(self.signs)
        known = self.explored.take(np.flatnonzero(self.explored.worst <= TOLERANCE))
        spread = np.subtract(*np.percentile(known.objectives, [75, 25], axis=0)) if len(known) else np.ones(m)
        spread = np.maximum(spread, 1e-9)
        base = known.objectives.min(axis=0) if len(known) else np.zeros(m)
        weights = [np.eye(m)[k] for k in range(m)]
        if m > 1:
            weights += list(self.rng.dirichlet(np.ones(m), 3))
        found = self.minimise(np.tile(base, (len(weights), 1)), np.array(weights) / spread)
        return Points.joined([self.explored, found])

    def attack(self, listed: Points, slack: np.ndarray) -> Points:
        """Return points found by trying to improve listed designs in every objective, as shares of their slack."""
        if not self.free:
            return self.explored
        # Of what is exactly zero nothing is forgiven.
        return self.minimise(listed.objectives, 1.0 / np.maximum(slack, 1e-12), listed)

    def minimise(self, base: np.ndarray, weights: np.ndarray, own: Points | None = None) -> Points:
        """Minimise max_k weights_k (objective_k - base_k) for several rows of weights, from many starts each."""
        starts, problem = [], []
        for p in range(len(base)):
            chosen = self._starts(base[p], weights[p])
            chosen = chosen if own is None else Points.joined([chosen, own.take(np.array([p, p]))])
            starts.append(chosen)
            problem.append(np.full(len(chosen), p))
        agents, task = Points.joined(starts), np.concatenate(problem)
        agents = self._descend(agents, base[task], weights[task], ROUNDS // 4)
        kept = self._best(agents, task, base, weights, KEPT)
        agents, task = agents.take(kept), task[kept]
        agents = self._descend(agents, base[task], weights[task], ROUNDS)
        polished = []
        for k in self._best(agents, task, base, weights, POLISHED if own is None else 1, apart=True):
            polished += self._polish(agents.take(np.array([k])), base[task[k]], weights[task[k]])
        return Points.joined([agents, *polished])

    def _best(
        self, agents: Points, task: np.ndarray, base: np.ndarray, weights: np.ndarray, count: int, apart: bool = False
    ) -> np.ndarray:
        """Return the positions of the best points of every problem, on request of different tuples."""
        merit, chosen = self._merit(agents, base[task], weights[task]), list[np.ndarray]()
        for p in range(len(base)):
            mine = np.flatnonzero(task == p)
            mine = mine[np.argsort(merit[mine], kind="stable")]
            if apart:
                mine = mine[np.sort(np.unique(agents.which[mine], return_index=True)[1])]
            chosen.append(mine[:count])
        return np.concatenate(chosen)

    @staticmethod
    def _scalar(points: Points, base: np.ndarray, weights: np.ndarray) -> np.ndarray:
        return np.max(np.where(weights > 0, weights * (points.objectives - base), -1e9), axis=1)

    def _merit(self, points: Points, base: np.ndarray, weights: np.ndarray) -> np.ndarray:
        """Return what is made small: feasible points by their value, before all others by their worst residual."""
        # The tolerance of feasibility is not what the search lives off; only rounding is forgiven here.
        value = np.arctan(self._scalar(points, base, weights))
        return np.where(points.worst <= 0.01 * TOLERANCE, value, 10.0 + np.minimum(points.worst, 1e9))

    def _starts(self, base: np.ndarray, weights: np.ndarray) -> Points:
        """Return good points of what was explored: of random thirds of it, and of several tuples."""
        explored = self.explored
        scalar = self._scalar(explored, base, weights)
        finite = scalar[np.isfinite(scalar)]
        unit = max(float(np.subtract(*np.percentile(finite, [75, 25]))), 1e-9) if len(finite) else 1.0
        group = np.arange(len(explored)) % GROUPS
        chosen = []
        for price in (3.0, 300.0):
            merit = scalar / unit + price * np.maximum(explored.worst, 0.0)
            merit = np.where(np.isfinite(merit), merit, 1e12)
            chosen += [int(np.argmin(np.where(group == g, merit, np.inf))) for g in range(GROUPS)]
            order = np.argpartition(merit, SHORT)[:SHORT] if len(merit) > SHORT else np.arange(len(merit))
            order = order[np.argsort(merit[order], kind="stable")]
            _, first = np.unique(explored.which[order], return_index=True)
            chosen += [int(k) for k in order[np.sort(first)[:PER_TUPLE]]]
        return explored.take(np.array(chosen))

    def _descend(self, agents: Points, base: np.ndarray, weights: np.ndarray, rounds: int) -> Points:
        """Improve points by random steps of all sizes, many points at once."""
        count, n = agents.x.shape
        span = self.high - self.low
        merit = self._merit(agents, base, weights)
        rng = np.random.default_rng([self.case.seed, count, rounds])  # the same whatever was searched for before
        for _ in range(rounds):
            size = 10.0 ** rng.uniform(-5, -0.3, (count, TRIES, 1))
            step = rng.normal(size=(count, TRIES, n)) * size * span
            single = np.arange(n) == rng.integers(0, n, (count, TRIES, 1))
            step = np.where((np.arange(TRIES) % 3 == 0)[None, :, None] & ~single, 0.0, step)
            x = np.clip(agents.x[:, None, :] + step, self.low, self.high).reshape(-1, n)
            tried = self.evaluate(np.repeat(agents.which, TRIES), x)
            value = self._merit(tried, np.repeat(base, TRIES, axis=0), np.repeat(weights, TRIES, axis=0))
            best = np.argmin(value.reshape(count, TRIES), axis=1) + TRIES * np.arange(count)
            better = value[best] < merit
            merit = np.where(better, value[best], merit)
            source = np.where(better, best + count, np.arange(count))
            agents = Points.joined([agents, tried]).take(source)
        return agents

    def _polish(self, point: Points, base: np.ndarray | None, weights: np.ndarray | None) -> list[Points]:
        """Improve one point by sequential quadratic programming on numerical derivatives.

        Without ``base`` and ``weights`` the worst residual is made small.
        """
        with np.errstate(all="ignore"):
            sizes = {name: size for name, (_, size) in self.missed(self.unknowns(point.which, point.x)).items()}
        n, span = len(self.free), self.high - self.low
        targets = 0 if weights is None else int(np.sum(weights > 0))
        memory: dict[bytes, tuple[np.ndarray, np.ndarray]] = {}

        def rows(s: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
            """Return the parts of the scalar and the residuals, with their derivatives, at shares of the box."""
            key = s.tobytes()
            if key not in memory:
                steps = np.where(s > 0.5, -1e-7, 1e-7)
                x = self.low + np.vstack([s, s + np.diag(steps)]) * span
                table = self._rows_of(point.which, x, base, weights, sizes)
                memory[key] = table[0], ((table[1:] - table[0]) / steps[:, None]).T
            return memory[key]

        def lifted(count: int) -> np.ndarray:
            """Return which rows stand below the last unknown, not below zero."""
            return np.arange(count) < targets if targets else np.ones(count, dtype=bool)

        def below(z: np.ndarray) -> np.ndarray:
            values = rows(np.clip(z[:n], 0, 1))[0]
            return z[n] * lifted(len(values)) - values

        def slope(z: np.ndarray) -> np.ndarray:
            jacobian = rows(np.clip(z[:n], 0, 1))[1]
            return np.column_stack([-jacobian, lifted(len(jacobian))])

        start = (point.x[0] - self.low) / span
        values = rows(start)[0]
        gradient = np.r_[np.zeros(n), 1.0]
        answer = minimize(
            lambda z: z[n],
            np.r_[start, np.max(values[lifted(len(values))])],
            jac=lambda z: gradient,
            bounds=[(0, 1)] * n + [(None, None)],
            constraints={"type": "ineq", "fun": below, "jac": slope},
            method="SLSQP",
            options={"maxiter": 40, "ftol": 1e-9},
        )
        if not np.isfinite(answer.x).all():
            return []
        return [self.evaluate(point.which, (self.low + np.clip(answer.x[:n], 0, 1) * span)[None, :])]

    def _rows_of(
        self,
        which: np.ndarray,
        x: np.ndarray,
        base: np.ndarray | None,
        weights: np.ndarray | None,
        sizes: Mapping[str, np.ndarray],
    ) -> np.ndarray:
        """Return, for points of one tuple, the parts of the scalar and then by how much every limit is missed.

        The sizes are those of one point: a residual proper does not change at all where one side is zero.
        """
        count, parts = len(x), list[np.ndarray]()
        with np.errstate(all="ignore"):
            u = self.unknowns(np.repeat(which, count), x)
            if weights is not None:
                parts.append((weights * (self.objectives(u, count) - base))[:, weights > 0])
            for name, (by, _) in self.missed(u).items():
                r = np.broadcast_to(by, (count,)) / sizes[name] + (1e-9 if self._guard(name) else 0.0)
                parts.append(np.where(np.isneginf(r), -1.0, r)[:, None])
            for name in self.case.solved:
                low, high = self.bounds[name]
                parts.append(np.stack([low - u[name], u[name] - high], axis=1) / (high - low))
        return np.nan_to_num(np.concatenate(parts, axis=1), nan=1e3, posinf=1e3, neginf=-1e3)

    def feasible(self) -> Points:
        """Return feasible points, seeking one by way of the worst residual where exploring found none."""
        found = self.extremes
        if not np.any(found.worst <= TOLERANCE) and self.free and len(found):
            nearest = found.take(np.argsort(found.worst, kind="stable"))
            _, first = np.unique(nearest.which, return_index=True)
            tried = [self._polish(nearest.take(np.array([k])), None, None) for k in np.sort(first)[:NEAREST]]
            found = Points.joined([found, *itertools.chain.from_iterable(tried)])
        return found.take(np.flatnonzero(found.worst <= TOLERANCE))

    # -- designs of the engine -------------------------------------------------------------------

    def point_of(self, design: Any) -> tuple[dict[str, Any], np.ndarray]:
        """Return the unknowns of a design as it is reported, and its row of free variables."""
        case, u = self.case, dict[str, Any](self.case.requirements)
        for slot, name in case.slots.items():
            row = np.flatnonzero(case.tables[name]["designation"] == str(design.parts[slot]))
            u |= {c: column[row] for c, column in self.columns[slot].items()}
        u |= {n: np.array([design.values[n]]) for n in (*case.variables, *case.counts)}
        u |= {n: Label(labels, np.array([labels.index(design.choices[n])])) for n, labels in case.choices.items()}
        return u, np.array([design.values[n] for n in self.free])

    def tuple_of(self, design: Any) -> int | None:
        """Return the number of the discrete tuple that a design is made of, or None if there is no such tuple."""
        same = np.ones(self.tuples, dtype=bool)
        for name, values in self.discrete.items():
            if name in self.case.slots:
                designations = self.case.tables[self.case.slots[name]]["designation"].to_numpy()
                same &= designations[values.astype(int)] == str(design.parts[name])
            elif name in self.case.choices:
                labels = np.array(self.case.choices[name])
                same &= labels[values.astype(int)] == design.choices[name]
            else:
                same &= np.abs(values - design.values[name]) <= 1e-9 * np.abs(values) + 1e-15
        found = np.flatnonzero(same)
        return int(found[0]) if len(found) else None
