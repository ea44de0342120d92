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


def must_be_one_family(spec: Spec) -> None:
    """Refuse a spec of several families."""
    refuse_several(spec.family, spec.file)


def must_be_a_question(spec: Spec) -> None:
    """Refuse a spec with values."""
    refuse_values(spec.values, spec.file)


def must_be_a_design(spec: Spec) -> None:
    """Refuse a spec of several families, without values, or with something left to fix."""
    must_be_one_family(spec)
    if spec.values is None:
        raise InputError(f"{spec.file}: values", None, A_DESIGN, ("values",))
    if spec.fix:
        right = "these under values: a given design has nothing left to fix"
        raise InputError(f"{spec.file}: fix", ", ".join(spec.fix), right, ("fix",))


def design_of_spec(spec: Spec, tables: Catalogs | None = None) -> tuple[DesignProblem, Catalogs, Design]:
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

    problem = robust_counterpart(load(spec.family, **spec.options), spec.robust or None, spec.limits)
    kept = _rows_kept(spec)
    sources = spec.catalogs if tables is None else tables
    if sources is None or isinstance(sources, Mapping):  # a file names no table that was in memory
        sources = {**{str(row["table"]): IN_MEMORY for row in spec.rows.values()}, **(sources or {})} or None
    known = rows_kept(spec.folder)
    rows = {name: list({**known.get(name, {}), **kept.get(name, {})}.values()) for name in {**known, **kept}}
    catalogs = catalogs_for(problem, sources, spec.folder, rows)
    try:
        design = evaluate(
            problem,
            spec.requirements,
            values=spec.values,
            parts=_one_each(spec),
            catalogs=catalogs,
            limits=spec.limits,
            objectives=spec.objectives,
        )
    except InputError as error:
        gone = {f"table {name}": file for name, file in catalogs.away().items()}
        if error.field not in gone:
            raise
        right = f"{error.expected}, the rows kept; {gone[error.field]} with all others is not there"
        raise InputError(error.field, error.value, right, error.path) from error
    return problem, catalogs, design


def _rows_kept(spec: Spec) -> dict[str, dict[str, dict[str, Any]]]:
    """Return the rows that a spec has kept of tables, by table and designation.

    Raises
    ------
    InputError
        One is not as it was written.
    """
    from synth.tables.reading import OF_RECORD
    from synth.tables.table import row_hash

    by_table: dict[str, dict[str, dict[str, Any]]] = {}
    for key, entry in spec.rows.items():
        cells = {name: x for name, x in entry.items() if name not in OF_RECORD}
        cells = {name: x if x is None or isinstance(x, str) else float(x) for name, x in cells.items()}
        if row_hash(cells) != entry["hash"]:
            raise InputError(f"rows: {key}", Described("a row that was changed"), ROW_EXPECTED, ("rows", key))
        by_table.setdefault(entry["table"], {})[entry["designation"]] = {**entry, **cells}
    return by_table


def _one_each(spec: Spec) -> dict[str, str]:
    """Return the designation per slot; a list of one counts as that one."""
    result = {}
    for slot, rule in spec.parts.items():
        rows = [rule] if isinstance(rule, str) else list(rule)
        if len(rows) != 1:
            right = "one designation: a given design has one part in each slot"
            raise InputError(f"{spec.file}: parts: {slot}", rows, right, ("parts", slot))
        result[slot] = rows[0]
    return result
