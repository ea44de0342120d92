"""Where boxes are split: scores of variables and factors, and what solved problems teach about them (pseudo-costs).

Nothing here proves anything: any score whatever leaves every bound right, and only the number of boxes changes.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from synth.bounds.boxes import Boxes
from synth.bounds.clusters import ClusterTree
from synth.bounds.influences import Influences
from synth.bounds.question_bounds import QuestionBounds
from synth.bounds.settings import BranchingSettings

# Widths are finite: one without bounds (a missing cutoff, ends too far apart for a ratio) times no influence is none.
LARGEST_RATIO = float(np.finfo(float).max)
WIDEST = float(np.log(LARGEST_RATIO))


@dataclass(frozen=True)
class BranchingStatistics:
    """What solved problems tell about where to split, per set of objectives with a cutoff (a row each).

    Parameters
    ----------
    shares : array (sets, limits + objectives)
        Sum of the shares that multipliers have in their total, by importance.
    importance : array (sets,)
        Sum of the importance of the problems.
    count : array (sets,)
        How many problems there were.
    """

    shares: np.ndarray
    importance: np.ndarray
    count: np.ndarray

    @staticmethod
    def none(sets: int, columns: int) -> BranchingStatistics:
        """Return the statistics of no problem."""
        return BranchingStatistics(np.zeros((sets, columns)), np.zeros(sets), np.zeros(sets, dtype=np.int64))

    def copy(self) -> BranchingStatistics:
        """Copy that shares no array."""
        return BranchingStatistics(self.shares.copy(), self.importance.copy(), self.count.copy())


@dataclass(frozen=True)
class ScoreTables:
    """How far limits and objectives spread, as scores are made of it.

    Parameters
    ----------
    steep : array (limits + objectives, variables)
        Per unit of the width of a variable or auxiliary variable.
    spreads : list of array (clusters, limits + objectives)
        Per factor, over each cluster.
    """

    steep: np.ndarray
    spreads: Sequence[np.ndarray]


class BranchingWeights:
    """Along what the boxes of a question are split.

    Parameters
    ----------
    question : QuestionBounds
    trees : list of ClusterTree
        The clusters of its factors.
    influences : Influences
    settings : BranchingSettings

    Attributes
    ----------
    tables : ScoreTables
        Replaced as a whole where influences are measured anew.
    weights : array (sets, limits + objectives)
        How much limits and objectives count, per set of objectives with a cutoff; bit ``k`` of the number of a set
        stands for objective ``k``.
    """

    def __init__(
        self,
        question: QuestionBounds,
        trees: Sequence[ClusterTree],
        influences: Influences,
        settings: BranchingSettings,
    ) -> None:
        self._question, self._trees, self._influences, self._settings = question, trees, influences, settings
        # What seems to matter to nothing must be split some day as well, or a box could be split for ever elsewhere.
        self._floor = settings.least_if_infeasible if question.infeasibility else settings.least
        self._range = np.maximum(question.high - question.low, 1e-300)
        self._bits = question.bounded if question.bounded <= settings.most_bits else 0
        self.tables = self._score_tables(influences.anywhere)
        self._statistics = BranchingStatistics.none(1 << self._bits, len(question.constraints) + len(question.goals))
        self.weights = self._weights()

    @property
    def spans(self) -> np.ndarray:
        """Return the unit of the width of each variable; 0 where widths are logarithms of ratios."""
        return np.where(self._question.positive, 0.0, self._range)

    def widths(self, low: np.ndarray, high: np.ndarray) -> np.ndarray:
        """Return widths of boxes on the scale of the influences."""
        with np.errstate(all="ignore"):
            ratio = np.minimum(high / low, LARGEST_RATIO)
            result: np.ndarray = np.where(self._question.positive, np.log(ratio), (high - low) / self._range)
        return result

    def scores(
        self, boxes: Boxes, undecided: Sequence[Any], goals: int, cutoffs: np.ndarray | None = None
    ) -> np.ndarray:
        """Return, per variable and factor, how far limits that are undecided and objectives spread over it.

        Parameters
        ----------
        boxes : Boxes
        undecided : list of array (boxes,)
            Per limit.
        goals : int
            How many objectives count, from the first.
        cutoffs : array (objectives,) or (boxes, objectives), optional
            What boxes are looked into for is seen by which are finite.

        Returns
        -------
        array (boxes, variables + factors)
        """
        question = self._question
        count, limits, width = len(boxes), len(question.constraints), question.width
        counted = np.zeros((count, limits + len(question.goals)), dtype=np.float32)
        for j, flag in enumerate(undecided):
            counted[:, j] = flag
        counted[:, limits : limits + goals] = 1.0
        counted *= self.weights[0 if cutoffs is None else self._pattern(np.isfinite(cutoffs[..., : self._bits]))]
        result = np.zeros((count, width + len(self._trees)), dtype=np.float32)
        if width:
            result[:, :width] = (counted @ self.tables.steep) * self.widths(boxes.low, boxes.high)
        for f, spread in enumerate(self.tables.spreads):
            result[:, width + f] = np.einsum("bj,bj->b", counted, spread.take(boxes.cell[:, f], axis=0))
        return result

    def focus(self, variables: np.ndarray, combinations: np.ndarray) -> None:
        """Measure influences at some designs: what matters there counts more than what matters anywhere.

        Parameters
        ----------
        variables : array (designs, variables)
        combinations : array (designs,)
        """
        inputs = self._question.instance.data(combinations)
        data = [np.broadcast_to(np.asarray(x, dtype=float), (len(variables),)) for x in inputs]
        near = self._influences.near([variables[:, i] for i in range(self._question.n)] + data)
        self.tables = self._score_tables(np.maximum(near, self._settings.anywhere * self._influences.anywhere))

    def learn(self, multipliers: np.ndarray, importance: np.ndarray) -> None:
        """Take multipliers of solved problems: where they are large, boxes are split.

        What blurs a bound is, to first order, the spread of every limit times its multiplier.

        Parameters
        ----------
        multipliers : array (problems, limits + objectives)
        importance : array (problems,)
            How much each problem counts.
        """
        sizes = np.abs(multipliers)
        total = sizes.sum(axis=1)
        good = np.isfinite(total) & (total > 0) & np.isfinite(importance) & (importance > 0)
        if not good.any():
            return
        shares = sizes[good] / total[good, None]
        first = len(self._question.constraints)
        goal_shares = shares[:, first : first + self._bits]
        pattern = self._pattern(goal_shares > self._settings.active_share * goal_shares.sum(axis=1, keepdims=True))
        np.add.at(self._statistics.shares, pattern, importance[good, None] * shares)
        np.add.at(self._statistics.importance, pattern, importance[good])
        np.add.at(self._statistics.count, pattern, 1)
        self.weights = self._weights()

    @property
    def learned(self) -> int:
        """Number of solved problems learned from."""
        return int(self._statistics.count.sum())

    def statistics(self) -> BranchingStatistics:
        """Branching knowledge gathered so far."""
        return self._statistics.copy()

    def adopt(self, statistics: BranchingStatistics) -> bool:
        """Take what was learned for the same limits and objectives; tell whether they are the same in number."""
        if statistics.shares.shape != self._statistics.shares.shape:
            return False
        self._statistics = statistics.copy()
        self.weights = self._weights()
        return True

    def _pattern(self, objectives: np.ndarray) -> np.ndarray:
        """Return the number of each set of objectives (..., bits)."""
        return np.asarray(objectives @ (1 << np.arange(self._bits)), dtype=np.int64)

    def _weights(self) -> np.ndarray:
        """Return the weights of limits and objectives; one without a cutoff decides nothing, unless none has one."""
        first, known = len(self._question.constraints), self._statistics
        result = np.ones(known.shares.shape)
        if known.count.any():
            result[:] = known.shares.sum(axis=0) / known.importance.sum()
            learned = known.count >= self._settings.enough
            result[learned] = known.shares[learned] / known.importance[learned, None]
            result += self._floor
        for pattern in range(1, len(result)):
            idle = [k for k in range(self._bits) if not pattern >> k & 1]
            result[pattern, [first + k for k in idle]] = 0.0
        return result.astype(np.float32)

    def _score_tables(self, influence: np.ndarray) -> ScoreTables:
        """Score tables for influences (limits + objectives, inputs)."""
        first_auxiliary = influence.shape[1] - len(self._question.auxiliary)
        moving = np.concatenate([influence[:, : self._question.n], influence[:, first_auxiliary:]], axis=1)
        steep = np.maximum(moving, self._floor)
        steep[:, : self._question.n] *= [self._share(v.name) for v in self._question.model.variables]
        spreads = [self._share(t.factor.name) * self._spread(t, influence) for t in self._trees]
        return ScoreTables(steep.astype(np.float32), [s.astype(np.float32) for s in spreads])

    def _share(self, name: str) -> float:
        """Weight of a variable or factor for splitting: little if others make up for it."""
        model, goals = self._question.model, self._question.goals[: self._question.bounded]
        unless, objective_nodes = model.declaration.late.get(name), {goal.node for goal in goals}
        if unless is None or any(model.quantity_node[objective] in objective_nodes for objective in unless):
            return 1.0
        return self._settings.late

    def _spread(self, tree: ClusterTree, influence: np.ndarray) -> np.ndarray:
        """Spread of limits and objectives over each cluster (clusters, limits + objectives)."""
        factor, question = tree.factor, self._question
        low, high = tree.hull(factor.columns) if factor.columns.size else (np.zeros((len(tree), 0)),) * 2
        with np.errstate(all="ignore"):
            width = np.where(low > 0, np.log(high / low), high - low)
        width = np.where(np.isnan(width), np.where(tree.leaf, 0.0, 1.0)[:, None], np.minimum(width, WIDEST))
        # The cutoff of a row is as far off as its objective.
        capped = np.eye(len(influence))[:, [len(question.constraints) + g for g in factor.capped]]
        influence_of_factor = np.concatenate([influence[:, [question.n + i for i in factor.inputs]], capped], axis=1)
        first = self._settings.parts_first if factor.name else self._settings.questions_first
        result: np.ndarray = (first * width @ influence_of_factor.T).astype(np.float32)
        # Rows that differ only in what has no influence are still different rows.
        result += np.where(tree.leaf, 0.0, self._floor)[:, None].astype(np.float32)
        return result
