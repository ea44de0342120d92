"""How steep limits and objectives are in variables, columns and auxiliary variables, measured at designs.

It steers where boxes and clusters are split and proves nothing.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from synth.bounds.clusters import ClusterTree, Factor
from synth.bounds.question_bounds import QuestionBounds
from synth.bounds.settings import BranchingSettings


class Influences:
    """How steep each limit and objective of a question is in each input, as logarithms.

    Parameters
    ----------
    question : QuestionBounds
    settings : BranchingSettings

    Attributes
    ----------
    anywhere : array (limits + objectives, inputs)
        Medians over random points; inputs are variables, data, and auxiliary variables.
    goal_sizes : array (objectives,)
        Median sizes of the objectives at these points: the units of those that have no logarithm.
    """

    def __init__(self, question: QuestionBounds, settings: BranchingSettings) -> None:
        self._question, self._settings = question, settings
        inputs = self._random_points()
        self._relative = [bool(np.all(x > 0)) for x in inputs]
        self._reach = [float(np.ptp(x)) for x in inputs]
        self.anywhere, self.goal_sizes = self._measured(inputs)

    def near(self, inputs: list[np.ndarray]) -> np.ndarray:
        """Return the influences (limits + objectives, inputs) as medians over some designs.

        Parameters
        ----------
        inputs : list of array (designs,)
            Variables and data.
        """
        return self._measured(inputs)[0]

    def clusters(self, factor: Factor) -> ClusterTree:
        """Return the rows of a factor, halved along the columns that matter most."""
        n = self._question.n
        weights = self.anywhere.sum(axis=0)[[n + i for i in factor.inputs]]
        return ClusterTree(factor, np.concatenate([weights, np.ones(len(factor.capped))]))

    def _random_points(self) -> list[np.ndarray]:
        question, samples = self._question, self._settings.samples
        n = question.n
        rng = np.random.default_rng(0)
        share, low, high = rng.random((samples, n)), question.low[:n], question.high[:n]
        with np.errstate(all="ignore"):
            ratio = low * (high / low) ** share
        points = np.where(question.positive[:n], ratio, low + share * (high - low))
        numbers = [rng.integers(size, size=samples) for size in question.instance.combinations.radix]
        data = [np.full(samples, v) for v in question.first_data()]
        for digits, factor in zip(numbers, question.factors, strict=True):
            for position, k in enumerate(factor.inputs):
                data[k] = factor.columns[digits, position]
        return [points[:, i] for i in range(n)] + data

    def _measured(self, inputs: list[np.ndarray]) -> tuple[np.ndarray, np.ndarray]:
        """Return the influences as medians over some designs, and the sizes of the objectives there."""
        question, n, count, step_size = self._question, self._question.n, len(inputs[0]), self._settings.step
        program, auxiliary, nodes = question.model.program, question.auxiliary, question.sides()
        moving = list(range(n)) + [n + k for f in question.factors for k in f.inputs]
        lifted = program.with_inputs(auxiliary)
        evaluate = question.model.function(("influence", tuple(nodes), auxiliary), lambda: lifted.compile(nodes))
        at_auxiliary = question.model.function(("auxiliary", auxiliary), lambda: program.compile(auxiliary))
        with np.errstate(all="ignore"):
            inputs = inputs + [np.broadcast_to(np.asarray(v, dtype=float), (count,)) for v in at_auxiliary(inputs)]
        moving += range(len(inputs) - len(auxiliary), len(inputs))
        result = np.zeros((len(question.constraints) + len(question.goals), len(inputs)))
        scales = np.ones(len(moving))
        # The points as they are, and with one input after the other a little larger: all in one evaluation.
        moved = [np.tile(x, (1 + len(moving), 1)) for x in inputs]
        relative = [*self._relative, *(True for _ in auxiliary)]
        for row, i in enumerate(moving):
            step = inputs[i] * step_size if relative[i] else np.full(count, step_size * self._reach[i])
            # Variables are measured as BranchingWeights.widths does, columns as clusters do.
            scales[row] = step_size if relative[i] or i < n else step[0]
            moved[i][1 + row] += step
        with np.errstate(all="ignore"):
            values = [np.broadcast_to(np.asarray(v, dtype=float), moved[0].shape) for v in evaluate(moved)]
            goals = np.array([np.abs(v[0]) for v in values[len(nodes) - len(question.goals) :]]).reshape(-1, count)
            sizes = _medians(np.where(goals > 0, goals, np.nan))
            changed = np.array([size[1:] - size[0] for size in self._sizes(values)])
            if changed.size:
                steep = _medians(np.abs(changed) / scales[:, None])
                result[:, moving] = np.minimum(steep, self._settings.largest_influence)
        return result, np.where(sizes > 0, sizes, 1.0)

    def _sizes(self, values: Sequence[np.ndarray]) -> list[np.ndarray]:
        """Return limits as log(value/limit) and objectives as logarithms, or as scaled differences."""
        sides = iter(values)
        result = []
        for constraint in self._question.constraints:
            value = next(sides)
            limit = np.full(value.shape, constraint.bound) if constraint.limit is None else next(sides)
            size = np.maximum(np.maximum(np.abs(value), np.abs(limit)), constraint.scale)
            result.append(np.where((value > 0) & (limit > 0), np.log(value / limit), (value - limit) / size))
        for _ in self._question.goals:
            value = next(sides)
            size = _medians(np.abs(value))[:, None]
            result.append(np.where(value > 0, np.log(value), value / np.where(size > 0, size, 1.0)))
        return result


def _medians(values: np.ndarray) -> np.ndarray:
    """Return the median of what is finite in each row, 0 where nothing is."""
    ordered = np.sort(np.where(np.isfinite(values), values, np.nan), axis=-1)
    count = np.isfinite(ordered).sum(axis=-1, keepdims=True)
    middle = [np.take_along_axis(ordered, np.maximum(k, 0), axis=-1) for k in ((count - 1) // 2, count // 2)]
    with np.errstate(all="ignore"):
        result: np.ndarray = np.where(count > 0, 0.5 * (middle[0] + middle[1]), 0.0)[..., 0]
    return result
