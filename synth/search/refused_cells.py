"""Clusters of rows that a refusal over several slots excludes as a whole, before single rows are looked at."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial

import casadi as ca
import numpy as np

from synth.bounds.clusters import Cells, ClusterTree
from synth.bounds.intervals import FORWARD
from synth.declaration import Refusal
from synth.model.model import Model
from synth.model.program import COMPARISONS, Program
from synth.operations.record import Interval
from synth.question.refusals import allowed_rows
from synth.question.search_space import SearchSpace

EXACT = COMPARISONS | {ca.OP_INPUT, ca.OP_CONST}


def _program(model: Model, refusal: Refusal) -> Program:
    return Program(model.inputs, [refusal.when], model.calls)


def _pairs(instance: SearchSpace, cells: Cells, refusal: Refusal, factors: Sequence[int]) -> np.ndarray:
    """Clusters of two factors that hold a pair of rows that a refusal allows (clusters, clusters)."""
    model, owner = instance.model, instance.owners()
    shape = tuple(instance.combinations.radix[f] for f in factors)
    data = instance.data(np.zeros(1, dtype=np.int64))
    for k, factor in enumerate(owner):
        if factor in factors:
            column = instance.column(k)
            column = column[:, None] if factor == factors[0] else column[None, :]
            data[k] = np.broadcast_to(column, shape).ravel()
    refused = np.asarray(model.refused(refusal)([None] * len(model.variables) + data)[0])
    allowed = ~(np.broadcast_to(refused, (shape[0] * shape[1],)).reshape(shape) > 0.5)
    for f in factors:
        allowed = _over_clusters(cells.trees[f], allowed).T  # one axis, then the other, which is turned back
    return allowed


def _over_clusters(tree: ClusterTree, rows: np.ndarray) -> np.ndarray:
    """Disjunction over the rows of each cluster (rows, n)."""
    result = np.empty((len(tree), rows.shape[1]), dtype=bool)
    result[tree.leaf] = rows[tree.first[tree.leaf]]  # the rows of a leaf are equal in all that is read
    for k in np.flatnonzero(~tree.leaf)[::-1].tolist():
        result[k] = result[tree.left[k]] | result[tree.right[k]]
    return result


def not_refused(space: SearchSpace, combinations: np.ndarray) -> np.ndarray:
    """Tell which combinations no refusal over several slots forbids.

    Parameters
    ----------
    space : SearchSpace
    combinations : array (combinations,)
    """
    refusals, count = space.selection.joint_refusals, len(combinations)
    data = space.data(combinations) if refusals else []
    return allowed_rows(space.model, refusals, data, count)


class RefusedCells:
    """Refusals that only compare, evaluated over clusters.

    A refusal that computes would need rounding to be reckoned with; it is asked of single combinations alone. Where two
    factors are compared that are not too large, every pair of clusters is looked up in a table; otherwise the ends of
    the clusters tell.

    Parameters
    ----------
    instance : SearchSpace
    cells : Cells
        The clusters; rows of a leaf are equal in all that refusals read.
    most_pairs : int
        Of rows, for which a table is made.
    """

    def __init__(self, instance: SearchSpace, cells: Cells, most_pairs: int) -> None:
        self._refused: list[tuple[Program, int]] = []
        self._tables: list[tuple[int, int, np.ndarray]] = []  # two factors, and which clusters of them go together
        self._ends: dict[int, tuple[int, np.ndarray, np.ndarray]] = {}  # by data input: factor, ends per cluster
        self._fixed: dict[int, float] = {}
        model, owner = instance.model, instance.owners()
        first = len(model.variables)
        for refusal in instance.selection.joint_refusals:
            program = model.function(("refusal program", id(refusal)), partial(_program, model, refusal))
            nodes = [program.nodes[k] for k in program.needed(program.outputs)]
            read = {int(node.constant) - first for node in nodes if node.op == ca.OP_INPUT}
            if any(node.op not in EXACT for node in nodes) or min(read, default=0) < 0:
                continue
            factors = sorted({owner[k] for k in read if owner[k] >= 0})
            if len(factors) == 2 and np.prod([float(instance.combinations.radix[f]) for f in factors]) <= most_pairs:
                one, two = factors
                self._tables.append((one, two, _pairs(instance, cells, refusal, factors)))
                continue
            self._refused.append((program, program.outputs[0]))
            for k in read:
                if owner[k] < 0:
                    self._fixed[k] = float(np.asarray(instance.data(np.zeros(1, dtype=np.int64))[k]).ravel()[0])
                else:
                    low, high = cells.trees[owner[k]].hull(instance.column(k)[:, None])
                    self._ends[k] = owner[k], low[:, 0], high[:, 0]
        self._first = first

    def may_be_allowed(self, cell: np.ndarray) -> np.ndarray:
        """Mask of cells (cells, factors) that may hold a combination that no refusal excludes."""
        allowed = np.ones(len(cell), dtype=bool)
        for one, two, together in self._tables:
            allowed &= together[cell[:, one], cell[:, two]]
        for program, output in self._refused:
            ranges: dict[int, Interval] = {}
            for k in program.needed([output]):
                node = program.nodes[k]
                if node.op == ca.OP_CONST:
                    ranges[k] = (node.constant, node.constant)
                elif node.op == ca.OP_INPUT:
                    ranges[k] = self._range(int(node.constant) - self._first, cell)
                else:
                    ranges[k] = FORWARD[node.op](*(ranges[a] for a in node.args))
            allowed &= ~(np.asarray(ranges[output][0]) > 0.5)
        return allowed

    def _range(self, k: int, cell: np.ndarray) -> Interval:
        if k in self._fixed:
            return self._fixed[k], self._fixed[k]
        factor, low, high = self._ends[k]
        return low[cell[:, factor]], high[cell[:, factor]]
