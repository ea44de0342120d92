"""Joint questions: alike but for the numbers of some requirements, each for its best design in one objective.

Which question a design answers is one more thing to choose among, as a slot is: a box may speak of many questions, is
tightened once for all of them, and is split between them only where that matters. A box is of no use any more when
none of its questions could have a better design in it. What is proven of each question is what a search of its
own would prove.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping, Sequence

import numpy as np

from synth.bounds.boxes import Boxes
from synth.bounds.kernel_subtrees import CutoffTables
from synth.model.model import DataInput
from synth.model.program import InputValue
from synth.question.combinations import JointCombinations
from synth.question.inputs import inputs_of_combination
from synth.question.instance import Instance
from synth.question.requirement_values import RequirementValues
from synth.question.search_space import SearchSpace
from synth.search.archive import Archive, Candidate
from synth.search.formulation import Formulation
from synth.search.pruning import reaches_beyond
from synth.search.settings import TUNING, Tuning


class JointInstance(SearchSpace):
    """Several questions as one: the first digit of a combination is the question.

    What they have in common is that of the first.

    Parameters
    ----------
    each : list of Instance
        That are alike: the same but for the numbers of some requirements.
    moving : collection of str, optional
        Requirements that may differ although they do not here, so that code is compiled once for several searches.
    cutoffs : mapping, optional
        Number of an objective -> the most that it may be in each question, as a value with its sign: it tells
        questions apart.
    floors : mapping, optional
        Number of an objective -> the least that it may be in each question. Of questions that are not told apart the
        lowest one holds.
    """

    scenario_factors = 1
    combinations: JointCombinations

    def __init__(
        self,
        each: Sequence[Instance],
        moving: Collection[str] = (),
        cutoffs: Mapping[int, np.ndarray] | None = None,
        floors: Mapping[int, np.ndarray] | None = None,
    ) -> None:
        self.each, self.first = list(each), each[0]
        self.cutoffs, self.floors = dict(cutoffs or {}), dict(floors or {})
        first, codec = self.first, JointCombinations([i.combinations for i in each])
        super().__init__(first.model, first.ranges, first.limits, first.selection, codec)
        names, required = {*moving, *different(each)}, [i.values.requirements for i in each]
        self.moving = {n: np.array([values[n] for values in required]) for n in required[0] if n in names}

    def owners(self) -> tuple[int, ...]:
        """Factor of each data input of the model; -1 where all questions fix it."""
        inputs = zip(super().owners(), self.model.data_inputs, strict=True)
        return tuple(0 if self._moves(entry) else factor for factor, entry in inputs)

    def column(self, position: int) -> np.ndarray:
        """Return data input number ``position`` for every alternative of the factor it belongs to."""
        entry = self.model.data_inputs[position]
        return self.moving[entry.name] if self._moves(entry) else super().column(position)

    def data(self, combinations: np.ndarray) -> list[InputValue]:
        """Return the data inputs of the model for combinations given by number."""
        every, fixed = np.asarray(combinations, dtype=np.int64), self.first.values
        question = self.combinations.question(every)
        requirements = {**fixed.requirements, **{name: values[question] for name, values in self.moving.items()}}
        return inputs_of_combination(self.model, requirements, fixed.rows, self.combinations, every)

    def values_of(self, combination: int) -> RequirementValues:
        """Return the requirement values of the question that a combination belongs to."""
        return self.each[self.combinations.question(combination)].values

    def _moves(self, entry: DataInput) -> bool:
        return entry.kind == "requirement" and entry.name in self.moving


def different(each: Sequence[Instance]) -> list[str]:
    """Requirements that differ among questions."""
    # Options may leave out requirements.
    required = [i.values.requirements for i in each]
    names = dict.fromkeys(n for values in required for n in values)
    return [n for n in names if len({values[n] for values in required if n in values}) > 1]


class IncumbentPerScenario(Archive):
    """The best feasible design of each question in one objective.

    Parameters
    ----------
    instance : JointInstance
    column : int
        Number of the objective.
    variables, objectives : int
        Width of the stored rows.
    fixed_cutoffs : array (questions, objectives), optional
        Cutoffs of phi that every design of a question must keep.
    tuning : Tuning
    """

    def __init__(
        self,
        instance: JointInstance,
        column: int,
        variables: int,
        objectives: int,
        fixed_cutoffs: np.ndarray | None = None,
        tuning: Tuning = TUNING,
    ) -> None:
        super().__init__([column], variables, objectives, tuning)
        self.tie = tuning.tolerances.tie
        self.instance, self.column = instance, column
        none = np.full((len(instance.each), objectives), np.inf)
        self.fixed_cutoffs = none if fixed_cutoffs is None else fixed_cutoffs

    def add(self, combination: np.ndarray, variables: np.ndarray, phi: np.ndarray) -> None:
        """Take new designs and keep the best of each question; of equal ones that which was known first."""
        keep = np.all(phi <= self.fixed_cutoffs[self.instance.combinations.question(combination)] + self.tie, axis=1)
        if combination is self.combination or not keep.any():
            return
        combination = np.concatenate([self.combination, combination[keep]])
        variables = np.concatenate([self.variables, variables[keep]])
        phi = np.concatenate([self.phi, phi[keep]])
        question = self.instance.combinations.question(combination)
        order = np.lexsort((phi[:, self.column], question))
        _, first = np.unique(question[order], return_index=True)
        best = order[first]
        self.combination, self.variables, self.phi = combination[best], variables[best], phi[best]

    def questions(self) -> np.ndarray:
        """Return the questions of the designs."""
        return self.instance.combinations.question(self.combination)

    def best(self) -> np.ndarray:
        """Return phi of the best design of each question, infinite where none is known."""
        result = np.full(len(self.instance.each), np.inf)
        result[self.questions()] = self.phi[:, self.column]
        return result


class BestPerScenario:
    """Find the best design of each question in one objective.

    Parameters
    ----------
    form : Formulation
        Of a joint instance.
    known : IncumbentPerScenario
    tolerance_of : callable
        Takes phi of the best designs; returns how much better a design must be to be of use.
    requested : array of bool (questions,)
        Other questions need no proof.
    to_beat : array (questions,), optional
        phi that a design must beat as well, whatever is known.
    """

    proves = False

    def __init__(
        self,
        form: Formulation,
        known: IncumbentPerScenario,
        tolerance_of: Callable[[np.ndarray], np.ndarray],
        requested: np.ndarray,
        to_beat: np.ndarray | None = None,
    ) -> None:
        self.form, self.known, self._tolerance_of, self.requested = form, known, tolerance_of, requested
        self._to_beat = np.full(len(requested), np.inf) if to_beat is None else to_beat
        self.columns, self.tie = [known.column], form.tuning.tolerances.tie
        self.tolerance = tolerance_of(np.zeros(1))
        self.fixed_cutoffs = np.full(len(form.goals), np.inf)
        self._tree = form.boxes.cells.trees[0]
        self._fixed_cutoffs = self._tree.hull(known.fixed_cutoffs)[1]
        self._ends: tuple[np.ndarray, np.ndarray] | None = None
        self._polished = np.full(len(requested), np.inf)

    def needed(self) -> np.ndarray:
        """Cutoff in phi of each question."""
        best = np.minimum(self.known.best(), self._to_beat)
        margin = np.where(np.isfinite(best), self._tolerance_of(best), 0.0)
        needed: np.ndarray = np.where(self.requested, best - margin, -np.inf)
        return needed

    def _cutoff(self, cell: np.ndarray) -> np.ndarray:
        """Return, per box, what a design must be better than in one of its questions."""
        if self._ends is None or self._ends[0] is not self.known.phi:
            self._ends = self.known.phi, self._tree.hull(self.needed()[:, None])[1][:, 0]
        cutoff: np.ndarray = self._ends[1][cell[:, 0]]
        return cutoff

    def cutoffs(self, lower: np.ndarray, cell: np.ndarray | None = None) -> np.ndarray:
        """Return, per box with these lower bounds of phi, what a design must keep to be of use."""
        assert cell is not None
        cutoffs: np.ndarray = self._fixed_cutoffs[cell[:, 0], : lower.shape[1]] + self.tie
        k = self.columns[0]
        cutoffs[:, k] = np.minimum(cutoffs[:, k], self._cutoff(cell))
        return cutoffs

    def possible_gain(self, lower: np.ndarray, cell: np.ndarray | None = None) -> np.ndarray:
        """Possible gain of a box over what is needed."""
        assert cell is not None
        cutoff = self._cutoff(cell)
        with np.errstate(all="ignore"):
            distance = cutoff - lower[:, self.columns[0]]
        broken = np.any(lower > self._fixed_cutoffs[cell[:, 0], : lower.shape[1]] + self.tie, axis=1)
        of_no_use = broken | (cutoff == -np.inf)
        gain: np.ndarray = np.where(of_no_use, 0.0, np.where(np.isnan(distance), np.inf, distance))
        return gain

    def take(self, combinations: np.ndarray, variables: np.ndarray, phi: np.ndarray) -> int:
        """Take feasible designs; return how many were of use."""
        new = int((self.possible_gain(phi, self.form.boxes.cell_of(combinations)) > 0).sum())
        self.known.add(combinations, variables, phi)
        return new

    def leading(self, archive: Archive) -> list[Candidate]:
        """Best designs that improved since the last call."""
        best = self.known.best()
        better = best < self._polished - self.tie
        self._polished = np.minimum(best, self._polished)
        return [c for c, q in zip(self.known, self.known.questions(), strict=True) if better[q]]

    def tables(self, form: Formulation) -> CutoffTables | None:
        """Return the cutoffs by the cluster of questions that a box speaks of."""
        if reaches_beyond(self, form.bounded) or np.any(np.isfinite(self._fixed_cutoffs[:, form.bounded :])):
            return None
        cutoffs = self._fixed_cutoffs[:, : form.bounded] + self.tie
        clusters = np.arange(len(cutoffs))[:, None]
        cutoffs[:, self.columns[0]] = np.minimum(cutoffs[:, self.columns[0]], self._cutoff(clusters))
        return CutoffTables(self.columns, np.full(form.bounded, np.inf), of_cluster=form.objectives.values_of(cutoffs))

    def open_questions(self, unresolved: Boxes) -> np.ndarray:
        """Mask of the questions for which unresolved boxes may hold an improving design."""
        needed, result = self.needed(), np.zeros(len(self.requested), dtype=bool)
        if not len(unresolved):
            return result
        lower, clusters = self.form.objectives.phi_of(unresolved.bounds)[:, self.columns[0]], unresolved.cell[:, 0]
        for cluster in np.unique(clusters):
            least = np.nan_to_num(lower[clusters == cluster], nan=-np.inf).min()
            rows = self._tree.rows(int(cluster))
            result[rows] |= needed[rows] > least
        return result
