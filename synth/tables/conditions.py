"""Conditions on the rows of a table: ``lubrication == 'oil' and p_allow > '0.4 N/mm2'``.

::

    condition  = and_part {"or" and_part}
    and_part   = not_part {"and" not_part}
    not_part   = "not" not_part | "(" condition ")" | test
    test       = column ("==" | "!=" | "<" | "<=" | ">" | ">=") value
               | column ["not"] "in" "(" value {"," value} ")"
               | text ["not"] "in" column
    value      = number | text | slot.column
    column     = name | slot.column

A text stands in single or double quotes. A bare number is in the unit that the table's schema gives the column, a
quoted one may have a unit of its own. ``'x' in column`` asks whether x is one of the items of a cell, which are
separated by semicolons. A comparison with an empty cell of a column of numbers is false; an empty cell of text is the
empty text.
A column may be called by its symbol. ``slot.column`` is a column of the row in another slot: such comparisons are for
:mod:`synth.model.slot_comparison`, a table alone cannot answer them.
"""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from synth.errors import InputError
from synth.tables.schema import Column
from synth.tables.table import Table
from synth.text.input_limits import INPUT_LIMITS
from synth.units import parse_quantity, parse_unit

BoolArray = NDArray[np.bool_]

_TOKENS = re.compile(
    r"""(?P<space>\s+)
    |(?P<number>[+-]?(?:[0-9]+(?:\.[0-9]*)?|\.[0-9]+)(?:[eE][+-]?[0-9]+)?(?![\w.]))
    |(?P<text>'[^']*'|"[^"]*")
    |(?P<path>[^\W\d]\w*\.[^\W\d]\w*)
    |(?P<name>[^\W\d]\w*)
    |(?P<op>==|!=|<=|>=|<(?!>)|>)
    |(?P<mark>[(),])""",
    re.VERBOSE,
)
_QUOTED = "a number with its unit in quotes: '0.4 N/mm2'"
_KEYWORDS = ("and", "or", "not", "in")
_COMPARE: dict[str, Callable[[NDArray[np.float64], float], BoolArray]] = {
    "==": lambda cells, value: cells == value,
    "!=": lambda cells, value: ~np.isnan(cells) & (cells != value),
    "<": lambda cells, value: cells < value,
    "<=": lambda cells, value: cells <= value,
    ">": lambda cells, value: cells > value,
    ">=": lambda cells, value: cells >= value,
}


@dataclass(frozen=True)
class _Token:
    kind: str
    text: str
    position: int


@dataclass(frozen=True)
class Value:
    """A value as written: quoted, a bare number, or a column of a slot."""

    text: str
    quoted: bool
    position: int
    column: bool = False


@dataclass(frozen=True)
class Test:
    """Column against one value, or against a list for ``in``."""

    column: str
    op: str
    values: tuple[Value, ...]
    position: int

    @property
    def compares_slots(self) -> bool:
        """Whether the row of one slot cannot answer it."""
        return "." in self.column or any(value.column for value in self.values)


@dataclass(frozen=True)
class ListItem:
    """Item of a cell."""

    item: str
    column: str
    position: int


@dataclass(frozen=True)
class Negation:
    """What must not hold."""

    part: Node


@dataclass(frozen=True)
class Junction:
    """All (``and``) or any (``or``) of the parts."""

    every: bool
    parts: tuple[Node, ...]


Node = Test | ListItem | Negation | Junction


@dataclass(frozen=True)
class Condition:
    """A parsed condition; ``str()`` gives its text back.

    Parameters
    ----------
    text : str
        As the user wrote it.
    columns : frozenset of str
        Names (or symbols) of the columns it asks for.
    """

    text: str
    columns: frozenset[str]
    _root: Node = field(repr=False, compare=False)

    def __str__(self) -> str:
        return self.text

    @property
    def compares_slots(self) -> bool:
        """Whether it names columns of slots, so that one table alone cannot answer it."""
        return _compares_slots(self._root)

    def joint(self) -> Node:
        """Return the parts, all of which must hold, that compare slots."""
        return Junction(True, tuple(part for part in self._parts() if _compares_slots(part)))

    def local(self) -> Condition:
        """Return the condition without the parts that compare slots; it may ask nothing."""
        parts = tuple(part for part in self._parts() if not _compares_slots(part))
        return Condition(self.text, self.columns, Junction(True, parts))

    def _parts(self) -> tuple[Node, ...]:
        root = self._root
        return root.parts if isinstance(root, Junction) and root.every else (root,)

    def mask(self, table: Table) -> BoolArray:
        """Rows for which the condition holds.

        Parameters
        ----------
        table : Table
            The table.

        Returns
        -------
        ndarray of bool
            One value per row.

        Raises
        ------
        InputError
            The table lacks a column, or a value does not fit its column.
        """
        return self._evaluate(self._root, table, None)

    def undecided(self, table: Table) -> BoolArray:
        """Rows whose empty cells decide whether the condition holds; parameters and faults as of :meth:`mask`."""
        return self._evaluate(self._root, table, True) ^ self._evaluate(self._root, table, False)

    def _evaluate(self, node: Node, table: Table, of_empty: bool | None) -> BoolArray:
        """Rows for which a part holds; ``of_empty``: what tests say of empty cells, by default that of no number."""
        if isinstance(node, Negation):
            return ~self._evaluate(node.part, table, None if of_empty is None else not of_empty)
        if isinstance(node, Junction):
            masks = [np.full(len(table), node.every), *(self._evaluate(part, table, of_empty) for part in node.parts)]
            return np.asarray(
                np.logical_and.reduce(masks) if node.every else np.logical_or.reduce(masks), dtype=np.bool_
            )
        if isinstance(node, Test) and node.compares_slots:
            right = "columns of this table: other slots are for the conditions under parts"
            raise self.wrong(node.position, node.column, right)
        try:
            column = table.column(node.column)
        except InputError as error:
            raise self.wrong(node.position, node.column, error.expected) from None
        passing = self._test(node, column, table)
        if of_empty is None:
            return passing
        return np.where(table.empty(column.name), of_empty, passing)

    def _test(self, node: Test | ListItem, column: Column, table: Table) -> BoolArray:
        """Rows whose cell in a column of the table passes one test."""
        if isinstance(node, ListItem):
            if column.numeric:
                right = f"a column of text after 'in'; {column.name} has numbers, compare them with == or <"
                raise self.wrong(node.position, node.column, right)
            items = [{item.strip() for item in cell.split(";")} for cell in table.text(column.name)]
            return np.array([node.item in members for members in items], dtype=np.bool_)
        return self._numbers(node, table) if column.numeric else self._texts(node, table)

    def _numbers(self, test: Test, table: Table) -> BoolArray:
        column = table.column(test.column)
        cells = table.number(column.name)
        masks = []
        for value in test.values:
            try:
                limit = parse_quantity(value.text, column.scale, column.name)
            except InputError as error:
                raise self.wrong(value.position, value.text, f"{error.expected} (column {column.heading})") from None
            masks.append(_COMPARE["==" if test.op == "in" else test.op](cells, limit))
        return np.asarray(np.logical_or.reduce(masks), dtype=np.bool_)

    def _texts(self, test: Test, table: Table) -> BoolArray:
        for value in test.values:
            if not value.quoted:
                right = f"a text in quotes, '{value.text}', since {test.column} is a column of text"
                raise self.wrong(value.position, value.text, right)
        if test.op not in ("==", "!=", "in"):
            right = f"== or != or in for {test.column}, which is a column of text"
            raise self.wrong(test.position, f"{test.column} {test.op}", right)
        texts = {value.text for value in test.values}
        equal = np.array([cell in texts for cell in table.text(test.column)], dtype=np.bool_)
        return ~equal if test.op == "!=" else equal

    def wrong(self, position: int, got: str, expected: str) -> InputError:
        """Return the error that points at a place of the condition."""
        return _error(self.text, position, got, expected)


def _compares_slots(node: Node) -> bool:
    if isinstance(node, Negation):
        return _compares_slots(node.part)
    if isinstance(node, Junction):
        return any(_compares_slots(part) for part in node.parts)
    return isinstance(node, Test) and node.compares_slots


def _error(text: str, position: int, got: str, expected: str) -> InputError:
    at = f"at {got!r} (character {position + 1})" if got else f"at its end (character {position + 1})"
    return InputError(f"condition {at}", text, expected)


def _tokens(text: str) -> list[_Token]:
    tokens: list[_Token] = []
    position = 0
    while position < len(text):
        match = _TOKENS.match(text, position)
        if match is None:
            raise _error(text, position, text[position : position + 2].strip(), _hint(text[position:]))
        kind = str(match.lastgroup)
        if kind != "space":
            word = match[0]
            tokens.append(_Token("keyword" if kind == "name" and word in _KEYWORDS else kind, word, position))
        position = match.end()
    tokens.append(_Token("end", "", len(text)))
    return tokens


def _hint(remaining: str) -> str:
    if remaining[0] in "'\"":
        return "a closing quote"
    hints = {
        "=": "== to compare",
        "<>": "!=",
        "&": "and",
        "|": "or",
        "!": "not, or !=",
        "[": "round brackets",
        "/": _QUOTED,
    }
    for start, right in hints.items():
        if remaining.startswith(start):
            return right
    if re.match(r"[+-]|\.?[0-9]", remaining):
        return f"a number such as 0.4, or {_QUOTED}"
    return "a column, one of == != < <= > >= in, and a number or a text in quotes"


def _is_unit(text: str) -> bool:
    try:
        parse_unit(text)
    except InputError:
        return False
    return True


class _Parser:
    """Recursive descent over the tokens."""

    def __init__(self, text: str) -> None:
        self.text = text
        self.tokens = _tokens(text)
        self.next = 0
        self.depth = 0
        self.columns: set[str] = set()

    @property
    def token(self) -> _Token:
        return self.tokens[self.next]

    def wrong(self, expected: str) -> InputError:
        return _error(self.text, self.token.position, self.token.text, expected)

    def take(self, *words: str) -> _Token | None:
        """Step over one of these keywords or marks, if it is next."""
        token = self.token
        if token.kind in ("keyword", "mark") and token.text in words:
            self.next += 1
            return token
        return None

    def parse(self) -> Node:
        node = self.any_of()
        if self.token.kind != "end":
            raise self.wrong(self.after_test())
        return node

    def after_test(self) -> str:
        before = self.tokens[self.next - 1]
        if before.kind == "number" and self.token.kind == "name" and _is_unit(self.token.text):
            return f"a number with its unit in quotes: '{before.text} {self.token.text}'"
        if before.kind == "number" and self.token.text == ",":
            return "a decimal point instead of a decimal comma"
        if self.token.text.lower() in _KEYWORDS:
            return (
                f"{self.token.text.lower()} in small letters"
                if self.token.kind == "name"
                else "and or or between two tests"
            )
        return "and, or, or the end of the condition"

    def any_of(self) -> Node:
        parts = [self.all_of()]
        while self.take("or"):
            parts.append(self.all_of())
        return parts[0] if len(parts) == 1 else Junction(False, tuple(parts))

    def all_of(self) -> Node:
        parts = [self.negation()]
        while self.take("and"):
            parts.append(self.negation())
        return parts[0] if len(parts) == 1 else Junction(True, tuple(parts))

    def negation(self) -> Node:
        self.depth += 1
        if self.depth > INPUT_LIMITS.nesting:
            raise self.wrong(f"at most {INPUT_LIMITS.nesting} brackets and nots inside each other")
        try:
            if self.take("not"):
                return Negation(self.negation())
            if self.take("("):
                node = self.any_of()
                if not self.take(")"):
                    raise self.wrong("a closing bracket" if self.token.kind == "end" else self.after_test())
                return node
            return self.test()
        finally:
            self.depth -= 1

    def test(self) -> Node:
        first = self.token
        if first.kind == "text":
            return self.membership()
        if first.kind == "number":
            raise self.wrong("the column first, then the comparison and the value")
        if first.kind not in ("name", "path"):
            raise self.wrong("a column, or a text in quotes before 'in'")
        self.next += 1
        if first.kind == "name":
            self.columns.add(first.text)
        operator = self.token
        if operator.kind == "op":
            self.next += 1
            return Test(first.text, operator.text, (self.value(first.kind == "path"),), first.position)
        negated = self.take("not")
        if self.take("in"):
            node = Test(first.text, "in", self.values(), first.position)
            return Negation(node) if negated else node
        raise self.wrong("one of == != < <= > >= in after a column")

    def membership(self) -> Node:
        item = self.value()
        negated = self.take("not")
        if not self.take("in"):
            raise self.wrong("in and a column after a text; a column stands first in a comparison")
        column = self.token
        if column.kind != "name":
            raise self.wrong("a column after 'in'")
        self.next += 1
        self.columns.add(column.text)
        node = ListItem(item.text, column.text, column.position)
        return Negation(node) if negated else node

    def values(self) -> tuple[Value, ...]:
        if not self.take("("):
            raise self.wrong("a list in round brackets after 'in': ('dry', 'oil')")
        values = [self.value()]
        while self.take(","):
            values.append(self.value())
        if not self.take(")"):
            raise self.wrong("a comma or a closing bracket")
        return tuple(values)

    def value(self, after_slot: bool = False) -> Value:
        """Read a value; after a column of another slot it may be a column of this one."""
        token = self.token
        if token.kind == "name" and after_slot:
            self.next += 1
            self.columns.add(token.text)
            return Value(token.text, False, token.position, column=True)
        if token.kind == "text":
            self.next += 1
            return Value(token.text[1:-1], True, token.position)
        if token.kind == "number":
            self.next += 1
            return Value(token.text, False, token.position)
        if token.kind == "path":
            self.next += 1
            return Value(token.text, False, token.position, column=True)
        if token.kind == "name":
            raise self.wrong(f"a number or a text in quotes: '{token.text}'")
        raise self.wrong("a number or a text in quotes")


def may_be_condition(text: str) -> bool:
    """Tell a text that may be meant as a condition from a single word: every condition compares, or asks ``in``.

    Examples
    --------
    >>> may_be_condition("mu_dynamic>0.1"), may_be_condition("'oil' in lubrication"), may_be_condition("cork_wet")
    (True, True, False)
    """
    return re.search(r"[\s<>=]", text) is not None


def parse_condition(text: str) -> Condition:
    """Read a condition.

    Parameters
    ----------
    text : str
        For example ``lubrication in ('dry', 'oil') and mu_dynamic > 0.1``.

    Returns
    -------
    Condition
        To be applied to tables.

    Raises
    ------
    InputError
        The text is not in the grammar; the message points at the place.

    Examples
    --------
    >>> sorted(parse_condition("crowned == 0 and kind != 'spherical_roller_bearing'").columns)
    ['crowned', 'kind']
    """
    if not isinstance(text, str):
        raise InputError("condition", text, "a text: a column, a comparison and a value")
    if not text.strip():
        raise InputError("condition", text, "a column, a comparison and a value")
    if len(text) > INPUT_LIMITS.condition:
        raise InputError("condition", text[:40], f"at most {INPUT_LIMITS.condition} characters")
    parser = _Parser(text)
    root = parser.parse()
    return Condition(text, frozenset(parser.columns), root)
