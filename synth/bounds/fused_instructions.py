"""Runs of instructions that stand together for every node of a kind, as one instruction each.

An instruction costs the kernel about as much to begin as to carry out for two registers. The operations, and with them
all bits of results, stay the same; only registers for what is passed on within a run are no longer written.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import NamedTuple

import numpy as np

from synth.bounds.instructions import WIDTH, Op, Row


class Run(NamedTuple):
    """Instructions in a row, and the operands of the one that takes their place.

    Registers are letters; ``x+`` is the one after ``x``, its upper end. The target is that of ``x``.

    Parameters
    ----------
    steps : tuple of (operation, registers)
        The first register is the target.
    operands : str
        Letters.
    """

    steps: tuple[tuple[Op, str], ...]
    operands: str


MEET = ((Op.FMAX, "x x s"), (Op.FMIN, "x+ x+ s+"))
MET_OTHER = ((Op.FMAX, "y y s"), (Op.FMIN, "y+ y+ t"))
# Longer runs first: they begin like shorter ones.
RUNS: dict[Op, Run] = {
    Op.PRODUCT_BACK: Run(((Op.DIV, "s k x+"), (Op.DIV, "t k+ x"), (Op.MET_DIV, "x k y+ k+ y"), *MET_OTHER), "k y"),
    Op.QUOTIENT_BACK: Run(((Op.DIV, "s x k+"), (Op.DIV, "t x+ k"), (Op.MET_MUL, "x k y k+ y+"), *MET_OTHER), "k y"),
    Op.SUM_BACK: Run(
        (
            (Op.MUL_SUB, "s k l x+"),
            (Op.MUL_SUB, "t k+ m x"),
            (Op.FMAX_MUL_SUB, "x x k l y+"),
            (Op.FMIN_MUL_SUB, "x+ x+ k+ m y"),
            *MET_OTHER,
        ),
        "k y l m",
    ),
    Op.DIFFERENCE_BACK: Run(
        ((Op.MUL_SUB, "s x l k+"), (Op.MUL_SUB, "t x+ m k"), (Op.MET_ADD, "x k y k+ y+"), *MET_OTHER), "k y l m"
    ),
    Op.AT_MOST: Run(((Op.MUL, "s b c"), (Op.KILL_ABOVE, "z x s"), (Op.FMIN, "x+ x+ s"), (Op.GT, "o x+ d")), "b c o d"),
    Op.AT_LEAST: Run(((Op.MUL, "s b c"), (Op.KILL_BELOW, "z x+ s"), (Op.FMAX, "x x s"), (Op.LT, "o x d")), "b c o d"),
    Op.SUM: Run(
        ((Op.ADD_SUB_MUL, "s a b c a"), (Op.FMAX, "x x s"), (Op.ADD_ADD_MUL, "s a+ b+ c a+"), (Op.FMIN, "x+ x+ s")),
        "a b c",
    ),
    Op.DIFFERENCE: Run(
        ((Op.SUB_SUB_MUL, "s a b+ c a"), (Op.FMAX, "x x s"), (Op.SUB_ADD_MUL, "s a+ b c a+"), (Op.FMIN, "x+ x+ s")),
        "a b c",
    ),
    Op.TERM_BACK: Run(((Op.FMAX_MUL_SUB, "x x k l y+"), (Op.FMIN_MUL_SUB, "x+ x+ k+ m y")), "k y l m"),
    Op.ROOT: Run(((Op.FMAX_SQRT, "x x a"), (Op.FMIN_SQRT, "x+ x+ a+")), "a"),
    Op.MEET: Run(MEET, "s"),
    Op.CROSSED: Run(((Op.KILL_CROSSED, "z x x+ c x+"),), "c"),
}
# Instructions for one node that serve several nodes side by side: how many is their first operand.
REPEATED = (Op.IN_ORDER, Op.CROSSED)

Steps = list[tuple[Op, list[str]]]


def fused(rows: Sequence[Row]) -> np.ndarray:
    """Instructions with runs taken together, as the kernel reads them: array (instructions, WIDTH)."""
    filled = [(*row, *[0] * (WIDTH - len(row))) for row in rows]
    return np.array(list(_repeated(list(_fused(filled)))), dtype=np.intc)


def _by_first() -> dict[int, list[tuple[Op, Steps, list[str]]]]:
    """Runs by the operation that they begin with."""
    runs: dict[int, list[tuple[Op, Steps, list[str]]]] = {}
    for op, run in RUNS.items():
        steps = [(operation, registers.split()) for operation, registers in run.steps]
        runs.setdefault(steps[0][0], []).append((op, steps, run.operands.split()))
    return runs


BY_FIRST = _by_first()


def _fused(rows: Sequence[Row]) -> Iterator[Row]:
    k = 0
    while k < len(rows):
        for op, steps, operands in BY_FIRST.get(rows[k][0], ()):
            registers = _registers(rows[k : k + len(steps)], steps)
            if registers is not None:
                row = (int(op), registers["x"], *(registers[letter] for letter in operands))
                yield (*row, *[0] * (WIDTH - len(row)))
                k += len(steps)
                break
        else:
            yield rows[k]
            k += 1


def _repeated(rows: Sequence[Row]) -> Iterator[Row]:
    """Instructions with those for nodes side by side taken together; their last operand is the same."""
    k = 0
    while k < len(rows):
        number, target, *operands = rows[k]
        if number not in REPEATED:
            yield rows[k]
            k += 1
            continue
        count = 1
        while rows[k + count][:2] == (number, target + 2 * count) and rows[k + count][2] == operands[0]:
            count += 1
        yield (number, target, count, operands[0], *[0] * (WIDTH - 4))
        k += count


def _registers(rows: Sequence[Row], steps: Steps) -> dict[str, int] | None:
    """Register of each letter of a run; None where the instructions are others."""
    if len(rows) < len(steps):
        return None
    registers: dict[str, int] = {}
    for row, (op, letters) in zip(rows, steps, strict=True):
        if row[0] != op:
            return None
        for register, letter in zip(row[1:], letters, strict=False):
            first_register = register - letter.endswith("+")
            if registers.setdefault(letter.rstrip("+"), first_register) != first_register:
                return None
    return registers
