"""Trees over everything that may be feasible, and what is done about the boxes that they leave open."""

from __future__ import annotations

import time
from dataclasses import replace
from typing import Protocol

import numpy as np

from synth.bounds.boxes import Boxes
from synth.search.best_first import best_first
from synth.search.branch_and_bound import TreeOutcome, branch_and_bound
from synth.search.front_state import FrontState
from synth.search.part_sampling import BEGUN_ANEW, passed_over, sample_parts, study_file
from synth.search.polishing import solve_everywhere
from synth.search.proven_gap import Bound
from synth.search.pruning import EpsilonCover, PruningRule, TabledPruningRule


def cover_everything(
    state: FrontState,
    rule: EpsilonCover,
    node_limit: float,
    enough: int | None = None,
    judged: bool = False,
    unresolved: Boxes | None = None,
) -> TreeOutcome:
    """Cover everything with one tolerance; if the time runs out, the boxes that are open tell what is proven.

    Parameters
    ----------
    state : FrontState
    rule : EpsilonCover
    node_limit : float
        Boxes that may be looked into.
    enough : int, optional
        Stop when more designs than this are known.
    judged : bool
        Stop where a front of two objectives will hardly close at once.
    unresolved : Boxes, optional
        Unresolved boxes of an earlier tree that covered as finely; by default the root box.
    """
    boxes = state.pool if unresolved is None else unresolved
    hopeless = state.hopeless if judged else lambda looked, waiting: False
    state.begin_tree(rule.tolerance)
    outcome = branch_and_bound(state.form, boxes, rule, state.clock, state.rng, node_limit, enough, hopeless)
    return _noted(state, rule, outcome)


def _noted(state: FrontState, rule: EpsilonCover, outcome: TreeOutcome) -> TreeOutcome:
    """Count the boxes; what is covered with one tolerance stays known if the time runs out later."""
    state.end_tree()
    state.counters.nodes += outcome.looked
    reached = rule if outcome.closed else _reached(state, rule, outcome.open)
    if reached is not None:
        state.proof.note_cover(reached)
    return outcome


def _reached(state: FrontState, rule: EpsilonCover, unresolved: Boxes) -> EpsilonCover | None:
    """Cover that holds in unresolved boxes as well, where one as fine as the gap does; None otherwise.

    Boxes too small to be split may stay open at the tolerance of ties, by less than can be told apart.
    """
    corners = state.form.objectives.phi_of(unresolved.bounds)
    missed = float(rule.possible_gain(corners, unresolved.cell).max(initial=0.0))
    wider = rule.tolerance + missed + state.task.tuning.tolerances.tie  # so that rounding does not decide
    if not np.all(wider <= state.rule.tolerance):
        return None
    cover = state.cover_within(wider)
    return None if np.any(cover.possible_gain(corners, unresolved.cell) > 0) else cover


def close_open_boxes(state: FrontState, unresolved: Boxes, rule: TabledPruningRule) -> Boxes:
    """Continue with boxes that a first search has left unresolved; return the unresolved ones and note their bounds.

    Combinations that are few are solved one by one first: boxes close around what is best. Where too many stay open
    to be solved, Optuna draws some of them.
    """
    solved, proof, thorough = False, state.proof, state.task.thorough
    if thorough and len(unresolved):
        solved = _solve_few(state, unresolved, rule)
        unresolved = _go_on(state, unresolved, rule)
    if not len(unresolved):
        return unresolved
    note_unresolved(state, unresolved, rule)
    if thorough and not solved and not _solve_few(state, unresolved, rule):
        _sample_parts(state, unresolved, rule)
        proof.exhausted = False
    proof.exhausted = proof.exhausted and thorough
    return unresolved


def note_unresolved(state: FrontState, unresolved: Boxes, rule: TabledPruningRule) -> None:
    """Note unresolved boxes and their bounds."""
    proof = state.proof
    proof.closed = False
    proof.unresolved += len(unresolved)
    if len(rule.columns) == state.task.m:
        proof.bounds.append(Bound(rule.tolerance, state.form.objectives.phi_of(unresolved.bounds)[:, : state.task.m]))


class UnresolvedTree(Protocol):
    """Interface of a tree with unresolved boxes."""

    @property
    def open_boxes(self) -> int:
        """How many boxes."""

    def open_combinations(self, most: int) -> np.ndarray:
        """Return combinations in them, at most so many."""


def leave_open(state: FrontState, unresolved: UnresolvedTree, rule: PruningRule) -> None:
    """Note unresolved boxes; their combinations are solved one by one where they are few, else a sample."""
    proof, thorough = state.proof, state.task.thorough
    proof.closed = False
    proof.unresolved += unresolved.open_boxes
    solved = thorough and _solved(state, unresolved.open_combinations(state.task.limits.few_combinations + 1), rule)
    if thorough and not solved and not state.sampled:
        _sample_parts(state, state.pool, rule)
        state.sampled = True
    proof.exhausted = proof.exhausted and solved


def _solve_few(state: FrontState, boxes: Boxes, rule: PruningRule) -> bool:
    """Solve the combinations of boxes from several starts, where they are few enough; tell whether they are."""
    most = state.task.limits.few_combinations
    return _solved(state, state.form.boxes.cells.all_members(boxes.cell, most + 1), rule)


def _solved(state: FrontState, combinations: np.ndarray, rule: PruningRule) -> bool:
    """Solve combinations from several starts, where they are few enough; tell whether they are."""
    few = len(combinations) <= state.task.limits.few_combinations
    if few:
        solve_everywhere(state.form, combinations, rule, state.clock, state.rng)
    return few


def _go_on(state: FrontState, unresolved: Boxes, rule: TabledPruningRule) -> Boxes:
    """Continue with boxes while they keep closing and there is time; return the unresolved ones."""
    state.begin_tree(rule.tolerance if len(rule.columns) == state.task.m else None)
    begun, budget = time.monotonic(), state.budget
    limits = replace(state.task.limits.further, seconds=budget.seconds)
    outcome = best_first(state.form, unresolved, rule, state.clock, state.rng, limits)
    budget.seconds -= time.monotonic() - begun
    budget.spent |= outcome.spent
    state.counters.nodes += outcome.looked
    state.end_tree()
    return outcome.open


def _sample_parts(state: FrontState, unresolved: Boxes, rule: PruningRule) -> None:
    """Search sampled combinations of boxes, without proof."""
    task, seed = state.task, state.task.settings.seed
    journal = study_file(task.instance, task.chosen, seed, task.tuning)
    state.progress.say("parts", 0.0, BEGUN_ANEW if passed_over(journal) else "")
    trials = task.tuning.heuristics.parts.trials
    state.counters.sampled_parts += sample_parts(state.form, unresolved, rule, state.clock, journal, seed, trials)
