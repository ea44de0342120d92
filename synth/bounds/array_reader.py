"""Carries out instructions over arrays of boxes in NumPy: the reference, and what runs where no kernel was built."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from synth.bounds.instructions import CONDITIONS, ENDS, MET, RULES, VALUES, InstructionList, Op, Row
from synth.bounds.root_propagation import Root

Pair = tuple[Any, Any]
Step = Callable[["_File"], None]


@dataclass
class BoxArrays:
    """What instructions read, over arrays.

    Parameters
    ----------
    count : int
        Boxes.
    variables, tables : list of (low, high), each (boxes,)
    constants, right_sides : list of float
    cutoffs : list of array (boxes,), optional
        Upper bounds of the objectives, with their sign.
    floors : list of array (boxes,)
        Least values of the objectives, with their sign.
    """

    count: int
    variables: list[Pair]
    tables: Sequence[Pair]
    constants: Sequence[float]
    right_sides: Sequence[float]
    cutoffs: Sequence[Any] | None
    floors: Sequence[Any]


class _File:
    """Registers, which boxes are dead, and what holds over the whole question."""

    def __init__(self, registers: list[Any], count: int, root: Root) -> None:
        self.registers, self.root = registers, root
        self.dead = np.zeros(count, dtype=bool)


class ArrayReader:
    """Instructions that are carried out over arrays.

    Parameters
    ----------
    instructions : InstructionList
    """

    def __init__(self, instructions: InstructionList) -> None:
        self.instructions = instructions
        self._lists: tuple[list[Step], ...] | None = None

    def contract(self, boxes: BoxArrays, root: Root, passes: int) -> tuple[np.ndarray, list[Any], list[Any]]:
        """Contract boxes.

        Parameters
        ----------
        boxes : BoxArrays
            Its variables are tightened in place.
        root : Root
            Signs that hold over it are settled in the instructions: boxes of variables must lie within it.
        passes : int
            Forward-backward sweeps.

        Returns
        -------
        tuple
            Dead boxes; lower ends of the objectives, with their sign; per limit whether a box may still break it.
        """
        code, at = self.instructions, self.instructions.regions
        if self._lists is None:
            self._lists = tuple([_step(row) for row in rows] for rows in (code.first, code.later, code.last))
        first, later, last = self._lists
        f: list[Any] = [None] * at.count

        def fill(place: int, values: Sequence[Any]) -> None:
            f[place : place + len(values)] = values

        fill(at.literals, list(code.literals))
        fill(at.constants, [np.float64(value) for value in boxes.constants for _ in range(2)])
        fill(at.right_sides, [np.float64(value) for value in boxes.right_sides])
        fill(at.cutoffs, boxes.cutoffs or [])
        fill(at.floors, boxes.floors)
        fill(at.tables, [end for pair in boxes.tables for end in pair])
        fill(at.variables, [end for i in code.variables for end in boxes.variables[i]])
        file = _File(f, boxes.count, root)
        for steps in (first, *[later] * (passes - 1), last):
            for step in steps:
                step(file)
        for place, i in enumerate(code.variables):
            boxes.variables[i] = f[at.variables + 2 * place], f[at.variables + 2 * place + 1]
        return file.dead, f[at.goals : at.goals + code.goals], f[at.open : at.open + code.limits]


def _step(row: Row) -> Step:
    """One instruction as a function of the file."""
    code, target, operands = row[0], row[1], row[2:]
    if code in VALUES:
        return _value(VALUES[code], target, operands)
    if code in CONDITIONS:
        return _kill(CONDITIONS[code], operands)
    if code in ENDS:
        return _ends(ENDS[code], target, operands)
    if code in MET:
        return _met(MET[code], target, operands)
    if code in RULES:
        return _rule(RULES[code].enclosure, target, operands)
    if code == Op.HOLD:
        return _hold(target, operands[0])
    return _in_order(target) if code == Op.IN_ORDER else _nothing


def _value(compute: Callable[..., Any], target: int, operands: Row) -> Step:
    def step(file: _File) -> None:
        f = file.registers
        f[target] = compute(*[f[k] for k in operands])

    return step


def _kill(holds: Callable[..., Any], operands: Row) -> Step:
    def step(file: _File) -> None:
        f = file.registers
        file.dead |= holds(*[f[k] for k in operands])

    return step


def _ends(compute: Callable[[Any, Any], Any], target: int, operands: Row) -> Step:
    a, b, c, d = operands

    def step(file: _File) -> None:
        f = file.registers
        f[target], f[target + 1] = compute(f[a], f[b]), compute(f[c], f[d])

    return step


def _met(compute: Callable[[Any, Any], Any], target: int, operands: Row) -> Step:
    a, b, c, d = operands

    def step(file: _File) -> None:
        f = file.registers
        low, high = compute(f[a], f[b]), compute(f[c], f[d])
        f[target], f[target + 1] = np.fmax(f[target], low), np.fmin(f[target + 1], high)

    return step


def _rule(enclosure: Callable[..., Pair | None], target: int, operands: Row) -> Step:
    def step(file: _File) -> None:
        f = file.registers
        enclosed = enclosure(*[(f[k], f[k + 1]) for k in operands])
        f[target], f[target + 1] = (np.nan, np.nan) if enclosed is None else enclosed

    return step


def _hold(target: int, node: int) -> Step:
    """Hold a node within what limits tell of it over the whole question, if they tell more than its arguments."""

    def step(file: _File) -> None:
        if file.root.narrowed[node]:
            f = file.registers
            f[target] = np.fmax(f[target], file.root.low[node])
            f[target + 1] = np.fmin(f[target + 1], file.root.high[node])

    return step


def _in_order(target: int) -> Step:
    def step(file: _File) -> None:
        f = file.registers
        low, high = f[target], f[target + 1]
        crossed = low > high
        f[target], f[target + 1] = np.where(crossed, high, low), np.where(crossed, low, high)

    return step


def _nothing(file: _File) -> None:
    """End a list: dead boxes are followed to its end."""
