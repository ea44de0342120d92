"""The kind ``prices``: ``of`` a job with a front, and what the verb takes beside it."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from synth.kinds.asked import (
    FAMILY,
    OF,
    by_name,
    checked_keys,
    front_of,
    of_files,
    question_record,
    read_json,
    seconds,
    told,
)
from synth.kinds.request_schemas import keys_of
from synth.order.feasibility import Status
from synth.queue.records import QUESTION, CheckedRequest, Record, ReportProgress, Sources
from synth.studies.prices.run import chosen_designs, prices, read_step

MAIN = "prices.json"
KEYS = keys_of("prices")
STEP = "1 %"


def read(request: Mapping[str, Any], sources: Sources) -> CheckedRequest:
    """Check a request; ``design`` is a rank or a list of ranks, all where it is left out.

    Raises
    ------
    InputError
        For everything that is wrong with it.
    """
    given = checked_keys(request, KEYS)
    front, _ = front_of(given, sources)
    ranks = [int(d.rank or 0) for d in chosen_designs(front, given.get("design"))]
    step = given.get("step", STEP)
    read_step(step)
    limit = seconds(given.get("time_limit"))
    stated = {key: given[key] for key in (OF, FAMILY) if key in given}
    return CheckedRequest(
        request={**stated, "design": ranks, "step": step, **({} if limit is None else {"time_limit": limit})},
        title=f"Prices: {front.frame.title}, {step}",
        families=(front.frame.family,),
    )


def work(request: Mapping[str, Any], sources: Sources, tell: ReportProgress) -> dict[str, Record]:
    """Tell what a per cent of everything costs."""
    front, tables = front_of(request, sources)
    found = prices(
        front,
        list(request["design"]),
        request["step"],
        catalogs=tables,
        progress=told(tell),
        time_limit=request.get("time_limit"),
    )
    return {**of_files(found.files()), **by_name(question_record("prices", request, sources))}


def summary(records: Mapping[str, bytes]) -> dict[str, Any]:
    """Return the facts of prices."""
    content = read_json(records, MAIN)
    asked = read_json(records, QUESTION)["request"]
    return {
        "outcome": (Status.FEASIBLE if content["designs"] else Status.NOT_SOLVED).value,
        "designs": len(content["designs"]),
        "asked": len(asked["design"]),
        "prices": sum(len(rows) for rows in content["designs"].values()),
        "step": asked["step"],
    }
