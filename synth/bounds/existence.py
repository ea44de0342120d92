"""Nodes of a program that have a value wherever the limits of the family hold, as far as intervals tell."""

from __future__ import annotations

from collections.abc import Sequence

import casadi as ca
import numpy as np

from synth.bounds.curvature import INF, Ends
from synth.bounds.feasible_intervals import FeasibleIntervals, natural
from synth.model.program import OP_SELECT, OPERATIONS, Node, Program
from synth.operations.record import Trait
from synth.question.search_space import SearchSpace


def _free_of_zero(a: Ends) -> bool:
    return a[0] > 0 or a[1] < 0


def _power(base: Ends, exponent: Ends) -> bool:
    if base[0] > 0 or (base[0] >= 0 and exponent[0] > 0):
        return True
    return exponent[0] == exponent[1] and exponent[0].is_integer() and (exponent[0] >= 0 or _free_of_zero(base))


def surely_exist(space: SearchSpace, nodes: Sequence[int]) -> list[bool]:
    """Whether nodes have a value in every design that keeps the limits of the family.

    Special functions count as existing: their families declare guards.

    Parameters
    ----------
    space : SearchSpace
    nodes : list of int
    """
    program, (low, high) = space.model.program, _input_ranges(space)
    with np.errstate(all="ignore"):
        plain: list[Ends] = []
        for node in program.nodes:
            plain.append(natural(program, node, plain, low, high))
        existing = _existing(program, low + high, plain)
        if not all(existing[k] for k in nodes):  # limits leave less, which takes several times as long to learn
            within = FeasibleIntervals(space.model, low, high)
            existing = _existing(program, low + high, list(zip(within.low, within.high, strict=True)))
    return [existing[k] for k in nodes]


def _existing(program: Program, inputs: np.ndarray, ends: Sequence[Ends]) -> list[bool]:
    """Whether nodes with these intervals exist, each; inputs exist where they are finite."""
    exists: list[bool] = []
    for node in program.nodes:
        if node.op == ca.OP_INPUT:
            exists.append(bool(np.isfinite(inputs[int(node.constant)])))
        else:
            exists.append(_exists(node, [ends[a] for a in node.args], [exists[a] for a in node.args]))
    return exists


def _input_ranges(space: SearchSpace) -> tuple[np.ndarray, np.ndarray]:
    """Least and largest value of every input; not-a-number where a row has none."""
    low, high = space.ranges.lower.tolist(), space.ranges.upper.tolist()
    first = space.data(np.zeros(1, dtype=np.int64))
    for k, owner in enumerate(space.owners()):
        values = np.ravel(first[k]) if owner < 0 else space.column(k)
        low.append(float(np.min(values)))
        high.append(float(np.max(values)))
    return np.array(low), np.array(high)


def _exists(node: Node, ends: Sequence[Ends], args: Sequence[bool]) -> bool:
    """Whether a node exists for all arguments in some intervals; of branches those count that may be taken."""
    if node.op == ca.OP_CONST:
        return -INF < node.constant < INF
    if node.op in (OP_SELECT, ca.OP_IF_ELSE_ZERO):
        low, high = ends[0]
        reachable = [high > 0.5, low < 0.5]
        return args[0] and all(there or not may for there, may in zip(args[1:], reachable, strict=False))
    return all(args) and _defined(node.op, ends)


def _defined(op: int, ends: Sequence[Ends]) -> bool:
    """Whether an operation has a value for all arguments in some intervals; special functions count as having one."""
    known = OPERATIONS.get(op)
    if op in (ca.OP_POW, ca.OP_CONSTPOW):
        return _power(*ends)
    if known is None or (Trait.DIVIDES in known.traits and not _free_of_zero(ends[-1])):
        return known is None
    return all(domain is None or domain.holds(ends[0]) for domain in (known.domain, known.finite))
