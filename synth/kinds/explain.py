"""The kind ``explain``: the keys of a spec and ``physics``, or ``of`` an earlier job with the entries that change."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

from synth.analysis.settings import WAYS_OUT
from synth.errors import InputError, gathered
from synth.kinds.asked import of_files, question_of, read_json, spec_of, stated_spec, titled
from synth.order.feasibility import Status
from synth.question.request import Request
from synth.question.settings import SearchSettings
from synth.queue.records import QUESTION, CheckedRequest, Record, ReportProgress, Sources
from synth.studies.infeasibility.explain import explanation_of
from synth.studies.infeasibility.explained_question import ExplainedQuestion
from synth.verbs.request import in_request
from synth.verbs.requests import ExplainRequest

MAIN = "explanation.json"
PHYSICS = "physics"


def read(request: Mapping[str, object], sources: Sources) -> CheckedRequest:
    """Check a request; what a search alone goes by (points, gap, weights) is left out.

    Raises
    ------
    InputError
        For everything that is wrong with it.
    """
    spec, own = spec_of(request, sources, (PHYSICS,))
    asked, settings = _asked(spec, sources)
    ExplainedQuestion(asked)
    stated = stated_spec(asked, settings, ("seed", "time_limit"))
    stated = {key: value for key, value in stated.items() if key not in ("objectives", "weights")}
    return CheckedRequest(
        request={**stated, **ExplainRequest.read(own, in_request).to_json()},
        title=f"Ways out: {titled(asked)}",
        families=(asked.problem.name,),
    )


def beside(request: Mapping[str, object], sources: Sources) -> tuple[dict[str, Any], list[InputError]]:
    """Return the spec in a request, and what is wrong beside it."""
    spec = {key: value for key, value in request.items() if key != PHYSICS}
    faults: list[InputError] = []
    with gathered(faults):
        ExplainRequest.read({PHYSICS: request.get(PHYSICS)}, in_request)
    return spec, faults


def work(request: Mapping[str, object], sources: Sources, tell: ReportProgress) -> dict[str, Record]:
    """Find what excludes each other and what would help."""
    spec, own = spec_of(request, sources, (PHYSICS,))
    found = explanation_of(*_asked(spec, sources), tell, ExplainRequest.read(own, in_request).physics)
    return of_files(found.files())


def summary(records: Mapping[str, bytes]) -> dict[str, Any]:
    """Return the facts of an explanation."""
    content = read_json(records, MAIN)
    settled = not content["interrupted"]
    outcome = Status.FEASIBLE if content["feasible"] else Status.INFEASIBLE if settled else Status.NOT_SOLVED
    return {
        "outcome": outcome.value,
        "family": read_json(records, QUESTION)["request"]["family"],
        "message": content["message"],
        "conflict": content["conflict"],
        "ways": len(content["ways"]),
        "proven": bool(content["minimal"]),
        "interrupted": content["interrupted"],
    }


def _asked(spec: Mapping[str, object], sources: Sources) -> tuple[Request, SearchSettings]:
    asked, settings = question_of(spec, sources)
    asked = replace(asked, objectives=None, weights={})
    return asked, SearchSettings(points=1, gap=WAYS_OUT.gap, seed=settings.seed, time_limit=settings.time_limit)
