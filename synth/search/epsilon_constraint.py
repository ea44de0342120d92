"""The epsilon-constraint method for two objectives: the best in the second while the first is capped ever lower.

A box from which both objectives could still be good is capped by nothing: whatever a known design excludes is a corner
of it, not a side. Where limits leave little room such boxes make up most of a tree. With the first objective capped
outright each step is a search for one best design, and a dozen of them cover a front.
"""

from __future__ import annotations

import numpy as np

from synth.bounds.boxes import Boxes
from synth.search.archive import Candidate
from synth.search.branch_and_bound import TreeOutcome, best, branch_and_bound, cover_of_one
from synth.search.budget import Clock
from synth.search.formulation import Formulation
from synth.search.one_exchange import OneExchange
from synth.search.polishing import polish_variables
from synth.search.pruning import EpsilonCover, NonImprovement

CAPPED, SOUGHT = 0, 1


def cover_by_epsilon_constraint(
    form: Formulation, pool: Boxes, rule: EpsilonCover, clock: Clock, rng: np.random.Generator, node_limit: float
) -> TreeOutcome:
    """Cover everything by known designs, as ``branch_and_bound`` does, for two objectives.

    Most of the tolerance is for the proof of a step, the rest for the choice of the design that stands for it: the one
    that reaches furthest in the other objective. Where little is left between the two ends it is covered at once: each
    step would look at much the same boxes.

    Parameters
    ----------
    form : Formulation
    pool : Boxes
        Everything that may hold a feasible design.
    rule : EpsilonCover
        Its tolerance is what counts; designs go into the archive of the formulation.
    clock : Clock
    rng : Generator
    node_limit : float
        Boxes that each step may look into.

    Returns
    -------
    TreeOutcome
        What steps left open, without what was covered meanwhile.
    """
    tree, tie = form.tuning.tree, form.tuning.tolerances.tie
    proof = tree.step_proof * rule.tolerance[SOUGHT]
    choice = rule.tolerance[SOUGHT] - proof
    cutoffs = np.full(len(form.goals), np.inf)
    corner = [form.objectives.phi_of(pool.bounds)[:, k].min(initial=np.inf) for k in (CAPPED, SOUGHT)]
    clock.beyond = [np.array(corner)]
    # The other end first: good designs there are often not far from good in both.
    at_end = cover_of_one(form, CAPPED, rule.tolerance[CAPPED], cutoffs)
    first, end = best(form, pool, at_end, clock, rng, node_limit=node_limit)
    looked, left, narrow = end.looked, [form.boxes.lean(form.boxes.nothing())], first is not None and end.closed
    OneExchange(form, rule, rng).improve(clock)
    if end.closed and first is not None:
        corner[CAPPED] = max(corner[CAPPED], first.phi[CAPPED] - rule.tolerance[CAPPED])
    while True:
        # What is better in the capped objective than all steps so far is open, and as bad in the other as the last one.
        clock.beyond = [np.array(corner), *(form.objectives.phi_of(b.bounds)[:, : len(corner)] for b in left)]
        sought = cover_of_one(form, SOUGHT, proof, cutoffs.copy())
        found, outcome = best(form, pool, sought, clock, rng, node_limit=node_limit)
        looked += outcome.looked
        left.append(form.boxes.lean(outcome.open))
        if found is None:
            break
        if outcome.closed:
            corner[SOUGHT] = max(corner[SOUGHT], found.phi[SOUGHT] - proof)
        _stretch(form, found, choice)
        phi = form.archive.phi
        good = (phi[:, SOUGHT] <= found.phi[SOUGHT] + choice) & (phi[:, CAPPED] <= cutoffs[CAPPED] + tie)
        cutoffs[CAPPED] = phi[good, CAPPED].min() - rule.tolerance[CAPPED]
        if first is not None and narrow and cutoffs[CAPPED] - first.phi[CAPPED] <= tree.narrow * rule.tolerance[CAPPED]:
            # Nothing is better in the first objective than its end, so nothing useful is worse than that in the second.
            between = np.where(np.arange(len(cutoffs)) == SOUGHT, first.phi[SOUGHT] - rule.tolerance[SOUGHT], cutoffs)
            rest = EpsilonCover(rule.columns, rule.tolerance, between, form.archive)
            outcome = branch_and_bound(form, pool, rest, clock, rng, min(node_limit, 2 * outcome.looked))
            looked += outcome.looked
            if outcome.closed:
                break
            narrow = False
    still = Boxes.joined(left)
    return TreeOutcome(still.take(rule.possible_gain(form.objectives.phi_of(still.bounds)) > 0), looked)


def prove_by_epsilon_constraint(
    form: Formulation, pool: Boxes, rule: NonImprovement, clock: Clock, rng: np.random.Generator, node_limit: float
) -> TreeOutcome:
    """Prove some designs as one tree for all of them does, but design by design; the ends first.

    A design that is beaten is replaced by the best that its step allows, which is thereby proven itself.

    Parameters
    ----------
    form, pool, clock, rng, node_limit
        As for :func:`cover_by_epsilon_constraint`.
    rule : NonImprovement
        Designs, of two objectives; those that need no proof are left out.

    Returns
    -------
    TreeOutcome
        What was left open.
    """
    nowhere, looked, left = np.full(len(form.goals), np.inf), 0, [form.boxes.lean(form.boxes.nothing())]

    def least(k: int, cutoffs: np.ndarray, phi: float) -> float:
        nonlocal looked
        sought = cover_of_one(form, k, rule.tolerance[k], cutoffs)
        found, outcome = best(form, pool, sought, clock, rng, _to_beat(form, k, phi), node_limit)
        looked += outcome.looked
        left.append(form.boxes.lean(outcome.open))
        if found is None or found.combination < 0:
            return phi
        rule.take(np.array([found.combination]), found.variables[None, :], found.phi[None, :])
        return float(found.phi[k])

    ends = [least(k, nowhere, min(c.phi[k] for c in rule.designs)) for k in (CAPPED, SOUGHT)]
    for design in rule.unproven():
        replaced = not any(c is design for c in rule.designs)
        if replaced or design.phi[CAPPED] <= ends[CAPPED] or design.phi[SOUGHT] <= ends[SOUGHT]:
            continue
        cutoffs = nowhere.copy()
        cutoffs[CAPPED] = design.phi[CAPPED] - rule.tolerance[CAPPED]
        least(SOUGHT, cutoffs, design.phi[SOUGHT])
    return TreeOutcome(Boxes.joined(left), looked)


def _to_beat(form: Formulation, k: int, phi: float) -> Candidate:
    """Return what must be beaten: a value of one objective that no design stands for."""
    return Candidate(-1, np.full(form.n, np.nan), np.where(np.arange(len(form.goals)) == k, phi, -np.inf))


def _stretch(form: Formulation, found: Candidate, allowance: float) -> None:
    """Add what the parts of a design reach in the first objective while the second gives way a little."""
    given = np.where(np.arange(len(found.phi)) == SOUGHT, allowance, 0.0)
    loose = Candidate(found.combination, found.variables, found.phi + given)
    points = polish_variables(form, [loose], 2, [CAPPED])[0].variables[None, :]
    combination = np.array([found.combination])
    rows, phi = form.points.feasible_rows(points, combination)
    form.archive.add(combination[rows], points[rows], phi[rows])
