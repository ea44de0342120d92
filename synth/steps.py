"""Two objectives, one step at a time: the best in the second while the first is capped ever lower.

A box from which both objectives could still be good is capped by nothing: whatever a known design excludes is a corner
of it, not a side. Where limits leave little room such boxes make up most of a cover. With the first objective capped
outright each step is a search for one best design, and a dozen of them cover a front.
"""

from __future__ import annotations

import numpy as np

from synth.clock import Clock
from synth.cover import Covered, cover
from synth.formulation import TIE, Archive, Boxes, Candidate, Formulation
from synth.purposes import Cover
from synth.seeker import Seeker
from synth.settle import settle_variables

CAPPED, SOUGHT = 0, 1


def cover_by_steps(
    form: Formulation, pool: Boxes, purpose: Cover, clock: Clock, rng: np.random.Generator, effort: float
) -> Covered:
    """Cover everything by known designs, as ``cover`` does, for two objectives.

    Half of the slack is for the proof of a step, half for the choice of the design that stands for it: the one that
    reaches furthest in the other objective.

    Parameters
    ----------
    form : Formulation
    pool : Boxes
        Everything that may hold a feasible design.
    purpose : Cover
        Its slack is what counts; designs go into the archive of the formulation.
    clock : Clock
    rng : Generator
    effort : float
        Boxes that each step may look into.

    Returns
    -------
    Covered
        What steps left open, without what was covered meanwhile.
    """
    half = purpose.slack[SOUGHT] / 2
    plain = np.full(len(form.goals), np.inf)
    # The other end first: good designs there are often not far from good in both.
    end = Cover([CAPPED], purpose.slack[CAPPED : CAPPED + 1], plain, Archive([CAPPED], form.n, len(form.goals)))
    end.take(form.archive.combination, form.archive.variables, form.archive.phi)
    looked, left = cover(form, pool, end, clock, rng, effort).looked, [form.lean(form.nothing())]
    Seeker(form, purpose, rng, False).beside(clock)
    while True:
        step = _step(form, half, plain)
        outcome = cover(form, pool, step, clock, rng, effort)
        looked += outcome.looked
        left.append(form.lean(outcome.open))
        if not len(step.known):
            break
        _stretch(form, step.known[0], half)
        phi = form.archive.phi
        good = (phi[:, SOUGHT] <= step.known.phi[0, SOUGHT] + half) & (phi[:, CAPPED] <= plain[CAPPED] + TIE)
        plain[CAPPED] = phi[good, CAPPED].min() - purpose.slack[CAPPED]
    still = Boxes.joined(left)
    return Covered(still.take(purpose.room(form.phi_of(still.bounds)) > 0), looked)


def prove_by_steps(
    form: Formulation,
    pool: Boxes,
    designs: list[Candidate],
    slack: np.ndarray,
    clock: Clock,
    rng: np.random.Generator,
    effort: float,
) -> tuple[list[bool], Boxes, int]:
    """Prove that nothing is better than a design by more than the slack in both objectives, design by design.

    What is better is found on the way and goes into the archive of the formulation.

    Parameters
    ----------
    form, pool, clock, rng, effort
        As for :func:`cover_by_steps`.
    designs : list of Candidate
        None dominated by a known one.
    slack : array (2,)
        In phi.

    Returns
    -------
    tuple
        Whether each design stands, what was left open, and how many boxes were looked into.
    """
    stands, left, looked = [], [form.lean(form.nothing())], 0
    for design in designs:
        plain = np.full(len(form.goals), np.inf)
        plain[CAPPED] = design.phi[CAPPED] - slack[CAPPED]
        step = _step(form, slack[SOUGHT], plain)
        _bar(step, design.phi[SOUGHT])
        outcome = cover(form, pool, step, clock, rng, effort)
        looked += outcome.looked
        left.append(form.lean(outcome.open))
        stands.append(step.known.phi[0, SOUGHT] >= design.phi[SOUGHT] - slack[SOUGHT])
    return stands, Boxes.joined(left), looked


def prove_ends(
    form: Formulation, pool: Boxes, slack: np.ndarray, clock: Clock, rng: np.random.Generator, effort: float
) -> tuple[bool, Boxes, int]:
    """Prove that the best known in each objective is the best there is; tell so, what is open, and the boxes."""
    stand, left, looked = True, [form.lean(form.nothing())], 0
    for k in (CAPPED, SOUGHT):
        best = form.archive.phi[:, k].min()
        step = Cover([k], slack[k : k + 1], np.full(len(form.goals), np.inf), Archive([k], form.n, len(form.goals)))
        step.take(form.archive.combination, form.archive.variables, form.archive.phi)
        outcome = cover(form, pool, step, clock, rng, effort)
        looked += outcome.looked
        left.append(form.lean(outcome.open))
        stand &= bool(step.known.phi[0, k] >= best - slack[k])
    return stand, Boxes.joined(left), looked


def _step(form: Formulation, slack: float, plain: np.ndarray) -> Cover:
    """Return the search for the best in the second objective, with the designs known that keep the cap."""
    step = Cover([SOUGHT], np.array([slack]), plain.copy(), Archive([SOUGHT], form.n, len(form.goals)))
    step.take(form.archive.combination, form.archive.variables, form.archive.phi)
    return step


def _bar(step: Cover, phi: float) -> None:
    """Set what must be beaten: a value of the second objective that no design stands for."""
    row = np.where(np.arange(len(step.plain)) == SOUGHT, phi, -np.inf)
    step.known.add(np.array([-1]), np.full((1, step.known.variables.shape[1]), np.nan), row[None, :])


def _stretch(form: Formulation, best: Candidate, room: float) -> None:
    """Add what the parts of a design reach in the first objective while the second gives way a little."""
    given = np.where(np.arange(len(best.phi)) == SOUGHT, room, 0.0)
    loose = Candidate(best.combination, best.variables, best.phi + given)
    points = settle_variables(form, [loose], 2, [CAPPED])[0].variables[None, :]
    combination = np.array([best.combination])
    rows, phi = form.feasible_rows(points, combination)
    form.archive.add(combination[rows], points[rows], phi[rows])
