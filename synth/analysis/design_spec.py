"""What a spec gives: a question, or a design that is evaluated, for whoever takes the one or the other."""

from __future__ import annotations

from typing import TYPE_CHECKING

from synth.errors import InputError
from synth.question.spec_keys import A_DESIGN, refuse_several, refuse_values

if TYPE_CHECKING:
    from synth.model.problem import DesignProblem
    from synth.question.spec import Spec
    from synth.results import Design
    from synth.tables.catalogs import Catalogs


def must_be_one_family(asked: Spec) -> None:
    """Refuse a spec of several families."""
    refuse_several(asked.family, asked.file)


def must_be_a_question(asked: Spec) -> None:
    """Refuse a spec with values."""
    refuse_values(asked.values, asked.file)


def must_be_a_design(asked: Spec) -> None:
    """Refuse a spec of several families, without values, or with something left to fix."""
    must_be_one_family(asked)
    if asked.values is None:
        raise InputError(
            f"{asked.file}: values",
            None,
            A_DESIGN,
            ("values",),
        )
    if asked.fix:
        right = "these under values: a given design has nothing left to fix"
        raise InputError(f"{asked.file}: fix", ", ".join(asked.fix), right, ("fix",))


def given_design(asked: Spec, tables: Catalogs | None = None) -> tuple[DesignProblem, Catalogs, Design]:
    """Load the problem and evaluate the design that a spec with values describes.

    ``tables``: in place of those that the spec names.
    """
    from synth.analysis.evaluate import evaluate
    from synth.model.registry import load
    from synth.question.catalogs import catalogs_for
    from synth.robust.counterpart import robust_counterpart

    problem = robust_counterpart(load(asked.family, **asked.options), asked.robust or None, asked.limits)
    catalogs = catalogs_for(problem, asked.catalogs if tables is None else tables, asked.folder)
    design = evaluate(
        problem,
        asked.requirements,
        values=asked.values,
        parts=_one_each(asked),
        catalogs=catalogs,
        limits=asked.limits,
        objectives=asked.objectives,
    )
    return problem, catalogs, design


def _one_each(asked: Spec) -> dict[str, str]:
    """Return the designation per slot; a list of one counts as that one."""
    result = {}
    for slot, rule in asked.parts.items():
        rows = [rule] if isinstance(rule, str) else list(rule)
        if len(rows) != 1:
            right = "one designation: a given design has one part in each slot"
            raise InputError(f"{asked.file}: parts: {slot}", rows, right, ("parts", slot))
        result[slot] = rows[0]
    return result
