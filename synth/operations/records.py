"""The records of all elementary operations."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np

from synth.operations import enclosures as e
from synth.operations.record import INF, NO_TRAIT, BackwardRule, Domain, Elasticity, Enclosure, InCell, Nodes, Operation
from synth.operations.record import Trait as T

HALF_TURN, QUARTER = float(np.pi), float(np.pi) / 2
LARGEST_EXPONENT = 700.0  # e to the power of more is no finite number

ABOVE_ZERO, FROM_ZERO, FROM_ONE = Domain(0.0, INF, open=True), Domain(0.0, INF), Domain(1.0, INF)
UNIT, INSIDE_UNIT, ABOVE_MINUS_ONE = Domain(-1.0, 1.0), Domain(-1.0, 1.0, open=True), Domain(-1.0, INF, open=True)
FINITE_POWER = Domain(-INF, LARGEST_EXPONENT, open=True)
FINITE_HALVES = Domain(-LARGEST_EXPONENT, LARGEST_EXPONENT, open=True)

STEADY, SIZE = T.STAYS_INFINITE | T.ROUNDS_WELL, T.NEVER_NEGATIVE | T.STAYS_INFINITE


def _operation(
    name: str, numeric: str, enclosure: Enclosure | None, *backward: BackwardRule | None, **known: Any
) -> Operation:
    """An operation that trees have a form of their own for, if nothing else is told."""
    known = {"text": "", "scalar": None, "domain": None, "instruction": name} | known
    return Operation(name=name, numeric=numeric, enclosure=enclosure, backward=backward, **known)


def _function(
    name: str,
    scalar: Callable[..., float],
    function: Callable[..., Any],
    enclosure: Enclosure,
    back: BackwardRule | None = None,
    text: str = "",
    **known: Any,
) -> Operation:
    """A function of one argument that NumPy has, and trees, if nothing else is told under the same name."""
    numeric = f"np.{function.__name__}({{0}})"
    text = text or name.lower()
    return _operation(name, numeric, enclosure, back, text=text, scalar=scalar, function=function, **known)


def _rising(
    name: str,
    scalar: Callable[..., float],
    function: Callable[..., Any],
    back: BackwardRule | None = None,
    domain: Domain | None = None,
    **known: Any,
) -> Operation:
    """A function of one argument that rises wherever it is defined."""
    enclosure = e.monotone(function) if domain is None else e.on_domain(function, domain)
    return _function(name, scalar, function, enclosure, back, domain=domain, **known)


def _pair(
    name: str, scalar: Callable[..., float], function: Callable[..., Any], enclosure: Enclosure | None, **known: Any
) -> Operation:
    """A function of two arguments that NumPy has, with one rule backward for both."""
    back, known = known.pop("back", None), {"text": name.lower()} | known
    numeric = f"np.{function.__name__}({{0}}, {{1}})"
    return _operation(name, numeric, enclosure, back, back, scalar=scalar, function=function, **known)


def _size_of(name: str) -> Callable[[Nodes, int, int], int]:
    """The size of another function of the same argument."""
    return lambda nodes, k, a: nodes.size(nodes.put(name, a))


def _odd(elasticity: Elasticity) -> dict[str, Any]:
    """What is known of a function that only changes its sign with that of its argument."""
    return {"elasticity": elasticity, "mirrored": replace(elasticity, sign=-1)}


def _even(elasticity: Elasticity) -> dict[str, Any]:
    """What is known of a function that is the same for both signs of its argument."""
    return {"elasticity": elasticity, "mirrored": elasticity}


def _condition(
    name: str, function: str, text: str, scalar: Callable[..., bool], enclosure: Enclosure, traits: T = NO_TRAIT
) -> Operation:
    """A comparison, or conditions joined."""
    numeric, traits = f"np.{function}({{0}}, {{1}}).astype(float)", T.TRUTH | T.NEVER_NEGATIVE | traits
    return _operation(name, numeric, enclosure, None, None, text=text, scalar=scalar, instruction="", traits=traits)


def _sign(x: float) -> float:
    return math.nan if math.isnan(x) else float((x > 0) - (x < 0))


def _least(*x: float) -> float:
    return math.nan if any(map(math.isnan, x)) else min(x)


def _most(*x: float) -> float:
    return math.nan if any(map(math.isnan, x)) else max(x)


def _at_most_one(nodes: Nodes, k: int, a: int) -> int:
    return nodes.number(1.0)


def _by(name: str) -> Callable[[Nodes, int, int], int]:
    """Another function of the same argument."""
    return lambda nodes, k, a: nodes.put(name, a)


MUL = STEADY | T.KEEPS_SIGN | T.COMMUTES
ARITHMETIC = (
    _operation(
        "ADD",
        "({0} + {1})",
        e.add,
        lambda r, a, b: e.widened(e.subtract(r, b), r, b),
        lambda r, a, b: e.widened(e.subtract(r, a), r, a),
        traits=STEADY | T.KEEPS_SIGN | T.ADDS | T.COMMUTES,
    ),
    _operation(
        "SUB",
        "({0} - {1})",
        e.subtract,
        lambda r, a, b: e.widened(e.add(r, b), r, b),
        lambda r, a, b: e.widened(e.subtract(a, r), a, r),
        traits=STEADY | T.ADDS,
    ),
    _operation(
        "MUL", "({0} * {1})", e.multiply, lambda r, a, b: e.quotient(r, b), lambda r, a, b: e.quotient(r, a), traits=MUL
    ),
    _operation(
        "DIV",
        "({0} / {1})",
        e.divide,
        lambda r, a, b: e.multiply(r, b),
        lambda r, a, b: e.quotient(a, r),
        traits=T.DIVIDES | T.KEEPS_SIGN | T.STAYS_INFINITE,
    ),
    _operation("NEG", "(-{0})", e.negate, lambda r, a: e.negate(r), exponent=1.0, traits=STEADY),
    _operation(
        "TWICE", "(2.0 * {0})", e.scaled(2.0), e.scaled(0.5), instruction="", exponent=1.0, traits=STEADY | T.KEEPS_SIGN
    ),
)
LENGTH = SIZE | T.ADDS | T.COMMUTES | T.KEEPS_UNIT
POWERS = (
    _operation(
        "SQ", "({0} * {0})", e.square, e.back_square, instruction="", exponent=2.0, traits=STEADY | T.NEVER_NEGATIVE
    ),
    _operation(
        "INV",
        "(1.0 / {0})",
        e.invert,
        lambda r, a: e.quotient((1.0, 1.0), r),
        instruction="",
        exponent=-1.0,
        slope=lambda nodes, k, a: nodes.put("SQ", k),
        traits=T.DIVIDES | T.KEEPS_SIGN,
    ),
    _rising("SQRT", math.sqrt, np.sqrt, e.back_root, FROM_ZERO, exponent=0.5, traits=STEADY | T.NEVER_NEGATIVE),
    _operation("POW", "({0} ** {1})", e.power, e.back_power, None),
    _operation("CONSTPOW", "({0} ** {1})", e.power, e.back_power, None, instruction="POW"),
    _rising(
        "EXP",
        math.exp,
        np.exp,
        e.back_exp,
        finite=FINITE_POWER,
        elasticity=Elasticity((0.0, INF), lambda y: y, 0.0, INF),
        mirrored=Elasticity((0.0, INF), lambda y: -y, 0.0, -INF),
        slope=_by("EXP"),
        traits=T.NEVER_NEGATIVE | T.ROUNDS_WELL,
    ),
    _rising(
        "EXPM1",
        math.expm1,
        np.expm1,
        e.back_expm1,
        finite=FINITE_POWER,
        elasticity=Elasticity((0.0, INF), lambda y: y / -np.expm1(-y), 1.0, INF),
        mirrored=Elasticity((0.0, INF), lambda y: y / np.expm1(y), 1.0, 0.0, sign=-1),
        slope=_by("EXP"),
        traits=T.KEEPS_SIGN,
        plain=("exp", 0.0, -1.0),
        # Far from 1 nothing is lost, and the logarithm of nothing does not exist.
        sheet=InCell(
            "IF({power:cell}=1,{0:cell},IF(OR({power:cell}<0.5,{power:cell}>2),{power:cell}-1,"
            "({power:cell}-1)*{0:cell}/LN({power:cell})))"
        ),
    ),
    _rising(
        "LOG",
        math.log,
        np.log,
        lambda r, a: (np.exp(r[0]), np.exp(r[1])),
        ABOVE_ZERO,
        text="ln",
        elasticity=Elasticity((1.0, INF), lambda y: 1 / np.log(y), INF, 0.0),
        slope=_size_of("INV"),
        traits=T.CROSSES_ZERO | T.STAYS_INFINITE,
    ),
    _rising(
        "LOG1P",
        math.log1p,
        np.log1p,
        lambda r, a: (np.expm1(r[0]), np.expm1(r[1])),
        ABOVE_MINUS_ONE,
        elasticity=Elasticity((0.0, INF), lambda y: y / ((1 + y) * np.log1p(y)), 1.0, 0.0),
        mirrored=Elasticity((0.0, 1.0), lambda y: -y / ((1 - y) * np.log1p(-y)), 1.0, INF, sign=-1),
        slope=lambda nodes, k, a: nodes.size(nodes.put("INV", nodes.put("ADD", nodes.number(1.0), a))),
        traits=T.KEEPS_SIGN | T.STAYS_INFINITE,
        plain=("ln", 1.0, 0.0),
        # W. Kahan: what is lost in 1 + x is lost in (1 + x) - 1 as well, so that their quotient mends it.
        sheet=InCell("IF(1+{0:cell}=1,{0:cell},LN(1+{0:cell})*{0:cell}/((1+{0:cell})-1))"),
    ),
    _pair("HYPOT", math.hypot, np.hypot, e.length, traits=LENGTH, sheet=InCell("SQRT({0:base}^2+{1:base}^2)")),
)
# The size of the logarithm of less than 1, which is negative.
LOG_BELOW_ONE = Elasticity((0.0, 1.0), lambda y: 1 / np.log(y), 0.0, -INF, sign=-1)

SINE = Elasticity((0.0, HALF_TURN), lambda y: y / np.tan(y), 1.0, -INF)
COSINE = Elasticity((0.0, QUARTER), lambda y: -y * np.tan(y), 0.0, -INF)
TANGENT = Elasticity((0.0, QUARTER), lambda y: 2 * y / np.sin(2 * y), 1.0, INF)
ARC_SINE = Elasticity((0.0, 1.0), lambda y: y / (np.sqrt(1 - y * y) * np.arcsin(y)), 1.0, INF)
ARC_COSINE = Elasticity((0.0, 1.0), lambda y: -y / (np.sqrt(1 - y * y) * np.arccos(y)), 0.0, -INF)
ARC_TANGENT = Elasticity((0.0, INF), lambda y: y / ((1 + y * y) * np.arctan(y)), 1.0, 0.0)
WAVES = (
    _function(
        "SIN", math.sin, np.sin, e.periodic(np.sin, QUARTER), slope=_size_of("COS"), traits=T.CROSSES_ZERO, **_odd(SINE)
    ),
    _function(
        "COS", math.cos, np.cos, e.periodic(np.cos, 0.0), slope=_size_of("SIN"), traits=T.CROSSES_ZERO, **_even(COSINE)
    ),
    _function(
        "TAN",
        math.tan,
        np.tan,
        e.tangent,
        slope=lambda nodes, k, a: nodes.put("ADD", nodes.number(1.0), nodes.put("SQ", k)),
        traits=T.CROSSES_ZERO,
        **_odd(TANGENT),
    ),
    _rising("ASIN", math.asin, np.arcsin, domain=UNIT, **_odd(ARC_SINE)),
    _function("ACOS", math.acos, np.arccos, e.arc_cosine, domain=UNIT, elasticity=ARC_COSINE, traits=T.NEVER_NEGATIVE),
    _rising("ATAN", math.atan, np.arctan, slope=_at_most_one, traits=T.KEEPS_SIGN, **_odd(ARC_TANGENT)),
    # Mathematics has the height first, spreadsheets the length.
    _pair("ATAN2", math.atan2, np.arctan2, e.angle, sheet=InCell("ATAN2({1},{0})")),
)
HYPERBOLIC_SINE = Elasticity((0.0, INF), lambda y: y / np.tanh(y), 1.0, INF)
HYPERBOLIC_COSINE = Elasticity((0.0, INF), lambda y: y * np.tanh(y), 0.0, INF)
HYPERBOLIC_TANGENT = Elasticity((0.0, INF), lambda y: 2 * y / np.sinh(2 * y), 1.0, 0.0)
AREA_SINE = Elasticity((0.0, INF), lambda y: y / (np.sqrt(1 + y * y) * np.arcsinh(y)), 1.0, 0.0)
AREA_COSINE = Elasticity((1.0, INF), lambda y: y / (np.sqrt(y * y - 1) * np.arccosh(y)), INF, 0.0)
AREA_TANGENT = Elasticity((0.0, 1.0), lambda y: y / ((1 - y * y) * np.arctanh(y)), 1.0, INF)
UNBOUNDED = T.KEEPS_SIGN | T.STAYS_INFINITE
HYPERBOLIC = (
    _rising(
        "SINH", math.sinh, np.sinh, finite=FINITE_HALVES, slope=_by("COSH"), traits=UNBOUNDED, **_odd(HYPERBOLIC_SINE)
    ),
    _function(
        "COSH", math.cosh, np.cosh, e.hyperbolic_cosine, finite=FINITE_HALVES, traits=SIZE, **_even(HYPERBOLIC_COSINE)
    ),
    _rising("TANH", math.tanh, np.tanh, slope=_at_most_one, traits=T.KEEPS_SIGN, **_odd(HYPERBOLIC_TANGENT)),
    _rising("ASINH", math.asinh, np.arcsinh, slope=_at_most_one, traits=UNBOUNDED, **_odd(AREA_SINE)),
    _rising("ACOSH", math.acosh, np.arccosh, domain=FROM_ONE, elasticity=AREA_COSINE),
    _rising("ATANH", math.atanh, np.arctanh, domain=INSIDE_UNIT, **_odd(AREA_TANGENT)),
    # Its slope is 1.13 at most.
    _operation("ERF", "erf({0})", None, None, text="erf", scalar=math.erf, slope=_at_most_one, traits=T.KEEPS_SIGN),
)
STEPS = T.KEEPS_SIGN | T.KEEPS_UNIT
EXTREME = T.KEEPS_SIGN | T.ROUNDS_WELL | T.COMMUTES | T.KEEPS_UNIT
COPIED_SIGN = InCell("IF({1:term}<0,-ABS({0}),ABS({0}))")
CHOICES = (
    _rising("FLOOR", lambda x: float(math.floor(x)), np.floor, traits=STEPS, sheet=InCell("INT({0})")),
    _rising("CEIL", lambda x: float(math.ceil(x)), np.ceil, traits=STEPS, sheet=InCell("-INT({negative})", "term")),
    _rising("SIGN", _sign, np.sign, traits=T.KEEPS_SIGN),
    _function(
        "FABS", abs, np.abs, e.magnitude, e.back_abs, "abs", instruction="ABS", exponent=1.0, traits=SIZE | T.KEEPS_UNIT
    ),
    _pair("FMIN", _least, np.minimum, e.least, back=e.above, text="min", instruction="MIN", traits=EXTREME),
    _pair("FMAX", _most, np.maximum, e.largest, back=e.below, text="max", instruction="MAX", traits=EXTREME),
    _pair(
        "FMOD",
        math.fmod,
        np.fmod,
        None,
        traits=T.DIVIDES | T.KEEPS_UNIT,
        sheet=InCell("{0:divisor}-{1:divisor}*TRUNC({0:divisor}/{1:divisor})", "factor"),  # MOD: sign of the divisor
    ),
    _pair("COPYSIGN", math.copysign, np.copysign, None, traits=T.KEEPS_UNIT, sheet=COPIED_SIGN),
    _operation(
        "IF_ELSE_ZERO", "np.where({0}, {1}, 0.0)", e.or_zero, None, e.back_yes, instruction="", traits=T.KEEPS_SIGN
    ),
    # CasADi writes where(c, a, b) as (c ? a : 0) + (!c ? b : 0); read back as one operation, the value is known to be
    # one of two, not the sum of two.
    _operation("SELECT", "np.where({0}, {1}, {2})", e.chosen, None, e.back_yes, e.back_no, instruction=""),
)
CONDITIONS = (
    _condition("LT", "less", "<", lambda a, b: a < b, e.less),
    _condition("LE", "less_equal", "<=", lambda a, b: a <= b, e.at_most),
    _condition("EQ", "equal", "==", lambda a, b: a == b, e.equal, T.COMMUTES),
    _condition("NE", "not_equal", "!=", lambda a, b: a != b, e.unequal, T.COMMUTES),
    _condition("AND", "logical_and", "and", lambda a, b: bool(a and b), e.both, T.COMMUTES),
    _condition("OR", "logical_or", "or", lambda a, b: bool(a or b), e.largest, T.COMMUTES),
    _operation(
        "NOT",
        "np.logical_not({0}).astype(float)",
        e.opposite,
        None,
        text="not",
        scalar=lambda a: not a,
        instruction="",
        traits=T.TRUTH | T.NEVER_NEGATIVE,
    ),
)
BY_NAME = {o.name: o for o in (*ARITHMETIC, *POWERS, *WAVES, *HYPERBOLIC, *CHOICES, *CONDITIONS)}
BY_TEXT = {o.text: o for o in BY_NAME.values() if o.text and T.TRUTH not in o.traits}  # as trees call functions
UNKNOWN = _operation("UNKNOWN", "{0}", None, None)


def function_of(text: str) -> Operation:
    """What is known of a function of a tree; nothing, where a tree from elsewhere calls one that is none."""
    return BY_TEXT.get(text, UNKNOWN)
