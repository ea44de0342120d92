"""What every family must keep: complete words, sound dimensions, exact evaluation, and answers that can be trusted."""

import numpy as np
import pytest

import synth
from synth.question.catalogs import as_catalogs
from synth.search.formulation import Formulation
from synth.testing import FamilyTests
from synth.testing.fronts import best, first_objective
from tests.asking import instance_of
from tests.conformance.cases import CASES
from tests.referees.ipopt import Task
from tests.regimes import refereed
from tests.repetitions import repetitions

pytestmark = pytest.mark.slow

# A class of tests per family, found by pytest under its name.
THOROUGH = repetitions(0, 1) == 1
for _family in CASES:
    globals()[f"Test_{_family}"] = type(f"Test_{_family}", (FamilyTests,), {"family": _family, "thorough": THOROUGH})

EXAMPLES = [(f, c) for f, data in CASES.items() for c in data.feasible]


@pytest.mark.parametrize(("family", "name"), EXAMPLES)
def test_random_starts_of_the_solver_find_nothing_better(family, name):
    case = CASES[family].feasible[name]
    objective = first_objective(family)
    settings = {k: v for k, v in case.settings.items() if k in ("parts", "limits", "fix")}
    optimum = best(family, case, objective.name, grid=False).values[objective.name]
    instance = instance_of(
        synth.load(family, **case.options), case.requirements, as_catalogs(None), **settings, grid=False
    )
    form = Formulation(instance, {objective.name: objective.sense}, 1)
    task = Task(np.ones(1), np.zeros(1), np.full(1, np.inf), form.objectives.scales, t_weight=0.0)
    rng = np.random.default_rng(4)
    reached = []
    for combination in rng.permutation(instance.combinations.count)[:12]:
        box = form.boxes.contract(form.boxes.box_of(int(combination)), None)
        for _ in range(2 * len(box)):
            low, high = box.low[0, : form.n], box.high[0, : form.n]  # a box may carry inner nodes too
            start = low * (high / low) ** rng.random(form.n)
            solution = refereed(form, task, int(combination), start, low, high)
            if solution is not None:
                value = form.points.evaluate(solution.variables[None, :], np.array([combination]))
                if value.feasible[0]:
                    reached.append(float(value.values[objective.name][0]))
    assert len(reached) >= 4
    assert min(reached) >= optimum * (1 - 1e-3)
