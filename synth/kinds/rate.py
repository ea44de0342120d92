"""The kind ``rate``: designs ``of`` a job with a front, or a design stated with ``values``, and what scatters."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from synth.analysis.design_spec import design_of_spec, must_be_a_design
from synth.errors import InputError
from synth.kinds.asked import about_front, catalogs_of, front_of, of_files, read_json, words
from synth.model.problem import DesignProblem
from synth.order.feasibility import Status
from synth.question.request_fields import FIELDS
from synth.question.spec import spec_from_mapping
from synth.question.uncertainty import read_block
from synth.queue.records import CheckedRequest, Record, ReportProgress, Sources
from synth.results import Design, Frame
from synth.results.plain import plain
from synth.results.ratings import NOT_SHOWN, YES
from synth.robust.rate import rate, rater_for
from synth.studies.prices.run import chosen_designs
from synth.tables.catalogs import Catalogs
from synth.verbs.request import WHERE, in_request, known_keys
from synth.verbs.requests import OF, RateRequest

MAIN = "rating.json"
ROBUST = "robust"
OF_ONE = tuple(name for name in RateRequest.fields() if name != "design")  # of a design that is stated


def read(request: Mapping[str, object], sources: Sources) -> CheckedRequest:
    """Check a request.

    Raises
    ------
    InputError
        For everything that is wrong with it.
    """
    given = _designs(request, sources)
    scattering = read_block(given.block)
    rater_for(given.frame, scattering, given.problem, given.tables)
    stated = {**given.stated, ROBUST: plain(given.block)}
    return CheckedRequest(
        request=stated if given.time_limit is None else {**stated, "time_limit": given.time_limit},
        title=f"Rating: {given.frame.title}, {', '.join(map(words, scattering.names))}",
        families=(given.frame.family,),
    )


def work(request: Mapping[str, object], sources: Sources, tell: ReportProgress) -> dict[str, Record]:
    """Rate the designs."""
    given = _designs(request, sources)
    how: dict[str, Any] = {"progress": tell, "time_limit": given.time_limit}
    found = rate(given.designs, given.block, problem=given.problem, catalogs=given.tables, **how)
    return of_files(found.files())


def summary(records: Mapping[str, bytes]) -> dict[str, Any]:
    """Return the facts of a rating."""
    content = read_json(records, MAIN)
    verdicts = [one["verdict"] for one in content["designs"]]
    holding, unknown = verdicts.count(YES), verdicts.count(NOT_SHOWN)
    none = Status.NOT_SOLVED if content["missing"] or unknown else Status.INFEASIBLE
    return {
        "outcome": Status.FEASIBLE.value if holding else none.value,
        "family": content["family"],
        "rated": content["rated"],
        "holding": holding,
        "not_shown": unknown,
        "missing": content["missing"],
        "sentence": content["sentence"],
        "interrupted": content["interrupted"],
    }


@dataclass(frozen=True, kw_only=True)
class _Given:
    """Designs that are rated: their problem where it is known, their tables, what scatters, and how it is stored."""

    designs: list[Design]
    problem: DesignProblem | None = None
    tables: Catalogs
    block: dict[str, Any]
    frame: Frame
    stated: dict[str, Any]
    time_limit: float | None


def _designs(request: Mapping[str, object], sources: Sources) -> _Given:
    if isinstance(request, Mapping) and request.get(OF) is not None:
        of, asked = about_front(request, RateRequest)
        front, tables = front_of(of, sources)
        designs = chosen_designs(front, asked.design)
        return _Given(
            designs=designs,
            tables=tables,
            block=_block(asked.block(front.frame.restated.get(ROBUST) or {})),
            frame=front.frame,
            stated={**of.to_json(), "design": [int(d.rank or 0) for d in designs]},
            time_limit=asked.time_limit,
        )
    content = known_keys(request, tuple(dict.fromkeys([*FIELDS, *OF_ONE])))
    asked = RateRequest.read({name: content.pop(name, None) for name in OF_ONE}, in_request)
    tables = catalogs_of(content.get("catalogs"), sources)
    spec = spec_from_mapping({k: v for k, v in content.items() if k != "catalogs"}, WHERE, Path())
    must_be_a_design(spec)
    problem, tables, design = design_of_spec(spec, tables)
    return _Given(
        designs=[design],
        problem=problem,
        tables=tables,
        block=_block(asked.block({})),
        frame=design.frame,
        stated={str(k): plain(v) for k, v in content.items()},
        time_limit=asked.time_limit,
    )


def _block(stated: Mapping[str, object] | None) -> dict[str, Any]:
    """What scatters.

    Raises
    ------
    InputError
        Nothing does.
    """
    if not stated:
        right = "what scatters, for example {'friction': 'catalogue range'} (the question has no robust block)"
        raise InputError(in_request(ROBUST), None, right, (ROBUST,))
    return dict(stated)
