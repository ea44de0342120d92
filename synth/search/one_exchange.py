"""One-exchange: designs that differ from a known one in one part, and known parts at other places of the front.

It proves nothing: the better the designs known, the less is left for boxes to cover.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from synth.nlp.batch import Tasks
from synth.order.pareto import spread_subset
from synth.search.archive import Candidate
from synth.search.budget import Clock
from synth.search.formulation import Formulation
from synth.search.primal_heuristics import PrimalHeuristics, spread_choice
from synth.search.pruning import EpsilonCover, PruningRule, rows_of_use
from synth.search.refused_cells import not_refused


class OneExchange:
    """Local search by exchange of one part of known designs.

    Parameters
    ----------
    form : Formulation
        Its archive holds the known designs; new ones are added.
    rule : PruningRule
        Tells which designs are of use, and takes them.
    rng : Generator
    """

    def __init__(self, form: Formulation, rule: PruningRule, rng: np.random.Generator) -> None:
        self.form, self.rule, self.rng = form, rule, rng
        self.heuristics = PrimalHeuristics(form, rule, rng, False)
        self.limits = self.heuristics.limits

    def improve(self, clock: Clock) -> None:
        """Exchange one part at a time of the designs known, and try known parts elsewhere on the front.

        The continuous problems of whole neighbourhoods are solved at once, round by round until nothing new comes.
        """
        form, archive = self.form, self.form.archive
        if not form.n or form.instance.combinations.count == 1 or not len(archive):
            return
        expanded: set[int] = set()
        placed: set[tuple[int, bytes]] = set()
        for _ in range(self.limits.rounds):
            clock.check(clock.open)
            # Every part of a design that nobody asked about yet, one at a time ...
            fresh = [k for k, c in enumerate(archive.combination) if int(c) not in expanded]
            spread = spread_subset(archive.phi[fresh][:, self.rule.columns], self.limits.parents)
            fresh = [fresh[int(k)] for k in spread]
            parents = [archive[k] for k in fresh]
            expanded.update(c.combination for c in parents)
            added = self._reach(*self._exchanged(parents)) if parents else 0
            # ... and all parts known to be good at all places of the front.
            if len(self.rule.columns) > 1:
                added += self._reach(*self._elsewhere(placed)) + self._ends(placed)
            if not added:
                return

    def again(self, combinations: np.ndarray, points: np.ndarray) -> None:
        """Take designs as they are where they are feasible, and solve each again from the objectives that it has."""
        form = self.form
        near = form.makeable.nearest(points)
        self.heuristics.offer(near, combinations)
        if form.n:
            _, phi = form.points.feasible_rows(points, combinations)
            self._reach(combinations, points, phi[:, self.rule.columns])

    def _most_solved(self) -> int:
        return self.limits.solved if self.form.continuous.batch_nlp().compiled else self.limits.solved_over_arrays

    def _exchanged(self, parents: Sequence[Candidate]) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Return combinations that differ from a parent in one part, with its variables and phi."""
        form = self.form
        made = [form.instance.combinations.neighbours(c.combination) for c in parents]
        combinations, rows = np.concatenate(made), np.repeat(np.arange(len(made)), [len(x) for x in made])
        _, first = np.unique(combinations, return_index=True)
        first = first[not_refused(form.instance, combinations[first])]
        if len(first) > self._most_solved():
            first = self.rng.choice(first, self._most_solved(), replace=False)
        rows = rows[first]
        variables, phi = np.array([c.variables for c in parents]), np.array([c.phi for c in parents])
        base: np.ndarray = phi[rows][:, self.rule.columns]
        return combinations[first], variables[rows], base

    def _elsewhere(self, placed: set[tuple[int, bytes]]) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Return known combinations with places of the front to try them at."""
        archive, columns = self.form.archive, self.rule.columns
        phi = archive.phi[:, columns]
        places = corners(phi, self.limits.targets)
        chosen = spread_subset(phi, self.limits.families)
        tried = [
            (int(k), place)
            for k in chosen
            for place in places
            if (int(archive.combination[k]), place.tobytes()) not in placed
        ][: self._most_solved()]
        placed.update((int(archive.combination[k]), place.tobytes()) for k, place in tried)
        rows = np.array([k for k, _ in tried], dtype=np.int64)
        bases = np.array([place for _, place in tried]).reshape(len(tried), len(columns))
        return archive.combination[rows], archive.variables[rows], bases

    def _ends(self, placed: set[tuple[int, bytes]]) -> int:
        """Exchange one part of the best design in an objective, for that objective alone."""
        archive, added = self.form.archive, 0
        for k in self.rule.columns:
            parent = archive[int(np.argmin(archive.phi[:, k]))]
            key = (parent.combination, bytes([k]))
            if key not in placed:
                placed.add(key)
                combinations, start, _ = self._exchanged([parent])
                tried = np.append(combinations, parent.combination)
                weights = np.zeros((len(tried), len(self.form.goals)))
                weights[:, self.rule.columns] = self.limits.tie_weight
                weights[:, k] = 1.0
                cutoffs = np.tile(self.rule.fixed_cutoffs, (len(tried), 1))
                tasks = Tasks(weights, np.zeros_like(weights), cutoffs, self.form.objectives.scales, 0.0)
                added += self._solved(tasks, tried, np.concatenate([start, parent.variables[None, :]]))
        return added

    def _improvement(self) -> EpsilonCover:
        """Pruning rule by which every non-dominated design is improving, by however little."""
        rule, archive = self.rule, self.form.archive
        cover = EpsilonCover(
            rule.columns, np.zeros(len(rule.columns)), rule.fixed_cutoffs, self.form.new_archive(rule.columns)
        )
        cover.take(archive.combination, archive.variables, archive.phi)
        return cover

    def _reach(self, combinations: np.ndarray, start: np.ndarray, base: np.ndarray) -> int:
        """Solve from each base straight up, or for the one objective; return how many designs are new."""
        if not len(combinations):
            return 0
        return self._solved(self.heuristics.upwards(base), combinations, start)

    def _solved(self, tasks: Tasks, combinations: np.ndarray, start: np.ndarray) -> int:
        """Solve problems over the full range of the variables, where that may improve; return how many are new."""
        form, columns = self.form, self.rule.columns
        rows = rows_of_use(form, self._improvement(), combinations)
        if not len(rows):
            return 0
        tasks, combinations, start = tasks.take(rows), combinations[rows], start[rows]
        ended = form.continuous.solve_batch(tasks, combinations, start)
        self.heuristics.learn(tasks, combinations, ended)
        if not form.gridded.any():
            return self.heuristics.offer(ended.variables, combinations)
        phi = ended.phi[:, : form.bounded] if max(columns) < form.bounded else ended.phi
        good = np.flatnonzero((ended.violation <= form.tuning.nlp.missed) & np.all(np.isfinite(phi), axis=1))
        cell = form.boxes.cell_of(combinations[good])
        gain, along = self.rule.possible_gain(phi[good], cell), phi[good][:, columns[0]]
        good = good[gain > 0][spread_choice(along[gain > 0], gain[gain > 0], self.limits.rounded_off)]
        if not len(good):
            return 0
        return self.heuristics.round_off(form.boxes.leaves(combinations[good]), ended.variables[good], tasks.take(good))


def corners(phi: np.ndarray, count: int) -> np.ndarray:
    """Return ends from which to look for designs between known ones, at most so many.

    Two objectives: the lower corners of the widest steps between neighbours. More: known designs, well spread.
    """
    if phi.shape[1] != 2 or len(phi) < 2:
        spread: np.ndarray = phi[spread_subset(phi, count)]
        return spread
    steps = phi[np.argsort(phi[:, 0], kind="stable")]
    low = np.stack([steps[:-1, 0], steps[1:, 1]], axis=1)
    width = np.max((steps[1:, 0] - steps[:-1, 0], steps[:-1, 1] - steps[1:, 1]), axis=0)
    chosen: np.ndarray = low[np.sort(np.argsort(-width, kind="stable")[:count])]
    return chosen
