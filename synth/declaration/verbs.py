"""What a design problem declares: the verbs of ``DesignProblem.declare`` and the records they leave."""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from numbers import Real
from typing import TYPE_CHECKING, Any, ClassVar, Generic, Self, TypeVar, overload

import casadi as ca
import numpy as np

from synth.declaration.faults import SourceLine, line_of_verb
from synth.declaration.grids import grid_values
from synth.declaration.records import (
    Advice,
    Choice,
    Constant,
    Count,
    Derived,
    Headline,
    Limit,
    NextRowRecord,
    Objective,
    OptionRecord,
    Part,
    Quantity,
    Refusal,
    RequirementRecord,
    RowRange,
    Step,
    VariableRecord,
)
from synth.errors import DeclarationError, InputError, UnknownOptionError, shortened
from synth.order.feasibility import SMALLEST
from synth.order.margins import MARGINS
from synth.units import Unit, parse_unit, to_si

if TYPE_CHECKING:
    from synth.special import SpecialCall
    from synth.tables.catalogs import Catalogs

# Formulas are plain NumPy functions; in this mode NumPy calls on symbols return plain symbols.
ca.GlobalOptions.setNumpyMode(-1)


SWITCHED = {"yes": "on", "no": "off"}  # YAML does not tell a bare on from yes


def labels_meant(word: object, labels: Sequence[str]) -> Sequence[str]:
    """Labels that a word may mean: itself, else the same but for case, else all that begin with it."""
    if not isinstance(word, str) or not word or word in labels:
        return [x for x in labels if x == word]
    folded = word.casefold()
    same = [x for x in labels if x.casefold() == folded]
    return same or [x for x in labels if x.casefold().startswith(folded)]


Declared = TypeVar("Declared")  # what the attribute of a block is


class BlockField(ABC, Generic[Declared]):
    """What may stand in a :class:`Block`: it declares itself under the name of the attribute.

    ``default`` counts where the user states nothing; it may be a function of the block for a value that follows from
    other fields.
    """

    default: Any

    @abstractmethod
    def declared(self, block: Block, name: str, default: Any, group: str) -> Declared:
        """Declare the field under a name; return what the attribute of the block is.

        ``group`` is that of the block, for a requirement or option that names none.
        """

    @overload
    def __get__(self, block: None, kind: type[Block]) -> Self: ...
    @overload
    def __get__(self, block: Block, kind: type[Block]) -> Declared: ...
    def __get__(self, block: Block | None, kind: type[Block]) -> Any:
        """The field itself on access through the class; of a block what it stands for, declared now."""
        if block is None:
            return self
        return block._declare(next(name for name, field in block.fields().items() if field is self))


@dataclass(frozen=True)
class Requirement(BlockField[Quantity]):
    """A requirement as field of a :class:`Block`; see :meth:`Declaration.requirement`.

    ``default`` may be a function that takes the block and returns the default from other fields, or None; ``optional``
    one that tells from what is given whether the requirement is in force only where it is stated; ``source`` one that
    returns where the default is from.
    """

    unit: str
    default: Any = None
    lower: float | None = None
    upper: float | None = None
    optional: bool | Callable[[Any], bool] = False
    symbol: str | None = None
    text: str = ""
    source: str | Callable[[Any], str] = ""
    group: str = ""
    follows: bool = False
    instead: tuple[str, ...] = ()

    def declared(self, block: Block, name: str, default: Quantity | float | str | None, group: str) -> Quantity:
        """Declare the requirement; return its symbol, or None for an optional one that is not given."""
        optional = self.optional(block) if callable(self.optional) else self.optional
        source = self.source(block) if callable(self.source) else self.source
        record = {**vars(self), "default": default, "optional": optional, "source": source}
        record["group"] = self.group or group
        return block.declaration.requirement(name, **record)


@dataclass(frozen=True)
class Option(BlockField[str]):
    """An option as field of a :class:`Block`, whose attribute is the word chosen; see :meth:`Declaration.option`.

    The choices are words, or the designations of a ``table``, or a function that takes the declaration and returns
    words that decide numbers alone.
    """

    choices: tuple[str, ...] | Callable[[Declaration], tuple[str, ...]] = ()
    default: str | Callable[[Any], str] = ""
    table: str = ""
    symbol: str | None = None
    text: str = ""
    source: str = ""
    group: str = ""

    def declared(self, block: Block, name: str, default: str, group: str) -> str:
        """Declare the option; return the chosen word."""
        d = block.declaration
        words = self.choices(d) if callable(self.choices) else self.choices
        choices = d.designations(self.table) if self.table else words
        return d.option(
            name, choices, default, self.symbol, self.text, self.source, self.group or group, not callable(self.choices)
        )


@dataclass(frozen=True)
class Variable(BlockField[Quantity]):
    """A variable as field of a :class:`Block`; see :meth:`Declaration.variable`."""

    unit: str
    lower: float
    upper: float
    grid: float | str | Sequence[float] | None = None
    symbol: str | None = None
    text: str = ""
    source: str = ""

    default = None

    def declared(self, block: Block, name: str, default: Any, group: str) -> Quantity:
        """Declare the variable; return its symbol. What the search decides belongs to no group.

        It has no default; what a use of the block states for it is the range ``within`` which it is searched.
        """
        d, bounds = block.declaration, (self.lower, self.upper)
        if default is not None and not isinstance(default, tuple):
            raise DeclarationError(f"{d.problem}: variable {name} has no default, it is what the search decides")
        return d.variable(name, self.unit, *bounds, self.grid, self.symbol, self.text, self.source, default)


@dataclass(frozen=True)
class Slot(BlockField[Part]):
    """A slot as field of a :class:`Block`; see :meth:`Declaration.part`."""

    table: str
    where: str | tuple[str, ...] = ()
    symbol: str | None = None
    text: str = ""
    source: str = ""

    default = None

    def declared(self, block: Block, name: str, default: Quantity | float | str | None, group: str) -> Part:
        """Declare the slot; return the part whose columns are symbols. What the search decides has no group."""
        d = block.declaration
        if default is not None:
            raise DeclarationError(f"{d.problem}: slot {name} has no default, it is what the search decides")
        return d.part(name, self.table, self.where, self.symbol, self.text, self.source)


class Block:
    """Quantities that are declared together, each once: its attribute is its field and its public name.

    ``d.block(Duty)`` declares the fields in the order of the class body, those of base classes first, but before all
    those that the attribute ``leading`` of a class names, and returns the block, whose attributes are then the symbols.
    A default may be made of any other field, which is declared before: of two words that follow from each other each
    has the other in its default, where it ``specifies`` that one. Properties may say what follows from them. The
    attribute ``group`` of a class is the group under which its own requirements and options are listed, where they
    name none.

    Parameters
    ----------
    d : Declaration
        Takes the declarations.
    defaults : mapping
        Defaults that this use of the block decides, by field.

    Raises
    ------
    DeclarationError
        When a default is meant for a field that the block does not have.

    Examples
    --------
    >>> class Duty(Block):
    ...     torque = Requirement("N*m", lower=0.1, upper=1e6, symbol="M", text="Torque to transmit")
    ...     peak_torque = Requirement("N*m", lambda duty: 2 * duty.torque, upper=1e7, text="Shock")
    >>> from synth.tables.catalogs import Catalogs
    >>> d = Declaration("shaft", {}, frozenset(), Catalogs())
    >>> duty = d.block(Duty)
    >>> duty.torque, d.requirements["peak_torque"].default
    (SX(torque), SX((2.*torque)))
    """

    group: ClassVar[str] = ""
    leading: ClassVar[tuple[str, ...]] = ()
    declaration: Declaration
    _waiting: dict[str, Any]

    def __init__(self, d: Declaration, defaults: Mapping[str, Any]) -> None:
        fields = self.fields()
        for name in defaults:
            if name not in fields:
                raise DeclarationError(f"{d.problem}: block {type(self).__name__} has no field {name!r}")
        self.__dict__.update(declaration=d, _waiting={n: defaults.get(n, f.default) for n, f in fields.items()})
        for name in fields:
            if name not in self.__dict__:
                self._declare(name)

    def _declare(self, name: str) -> Any:
        """Declare a field, and before it those that its default is made of."""
        d, waiting = self.declaration, self._waiting
        if name not in waiting:
            raise DeclarationError(f"{d.problem}: the default of {name} is made of itself")
        default = waiting.pop(name)
        if callable(default):
            default = default(self)
        group = next(getattr(base, "group", "") for base in type(self).__mro__ if name in vars(base))
        self.__dict__[name] = self.fields()[name].declared(self, name, default, group)
        return self.__dict__[name]

    def specifies(self, *names: str) -> bool:
        """Whether the user states one of the requirements of these names."""
        return not self.declaration.specified.isdisjoint(names)

    @classmethod
    def fields(cls) -> dict[str, BlockField[Any]]:
        """Declarations of the block, by name and in order."""
        everything = [item for base in reversed(cls.__mro__) for item in vars(base).items()]
        fields = {name: value for name, value in everything if isinstance(value, BlockField)}
        return {name: fields[name] for name in (*cls.leading, *fields)}

    def __setattr__(self, name: str, value: object) -> None:
        raise AttributeError(f"{type(self).__name__}.{name} is what was declared; it cannot be set")


AnyBlock = TypeVar("AnyBlock", bound=Block)


class Declaration:
    """Collects what a problem declares, for one set of options and of optional requirements given.

    Parameters
    ----------
    problem : str
        Name of the problem, for messages.
    options : mapping
        Options the user has set.
    specified : set of str
        Names of the requirements the user has given.
    catalogs : Catalogs
        The part tables in force.
    """

    def __init__(self, problem: str, options: Mapping[str, str], specified: frozenset[str], catalogs: Catalogs) -> None:
        self.problem = problem
        self.catalogs = catalogs
        self._requested_options = dict(options)
        self.specified = specified
        self.requirements: dict[str, RequirementRecord] = {}
        self.options: dict[str, OptionRecord] = {}
        self.variables: dict[str, VariableRecord] = {}
        self.counts: dict[str, Count] = {}
        self.choices: dict[str, Choice] = {}
        self.slots: dict[str, Part] = {}
        self.rows: dict[str, Part] = {}
        self.derived: dict[str, Derived] = {}
        self.steps: dict[str, Step] = {}
        self.constants: dict[str, Constant] = {}
        self.next_rows: dict[str, NextRowRecord] = {}
        self.limits: dict[str, Limit] = {}
        self.objectives: dict[str, Objective] = {}
        self.preferences: dict[str, str] = {}
        self.refusals: list[Refusal] = []
        self.advices: list[Advice] = []
        self.headlines = Headline()
        self.late: dict[str, tuple[str, ...]] = {}
        self.lines: dict[str, SourceLine | None] = {}  # of expressions, by what they are of
        self._symbols: dict[str, str] = {}

    # -- names ---------------------------------------------------------------------------------

    def _claim(self, name: str, symbol: str | None) -> str:
        symbol = name if symbol is None else symbol
        for word in {name, symbol}:
            if word in self._symbols:
                raise DeclarationError(
                    f"{self.problem}: {word!r} of {name} is already the name or symbol of {self._symbols[word]}"
                )
        self._symbols[name] = self._symbols[symbol] = name
        return symbol

    def words(self) -> frozenset[str]:
        """Every name and symbol in use, those of steps and constants too."""
        return frozenset(self._symbols)

    def _number(self, what: str, value: object, unit: Unit | None = None, end: bool = False) -> float:
        """Convert a number to SI; refuse what is none. ``end`` allows the open end of a range."""
        right = "a number or inf" if end else "a finite number"
        si = math.nan
        if isinstance(value, Real) and not isinstance(value, bool):
            with suppress(OverflowError):  # an integer of more digits than a float holds
                si = float(value) if unit is None else float(to_si(float(value), unit))
        elif isinstance(value, ca.SX):
            right += "; what depends on quantities is a limit"
        if math.isnan(si) or (math.isinf(si) and not end):
            raise DeclarationError(f"{self.problem}: {what} is {shortened(repr(value))}; it must be {right}")
        return si

    def _unit(self, what: str, unit: str) -> Unit:
        """Read the unit that a declaration states; refuse what is none."""
        try:
            return parse_unit(unit)
        except InputError as error:
            raise DeclarationError(f"{self.problem}: {what} has {error}") from error

    def _expression(self, what: str, value: Quantity | float) -> ca.SX:
        """Scalar expression of a declaration; the line that states it is kept for faults that the trace shows."""
        try:
            expression = ca.SX(value)
        except (TypeError, NotImplementedError, RuntimeError):
            expression = None
        if expression is None or expression.shape != (1, 1):
            shape = "" if expression is None else f" of shape {expression.shape}"
            right = "a number or an expression of quantities"
            raise DeclarationError(f"{self.problem}: {what} is {type(value).__name__}{shape}; it must be {right}")
        self.lines[what] = line_of_verb()
        return expression

    def names(self) -> dict[str, str]:
        """Return every accepted spelling (name or symbol) and the name it stands for."""
        silent = {*self.steps, *self.constants, *self.next_rows}
        return {word: name for word, name in self._symbols.items() if name not in silent}

    def tables(self) -> set[str]:
        """Tables of which a row may be read: by slots, fixed rows, or as what comes next to a quantity."""
        read = {part.table for part in (*self.slots.values(), *self.rows.values())}
        following = self.next_rows.values()
        return read | {x.table for x in following} | {x.beside.table for x in following if x.beside is not None}

    # -- verbs ---------------------------------------------------------------------------------

    def block(self, kind: type[AnyBlock], **defaults: Any) -> AnyBlock:
        """Declare the fields of a block and return it.

        Parameters
        ----------
        kind : subclass of Block
        **defaults
            Defaults that this use of the block decides, by field: numbers in the unit of the field, expressions in SI,
            words for options.

        Returns
        -------
        Block
            Its attributes are the symbols, None for optional requirements that are not given, words for options.
        """
        return kind(self, defaults)

    def requirement(
        self,
        name: str,
        unit: str,
        default: Quantity | float | None = None,
        lower: float | None = None,
        upper: float | None = None,
        optional: bool = False,
        symbol: str | None = None,
        text: str = "",
        source: str = "",
        group: str = "",
        follows: bool = False,
        instead: tuple[str, ...] = (),
    ) -> Any:
        """Declare a quantity that the user states; bare numbers are in ``unit``, expressions in SI.

        ``group`` is a word of the family, under which forms and descriptions list what belongs together. One that
        ``follows`` stands for its default where it is not stated, so that what moves the others in a study or by
        scatter moves it too. Where it is missing, others are named that
        may be stated ``instead``.

        Returns
        -------
        symbol, or None for an optional requirement that was not given, or the default that one follows.
        """
        symbol = self._claim(name, symbol)
        parsed = self._unit(f"requirement {name}", unit)
        what = f"of requirement {name}"
        low = self._number(f"the lower end {what}", -np.inf if lower is None else lower, parsed, end=True)
        high = self._number(f"the upper end {what}", np.inf if upper is None else upper, parsed, end=True)
        if low > high or low == np.inf or high == -np.inf:
            raise DeclarationError(f"{self.problem}: requirement {name} needs lower <= upper, not {lower} .. {upper}")
        if isinstance(default, Real):
            default = self._number(f"the default {what}", default, parsed)
        elif default is not None:
            default = self._expression(f"the default {what}", default)
        specified = name in self.specified
        record = RequirementRecord(
            name=name,
            unit=unit,
            symbol=symbol,
            text=text,
            source=source,
            default=default,
            lower=low,
            upper=high,
            optional=optional,
            given=specified,
            group=group,
            sx=None if optional and not specified else ca.SX.sym(name),
            follows=follows and not specified and isinstance(default, ca.SX),
            instead=instead,
        )
        self.requirements[name] = record
        return default if record.follows and record.sx is not None else record.sx

    def option(
        self,
        name: str,
        choices: Sequence[str],
        default: str,
        symbol: str | None = None,
        text: str = "",
        source: str = "",
        group: str = "",
        structural: bool = True,
    ) -> str:
        """Declare a choice of the user and return the chosen string; ``group`` as of requirements.

        One that is not ``structural`` decides numbers alone, and no names.
        """
        symbol = self._claim(name, symbol)
        labels = tuple(choices)
        if default not in labels:
            raise DeclarationError(f"{self.problem}: default {default!r} of option {name} is not one of {labels}")
        if name != symbol and name in self._requested_options and symbol in self._requested_options:
            right = "each option once (name and symbol mean the same)"
            raise InputError(f"options: {name}", symbol, right, ("options", symbol))
        chosen = self._requested_options.get(name, self._requested_options.get(symbol, default))
        if isinstance(chosen, bool):
            chosen = "yes" if chosen else "no"  # YAML reads a bare yes or no as a truth value
        if isinstance(chosen, str) and chosen not in labels and SWITCHED.get(chosen) in labels:
            chosen = SWITCHED[chosen]
        meant = labels_meant(chosen, labels)
        if len(meant) != 1:
            between = "; " if any("," in label for label in labels) else ", "
            raise InputError(f"option {name}", chosen, "one of " + between.join(meant or labels), ("options", name))
        (chosen,) = meant
        self.options[name] = OptionRecord(name, symbol, text, source, labels, default, chosen, group, structural)
        return str(chosen)

    def designations(self, table: str) -> tuple[str, ...]:
        """Return the designations of a catalogue table, for options that are rows of a table."""
        return tuple(self.catalogs.table(table).designations)

    def cell(self, table: str, designation: str, column: str) -> str:
        """Return a text of a catalogue table; empty where a user's own table does not have the column."""
        source_table = self.catalogs.table(table)
        return source_table.text(column)[source_table.row_index(designation)] if source_table.has(column) else ""

    def has_column(self, table: str, column: str) -> bool:
        """True if a catalogue table has a column: a user's own may lack those that are not required."""
        return self.catalogs.table(table).has(column)

    def numbers(self, table: str, column: str) -> np.ndarray:
        """Return a column of a catalogue table in SI, not-a-number where a row has no value."""
        return self.catalogs.table(table).number(column)

    def variable(
        self,
        name: str,
        unit: str,
        lower: float,
        upper: float,
        grid: float | str | Sequence[float] | None = None,
        symbol: str | None = None,
        text: str = "",
        source: str = "",
        within: tuple[Quantity | float, Quantity | float] | None = None,
    ) -> Any:
        """Declare an unknown with bounds (and grid) in ``unit``; return its SI symbol. Equal bounds make a constant.

        ``within``: the range that is searched inside the bounds, as expressions of requirements in SI.
        """
        symbol, what = self._claim(name, symbol), f"the range of variable {name}"
        parsed = self._unit(f"variable {name}", unit)
        low = self._number(f"the lower end of variable {name}", lower, parsed)
        high = self._number(f"the upper end of variable {name}", upper, parsed)
        if low > high:
            raise DeclarationError(f"{self.problem}: variable {name} needs lower <= upper, not {lower} .. {upper}")
        try:
            makeable = grid_values(grid, lower, upper)
        except DeclarationError as error:
            raise DeclarationError(f"{self.problem}: variable {name}: {error}") from None
        if grid is not None and not len(makeable):
            raise DeclarationError(f"{self.problem}: the grid of variable {name} has no value from {lower} to {upper}")
        searched = {str(x) for end in within or () for x in ca.symvar(ca.SX(end))} & {*self.variables, *self.counts}
        if searched:
            raise DeclarationError(f"{self.problem}: {what} depends on {', '.join(searched)}, which is searched")
        record = VariableRecord(
            name=name,
            unit=unit,
            symbol=symbol,
            text=text,
            source=source,
            lower=low,
            upper=high,
            grid=np.asarray(to_si(makeable, parsed), dtype=float),
            sx=ca.SX.sym(name),
            within=None if within is None else (self._expression(what, within[0]), self._expression(what, within[1])),
        )
        self.variables[name] = record
        return record.sx

    def count(
        self,
        name: str,
        lower: float,
        upper: float,
        step: float = 1,
        symbol: str | None = None,
        text: str = "",
        source: str = "",
    ) -> Any:
        """Declare a stepped unknown; return its symbol."""
        symbol = self._claim(name, symbol)
        for part, number in (("lower end", lower), ("upper end", upper), ("step", step)):
            self._number(f"the {part} of count {name}", number)
        if not (step > 0 and lower <= upper):
            raise DeclarationError(f"{self.problem}: count {name} needs lower <= upper and a step above 0")
        values = lower + step * np.arange(int(np.floor((upper - lower) / step + MARGINS.step)) + 1)
        record = Count(name, "-", symbol, text, source, values.astype(float), ca.SX.sym(name))
        self.counts[name] = record
        return record.sx

    def choice(
        self,
        name: str,
        labels: Sequence[str],
        symbol: str | None = None,
        text: str = "",
        source: str = "",
        refused: Mapping[str, str] | None = None,
    ) -> Choice:
        """Declare a discrete unknown that the search decides; ``refused`` says why other labels cannot be asked for."""
        symbol = self._claim(name, symbol)
        if not labels or len(set(labels)) < len(labels):
            raise DeclarationError(f"{self.problem}: choice {name} needs labels, each once")
        record = Choice(name, symbol, text, source, tuple(labels), ca.SX.sym(name), dict(refused or {}))
        self.choices[name] = record
        return record

    def part(
        self,
        slot: str,
        table: str,
        where: str | Sequence[str] = (),
        symbol: str | None = None,
        text: str = "",
        source: str = "",
    ) -> Part:
        """Declare a slot filled by one row of a catalogue table; columns are attributes of the result."""
        symbol = self._claim(slot, symbol)
        conditions = (where,) if isinstance(where, str) else tuple(where)
        part = self._part(slot, table, tuple(c for c in conditions if c), symbol, text, source, True)
        self.slots[slot] = part
        return part

    def split_last(self, *names: str, unless: Sequence[str] = ()) -> None:
        """Tell the search to split these variables, counts and parts last.

        For unknowns that make up for one another, as number, rate and deflection of springs do for their force: each
        of them alone seems to decide limits that see the force only, so that boxes are split over and over along what
        the best design hardly depends on. It steers the search and proves nothing. ``unless`` names objectives that
        see more of these unknowns than their force: where one of them is asked for, nothing is split last.
        """
        self.late |= dict.fromkeys(names, tuple(unless))

    def row(self, table: str, designation: str) -> Part:
        """Return one fixed row of a table (not a slot), for options whose figures stand in a table."""
        self.catalogs.table(table).row_index(designation)
        slot = f"{table}:{designation}"
        if slot not in self.rows:
            self.rows[slot] = self._part(slot, table, (f"designation == {designation!r}",), "", "", "", False)
        return self.rows[slot]

    def _part(
        self, slot: str, table: str, where: tuple[str, ...], symbol: str, text: str, source: str, is_slot: bool
    ) -> Part:
        columns = self.catalogs.table(table).columns
        known = frozenset(c for c, column in columns.items() if column.type in ("number", "integer", "flag"))
        return Part(slot, table, where, symbol, text, source, is_slot, known)

    def derive(
        self,
        name: str,
        unit: str,
        expr: Quantity | float,
        symbol: str | None = None,
        text: str = "",
        source: str = "",
        needs: str | Sequence[str] = (),
        ceiling: float | None = None,
    ) -> Any:
        """Declare a named, reported quantity and return its expression.

        ``needs`` names the guards (limits with ``guard=True``) without which it does not exist;
        it and all that depends on it are null where one of them fails. A user's own limit on it above
        ``ceiling`` (in ``unit``) is refused: it would allow what the model does not cover.
        """
        symbol = self._claim(name, symbol)
        parsed = self._unit(f"derived {name}", unit)
        guards = (needs,) if isinstance(needs, str) else tuple(needs)
        highest = np.inf if ceiling is None else self._number(f"the ceiling of {name}", ceiling, parsed)
        value = self._expression(f"derived {name}", expr)
        record = Derived(name, unit, symbol, text, source, guards, value, highest)
        self.derived[name] = record
        return record.sx

    def step(
        self, name: str, unit: str, expr: Quantity | float, symbol: str | None = None, text: str = "", source: str = ""
    ) -> Quantity:
        """Name a quantity on the way to others, so that hooks read it from ``design.steps``; return its expression.

        It is no public result: no column, limit or objective, and the search does not see it.
        """
        symbol = self._claim(name, symbol)
        self._unit(f"step {name}", unit)
        record = Step(name, unit, symbol, text, source, self._expression(f"step {name}", expr))
        self.steps[name] = record
        return record.sx

    def constant(
        self, name: str, unit: str, value: float, symbol: str | None = None, text: str = "", source: str = ""
    ) -> float:
        """Name a number that formulas hold, so that people read its name in place of it; return it in SI.

        It stays a plain number in the formulas: nothing that is computed changes.
        """
        symbol = self._claim(name, symbol)
        si = self._number(f"constant {name}", value, self._unit(f"constant {name}", unit))
        self.constants[name] = Constant(name, unit, symbol, text, source, si)
        return si

    def next_row(
        self,
        name: str,
        quantity: Quantity | float,
        table: str,
        column: str,
        beside: RowRange | None = None,
        typed: bool = False,
        text: str = "",
        source: str = "",
    ) -> None:
        """Name with every design the row of a table whose column is smallest but not below a quantity (SI).

        It tells what to buy or to make next to a size that no table decides; the search does not see it.

        Parameters
        ----------
        name : str
            Under which the row stands in ``design.next_rows``.
        quantity : symbol or expression
            SI.
        table, column : str
            A catalogue table, and its column of numbers.
        beside : RowRange, optional
            A second table, of which the row is named whose range holds the value that was found in the first.
        typed : bool
            Whether the quantity is a size that the user states, which nothing says is needed.
        text, source : str
        """
        self._claim(name, None)
        lookups = [(table, column)]
        if beside is not None:
            lookups += [(beside.table, beside.over), (beside.table, beside.up_to)]
        for where, key in lookups:
            self.catalogs.table(where).number(key)  # tells now what is no column of numbers
        unit = self.catalogs.table(table).column(column).unit or "-"
        needed = self._expression(f"next row {name}", quantity)
        self.next_rows[name] = NextRowRecord(name, unit, name, text, source, needed, table, column, beside, typed)

    def at_most(self, name: str, value: Quantity | float, limit: Quantity | float, unit: str, **details: Any) -> None:
        """Declare the limit ``value <= limit``; both sides in SI, ``unit`` is for people."""
        self._limit(name, "at_most", value, limit, unit, **details)

    def at_least(self, name: str, value: Quantity | float, limit: Quantity | float, unit: str, **details: Any) -> None:
        """Declare the limit ``value >= limit``."""
        self._limit(name, "at_least", value, limit, unit, **details)

    def equal(self, name: str, value: Quantity | float, limit: Quantity | float, unit: str, **details: Any) -> None:
        """Declare the limit ``value == limit``."""
        self._limit(name, "equal", value, limit, unit, **details)

    def _limit(
        self,
        name: str,
        sense: str,
        value: Quantity | float,
        limit: Quantity | float,
        unit: str,
        guard: bool = False,
        text: str = "",
        source: str = "",
        scale: float | None = None,
    ) -> None:
        if name in self.limits:
            raise DeclarationError(f"{self.problem}: limit {name} is declared twice")
        if guard and sense == "equal":
            raise DeclarationError(f"{self.problem}: an equality ({name}) cannot be a guard")
        parsed = self._unit(f"limit {name}", unit)
        size = SMALLEST if scale is None else self._number(f"the scale of limit {name}", scale, parsed)
        if not size > 0:
            raise DeclarationError(f"{self.problem}: limit {name} has scale {scale}; it must be above 0")
        left, right = (self._expression(f"limit {name}", side) for side in (value, limit))
        self.limits[name] = Limit(name, sense, unit, text, source, left, right, guard, size)

    def objective(self, name: str, sense: str = "min", default: bool = True, resolution: float | None = None) -> None:
        """Offer a named quantity as objective.

        Parameters
        ----------
        name : str
        sense : {"min", "max"}
        default : bool
            Whether it counts where the question names none.
        resolution : float, optional
            In the unit of the quantity: what is better by less counts as equal where the objective may be zero or
            negative, so that a share of its value tells nothing.
        """
        if sense not in ("min", "max"):
            raise DeclarationError(f"{self.problem}: objective {name} has sense {sense!r}; write 'min' or 'max'")
        if resolution is not None and not self._number(f"the resolution of objective {name}", resolution) > 0:
            raise DeclarationError(
                f"{self.problem}: objective {name} has resolution {resolution!r}; it must be above 0"
            )
        self.objectives[name] = Objective(name, sense, default, resolution)

    def prefer(self, name: str, sense: str = "min") -> None:
        """Settle by a quantity what the objectives leave open, after those preferred before.

        Parameters
        ----------
        name : str
            Left out where an option does without it.
        sense : {"min", "max"}
        """
        if sense not in ("min", "max"):
            raise DeclarationError(f"{self.problem}: preference {name} has sense {sense!r}; write 'min' or 'max'")
        self.preferences[name] = sense

    def headline(self, *names: str, sized_by: str = "") -> None:
        """Name what people decide by, in the order of a table of designs; objectives that were chosen stand before.

        Parameters
        ----------
        *names : str
            Variables, counts and derived quantities; those that an option does without are left out.
        sized_by : str
            The limit whose sides are what a design carries and what it is sized for.
        """
        self.headlines = Headline(names, sized_by)

    def refuse(self, code: str, when: Quantity | float, message: str) -> None:
        """Refuse input (or leave out rows) for which ``when`` holds."""
        self.refusals.append(Refusal(code, self._expression(f"refusal {code}", when), message))

    def advise(self, code: str, when: Quantity | float, message: str, source: str = "") -> None:
        """Print a remark on the designs for which ``when`` holds."""
        self.advices.append(Advice(code, self._expression(f"advice {code}", when), message, source))

    # -- views ---------------------------------------------------------------------------------

    def key(self) -> tuple[str, dict[str, str], frozenset[str], Catalogs]:
        """Problem, options, specified requirements and tables: declarations with the same are equal."""
        return self.problem, self._requested_options, self.specified, self.catalogs

    def quantities(self) -> Iterator[tuple[str, str, str]]:
        """Yield (name, unit, kind) of every numeric quantity, in the order of reports."""
        for variable in self.variables.values():
            yield variable.name, variable.unit, "variable"
        for count in self.counts.values():
            yield count.name, "-", "count"
        for derived in self.derived.values():
            yield derived.name, derived.unit, "derived"

    def settle_columns(self, calls: Sequence[SpecialCall]) -> None:
        """Ask of tables only the columns that results read: what hooks alone read may be without a value.

        Parameters
        ----------
        calls : list of SpecialCall
            Special functions that were used, in order.

        Raises
        ------
        InputError
            A table lacks a column that the problem cannot do without.
        """
        read = self._read_by_results(calls)
        for part in (*self.slots.values(), *self.rows.values()):
            for key, column in part.columns.items():
                if not column.required:
                    continue
                if str(column.sx) not in read:
                    part.columns[key] = replace(column, required=False)
                elif key.isidentifier() and key not in part.known:
                    raise part.lacking(key)

    def _read_by_results(self, calls: Sequence[SpecialCall]) -> set[str]:
        """Symbols that defaults, quantities, limits, refusals or remarks depend on."""
        expressions = [r.default for r in self.requirements.values() if isinstance(r.default, ca.SX)]
        expressions += [q.sx for q in self.derived.values()]
        expressions += [side for limit in self.limits.values() for side in (limit.value, limit.limit)]
        expressions += [x.when for x in self.refusals] + [x.when for x in self.advices]
        read = {str(s) for s in ca.symvar(ca.SX(ca.vertcat(*expressions)))}
        for call in reversed(calls):  # the arguments of a call may be the results of earlier ones
            if str(call.symbol) in read:
                read |= {str(s) for x in call.arguments for s in ca.symvar(ca.SX(x))}
        return read

    def finish(self) -> None:
        """Check what can only be checked when everything is declared."""
        known = {name for name, _, _ in self.quantities()}
        for name in self.late:
            if name not in {*self.variables, *self.counts, *self.choices, *self.slots}:
                raise DeclarationError(f"{self.problem}: {name} is split last, but is no variable, count or part")
        for name in {name for names in self.late.values() for name in names}:
            if name not in self.objectives:
                raise DeclarationError(f"{self.problem}: {name} decides what is split last, but is no objective")
        for objective in self.objectives.values():
            if objective.name not in known:
                raise DeclarationError(
                    f"{self.problem}: objective {objective.name} is no variable, count or derived quantity"
                )
        self.preferences = {name: sense for name, sense in self.preferences.items() if name in known}
        shown, sized_by = self.headlines.shown, self.headlines.sized_by
        self.headlines = Headline(
            tuple(name for name in shown if name in known), sized_by if sized_by in self.limits else ""
        )
        for derived in self.derived.values():
            for guard in derived.needs:
                if guard not in self.limits or not self.limits[guard].guard:
                    raise DeclarationError(f"{self.problem}: {derived.name} needs {guard!r}, which is no guard")
        for option in self._requested_options:
            if option not in self.options and option not in {o.symbol for o in self.options.values()}:
                known_options = ", ".join(self.options) or "none"
                right = f"an option of {self.problem}: {known_options}"
                raise UnknownOptionError("options", option, right, ("options", option))
