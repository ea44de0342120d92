"""Primal heuristics: search boxes that no known design covers, by points, rounding and solves."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from synth.bounds.boxes import Boxes
from synth.nlp.batch import Solutions, Tasks
from synth.order.margins import below
from synth.search.archive import rows_of
from synth.search.formulation import Formulation
from synth.search.polishing import polish_variables
from synth.search.pruning import PruningRule


class PrimalHeuristics:
    """Searches boxes that no known design covers; proves nothing.

    Parameters
    ----------
    form : Formulation
        Designs go into its archive.
    rule : PruningRule
        Tells which designs are of use, and takes them.
    rng : Generator
    every_goal : bool
        Whether boxes are bounded in all objectives, not only in the first ones.
    """

    def __init__(self, form: Formulation, rule: PruningRule, rng: np.random.Generator, every_goal: bool) -> None:
        self.form, self.rule, self.rng, self.every_goal = form, rule, rng, every_goal
        self.limits = form.tuning.heuristics.primal
        self.nlps = self.limits.most_problems // 4
        self.rounds = self.failures = 0

    def search_boxes(self, batch: Boxes) -> None:
        """Try the boxes with the largest possible gain, all along the front.

        After rounds without success this happens only now and then.
        """
        self.rounds += 1
        limits, form = self.limits, self.form
        if self.failures >= limits.patience and self.rounds % (self.failures - limits.patience + 2):
            return
        if form.n and not len(form.archive):
            self._solve_elastic(batch)
        phi = form.objectives.phi_of(batch.bounds)
        gain, along = self.rule.possible_gain(phi, batch.cell), phi[:, self.rule.columns[0]]
        new = self._probe(batch.take(spread_choice(along, gain, limits.probes)))
        if form.n and self._worth_solving():
            most = limits.most_problems if len(self.rule.columns) > 1 else limits.least_problems
            chosen = batch.take(spread_choice(along, gain, min(self.nlps, most)))
            chosen = chosen.take(self.rule.possible_gain(form.objectives.phi_of(chosen.bounds), chosen.cell) > 0)
            good = self._solve(chosen)
            more, fewer = min(2 * self.nlps, limits.most_problems), max(self.nlps // 2, limits.least_problems)
            self.nlps = more if 4 * good > len(chosen) else fewer
            new += good
        if new and len(self.rule.columns) == 1:
            self.polish_best(0, self.rule.columns)
        self.failures = 0 if new else self.failures + 1

    def _worth_solving(self) -> bool:
        """True if boxes are worth a solver: points say as much once designs are known, but along a whole front.

        Before that, optima tell what is worth splitting. Of a whole front they are worth it as long as designs are
        looked for; then points are enough where values are makeable, unless a proof goes on for long: boxes do not
        close around a design that is not known.
        """
        form, rule = self.form, self.rule
        known = len(form.archive) > 0 and form.bounding.branching.learned >= self.limits.learned
        pointed_at = self._known_before and self.rounds <= self.limits.long_proof
        return form.infeasibility or not known or (len(rule.columns) > 1 and not pointed_at)

    @property
    def _known_before(self) -> bool:
        """True if makeable designs were chosen before: what is better than they are points show."""
        return self.rule.proves and bool(self.form.gridded.any())

    @property
    def content(self) -> bool:
        """True if hardly any new designs turn up, so that boxes may be split further before the next search.

        Where few designs of a front are known they are hard to find, and each spares many boxes.
        """
        archive = self.form.archive
        scarce = len(archive.columns) > 1 and len(archive) < self.limits.scarce
        return self._known_before or (self.failures >= self.limits.patience and not scarce)

    def polish_best(self, traded: int, order: Sequence[int]) -> None:
        """Make what is best as good as its parts and makeable values allow: what was rounded may leave much.

        The first ``traded`` objectives stay as good as they are; the others follow in ``order``.
        """
        exact = polish_variables(self.form, self.rule.leading(self.form.archive), traded, order)
        if exact:
            combinations, points, _ = rows_of(exact)
            self.offer(points, combinations)

    def _solve_elastic(self, batch: Boxes) -> None:
        """Solve for the least common violation of all limits: what it depends on is split first."""
        form = self.form
        boxes = batch.take(self.rng.integers(len(batch), size=min(self.limits.elastic, len(batch))))
        combinations = form.boxes.combination(replace(boxes, cell=form.boxes.cells.random_leaves(boxes.cell, self.rng)))
        nothing = np.zeros((len(boxes), len(form.goals)))
        cutoffs = np.tile(self.rule.fixed_cutoffs, (len(boxes), 1))
        tasks = Tasks(nothing, nothing, cutoffs, form.objectives.scales, elastic=1.0)
        solutions = form.continuous.solve_batch(tasks, combinations, form.boxes.inside(boxes, 0.5))
        # The closer limits come to agreeing, the more boxes it takes to show that they do not.
        form.continuous.learn(tasks, solutions, np.maximum(np.abs(solutions.t), self.limits.near) ** -2.0)
        if not form.gridded.any():
            self.offer(solutions.variables, combinations)

    def learn(self, tasks: Tasks, combinations: np.ndarray, solutions: Solutions) -> None:
        """Learn branching weights from optima; in infeasibility mode near-improving ones weigh more."""
        importance = np.ones(len(solutions.t))
        if self.form.infeasibility:
            gain = self.rule.possible_gain(solutions.phi, self.form.boxes.cell_of(combinations))
            excess = np.nan_to_num(-gain, nan=np.inf, posinf=np.inf)
            importance = np.maximum(excess, float(self.rule.tolerance.min())) ** -2.0
        self.form.continuous.learn(tasks, solutions, importance)

    def _tightened(self, boxes: Boxes) -> Boxes:
        cutoffs = self.rule.cutoffs(self.form.objectives.phi_of(boxes.bounds), boxes.cell)
        return self.form.boxes.contract(boxes, cutoffs, every_goal=self.every_goal)

    def _probe(self, boxes: Boxes) -> int:
        """Evaluate points of a random combination of each box; gridded variables are fixed in its middle first."""
        form = self.form
        single = form.boxes.cells.single(boxes.cell).all()
        if not single:
            boxes = replace(boxes, cell=form.boxes.cells.random_leaves(boxes.cell, self.rng))
        if form.gridded.any():
            middle, (low, high) = form.makeable.nearest(form.boxes.inside(boxes, 0.5)), form.boxes.ends(boxes)
            boxes = replace(boxes, low=np.where(form.gridded, middle, low), high=np.where(form.gridded, middle, high))
        if form.gridded.any() or not single:
            boxes = self._tightened(boxes)
        return self._keep(boxes)[0]

    def _keep(self, boxes: Boxes) -> tuple[int, np.ndarray]:
        """Evaluate two points of each box; return how many were new, and which boxes have a feasible one."""
        total, thin, hit = 0, self._thin(boxes), np.zeros(len(boxes), dtype=bool)
        for share in (self.limits.inside, 0.5) if len(boxes) else ():
            points = self.form.makeable.nearest(self.form.boxes.inside(boxes, share))
            new, rows = self._offered(points, self.form.boxes.combination(boxes))
            hit[rows] = True
            total += new
        missed = np.flatnonzero(thin & ~hit)
        if len(missed):
            new, rows = self.on_edge(
                points[missed], self.form.boxes.combination(boxes.take(missed)), self.limits.rounded_off
            )
            hit[missed[rows]] = True
            total += new
        return total, hit

    def _thin(self, boxes: Boxes) -> np.ndarray:
        """Mask of boxes in which limits that nearly exclude each other leave a variable no choice.

        What is feasible there is so by the tolerance alone. Without it such a sliver would be split endlessly along
        the other variables.
        """
        low, high = self.form.boxes.ends(boxes)
        floor = self.limits.thin * np.maximum(np.abs(high), np.abs(low))
        narrow: np.ndarray = np.any((low < high) & (high - low <= floor), axis=1)
        return narrow

    def offer(self, points: np.ndarray, combinations: np.ndarray) -> int:
        """Take what is feasible; return how many designs no known one covered."""
        return self._offered(points, combinations)[0]

    def _offered(self, points: np.ndarray, combinations: np.ndarray) -> tuple[int, np.ndarray]:
        """Number of new designs among points, and the rows that are feasible."""
        rows, phi = self.form.points.feasible_rows(points, combinations)
        return self._add_feasible(points[rows], combinations[rows], phi[rows]), rows

    def _add_feasible(self, points: np.ndarray, combinations: np.ndarray, phi: np.ndarray) -> int:
        """Add feasible designs; return how many no known one covered."""
        if not len(points):
            return 0
        used = self.rule.take(combinations, points, phi)
        self.form.archive.add(combinations, points, phi)
        return used

    def on_edge(self, points: np.ndarray, combinations: np.ndarray, most: int) -> tuple[int, np.ndarray]:
        """Add replacements of points that are feasible by the full tolerance alone.

        That is the best design near to it, of the same parts and makeable values, that keeps the limits more closely.
        Only where there is none the point is taken as it is. It then counts as worse than it is, by more than what the
        tolerance is worth, so that it takes the place of no design that does without.

        Parameters
        ----------
        points, combinations : array (points, variables), array (points,)
        most : int
            So many are looked at, those that promise most.

        Returns
        -------
        tuple
            How many designs no known one covered, and the positions of the points that something stands for.
        """
        form, columns = self.form, self.rule.columns
        rows, phi = form.points.edge_rows(points, combinations)
        if not len(rows):
            return 0, rows
        gain = self.rule.possible_gain(phi[rows], form.boxes.cell_of(combinations[rows]))
        rows, gain = rows[gain > 0], gain[gain > 0]
        rows = rows[spread_choice(phi[rows, columns[0]], gain, most)]
        marks = [(int(c), x.tobytes()) for c, x in zip(combinations[rows], points[rows][:, form.gridded], strict=True)]
        fresh = {mark: row for mark, row in zip(marks, rows.tolist(), strict=True) if mark not in form.kept_closely}
        new = 0
        if fresh:
            kept_rows = np.array(list(fresh.values()))
            base = np.full((len(kept_rows), len(form.goals)), np.inf)
            base[:, columns] = phi[kept_rows][:, columns]
            slopes = np.where(np.isfinite(base), 1.0, 0.0)
            tasks = Tasks(self.limits.tie_weight * slopes, slopes, base, form.objectives.scales, 1.0)
            low, high = (np.where(form.gridded, points[kept_rows], ends) for ends in (form.lower, form.upper))
            answer = form.continuous.solve_batch(tasks, combinations[kept_rows], points[kept_rows], low, high)
            new, kept = self._offered(answer.variables, combinations[kept_rows])
            form.kept_closely.update((mark, k in set(kept.tolist())) for k, mark in enumerate(fresh))
        unsolved = rows[[not form.kept_closely[mark] for mark in marks]]
        worse = phi[unsolved] + form.tuning.tolerances.edge_worth
        return new + self._add_feasible(points[unsolved], combinations[unsolved], worse), rows

    def upwards(self, base: np.ndarray) -> Tasks:
        """Return problems that go from lower ends of the objectives (not-a-number: unknown) straight up."""
        form, columns = self.form, self.rule.columns
        count, goals = len(base), len(form.goals)
        slopes, weights = np.zeros((count, goals)), np.zeros((count, goals))
        cutoffs = np.tile(self.rule.fixed_cutoffs, (count, 1))
        if len(columns) == 1:
            weights[:, columns] = 1.0
        else:
            slope = self.rule.tolerance / self.rule.tolerance.max()
            known = np.isfinite(base)
            cutoffs[:, columns] = np.where(known, base, np.inf)
            slopes[:, columns] = np.where(known, slope, 0.0)
            weights[:, columns] = np.where(known, self.limits.tie_weight / slope, 1.0)
        return Tasks(weights, slopes, cutoffs, form.objectives.scales, 1.0 if len(columns) > 1 else 0.0)

    def _solve(self, boxes: Boxes) -> int:
        """Solve the continuous problems of a random combination of each box: straight up from its lower bounds."""
        form, columns = self.form, self.rule.columns
        if not len(boxes):
            return 0
        if not form.boxes.cells.single(boxes.cell).all():
            boxes = replace(boxes, cell=form.boxes.cells.random_leaves(boxes.cell, self.rng))
            boxes = self._tightened(boxes)
            if not len(boxes):
                return 0
        tasks = self.upwards(form.objectives.phi_of(boxes.bounds)[:, columns])
        combinations = form.boxes.combination(boxes)
        low, high = form.boxes.ends(boxes)
        settled = form.gridded & (low == high)
        low, high = np.where(settled, low, form.lower), np.where(settled, high, form.upper)
        answer = form.continuous.solve_batch(tasks, combinations, form.boxes.inside(boxes, 0.5), low, high)
        self.learn(tasks, combinations, answer)
        makeable = np.all(settled == form.gridded, axis=1)
        new = self.offer(answer.variables[makeable], combinations[makeable])
        fractional = np.flatnonzero(~makeable)
        if not len(fractional):
            return new
        return new + self.round_off(boxes.take(fractional), answer.variables[fractional], tasks.take(fractional))

    def round_off(self, boxes: Boxes, variables: np.ndarray, tasks: Tasks) -> int:
        """Try the makeable points around continuous optima, of which ``tasks`` are the problems.

        What is not gridded is solved for again: of each optimum at the makeable points that promise most, and at all of
        them where what limits leave is so narrow that no point hits it. A point that happens to be feasible is worth
        little, as it may be far from what its makeable values allow.
        """
        form = self.form
        low, high, source = roundings(form, variables)
        bounds = np.full((len(low), boxes.bounds.shape[1]), -np.inf)
        around = self._tightened(replace(boxes.take(source), low=low, high=high, bounds=bounds, tag=source))
        new, hit = self._keep(around)
        if form.gridded.all():
            return new
        missed = np.ones(len(variables), dtype=bool)
        missed[around.tag[hit]] = False
        gain = self.rule.possible_gain(form.objectives.phi_of(around.bounds), around.cell)
        order = np.lexsort((-gain, around.tag))
        place = np.arange(len(order)) - np.searchsorted(around.tag[order], around.tag[order])
        chosen = np.sort(order[(place < self.limits.solved_again) | missed[around.tag[order]]])
        again = around.take(chosen[gain[chosen] > 0])
        if not len(again):
            return new
        low, high = form.boxes.ends(again)
        low, high = np.where(form.gridded, low, form.lower), np.where(form.gridded, high, form.upper)
        combinations = form.boxes.combination(again)
        start = form.boxes.inside(again, 0.5)
        answer = form.continuous.solve_batch(tasks.take(again.tag), combinations, start, low, high)
        return new + self.offer(answer.variables, combinations)


def roundings(form: Formulation, variables: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return boxes (low, high, which design) with gridded variables fixed at values around those of each design."""
    limits, snap = form.tuning.heuristics.primal, form.tuning.tolerances.snap
    reach = limits.reach if (2 * limits.reach) ** int(form.gridded.sum()) <= limits.most_roundings else 1
    steps = np.array(np.meshgrid(*[np.arange(-reach, reach) if g else [0] for g in form.gridded], indexing="ij"))
    steps = steps.reshape(form.n, -1).T
    count = len(steps)
    low = np.tile(form.bounding.question.low[: form.n], (len(variables) * count, 1))
    high = np.tile(form.bounding.question.high[: form.n], (len(variables) * count, 1))
    for k, grid in enumerate(form.makeable.grids):
        if len(grid):
            place = np.searchsorted(grid, below(variables[:, k], snap))[:, None] + steps[None, :, k]
            low[:, k] = high[:, k] = grid[np.clip(place, 0, len(grid) - 1)].ravel()
    return low, high, np.repeat(np.arange(len(variables)), count)


def spread_choice(along: np.ndarray, gain: np.ndarray, count: int) -> np.ndarray:
    """Return positions of boxes with large possible gains, spread along an objective."""
    if len(gain) <= count:
        return np.arange(len(gain))
    order = np.argsort(along, kind="stable")
    group = np.arange(len(order)) * count // len(order)
    by_gain = np.lexsort((-gain[order], group))
    first = np.searchsorted(group[by_gain], np.arange(count))
    chosen: np.ndarray = order[by_gain[first]]
    return chosen
