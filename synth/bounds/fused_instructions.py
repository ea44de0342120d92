"""Runs of instructions that stand together for every node of a kind, as one instruction each.

An instruction costs the kernel about as much to begin as to carry out for two registers. The operations, and with them
all bits of results, stay the same; only registers for what is passed on within a run are no longer written.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import NamedTuple

Row = tuple[int, ...]  # number of the operation, target, operands


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

    steps: tuple[tuple[str, str], ...]
    operands: str


MEET = (("v_fmax(a, b)", "x x s"), ("v_fmin(a, b)", "x+ x+ s+"))
MET_OTHER = (("v_fmax(a, b)", "y y s"), ("v_fmin(a, b)", "y+ y+ t"))
# Longer runs first: they begin like shorter ones.
RUNS: Mapping[str, Run] = {
    "PRODUCT_BACK": Run(
        (("a / b", "s k x+"), ("a / b", "t k+ x"), ("both ends met a / b", "x k y+ k+ y"), *MET_OTHER), "k y"
    ),
    "QUOTIENT_BACK": Run(
        (("a / b", "s x k+"), ("a / b", "t x+ k"), ("both ends met a * b", "x k y k+ y+"), *MET_OTHER), "k y"
    ),
    "SUM_BACK": Run(
        (
            ("a * b - c", "s k l x+"),
            ("a * b - c", "t k+ m x"),
            ("v_fmax(a, b * c - d)", "x x k l y+"),
            ("v_fmin(a, b * c - d)", "x+ x+ k+ m y"),
            *MET_OTHER,
        ),
        "k y l m",
    ),
    "DIFFERENCE_BACK": Run(
        (
            ("a * b - c", "s x l k+"),
            ("a * b - c", "t x+ m k"),
            ("both ends met a + b", "x k y k+ y+"),
            *MET_OTHER,
        ),
        "k y l m",
    ),
    "AT_MOST": Run(
        (("a * b", "s b c"), ("kill a > b", "z x s"), ("v_fmin(a, b)", "x+ x+ s"), ("a > b", "o x+ d")), "b c o d"
    ),
    "AT_LEAST": Run(
        (("a * b", "s b c"), ("kill a < b", "z x+ s"), ("v_fmax(a, b)", "x x s"), ("a < b", "o x d")), "b c o d"
    ),
    "SUM": Run(
        (
            ("a + b - c * d", "s a b c a"),
            ("v_fmax(a, b)", "x x s"),
            ("a + b + c * d", "s a+ b+ c a+"),
            ("v_fmin(a, b)", "x+ x+ s"),
        ),
        "a b c",
    ),
    "DIFFERENCE": Run(
        (
            ("a - b - c * d", "s a b+ c a"),
            ("v_fmax(a, b)", "x x s"),
            ("a - b + c * d", "s a+ b c a+"),
            ("v_fmin(a, b)", "x+ x+ s"),
        ),
        "a b c",
    ),
    "TERM_BACK": Run((("v_fmax(a, b * c - d)", "x x k l y+"), ("v_fmin(a, b * c - d)", "x+ x+ k+ m y")), "k y l m"),
    "ROOT": Run((("v_fmax(a, v_sqrt(b))", "x x a"), ("v_fmin(a, v_sqrt(b))", "x+ x+ a+")), "a"),
    "MEET": Run(MEET, "s"),
    "CROSSED": Run((("kill a > b + c * d", "z x x+ c x+"),), "c"),
}
# Instructions for one node that serve several nodes side by side: how many is their first operand.
REPEATED = ("IN_ORDER", "CROSSED")


def fused(rows: Sequence[Row], numbers: Mapping[str, int], width: int) -> list[Row]:
    """Instructions with runs taken together.

    Parameters
    ----------
    rows : list
    numbers : mapping
        Name of an operation -> its number.
    width : int
        Of an instruction.
    """
    repeated = [numbers[name] for name in REPEATED]
    return list(_repeated(list(_fused(rows, _numbered(numbers), width)), repeated, width))


def _numbered(numbers: Mapping[str, int]) -> dict[int, list[tuple[int, list[tuple[int, list[str]]], list[str]]]]:
    """Runs by the operation that they begin with."""
    runs: dict[int, list[tuple[int, list[tuple[int, list[str]]], list[str]]]] = {}
    for name, run in RUNS.items():
        steps = [(numbers[operation], registers.split()) for operation, registers in run.steps]
        runs.setdefault(steps[0][0], []).append((numbers[name], steps, run.operands.split()))
    return runs


def _fused(
    rows: Sequence[Row], runs: Mapping[int, list[tuple[int, list[tuple[int, list[str]]], list[str]]]], width: int
) -> Iterator[Row]:
    k = 0
    while k < len(rows):
        for number, steps, operands in runs.get(rows[k][0], ()):
            registers = _registers(rows[k : k + len(steps)], steps)
            if registers is not None:
                row = (number, registers["x"], *(registers[letter] for letter in operands))
                yield (*row, *[0] * (width - len(row)))
                k += len(steps)
                break
        else:
            yield rows[k]
            k += 1


def _repeated(rows: Sequence[Row], repeated: Sequence[int], width: int) -> Iterator[Row]:
    """Instructions with those for nodes side by side taken together; their last operand is the same."""
    k = 0
    while k < len(rows):
        number, target, *operands = rows[k]
        if number not in repeated:
            yield rows[k]
            k += 1
            continue
        count = 1
        while rows[k + count][:2] == (number, target + 2 * count) and rows[k + count][2] == operands[0]:
            count += 1
        yield (number, target, count, operands[0], *[0] * (width - 4))
        k += count


def _registers(rows: Sequence[Row], steps: Sequence[tuple[int, list[str]]]) -> dict[str, int] | None:
    """Register of each letter of a run; None where the instructions are others."""
    if len(rows) < len(steps):
        return None
    registers: dict[str, int] = {}
    for row, (number, letters) in zip(rows, steps, strict=True):
        if row[0] != number:
            return None
        for register, letter in zip(row[1:], letters, strict=False):
            own = register - letter.endswith("+")
            if registers.setdefault(letter.rstrip("+"), own) != own:
                return None
    return registers
