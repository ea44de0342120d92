"""The instructions that tighten boxes: one list for all readers, over numbered registers.

An instruction is a row of numbers: what is done, the register of the result, and those of the operands. NumPy carries
it out by the functions given here (:mod:`synth.bounds.array_reader`), the kernel by the case of the same name in
``box_cases.h``. Both ends of a node stand side by side, the lower one first.
"""

from __future__ import annotations

import operator
from collections.abc import Callable
from dataclasses import dataclass
from enum import IntEnum, auto
from typing import Any

import casadi as ca
import numpy as np

from synth.bounds.intervals import BACKWARD, FORWARD, loosened
from synth.model.program import OP_SELECT, OPERATIONS
from synth.operations.enclosures import unbounded
from synth.operations.record import Interval
from synth.order.margins import Numbers

WIDTH = 6  # of an instruction: what is done, where the result goes, and up to four operands
Row = tuple[int, ...]


class Op(IntEnum):
    """What an instruction does; the rules for enclosures, :data:`RULES`, are numbered after these."""

    END = 0
    END_IF_DEAD = auto()
    HOLD = auto()
    IN_ORDER = auto()
    # Runs of instructions as one: :mod:`synth.bounds.fused_instructions`.
    PRODUCT_BACK = auto()
    QUOTIENT_BACK = auto()
    SUM_BACK = auto()
    DIFFERENCE_BACK = auto()
    AT_MOST = auto()
    AT_LEAST = auto()
    SUM = auto()
    DIFFERENCE = auto()
    TERM_BACK = auto()
    ROOT = auto()
    MEET = auto()
    CROSSED = auto()
    # Numbers.
    MOVE = auto()
    ADD = auto()
    SUB = auto()
    MUL = auto()
    DIV = auto()
    POW = auto()
    FMOD = auto()
    COPYSIGN = auto()
    ATAN2 = auto()
    HYPOT = auto()
    MIN = auto()
    MAX = auto()
    NEG = auto()
    EXP = auto()
    LOG = auto()
    SQRT = auto()
    SIN = auto()
    COS = auto()
    TAN = auto()
    ASIN = auto()
    ACOS = auto()
    ATAN = auto()
    FLOOR = auto()
    CEIL = auto()
    ABS = auto()
    SIGN = auto()
    ERF = auto()
    SINH = auto()
    COSH = auto()
    TANH = auto()
    ASINH = auto()
    ACOSH = auto()
    ATANH = auto()
    LOG1P = auto()
    EXPM1 = auto()
    MUL_SUB = auto()  # a b - c
    MUL_SUM = auto()  # a (b + c)
    ADD_SUB_MUL = auto()  # a + b - c d
    ADD_ADD_MUL = auto()
    SUB_SUB_MUL = auto()
    SUB_ADD_MUL = auto()
    LOOSEN_UP = auto()  # a limit, its least size, and the share of its size by which it moves
    LOOSEN_DOWN = auto()
    # Ends that are met with what is known of them: of a number and not-a-number, the number.
    FMAX = auto()
    FMAX_MUL = auto()
    FMAX_DIV = auto()
    FMAX_MUL_SUB = auto()
    FMAX_SQRT = auto()
    FMIN = auto()
    FMIN_MUL = auto()
    FMIN_DIV = auto()
    FMIN_MUL_SUB = auto()
    FMIN_SQRT = auto()
    # Masks, and what reads them.
    GT = auto()
    LT = auto()
    GE = auto()
    LE = auto()
    EQ = auto()
    NE = auto()
    GT_MUL = auto()  # a > b c
    LT_MUL = auto()
    NOT = auto()
    AND = auto()
    OR = auto()
    CHOOSE = auto()
    KEEP = auto()
    TRUTH = auto()
    # Boxes die where a condition holds.
    KILL_ABOVE = auto()
    KILL_BELOW = auto()
    KILL_CROSSED = auto()  # a > b + c d
    # Both ends of a node, each from two operands; met with what is known of them.
    ENDS_ADD = auto()
    ENDS_SUB = auto()
    ENDS_MUL = auto()
    ENDS_DIV = auto()
    MET_ADD = auto()
    MET_SUB = auto()
    MET_MUL = auto()
    MET_DIV = auto()


def _erf(x: Numbers) -> Any:
    from scipy.special import erf  # costly to import; few formulas name it

    return erf(x)


# Value of the result from those of the operands.
VALUES: dict[int, Callable[..., Any]] = {
    **{Op[known.instruction]: known.function for known in OPERATIONS.values() if known.function and known.instruction},
    Op.MOVE: lambda a: a,
    Op.ADD: operator.add,
    Op.SUB: operator.sub,
    Op.MUL: operator.mul,
    Op.DIV: operator.truediv,
    Op.POW: operator.pow,
    Op.NEG: operator.neg,
    Op.ERF: _erf,
    Op.MUL_SUB: lambda a, b, c: a * b - c,
    Op.MUL_SUM: lambda a, b, c: a * (b + c),
    Op.ADD_SUB_MUL: lambda a, b, c, d: a + b - c * d,
    Op.ADD_ADD_MUL: lambda a, b, c, d: a + b + c * d,
    Op.SUB_SUB_MUL: lambda a, b, c, d: a - b - c * d,
    Op.SUB_ADD_MUL: lambda a, b, c, d: a - b + c * d,
    Op.LOOSEN_UP: loosened,
    Op.LOOSEN_DOWN: lambda limit, size, share: loosened(limit, size, -share),
    Op.FMAX: np.fmax,
    Op.FMAX_MUL: lambda a, b, c: np.fmax(a, b * c),
    Op.FMAX_DIV: lambda a, b, c: np.fmax(a, b / c),
    Op.FMAX_MUL_SUB: lambda a, b, c, d: np.fmax(a, b * c - d),
    Op.FMAX_SQRT: lambda a, b: np.fmax(a, np.sqrt(b)),
    Op.FMIN: np.fmin,
    Op.FMIN_MUL: lambda a, b, c: np.fmin(a, b * c),
    Op.FMIN_DIV: lambda a, b, c: np.fmin(a, b / c),
    Op.FMIN_MUL_SUB: lambda a, b, c, d: np.fmin(a, b * c - d),
    Op.FMIN_SQRT: lambda a, b: np.fmin(a, np.sqrt(b)),
    Op.GT: operator.gt,
    Op.LT: operator.lt,
    Op.GE: operator.ge,
    Op.LE: operator.le,
    Op.EQ: operator.eq,
    Op.NE: operator.ne,
    Op.GT_MUL: lambda a, b, c: a > b * c,
    Op.LT_MUL: lambda a, b, c: a < b * c,
    Op.NOT: np.logical_not,
    Op.AND: np.logical_and,
    Op.OR: np.logical_or,
    Op.CHOOSE: np.where,
    Op.KEEP: lambda mask, a: np.where(mask, a, 0.0),
    Op.TRUTH: lambda mask: np.where(mask, 1.0, 0.0),
}
CONDITIONS: dict[int, Callable[..., Any]] = {
    Op.KILL_ABOVE: operator.gt,
    Op.KILL_BELOW: operator.lt,
    Op.KILL_CROSSED: lambda a, b, c, d: a > b + c * d,
}
# Both ends from two operands each.
ENDS: dict[int, Callable[[Any, Any], Any]] = {
    Op.ENDS_ADD: operator.add,
    Op.ENDS_SUB: operator.sub,
    Op.ENDS_MUL: operator.mul,
    Op.ENDS_DIV: operator.truediv,
}
MET: dict[int, Callable[[Any, Any], Any]] = {
    Op.MET_ADD: operator.add,
    Op.MET_SUB: operator.sub,
    Op.MET_MUL: operator.mul,
    Op.MET_DIV: operator.truediv,
}

# An operation of a formula -> the instruction that computes it; the others take two: box_emitter.
ELEMENTARY = {op: Op[known.instruction] for op, known in OPERATIONS.items() if known.instruction}
COMPARED: dict[int, Op] = {ca.OP_LT: Op.LT, ca.OP_LE: Op.LE, ca.OP_EQ: Op.EQ, ca.OP_NE: Op.NE}
OP_NAMES: dict[int, str] = {
    **{getattr(ca, name): name.removeprefix("OP_") for name in dir(ca) if name.startswith("OP_")},
    OP_SELECT: "SELECT",
}
POWERS = (ca.OP_POW, ca.OP_CONSTPOW)


@dataclass(frozen=True)
class EnclosureRule:
    """Both ends of a node from both ends of others.

    ``enclosure`` takes intervals; None where nothing is known.
    """

    name: str
    enclosure: Callable[..., Interval | None]


def _rules() -> list[EnclosureRule]:
    forward = [EnclosureRule(f"FORWARD_{OP_NAMES[op]}", rule) for op, rule in FORWARD.items() if op not in POWERS]
    backward = [
        EnclosureRule(f"BACKWARD_{OP_NAMES[op]}_{i}", rule)
        for op, rules in BACKWARD.items()
        for i, rule in enumerate(rules)
        if rule and op not in POWERS
    ]
    # The kernel has a rule for an exponent that is the same for all boxes, and one for any other.
    powers = [EnclosureRule(f"FORWARD_{name}", FORWARD[ca.OP_POW]) for name in ("POW_CONSTANT", "POW_ANY")]
    base = BACKWARD[ca.OP_POW][0]
    assert base is not None
    unknown = [EnclosureRule(f"WHOLE_{count}", unbounded) for count in (1, 2, 3)]
    return [*forward, *powers, *unknown, *backward, EnclosureRule("BACKWARD_POW_CONSTANT", base)]


RULES: dict[int, EnclosureRule] = {len(Op) + k: rule for k, rule in enumerate(_rules())}
RULE_NUMBERS: dict[str, int] = {rule.name: number for number, rule in RULES.items()}


def labels() -> list[str]:
    """Names of all operations in the order of their numbers."""
    return [*(op.name for op in Op), *RULE_NUMBERS]


@dataclass(frozen=True)
class Regions:
    """First register of each region.

    First what boxes bring and what is computed of them, in the order in which it stands in the file; ``scratch`` are
    registers on the way, ``literals`` numbers of the instructions, and ``count`` is the number of all registers.
    """

    constants: int
    right_sides: int
    cutoffs: int
    floors: int
    tables: int
    variables: int
    inner: int
    open: int
    goals: int
    scratch: int
    literals: int
    count: int


@dataclass(frozen=True)
class InstructionList:
    """The instructions of one sign pattern, and what they read and give.

    Parameters
    ----------
    first, later, last : list of Row
        Of the first forward-backward sweep, of one that follows, and what is read off at the end.
    regions : Regions
    literals : array
        Numbers of the instructions.
    variables : list of int
        Which variable each pair of the region of variables is.
    constants, tables, limits, goals : int
        How many.
    """

    first: tuple[Row, ...]
    later: tuple[Row, ...]
    last: tuple[Row, ...]
    regions: Regions
    literals: np.ndarray
    variables: tuple[int, ...]
    constants: int
    tables: int
    limits: int
    goals: int
