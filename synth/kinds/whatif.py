"""The kind ``whatif``: the keys of a spec, ``vary`` and ``breaks``, or ``of`` an earlier job with what changes.

Of an earlier job all is taken over but ``points``, which are those of a study unless the request says otherwise.

Ends and a count, which Python states as a tuple, are ``{"from": "200 mm", "to": "300 mm", "count": 11}``.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from synth.errors import InputError, gathered
from synth.kinds.asked import (
    by_name,
    catalogs_of,
    json_record,
    of_files,
    problem_of,
    question_of,
    read_json,
    spec_of,
    stated_spec,
    titled,
    words,
)
from synth.kinds.settings import KIND_SETTINGS
from synth.model.model import Model
from synth.order.feasibility import Status
from synth.question.arguments import Objectives
from synth.question.objectives import chosen_objectives
from synth.queue.records import CheckedRequest, Record, ReportProgress, Sources
from synth.results.plain import plain
from synth.studies.whatif.run import POINTS, study_of
from synth.studies.whatif.steps import check_steps
from synth.studies.whatif.study_record import study_record
from synth.studies.whatif.vary import Varied, read_vary
from synth.verbs.request import WHERE, in_request
from synth.verbs.requests import OF, SPEC, VARIED_ENDS, WhatIfRequest

MAIN = "study.json"
VARY, BREAKS = "vary", "breaks"


def read(request: Mapping[str, object], sources: Sources) -> CheckedRequest:
    """Check a request; of many steps some are posed, spread evenly, and all when the work begins.

    Raises
    ------
    InputError
        For everything that is wrong with it.
    """
    spec, own = spec_of(request, sources, (VARY, BREAKS))
    if request.get(OF) is not None and request.get("points") is None:
        spec.pop("points", None)  # those of a whole front are far more than a step needs
    beyond = WhatIfRequest.read(own, in_request)
    asked, settings = question_of(spec, sources, points=POINTS)
    varied, count = check_steps(asked, settings, beyond.vary, KIND_SETTINGS.posed_steps)
    if count > KIND_SETTINGS.steps:
        raise InputError(f"{WHERE}: vary", f"{count} steps", f"at most {KIND_SETTINGS.steps} steps", (VARY,))
    stated = stated_spec(asked, settings)
    return CheckedRequest(
        request={**stated, VARY: _stated_vary(beyond.vary), BREAKS: beyond.breaks},
        title=f"What if {', '.join(map(words, varied))}: {titled(asked)}",
        families=(asked.problem.name,),
        bulk=count > KIND_SETTINGS.interactive_steps,
        steps=count,
    )


def beside(request: Mapping[str, object], sources: Sources) -> tuple[dict[str, Any], list[InputError]]:
    """Return the spec in a request, and what is wrong with what varies.

    A requirement that is varied need not be stated: its first value stands in the spec then.
    """
    spec = {key: value for key, value in request.items() if key not in (VARY, BREAKS)}
    faults: list[InputError] = []
    stated, vary = request.get(VARY), dict[str, Any]()
    with gathered(faults):
        if (breaks := request.get(BREAKS)) is not None:
            WhatIfRequest.fields()[BREAKS].read(in_request(BREAKS), breaks)
    if not isinstance(stated, Mapping) or not stated:
        with gathered(faults):
            WhatIfRequest.read({VARY: stated}, in_request)
        return spec, faults
    for name, values in stated.items():
        with gathered(faults):
            vary |= WhatIfRequest.read({VARY: {name: values}}, in_request).vary
    with gathered([]):  # of the spec: its check tells it
        known = {key: value for key, value in spec.items() if key in (*SPEC, OF)}
        whole, _ = spec_of(known, sources)
        tables = catalogs_of(whole.get("catalogs"), sources)
        problem = problem_of(whole)
        declared = problem.model(frozenset(), tables).declaration
        names, given = declared.names(), dict(whole.get("requirements") or {})
        there = {names.get(str(word)) for word in given}
        stated_names = {str(name) for name in (there | {names.get(name) for name in vary}) & {*declared.requirements}}
        model = problem.model(frozenset(stated_names), tables)
        chosen = _objectives(model, whole.get("objectives"))
        found: list[Varied] = []
        for name, values in vary.items():
            with gathered(faults):
                found += read_vary({name: values}, model, chosen)
        if not faults:
            with gathered(faults):
                read_vary(vary, model, chosen)
        given |= {x.name: x.spec_value(x.values[0]) for x in found if x.kind == "requirement" and x.name not in there}
        return {**spec, **whole, "requirements": given}, faults
    return spec, faults


def work(request: Mapping[str, object], sources: Sources, tell: ReportProgress) -> dict[str, Record]:
    """Answer all steps, and find where the best parts or counts change."""
    spec, own = spec_of(request, sources, (VARY, BREAKS))
    beyond = WhatIfRequest.read(own, in_request)
    question = question_of(spec, sources, points=POINTS)
    study = study_of(*question, beyond.vary, tell, beyond.breaks)
    return {**of_files(study.files()), **by_name(json_record(MAIN, study_record(study)))}


def summary(records: Mapping[str, bytes]) -> dict[str, Any]:
    """Return the facts of a study."""
    content = read_json(records, MAIN)
    states = [step["status"] for step in content["steps"]]
    feasible = sum(bool(step["front"] and step["front"]["designs"]) for step in content["steps"])
    stopped = Status.NOT_SOLVED.value in states
    unproven = Status.NOT_FOUND if Status.NOT_FOUND.value in states else Status.INFEASIBLE
    outcome = (Status.FEASIBLE if feasible else Status.NOT_SOLVED if stopped else unproven).value
    if feasible and all(state in (Status.OPTIMAL.value, Status.INFEASIBLE.value) for state in states):
        outcome = Status.OPTIMAL.value  # every step is proven
    return {
        "outcome": outcome,
        "family": content["family"],
        "varied": [one["label"] for one in content["varied"]],
        "steps": len(states),
        "feasible_steps": feasible,
        "breaks": len(content["breaks"]),
        "interrupted": content["interrupted"],
    }


def _objectives(model: Model, stated: Objectives) -> list[str]:
    """Return the objectives of a spec; where they are wrong, which its check tells, those of the family."""
    try:
        return list(chosen_objectives(model, stated))
    except InputError:
        return list(chosen_objectives(model, None))


def _stated_vary(stated: Mapping[str, object]) -> dict[str, Any]:
    """Varied quantity as it is stored."""

    def entry(values: object) -> Any:
        if isinstance(values, Mapping):
            return {key: values[key] for key in VARIED_ENDS}
        return plain(list(values) if isinstance(values, Sequence) and not isinstance(values, str) else values)

    return {str(name): entry(values) for name, values in stated.items()}
