"""Faults of a declaration, each told with its source line and the function to use instead.

A symbol has no value while a problem is declared. Python and C code that asks it for one gets not-a-number from CasADi
(``math.sin``), or an error that says nothing to whoever wrote the formula (``max``): here both are a
:class:`DeclarationError`.
"""

from __future__ import annotations

import functools
import linecache
import math
import re
import sys
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from contextvars import ContextVar
from dataclasses import dataclass
from itertools import islice
from pathlib import Path
from types import CodeType, FrameType
from typing import Any

import casadi as ca
import numpy as np

from synth.errors import DeclarationError, InputError, shortened
from synth.operations.records import BY_TEXT
from synth.plugins import SHIPPED_FAMILIES

LIBRARIES = frozenset({"synth", "casadi", "numpy", "scipy", "pandas"}) | sys.stdlib_module_names
MOST_NAMES = 3  # that a message repeats
USUAL = "Python's arithmetic and NumPy functions of one value (np.sqrt, np.maximum, np.where ...)"
TEXTS = "numbers, part.says(column, text) for a cell of text, choice.select({label: ...}) for a label"
BOTH = "np.minimum and np.maximum, two at a time"
# Functions of `math` that NumPy has under the same name and symbols do not take, and all others.
INSTEAD = {name: f"np.{name}" for name in dir(math) if hasattr(np, name)} | {
    **{name: o.numeric.partition("(")[0] for name, o in BY_TEXT.items() if o.numeric.startswith("np.arc")},
    "pow": "the operator **",
    "dist": "np.hypot",
    "fsum": "sum",
    "sumprod": "np.dot",
    "erf": "casadi.erf",
    "erfc": "1 - casadi.erf(...)",
    **dict.fromkeys(("max", "amax", "nanmax"), "np.maximum"),
    **dict.fromkeys(("min", "amin", "nanmin"), "np.minimum"),
    **dict.fromkeys(("sort", "sorted", "median", "ptp", "percentile", "quantile", "argmax", "argmin"), BOTH),
    "any": "np.logical_or",
    "all": "np.logical_and",
    **dict.fromkeys(("float", "complex", "float64", "float32", "asarray"), "the expression as it is"),
    **dict.fromkeys(("int", "int64", "index", "range"), "np.floor, or d.count for a whole number that is searched"),
    "solve": "casadi.solve(casadi.SX(A), casadi.SX(b))",
    "inv": "casadi.inv(casadi.SX(A))",
    "det": "casadi.det(casadi.SX(A))",
    **dict.fromkeys(("interp1d", "CubicSpline", "interpn"), "np.interp, or a formula of the curve"),
    **dict.fromkeys(("quad", "solve_ivp", "odeint"), "a sum over fixed points, or the formula of the integral"),
    **dict.fromkeys(("brentq", "fsolve", "root", "root_scalar", "minimize"), "an unknown (d.variable) and d.equal"),
    "polyval": "the powers written out, c0 + c1*x + c2*x**2",
    **dict.fromkeys(("piecewise", "nan_to_num", "choose"), "np.where"),
    **dict.fromkeys(("isnan", "isinf", "isfinite"), "a guard, d.at_least(..., guard=True)"),
    **dict.fromkeys(("isclose", "allclose"), "a limit, d.equal"),
}
CALL = re.compile(r"(?:\w+\.)*(\w+)\s*\(")
WORD = re.compile(r"[^\W\d]\w*")
# What asks a condition for its truth, by how its line is written.
ASKING = (
    (re.compile(r"\bif\b|\belif\b|\bwhile\b"), "np.where(condition, a, b)"),
    (re.compile(r"\band\b"), "np.logical_and"),
    (re.compile(r"\bor\b"), "np.logical_or"),
    (re.compile(r"\bnot\b"), "np.logical_not"),
    (re.compile(r"\bin\b"), "np.logical_or of comparisons"),
    (re.compile(r"[<>]=?[^<>]*[<>]"), "np.logical_and(a < x, x < b)"),
    (re.compile(r"\bassert\b"), "a limit (d.at_least) or d.refuse"),
)


@dataclass(frozen=True)
class SourceLine:
    """A line of a family."""

    file: str
    number: int

    def __str__(self) -> str:
        text = linecache.getline(self.file, self.number).strip()
        place = f"{Path(self.file).name}, line {self.number}"
        return f"{place}: {shortened(text)}" if text else place


class _NoValue(TypeError):
    """A symbol or an expression of symbols was asked for its value."""

    def __init__(self, expression: ca.SX) -> None:
        super().__init__("a symbol has no value in a declaration")
        self.expression = expression


_declaring: ContextVar[bool] = ContextVar("declaring", default=False)


def _refused(convert: Callable[..., Any]) -> Callable[..., Any]:
    """Refuse a conversion of what holds symbols, while a problem is declared."""

    @functools.wraps(convert)
    def converted(expression: ca.SX, *arguments: Any) -> Any:
        if _declaring.get() and not expression.is_constant():
            raise _NoValue(expression)
        return convert(expression, *arguments)

    return converted


for _name in ("__float__", "__int__", "__bool__"):
    setattr(ca.SX, _name, _refused(getattr(ca.SX, _name)))


def _of_numbers(compare: Callable[..., Any]) -> Callable[..., Any]:
    """Refuse a comparison of symbols with a text, which is never true, while a problem is declared."""

    @functools.wraps(compare)
    def compared(expression: ca.SX, other: object) -> Any:
        if _declaring.get() and isinstance(other, str):
            names = ", ".join(_names(expression)[:MOST_NAMES]) or "a number"
            raise DeclarationError(f"{names} is compared with {other!r}, a text; use {TEXTS}")
        return compare(expression, other)

    return compared


for _name in ("__eq__", "__ne__"):
    setattr(ca.SX, _name, _of_numbers(getattr(ca.SX, _name)))


@contextmanager
def declaring(problem: str) -> Iterator[None]:
    """Tell what goes wrong in a declaration as a fault of the family, with its line.

    Raises
    ------
    DeclarationError
        A verb refuses what is declared, a symbol is asked for its value, or the code of the family raises an error.
    """
    token = _declaring.set(True)
    try:
        yield
    except InputError:
        raise
    except Exception as error:
        fault = _fault(problem, error)
        if fault is None:
            raise
        raise fault from error
    finally:
        _declaring.reset(token)


def line_of_verb() -> SourceLine | None:
    """Line of the family that is being run; None where no family is."""
    frame: FrameType | None = sys._getframe(1)
    while frame is not None:
        if _is_of_family(frame):
            return SourceLine(frame.f_code.co_filename, frame.f_lineno)
        frame = frame.f_back
    return None


def _is_of_family(frame: FrameType) -> bool:
    name = str(frame.f_globals.get("__name__", ""))
    return name.startswith(f"{SHIPPED_FAMILIES}.") or name.partition(".")[0] not in LIBRARIES


def _fault(problem: str, error: Exception) -> DeclarationError | None:
    """Fault of the family behind an error; None where its line is known already, or no line of a family raised it."""
    trace, innermost = error.__traceback__, None
    while trace is not None:
        innermost = trace if _is_of_family(trace.tb_frame) else innermost
        trace = trace.tb_next
    if innermost is None or (isinstance(error, DeclarationError) and error.line is not None):
        return None
    line = SourceLine(innermost.tb_frame.f_code.co_filename, innermost.tb_lineno)
    if isinstance(error, DeclarationError):
        return DeclarationError(str(error), line)
    frame, source = innermost.tb_frame, linecache.getline(line.file, line.number)
    segment = _segment(frame.f_code, innermost.tb_lasti) or source.strip()
    names = _names(error.expression) if isinstance(error, _NoValue) else _names(*_operands(segment, frame))
    if not names:
        return DeclarationError(f"{problem}: {type(error).__name__}: {_first_line(error)}", line)
    shown = shortened(" ".join(segment.split()))
    of = ", ".join(names[:MOST_NAMES]) + (" ..." if len(names) > MOST_NAMES else "")
    if isinstance(error, _NoValue) or "truth value" in str(error):
        fault = f"{shown} asks for the value of {of}, which is not known in a declaration"
    else:
        fault = f"{shown} does not take {of}, a symbol without a value ({_first_line(error)})"
    return DeclarationError(f"{problem}: {fault}; use {_instead(segment, source)}", line)


def _segment(code: CodeType, instruction: int) -> str:
    """Source text of the expression that an instruction belongs to; empty where it cannot be had."""
    first, last, start, end = next(islice(code.co_positions(), instruction // 2, None), (None,) * 4)
    if first is None or last is None or start is None or end is None:
        return ""
    lines = [linecache.getline(code.co_filename, number).encode() for number in range(first, last + 1)]
    lines[-1] = lines[-1][:end]  # columns are counted in bytes
    lines[0] = lines[0][start:]
    return b"".join(lines).decode(errors="replace")


def _instead(segment: str, line: str) -> str:
    """Words for what to write instead of an expression that asks a symbol for its value."""
    called = CALL.match(segment)
    if called is not None and called[1] in INSTEAD:
        return INSTEAD[called[1]]
    return next((instead for asks, instead in ASKING if called is None and asks.search(line)), USUAL)


def _operands(segment: str, frame: FrameType) -> Iterator[Any]:
    """Values of the variables that a piece of source text names."""
    for word in dict.fromkeys(WORD.findall(segment)):
        scope: Mapping[str, Any] = frame.f_locals if word in frame.f_locals else frame.f_globals
        if word in scope:
            yield scope[word]


def _names(*values: Any) -> list[str]:
    """Names of the symbols in expressions, also in lists and arrays of these."""
    names: dict[str, None] = {}
    for value in values:
        if isinstance(value, ca.SX):
            names |= dict.fromkeys(str(symbol) for symbol in ca.symvar(value))
        elif isinstance(value, (list, tuple)) or (isinstance(value, np.ndarray) and value.dtype == object):
            names |= dict.fromkeys(_names(*value))
    return list(names)


def _first_line(error: Exception) -> str:
    return shortened(next(iter(str(error).strip().splitlines()), type(error).__name__))
