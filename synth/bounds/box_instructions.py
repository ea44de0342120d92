"""The statements that tighten boxes as a list of instructions, for the kernel.

They do the operations of the NumPy form on the same numbers in the same order. An instruction is a row of numbers: what
is done, the register of the result, and those of the operands. What an instruction can do is an expression in C
(:func:`forms`) or a rule of :mod:`synth.bounds.compiled_rules`; larger expressions are taken apart.
"""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cache
from typing import Any

import casadi as ca
import numpy as np

from synth.bounds import compiled_rules as rules
from synth.bounds.contractor import Code
from synth.bounds.fused_instructions import RUNS, fused
from synth.bounds.propagated_nodes import CONSTANT
from synth.bounds.statements import Assign, Enclose, EndOfFirstSweep, Hold, Kill, Narrow, Statement
from synth.kernels.expressions import EXPRESSIONS
from synth.model.program import COMPARISONS, OP_SELECT, Program, UnsupportedOperation
from synth.special import SpecialFunction

WIDTH = 6  # of an instruction: what is done, where the result goes, and up to four operands
LETTERS = "abcd"
BUILT_IN = ("END", "END_IF_DEAD", "HOLD", "IN_ORDER", *RUNS)

# Expressions of registers a to d that are not masks, and of masks.
NUMBERS = (
    "a",
    "a * b - c",
    "a + b - c * d",
    "a + b + c * d",
    "a - b - c * d",
    "a - b + c * d",
    "a * (b + c)",
    "v_min(a, b)",
    "v_max(a, b)",
)
MASKS = ("a > b", "a < b", "a >= b", "a > b * c", "a < b * c", "a > b + c * d")
# What narrows an end is met with what is known of it, without a further instruction.
MET = ("a", "a * b", "a / b", "a + b", "a - b", "a * b - c", "a - b * c", "v_sqrt(a)")
# Both ends of a node at once, each from two operands.
TWICE = ("a * b", "a / b", "a + b", "a - b")
ENDS = {"v_fmax": "both ends met", "": "both ends"}
# What reads masks, or an expression that is not said in C as it is here.
OTHERS = {
    "~a": "(vd)~(vi)a",
    "a & b": "(vd)((vi)a & (vi)b)",
    "a | b": "(vd)((vi)a | (vi)b)",
    "choose(a, b, c)": "choose((vi)a, b, c)",
    "keep(a, b)": "keep((vi)a, b)",
    "TRUTH(a)": "keep((vi)a, all(1.0))",
    "up(a, b, c)": "a + c * v_max(v_abs(a), b)",
    "down(a, b, c)": "a - c * v_max(v_abs(a), b)",
}
LEAF = re.compile(
    r"\b(?:[lhoax]\d+|[rabc]_(?:low|high)|[stmpq])\b(?!\()|[BCF]\[\d+\]|(?<![\w.\]])(?:\d+\.?\d*(?:e[+-]?\d+)?|INFINITY|NAN)(?![\w.])"
)
CROSSED = re.compile(r"choose\(l(\d+) > h\1, h\1, l\1\)")
OF_TWO = re.compile(r"(?:(v_fmax|v_fmin)\((\w+), )?([lh]\d+|[st]) ([-+*/]) ([lh]\d+|[st])\)?")
LOOSENED = re.compile(r"loosened\(([^,]+), ([^,]+), (-?)([^,()]+)\)")


class NoForm(Exception):
    """Something in the statements cannot be done by the list."""


def _plain(text: str) -> str:
    """Return an expression as ``ast`` writes it."""
    return ast.unparse(ast.parse(text, mode="eval"))


@cache
def forms() -> dict[str, str]:
    """Return what an instruction can compute: expressions of letters, in C; masks are kept as numbers."""
    plain = [*NUMBERS, *(_lettered(text.format("a", "b")) for text in EXPRESSIONS.values())]
    made = {_plain(text): text for text in plain if not any(sign in text for sign in "<>=!")}
    for text in (*MASKS, *(EXPRESSIONS[op] for op in (ca.OP_LT, ca.OP_LE, ca.OP_EQ, ca.OP_NE))):
        made[_plain(text.format("a", "b"))] = f"(vd)({text.format('a', 'b')})"
    for side in ("v_fmax", "v_fmin"):
        for text in MET:
            later = re.sub(r"\b[abc]\b", lambda letter: LETTERS[LETTERS.index(letter[0]) + 1], text)
            made[_plain(f"{side}(a, {later})")] = f"{side}(a, {later})"
    return made | OTHERS


def _lettered(text: str) -> str:
    """Return an expression in which each place is a letter of its own, numbers too."""
    letters = iter(LETTERS)
    return re.sub(r"\b[ab]\b|\b\d+\.\d+", lambda _: next(letters), text)


@cache
def operations() -> dict[str, int]:
    """Return the number of everything that an instruction can do."""
    twice = [f"{how} {text}" for how in ENDS.values() for text in TWICE]
    kills = [f"kill {text}" for text in ("a", *MASKS)]
    names = [*BUILT_IN, *forms(), *kills, *twice, *(name for name, _ in rule_functions())]
    return {name: number for number, name in enumerate(names)}


# What rules are called with that is no expression of registers: such rules are functions in C.
FUNCTIONS = re.compile(r"\bi_|\bwave\b|\bequality\b|\bblurred\b|\bwidened\b|\bfloor\b")


@cache
def _bodies() -> dict[str, str]:
    """Return the rules for enclosures, which read ``a``, ``b`` and ``c``, and ``r``."""
    bodies = {f"forward_{op + 100}": body for op, body in rules.FORWARD.items()}
    for same, body in rules.POWER_FORWARD.items():
        bodies[f"forward_power_{'constant' if same else 'any'}"] = body
    for count in (1, 2, 3):
        total = " + ".join(f"{x}.low" for x in "abc"[:count])
        bodies[f"whole_{count}"] = f"both(({total}) * 0.0 - INFINITY, ({total}) * 0.0 + INFINITY)"
    for op, own in rules.BACKWARD.items():
        bodies |= {f"backward_{op + 100}_{i}": body for i, body in enumerate(own) if body}
    return bodies | {"backward_power": rules.POWER_BACKWARD}


def rule_functions() -> Iterator[tuple[str, str]]:
    """Return the rules that are functions in C."""
    return ((name, body) for name, body in _bodies().items() if _ends_of(body) is None)


@cache
def _ends_of(body: str) -> tuple[str, str] | None:
    """Return a rule as an expression for each end; None where it is more than that."""
    text = re.sub(r"clipped\(([^,()]+), ([^,()]+), ([^,()]+)\)", r"v_min(v_max(\1, \2), \3)", body)
    text = re.sub(
        r"where\(([^,()]+), r, unknown\(\)\)",
        r"both(choose(\1, r.low, -INFINITY), choose(\1, r.high, INFINITY))",
        text,
    )
    if FUNCTIONS.search(text) or not text.startswith("both("):
        return None
    low, high = ast.parse(text, mode="eval").body.args  # type: ignore[attr-defined]
    return ast.unparse(low), ast.unparse(high)


@dataclass(frozen=True)
class Instructions:
    """The lists of one sign pattern, and where in the file of registers what they read and write stands.

    Parameters
    ----------
    places : dict of str to int
        The first register of each region, and how many registers there are.
    literals : array
        Numbers of the expressions.
    first, later, last : array (instructions, WIDTH)
        Of the first sweep, of one that follows, and what is read off at the end.
    """

    places: dict[str, int]
    literals: np.ndarray
    first: np.ndarray
    later: np.ndarray
    last: np.ndarray


def instructions(code: Code) -> Instructions | None:
    """Return generated code as lists; None where something in it has no form there."""
    try:
        return _Lists(code).made()
    except (NoForm, UnsupportedOperation, KeyError):
        return None


class _Lists:
    """Makes the lists of one sign pattern."""

    LATER = 1 << 24  # registers of literals are known when all else is

    def __init__(self, code: Code) -> None:
        self.code, self.nodes, self.sweeps = code, code.nodes, code.sweeps
        self.number = operations()
        self.out: list[tuple[int, ...]] = []
        self.literals: dict[str, int] = {}
        self.formulas: dict[int, tuple[list[tuple[str, str]], str]] = {}  # of special functions
        self.used = self.most = 0  # temporary registers
        self.places = self._regions()

    def _regions(self) -> dict[str, int]:
        """Give every name of the statements a register; ends of a node stand side by side."""
        sweeps, self.register = self.sweeps, dict[str, int]()
        moved = [k for k, _ in sweeps.variables]
        inner = [k for k in self.nodes.inner if k not in self.nodes.auxiliary]
        regions = {
            "constants": [f"{end}{k}" for k in sweeps.constants for end in "lh"],
            "right_sides": [f"B[{j}]" for j in range(sweeps.limits)],
            "cutoffs": [f"C[{j}]" for j in range(len(sweeps.goals))],
            "floors": [f"F[{j}]" for j in range(len(sweeps.goals))],
            "tables": [f"{end}{k}" for k in sweeps.tables for end in "lh"],
            "variables": [f"{end}{k}" for k in moved for end in "lh"],
            "inner": [f"{end}{k}" for k in inner for end in "lh"],
            "open": [f"o{j}" for j in range(sweeps.limits)],
            "goals": [f"goal {j}" for j in range(len(sweeps.goals))],
            "scratch": list("stmpq"),
        }
        places = {}
        for region, names in regions.items():
            places[region] = len(self.register)
            self.register |= {name: len(self.register) + i for i, name in enumerate(names)}
        self.free_at = len(self.register)
        return places

    def made(self) -> Instructions:
        """Return all lists."""
        lists = [self._list(self.sweeps.first), self._list(self.sweeps.later), self._ends()]
        self.places["literals"] = self.free_at + self.most
        self.places["registers"] = self.places["literals"] + len(self.literals)
        for own in lists:
            own[own >= self.LATER] += self.places["literals"] - self.LATER
        numbers = {"INFINITY": np.inf, "NAN": np.nan}
        literals = np.array([numbers[x] if x in numbers else float(x) for x in self.literals])
        return Instructions(self.places, literals, *lists)

    def _list(self, statements: Sequence[Statement]) -> np.ndarray:
        self.out, k = [], 0
        while k < len(statements):
            self.used = 0
            k += (
                self._in_order(statements[k : k + 3])
                or self._both_ends(statements[k : k + 2])
                or self._one(statements[k])
            )
        self._put("END", 0)
        return np.array(fused(self.out, self.number, WIDTH), dtype=np.intc)

    def _ends(self) -> np.ndarray:
        goals = [Assign(f"goal {j}", end) for j, end in enumerate(self.sweeps.goals)]
        return self._list(goals)

    def _put(self, name: str, target: int, operands: Sequence[int] = ()) -> None:
        self.out.append((self.number[name], target, *operands, *[0] * (WIDTH - 2 - len(operands))))

    def _new(self, count: int = 1) -> int:
        first, self.used = self.free_at + self.used, self.used + count
        self.most = max(self.most, self.used)
        return first

    def _low(self, k: int) -> int:
        return self.register[f"l{k}"]

    # -- statements

    def _one(self, s: Statement) -> int:
        if isinstance(s, Assign):
            self._compute(s.value, self.register, self.register[s.target])
        elif isinstance(s, Kill):
            self._kill(s.condition)
        elif isinstance(s, Hold):
            self._put("HOLD", self._low(s.node), [s.node])
        elif isinstance(s, EndOfFirstSweep):
            self._put("END_IF_DEAD", 0)
        elif isinstance(s, Enclose):
            self._enclose(s)
        else:
            self._narrow(s)
        return 1

    def _in_order(self, some: Sequence[Statement]) -> int:
        """Put ends that change places where they cross: three statements are one instruction."""
        first = some[0]
        node = CROSSED.fullmatch(first.value) if isinstance(first, Assign) else None
        if node is None:
            return 0
        k = node[1]
        swapped = (Assign("m", node[0]), Assign(f"h{k}", f"choose(l{k} > h{k}, l{k}, h{k})"), Assign(f"l{k}", "m"))
        if tuple(some) != swapped:
            return 0
        self._put("IN_ORDER", self.register[f"l{k}"])
        return 3

    def _both_ends(self, some: Sequence[Statement]) -> int:
        """Put both ends of a node where each comes of two operands: two statements are one instruction."""
        low, high = some[0], some[-1]
        if not (isinstance(low, Assign) and isinstance(high, Assign)):
            return 0
        first, second = OF_TWO.fullmatch(low.value), OF_TWO.fullmatch(high.value)
        if first is None or second is None or low.target[0] != "l" or high.target != f"h{low.target[1:]}":
            return 0
        met, own, a, sign, b = first.groups()
        met_too, other, c, sign_too, d = second.groups()
        alike = (met, met_too) in (("v_fmax", "v_fmin"), (None, None)) and sign == sign_too
        if not alike or own not in (None, low.target) or other not in (None, high.target) or low.target in (c, d):
            return 0
        self._put(f"{ENDS[met or '']} a {sign} b", self.register[low.target], [self.register[x] for x in (a, b, c, d)])
        return 2

    def _kill(self, condition: str) -> None:
        text, leaves = _masked(condition)
        self._steps(_plan(text, killing=True), [self._leaf(x, self.register) for x in leaves], 0)

    def _enclose(self, s: Enclose) -> None:
        ends, nodes = [self._low(k) for k in s.args], self.nodes
        if s.function.startswith("range_of"):
            self._range(int(s.function.removeprefix("range_of_special_")), s.args)
            return
        name = f"whole_{len(s.args)}"
        if s.function != "whole":
            powers = [f"forward_{op + 100}" for op in rules.POWERS]
            exponent = "constant" if nodes.kind[s.args[-1]] == CONSTANT else "any"
            name = f"forward_power_{exponent}" if s.function in powers else s.function
        self._rule(name, self.register["s"], ends)

    def _rule(self, name: str, target: int, operands: Sequence[int]) -> None:
        """Put a rule that gives both ends; the operands are the registers of the lower ones."""
        ends = _ends_of(_bodies()[name])
        if ends is None:
            self._put(name, target, operands)
            return
        letters = "rabc" if name.startswith("backward") else "abc"
        names: dict[str, int] = {}
        for letter, low in zip(letters, operands, strict=False):
            names |= {f"{letter}_low": low, f"{letter}_high": low + 1}
        for place, text in enumerate(ends):
            self._compute(re.sub(r"\b([rabc])\.(low|high)\b", r"\1_\2", text), names, target + place)

    def _range(self, k: int, args: Sequence[int]) -> None:
        """Put the ends of a special function whose arguments may be negative: nothing is known of it then."""
        rising = [low >= 0 for low, _ in self.nodes.program.specials[k].elasticity]
        least = ", ".join(f"{'l' if up else 'h'}{a}" for a, up in zip(args, rising, strict=True))
        most = ", ".join(f"{'h' if up else 'l'}{a}" for a, up in zip(args, rising, strict=True))
        inside = " & ".join(f"(l{a} >= 0.0)" for a in args)
        self._compute(f"choose({inside}, special_{k}({least}), -INFINITY)", self.register, self.register["s"])
        self._compute(f"choose({inside}, special_{k}({most}), INFINITY)", self.register, self.register["t"])

    def _narrow(self, s: Narrow) -> None:
        power = s.op in rules.POWERS
        if power and self.nodes.kind[s.args[1]] != CONSTANT:
            return
        known = [self._low(s.node), *(self._low(a) for a in s.args)]
        found = [self._new(2) for _ in s.positions]
        for i, place in zip(s.positions, found, strict=True):
            self._rule("backward_power" if power else f"backward_{s.op + 100}_{i}", place, known)
        for i, place in zip(s.positions, found, strict=True):
            low = self._low(s.args[i])
            self._put("v_fmax(a, b)", low, [low, place])
            self._put("v_fmin(a, b)", low + 1, [low + 1, place + 1])

    # -- expressions

    def _leaf(self, name: str, names: dict[str, int]) -> int:
        if name in names:
            return names[name]
        if not re.match(r"\d|INFINITY|NAN", name):
            raise NoForm(name)
        return self.LATER + self.literals.setdefault(name, len(self.literals))

    def _compute(self, text: str, names: dict[str, int], target: int) -> None:
        """Put the value of an expression into a register."""
        masked, leaves = _masked(text)
        self._steps(_plan(masked), [self._leaf(x, names) for x in leaves], target)

    def _steps(self, steps: Sequence[Step], leaves: Sequence[int], target: int) -> None:
        """Put the steps of an expression, the last one with a given target."""
        made: list[int] = []
        for number, (name, operands) in enumerate(steps):
            given = [leaves[x] if x >= 0 else made[~x] for x in operands]
            place = target if number == len(steps) - 1 else self._new()
            made.append(place)
            if name.startswith("special_"):
                self._special(int(name.removeprefix("special_")), given, place)
            else:
                self._put(name, place, given)

    def _special(self, k: int, args: Sequence[int], target: int) -> None:
        """Put the formula of a special function, which stands in the list as often as it is used."""
        if k not in self.formulas:
            self.formulas[k] = formula_steps(self.nodes.program.specials[k])
        steps, result = self.formulas[k]
        names = {f"a{i}": place for i, place in enumerate(args)}
        for name, value in steps:
            names[name] = self._new()
            self._compute(value, names, names[name])
        self._compute(result, names, target)


# An operation and its operands: leaves of the expression by number, results of earlier steps as ~number.
Step = tuple[str, tuple[int, ...]]


def _masked(text: str) -> tuple[str, list[str]]:
    """Return an expression with its leaves numbered, and the leaves: few expressions differ in more than these."""
    text = LOOSENED.sub(lambda own: f"{'down' if own[3] else 'up'}({own[1]}, {own[2]}, {own[4]})", text)
    text = re.sub(r"\ball\(([^()]*)\)", r"(\1)", text)
    leaves: list[str] = []

    def numbered(leaf: re.Match[str]) -> str:
        leaves.append(leaf[0])
        return f"_{len(leaves) - 1}"

    return LEAF.sub(numbered, text), leaves


@cache
def _plan(text: str, killing: bool = False) -> tuple[Step, ...]:
    """Return the steps that compute an expression with numbered leaves, or kill where it holds."""
    expression = ast.parse(text, mode="eval").body
    steps: list[Step] = []
    if not killing:
        if isinstance(expression, ast.Name):
            return (("a", (_operand(expression.id),)),)
        _taken_apart(expression, steps)
        return tuple(steps)
    _without_specials(expression, steps)
    name, operands = _form(expression)
    if f"kill {name}" not in operations():
        name, operands = "a", [_taken_apart(expression, steps).id]
    return (*steps, (f"kill {name}", tuple(_operand(x) for x in operands)))


def _operand(name: str) -> int:
    """Return the number of a leaf, or the inverted one of a step."""
    return ~int(name[2:]) if name.startswith("_t") else int(name[1:])


def _form(expression: ast.expr) -> tuple[str, list[str]]:
    """Return an expression of letters, and what they stand for."""
    text = ast.unparse(expression)
    names = re.findall(r"\b_t?\d+\b", text)
    letters = iter(names and [*LETTERS, *[""] * len(names)])
    return re.sub(r"\b_t?\d+\b", lambda _: next(letters), text), names


def _taken_apart(expression: ast.expr, steps: list[Step]) -> ast.Name:
    """Add the steps that compute an expression; return the name of its value."""
    if isinstance(expression, ast.Name):
        return expression
    special = _special_name(expression)
    if not special:
        _without_specials(expression, steps)
    name, operands = _form(expression)
    if special or name not in forms():
        changed = False
        for place, of, child in _children(expression):
            if not isinstance(child, ast.Name):
                _replace(place, of, _taken_apart(child, steps))
                changed = True
        if not changed and not special:
            raise NoForm(name)
        if not special:
            return _taken_apart(expression, steps)
        name, operands = special, [child.id for _, _, child in _children(expression) if isinstance(child, ast.Name)]
    steps.append((name, tuple(_operand(x) for x in operands)))
    return ast.Name(f"_t{len(steps) - 1}")


def _without_specials(expression: ast.expr, steps: list[Step]) -> None:
    """Compute the special functions in an expression first, and put their values into their places."""
    for place, of, child in _children(expression):
        if _special_name(child):
            _replace(place, of, _taken_apart(child, steps))
        else:
            _without_specials(child, steps)


def _special_name(expression: ast.expr) -> str:
    """Return the name of the special function that is called, "" for anything else."""
    called = isinstance(expression, ast.Call) and isinstance(expression.func, ast.Name)
    name = ast.unparse(expression.func) if called else ""  # type: ignore[attr-defined]
    return name if name.startswith("special_") else ""


def _children(expression: ast.expr) -> Iterator[tuple[Any, int | str, ast.expr]]:
    """Return the parts of an expression, each with where it stands."""
    if isinstance(expression, ast.Call):
        yield from ((expression.args, k, part) for k, part in enumerate(expression.args))
    elif isinstance(expression, ast.BinOp):
        yield expression, "left", expression.left
        yield expression, "right", expression.right
    elif isinstance(expression, ast.UnaryOp):
        yield expression, "operand", expression.operand
    elif isinstance(expression, ast.Compare):
        yield expression, "left", expression.left
        yield from ((expression.comparators, k, part) for k, part in enumerate(expression.comparators))


def _replace(place: Any, of: int | str, part: ast.expr) -> None:
    if isinstance(of, int):
        place[of] = part
    else:
        setattr(place, of, part)


def formula_steps(function: SpecialFunction) -> tuple[list[tuple[str, str]], str]:
    """Return the formula of a special function, traced with symbols, in C: names with their values, and the result.

    Its arguments are a0, a1 and so on.
    """
    symbols = [ca.SX.sym(f"a{k}") for k in range(len(function.elasticity))]
    program = Program(symbols, [function.formula(*symbols)])
    steps: list[tuple[str, str]] = []
    names: dict[int, str] = {}
    for k in program.needed(program.outputs):
        node = program.nodes[k]
        args = [names[a] for a in node.args]
        truths = [f"({x} != 0.0)" for x in args]
        if node.op == ca.OP_INPUT:
            names[k] = f"a{int(node.constant)}"
            continue
        if node.op == ca.OP_CONST:
            value = f"all({_literal(node.constant)})"
        elif node.op == ca.OP_NOT:
            value = f"TRUTH(~{truths[0]})"
        elif node.op in (ca.OP_AND, ca.OP_OR):
            value = f"TRUTH({truths[0]} {'&' if node.op == ca.OP_AND else '|'} {truths[1]})"
        elif node.op in COMPARISONS:
            value = f"TRUTH({EXPRESSIONS[node.op].format(*args)})"
        elif node.op == OP_SELECT:
            value = f"choose({truths[0]}, {args[1]}, {args[2]})"
        elif node.op == ca.OP_IF_ELSE_ZERO:
            value = f"keep({truths[0]}, {args[1]})"
        else:
            value = EXPRESSIONS[node.op].format(*args)
        names[k] = f"x{k}"
        steps.append((names[k], value))
    result = names[program.outputs[0]]
    if function.above is not None:
        first, second = function.above
        result = f"choose(a{first} >= a{second}, {result}, all(NAN))"
    return steps, result


def _literal(value: float) -> str:
    if np.isnan(value):
        return "NAN"
    if np.isinf(value):
        return "INFINITY" if value > 0 else "-INFINITY"
    return repr(float(value))
