"""The verb: requirement in, front out."""

from __future__ import annotations

import time
from collections.abc import Mapping
from dataclasses import replace

from synth.question.arguments import Family, Limits, Objectives, PartRules, Pins, Requirements, Scatter, UserTables
from synth.question.request import Request
from synth.question.settings import Progress, SearchSettings, check_progress
from synth.question.uncertainty import Uncertainty
from synth.results import ParetoFront
from synth.search.question import Question, pose
from synth.search.settings import TUNING, Tuning


def synthesize(
    p: Family,
    requirements: Requirements,
    objectives: Objectives = None,
    points: int = 30,
    *,
    catalogs: UserTables = None,
    parts: PartRules | None = None,
    limits: Limits | None = None,
    fix: Pins | None = None,
    weights: Mapping[str, float] | None = None,
    gap: float = 1e-3,
    grid: bool = True,
    workers: int = 1,
    seed: int = 0,
    progress: Progress | None = None,
    time_limit: float | None = None,
    robust: Scatter | None = None,
) -> ParetoFront:
    """Find the ranked Pareto designs for a requirement.

    Parameters
    ----------
    p : family name, DesignProblem subclass or instance
    requirements : mapping
        Name or symbol -> text with unit ("600 N*m") or bare number in the declared unit.
    objectives : names, or mapping name -> "min"/"max", optional
        The family's defaults when not given.
    points : int
        At most this many designs.
    catalogs : folder or mapping, optional
        Own part tables; others stay the shipped ones.
    parts : mapping, optional
        Slot -> list of designations, or a condition on columns, of other slots too: "thickness == other.thickness".
    limits : mapping, optional
        Quantity -> "<= 260 mm", "200 mm .. 260 mm", "== 4", or a list of them; count -> a set, [8, 12, 16].
    fix : mapping, optional
        Pins variables, counts, choices, parts; counts to a set as well.
    weights : mapping, optional
        Objective -> weight >= 0 for the ranking; 1 where missing.
    gap : float
        Relative improvement in every objective that need not be excluded.
    grid : bool
        True: only makeable values of gridded variables. False: all variables continuous.
    workers : int
        Threads that may tighten boxes at the same time, where kernels compute; the result is the same for any
        number.
    seed : int
        Of all random choices.
    progress : callable, optional
        Called with a mapping: stage, done (0..1), combinations, incumbents, message; at most twice a second ``points``
        as well, the objectives of at most 200 designs that are known, with ``columns``, their names and units.
    time_limit : float, optional
        Seconds after which the best front so far is returned.
    robust : mapping, optional
        What scatters and by how much: {"friction": "catalogue range", "load_torque": "+-10 %"}. Limits then hold over
        the whole range, or designs are only rated ("mode": "rate").

    Returns
    -------
    ParetoFront

    Raises
    ------
    InputError
        For everything that is wrong with the input, in one sentence.
    """
    begun = time.monotonic()
    settings = SearchSettings(points=points, gap=gap, workers=workers, seed=seed, time_limit=time_limit)
    check_progress(progress)
    request = Request.of(
        p,
        requirements,
        catalogs,
        robust,
        objectives=objectives,
        parts=parts,
        limits=limits,
        fix=fix,
        weights=weights,
        grid=grid,
    )
    return find_front(request, settings.since(begun), progress)


def find_front(
    request: Request, settings: SearchSettings, progress: Progress | None = None, tuning: Tuning = TUNING
) -> ParetoFront:
    """Find the ranked Pareto designs for a request; where something scatters, those that stand it, or all rated.

    ``tuning``: what its searches go by.

    Raises
    ------
    InputError
        For everything that is wrong with the request, in one sentence.
    """
    begun = time.monotonic()
    if request.robust is None:
        question = pose(request, settings, tuning=tuning)
        return question.within(settings.since(begun).time_limit).answer(progress)
    # Costly to import; few questions need it.
    from synth.robust.rating import Rater
    from synth.robust.robust_front import robust_front

    rater = Rater(request, request.robust, tuning.robust)
    remaining = settings.since(begun).time_limit

    def question_for(uncertainty: Uncertainty) -> Question:
        return pose(replace(request, robust=uncertainty), settings, tuning=tuning)

    return robust_front(question_for, rater, progress, remaining)
