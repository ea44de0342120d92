"""How many small continuous problems are solved per second: arrays, the kernel and IPOPT on the same problems."""

from __future__ import annotations

import os
import time
from collections.abc import Callable
from typing import Any

import numpy as np

import synth
from synth.kernels.loading import VARIABLE
from synth.model.constraint import Goal, NodeConstraint
from synth.nlp.batch import BatchNlp, ProblemInputs, Solutions, Tasks
from synth.nlp.rows import Rows
from synth.question.catalogs import as_catalogs
from tests.asking import instance_of
from tests.referees.ipopt import ParametricNlp, Task

REQUIREMENTS = {
    "load_torque": "600 N*m",
    "driver_speed": "26.6 rad/s",
    "driven_inertia": "30 kg*m2",
    "engagements_per_hour": "50 1/h",
    "jerk_limit": "18 rad/s3",
}
OBJECTIVES = ("mass", "actuation_force")
SAMPLES = 40_000
SPREAD = 2.0
FEASIBLE = 1e-8


class Workload:
    """Chebyshev tasks on random combinations of the multi-plate clutch, in boxes around feasible points.

    Parameters
    ----------
    count : int
        Number of problems.
    seed : int
    """

    def __init__(self, count: int, seed: int = 0) -> None:
        instance = instance_of(synth.load("multi_plate_clutch", practice="off"), REQUIREMENTS, as_catalogs(None))
        self.model = model = instance.model
        self.n = len(model.variables)
        self.rows = Rows(
            constraints=tuple(NodeConstraint.of(x) for x in model.constraints),
            goals=tuple(Goal(model.quantity_node[name]) for name in OBJECTIVES),
            log_constraints=tuple(x.sense != "equal" for x in model.limits),
            log_goals=(True,) * len(OBJECTIVES),
            log_variables=tuple(bool(x > 0) for x in instance.ranges.lower),
        )
        self.bounds = [0.0] * len(self.rows.constraints)
        rng = np.random.default_rng(seed)
        outer = rng.uniform(0.15, 0.45, SAMPLES)
        force, ramp = np.exp(rng.uniform(np.log([[4e3], [0.1]]), np.log([[6e4], [4.0]]), (2, SAMPLES)))
        points = np.stack([outer, outer * rng.uniform(0.65, 0.78, SAMPLES), force, ramp], axis=1)
        combinations = rng.integers(0, instance.combinations.count, SAMPLES)
        feasible = np.flatnonzero(model.evaluate(points, instance.data(combinations)).feasible)
        chosen = rng.choice(feasible, count)
        point = points[chosen]
        self.data = instance.data(combinations[chosen])
        self.low = np.maximum(point / SPREAD, instance.ranges.lower)
        self.high = np.minimum(point * SPREAD, instance.ranges.upper)
        self.start = np.sqrt(self.low * self.high)
        values = model.evaluate(point, self.data).values
        caps = np.log(np.stack([values[name] for name in OBJECTIVES], axis=1)) + rng.normal(0.0, 0.2, (count, 2))
        slopes = np.exp(rng.uniform(-2.0, 0.5, (count, 2)))
        self.tasks = Tasks(np.full((count, 2), 1e-6), slopes, caps, np.ones(2))
        self.void = np.stack([x.void(self.data, (count,)) for x in model.constraints], axis=1)

    def batch(self, native: bool) -> Callable[[], Solutions] | None:
        """Call that solves all problems at once; None where the kernel is wanted and was not built."""
        os.environ[VARIABLE] = "1" if native else "0"
        solver = BatchNlp(self.model.program, self.n, self.rows)
        if native and not solver.compiled:
            return None
        inputs = ProblemInputs(self.data, self.low, self.high, self.bounds, self.void)
        return lambda: solver.solve(self.tasks, inputs, self.start)

    def one_by_one(self, count: int) -> Callable[[], None]:
        """Return a call that solves the first problems with IPOPT."""
        nlp = ParametricNlp(self.model.program, self.n, self.rows)
        tasks, size = self.tasks, len(self.start)
        columns = [np.broadcast_to(np.asarray(x, dtype=float), size) for x in self.data]

        def solve() -> None:
            for k in range(count):
                task = Task(tasks.weights[k], tasks.slopes[k], tasks.cutoffs[k], tasks.goal_scales, tasks.t_weight)
                data = [float(x[k]) for x in columns]
                nlp.solve(task, data, self.start[k], self.low[k], self.high[k], self.bounds, self.void[k])

        return solve


def measure(count: int = 20_000, referee: int = 60, repeats: int = 3) -> dict[str, Any]:
    """Return problems per second of processor time, for each way of solving them.

    Parameters
    ----------
    count : int
        Problems for the batched solvers.
    referee : int
        Problems for IPOPT.
    repeats : int
        The median counts.

    Returns
    -------
    dict
        ``numpy``, ``kernel`` (None where it was not built) and ``ipopt``: problems per second and core;
        ``solved``: share of problems for which a feasible point was found.
    """
    work = Workload(count)
    plain, kernel = work.batch(False), work.batch(True)
    assert plain is not None
    solution = (kernel or plain)()
    return {
        "numpy": _rate(plain, count, repeats),
        "kernel": None if kernel is None else _rate(kernel, count, repeats),
        "ipopt": _rate(work.one_by_one(referee), referee, 1),
        "solved": float(np.mean(solution.violation <= FEASIBLE)),
    }


def _rate(call: Callable[[], Any], count: int, repeats: int) -> float:
    seconds = []
    for _ in range(repeats):
        started = time.process_time()
        call()
        seconds.append(time.process_time() - started)
    return count / float(np.median(seconds))


if __name__ == "__main__":
    for name, value in measure().items():
        print(f"{name}: {value}")
