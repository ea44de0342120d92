"""Analysis of single designs: no search, no rounding, every limit told."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from typing import Any, TypeAlias

import casadi as ca
import numpy as np

from synth.analysis.designs import lookup_rows, make_design, make_frame
from synth.analysis.settings import DERIVED
from synth.errors import InputError, RefusedError, at
from synth.model.model import DataInput, Model
from synth.question.arguments import DesignSource, DesignValues, Family, Limits, Objectives, Requirements, UserTables
from synth.question.inputs import inputs_of_design, part_value
from synth.question.instance import Instance
from synth.question.names import as_mapping
from synth.question.objectives import chosen_objectives
from synth.question.offers import offers
from synth.question.request import Request
from synth.question.search_range import outside, refuse_not_computable, refuse_other_sign, shown_range, widened
from synth.question.selection import part_row
from synth.results import Design
from synth.results.design import DesignSteps
from synth.special import expanded
from synth.units import parse_quantity, typed_quantity

Residuals: TypeAlias = Callable[[np.ndarray], np.ndarray]


def evaluate(
    p: Family,
    requirements: Requirements,
    design: DesignSource | None = None,
    *,
    values: DesignValues | None = None,
    parts: Mapping[str, str] | None = None,
    catalogs: UserTables = None,
    limits: Limits | None = None,
    objectives: Objectives = None,
) -> Design:
    """Analyse one design: every quantity, every limit; nothing is searched or rounded.

    A value outside of the range that is searched is computed as well, and told in ``outside``.

    Parameters
    ----------
    p : family name, DesignProblem subclass or instance
    requirements : mapping
        As for ``synthesize``.
    design : Design or mapping, optional
        A Design, or a mapping with ``values`` and ``parts`` (strings with units).
    values, parts : mapping, optional
        The same two, given directly. Derived quantities may stand for as many variables.
    catalogs, limits, objectives : optional
        As for ``synthesize``.

    Returns
    -------
    Design
        With ``status`` feasible or infeasible, and ``violated`` naming every limit that fails.

    Raises
    ------
    InputError
        When something is missing, unknown or cannot be computed, or more is given than needed.
    """
    if design is not None and (values is not None or parts is not None):
        raise InputError("design", "design and values/parts", "either a design, or values= and parts=")
    if isinstance(design, Design):
        values = {n: design.values[n] for n, k in design.frame.kinds.items() if k in ("variable", "count")}
        si = {**values, **design.choices}
        parts = {slot: str(row) for slot, row in design.parts.items()}
        return analysed(p, requirements, si, parts, catalogs=catalogs, limits=limits, objectives=objectives)
    if design is not None:
        if not isinstance(design, Mapping):
            raise InputError("design", design, "a Design, or a mapping with 'values' and 'parts'", ("design",))
        values, parts = design.get("values"), design.get("parts")
    values = as_mapping(values, "values", "{'mass': '20 kg'}")
    parts = as_mapping(parts, "parts", "{'slot': 'designation'}")
    return analysed(
        p, requirements, values, parts, catalogs=catalogs, limits=limits, objectives=objectives, in_si=False
    )


def analysed(
    p: Family,
    requirements: Requirements,
    values: Mapping[str, Any],
    parts: Mapping[str, str],
    *,
    catalogs: UserTables = None,
    limits: Limits | None = None,
    objectives: Objectives = None,
    in_si: bool = True,
) -> Design:
    """Analyse a design; ``in_si``: its sizes, counts and choices are kept in SI. All else as for :func:`evaluate`.

    Raises
    ------
    InputError
        As for :func:`evaluate`.
    """
    instance = Instance(Request.of(p, requirements, catalogs, limits=limits), restrict=False)
    model = instance.model
    rows = _chosen_rows(instance, parts)
    known, choices, derived = _read_values(model, values, in_si)
    instance.limits.judge_unknowns(known)
    data = _data(instance, rows, known, choices)
    remarks = _refuse_discrete(instance, data, rows)
    variables = _complete_variables(model, known, derived, data)
    frame = make_frame(instance, chosen_objectives(model, objectives))
    part_rows = {slot: part_row(table, index) for slot, (table, index) in rows.items()}
    result = instance.evaluate(np.asarray(variables, dtype=float)[None, :], data)
    beyond = outside(model, {**known, **dict(zip((v.name for v in model.variables), variables.tolist(), strict=True))})
    refuse_not_computable(model, result, beyond, variables, data)
    next_rows = model.next_rows(variables[None, :], data)[0]
    return make_design(
        instance,
        frame,
        variables,
        result,
        0,
        part_rows,
        choices,
        remarks=remarks,
        outside=beyond,
        steps=DesignSteps(model.steps(variables[None, :], data)[0]),
        next_rows=next_rows,
        rows=lookup_rows(model, next_rows),
    )


def _chosen_rows(instance: Instance, parts: Mapping[str, str]) -> dict[str, tuple[Any, int]]:
    model = instance.model
    slots = model.declaration.slots
    designations = {model.name_of(str(word), "parts", list(slots), "a slot"): str(d) for word, d in parts.items()}
    result = {}
    for slot, part in slots.items():
        if slot not in designations:
            raise InputError(f"parts: {slot}", None, f"a designation of table {part.table}", ("parts", slot))
        table = instance.catalogs.table(part.table)
        with at("parts", slot):
            result[slot] = (table, table.row_index(designations[slot]))
    return result


def _read_values(
    model: Model, values: Mapping[str, Any], in_si: bool
) -> tuple[dict[str, float], dict[str, str], dict[str, float]]:
    d = model.declaration
    known, choices, derived = dict[str, float](), dict[str, str](), dict[str, float]()
    for word, value in values.items():
        among = [*model.quantity_sx, *d.choices]
        name = model.name_of(str(word), "values", among, "a variable, count, choice or derived quantity")
        if name in known or name in choices or name in derived:
            right = "each quantity once (name and symbol mean the same)"
            raise InputError(f"values: {name}", word, right, ("values", str(word)))
        if name in d.choices:
            label = ("yes" if value else "no") if isinstance(value, bool) else str(value)
            if label not in d.choices[name].labels:
                raise InputError(f"values: {name}", value, d.choices[name].expected(label), ("values", name))
            choices[name] = label
            continue
        with at("values", name):
            si = float(value) if in_si else parse_quantity(value, model.units[name], f"values: {name}")
        (derived if name in d.derived else known)[name] = si
    for name, choice in d.choices.items():
        if name not in choices:
            raise InputError(f"values: {name}", None, "one of " + ", ".join(choice.labels), ("values", name))
    for name, count in d.counts.items():
        if name not in known:
            raise InputError(f"values: {name}", None, f"a value, {shown_range(count)} as a rule", ("values", name))
    refuse_other_sign(model, known)
    return known, choices, derived


def _data(
    instance: Instance, rows: Mapping[str, tuple[Any, int]], known: Mapping[str, float], choices: Mapping[str, str]
) -> list[float]:
    def part(entry: DataInput) -> float:
        table, index = rows[entry.name]
        value = float(part_value(table, [index], entry.columns)[0])
        if np.isnan(value) and entry.required:
            right = f"a row with a value in {' or '.join(entry.columns)}"
            raise InputError(f"parts: {entry.name}", table.designations[index], right, ("parts", entry.name))
        return value

    return inputs_of_design(instance.model, instance.values.requirements, instance.values.rows, known, choices, part)


def _refuse_discrete(instance: Instance, data: Sequence[float], rows: Mapping[str, tuple[Any, int]]) -> tuple[str, ...]:
    """Refuse parts and counts that must not be used; remark on rows that the slot would not offer."""
    model = instance.model
    symbols = {str(e.sx): v for e, v in zip(model.data_inputs, data, strict=True)}
    for refusal, kinds in zip(model.declaration.refusals, model.refusal_kinds, strict=True):
        if kinds:
            when = expanded(refusal.when, model.calls)
            used = ca.symvar(when)
            function = ca.Function("refused", used, [when])
            if float(function(*[symbols[str(s)] for s in used])) > 0.5:
                name = min(kinds)
                path = ("parts" if name in model.declaration.slots else "values", name)
                raise RefusedError(refusal.code, ", ".join(sorted(kinds)), refusal.message, path)
    remarks = []
    for slot, (table, index) in rows.items():
        part = model.declaration.slots[slot]
        if not offers(part, table)[index]:
            remarks.append(f"unusual_part: {slot} {table.designations[index]} does not meet {' and '.join(part.where)}")
    return tuple(remarks)


def _complete_variables(
    model: Model, known: Mapping[str, float], derived: Mapping[str, float], data: Sequence[float]
) -> np.ndarray:
    """Return all variables, solving for those that derived quantities stand for."""
    missing = [k for k, v in enumerate(model.variables) if v.name not in known]
    if len(derived) != len(missing):
        names = [model.variables[k].name for k in missing]
        if not names:
            raise InputError(
                "values", ", ".join(derived), "no derived quantities: all variables are given already", ("values",)
            )
        if not derived:
            v = model.variables[missing[0]]
            low, high = typed_quantity(v.lower, v.unit), typed_quantity(v.upper, v.unit)
            right = f"a value ({low} to {high}), or a derived quantity in its place"
            raise InputError(f"values: {v.name}", None, right, ("values", v.name))
        right = f"exactly {len(names)} derived quantities in place of {', '.join(names)}"
        raise InputError("values", ", ".join(derived), right, ("values",))
    variables = np.array([known.get(v.name, np.nan) for v in model.variables])
    if missing:
        variables[missing] = _solve_for(model, missing, derived, variables, data)
    return variables


def _solve_for(
    model: Model, missing: list[int], derived: Mapping[str, float], variables: np.ndarray, data: Sequence[float]
) -> np.ndarray:
    """Return the missing variables that give the derived quantities: within what is searched, or else nearest to it."""
    unknown = [model.variables[k] for k in missing]
    names = list(derived)
    target = np.array([derived[n] for n in names])
    scale = np.maximum(np.abs(target), DERIVED.smallest)
    function = model.function(("solve", tuple(missing), tuple(names)), lambda: _derived_function(model, missing, names))
    lower, upper = np.array([v.lower for v in unknown]), np.array([v.upper for v in unknown])

    def difference(x: np.ndarray) -> np.ndarray:
        missed: np.ndarray = (np.asarray(function(x, variables, data)[0]).ravel() - target) / scale
        return missed

    def slope(x: np.ndarray) -> np.ndarray:
        relative: np.ndarray = np.asarray(function(x, variables, data)[1]) / scale[:, None]
        return relative

    rng = np.random.default_rng(0)
    starts = [np.where(upper > 0, np.sqrt(np.maximum(lower, 1e-9) * np.maximum(upper, 0.0)), 0.5 * (lower + upper))]
    starts += list(lower + (upper - lower) * rng.random((DERIVED.starts, len(unknown))))
    for x in _solutions(difference, slope, starts, lower, upper):
        return x
    least, most = widened(unknown, DERIVED.wider)
    # Searched lies nearest what was meant; from its corners and inside, and from further out.
    shares = rng.random((DERIVED.outside, len(unknown)))
    reach = [np.clip(lower + (upper - lower) * (3 * share - 1), least, most) for share in shares]
    solutions = list(_solutions(difference, slope, [lower, upper, *starts[: DERIVED.again], *reach], least, most))
    if solutions:
        size = np.maximum(upper - lower, DERIVED.smallest * np.abs(upper))
        return min(solutions, key=lambda x: float(np.max(np.maximum(lower - x, x - upper) / size)))
    targets = ", ".join(f"{n} = {typed_quantity(derived[n], model.units[n])}" for n in names)
    ranges = ", ".join(f"{v.name} ({shown_range(v)})" for v in unknown)
    right = f"quantities that some {ranges} can give, or values not far outside"
    raise InputError("values", targets, right, ("values",))


def _solutions(
    difference: Residuals, slope: Residuals, starts: Sequence[np.ndarray], lower: np.ndarray, upper: np.ndarray
) -> Iterator[np.ndarray]:
    """Yield the points within bounds at which nothing differs, one per start that leads to one."""
    from scipy.optimize import least_squares  # costly to import; most designs are given by their variables

    for start in starts:
        with np.errstate(all="ignore"):
            try:
                answer = least_squares(
                    difference,
                    np.clip(start, lower, upper),
                    jac=slope,
                    bounds=(lower, upper),
                    xtol=1e-15,
                    ftol=1e-15,
                    gtol=1e-15,
                    x_scale=np.maximum(np.abs(lower), np.abs(upper)),
                )
            except (ValueError, np.linalg.LinAlgError):
                continue  # this start left the domain of a formula
            x = _polish(answer.x, difference, slope, lower, upper)
            solved = bool(np.max(np.abs(difference(x))) <= DERIVED.solved)
        if solved:
            yield x


def _derived_function(model: Model, missing: list[int], names: list[str]) -> Any:
    x = ca.SX.sym("x", len(missing))
    known = ca.SX.sym("known", len(model.variables))
    data = ca.SX.sym("data", len(model.data_inputs))
    replaced = [x[missing.index(k)] if k in missing else known[k] for k in range(len(model.variables))]
    replaced += [data[k] for k in range(len(model.data_inputs))]
    everything = dict(zip(model.quantity_node, model.program.symbolic(replaced), strict=False))
    outputs = ca.vertcat(*[everything[n] for n in names])
    return ca.Function("derived", [x, known, data], [outputs, ca.jacobian(outputs, x)])


def _polish(x: np.ndarray, difference: Residuals, slope: Residuals, lower: np.ndarray, upper: np.ndarray) -> np.ndarray:
    """Finish with Newton steps: least squares stops at the square root of what is reachable."""
    for _ in range(DERIVED.newton):
        try:
            step = np.linalg.solve(slope(x), difference(x))
        except np.linalg.LinAlgError:
            return x
        moved = np.clip(x - step, lower, upper)
        if np.max(np.abs(difference(moved))) >= np.max(np.abs(difference(x))):
            return x
        x = moved
    return x
