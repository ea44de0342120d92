"""A declaration traced into one program, from which everything else is read."""

from __future__ import annotations

import difflib
from collections.abc import Callable, Hashable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import casadi as ca
import numpy as np

from synth.declaration import Declaration, DeclarationError, Origin, Part, Refusal
from synth.errors import InputError
from synth.model.constraint import SYMBOLS, Constraint
from synth.model.limit_terms import NEAR_ZERO, LimitTerms
from synth.model.next_rows import next_row
from synth.model.numbers import numeric
from synth.model.program import InputValue, Program, UnsupportedOperation
from synth.order.feasibility import holds, residual
from synth.results.next_row import NextRow
from synth.special import SpecialCall, expanded
from synth.system.interrupts import held_back
from synth.units import typed_quantity

MOST_FUNCTIONS = 512  # that a model keeps


@dataclass(frozen=True)
class DataInput:
    """One input of the program that is fixed by the combination or the requirements."""

    kind: str  # requirement, row, count, choice, part
    name: str  # requirement, count, choice, slot or row
    columns: tuple[str, ...]  # of part and row: the columns, first one given counts
    required: bool
    sx: Any

    @property
    def column(self) -> str:
        """Return the key of the column in its part or row; empty for what is no column."""
        return "|".join(self.columns)

    @property
    def key(self) -> tuple[str, str, str]:
        """Key that identifies it among all inputs."""
        return self.kind, self.name, self.column

    @property
    def label(self) -> str:
        """Return a readable name, ``slot.column`` for parts."""
        return f"{self.name}.{self.column}" if self.columns else self.name


@dataclass(frozen=True)
class Evaluation:
    """What the program says for a batch of designs; every value is an array over the batch, in SI."""

    values: dict[str, np.ndarray]
    limits: dict[str, tuple[np.ndarray, np.ndarray]]
    residuals: dict[str, np.ndarray]
    holds: dict[str, np.ndarray]
    void: dict[str, np.ndarray]
    advice: dict[int, np.ndarray]
    feasible: np.ndarray
    scales: dict[str, np.ndarray | float]  # per limit: smallest size that counts
    terms: dict[str, np.ndarray]  # per quantity: the size of its largest term, where its value does not tell it

    def also(self, constraints: Sequence[Constraint]) -> Evaluation:
        """Model with further limits on quantities, which count as those of the family do.

        Where the guards do not hold without which a quantity does not exist, they alone tell why.
        """
        if not constraints:
            return self
        limits, residuals, held, void = dict(self.limits), dict(self.residuals), dict(self.holds), dict(self.void)
        feasible, scales = self.feasible.copy(), dict(self.scales)
        for x in constraints:
            value = self.values[x.quantity]
            limits[x.name] = value, np.full(value.shape, float(x.bound))
            scales[x.name] = x.scale if x.terms is None else np.fmin(self.terms[x.quantity], x.most_terms)
            with np.errstate(all="ignore"):
                residuals[x.name] = residual(value, float(x.bound), x.sense, scales[x.name])
            kept = holds(residuals[x.name], x.guard)
            for guard in x.behind:
                kept = kept | ~self.holds[guard]
            held[x.name], void[x.name] = kept, np.zeros(kept.shape, dtype=bool)
            feasible &= kept
        return replace(
            self, limits=limits, residuals=residuals, holds=held, void=void, feasible=feasible, scales=scales
        )

    def take(self, rows: slice) -> Evaluation:
        """Note restricted to some of the designs."""
        return Evaluation(
            {name: x[rows] for name, x in self.values.items()},
            {name: (value[rows], bound[rows]) for name, (value, bound) in self.limits.items()},
            {name: x[rows] for name, x in self.residuals.items()},
            {name: x[rows] for name, x in self.holds.items()},
            {name: x[rows] for name, x in self.void.items()},
            {k: x[rows] for k, x in self.advice.items()},
            self.feasible[rows],
            {name: x[rows] if isinstance(x, np.ndarray) else x for name, x in self.scales.items()},
            {name: x[rows] for name, x in self.terms.items()},
        )


class Model:
    """One traced problem: its symbols, its program and the evaluators made from it.

    Parameters
    ----------
    title : str
        Name of the problem, for messages.
    declaration : Declaration
        What the family declared.
    calls : list of SpecialCall
        Special functions that were used.
    where_declared : callable
        Says of a name that is not declared here with what it is; nothing where it is with nothing.
    """

    def __init__(
        self,
        title: str,
        declaration: Declaration,
        calls: Sequence[SpecialCall] = (),
        where_declared: Callable[[str], str] = lambda _: "",
    ) -> None:
        declaration.finish()
        declaration.settle_columns(calls)
        self.title = title
        self.declaration = declaration
        self.calls = list(calls)
        self._where_declared = where_declared
        self.variables = list(declaration.variables.values())
        self.limits = list(declaration.limits.values())
        requirements = declaration.requirements.values()
        self.requirement_symbols = {r.name: str(r.sx) for r in requirements if r.sx is not None}
        self.data_inputs = self._data_inputs(declaration)
        self.inputs = [v.sx for v in self.variables] + [i.sx for i in self.data_inputs]
        keys = [("variable", v.name, "") for v in self.variables] + [i.key for i in self.data_inputs]
        self.input_number = {key: number for number, key in enumerate(keys)}
        self.units = {name: unit for name, unit, _ in declaration.quantities()}
        self._check_expressions()
        named: dict[str, Any] = {v.name: v.sx for v in self.variables}
        named |= {c.name: c.sx for c in declaration.counts.values()}
        named |= {q.name: q.sx for q in declaration.derived.values()}
        self.quantity_sx = named
        outputs = list(named.values())
        outputs += [side for limit in self.limits for side in (limit.value, limit.limit)]
        outputs += [a.when for a in declaration.advices]
        self.program = Program(self.inputs, outputs, calls)
        self.traced = len(self.program.nodes)  # of formulas; what follows tells sizes, or where a value is lacking
        numbers = iter(self.program.outputs)
        self.quantity_node = {name: next(numbers) for name in named}
        sides = {limit.name: (next(numbers), next(numbers)) for limit in self.limits}
        self.advice_nodes = [next(numbers) for _ in declaration.advices]
        self._terms = LimitTerms(self.program, len(self.variables), *self.zeros())
        # A guard holds strictly: it has no tolerance, and so no size.
        sized = {x.name: None if x.guard else self._terms.of(sides[x.name], x.scale) for x in self.limits}
        self._evaluate = self.program.compile([*self.program.outputs, *(k for k in sized.values() if k is not None)])
        self._terms_of: dict[str, int | None] = {}  # of quantities that somebody limits
        self.refusal_kinds = [self._refusal_inputs(r.code, r.when) for r in declaration.refusals]
        self._function_cache: dict[Any, Any] = {}
        self._null_values, behind = self._behind_guards(sides)
        void = self._void_inputs(sides)
        self.constraints = tuple(
            Constraint(
                name=x.name,
                sense=x.sense,
                value=self._value_unless_void(*sides[x.name], void[x.name]),
                bound=sides[x.name][1],
                unit=x.unit,
                scale=x.scale,
                terms=sized[x.name],
                guard=x.guard,
                origin=x.origin,
                void_without=tuple(void[x.name]),
                behind=tuple(behind[x.name]),
            )
            for x in self.limits
        )

    # -- the trace -----------------------------------------------------------------------------

    def steps(self, variables: np.ndarray, data: Sequence[InputValue]) -> list[dict[str, float]]:
        """Return the unreported quantities of a batch of designs by name, in SI, for hooks to read.

        Like reported ones they are not-a-number where a guard fails without which they do not exist.

        Parameters
        ----------
        variables : array (batch, variables)
            SI values in the declared order.
        data : list of numbers or arrays (batch,)
            One entry per data input.
        """
        return self._unsearched("steps", self.declaration.steps, variables, data)

    def next_rows(self, variables: np.ndarray, data: Sequence[InputValue]) -> list[dict[str, NextRow]]:
        """Return, per design of a batch, the rows of tables that are next to its quantities, by name.

        Where a guard fails without which the quantity does not exist, there is none. Parameters as of ``steps``.
        """
        declared, catalogs = self.declaration.next_rows, self.declaration.catalogs
        needed = self._unsearched("next rows", declared, variables, data)
        return [{n: next_row(declared[n], x, catalogs) for n, x in each.items() if not np.isnan(x)} for each in needed]

    def _unsearched(
        self, what: str, named: Mapping[str, Any], variables: np.ndarray, data: Sequence[InputValue]
    ) -> list[dict[str, float]]:
        """Function for what only results and hooks read, as a program of its own: the search does not carry it."""
        if not named:
            return [{} for _ in variables]
        expressions = [record.sx for record in named.values()]
        compiled = self.function(what, lambda: Program(self.inputs, expressions, self.calls).compile())
        arguments = [np.atleast_1d(np.asarray(x, dtype=float)) for x in (*np.asarray(variables, dtype=float).T, *data)]
        with np.errstate(all="ignore"):
            results = compiled(arguments)
        columns = [np.broadcast_to(np.ravel(x), len(variables)) for x in results]
        behind = self.function(f"guards of {what}", lambda: self._guards_of(expressions))
        held = self.evaluate(np.asarray(variables, dtype=float), data).holds if any(behind) else {}
        for k, guards in enumerate(behind):
            for guard in guards:
                columns[k] = np.where(held[guard], columns[k], np.nan)
        return [dict(zip(named, row, strict=True)) for row in zip(*(x.tolist() for x in columns), strict=True)]

    def _guards_of(self, steps: Sequence[Any]) -> list[list[str]]:
        """Return, per expression, the guards without which it does not exist: those of what it is computed from."""
        needs = [(q.sx, guard) for q in self.declaration.derived.values() for guard in q.needs]
        program = Program(self.inputs, [*steps, *(sx for sx, _ in needs)], self.calls)
        step_nodes, needing = program.outputs[: len(steps)], program.outputs[len(steps) :]
        behind: list[list[str]] = [[] for _ in steps]
        for guard in sorted({name for _, name in needs}):
            marked = program.downstream(node for node, (_, name) in zip(needing, needs, strict=True) if name == guard)
            for k, node in enumerate(step_nodes):
                if marked[node]:
                    behind[k].append(guard)
        return behind

    def _data_inputs(self, d: Declaration) -> list[DataInput]:
        inputs = [DataInput("requirement", r.name, (), True, r.sx) for r in d.requirements.values() if r.sx is not None]

        def columns(kind: str, part: Part) -> list[DataInput]:
            return [DataInput(kind, part.slot, c.columns, c.required, c.sx) for c in part.columns.values()]

        for row in d.rows.values():
            inputs += columns("row", row)
        inputs += [DataInput("count", c.name, (), True, c.sx) for c in d.counts.values()]
        inputs += [DataInput("choice", c.name, (), True, c.sx) for c in d.choices.values()]
        for slot in d.slots.values():
            inputs += columns("part", slot)
        return inputs

    def zeros(self) -> tuple[dict[int, float], frozenset[int]]:
        """Inputs that can be zero, with the size below which they count as equally large, and those never negative."""
        near_zero, not_negative = dict[int, float](), set[int]()
        for k, v in enumerate(self.variables):
            if v.lower <= 0.0 <= v.upper:
                near_zero[k] = NEAR_ZERO * max(-v.lower, v.upper)
            if v.lower >= 0.0:
                not_negative.add(k)
        for k, entry in enumerate(self.data_inputs, start=len(self.variables)):
            if self._least(entry) >= 0.0:
                not_negative.add(k)
        return near_zero, frozenset(not_negative)

    def _least(self, entry: DataInput) -> float:
        """Least value that a data input can have, as far as the declaration tells."""
        d = self.declaration
        if entry.kind == "requirement":
            return d.requirements[entry.name].lower
        if entry.kind == "count":
            return float(d.counts[entry.name].values.min())
        if entry.kind == "choice":
            return 0.0
        part = d.rows[entry.name] if entry.kind == "row" else d.slots[entry.name]
        table = d.catalogs.table(part.table)
        values = [table.number(c) for c in entry.columns if table.has(c)]
        return min((float(np.nanmin(x)) for x in values if not np.isnan(x).all()), default=0.0)

    def terms_of(self, quantity: str) -> int | None:
        """Node of the largest term of a quantity, where its value does not tell it; made when it is first limited."""
        if quantity not in self._terms_of:
            self._terms_of[quantity] = self._terms.of([self.quantity_node[quantity]])
        return self._terms_of[quantity]

    def _check_expressions(self) -> None:
        """Refuse expressions that hold symbols from elsewhere, numbers that are none or operations without a form."""
        d = self.declaration
        # The first that is wrong is told: what others are computed from stands before them.
        defaults = [r for r in d.requirements.values() if isinstance(r.default, ca.SX)]
        named = [(f"the default of requirement {r.name}", r.default) for r in defaults]
        # What a special function is made of comes into formulas later, when it is written out for solvers.
        named += [(f"special function {c.function.name}", ca.SX(c.function.formula(*c.arguments))) for c in self.calls]
        named += [(f"derived {q.name}", q.sx) for q in d.derived.values()]
        named += [(f"step {s.name}", s.sx) for s in d.steps.values()]
        named += [(f"limit {x.name}", e) for x in self.limits for e in (x.value, x.limit)]
        named += [(f"next row {r.name}", r.sx) for r in d.next_rows.values()]
        named += [(f"refusal {r.code}", r.when) for r in d.refusals]
        named += [(f"advice {a.code}", a.when) for a in d.advices]
        named += [(f"the range of variable {v.name}", end) for v in self.variables for end in v.within or ()]
        known = {str(s) for s in self.inputs} | {str(c.symbol) for c in self.calls}
        for label, expression in named:
            strange = sorted({str(s) for s in ca.symvar(expression)} - known)
            if strange:
                raise self._fault(label, f"uses {strange}, which the declaration does not make")
        try:
            program = Program(self.inputs, [expression for _, expression in named], self.calls)
        except UnsupportedOperation:
            for label, expression in named:
                try:
                    Program(self.inputs, [expression], self.calls)
                except UnsupportedOperation as error:
                    raise self._fault(label, f"cannot be computed: {error}") from error
            raise
        held = [k for k, node in enumerate(program.nodes) if node.op == ca.OP_CONST and not np.isfinite(node.constant)]
        if held:
            marked = program.downstream(held)
            label, output = next((x, n) for (x, _), n in zip(named, program.outputs, strict=True) if marked[n])
            number = next(program.nodes[k].constant for k in program.needed([output]) if k in held)
            raise self._fault(label, f"holds {number}; formulas take finite numbers alone")

    def _fault(self, label: str, fault: str) -> DeclarationError:
        return DeclarationError(f"{self.title}: {label} {fault}", self.declaration.lines.get(label))

    def _void_inputs(self, sides: Mapping[str, tuple[int, int]]) -> dict[str, list[int]]:
        """Return, per limit, the optional data inputs that make it void where they have no value.

        What a user limits must have a value: such a limit is missed where there is none.
        """
        first = len(self.variables)
        optional = [first + k for k, i in enumerate(self.data_inputs) if not i.required]
        result: dict[str, list[int]] = {limit.name: [] for limit in self.limits}
        for k in optional:
            marked = self.program.dependence([k])
            for limit in self.limits:
                if limit.origin not in (Origin.USER, Origin.PIN) and any(marked[n] for n in sides[limit.name]):
                    result[limit.name].append(k - first)
        return result

    def _value_unless_void(self, value: int, bound: int, void: Sequence[int]) -> int:
        """Node of the value of a limit, not-a-number where data inputs without a value make the limit void.

        Bounds know by that alone that it says nothing there.
        """
        program, inputs = self.program, [len(self.variables) + k for k in void]
        node = program.empty_without([k for k in inputs if not program.lost_without(k)[bound]], value)
        if node != value:
            program.outputs.append(node)
        return node

    def _refusal_inputs(self, code: str, when: ca.SX) -> frozenset[str]:
        """Return the discrete unknowns (slots, counts, choices) that a refusal speaks of."""
        used = {str(s) for s in ca.symvar(expanded(when, self.calls))}
        if used & {str(v.sx) for v in self.variables}:
            raise DeclarationError(f"{self.title}: refusal {code} speaks of a continuous variable; that is a limit")
        return frozenset(
            i.name for i in self.data_inputs if i.kind in ("count", "choice", "part") and str(i.sx) in used
        )

    def _behind_guards(self, sides: Mapping[str, tuple[int, int]]) -> tuple[dict[str, list[str]], dict[str, list[str]]]:
        """Return, per quantity and per limit, the guards without which it does not exist."""
        values: dict[str, list[str]] = {name: [] for name in self.quantity_node}
        limits: dict[str, list[str]] = {limit.name: [] for limit in self.limits}
        needs = [(q.name, g) for q in self.declaration.derived.values() for g in q.needs]
        for guard in sorted({g for _, g in needs}):
            marked = self.program.downstream(self.quantity_node[name] for name, g in needs if g == guard)
            for name, node in self.quantity_node.items():
                if marked[node]:
                    values[name].append(guard)
            for name, nodes in sides.items():
                if name != guard and any(marked[n] for n in nodes):
                    limits[name].append(guard)
        return values, limits

    def guards_of(self, name: str) -> tuple[str, ...]:
        """Return the guards without which a quantity does not exist."""
        return tuple(self._null_values[name])

    def constraint_on(
        self, quantity: str, sense: str, bound: float, name: str = "", origin: Origin = Origin.USER
    ) -> Constraint:
        """Return the limit of a user on a named quantity.

        Parameters
        ----------
        quantity : str
            Its public name.
        sense : {"at_most", "at_least", "equal"}
        bound : float
            SI.
        name : str
            As reports call it; by default what a user would type.
        origin : Origin
        """
        unit = self.units[quantity]
        return Constraint(
            name=name or f"{quantity} {SYMBOLS[sense]} {typed_quantity(bound, unit, None)}",
            sense=sense,
            value=self.quantity_node[quantity],
            bound=float(bound),
            unit=unit,
            terms=self.terms_of(quantity),
            origin=origin,
            quantity=quantity,
            behind=self.guards_of(quantity),
        )

    # -- names ---------------------------------------------------------------------------------

    def name_of(
        self, word: str, field: str, among: Sequence[str], what: str, path: tuple[str, ...] | None = None
    ) -> str:
        """Return the public name for a name or symbol; refuse with the closest spellings otherwise.

        ``path`` is where the word stands, by default a key under the field.
        """
        path = (field, word) if path is None else path
        spellings = self.declaration.names()
        name = spellings.get(word)
        if name in among:
            return str(name)
        if name is not None:
            raise InputError(field, word, f"{what}; {name} is {self.kind_of(name)}", path)
        allowed = [s for s, n in spellings.items() if n in among]
        close = difflib.get_close_matches(word, allowed, n=3, cutoff=0.6)
        hint = f" (did you mean {' or '.join(close)}?)" if close else ""
        right = f"{what} of {self.title}{hint}; {self._where_declared(word) or 'its description lists them'}"
        raise InputError(field, word, right, path)

    def by_name(self, mapping: Mapping[Any, Any], field: str, among: Sequence[str], what: str) -> dict[str, Any]:
        """Return a mapping of names or symbols by public name; each may be given once."""
        result: dict[str, Any] = {}
        for word, value in mapping.items():
            name = self.name_of(str(word), field, among, what)
            if name in result:
                right = "each name once (name and symbol mean the same)"
                raise InputError(f"{field}: {name}", str(word), right, (field, str(word)))
            result[name] = value
        return result

    def kind_of(self, name: str) -> str:
        """Kind of a declared name, with its article."""
        d = self.declaration
        kinds: dict[str, Mapping[str, Any]] = {
            "a requirement": d.requirements,
            "an option": d.options,
            "a variable": d.variables,
            "a count": d.counts,
            "a choice": d.choices,
            "a slot": d.slots,
            "a derived quantity": d.derived,
        }
        return next(kind for kind, members in kinds.items() if name in members)

    # -- numbers -------------------------------------------------------------------------------

    def evaluate(self, variables: np.ndarray, data: Sequence[InputValue]) -> Evaluation:
        """Evaluate a batch of designs: quantities and the limits of the family (``Instance.evaluate`` has all).

        Parameters
        ----------
        variables : array (batch, variables)
            SI values in the declared order.
        data : list of numbers or arrays (batch,)
            One entry per data input.

        Returns
        -------
        Evaluation
        """
        count = len(variables)
        with np.errstate(all="ignore"):
            raw = self._evaluate([variables[:, k] for k in range(len(self.variables))] + list(data))
            numbers = iter([_column(x, count) for x in raw])
            values = {name: next(numbers) for name in self.quantity_node}
            limits = {limit.name: (next(numbers), next(numbers)) for limit in self.limits}
            advice = {k: next(numbers) > 0.5 for k in range(len(self.advice_nodes))}
            scales: dict[str, np.ndarray | float] = {
                x.name: x.scale if x.terms is None else next(numbers) for x in self.constraints
            }
            residuals = {x.name: residual(*limits[x.name], x.sense, scales[x.name]) for x in self.constraints}
            held = {x.name: holds(residuals[x.name], x.guard) for x in self.constraints}
            void = {x.name: x.void(data, (count,)) for x in self.constraints}
            for name, guards in self._null_values.items():
                for guard in guards:
                    values[name] = np.where(held[guard], values[name], np.nan)
            feasible = np.ones(count, dtype=bool)
            for limit in self.constraints:
                name = limit.name
                for guard in limit.behind:
                    residuals[name] = np.where(held[guard], residuals[name], np.nan)
                    held[name] = held[name] | ~held[guard]  # the guard alone tells why
                residuals[name] = np.where(void[name], np.nan, residuals[name])
                held[name] = held[name] | void[name]
                feasible &= held[name]
            terms = self._terms_at(variables, data)
        return Evaluation(values, limits, residuals, held, void, advice, feasible, scales, terms)

    def _terms_at(self, variables: np.ndarray, data: Sequence[InputValue]) -> dict[str, np.ndarray]:
        """Size of the largest term of each quantity that somebody limits, where its value does not tell it."""
        nodes = {name: k for name, k in self._terms_of.items() if k is not None}
        if not nodes:
            return {}
        term_nodes = tuple(nodes.values())
        compiled = self.function(("terms", term_nodes), lambda: self.program.compile(term_nodes))
        sizes = compiled([*np.asarray(variables, dtype=float).T, *data])
        return {name: _column(x, len(variables)) for name, x in zip(nodes, sizes, strict=True)}

    def number(self, expression: ca.SX, values: Mapping[str, float]) -> float:
        """Return the value of an expression of the declaration that no variable is in.

        What evaluates it is built once per model, not once per question.

        Parameters
        ----------
        expression : symbol or expression
        values : mapping
            Symbol -> SI value.
        """
        function, names = self.numeric(expression)
        return float(function.call([values[name] for name in names])[0])

    def numeric(self, expression: ca.SX) -> tuple[Any, list[str]]:
        """Return the function that evaluates an expression of the declaration, and the names of its arguments."""
        made: tuple[Any, list[str]] = self.function(
            ("number", id(expression)), lambda: numeric(expanded(expression, self.calls))
        )
        return made

    def refused(self, refusal: Refusal) -> Any:
        """Return the function that evaluates a refusal for batches of inputs."""
        return self.function(
            ("refusal", id(refusal)), lambda: Program(self.inputs, [refusal.when], self.calls).compile()
        )

    def function(self, key: Hashable, make: Callable[[], Any]) -> Any:
        """Return an object that is built once per model, for example a CasADi function or a solver.

        A model may serve a process for long, asked for ever other limits: what was not used for longest is given up.
        """
        missing = object()
        built = self._function_cache.pop(key, missing)
        if built is not missing:
            self._function_cache[key] = built
            return built
        with held_back():
            built = make()
            while len(self._function_cache) >= MOST_FUNCTIONS:
                self._function_cache.pop(next(iter(self._function_cache)), None)
            self._function_cache[key] = built
        return built


def _column(x: InputValue, count: int) -> np.ndarray:
    """Return an output as an array over the batch."""
    if isinstance(x, np.ndarray) and x.shape == (count,) and x.dtype == float:
        return x
    return np.broadcast_to(np.asarray(x, dtype=float), (count,))
