"""The calculation of a question: formulas read back from the trace, with named quantities in place of what they are.

What is read is what was solved: the same symbols, the same operations, special functions written out. A formula that
is too long for a line is told in parts (``u_1``, ``u_2``, ...), those first that stand there more than once; a family
that names its steps (``Declaration.step``) needs none.
"""

from __future__ import annotations

import math
from collections.abc import Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import count
from typing import Any

import casadi as ca

from synth.analysis.restate import question_of
from synth.declaration import Declaration, Origin
from synth.declaration.records import Choice, Constant, Count, Derived, RequirementRecord, Step, VariableRecord
from synth.model.constraint import Constraint
from synth.model.model import Model
from synth.model.problem import DesignProblem
from synth.model.program import COMPARISONS, OP_SELECT, OPERATIONS, Node, Program
from synth.question.arguments import Family, Limits, Requirements, UserTables
from synth.question.inputs import fixed_row_values
from synth.question.instance import Instance
from synth.question.request import Request
from synth.results import ParetoFront
from synth.results.calculation import Calculation, LimitRule, NamedQuantity, RemarkRule, load_calculation
from synth.results.dimensions import dimension_of, unit_for
from synth.results.expression import Expression, names_in, simplified_product, simplified_sum
from synth.robust.counterpart import nominal
from synth.special import expanded
from synth.tables.catalogs import Catalogs
from synth.text.row_cells import CODE_OF, named_column

LONGEST = 26  # quantities and numbers in one formula: what fits a line of a page
SHORTEST = 5  # in a part of a formula that is told alone
DEEPEST = 50  # operations inside each other in one formula: what readers of JSON and spreadsheets take

ONE: Expression = ["n", 1.0]


def calculation(
    asked: ParetoFront | DesignProblem | type[DesignProblem] | str,
    requirements: Requirements | None = None,
    catalogs: UserTables = None,
    limits: Limits | None = None,
    problem: Family | None = None,
) -> Calculation:
    """Calculation of every number of a design.

    Parameters
    ----------
    asked : ParetoFront, family name, DesignProblem subclass or instance
        A front that was loaded is read from its ``calculation.json``; one that has none is traced again.
    requirements : mapping, optional
        Of a problem: as for ``synthesize``. A front has its own.
    catalogs, limits : optional
        Of a problem, as for ``synthesize``; of a front, own tables that were in memory.
    problem : DesignProblem subclass or instance, optional
        For a loaded front of a problem of one's own.

    Returns
    -------
    Calculation
        ``calculation.of_design(design)`` has all quantities and limits of a design, computed anew and compared with its
        record.

    Raises
    ------
    InputError
        When the question cannot be posed, or the file is not what was saved with the front.
    """
    if isinstance(asked, ParetoFront):
        return _of_front(asked, problem, catalogs)
    # A given design may lie outside of what is searched, so limits bound nothing here.
    return calculation_of(Instance(Request.of(asked, requirements or {}, catalogs, limits=limits), restrict=False))


def _of_front(front: ParetoFront, problem: Family | None, catalogs: UserTables) -> Calculation:
    saved = front.kept.get("calculation")
    if saved and front.folder is not None and problem is None and catalogs is None:
        return load_calculation(front.folder, saved)
    return calculation_of(question_of(front, problem, catalogs, kept=True))


def calculation_of(instance: Instance) -> Calculation:
    """Return the calculation of a question; scatter is recorded with its designs."""
    model, nominal_problem = instance.model, nominal(instance.problem)
    if nominal_problem is not instance.problem:
        model = nominal_problem.model(frozenset(instance.values.given), instance.catalogs)
    formulas: _Formulas = model.function("formulas", lambda: _Formulas.read(model))
    rows = fixed_row_values(model.declaration, instance.catalogs)
    inputs = _inputs(model, instance, rows)
    quantities = {q.name: q for q in [*inputs, *formulas.constants]}
    for q in formulas.computed:
        quantities[q.name] = q if q.kind != "helper" else _with_unit(q, quantities)
    of_user = [_of_user(x) for x in instance.limits.judging if x.origin in (Origin.USER, Origin.PIN)]
    d = model.declaration
    return Calculation(
        family=nominal_problem.name,
        title=nominal_problem.title or nominal_problem.name,
        sources=tuple(nominal_problem.sources),
        options={name: o.chosen for name, o in d.options.items()},
        quantities=quantities,
        limits=(*formulas.limits, *of_user),
        remarks=formulas.remarks,
    )


def _of_user(x: Constraint) -> LimitRule:
    return LimitRule(
        name=x.name,
        sense=x.sense,
        unit=x.unit,
        text="limit of the user",
        value=["q", x.quantity],
        limit=["n", float(x.bound)],
        guard=x.guard,
        scale=x.scale,
        needs=x.behind,
        stated_by="user",
    )


def _with_unit(q: NamedQuantity, known: Mapping[str, NamedQuantity]) -> NamedQuantity:
    """Return a part of a formula with a unit, as far as that follows from what it is made of."""
    assert q.expression is not None
    dimension = dimension_of(q.expression, known)
    if dimension is None or any(x.denominator > 1 for x in dimension):
        return replace(q, unit="")
    return replace(q, unit=unit_for(dimension)) if any(dimension) else q


# ---- inputs ---------------------------------------------------------------------------------------------------------


def _inputs(model: Model, instance: Instance, rows: Mapping[str, float]) -> list[NamedQuantity]:
    """Inputs of a model: requirements, searched quantities and cells of tables.

    A requirement that follows from others is computed.
    """
    d, quantities = model.declaration, list[NamedQuantity]()
    defaults = _defaults(model)
    for r in d.requirements.values():
        if r.sx is not None and not r.follows:
            default = defaults.get(r.name)
            quantities.append(_quantity(r, "requirement", group=r.group, expression=default, bounds=(r.lower, r.upper)))
    for v in d.variables.values():
        quantities.append(_quantity(v, "variable", bounds=(v.lower, v.upper)))
    for c in d.counts.values():
        step = float(c.values[1] - c.values[0]) if len(c.values) > 1 else None
        quantities.append(_quantity(c, "count", bounds=(float(c.values[0]), float(c.values[-1])), step=step))
    for choice in d.choices.values():
        quantities.append(_quantity(choice, "choice", labels=choice.labels))
    quantities += _of_rows(model, instance.catalogs, rows)
    return _with_distinct_symbols(quantities, d)


_Declared = RequirementRecord | VariableRecord | Count | Choice | Derived | Step | Constant


def _quantity(record: _Declared, kind: str, **more: Any) -> NamedQuantity:
    """Quantity of a declared record; choices have no unit."""
    return NamedQuantity(
        name=record.name,
        kind=kind,
        symbol=record.symbol,
        unit=getattr(record, "unit", "-"),
        text=record.text,
        source=record.source,
        **more,
    )


def _of_rows(model: Model, catalogs: Catalogs, rows: Mapping[str, float]) -> list[NamedQuantity]:
    quantities = []
    for entry in model.data_inputs:
        if entry.kind not in ("part", "row"):
            continue
        part = (model.declaration.slots if entry.kind == "part" else model.declaration.rows)[entry.name]
        table = catalogs.table(part.table)
        names = [named_column(c) for c in entry.columns]
        column = next((table.column(name) for name in names if table.has(name)), None)
        texts = tuple(sorted(part.texts.get(names[0], ()))) if entry.columns[0].startswith(CODE_OF) else ()
        value = rows[str(entry.sx)] if entry.kind == "row" else None
        quantities.append(
            NamedQuantity(
                name=entry.label,
                kind=entry.kind,
                symbol=(column.symbol if column is not None else "") or names[0],
                unit=(column.unit or "-") if column is not None else "",
                text=column.description
                if column is not None
                else f"{names[0]}, a column that this table does not have",
                source=f"table {part.table}",
                value=None if value is None or math.isnan(value) else value,
                slot=entry.name,
                columns=tuple(column.name if column is not None and names[0] == c else c for c in entry.columns),
                labels=texts,
            )
        )
    return quantities


def _with_distinct_symbols(inputs: Sequence[NamedQuantity], d: Declaration) -> list[NamedQuantity]:
    """Inputs with distinct symbols: a column that shares its symbol takes that of its slot."""
    declared = [*(x.symbol for x in d.derived.values()), *(x.symbol for x in d.steps.values())]
    declared += [x.symbol for x in d.constants.values()]
    in_use = declared + [q.symbol for q in inputs]
    result = []
    for q in inputs:
        if q.kind in ("part", "row") and in_use.count(q.symbol) > 1:
            slot = d.slots[q.slot].symbol if q.kind == "part" else q.slot.split(":", 1)[1]
            result.append(replace(q, symbol=f"{q.symbol}_{slot or q.slot}"))
        else:
            result.append(q)
    return result


def _defaults(model: Model) -> dict[str, Expression]:
    """Formulas of defaults that follow from other requirements, where no value is explicit."""
    d = model.declaration
    defaults = {
        r.name: ca.SX(r.default)
        for r in d.requirements.values()
        if r.sx is not None
        and not r.given
        and not r.follows
        and r.default is not None
        and not isinstance(r.default, float)
    }
    if not defaults:
        return {}
    program = Program(model.inputs, [expanded(e, model.calls) for e in defaults.values()])
    leaves = _input_names(model, program)
    reader, parts = _Reader(program, leaves), _Parts(program, leaves)
    # Parts stand behind all inputs, so that a default of more than a line is told by its value.
    return {name: reader.tree(k) for name, k in zip(defaults, program.outputs, strict=True) if parts.fits(k)}


def _input_names(model: Model, program: Program) -> dict[int, str]:
    labels = [v.name for v in model.variables] + [i.label for i in model.data_inputs]
    return dict(zip(program.input_nodes, labels, strict=True))


# ---- formulas -------------------------------------------------------------------------------------------------------


@dataclass(frozen=True)
class _Formulas:
    """What the formulas of a model say, whatever the numbers are."""

    constants: tuple[NamedQuantity, ...]
    computed: tuple[NamedQuantity, ...]
    limits: tuple[LimitRule, ...]
    remarks: tuple[RemarkRule, ...]

    @staticmethod
    def read(model: Model) -> _Formulas:
        """Read the formulas of a model from its trace."""
        d = model.declaration
        following = {r.name: r for r in d.requirements.values() if r.follows and r.sx is not None}
        expressions = [*(q.sx for q in d.derived.values()), *(q.sx for q in d.steps.values())]
        expressions += [r.default for r in following.values()]
        expressions += [side for x in d.limits.values() for side in (x.value, x.limit)] + [a.when for a in d.advices]
        everything = ca.vertsplit(expanded(ca.vertcat(*expressions), model.calls)) if expressions else []
        program = Program(model.inputs, everything)
        nodes = iter(program.outputs)
        named = {name: next(nodes) for name in (*d.derived, *d.steps, *following)}
        sides = {name: (next(nodes), next(nodes)) for name in d.limits}
        conditions = [next(nodes) for _ in d.advices]
        leaves = _input_names(model, program)
        for name, node in named.items():
            if program.nodes[node].op != ca.OP_CONST:
                leaves.setdefault(node, name)
        turned = _turned_round(program, leaves)
        roots = [*named.values(), *turned, *(node for pair in sides.values() for node in pair), *conditions]
        helpers = _Parts(program, leaves | turned, d.words()).of(roots)
        leaves |= helpers
        reader = _Reader(program, leaves, turned)
        needs = _needs(model, program, {**named, **{name: node for node, name in helpers.items()}})
        records: dict[str, NamedQuantity] = {}
        for name, node in named.items():
            record = d.derived.get(name) or d.steps.get(name) or following[name]
            tree = reader.written_out(node) if leaves.get(node) == name else reader.tree(node)
            kind = "derived" if name in d.derived else "step"
            records[name] = _quantity(record, kind, expression=tree, needs=needs[name])
        for node, name in helpers.items():
            tree, more = reader.written_out(node), needs[name]
            records[name] = NamedQuantity(name=name, kind="helper", symbol=name, unit="-", expression=tree, needs=more)
        return _Formulas(
            tuple(_quantity(c, "constant", value=c.value) for c in d.constants.values()),
            tuple(_in_order(records)),
            _rules(model, {name: (reader.tree(a), reader.tree(b)) for name, (a, b) in sides.items()}),
            tuple(
                RemarkRule(code=a.code, condition=reader.tree(node), message=a.message, source=a.source)
                for a, node in zip(d.advices, conditions, strict=True)
            ),
        )


def _rules(model: Model, sides: Mapping[str, tuple[Expression, Expression]]) -> tuple[LimitRule, ...]:
    """Limits of a model, with the formulas of their sides."""
    known = {x.name: x for x in model.constraints}
    return tuple(
        LimitRule(
            name=x.name,
            sense=x.sense,
            unit=x.unit,
            text=x.text,
            source=x.source,
            value=sides[x.name][0],
            limit=sides[x.name][1],
            guard=x.guard,
            scale=x.scale,
            needs=known[x.name].behind,
            optional=tuple(model.data_inputs[k].label for k in known[x.name].void_without),
            stated_by="user" if x.origin in (Origin.USER, Origin.PIN) else "family",
        )
        for x in model.declaration.limits.values()
    )


def _turned_round(program: Program, leaves: Mapping[int, str]) -> dict[int, str]:
    """Return nodes of which a named quantity is the negative: minus that quantity stands for them as well.

    CasADi takes signs out of sums and products, so that -(-M + L) is found where M - L was written.
    """
    negated = dict[int, str]()
    for node, name in leaves.items():
        operation = program.nodes[node]
        if operation.op == ca.OP_NEG and operation.args[0] not in leaves and program.nodes[operation.args[0]].args:
            negated.setdefault(operation.args[0], name)
    return negated


def _needs(model: Model, program: Program, named: Mapping[str, int]) -> dict[str, tuple[str, ...]]:
    """Return, per quantity, the guards without which it does not exist: those of what it is computed from."""
    declared = [(q.name, guard) for q in model.declaration.derived.values() for guard in q.needs]
    needs: dict[str, list[str]] = {name: [] for name in named}
    for guard in sorted({guard for _, guard in declared}):
        marked = program.downstream(named[name] for name, required in declared if required == guard)
        for name, node in named.items():
            if marked[node]:
                needs[name].append(guard)
    return {name: tuple(guards) for name, guards in needs.items()}


def _in_order(records: Mapping[str, NamedQuantity]) -> list[NamedQuantity]:
    """Quantities in an order in which each stands behind what it is computed from, otherwise as they were declared."""
    placed: dict[str, NamedQuantity] = {}
    stack = list(records)[::-1]  # parts come last, so that those of limits and remarks alone stand at the end
    while stack:
        q = records[stack[-1]]
        assert q.expression is not None
        missing = [n for n in dict.fromkeys(names_in(q.expression)) if n in records and n not in placed]
        if missing and q.name not in placed:
            stack += reversed(missing)
        else:
            placed.setdefault(q.name, q)
            stack.pop()
    return list(placed.values())


class _Parts:
    """Names for nodes that split formulas that are too long or too deep.

    Parameters
    ----------
    program : Program
    leaves : mapping
        Node -> name of what has one.
    words : collection of str
        Names that parts must not have.
    """

    def __init__(self, program: Program, leaves: Mapping[int, str], words: Collection[str] = ()) -> None:
        self.nodes, self.leaves = program.nodes, dict(leaves)
        self.names = (name for name in (f"u_{number}" for number in count(1)) if name not in words)
        self.named: dict[int, str] = {}

    def of(self, roots: Iterable[int]) -> dict[int, str]:
        """Names of the parts of formulas, by node; formulas share them."""
        for root in dict.fromkeys(sorted(roots)):
            self._shorten(root)
        return self.named

    def fits(self, root: int) -> bool:
        """True if a formula needs no split."""
        return self._measured(root).fits

    def _shorten(self, root: int) -> None:
        while not (formula := self._measured(root)).fits:
            part = self._best(root, formula)
            if part is None:
                return
            self.named[part] = self.leaves[part] = next(self.names)
            self._shorten(part)

    def _measured(self, root: int) -> _Formula:
        """Measure the formula of a node down to what has a name."""
        inner, stack, seen = list[int](), [root], {root}
        while stack:
            node = stack.pop()
            inner.append(node)
            for a in self.nodes[node].args:
                if a not in seen and a not in self.leaves and self.nodes[a].args:
                    seen.add(a)
                    stack.append(a)
        inner.sort()
        sizes: dict[int, int] = {}
        depths: dict[int, int] = {}
        for node in inner:
            sizes[node] = sum(sizes.get(a, 1) for a in self.nodes[node].args)
            depths[node] = 1 + max((depths.get(a, 0) for a in self.nodes[node].args), default=0)
        times = dict.fromkeys(inner, 0)
        times[root] = 1
        for node in reversed(inner):
            for a in self.nodes[node].args:
                if a in times:
                    times[a] += times[node]
        return _Formula(inner, sizes, depths, times, sizes[root] <= LONGEST and depths[root] <= DEEPEST)

    def _best(self, root: int, formula: _Formula) -> int | None:
        """Return the part that makes a formula shorter and is most worth a name."""
        inner, sizes, depths = formula.inner, formula.sizes, formula.depths
        if sizes[root] <= LONGEST:
            return max((k for k in inner if depths[k] <= DEEPEST), key=lambda k: (depths[k], -k))
        shorter = [k for k in inner if SHORTEST <= sizes[k] < sizes[root]]
        # A condition is a number only where nothing else makes its formula shorter.
        offered = [k for k in shorter if not self._is_condition(k)] or shorter
        if not offered:
            return None
        repeated = [k for k in offered if formula.times[k] > 1 and sizes[k] <= LONGEST]
        if repeated:
            return max(repeated, key=lambda k: ((formula.times[k] - 1) * sizes[k], -k))
        half = max(12, sizes[root] // 2)
        small = [k for k in offered if sizes[k] <= half]
        return max(small or offered, key=lambda k: (sizes[k] if small else -sizes[k], -k))

    def _is_condition(self, node: int) -> bool:
        return self.nodes[node].op in COMPARISONS


@dataclass(frozen=True)
class _Formula:
    """Nodes of a formula in order; by node how much stands in it, how deep it is, and how often it stands there."""

    inner: list[int]
    sizes: dict[int, int]
    depths: dict[int, int]
    times: dict[int, int]
    fits: bool


class _Reader:
    """Trees of nodes, with names in place of what has one.

    Parameters
    ----------
    program : Program
    leaves : mapping
        Node -> name.
    turned : mapping, optional
        Node -> name of what is its negative.
    """

    def __init__(self, program: Program, leaves: Mapping[int, str], turned: Mapping[int, str] | None = None) -> None:
        self.nodes, self.leaves, self.turned = program.nodes, leaves, turned or {}
        self._known: dict[int, Expression] = {}

    def tree(self, node: int) -> Expression:
        """Return the tree of a node, or its name."""
        return self._named(node) or self.written_out(node)

    def _named(self, node: int) -> Expression | None:
        if node in self.leaves:
            return ["q", self.leaves[node]]
        return ["neg", ["q", self.turned[node]]] if node in self.turned else None

    def written_out(self, node: int) -> Expression:
        """Expression of a node in its operands; an input stands for itself."""
        if node not in self._known:
            # Each before its readers, so that depth is no matter.
            stack = [node]
            while stack:
                k = stack[-1]
                missing = [a for a in self.nodes[k].args if a not in self._known and not self._stands_for(k, a)]
                if missing:
                    stack += missing
                    continue
                self._known[k] = self._made(k, [self._stands_for(k, a) or self._known[a] for a in self.nodes[k].args])
                stack.pop()
        return self._known[node]

    def _stands_for(self, reader: int, node: int) -> Expression | None:
        """Name of an argument; none where it is the negative of the quantity that reads it."""
        negated = self.turned.get(node)
        return None if negated is not None and self.leaves.get(reader) == negated else self._named(node)

    def _made(self, k: int, a: list[Expression]) -> Expression:
        node: Node = self.nodes[k]
        op = node.op
        if op == ca.OP_CONST:
            return ["n", float(node.constant)]
        if op == ca.OP_INPUT:
            return ["q", self.leaves[k]]
        if op == ca.OP_ADD:
            return simplified_sum([(a[0], 1), (a[1], 1)])
        if op == ca.OP_SUB:
            return simplified_sum([(a[0], 1), (a[1], -1)])
        if op == ca.OP_NEG:
            return a[0][1] if a[0][0] == "neg" else ["n", -a[0][1]] if a[0][0] == "n" else ["neg", a[0]]
        return _PRODUCTS[op](a) if op in _PRODUCTS else self._other(op, a)

    def _other(self, op: int, a: list[Expression]) -> Expression:
        if op in (ca.OP_POW, ca.OP_CONSTPOW):
            return ["^", a[0], a[1]]
        if op == OP_SELECT:
            return ["if", *a]
        if op == ca.OP_IF_ELSE_ZERO:
            return ["if", a[0], a[1], ["n", 0.0]]
        if op in COMPARISONS:
            return [OPERATIONS[op].text, *a]
        if op in (ca.OP_FMIN, ca.OP_FMAX):
            name, several = OPERATIONS[op].text, list[Expression]()
            for x in a:
                several += x[2] if x[0] == "f" and x[1] == name else [x]
            return ["f", name, several]
        return ["f", OPERATIONS[op].text, a]


_PRODUCTS = {
    ca.OP_MUL: lambda a: simplified_product(a, []),
    ca.OP_DIV: lambda a: simplified_product([a[0]], [a[1]]),
    ca.OP_INV: lambda a: simplified_product([ONE], [a[0]]),
    ca.OP_TWICE: lambda a: simplified_product([["n", 2.0], a[0]], []),
    ca.OP_SQ: lambda a: ["^", a[0], ["n", 2.0]] if a[0][0] in ("+", "neg") else simplified_product([a[0], a[0]], []),
}
