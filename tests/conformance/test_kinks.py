"""Of every family: what the solver calls an optimum is one, in every regime around it, and from every start."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
import pytest

import synth
from synth.model.constraint import void_limits
from synth.nlp.batch import Tasks
from synth.question.catalogs import as_catalogs
from synth.question.objectives import chosen_objectives, with_ties
from synth.search.formulation import Formulation
from synth.search.settings import TUNING
from synth.testing import Case
from tests.asking import instance_of
from tests.conformance.cases import CASES, answer, front_of
from tests.referees.ipopt import Task
from tests.regimes import best_in_any_regime, referee

pytestmark = pytest.mark.slow

EXAMPLES = [(f, c) for f, data in CASES.items() for c in data.feasible]
STARTS = 8
NEAR = 1e-3  # how far around an answer the referee looks, as a share of values or of ranges
SURE = 1e-7  # relative
ALIKE = 1e-6  # answers that differ by less are one
# Sizes that stay pinned where the others are free, for a quick proof.
HELD = {"magnetic_powder_clutch": ("coil_height", "pole_length"), "electromagnetic_clutch": ("yoke_thickness",)}


@dataclass(frozen=True)
class Pinned:
    """What pins parts, counts and choices to those of a design that was found, but no size."""

    design: synth.Design
    parts: Mapping[str, Any]
    fix: Mapping[str, Any]


@pytest.fixture(scope="module", params=EXAMPLES, ids=lambda p: f"{p[0]}-{p[1]}")
def example(request: pytest.FixtureRequest) -> tuple[str, Case, list[Pinned]]:
    """Return a family, a case and the combinations of the first and the last design of its front."""
    family, name = request.param
    case = CASES[family].feasible[name]
    front = front_of(family, name)
    counts = front.question.model.declaration.counts
    made = {}
    for design in (front.designs[0], front.designs[-1]):
        fix = {**{n: design.values[n] for n in counts}, **design.choices}
        pinned = Pinned(design, {slot: [str(part)] for slot, part in design.parts.items()}, fix)
        made[str((pinned.parts, fix))] = pinned
    return family, case, list(made.values())


class Question:
    """The continuous problems of one combination, every size free to move."""

    def __init__(self, problem: Any, case: Case, pinned: Pinned) -> None:
        instance = instance_of(
            problem, case.requirements, as_catalogs(None), parts=pinned.parts, fix=pinned.fix, grid=False
        )
        assert instance.combinations.count == 1
        model = instance.model
        asked = chosen_objectives(model, case.settings.get("objectives")) | chosen_objectives(model, None)
        names = model.declaration.objectives
        objectives = {name: sense for name, sense in with_ties(model, asked).items() if name in names}
        self.form = form = Formulation(instance, objectives, len(asked))
        self.own = np.zeros(STARTS, dtype=np.int64)
        self.data = [float(np.asarray(x).ravel()[0]) for x in instance.data(self.own[:1])]
        self.void = void_limits(form.constraints, self.data, 1)[0]
        self.positive = form.lower > 0
        self.design = np.array([pinned.design.values[v.name] for v in model.variables])
        share = np.random.default_rng(3).random((STARTS, form.n))
        with np.errstate(all="ignore"):
            ratios = form.lower * (form.upper / form.lower) ** share
        self.starts = np.where(self.positive, ratios, form.lower + share * (form.upper - form.lower))
        self.starts[0] = self.design

    def tasks(self) -> list[Task]:
        """Return each objective alone, those traded together, and what beats the design in all of these at once."""
        form = self.form
        m, traded = len(form.goals), np.arange(len(form.goals)) < form.traded
        free, none = np.full(m, np.inf), np.zeros(m)
        weights = [*np.eye(m), traded / form.traded]
        _, (phi,) = form.points.feasible_rows(self.design[None, :], self.own[:1])
        alone = [Task(w, none, free, form.objectives.scales, 0.0) for w in weights]
        return [*alone, Task(none, np.ones(m), np.where(traded, phi, np.inf), form.objectives.scales, 1.0)]

    def cost_of(self, task: Task, point: np.ndarray) -> float:
        """Return the cost of sizes by the formulas as they were written; infinite where a limit does not hold."""
        kept, (phi,) = self.form.points.feasible_rows(point[None, :], self.own[:1])
        if not len(kept):
            return np.inf
        return float(task.weights @ phi + (task.t_weight * np.max(phi - task.cutoffs) if task.t_weight else 0.0))

    def answers(self, task: Task) -> list[tuple[float, np.ndarray]]:
        """Return cost and sizes of what the search's own solver calls optima, from every start."""
        wide = [np.tile(x, (STARTS, 1)) for x in (task.weights, task.slopes, task.cutoffs)]
        tasks = Tasks(wide[0], wide[1], wide[2], task.goal_scales, task.t_weight)
        found = self.form.continuous.solve_batch(tasks, self.own, self.starts)
        called = np.flatnonzero(found.converged & (found.violation <= TUNING.nlp.missed))
        return [(self.cost_of(task, x), x) for x in found.variables[called]]

    def referee(self, task: Task, starts: np.ndarray, low: np.ndarray, high: np.ndarray) -> float:
        """Return the least cost that IPOPT finds in any regime."""
        ends = np.maximum(self.form.lower, low), np.minimum(self.form.upper, high)
        return best_in_any_regime(
            referee(self.form),
            task,
            self.data,
            starts,
            ends,
            self.form.bounds,
            self.void,
            lambda x: self.cost_of(task, x),
        )

    def around(self, point: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return a small box around sizes."""
        reach = NEAR * np.where(self.positive, point, self.form.upper - self.form.lower)
        return point - reach, point + reach


def test_answers_are_optima_in_every_regime_and_from_every_start(example):
    family, case, made = example
    problem = synth.load(family, **case.options)
    for pinned in made:
        question = Question(problem, case, pinned)
        form, called, asked = question.form, 0, 0
        for number, task in enumerate(question.tasks()):
            answers = question.answers(task)
            # What is called an optimum keeps the limits ...
            assert all(np.isfinite(cost) for cost, _ in answers)
            # ... no regime around it has a better one; answers from other starts are the same, or optima as well ...
            costs = np.array([cost for cost, _ in answers])
            _, distinct = np.unique(np.round(costs / ALIKE), return_index=True)
            for cost, point in (answers[k] for k in distinct):
                better = question.referee(task, point[None, :], *question.around(point))
                assert better >= cost - SURE, (form.names, number)
                # The referee finds its way too.
                assert better <= cost + SURE, (form.names, number)
            # ... every problem is answered, and the design that was found is none the better, though all its sizes
            # are makeable.
            assert answers, (form.names, number)
            assert costs.min() <= question.cost_of(task, question.design) + SURE
            called, asked = called + len(answers), asked + STARTS
        assert called > 0.9 * asked


def test_the_best_design_does_not_become_worse_with_a_smaller_gap(example):
    family, case, (pinned, *_) = example
    question = Question(synth.load(family, **case.options), case, pinned)
    declaration = question.form.model.declaration
    # Where formulas have edges sizes are free; elsewhere those that the case pins stay, for a quick proof.
    edged = question.form.continuous.has_edges
    pinned_sizes = {k: v for k, v in case.settings.get("fix", {}).items() if k not in declaration.counts}
    sizes = {k: v for k, v in pinned_sizes.items() if k in HELD.get(family, ())} if edged else pinned_sizes
    name = question.form.names[0]
    asked = {"parts": pinned.parts, "fix": {**sizes, **pinned.fix}, "objectives": [name], "grid": False, "points": 1}
    if edged:
        asked["limits"] = {}
    best = []
    for gap in (1e-3, 1e-4):
        # What is proven must not depend on how busy the machine is: no budget of time but this.
        front = answer(family, case, gap=gap, time_limit=600, **asked)
        assert front.certificate.kind == "global"
        best.append(front.designs[0].values[name])
    sign = 1 if declaration.objectives[name].sense == "min" else -1
    assert sign * (best[1] - best[0]) <= 1e-8 * abs(best[0])
