"""The kind ``rate``: designs ``of`` a job with a front, or a design stated with ``values``, and what scatters."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from synth.analysis.design_spec import design_of_spec, must_be_a_design
from synth.errors import InputError
from synth.kinds.asked import (
    FAMILY,
    OF,
    WHERE,
    by_name,
    catalogs_of,
    checked_keys,
    digests,
    front_of,
    of_files,
    question_record,
    read_json,
    seconds,
    told,
    words,
)
from synth.kinds.request_schemas import DESIGN, RATED
from synth.model.problem import DesignProblem
from synth.order.feasibility import Status
from synth.question.spec import spec_from_mapping
from synth.question.uncertainty import read_block
from synth.queue.records import CheckedRequest, Record, ReportProgress, Sources
from synth.results import Design, Frame
from synth.results.plain import plain
from synth.results.ratings import NOT_SHOWN, YES
from synth.robust.rate import rate, rater_for
from synth.studies.prices.run import chosen_designs
from synth.tables.catalogs import Catalogs

MAIN = "rating.json"
ROBUST = "robust"
OF_JOB, OF_DESIGN = (tuple(schema["properties"]) for schema in (RATED, DESIGN))


def read(request: Mapping[str, Any], sources: Sources) -> CheckedRequest:
    """Check a request.

    Raises
    ------
    InputError
        For everything that is wrong with it.
    """
    designs, problem, tables, block, frame = _designs(request, sources)
    limit = seconds(request.get("time_limit"))
    scattering = read_block(block)
    rater_for(frame, scattering, problem, tables)
    stated: dict[str, Any] = {key: request[key] for key in (OF, FAMILY) if request.get(key) is not None}
    if OF in request:
        stated["design"] = [int(d.rank or 0) for d in designs]
    else:
        stated = {str(k): plain(v) for k, v in request.items() if v is not None and k not in (ROBUST, "time_limit")}
    stated |= {ROBUST: plain(block), **({} if limit is None else {"time_limit": limit})}
    return CheckedRequest(
        request=stated,
        title=f"Rating: {frame.title}, {', '.join(map(words, scattering.names))}",
        families=(frame.family,),
        tables=digests(stated.get("catalogs"), sources),
    )


def work(request: Mapping[str, Any], sources: Sources, tell: ReportProgress) -> dict[str, Record]:
    """Rate the designs."""
    designs, problem, tables, block, _ = _designs(request, sources)
    found = rate(
        designs, block, problem=problem, catalogs=tables, progress=told(tell), time_limit=request.get("time_limit")
    )
    return {**of_files(found.files()), **by_name(question_record("rate", request, sources))}


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


def _designs(
    request: Mapping[str, Any], sources: Sources
) -> tuple[list[Design], DesignProblem | None, Catalogs, dict[str, Any], Frame]:
    """Return the designs that are meant, their problem where it is known, tables, what scatters, and their frame."""
    if isinstance(request, Mapping) and request.get(OF) is not None:
        given = checked_keys(request, OF_JOB)
        front, tables = front_of(given, sources)
        designs, problem, known = chosen_designs(front, given.get("design")), None, front.frame.restated.get(ROBUST)
        frame, block = front.frame, given.get(ROBUST) or known
    else:
        given = checked_keys(request, OF_DESIGN)
        tables = catalogs_of(given.get("catalogs"), sources)
        asked = spec_from_mapping({k: v for k, v in given.items() if k != "catalogs"}, WHERE, Path())
        must_be_a_design(asked)
        problem, tables, design = design_of_spec(asked, tables)
        designs, frame, block = [design], design.frame, dict(asked.robust)
    if not block:
        right = "what scatters, for example {'friction': 'catalogue range'} (the question has no robust block)"
        raise InputError(f"{WHERE}: {ROBUST}", None, right, (ROBUST,))
    return designs, problem, tables, dict(block), frame
