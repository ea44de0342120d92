"""What a spec gives: a question, or a design that is evaluated, for whoever takes the one or the other."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from synth.errors import Described, InputError
from synth.question.request_fields import ROW_EXPECTED
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

    Rows of tables that are away are those that the spec has kept, or the front beside it. ``tables``: in place of those
    that the spec names.
    """
    from synth.analysis.evaluate import evaluate
    from synth.analysis.restate import IN_MEMORY
    from synth.model.registry import load
    from synth.question.catalogs import catalogs_for
    from synth.results.loading import rows_kept
    from synth.robust.counterpart import robust_counterpart

    problem = robust_counterpart(load(asked.family, **asked.options), asked.robust or None, asked.limits)
    kept = _rows_kept(asked)
    stated = asked.catalogs if tables is None else tables
    if stated is None or isinstance(stated, Mapping):  # what was in memory no file names
        stated = {**{str(row["table"]): IN_MEMORY for row in asked.rows.values()}, **(stated or {})} or None
    known = rows_kept(asked.folder)
    rows = {name: list({**known.get(name, {}), **kept.get(name, {})}.values()) for name in {**known, **kept}}
    catalogs = catalogs_for(problem, stated, asked.folder, rows)
    try:
        design = evaluate(
            problem,
            asked.requirements,
            values=asked.values,
            parts=_one_each(asked),
            catalogs=catalogs,
            limits=asked.limits,
            objectives=asked.objectives,
        )
    except InputError as error:
        gone = {f"table {name}": file for name, file in catalogs.away().items()}
        if error.field not in gone:
            raise
        right = f"{error.expected}, the rows kept; {gone[error.field]} with all others is not there"
        raise InputError(error.field, error.value, right, error.path) from error
    return problem, catalogs, design


def _rows_kept(asked: Spec) -> dict[str, dict[str, dict[str, Any]]]:
    """Return the rows that a spec has kept of tables, by table and designation.

    Raises
    ------
    InputError
        One is not as it was written.
    """
    from synth.tables.reading import OF_RECORD
    from synth.tables.table import row_hash

    found: dict[str, dict[str, dict[str, Any]]] = {}
    for key, told in asked.rows.items():
        cells = {name: x for name, x in told.items() if name not in OF_RECORD}
        cells = {name: x if x is None or isinstance(x, str) else float(x) for name, x in cells.items()}
        if row_hash(cells) != told["hash"]:
            raise InputError(f"rows: {key}", Described("a row that was changed"), ROW_EXPECTED, ("rows", key))
        found.setdefault(told["table"], {})[told["designation"]] = {**told, **cells}
    return found


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
