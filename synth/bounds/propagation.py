"""Interval propagation over the boxes of one question: sound bounds, nothing that steers the search."""

from __future__ import annotations

import copy
from dataclasses import dataclass
from typing import Any

import numpy as np

from synth.bounds.array_reader import BoxArrays
from synth.bounds.boxes import Boxes
from synth.bounds.clusters import Cells, ClusterTree
from synth.bounds.contractor import Code
from synth.bounds.question_bounds import QuestionBounds

# The ends of nodes per cluster, and a factor's: what propagation reads of tables.
Ends = tuple[np.ndarray, np.ndarray]
Tables = list[tuple[int, np.ndarray, np.ndarray]]


@dataclass(frozen=True)
class Propagated:
    """Boxes after propagation.

    Parameters
    ----------
    alive : array (boxes,)
        Whether anything feasible may be left.
    low, high : array (boxes, variables)
    goals : list of array (boxes,)
        Lower bounds of the objectives, with their sign.
    undecided : list of array (boxes,)
        Per limit: whether a box may still break it.
    """

    alive: np.ndarray
    low: np.ndarray
    high: np.ndarray
    goals: list[Any]
    undecided: list[Any]


class Propagation:
    """Interval propagation for one question.

    Parameters
    ----------
    question : QuestionBounds
    cells : Cells
        The clusters of its factors. How they are split is of no matter here.

    Attributes
    ----------
    tables : dict of list of (factor, low, high)
        By whether every objective counts: the factor of each tabulated node and its ends per cluster, in the order of
        the contractor.
    """

    def __init__(self, question: QuestionBounds, cells: Cells) -> None:
        self.question, self.cells = question, cells
        self._ends = [self._ends_per_cluster(f) for f in range(len(question.factors))]
        self.tables = self._in_order()
        self.floors = self._floors_per_cluster()
        self._codes: dict[tuple[bool, bool], Code] = {}

    def among(self, question: QuestionBounds, first: ClusterTree) -> Propagation:
        """Propagation for other rows of the first factor.

        Parameters
        ----------
        question : QuestionBounds
            As :meth:`QuestionBounds.among` returns it.
        first : ClusterTree
            The clusters of the other rows.
        """
        new = copy.copy(self)
        new.question = question
        new.cells = Cells([first, *self.cells.trees[1:]], question.instance.combinations.radix)
        new._ends = [new._ends_per_cluster(0), *self._ends[1:]]
        new.tables = new._in_order()
        new.floors = new._floors_per_cluster()
        return new

    def run(self, boxes: Boxes, cutoffs: np.ndarray | None, passes: int, every: bool) -> Propagated:
        """Tighten boxes.

        Parameters
        ----------
        boxes : Boxes
        cutoffs : array (objectives,) or (boxes, objectives), optional
            Upper bounds of the objectives, with their sign.
        passes : int
            Forward-backward sweeps.
        every : bool
            Whether objectives that only settle ties count.
        """
        count, question, width, floors = len(boxes), self.question, self.question.width, self.floors
        read = BoxArrays(
            count=count,
            variables=[(boxes.low[:, i], boxes.high[:, i]) for i in range(width)],
            tables=[(a.take(boxes.cell[:, f]), b.take(boxes.cell[:, f])) for f, a, b in self.tables[every]],
            constants=question.constants[every],
            right_sides=question.right_sides,
            cutoffs=None if cutoffs is None else list(np.moveaxis(cutoffs, -1, 0)),
            floors=[-np.inf] * len(question.goals) if floors is None else list(floors[boxes.cell[:, 0]].T),
        )
        with np.errstate(all="ignore"):
            reader = self.code(every, cutoffs is not None).reader
            dead, goals, undecided = reader.contract(read, question.root, passes)
        low, high = np.empty((count, width)), np.empty((count, width))
        for i, (x, y) in enumerate(read.variables):
            low[:, i], high[:, i] = x, y
        return Propagated(~dead, low, high, goals, undecided)

    def code(self, every: bool, capped: bool) -> Code:
        """Code of a sign pattern; ``every``: with objectives that only settle ties, ``capped``: with cutoffs."""
        key = (every, capped)
        if key not in self._codes:
            self._codes[key] = self.question.contractors[every].code(self.question.root, capped)
        return self._codes[key]

    def _ends_per_cluster(self, f: int) -> dict[int, Ends]:
        """Return the ends per cluster of the nodes that one factor alone decides."""
        per_row, root = self.question.row_values[f], self.question.root
        if not per_row:
            return {}
        low, high = self.cells.trees[f].hull(np.stack(list(per_row.values()), axis=1))
        result = {}
        for column, node in enumerate(per_row):
            # What the whole question excludes is cut off, so that signs settled there hold for every cluster.
            ends = np.fmax(low[:, column], root.low[node]), np.fmin(high[:, column], root.high[node])
            result[node] = np.ascontiguousarray(ends[0]), np.ascontiguousarray(ends[1])
        return result

    def _floors_per_cluster(self) -> np.ndarray | None:
        """Floors of objectives per cluster of the first factor; None where there are none."""
        declared, tree = self.question.instance.floors, self.cells.trees[0] if self.cells.trees else None
        if not declared or tree is None:
            return None
        per_row = np.full((len(tree.leaf_of_row), len(self.question.goals)), -np.inf)
        for k, values in declared.items():
            # Rows of a leaf are equal in all else that counts: what the lowest floor allows counts for all of them.
            per_leaf = np.full(len(tree), np.inf)
            np.minimum.at(per_leaf, tree.leaf_of_row, values)
            per_row[:, k] = per_leaf[tree.leaf_of_row]
        return tree.hull(per_row)[0]

    def _in_order(self) -> dict[bool, Tables]:
        ends = {node: (f, *pair) for f, of_factor in enumerate(self._ends) for node, pair in of_factor.items()}
        return {every: [ends[node] for node in c.nodes.tables] for every, c in self.question.contractors.items()}
