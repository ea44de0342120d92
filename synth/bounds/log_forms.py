"""Formulas in logarithms: products of powers are linear forms, and sums are relations between three of them.

Of each node whose sign is known in a box the logarithm of its size is a linear form of *columns*, plus a constant.
Columns are the logarithms of variables, of what tables say, and of nodes that are no product of powers. How such a node
hangs together with its arguments is a :class:`Relation`; where nothing is known of that, the node is a column with its
range and no more.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import casadi as ca
import numpy as np

from synth.bounds.propagated_nodes import CONSTANT, INNER, PropagatedNodes
from synth.model.program import EXPONENTS, OP_SPECIAL

SUM, LARGEST, LEAST, ELASTIC = "sum", "largest", "least", "elastic"


@dataclass(frozen=True)
class Relation:
    """How the sizes of some nodes hang together.

    ``SUM``: the first is the sum of the second and the third. ``LARGEST``, ``LEAST``: the first is the larger or the
    smaller of the others. ``ELASTIC``: the first is a special function of the others, whose elasticities are declared.
    """

    kind: str
    nodes: tuple[int, ...]


@dataclass(frozen=True)
class LogForms:
    """The linear forms of some nodes.

    Parameters
    ----------
    signs : array (nodes,)
        Of all nodes of the program: 0 where a node has no form.
    columns : list of int
        The node of each column.
    relations : list of Relation
    coefficients : dict of dict
        Per node: column -> coefficient.
    offsets : dict of float
        Per node: the constant.
    """

    signs: np.ndarray
    columns: tuple[int, ...]
    relations: tuple[Relation, ...]
    coefficients: dict[int, dict[int, float]]
    offsets: dict[int, float]

    @cached_property
    def place(self) -> dict[int, int]:
        """Rows of :attr:`matrix`, by node."""
        return {k: row for row, k in enumerate(self.coefficients)}

    @cached_property
    def matrix(self) -> np.ndarray:
        """Coefficients of all nodes that have a form (nodes, columns)."""
        result = np.zeros((len(self.place), len(self.columns)))
        for k, form in self.coefficients.items():
            for column, value in form.items():
                result[self.place[k], column] = value
        return result

    @cached_property
    def constants(self) -> np.ndarray:
        """Constants of all nodes that have a form (nodes,)."""
        return np.array([self.offsets[k] for k in self.place])


def log_forms(nodes: PropagatedNodes, signs: np.ndarray, values: dict[int, float]) -> LogForms:
    """Return the forms of all nodes for signs that hold in a box.

    Parameters
    ----------
    nodes : PropagatedNodes
    signs : array (nodes,)
        Of all nodes of the program: +1 or -1, 0 where it is not known or the node must not be used.
    values : dict of float
        Of the constant nodes.
    """
    return _Composition(nodes, signs, values).forms()


class _Composition:
    """The forms of nodes, one after the other."""

    def __init__(self, nodes: PropagatedNodes, signs: np.ndarray, values: dict[int, float]) -> None:
        self.nodes, self.program, self.signs, self.values = nodes, nodes.program, signs, values
        self.columns, self.relations = list[int](), list[Relation]()
        self.coefficients, self.offsets = dict[int, dict[int, float]](), dict[int, float]()

    def forms(self) -> LogForms:
        """Return all forms."""
        shown = {*self.nodes.constants, *self.nodes.tables, *self.nodes.variables, *self.nodes.inner}
        for k in self.nodes.order:
            if k in shown and self.signs[k]:
                self._add(k)
        return LogForms(
            self.signs, tuple(self.columns), tuple(self.relations), dict(self.coefficients), dict(self.offsets)
        )

    def _add(self, k: int) -> None:
        node = self.program.nodes[k]
        if self.nodes.kind[k] == CONSTANT:
            self.coefficients[k], self.offsets[k] = {}, float(np.log(abs(self.values[k])))
        elif self.nodes.kind[k] != INNER or not all(a in self.coefficients for a in node.args):
            self._column(k)
        elif node.op == ca.OP_MUL:
            self._product(k, [(node.args[0], 1.0), (node.args[1], 1.0)])
        elif node.op == ca.OP_DIV:
            self._product(k, [(node.args[0], 1.0), (node.args[1], -1.0)])
        elif node.op in EXPONENTS:
            self._product(
                k, [(node.args[0], EXPONENTS[node.op])], float(np.log(2.0)) if node.op == ca.OP_TWICE else 0.0
            )
        elif node.op in (ca.OP_POW, ca.OP_CONSTPOW) and self.nodes.kind[node.args[1]] == CONSTANT:
            self._product(k, [(node.args[0], self.values[node.args[1]])])
        else:
            self._column(k)
            self.relations += self._related(k, node.op, node.args)

    def _column(self, k: int) -> None:
        self.coefficients[k], self.offsets[k] = {len(self.columns): 1.0}, 0.0
        self.columns.append(k)

    def _product(self, k: int, factors: Sequence[tuple[int, float]], offset: float = 0.0) -> None:
        form = dict[int, float]()
        for a, power in factors:
            offset += power * self.offsets[a]
            for column, value in self.coefficients[a].items():
                form[column] = form.get(column, 0.0) + power * value
        self.coefficients[k], self.offsets[k] = {c: v for c, v in form.items() if v}, offset

    def _related(self, k: int, op: int, args: tuple[int, ...]) -> list[Relation]:
        signs = self.signs
        if op in (ca.OP_ADD, ca.OP_SUB):
            a, b = args
            sign, first, second = signs[k], signs[a], signs[b] if op == ca.OP_ADD else -signs[b]
            if first == second:
                return [Relation(SUM, (k, a, b))]
            # What is left of the larger one has its sign.
            return [Relation(SUM, (a, k, b) if sign == first else (b, k, a))]
        if op in (ca.OP_FMAX, ca.OP_FMIN) and signs[args[0]] == signs[args[1]]:
            larger = (op == ca.OP_FMAX) == (signs[k] > 0)
            return [Relation(LARGEST if larger else LEAST, (k, *args))]
        if op == OP_SPECIAL and all(signs[a] > 0 for a in (k, *args)):
            return [Relation(ELASTIC, (k, *args))]
        return []
