"""The design that is best in one objective: a tree of its own, before the front or as all that is asked."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from synth.bounds.boxes import Boxes
from synth.search.archive import Archive, Candidate, rows_of
from synth.search.branch_and_bound import TreeOutcome, best, cover_of_one
from synth.search.formulation import Formulation
from synth.search.front_state import FrontState
from synth.search.proven_gap import Bound
from synth.search.pruning import EpsilonCover
from synth.search.relaxed_boxes import RelaxedBoxes
from synth.search.resolution import ranges
from synth.search.stages.best_by_turns import BestOfTwoTrees
from synth.search.stages.trees import close_open_boxes, note_unresolved

MOST_MEASURES = (
    4  # of the size of an objective near its best value; each is at least 1e5 times finer for a gap of 0.1 %
)


def find_extremes(state: FrontState) -> None:
    """Find the design that is best in each objective, before the front: its ranges are needed, or it is all.

    Where what is best turns out to be so small that the resolution is coarser than the gap, it is sought once more with
    objectives measured by their size there. An objective that can vanish would go on like that for ever: from the third
    time on a tree that does not close soon ends it, and what is proven by then is told.
    """
    m, times = state.task.m, 0
    while True:
        bests = [best_in(state, k, brief=times > 1) for k in range(m)]
        known = [c for c in bests if c is not None]
        times += 1
        values = np.array([state.form.objectives.values_of(c.phi[:m]) for c in known]).reshape(len(known), m)
        if times > MOST_MEASURES or not known or not state.measure_near(values):
            break
    if m == 1:
        state.front, state.proof.complete = known, state.proof.closed
    elif known:
        sizes = ranges(np.array([c.phi for c in known]))
        state.rule, state.spans = state.cover_at_gap(sizes), sizes[:m]


def best_in(state: FrontState, k: int, brief: bool = False) -> Candidate | None:
    """Optimum of one objective, proven within the gap, or as far as can be proven.

    Parameters
    ----------
    state : FrontState
    k : int
        The number of the objective.
    brief : bool
        Give up where a first tree leaves boxes open.
    """
    no_cutoffs = np.full(len(state.form.goals), np.inf)
    before, limits = len(state.form.archive), state.task.limits
    soon = state.node_limit if state.infeasibility_mode else min(limits.first_try, state.node_limit)
    state.counters.scalar_problems += 1
    incumbent, outcome, tolerance = _best_within(state, k, no_cutoffs, None, soon)
    if brief and not outcome.closed:
        note_unresolved(state, outcome.open, _rule_for_best(state, k, no_cutoffs, tolerance, incumbent))
        state.proof.exhausted = False
        return incumbent
    if not outcome.closed and not state.infeasibility_mode:
        # What is feasible may be so narrow that it costs most to tell which limits leave nothing.
        plain, open_plain, coarse = state.form, outcome.open, tolerance
        state.begin_again(infeasibility=True)
        incumbent, outcome, tolerance = _best_within(state, k, no_cutoffs, incumbent, soon)
        if not outcome.closed:
            # What was settled with a coarser tolerance is not settled.
            open_plain = open_plain if coarse <= tolerance else plain.boxes.root()
            trees = BestOfTwoTrees(state, k, (plain, open_plain), outcome.open, tolerance)
            trees.go_on(limits.together.after)
            worth = not trees.closed and state.task.thorough and limits.together.boxes > 0
            closed_within = _closed_together(state, k, plain) if worth else None
            if closed_within is None:
                trees.go_on(np.inf)
                unresolved = trees.weakest()
            else:
                unresolved, tolerance = state.form.boxes.nothing(), closed_within
            known = state.form.archive
            best_known = known[int(np.argmin(known.phi[:, k]))] if len(known) else None
            if before == 0 and best_known is None and not len(unresolved):
                state.proof.open_combinations = 0.0
            return _close_best(state, _rule_for_best(state, k, no_cutoffs, tolerance, best_known), unresolved)
    if not outcome.closed:
        return _close_best(state, _rule_for_best(state, k, no_cutoffs, tolerance, incumbent), outcome.open)
    if before == 0 and incumbent is None:
        state.proof.open_combinations = 0.0
    return incumbent


def _closed_together(state: FrontState, k: int, plain: Formulation) -> float | None:
    """Tolerance within which a tree of plain boxes closes, bounded by all limits together; None if it does not.

    Boxes may stay open because limits contradict each other only all together.
    """
    other, most, known = state.form, state.task.limits.together.boxes, state.form.archive
    best_known = known[int(np.argmin(known.phi[:, k]))] if len(known) else None
    state.go_on_with(plain)
    _, outcome, tolerance = _best_within(state, k, np.full(len(plain.goals), np.inf), best_known, most, together=True)
    if outcome.closed:
        return tolerance
    if state.task.m == 1:
        # Known whatever the alternating trees yield.
        corners = plain.objectives.phi_of(outcome.open.bounds)[:, :1]
        state.proof.bounds.append(Bound(np.array([tolerance]), corners))
    state.go_on_with(other)
    return None


def better_in(
    state: FrontState, k: int, fixed_cutoffs: np.ndarray, start: Candidate, node_limit: int, finest: float = np.inf
) -> Candidate | None:
    """Best design in one objective after few boxes, without proof.

    Parameters
    ----------
    state, k
        As for :func:`best_in`.
    fixed_cutoffs : array (objectives,)
        phi that the design must keep.
    start : Candidate
        Known already.
    node_limit : int
        Boxes that may be looked into.
    finest : float
        A gap that it shall be found within, where it is smaller than that of the search.
    """
    state.counters.scalar_problems += 1
    return _best_within(state, k, fixed_cutoffs, start, node_limit, finest=finest)[0]


def _best_within(
    state: FrontState,
    k: int,
    fixed_cutoffs: np.ndarray,
    start: Candidate | None,
    node_limit: float,
    together: bool = False,
    finest: float = np.inf,
) -> tuple[Candidate | None, TreeOutcome, float]:
    """Best design within a number of boxes, the outcome of the search, and its tolerance.

    ``together``: boxes are bounded by all limits together as well, as long as it looks as if that will close.
    """
    sizes = None if start is None else np.abs(start.phi)
    tolerance = float(state.form.objectives.tolerance(min(state.task.settings.gap, finest), sizes)[k])
    incumbent, outcome = _tree(state, k, fixed_cutoffs, tolerance, start, node_limit, together)
    while incumbent is not None and outcome.closed:
        # The gap is a share of the best value, whose size is known only now; a better one may be smaller again.
        finer = _finer(state, k, tolerance, [incumbent])
        if finer is None:
            break
        tolerance = finer
        incumbent, outcome = _tree(state, k, fixed_cutoffs, tolerance, incumbent, node_limit, together)
    return incumbent, outcome, tolerance


def _tree(
    state: FrontState,
    k: int,
    fixed_cutoffs: np.ndarray,
    tolerance: float,
    start: Candidate | None,
    node_limit: float,
    together: bool,
) -> tuple[Candidate | None, TreeOutcome]:
    """Search one tree; where there is but one objective, what it leaves open speaks of all designs."""
    state.begin_tree(np.array([tolerance]) if state.task.m == 1 else None)
    rule = cover_of_one(state.form, k, tolerance, fixed_cutoffs)
    form, limits = state.form, state.task.limits.together

    def hopeless(looked: int, waiting: int) -> bool:
        return together and looked >= limits.soon and waiting > limits.stays_open * looked

    relaxed = RelaxedBoxes(form, k) if together else None
    incumbent = best(form, state.pool, rule, state.clock, state.rng, start, node_limit, hopeless, relaxed)
    state.end_tree()
    return incumbent


def _close_best(state: FrontState, rule: EpsilonCover, unresolved: Boxes) -> Candidate | None:
    """Continue with the unresolved boxes of a tree for one best design; return the incumbent."""
    unresolved = close_open_boxes(state, unresolved, rule)
    k = rule.columns[0]
    while not len(unresolved) and (finer := _finer(state, k, float(rule.tolerance[0]), rule.known)) is not None:
        rule = _rule_for_best(state, k, rule.fixed_cutoffs, finer, rule.known[0])
        unresolved = close_open_boxes(state, state.pool, rule)
    return rule.known[0] if len(rule.known) else None


def _rule_for_best(
    state: FrontState, k: int, fixed_cutoffs: np.ndarray, tolerance: float, known: Candidate | None
) -> EpsilonCover:
    """Return the rule for the design that is best in one objective."""
    rule = cover_of_one(state.form, k, tolerance, fixed_cutoffs)
    if known is not None:
        rule.take(*rows_of([known]))
    return rule


def _finer(state: FrontState, k: int, tolerance: float, known: Archive | Sequence[Candidate]) -> float | None:
    """Return the tolerance that the gap means at the best value known; None where it is as fine as that already."""
    if state.task.m > 1 or not len(known) or state.form.objectives.log[k]:
        return None
    finer = float(state.form.objectives.tolerance(state.task.settings.gap, np.abs(known[0].phi))[k])
    return finer if finer < tolerance else None
