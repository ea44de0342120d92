"""Why nothing is feasible, over the whole catalogue, and what would make it so."""

from __future__ import annotations

import math
import time

from synth.analysis.fired_guards import fired_guards
from synth.analysis.settings import WAYS_OUT
from synth.question.arguments import Family, Limits, PartRules, Pins, Requirements, Scatter, UserTables
from synth.question.request import Request
from synth.question.settings import Progress, SearchSettings, check_progress
from synth.studies.infeasibility.conflict import irreducible_subset
from synth.studies.infeasibility.explained_question import ExplainedQuestion
from synth.studies.infeasibility.explanation import Explanation, Relaxation
from synth.studies.infeasibility.joint_way import JointWay, widened
from synth.studies.infeasibility.least_amount import Giving, RelaxedSearch
from synth.studies.infeasibility.patches import Patches
from synth.studies.infeasibility.relaxation import COLUMN, LIMIT
from synth.studies.infeasibility.single_ways import CHOICE, SingleWays, trials
from synth.system.deadline import stoppable


def explain(
    p: Family,
    requirements: Requirements,
    *,
    catalogs: UserTables = None,
    parts: PartRules | None = None,
    limits: Limits | None = None,
    fix: Pins | None = None,
    grid: bool = True,
    seed: int = 0,
    progress: Progress | None = None,
    time_limit: float | None = None,
    robust: Scatter | None = None,
    physics: bool = False,
) -> Explanation:
    """Tell why nothing is feasible, over all combinations of parts and counts, and what would make it so.

    Parameters
    ----------
    p, requirements, catalogs, parts, limits, fix, grid, seed, robust
        As for ``synthesize``.
    progress : callable, optional
        Called with a mapping: stage, done (0..1), message.
    time_limit : float, optional
        Seconds; what was found until then is returned.
    physics : bool
        Whether limits of the family may give way as well: alone, and all together with the user's own.

    Returns
    -------
    Explanation

    Raises
    ------
    InputError
        For everything that is wrong with the input, in one sentence.
    """
    begin = time.monotonic()
    settings = SearchSettings(points=1, gap=WAYS_OUT.gap, seed=seed, time_limit=time_limit)
    check_progress(progress)
    request = Request.of(p, requirements, catalogs, robust, parts=parts, limits=limits, fix=fix, grid=grid)
    return explanation_of(request, settings.since(begin), progress, physics)


def explanation_of(
    request: Request, settings: SearchSettings, progress: Progress | None = None, physics: bool = False
) -> Explanation:
    """Tell why nothing is feasible; of the settings the seed and the time limit count.

    Raises
    ------
    InputError
        For everything that is wrong with the request, in one sentence.
    """
    begin = time.monotonic()
    deadline = math.inf if settings.time_limit is None else begin + settings.time_limit
    search = RelaxedSearch(ExplainedQuestion(request), settings, deadline, progress)
    result = Explanation(guards=tuple(search.question.guards))
    with stoppable(deadline) as ending:
        _explain(search, result, physics)
    result.interrupted = ending.reason
    result.single.sort(key=lambda w: w.amount)
    result.parts.sort(key=lambda w: w.amount)
    result.seconds = time.monotonic() - begin
    return result


def _explain(search: RelaxedSearch, result: Explanation, physics: bool) -> None:
    """Find what excludes each other and what helps, as far as there is time."""
    patches = Patches(search.question, search.ways.slack)
    search.say("guards", 0.0, "what is refused outright")
    result.fired = fired_guards(search.question.instance)
    if not result.fired:
        _find_conflict(search, patches, result, physics)
    if not result.feasible:
        _find_ways(search, patches, result, physics)


def _find_conflict(search: RelaxedSearch, patches: Patches, result: Explanation, physics: bool) -> None:
    """Find which limits exclude each other, if any do."""
    question = search.question
    search.say("limits", 0.02, "all limits together")
    widest = search.least(Giving(give={(LIMIT, name): question.sign(name) for name in question.giving}))
    if widest.design is not None and widest.amount <= search.ways.nothing:
        result.feasible = True
        return
    search.say("conflict", 0.1, "which limits exclude each other")
    result.conflict, result.minimal = irreducible_subset(search, patches, widest.design)
    if physics and widest.design is not None:
        result.physics = widened(patches, widest, widest.design)


def _find_ways(search: RelaxedSearch, patches: Patches, result: Explanation, physics: bool) -> None:
    """Find what makes it feasible: one thing alone, and all that was asked together."""
    single_ways, tried = SingleWays(search, patches), trials(search.question, result.fired, result.conflict, physics)
    for k, trial in enumerate(tried):
        search.say("ways out", 0.2 + 0.7 * k / len(tried), str(trial))
        way = single_ways.way(trial)
        if isinstance(way, Relaxation):
            place = {COLUMN: result.parts, CHOICE: result.choices}.get(trial.kind, result.single)
            place.append(way)
        elif way is not None:
            result.not_settled.append(way)
    search.say("joint", 0.9, "all that was asked together")
    result.joint = JointWay(search, patches, result.single, result.conflict).way()
