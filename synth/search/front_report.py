"""What a search tells of what it has found: designs with their ties settled, certificate, statistics, front."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from msgspec import structs

from synth.analysis.designs import make_frame, offered
from synth.analysis.written_digits import written_digits
from synth.order.feasibility import Status
from synth.order.pareto import Scale
from synth.results import Certificate, Design, Frame, ParetoFront
from synth.results.assembly import front_of, ranked
from synth.results.least_infeasible import LeastInfeasible
from synth.results.search_record import SettingsRecord
from synth.results.statistics import SearchStatistics
from synth.search.archive import Candidate, distinct
from synth.search.complete_designs import complete_designs
from synth.search.front_claim import finer_than_ties, gap_amounts, proven_gap
from synth.search.front_state import FrontState
from synth.search.polishing import break_ties
from synth.search.sensitivity import elasticities
from synth.search.stages.one_best import better_in

# -- designs ---------------------------------------------------------------------------------------


def settled_designs(
    state: FrontState, frame: Frame, weights: Sequence[float], chosen: Sequence[Candidate]
) -> list[Design]:
    """Return designs with what the objectives do not see settled, other combinations that tie, and elasticities.

    Parameters
    ----------
    state : FrontState
    frame : Frame
    weights : list of float
        Of the objectives, for the ranking.
    chosen : list of Candidate
    """
    settled, alternatives = _settled(state, chosen)
    state.progress.say("report", 0.5)
    costs = elasticities(state.form, settled, state.task.m) or [{}] * len(settled)
    known: dict[str, Any] = {"status": Status.FEASIBLE, "gap": None}
    if state.proof.closed:
        known = {"status": Status.OPTIMAL, "gap": state.task.settings.gap}
    more = [{**known, "alternatives": a, "elasticity": c} for a, c in zip(alternatives, costs, strict=True)]
    designs = _records(state, frame, settled, more)
    return ranked(designs, state.task.chosen, weights, state.proof.complete, _scale(state))[1]


def designs_at_stop(state: FrontState, frame: Frame, weights: Sequence[float]) -> list[Design]:
    """Designs of the front as they are when the search is stopped."""
    candidates = distinct(state.form.points.as_they_are(state.front), state.task.m, state.task.tuning)
    nothing: Mapping[str, Any] = {"status": Status.FEASIBLE, "gap": None, "alternatives": (), "elasticity": {}}
    records = _records(state, frame, candidates, [nothing] * len(candidates))
    return ranked(records, state.task.chosen, weights, scale=_scale(state))[1]


def further_designs(state: FrontState, candidates: Sequence[Candidate]) -> list[Design]:
    """Designs of candidates that are added to a finished front."""
    frame = make_frame(state.task.instance, state.task.chosen)
    designs = settled_designs(state, frame, [1.0] * state.task.m, candidates)
    state.front = [*state.front, *candidates]
    return designs


def _scale(state: FrontState) -> Scale | None:
    """Scale by which designs of the front are ranked; None where it is not known."""
    return None if state.scored is None else state.scored.scale


def _records(
    state: FrontState, frame: Frame, candidates: Sequence[Candidate], more: Sequence[Mapping[str, object]]
) -> list[Design]:
    """Return candidates as designs, with what else is known of each."""
    points = np.array([c.variables for c in candidates]).reshape(len(candidates), state.form.n)
    numbers = np.array([c.combination for c in candidates], dtype=np.int64)
    result, instance = state.form.points.evaluate(points, numbers), state.form.instance
    digits = written_digits(instance, points, instance.data(numbers), result, list(frame.objectives))
    details = [{"digits": least, **known} for least, known in zip(digits, more, strict=True)]
    return complete_designs(state.form, [frame] * len(candidates), candidates, result, details)


def _settled(state: FrontState, designs: Sequence[Candidate]) -> tuple[list[Candidate], list[tuple[str, ...]]]:
    """Settle ties by the other objectives, and name other combinations that tie."""
    form, m, tuning = state.form, state.task.m, state.task.tuning
    chosen, strict = list(designs), finer_than_ties(state)
    if m == 1 and len(form.goals) > 1:
        # One objective leaves whole families of parts open; the next objective is settled over all of them.
        cutoffs = np.full(len(form.goals), np.inf)
        cutoffs[0] = chosen[0].phi[0] + (0.0 if strict[0] else tuning.tolerances.tie)
        other = better_in(state, 1, cutoffs, chosen[0], tuning.tree.tie)
        if other is not None and not _gives_away(chosen[0], other, strict):
            chosen[0] = other
    pairs: list[tuple[Candidate, tuple[str, ...]]] = []
    while chosen:
        settled = break_ties(form, state.pool, chosen, m)
        before = form.points.as_they_are(chosen)
        listed = form.points.as_they_are([c for c, _ in settled])
        for original, c, (_, a) in zip(before, listed, settled, strict=True):
            pairs.append((original, ()) if _gives_away(original, c, strict) else (c, a))
        stay = {id(c) for c in distinct([c for c, _ in pairs], m, tuning)}
        pairs = [pair for pair in pairs if id(pair[0]) in stay]
        # Where settling has made two designs one, others that stand as well take the place.
        missing = max(state.task.settings.points - len(pairs), 0)
        chosen, state.spare = state.spare[:missing], state.spare[missing:] if missing else []
    return [c for c, _ in pairs], [a for _, a in pairs]


def _gives_away(original: Candidate, other: Candidate, strict: np.ndarray) -> bool:
    """True if a design that ties is worse where even what a tie may give away is more than the claim allows."""
    m = len(strict)
    return bool(np.any(other.phi[:m][strict] > original.phi[:m][strict]))


# -- the front -------------------------------------------------------------------------------------


def front_result(
    state: FrontState,
    frame: Frame,
    designs: Sequence[Design],
    settings: SettingsRecord,
    explanation: LeastInfeasible | None = None,
    interrupted: str = "",
) -> ParetoFront:
    """Return the front with what is proven of it.

    Parameters
    ----------
    state : FrontState
    frame : Frame
    designs : list of Design
        In order of rank.
    settings : SettingsRecord
        As they were asked for.
    explanation : LeastInfeasible, optional
        Why there is no design.
    interrupted : str
        What stopped the search; nothing where it was finished.
    """
    return front_of(
        state.task.instance,
        frame,
        designs,
        _certificate(state, designs, bool(interrupted)),
        _statistics(state),
        settings,
        complete=state.proof.complete,
        explanation=explanation,
        interrupted=interrupted,
        scale=_scale(state),
    )


def _certificate(state: FrontState, designs: Sequence[Design], interrupted: bool) -> Certificate:
    """Statement of the proof: of all combinations, of those solved one by one, or none."""
    task, proof = state.task, state.proof
    kind = "global" if proof.closed else "exhaustive" if proof.exhausted and not interrupted else "heuristic"
    gap = (task.settings.gap if designs else None) if kind == "global" else proven_gap(state)
    spent = task.limits.further.seconds if state.budget.spent and kind != "global" else None
    amounts = gap_amounts(state, gap, designs) if designs and gap is not None else {}
    return Certificate(
        kind,
        gap,
        task.instance.combinations.count,
        _excluded(state),
        len(state.form.counters.solved_combinations),
        proof.unresolved,
        spent,
        amounts,
        {name: task.instance.model.units[name] for name in amounts},
    )


def _excluded(state: FrontState) -> int:
    """Number of combinations that bounds have excluded."""
    total, solved = state.task.instance.combinations.count, len(state.form.counters.solved_combinations)
    still_open = 0.0 if state.proof.closed else state.proof.open_combinations
    return int(max(total - max(still_open, solved), 0))


def _statistics(state: FrontState) -> SearchStatistics:
    """Cost of the search."""
    form, counters = state.form, state.counters
    return structs.replace(
        offered(state.task.instance),
        excluded_by_bound=_excluded(state),
        solved=len(form.counters.solved_combinations),
        boxes=form.counters.contracted,
        scalar_problems=counters.scalar_problems,
        designs_known=len(form.archive),
        nlp_solves=form.counters.nlp_solves,
        nlp_solves_to_find=counters.solves_to_find,
        outer_trials=counters.sampled_parts,
        seconds={**state.progress.seconds, "total": state.progress.elapsed},
    )
