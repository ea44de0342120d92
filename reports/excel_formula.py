"""Formulas of a calculation as formulas of a spreadsheet: named cells in place of quantities.

Only functions that every spreadsheet has had for decades are used: no LET, no LAMBDA, no array formulas. Where a
spreadsheet reads signs otherwise than mathematics does there are brackets: ``-a^2`` is (-a)^2 there, and ``a^b^c`` is
(a^b)^c.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Collection, Mapping
from fractions import Fraction

from synth.operations.record import Trait
from synth.operations.records import function_of
from synth.results.expression import Expression, parts_of, with_parts
from synth.units import parse_unit

LONGEST = 2000  # characters; Excel takes 8192, people read fewer
DEEPEST = 60  # brackets inside each other; Excel takes 64 functions
HALVED = 6  # parts of a sum or product from which on its halves get cells
WIDTH = 5  # decimals of a number from which on it is looked for among fractions

# How firmly what stands there must hold together: a term, a factor, what is divided by, what is raised.
ANY, TERM, FACTOR, DIVISOR, BASE = range(5)
FIRMNESS = {"": ANY, "term": TERM, "factor": FACTOR, "divisor": DIVISOR, "base": BASE}  # as templates name it

Helper = Callable[[Expression], str]

SIGN_OF = {"<": "<", "<=": "<=", "==": "=", "!=": "<>"}
CONDITIONS = frozenset((*SIGN_OF, "and", "or", "not"))

PI = parse_unit("deg").ratio * 180
DENOMINATORS = (1, 2, 3, 4, 6, 7, 8, 9, 12, 16, 24, 30, 32, 60, 64, 180)
NUMERATORS = (1, 2, 3, 4, 5, 7, 8, 11, 16, 32)


def write(
    expression: Expression, names: Mapping[str, str], helper: Helper | None = None, doubtful: Collection[str] = ()
) -> str:
    """Return a tree as the formula of a cell, without the sign of equality in front.

    Parameters
    ----------
    expression : Expression
    names : mapping
        Quantity -> what the spreadsheet calls it: a defined name, or a cell.
    helper : callable, optional
        Puts a tree into a cell of its own and returns that. Without it a formula that needs its argument twice writes
        it twice, and one that is too long is refused.
    doubtful : collection of str
        Quantities whose cell may hold an error. A comparison with what does not exist is not true (unequal: true), as
        everywhere in this program; a spreadsheet would hand the error on.

    Returns
    -------
    str

    Raises
    ------
    ValueError
        The formula is longer than :data:`LONGEST`, and there is no helper.

    Examples
    --------
    >>> x, y = ["q", "x"], ["q", "y"]
    >>> write(["neg", ["^", x, ["n", 2.0]]], {"x": "wire.d"})
    '-(wire.d^2)'
    >>> write(["+", [["*", [["n", 2.0], x], [y]], ["neg", ["+", [x, y]]]]], {"x": "x", "y": "y"})
    '2*x/y-(x+y)'
    >>> write(["f", "atan2", [y, x]], {"x": "x", "y": "y"})
    'ATAN2(x,y)'
    >>> write(["if", ["<=", x, y], ["n", 1 / 3], ["n", 0.39269908169872414]], {"x": "x", "y": "y"})
    'IF(x<=y,1/3,PI()/8)'
    """
    known = dict(names)
    while True:
        text = _Writer(known, helper, frozenset(doubtful)).number(expression)
        if len(text) <= LONGEST and _depth(text) <= DEEPEST:
            return text
        if helper is None:
            raise ValueError(f"a formula of {len(text)} characters needs cells for its parts")
        expression = _shorter(expression, known, helper)


def number_text(value: float) -> str:
    """Return a number as formulas have it: a fraction, or a multiple of pi, where it is one.

    A spreadsheet reads 15 digits; so 1/3 is more than a short way to write it.

    Examples
    --------
    >>> [number_text(x) for x in (0.25, 2 / 3, 4 * math.pi, 1e-7, 600.0, -0.1, 6.02e23)]
    ['0.25', '2/3', '4*PI()', '1E-07', '600', '-0.1', '6.02E+23']
    """
    if value < 0:
        return "-" + number_text(-value)
    if float(value).is_integer() and value < 1e15:
        return str(int(value))
    plain = repr(float(value)).replace("e", "E")
    if len(plain) <= WIDTH + 2 or not 1e-4 < value < 1e4:
        return plain
    for power, word in ((0, ""), (1, "PI()"), (2, "PI()^2")):
        for under in DENOMINATORS:
            for over in NUMERATORS:
                if abs(over * math.pi**power / under - value) <= 2e-16 * value:
                    front = [str(over)] if over > 1 or not word else []
                    return "*".join([*front, *([word] if word else [])]) + (f"/{under}" if under > 1 else "")
    return plain


def to_si_text(cell: str, unit: str) -> str:
    """Return the formula for the SI value of a cell in a unit, with the factor written out.

    Examples
    --------
    >>> to_si_text("C5", "mm"), to_si_text("C5", "1/min"), to_si_text("C5", "degC"), to_si_text("C5", "N*m")
    ('C5/1000', 'C5*PI()/30', 'C5+273.15', 'C5')
    """
    factor, offset = _factor(unit)
    return f"{cell}{factor}+{offset}" if offset else f"{cell}{factor}"


def from_si_text(cell: str, unit: str) -> str:
    """Return the formula for the value in a unit of a cell that holds it in SI.

    Examples
    --------
    >>> from_si_text("E5", "mm"), from_si_text("E5", "1/min"), from_si_text("E5", "degC"), from_si_text("E5", "-")
    ('E5*1000', 'E5*30/PI()', 'E5-273.15', 'E5')
    """
    factor, offset = _factor(unit, turned=True)
    return f"({cell}-{offset}){factor}" if offset and factor else f"{cell}-{offset}" if offset else f"{cell}{factor}"


def _factor(unit: str, turned: bool = False) -> tuple[str, str]:
    """Text behind the cell, and the added factor: the exact factor of a unit as people write it."""
    if unit in ("", "-"):
        return "", ""
    read = parse_unit(unit)
    offset = repr(read.offset) if read.offset else ""
    for power in (0, 1, -1):
        ratio = read.ratio / PI**power
        if max(ratio.numerator, ratio.denominator) < 10**15:
            break
    else:
        ratio, power = Fraction(float(read.ratio)), 0
        return (("/" if turned else "*") + number_text(float(ratio))), offset
    if turned:
        ratio, power = 1 / ratio, -power
    over = ([str(ratio.numerator)] if ratio.numerator > 1 else []) + (["PI()"] if power > 0 else [])
    under = ([str(ratio.denominator)] if ratio.denominator > 1 else []) + (["PI()"] if power < 0 else [])
    return "".join(f"*{x}" for x in over) + "".join(f"/{x}" for x in under), offset


def _depth(text: str) -> int:
    """Depth of nested brackets."""
    deepest = depth = 0
    for letter in text:
        depth += (letter == "(") - (letter == ")")
        deepest = max(deepest, depth)
    return deepest


def _shorter(tree: Expression, known: dict[str, str], helper: Helper) -> Expression:
    """Return a tree with parts of it in cells of their own, which it calls by name; the names are added to those known.

    Raises
    ------
    ValueError
        No part of it can have a cell.
    """

    def apart(part: Expression) -> Expression:
        if part[0] in SIGN_OF:  # the sides of a comparison get cells, not the comparison
            return with_parts(part, [apart(side) if parts_of(side) else side for side in part[1:]])
        if part[0] in CONDITIONS:
            return with_parts(part, [["!=", named(["if", x, ["n", 1.0], ["n", 0.0]]), ["n", 0.0]] for x in part[1:]])
        return named(part)

    def named(part: Expression) -> Expression:
        cell = helper(part)
        known[cell] = cell
        return ["q", cell]

    def halves(several: list[Expression], joined: Callable[[list[Expression]], Expression]) -> list[Expression]:
        half = len(several) // 2
        return [apart(joined(several[:half])), apart(joined(several[half:]))] if len(several) >= HALVED else several

    parts = parts_of(tree)
    if len(parts) >= HALVED and tree[0] in ("+", "f"):
        return _joined(tree, halves(parts, lambda chunk: _joined(tree, chunk)))
    if tree[0] == "*" and max(map(len, tree[1:])) >= HALVED:
        return ["*", *(halves(side, lambda chunk: ["*", chunk, []]) for side in tree[1:])]
    if not any(parts_of(part) for part in parts):
        raise ValueError("a formula of few names is too long: the names are")
    return with_parts(tree, [apart(part) if parts_of(part) else part for part in parts])


def _joined(tree: Expression, parts: list[Expression]) -> Expression:
    """Return other parts joined as those of a sum or a function are."""
    return ["+", parts] if tree[0] == "+" else ["f", tree[1], parts]


class _Writer:
    """Text of trees; each method returns what holds together as firmly as it is asked to."""

    def __init__(self, names: Mapping[str, str], helper: Helper | None, doubtful: frozenset[str]) -> None:
        self.names, self.helper, self.doubtful = names, helper, doubtful

    def number(self, tree: Expression, firm: int = ANY) -> str:
        """Return a tree that is a number."""
        kind = tree[0]
        if kind == "q":
            return self.names[tree[1]]
        if kind == "n":
            return self._constant(tree[1], firm)
        if kind == "+":
            return _bracketed(self._sum(tree[1]), firm >= FACTOR)
        if kind == "neg":
            return _bracketed("-" + self._negated(tree[1]), firm >= TERM)
        if kind == "*":
            return _bracketed(self._product(tree[1], tree[2]), firm >= DIVISOR)
        if kind == "^":
            text = f"{self.number(tree[1], BASE)}^{self.number(tree[2], BASE)}"
            return _bracketed(text, firm >= BASE)
        if kind == "if":
            return f"IF({self.condition(tree[1])},{self.number(tree[2])},{self.number(tree[3])})"
        if kind in CONDITIONS:
            return f"IF({self.condition(tree)},1,0)"
        return self._function(tree[1], tree[2], firm)

    def condition(self, tree: Expression) -> str:
        """Return a tree that is true or false."""
        kind = tree[0]
        if kind in ("and", "or"):
            return f"{kind.upper()}({self.condition(tree[1])},{self.condition(tree[2])})"
        if kind == "not":
            return f"NOT({self.condition(tree[1])})"
        if kind not in SIGN_OF:
            return f"{self.number(tree, TERM)}<>0"
        text = f"{self.number(tree[1], TERM)}{SIGN_OF[kind]}{self.number(tree[2], TERM)}"
        if self._fails(tree[1]) or self._fails(tree[2]):
            return f"IFERROR({text},{'TRUE' if kind == '!=' else 'FALSE'})"
        return text

    def _constant(self, value: float, firm: int) -> str:
        if not math.isfinite(value):
            return "NA()" if math.isnan(value) else f"{'-' if value < 0 else ''}1E+308"
        text = number_text(value)
        is_plain = not any(sign in text for sign in "*/^")
        return _bracketed(text, firm >= TERM if value < 0 else firm >= DIVISOR and not is_plain)

    def _sum(self, terms: list[Expression]) -> str:
        text = self.number(terms[0])
        for term in terms[1:]:
            if term[0] == "neg":
                text += "-" + self.number(term[1], FACTOR)
            elif term[0] == "n" and term[1] < 0:
                text += self._constant(term[1], ANY)
            else:
                text += "+" + self.number(term, TERM)
        return text

    def _negated(self, tree: Expression) -> str:
        """Operand behind a minus: a sign goes before a power there, so a power stands in brackets."""
        plain = tree[0] in ("q", "f", "if") or (tree[0] == "n" and tree[1] >= 0)
        text = self.number(tree, BASE)
        return text if plain or text.startswith("(") else f"({text})"

    def _product(self, over: list[Expression], under: list[Expression]) -> str:
        text = "*".join(self.number(x, FACTOR) for x in over or [["n", 1.0]])
        if len(under) == 1:
            return f"{text}/{self.number(under[0], DIVISOR)}"
        return text + ("/(" + "*".join(self.number(x, FACTOR) for x in under) + ")" if under else "")

    def _function(self, name: str, arguments: list[Expression], firm: int) -> str:
        sheet = function_of(name).sheet
        if sheet is None:
            return f"{name.upper()}({','.join(map(self.number, arguments))})"
        power, negative = _Argument(self, ["f", "exp", arguments]), _Argument(self, ["neg", arguments[0]])
        text = sheet.text.format(*(_Argument(self, x) for x in arguments), power=power, negative=negative)
        return _bracketed(text, sheet.falls_apart_in is not None and firm >= FIRMNESS[sheet.falls_apart_in])

    def referred(self, tree: Expression) -> str:
        """Reference that can occur several times."""
        if tree[0] == "q" or self.helper is None:
            return self.number(tree, BASE)
        return self.helper(tree)

    def _fails(self, tree: Expression) -> bool:
        """True if the cell of a tree may hold an error."""
        kind = tree[0]
        if kind == "q":
            return tree[1] in self.doubtful
        if any(map(self._fails, parts_of(tree))):
            return True
        if kind == "*":
            return any(x[0] != "n" or x[1] == 0 for x in tree[2])
        if kind == "^":
            return not (tree[2][0] == "n" and tree[2][1] > 0 and float(tree[2][1]).is_integer())
        if kind != "f":
            return False
        function = function_of(tree[1])  # a spreadsheet refuses what is not defined or not finite
        return function.domain is not None or function.finite is not None or Trait.DIVIDES in function.traits


class _Argument:
    """Argument of a function, which a template names with how firmly it must hold together, or ``cell``."""

    def __init__(self, writer: _Writer, tree: Expression) -> None:
        self.writer, self.tree, self.known = writer, tree, dict[str, str]()

    def __format__(self, how: str) -> str:
        if how not in self.known:  # written once: parts of it may take cells
            writer, tree = self.writer, self.tree
            self.known[how] = writer.referred(tree) if how == "cell" else writer.number(tree, FIRMNESS[how])
        return self.known[how]


def may_fail(expression: Expression, doubtful: Collection[str]) -> bool:
    """True if the cell of a tree may hold an error, given the quantities whose cells may."""
    return _Writer({}, None, frozenset(doubtful))._fails(expression)


def _bracketed(text: str, needed: bool) -> str:
    return f"({text})" if needed else text
