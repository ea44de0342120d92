"""Other optimisers on the same model, each given a vectorised evaluation and ordered, logarithmic unknowns.

The unknowns of a peer are, in this order: for each slot, count and choice the position of the row or value
(rounded; rows are sorted by their first number: neighbours are alike), then the variables, by logarithm where they
are positive. Every design that a peer evaluates counts for its front, not only its last population.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping, Sequence
from typing import Any

import casadi as ca
import moocore
import numpy as np

from synth.question.instance import Instance
from synth.special import expanded
from synth.tables.catalogs import Catalogs
from tests.asking import instance_of
from tests.benchmarks import cases

POPULATION = 200
OPTUNA_POPULATION = 50
WORST = 1e12  # stands for an objective that does not exist; such a design is infeasible anyway
MOST_VIOLATED = 10.0


class Stop(Exception):
    """The last checkpoint has passed."""


class Vectorised:
    """The model as a function of plain number rows, with a record of the front at each checkpoint.

    Parameters
    ----------
    instance : Instance
    objectives : list of str
        All to be small.
    checkpoints : list of float
        Seconds after ``start`` at which the front so far is kept.
    """

    def __init__(self, instance: Instance, objectives: Sequence[str], checkpoints: Sequence[float]) -> None:
        self.instance, self.objectives, self.checkpoints = instance, list(objectives), list(checkpoints)
        self.discrete = len(instance.combinations.radix)
        self._orders = [np.argsort(next(iter(s.columns.values())), kind="stable") for s in instance.selection.slots]
        self.logs = instance.ranges.lower > 0
        low, high = (
            np.where(self.logs, np.log(np.maximum(b, 1e-300)), b)
            for b in (instance.ranges.lower, instance.ranges.upper)
        )
        self.low = np.concatenate([np.zeros(self.discrete), low])
        self.high = np.concatenate([np.array(instance.combinations.radix) - 1.0, high])
        self.limits = len(instance.model.limits)
        self.evaluations = 0
        self.snapshots: dict[float, np.ndarray] = {}
        self._front = np.empty((0, len(self.objectives)))
        self._begin = 0.0

    def start(self) -> None:
        """Start the clock."""
        self._begin = time.perf_counter()

    def decode(self, x: np.ndarray) -> tuple[np.ndarray, list[Any]]:
        """Return variables and data of rows of unknowns."""
        digits = np.clip(np.rint(x[:, : self.discrete]), 0, self.high[: self.discrete]).astype(np.int64)
        for k, order in enumerate(self._orders):
            digits[:, k] = order[digits[:, k]]
        numbers = np.zeros(len(x), dtype=np.int64)
        for k, size in enumerate(self.instance.combinations.radix):
            numbers = numbers * size + digits[:, k]
        raw = x[:, self.discrete :]
        variables = np.where(self.logs, np.exp(np.where(self.logs, raw, 0.0)), raw)
        return np.clip(variables, self.instance.ranges.lower, self.instance.ranges.upper), self.instance.data(numbers)

    def evaluate(self, x: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return objectives (rows, objectives) and limits (rows, limits), which hold where not positive.

        Raises
        ------
        Stop
            After the last checkpoint.
        """
        variables, data = self.decode(x)
        result = self.instance.model.evaluate(variables, data)
        values = np.stack([result.values[name] for name in self.objectives], axis=1)
        violations = np.empty((len(x), self.limits))
        for k, limit in enumerate(self.instance.model.limits):
            r = np.nan_to_num(result.residuals[limit.name], nan=1.0, posinf=MOST_VIOLATED, neginf=-1.0)
            broken = ~result.holds[limit.name]
            violations[:, k] = np.where(broken, np.clip(r, 1e-9, MOST_VIOLATED), np.clip(r, -1.0, 0.0))
        self.evaluations += len(x)
        self._record(values[result.feasible & np.isfinite(values).all(axis=1)])
        return np.nan_to_num(values, nan=WORST, posinf=WORST), violations

    def _record(self, found: np.ndarray) -> None:
        passed = time.perf_counter() - self._begin
        for checkpoint in self.checkpoints:
            if passed > checkpoint and checkpoint not in self.snapshots:
                self.snapshots[checkpoint] = self._front
        if len(self.snapshots) == len(self.checkpoints):
            raise Stop
        if len(found):
            self._front = np.asarray(moocore.filter_dominated(np.concatenate([self._front, found])))


def run(case: Mapping[str, Any]) -> dict[str, Any]:
    """Run one peer; return its front at each checkpoint, or the seconds per problem of IPOPT."""
    question = cases.question(cases.SIZES[case["size"]])
    instance = instance_of(
        cases.problem(), cases.HOIST, question["catalogs"] or Catalogs(), question["parts"], grid=case["grid"]
    )
    if case["peer"] == "ipopt":
        return ipopt(instance, case["objectives"], case["sample"], case["caps"], case["seed"])
    model = Vectorised(instance, case["objectives"], case["checkpoints"])
    try:
        PEERS[case["peer"]](model, case["seed"])
    except Stop:
        pass
    return {
        "evaluations": model.evaluations,
        "combinations": instance.combinations.count,
        "fronts": [model.snapshots.get(c, np.empty((0, 2))).tolist() for c in case["checkpoints"]],
    }


def _pymoo(model: Vectorised, make: Callable[[], Any], seed: int) -> None:
    from pymoo.core.problem import Problem
    from pymoo.core.termination import NoTermination

    class Traced(Problem):  # type: ignore[misc]
        def __init__(self) -> None:
            super().__init__(
                n_var=len(model.low),
                n_obj=len(model.objectives),
                n_ieq_constr=model.limits,
                xl=model.low,
                xu=model.high,
            )

        def _evaluate(self, x: np.ndarray, out: dict[str, Any], *_: Any, **__: Any) -> None:
            out["F"], out["G"] = model.evaluate(x)

    algorithm = make()
    model.start()
    algorithm.setup(Traced(), termination=NoTermination(), seed=seed, verbose=False)
    while True:
        algorithm.next()


def pymoo_nsga2(model: Vectorised, seed: int) -> None:
    """Run NSGA-II of pymoo."""
    from pymoo.algorithms.moo.nsga2 import NSGA2

    _pymoo(model, lambda: NSGA2(pop_size=POPULATION), seed)


def pymoo_nsga3(model: Vectorised, seed: int) -> None:
    """Run NSGA-III of pymoo, with as many reference directions as individuals."""
    from pymoo.algorithms.moo.nsga3 import NSGA3
    from pymoo.util.ref_dirs import get_reference_directions

    directions = get_reference_directions("das-dennis", len(model.objectives), n_partitions=POPULATION - 1)
    _pymoo(model, lambda: NSGA3(directions, pop_size=POPULATION), seed)


def _optuna(model: Vectorised, sampler: Any, batch: int) -> None:
    import optuna

    optuna.logging.set_verbosity(optuna.logging.ERROR)
    study = optuna.create_study(directions=["minimize"] * len(model.objectives), sampler=sampler)
    spans = [(float(a), float(b)) for a, b in zip(model.low, model.high, strict=True)]
    model.start()
    while True:
        trials = [study.ask() for _ in range(batch)]
        x = np.array(
            [
                [
                    trial.suggest_int(f"x{k}", int(a), int(b))
                    if k < model.discrete
                    else trial.suggest_float(f"x{k}", a, b)
                    for k, (a, b) in enumerate(spans)
                ]
                for trial in trials
            ]
        )
        values, violations = model.evaluate(x)
        for trial, f, g in zip(trials, values, violations, strict=True):
            for k, violation in enumerate(g):
                trial.set_constraint(f"g{k}", float(violation))
            study.tell(trial, [float(v) for v in f])


def optuna_nsga2(model: Vectorised, seed: int) -> None:
    """Run NSGA-II of Optuna, one population asked at a time."""
    from optuna.samplers import NSGAIISampler

    _optuna(model, NSGAIISampler(population_size=OPTUNA_POPULATION, seed=seed), OPTUNA_POPULATION)


def optuna_tpe(model: Vectorised, seed: int) -> None:
    """Run the tree-structured Parzen estimator of Optuna, several candidates asked at a time."""
    from optuna.samplers import TPESampler

    _optuna(model, TPESampler(seed=seed, constant_liar=False), 10)


PEERS: dict[str, Callable[[Vectorised, int], None]] = {
    "pymoo NSGA-II": pymoo_nsga2,
    "pymoo NSGA-III": pymoo_nsga3,
    "Optuna NSGA-II": optuna_nsga2,
    "Optuna TPE": optuna_tpe,
}

IPOPT: dict[str, Any] = {
    "print_time": False,
    "ipopt.print_level": 0,
    "ipopt.sb": "yes",
    "ipopt.tol": 1e-8,
    "ipopt.max_iter": 200,
    "error_on_fail": False,
    "show_eval_warnings": False,
}


def ipopt(
    instance: Instance, objectives: Sequence[str], sample: int, caps: Sequence[float], seed: int
) -> dict[str, Any]:
    """Return the mean seconds of one parametric IPOPT problem, built once, over combinations drawn at random.

    Least first objective, the second at most a cap drawn from the range ``caps``; positive quantities enter by
    their logarithm.
    """
    model = instance.model
    n = len(model.variables)
    rng = np.random.default_rng(seed)
    numbers = rng.integers(instance.combinations.count, size=sample)
    data = instance.data(numbers)
    low, high = np.log(instance.ranges.lower), np.log(instance.ranges.upper)
    spread = np.exp(low + (high - low) * rng.random((sample, n)))
    seen = model.evaluate(spread, data)
    y, cap = ca.SX.sym("y", n), ca.SX.sym("cap")
    parameters = ca.vertcat(*model.inputs[n:])

    def written(expression: Any) -> Any:
        return ca.substitute(expanded(expression, model.calls), ca.vertcat(*model.inputs[:n]), ca.exp(y))

    g = []
    for limit in model.limits:
        value, bound = written(limit.value), written(limit.limit)
        a, b = seen.limits[limit.name]
        positive = bool(np.all(a > 0) and np.all(b > 0))
        form = ca.log(value / bound) if positive else (value - bound) / float(np.nanmax(np.abs(np.stack([a, b]))))
        g.append(-form if limit.sense == "at_least" else form)
    f, capped = (ca.log(written(model.quantity_sx[name])) for name in objectives[:2])
    problem = {"x": y, "p": ca.vertcat(parameters, cap), "f": f, "g": ca.vertcat(*g, capped - cap)}
    begin = time.perf_counter()
    solver = ca.nlpsol("solver", "ipopt", problem, IPOPT)
    build = time.perf_counter() - begin
    seconds, solved = [], 0
    for k in range(sample):
        values = [float(np.broadcast_to(x, (sample,))[k]) for x in data]
        clean = [1.0 if np.isnan(v) else v for v in values]  # limits that use an empty cell are void
        upper = [np.inf if seen.void[limit.name][k] else 0.0 for limit in model.limits]
        most = float(np.log(rng.uniform(caps[0], caps[1])))
        begin = time.perf_counter()
        solver(x0=0.5 * (low + high), p=[*clean, most], lbx=low, ubx=high, lbg=-np.inf, ubg=[*upper, 0.0])
        seconds.append(time.perf_counter() - begin)
        solved += bool(solver.stats()["success"])
    return {
        "combinations": instance.combinations.count,
        "build": build,
        "seconds": float(np.mean(seconds)),
        "median": float(np.median(seconds)),
        "solved": solved,
        "sample": sample,
    }
