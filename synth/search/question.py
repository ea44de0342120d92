"""A question as it is posed to the search."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

from synth.bounds.branching import BranchingStatistics
from synth.model.problem import DesignProblem
from synth.question.count_domain import stated
from synth.question.instance import Instance
from synth.question.objectives import chosen_objectives, weights_of
from synth.question.request import Request
from synth.question.settings import Progress, SearchSettings
from synth.results import Design, ParetoFront
from synth.results.search_record import SettingsRecord
from synth.search.front_search import FrontSearch, Report
from synth.search.front_state import FrontTask
from synth.search.settings import TUNING, Tuning
from synth.search.warm_start import WarmStart


@dataclass(frozen=True, kw_only=True)
class Question:
    """A request that has been checked against its model, with every fault reported.

    ``chosen`` are the objectives with their sense, ``weights`` those of all of them.
    ``tuning``: what its search goes by.
    """

    request: Request
    settings: SearchSettings
    instance: Instance
    chosen: Mapping[str, str]
    weights: Mapping[str, float]
    tuning: Tuning = TUNING

    def within(self, seconds: float | None) -> Question:
        """Return the same with another time limit; None: without any."""
        return replace(self, settings=self.settings.within(seconds))

    def record(self) -> SettingsRecord:
        """Record of the question that a front keeps beside its frame, as files keep it."""
        request, settings = self.request, self.settings
        return SettingsRecord(
            points=settings.points,
            gap=settings.gap,
            grid=request.grid,
            seed=settings.seed,
            weights=self.weights,
            parts=request.rules(),
            limits=stated(request.limits),
            fix=stated(request.fix),
        )

    def answer(
        self,
        progress: Progress | None = None,
        known: Sequence[Design] = (),
        explained: bool = True,
        branching: BranchingStatistics | None = None,
        start: ParetoFront | None = None,
    ) -> ParetoFront:
        """Search the designs.

        ``known`` are designs of a similar question, where to look first, ``branching`` what its search has learned of
        where to split. They prove nothing, and no design is taken from them that this question does not allow.
        ``explained``: tell why, where nothing is feasible. ``start`` is the front of an earlier search of this very
        question, to go on from.
        """
        search = self.search(progress, WarmStart(designs=known, branching=branching))
        if start is not None:
            search.begin_from(start)
        return search.run(self.report(explained))

    def experience(self) -> tuple[ParetoFront, BranchingStatistics | None]:
        """Search the designs; return the front and what was learned, if anything, to help with similar questions."""
        search = self.search()
        front, state = search.run(self.report(explained=False)), search.state
        # What was learned where nothing was feasible does not help where something is.
        useful = front.designs and not state.infeasibility_mode
        return front, state.form.bounding.branching.statistics() if useful else None

    def search(self, progress: Progress | None = None, warm: WarmStart | None = None) -> FrontSearch:
        """Return the search that answers; ``warm``: what is known of similar questions."""
        task = FrontTask(
            instance=self.instance,
            chosen=self.chosen,
            settings=self.settings,
            tuning=self.tuning,
            warm=warm or WarmStart(),
        )
        return FrontSearch(task, progress)

    def report(self, explained: bool = True) -> Report:
        """Front with its claim; ``explained``: why, where nothing is feasible."""
        return Report(weights=list(self.weights.values()), settings=self.record(), explained=explained)


def pose(
    request: Request, settings: SearchSettings, problem: DesignProblem | None = None, tuning: Tuning = TUNING
) -> Question:
    """Check a request against its model.

    Parameters
    ----------
    request : Request
    settings : SearchSettings
    problem : DesignProblem, optional
        Its problem with the limits posed over the range of what scatters, where that is done already.
    tuning : Tuning
        What its search goes by.

    Raises
    ------
    InputError
        For everything that is wrong with the request, in one sentence.
    """
    if problem is None:
        problem = request.problem
        if request.robust is not None:
            from synth.robust.counterpart import robust_counterpart  # costly to import; few questions need it

            problem = robust_counterpart(problem, request.robust, request.limits)
    instance = Instance(replace(request, problem=problem))
    chosen = chosen_objectives(instance.model, request.objectives)
    weights = dict(zip(chosen, weights_of(instance.model, chosen, request.weights), strict=True))
    return Question(
        request=request, settings=settings, instance=instance, chosen=chosen, weights=weights, tuning=tuning
    )


def one_best(
    instance: Instance, objective: str, settings: SearchSettings, node_limit: int, tuning: Tuning = TUNING
) -> ParetoFront:
    """Return the best design for one objective, for questions that the engine asks itself.

    Where there is none nothing is explained; what ``node_limit`` boxes leave open is left open.
    """
    chosen = chosen_objectives(instance.model, [objective])
    task = FrontTask(instance=instance, chosen=chosen, settings=settings, tuning=tuning, node_limit=node_limit)
    record = SettingsRecord(points=settings.points, gap=settings.gap)
    return FrontSearch(task).run(Report(weights=[1.0], settings=record, explained=False))
