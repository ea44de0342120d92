"""Designs do not live off the tolerance: limits are kept to 1e-8 wherever something can move; nobody gains by it."""

import casadi as ca
import numpy as np
import pytest

from synth.order.feasibility import TOLERANCE
from synth.search.formulation import Formulation
from synth.search.refused_cells import not_refused
from synth.special import expanded
from tests.conformance.cases import CASES, front_of
from tests.referees.ipopt import Task
from tests.regimes import refereed

pytestmark = pytest.mark.slow

EXAMPLES = [(f, c) for f, data in CASES.items() for c in data.feasible]
CLOSE = 1e-8
SURE = 1e-7  # relative; a tenth of the tolerance
OTHERS = 3  # designs listed, and combinations one part away, that each design is compared with


@pytest.fixture(scope="module", params=EXAMPLES, ids=lambda p: f"{p[0]}-{p[1]}")
def front(request):
    found = front_of(*request.param)
    assert found.certificate.kind == "global"
    return found


def movable(instance):
    """Return the names of the limits that a continuous variable enters which is neither pinned nor gridded."""
    model = instance.model
    ends = zip(instance.ranges.lower, instance.ranges.upper, instance.ranges.grids(), strict=True)
    free = [v.sx for v, (low, high, grid) in zip(model.variables, ends, strict=True) if low < high and not len(grid)]
    sides = {x.name: [x.value, x.limit] for x in model.limits}
    sides |= {x.name: [model.quantity_sx[x.quantity]] for x in instance.limits.judging}
    return {
        name
        for name, own in sides.items()
        if free and any(ca.which_depends(expanded(ca.vertcat(*own), model.calls), ca.vertcat(*free), 1, False))
    }


def test_limits_are_kept_closely_wherever_something_can_move(front):
    moved = movable(front.question)
    for design in front.designs:
        for name, r in design.residuals.items():
            assert not r > (CLOSE if name in moved else TOLERANCE), (design.rank, name)


def combination_of(instance, design):
    """Return the number of the combination that a design is made of."""
    for number in range(instance.combinations.count):
        parts, counts, choices = instance.combinations.describe(number)
        same = all(table.designations[row] == str(design.parts[slot]) for slot, (table, row) in parts.items())
        same = same and all(design.values[name] == value for name, value in counts.items())
        if same and all(design.choices[name] == label for name, label in choices.items()):
            return number
    raise AssertionError(design)


def reached(form, combination, variables, phi):
    """Return by how much the referee comes short of a design in the worst objective, limits kept closely; or None.

    With other parts, from these variables, of which the makeable ones stay. Negative: the design is dominated.
    """
    low, high = (np.where(form.gridded, variables, ends) for ends in (form.lower, form.upper))
    task = Task(np.zeros(len(phi)), np.ones(len(phi)), phi, form.objectives.scales)
    solution = refereed(form, task, combination, variables, low, high)
    if solution is None:
        return None
    rows, found = form.points.feasible_rows(solution.variables[None, :], np.array([combination]))
    return float(np.max(found[0] - phi)) if len(rows) else None


def test_no_design_is_dominated_by_another_combination_that_keeps_the_limits_closely(front):
    instance, rng = front.question, np.random.default_rng(5)
    form = Formulation(instance, front.frame.objectives, len(front.frame.objectives))
    made = [combination_of(instance, d) for d in front.designs]
    points = np.array([[d.values[v.name] for v in instance.model.variables] for d in front.designs])
    _, phi = form.points.feasible_rows(points, np.array(made))
    compared = 0
    for own, x, target in zip(made, points, phi, strict=True):
        # The design itself loses nothing where it keeps the limits closely.
        assert reached(form, own, x, target) == pytest.approx(0.0, abs=SURE)
        beside = instance.combinations.neighbours(own)
        rivals = [(c, y) for c, y in zip(made, points, strict=True) if c != own]
        rivals = [rivals[k] for k in rng.permutation(len(rivals))[:OTHERS]]
        rivals += [(int(c), x) for c in rng.permutation(beside[not_refused(form.instance, beside)])[:OTHERS]]
        short = [reached(form, combination, start, target) for combination, start in rivals]
        assert all(t is None or t > -SURE for t in short)
        compared += sum(t is not None for t in short)
    assert compared > 0
