"""From a requirement to ranked Pareto designs over all combinations of parts and counts."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace

from synth import deadline
from synth.analysis.designs import make_frame
from synth.compiled.compilation import meanwhile, switched_off
from synth.deadline import Stopped
from synth.question.settings import Progress
from synth.results import Design, Frame, ParetoFront
from synth.results.least_infeasible import LeastInfeasible
from synth.results.search_record import SettingsRecord
from synth.search.archive import Candidate
from synth.search.front_claim import claim_no_less
from synth.search.front_report import designs_as_found, front_found, settled_designs
from synth.search.front_state import FrontState, FrontTask
from synth.search.given_front import given_front
from synth.search.least_infeasible import explain_infeasible
from synth.search.proven_gap import Bound, LevelBound
from synth.search.stages.choosing import choose_designs
from synth.search.stages.covering import cover_front
from synth.search.stages.first_by_rank import find_first, first_is_listed
from synth.search.stages.first_designs import bound_everything, find_first_designs
from synth.search.stages.one_best import find_extremes
from synth.search.stages.stopping import stop_early


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


@dataclass(frozen=True, kw_only=True)
class FoundAside:
    """What a search without compiled code has found and proven while the compiler was at work.

    Parameters
    ----------
    designs : list of Candidate
    bounds : list of Bound or LevelBound
    front : ParetoFront, optional
        Where it has proven everything: the answer if time is over before the search itself has it.
    """

    designs: Sequence[Candidate] = ()
    bounds: Sequence[Bound | LevelBound] = ()
    front: ParetoFront | None = None


class FrontSearch:
    """One run: the front, its extremes, ties, and the report.

    Parameters
    ----------
    task : FrontTask
    progress : callable, optional
        Told how far the search is.
    """

    def __init__(self, task: FrontTask, progress: Progress | None = None) -> None:
        self.state, self.aside = FrontState(task, progress), FoundAside()

    def begin_from(self, front: ParetoFront) -> None:
        """Begin with the front of an earlier search of the same question: none of its designs is lost."""
        self.state.given = given_front(self.state.form, front)

    def run(self, report: Report) -> ParetoFront:
        """Search, and return the front; what stops the search early leaves what is known by then."""
        state, interrupted = self.state, ""
        frame = make_frame(state.task.instance, state.task.chosen)
        designs: list[Design] = []
        explanation: LeastInfeasible | None = None
        try:
            with deadline.until(state.clock.deadline), meanwhile(lambda ready: self.look_aside(ready, report)):
                find_designs(state)
                if len(state.form.archive):
                    designs = choose_and_report(state, frame, report.weights)
                elif report.explained:
                    explanation = explain(state)
        except Stopped as stop:
            interrupted = stop.reason
        except KeyboardInterrupt:
            interrupted = "interrupted"
        if interrupted and self.aside.front is not None:
            return self.aside.front
        if interrupted:
            self._take_aside()
            stop_early(state)
            designs = designs_as_found(state, frame, report.weights) if state.front else []
        return front_found(state, frame, designs, report.settings, explanation, interrupted)

    def look_aside(self, ready: Callable[[], bool], report: Report) -> None:
        """Search without compiled code until the compiler is done: what is found counts if time is over before.

        The search that waits goes on as if nothing had happened, so that its result does not depend on how long the
        compiler takes.

        Parameters
        ----------
        ready : callable
            Tells whether the compiler is done.
        report : Report
        """
        state = self.state
        with switched_off(), deadline.until(state.clock.deadline, ready):
            aside = FrontSearch(self._task_aside(), state.progress.report)
            for c in (*state.form.archive, *self.aside.designs):
                aside.state.take(c)
            found = aside.run(report)
        proven = found.certificate.kind == "global" and not found.interrupted
        self.aside = FoundAside(
            designs=list(aside.state.form.archive),
            bounds=aside.state.proof.bounds,
            front=found if proven else self.aside.front,
        )
        if found.interrupted == "interrupted":
            raise KeyboardInterrupt
        deadline.check()

    def _task_aside(self) -> FrontTask:
        """Return the same question for a search that nothing is compiled for."""
        task = self.state.task
        alone = replace(task.settings, workers=1, time_limit=None)
        warm = replace(task.warm, branching=None)
        return replace(task, settings=alone, node_limit=self.state.node_limit, similar_questions=1, warm=warm)

    def _take_aside(self) -> None:
        """Take what was found and proven without compiled code."""
        for c in self.aside.designs:
            self.state.take(c)
        self.state.proof.bounds += self.aside.bounds


def find_designs(state: FrontState) -> None:
    """Find the designs that are known when the front is chosen."""
    with state.progress.stage("bounds"):
        bound_everything(state)
    if len(state.pool):
        with state.progress.stage("coarse"):
            find_first_designs(state)
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
    if not state.proof.closed:
        claim_no_less(state)
    state.counters.solves_to_find, state.reporting = state.form.counters.nlp_solves, True
    with state.progress.stage("report"):
        return settled_designs(state, frame, weights, state.front)


def explain(state: FrontState) -> LeastInfeasible:
    """Return why nothing is feasible."""
    searched = set(state.form.counters.solved_combinations)
    with state.progress.stage("explanation"):
        explanation = explain_infeasible(state.form, state.rng)
    # What was solved only to explain does not change how the combinations were excluded.
    state.form.counters.solved_combinations = searched
    return explanation
