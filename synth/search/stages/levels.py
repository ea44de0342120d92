"""A front of two objectives level by level: its ends, then the best in the second within cutoffs of the first.

Nothing need be covered between the levels: each design stands by its own level, and by the two ends.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from synth.search.archive import rows_of
from synth.search.front_state import FrontState
from synth.search.joint.levels import CAPPED, SOUGHT, Cutoffs, LevelProof
from synth.search.polishing import polish_extremes
from synth.search.proven_gap import Level, LevelBound
from synth.search.pruning import NonImprovement, PruningRule
from synth.search.stages.best_by_turns import prove_end
from synth.search.stages.first_designs import few_known, search_neighbourhoods
from synth.search.stages.spreading import different
from synth.search.stages.trees import leave_open
from synth.search.turns import TurnBudget


def seek_levels(state: FrontState) -> None:
    """Continue by epsilon levels where a front was not covered soon: its extremes, and designs between them."""
    state.by_levels = True
    if not _prove_ends(state):
        # Designs are hard to find, or boxes hard to close: better designs help with both.
        _intensify(state)
    elif _best_in_both(state):
        state.proof.note_cover(state.cover_within(state.rule.tolerance))
        state.proof.open_combinations = 0.0
        return
    if len(state.form.archive):
        first = state.form.archive.phi[:, CAPPED]
        count = state.task.oversampled + state.task.limits.by_levels.picture
        _explore_levels(state, np.linspace(first.min(), first.max(), count + 2)[1:-1])
    elif state.proof.closed:
        state.proof.open_combinations = 0.0


def _best_in_both(state: FrontState) -> bool:
    """True if one design is the best known in both objectives: once they are proven, it covers everything."""
    phi = state.form.archive.phi[:, : state.task.m]
    return bool(len(phi)) and bool(np.all(phi <= phi.min(axis=0), axis=1).any())


def _intensify(state: FrontState) -> None:
    """Search a few combinations exhaustively, once."""
    if not state.looked_harder:
        state.looked_harder = True
        search_neighbourhoods(state)


def prove_levels(state: FrontState, staircase: NonImprovement) -> bool:
    """Prove designs, each at its own level; True if all are proven.

    A design that is beaten gives its place to the best of its level, which is thereby proven.

    Parameters
    ----------
    state : FrontState
    staircase : NonImprovement
        The designs.
    """
    ends_proven = _prove_ends(state)
    for _ in range(state.task.limits.by_levels.rounds):
        staircase.renew(SOUGHT)
        phi = np.array([c.phi[: state.task.m] for c in staircase.designs])
        phi = phi[~proven_by_levels(state, phi)]
        if not len(phi):
            return ends_proven
        within = phi[:, CAPPED] - state.rule.tolerance[CAPPED] + state.task.tuning.tolerances.rounded
        if not _prove(state, within, phi[:, SOUGHT], staircase):
            break
    return False


def fill_levels(state: FrontState) -> bool:
    """Search between the known designs until there are as many as requested; True if nothing is unresolved.

    Where few are known although they were looked for, hardly anything is feasible between them. Then boxes find what
    there is while they prove it, and looking again would take longer than they do.
    """
    ends_proven, tolerance = _prove_ends(state), state.rule.tolerance
    rounds = state.task.limits.by_levels.rounds + state.task.settings.points
    for _ in range(rounds if ends_proven else 0):
        known = sorted(different(state, list(state.form.archive)), key=lambda c: float(c.phi[CAPPED]))
        phi, before = np.array([c.phi[: state.task.m] for c in known]), state.form.archive.phi
        if len(known) >= state.task.settings.points:
            return True
        if not few_known(state):
            _explore_levels(state, 0.5 * (phi[1:, CAPPED] + phi[:-1, CAPPED]))
            if not np.array_equal(before, state.form.archive.phi):
                continue
        # Nothing within what is as good as a design in the first objective is better than its neighbour in the second.
        gaps = np.stack([phi[1:, CAPPED] - tolerance[CAPPED], phi[:-1, SOUGHT]], axis=1)
        uncovered = np.array([not _covered(state, *gap) for gap in gaps], dtype=bool)
        closed = not uncovered.any() or _prove(state, gaps[uncovered, 0], gaps[uncovered, 1], state.rule)
        if not closed:
            return False
        if np.array_equal(before, state.form.archive.phi):
            state.proof.note_cover(state.cover_within(tolerance))
            return True
    return ends_proven


def _prove_ends(state: FrontState) -> bool:
    """Prove the extreme points, once at each tolerance; True if they are proven."""
    proof, tolerance = state.proof, state.rule.tolerance
    if not any(isinstance(b, LevelBound) and np.array_equal(b.tolerance, tolerance) for b in proof.bounds):
        proof.bounds.append(LevelBound(tolerance, proof.levels))
    result = True
    for k in (CAPPED, SOUGHT):
        ends = [level for level in proof.levels if level.sought == k and np.all(np.isinf(level.within))]
        if not any(len(level.corners) or level.tolerance[k] <= tolerance[k] for level in ends):
            unresolved = prove_end(state, k, lambda: _intensify(state))
            ends = [level for level in proof.levels if level.sought == k and np.all(np.isinf(level.within))]
            if unresolved is not None:
                leave_open(state, unresolved, state.cover_within(tolerance))
            polish_extremes(state.form, state.task.m, float(tolerance.max()))
        result &= any(not len(level.corners) and level.tolerance[k] <= tolerance[k] for level in ends)
    return result


def _prove(state: FrontState, first: np.ndarray, to_beat: np.ndarray, rule: PruningRule) -> bool:
    """Search levels and note their bounds; True if nothing is unresolved. Designs go into the archive."""
    closed = True
    for chunk in _in_numbers(state, len(first)):
        needs = Cutoffs(first=first[chunk], to_beat=to_beat[chunk], tolerance=float(state.rule.tolerance[SOUGHT]))
        cutoffs = _side_by_side(state, needs.distinct())
        levels, budget = state.levels_within(cutoffs), state.turn_budget()
        search = levels.prove_soon if few_known(state) else levels.prove
        state.begin_tree(None)
        try:
            _teach(state, levels)
            search(budget, state.task.limits.by_levels.first)
        finally:
            state.budget.take(budget)
            state.proof.levels += levels.levels()
            _take(state, levels)
        if levels.unproven.any():
            leave_open(state, levels, rule)
            closed = False
    return closed


def _explore_levels(state: FrontState, first: np.ndarray) -> None:
    """Search for designs at levels, without proof.

    Where few boxes tell what is best, designs need not be looked for: where hardly anything is feasible, as between
    the last few makeable designs of a front, solving combinations takes a hundred times as long as the proof. And where
    few designs are known they are left to the proof in any case (:func:`fill_levels`).
    """
    limits = state.task.limits
    for chunk in _in_numbers(state, len(first)):
        anything = np.full(len(first[chunk]), np.inf)
        cutoffs = Cutoffs(first=first[chunk], to_beat=anything, tolerance=float(state.rule.tolerance[SOUGHT]))
        levels = state.levels_within(cutoffs.distinct())
        state.begin_tree(None)
        try:
            _teach(state, levels)
            levels.prove_soon(
                TurnBudget(limits.by_levels.before_looking, replace(limits.further, seconds=0.0)),
                limits.by_levels.first,
            )
            if not few_known(state):
                levels.sweep()
        finally:
            state.proof.levels += levels.levels(only_proven=True)
            _take(state, levels)


def _teach(state: FrontState, levels: LevelProof) -> None:
    """Try the designs known at levels where no others have taught yet where boxes of levels are worth splitting."""
    if state.learned_at_levels is None:
        levels.try_known()


def _take(state: FrontState, levels: LevelProof) -> None:
    """Add the new designs of levels to the archive, and count the work."""
    designs, counters, form = levels.new_designs(), levels.search.form.counters, state.form
    state.learned_at_levels = levels.learned()
    if designs:
        form.archive.add(*rows_of(designs))
    state.counters.scalar_problems += len(levels.cutoffs)
    state.counters.nodes += counters.contracted
    form.counters.add(counters, map(levels.combination_of, counters.solved_combinations))


def _in_numbers(state: FrontState, levels: int) -> Sequence[slice]:
    """Return levels in groups whose combinations can all be numbered."""
    most = max(state.task.tuning.joint.numbers // state.task.instance.combinations.count, 1)
    return [slice(k, k + most) for k in range(0, levels, most)]


def proven_by_levels(state: FrontState, phi: np.ndarray) -> np.ndarray:
    """Tell which designs are proven."""
    result = np.zeros(len(phi), dtype=bool)
    for level in state.proof.levels:
        result |= level.proves(phi, state.rule.tolerance)
    return result


def _covered(state: FrontState, first: float, second: float) -> bool:
    """True if it is proven that nothing within a cutoff of the first objective is better in the second."""
    return any(level.within[CAPPED] >= first and level.least >= second for level in _closed(state))


def _side_by_side(state: FrontState, cutoffs: Cutoffs) -> Cutoffs:
    """Let levels search what is not told by others: those before them, and those that are proven."""
    closed = [(float(level.within[CAPPED]), level.least) for level in _closed(state)]
    excluded = [
        max((within for within, least in closed if within < first and least >= to_beat), default=-np.inf)
        for first, to_beat in zip(cutoffs.first, cutoffs.to_beat, strict=True)
    ]
    return cutoffs.side_by_side(np.array(excluded), float(state.rule.tolerance[CAPPED]))


def _closed(state: FrontState) -> list[Level]:
    """Levels of the second objective that are proven to the requested tolerance."""
    finest = state.rule.tolerance[SOUGHT]
    closed = [level for level in state.proof.levels if level.sought == SOUGHT and not len(level.corners)]
    return [level for level in closed if level.tolerance[SOUGHT] <= finest]
