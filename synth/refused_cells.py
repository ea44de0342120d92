"""Clusters of rows that a refusal over several slots excludes as a whole, before single rows are looked at."""

from __future__ import annotations

from functools import partial

import casadi as ca
import numpy as np

from synth.clusters import Cells
from synth.declaration import Refusal
from synth.instance import Instance
from synth.intervals import FORWARD, Interval
from synth.model import Model
from synth.program import COMPARISONS, Program

EXACT = COMPARISONS | {ca.OP_INPUT, ca.OP_CONST}


def _program(model: Model, refusal: Refusal) -> Program:
    return Program(model.inputs, [refusal.when], model.calls)


class RefusedCells:
    """What refusals that only compare say of whole clusters.

    A refusal that computes would need rounding to be reckoned with; it is asked of single combinations alone.

    Parameters
    ----------
    instance : Instance
    cells : Cells
        The clusters; rows of a leaf are equal in all that refusals read.
    """

    def __init__(self, instance: Instance, cells: Cells) -> None:
        self._refused: list[tuple[Program, int]] = []
        self._ends: dict[int, tuple[int, np.ndarray, np.ndarray]] = {}  # by data input: factor, ends per cluster
        self._fixed: dict[int, float] = {}
        model, owner = instance.model, instance.owners()
        first = len(model.variables)
        for refusal in instance.joint_refusals:
            program = model.function(("refusal program", id(refusal)), partial(_program, model, refusal))
            nodes = [program.nodes[k] for k in program.needed(program.outputs)]
            read = {int(node.constant) - first for node in nodes if node.op == ca.OP_INPUT}
            if any(node.op not in EXACT for node in nodes) or min(read, default=0) < 0:
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
        """Tell which cells (cells, factors) hold a combination that no refusal is known to exclude."""
        allowed = np.ones(len(cell), dtype=bool)
        for program, output in self._refused:
            found: dict[int, Interval] = {}
            for k in program.needed([output]):
                node = program.nodes[k]
                if node.op == ca.OP_CONST:
                    found[k] = (node.constant, node.constant)
                elif node.op == ca.OP_INPUT:
                    found[k] = self._range(int(node.constant) - self._first, cell)
                else:
                    found[k] = FORWARD[node.op](*(found[a] for a in node.args))
            allowed &= ~(np.asarray(found[output][0]) > 0.5)
        return allowed

    def _range(self, k: int, cell: np.ndarray) -> Interval:
        if k in self._fixed:
            return self._fixed[k], self._fixed[k]
        factor, low, high = self._ends[k]
        return low[cell[:, factor]], high[cell[:, factor]]
