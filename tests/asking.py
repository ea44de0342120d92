"""Questions as tests state them: in one line, with the arguments of ``synth.synthesize``."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from synth.model.problem import DesignProblem
from synth.question.instance import Instance
from synth.question.request import Request
from synth.question.request_fields import SEARCHED
from synth.question.settings import SearchSettings
from synth.question.uncertainty import Uncertainty
from synth.robust.rating import Rater
from synth.search.question import Question
from synth.search.question import pose as posed
from synth.search.settings import TUNING, Tuning
from synth.studies.whatif.steps import Steps
from synth.tables.catalogs import Catalogs


def pose(
    p: Any,
    requirements: Mapping[str, Any],
    objectives: Any = None,
    points: int = 30,
    catalogs: Any = None,
    parts: Any = None,
    tuning: Tuning = TUNING,
    **more: Any,
) -> Question:
    """Return a question that has been checked."""
    how = {name: more.pop(name) for name in SEARCHED if name in more}
    request = Request.of(p, requirements, catalogs, objectives=objectives, parts=parts, **more)
    return posed(request, SearchSettings(points=points, **how), tuning=tuning)


def instance_of(
    problem: DesignProblem,
    requirements: Mapping[str, Any],
    catalogs: Catalogs,
    parts: Any = None,
    limits: Any = None,
    fix: Any = None,
    grid: bool = True,
    objectives: Any = None,
    **how: bool,
) -> Instance:
    """Return a model with its requirement values and restrictions."""
    asked = {"parts": parts, "limits": limits, "fix": fix, "grid": grid, "objectives": objectives}
    return Instance(Request(problem=problem, requirements=requirements, catalogs=catalogs, **asked), **how)


def rater_of(
    problem: DesignProblem, requirements: Mapping[str, Any], catalogs: Catalogs, limits: Any, block: Uncertainty
) -> Rater:
    """Return what rates designs over a range."""
    return Rater(Request(problem=problem, requirements=requirements, catalogs=catalogs, limits=limits), block)


def steps_of(
    p: Any, requirements: Mapping[str, Any], vary: Any, catalogs: Any = None, robust: Any = None, **more: Any
) -> Steps:
    """Return the questions of a study."""
    how = {name: more.pop(name) for name in SEARCHED if name in more}
    return Steps(Request.of(p, requirements, catalogs, robust, **more), SearchSettings(**how), vary)
