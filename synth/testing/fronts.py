"""What fronts of feasible cases and the explanation of the infeasible case must keep."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from functools import cache, cached_property
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np
import pytest
import yaml

import synth
from synth.declaration import Objective
from synth.folders.files import read_bytes
from synth.results.front import front_record
from synth.results.front_record import record_text
from synth.search.formulation import Formulation
from synth.search.refused_cells import not_refused
from synth.testing.properties import Properties
from synth.testing.records import Case, answer, cases_of, front_of, question
from synth.text.input_limits import INPUT_LIMITS

POINTS = 400
SPARE = 20_000  # bytes per design, for what scatters (12 000 where six things do) and for what ties
of_a_front = Properties()


@dataclass(frozen=True)
class FeasibleCase:
    """A feasible case; ``thorough``: all its tightened requirements are tried, else one."""

    family: str
    name: str
    thorough: bool

    @property
    def case(self) -> Case:
        """Question."""
        return cases_of(self.family).feasible[self.name]

    @property
    def front(self) -> synth.ParetoFront:
        """Front, not interrupted."""
        front = front_of(self.family, self.name)
        assert front.interrupted == ""
        return front

    @cached_property
    def optimum(self) -> float:
        """Least value of the first objective, with the seed by default."""
        return least(self)


@of_a_front
def feasible_examples_are_answered_and_proven(example: FeasibleCase) -> None:
    front = example.front
    assert front.status.value == "optimal"
    assert 2 <= len(front.designs) <= 4
    assert front.certificate.kind == "global"
    objectives = list(front.frame.objectives)
    values = np.array([[d.values[n] for n in objectives] for d in front.designs])
    for k, row in enumerate(values):
        assert not any(np.all(other <= row) for j, other in enumerate(values) if j != k)


@of_a_front
def the_search_calls_feasible_what_the_evaluation_does(example: FeasibleCase) -> None:
    instance = example.front.question
    form = Formulation(instance, {}, 0)
    rng = np.random.default_rng(11)
    designs = [[d.values[v.name] for v in instance.model.variables] for d in example.front.designs]
    variables = np.repeat(designs, POINTS // len(designs), axis=0)
    # On and near the designs, where some limit is just kept or just missed.
    variables *= np.exp(rng.normal(0, 1e-3, variables.shape) * (rng.random(variables.shape) < 0.2))
    variables = np.clip(variables, instance.ranges.lower, instance.ranges.upper)
    combinations = rng.integers(0, instance.combinations.count, len(variables))
    close, edge = (
        form.points.feasible_rows(variables, combinations)[0],
        form.points.edge_rows(variables, combinations)[0],
    )
    assert not set(close) & set(edge)
    rows = np.union1d(close, edge)
    result = form.points.evaluate(variables, combinations)
    allowed = result.feasible & not_refused(form.instance, combinations)
    assert 0 < len(rows)
    np.testing.assert_array_equal(rows, np.flatnonzero(allowed))


@of_a_front
def every_limit_has_a_utilisation(example: FeasibleCase) -> None:
    front = example.front
    for design in front.designs:
        assert set(design.utilisation) == set(front.frame.limit_units)
        unchecked = {remark.split()[2].rstrip(",") for remark in design.not_checked}
        for name, used in design.utilisation.items():
            if used is None:
                assert name in unchecked
            else:
                assert 0 <= used <= 1 + 2e-6


@of_a_front
def designs_are_makeable(example: FeasibleCase) -> None:
    front = example.front
    for design in front.designs:
        assert design.off_grid == {}


@of_a_front
def design_files_say_the_same_design_in_few_digits(example: FeasibleCase) -> None:
    family, case, front = example.family, example.case, example.front
    for design in front.designs:
        assert design.digits is not None
        spec = yaml.safe_load(design.yaml())
        again = synth.evaluate(
            synth.load(family, **spec.get("options", {})),
            spec["requirements"],
            {"values": spec["values"], "parts": spec["parts"]},
            limits=case.settings.get("limits"),
            objectives=front.frame.objectives,
        )
        assert (again.violated, again.not_checked) == ((), design.not_checked)
        assert set(design.advice) >= set(again.advice)
        assert again.off_grid == design.off_grid
        for name, value in design.objectives.items():
            assert again.objectives[name] == pytest.approx(value, rel=1e-9, abs=0.0)
        for name, kind in design.frame.kinds.items():
            if kind == "count":
                assert spec["values"][name] == design.values[name] or isinstance(spec["values"][name], str)
            elif kind == "variable" and design.digits:
                number = str(spec["values"][name]).split()[0].split("e")[0]
                assert len(number.replace(".", "").strip("-0")) <= design.digits


@of_a_front
def checking_a_design_gives_its_values_again(example: FeasibleCase) -> None:
    family, case, front = example.family, example.case, example.front
    for design in front.designs:
        spec = design.to_spec()
        problem = synth.load(family, **spec.get("options", {}))
        again = synth.evaluate(problem, spec["requirements"], spec, limits=case.settings.get("limits"))
        assert again.status.value == "feasible"
        assert again.violated == ()
        for name, value in design.values.items():
            assert again.values[name] == value or (math.isnan(value) and math.isnan(again.values[name]))
        # Limits of one's own on variables and counts bound a search; of a given design they are told as well.
        unknowns = {n for n, kind in design.frame.kinds.items() if kind in ("variable", "count")}
        more = set(again.utilisation) - set(design.utilisation)
        assert {name.split()[0] for name in more} <= unknowns & set(case.settings.get("limits") or {})
        assert {n: again.utilisation[n] for n in design.utilisation} == design.utilisation
        assert again.advice == design.advice


@of_a_front
def the_largest_front_can_be_read_back(example: FeasibleCase) -> None:
    front = example.front

    def text(designs: list[synth.Design]) -> bytes:
        return record_text(front_record(replace(front, designs=designs))).encode()

    longest = max(front.designs, key=lambda d: len(text([d])))
    one, two = (len(text([longest] * count)) for count in (1, 2))
    size = one + (two - one) * (INPUT_LIMITS.points - 1)
    with TemporaryDirectory() as folder:
        path = Path(folder) / "front.json"
        path.write_bytes(text([longest]).ljust(size))
        assert len(read_bytes(path, "front")) == size
    assert size + SPARE * INPUT_LIMITS.points < INPUT_LIMITS.file


def best(family: str, case: Case, objective: str, **more: Any) -> synth.Design | None:
    """Best design by one objective."""
    front = answer(family, case, objectives=[objective], points=1, **more)
    assert front.interrupted == ""
    return front.designs[0] if front.designs else None


@cache
def first_objective(family: str) -> Objective:
    """First objective that a search takes by default."""
    declared = question(family, {}, optional=False).model.declaration.objectives.values()
    return next(o for o in declared if o.default)


def least(example: FeasibleCase, **more: Any) -> float:
    """Least value of the first objective."""
    objective = first_objective(example.family).name
    found = best(example.family, example.case, objective, **more)
    assert found is not None
    return float(found.values[objective])


@of_a_front
def another_seed_reaches_the_same_optimum(example: FeasibleCase) -> None:
    objective = first_objective(example.family).name
    assert least(example, seed=1) == pytest.approx(example.optimum, rel=1e-3)
    extreme = min(d.values[objective] for d in example.front.designs)
    assert example.optimum == pytest.approx(extreme, rel=1e-3)


@of_a_front
def tightening_never_improves_an_objective(example: FeasibleCase) -> None:
    objective = first_objective(example.family)
    assert objective.sense == "min"
    for name, value in list(example.case.tighten.items())[: None if example.thorough else 1]:
        tight = best(example.family, example.case, objective.name, requirements={name: value})
        if tight is not None:
            assert tight.values[objective.name] >= example.optimum * (1 - 1e-3), name
    assert least(example, gap=0.05) <= example.optimum * 1.06


def explained_by_name(family: str) -> None:
    """Check that the infeasible case is explained by a culprit."""
    front = answer(family, cases_of(family).infeasible)
    assert front.status.value == "infeasible"
    assert len(front.designs) == 0
    assert front.explanation is not None
    named = [c["limit"] for c in front.explanation["conflicts"]]
    assert named
    assert set(named) <= set(front.frame.limit_units)
    assert set(named) & cases_of(family).culprits
    for name in named:
        assert name in front.explanation["message"]
    guards = {x.name for x in question(family, {}, optional=True).model.limits if x.guard}
    assert not set(named) & guards  # a guard cannot be relaxed, so it explains nothing
