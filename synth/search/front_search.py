"""From a requirement to ranked Pareto designs over all combinations of parts and counts."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

from synth.analysis.designs import make_frame
from synth.question.settings import Progress
from synth.results import Design, Frame, ParetoFront
from synth.results.least_infeasible import LeastInfeasible
from synth.results.search_record import SettingsRecord
from synth.search.front_claim import claim_no_less, settle_proof
from synth.search.front_report import designs_at_stop, front_result, settled_designs
from synth.search.front_state import FrontState, FrontTask
from synth.search.least_infeasible import explain_infeasible
from synth.search.stages.choosing import choose_designs
from synth.search.stages.covering import cover_front
from synth.search.stages.first_by_rank import find_first, first_is_listed
from synth.search.stages.first_designs import bound_everything, find_first_designs
from synth.search.stages.one_best import find_extremes
from synth.search.stages.stopping import stop_early
from synth.search.starting_front import starting_front
from synth.system.deadline import stoppable


@dataclass(frozen=True, kw_only=True)
class Report:
    """What a front is to tell beside its designs.

    Parameters
    ----------
    weights : list of float
        Of the objectives, for the ranking.
    settings : SettingsRecord
        As they were asked for; kept with the front.
    explained : bool
        Tell why, where nothing is feasible.
    """

    weights: Sequence[float]
    settings: SettingsRecord = field(default_factory=SettingsRecord)
    explained: bool = True


class FrontSearch:
    """One run: the front, its extremes, ties, and the report.

    Parameters
    ----------
    task : FrontTask
    progress : callable, optional
        Told how far the search is.
    """

    def __init__(self, task: FrontTask, progress: Progress | None = None) -> None:
        self.state = FrontState(task, progress)

    def begin_from(self, front: ParetoFront) -> None:
        """Start from the front of an earlier search of the same question: none of its designs is lost."""
        self.state.start = starting_front(self.state.form, front)

    def run(self, report: Report) -> ParetoFront:
        """Search, and return the front; what stops the search early leaves what is known by then."""
        state = self.state
        frame = make_frame(state.task.instance, state.task.chosen)
        designs: list[Design] = []
        explanation: LeastInfeasible | None = None
        with stoppable(state.clock.deadline) as ending:
            find_designs(state)
            if len(state.form.archive):
                designs = choose_and_report(state, frame, report.weights)
            elif report.explained:
                explanation = explain(state)
        if ending.reason:
            stop_early(state)
            designs = designs_at_stop(state, frame, report.weights) if state.front else []
        return front_result(state, frame, designs, report.settings, explanation, ending.reason)


def find_designs(state: FrontState) -> None:
    """Find the designs that are known when the front is chosen."""
    with state.progress.stage("bounds"):
        bound_everything(state)
    if len(state.pool):
        with state.progress.stage("coarse"):
            find_first_designs(state)
            state.loosen_less()
    if len(state.pool):
        if state.task.m == 1 or not state.form.objectives.log[: state.task.m].all():
            with state.progress.stage("extremes"):
                find_extremes(state)
        if state.task.m > 1:
            with state.progress.stage("front"):
                cover_front(state)


def choose_and_report(state: FrontState, frame: Frame, weights: Sequence[float]) -> list[Design]:
    """Choose the designs to list, and return them as they are told."""
    if state.task.m > 1:
        with state.progress.stage("front"):
            choose_designs(state)
        with state.progress.stage("first"):
            find_first(state, weights)
            if not first_is_listed(state):
                choose_designs(state)
    settle_proof(state)
    if not state.proof.closed:
        claim_no_less(state)
    state.counters.solves_to_find, state.reporting = state.form.counters.nlp_solves, True
    with state.progress.stage("report"):
        return settled_designs(state, frame, weights, state.front)


def explain(state: FrontState) -> LeastInfeasible:
    """Reason why nothing is feasible."""
    searched = set(state.form.counters.solved_combinations)
    with state.progress.stage("explanation"):
        explanation = explain_infeasible(state.form, state.rng, proven=state.proof.closed)
    # What was solved only to explain does not change how the combinations were excluded.
    state.form.counters.solved_combinations = searched
    return explanation
