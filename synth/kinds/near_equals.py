"""The kind ``near_equals``: ``of`` a job with a front, the rank of a design, and what the verb takes beside it."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from synth.errors import whole_number
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
    seed,
    told,
)
from synth.kinds.request_schemas import keys_of
from synth.order.feasibility import Status
from synth.queue.records import CheckedRequest, Record, ReportProgress, Sources
from synth.studies.near_optimal import chosen_design, near_equals, read_share
from synth.text.input_limits import INPUT_LIMITS

MAIN = "near_equals.json"
KEYS = keys_of("near_equals")
USUAL: Mapping[str, Any] = {"design": 1, "within": "2 %", "count": 5}


def read(request: Mapping[str, Any], sources: Sources) -> CheckedRequest:
    """Check a request.

    Raises
    ------
    InputError
        For everything that is wrong with it.
    """
    given = {**USUAL, **checked_keys(request, KEYS)}
    front, _ = front_of(given, sources)
    rank = whole_number(given["design"], "design", INPUT_LIMITS.points, path=("design",))
    chosen_design(front, rank)
    read_share(given["within"])
    count = whole_number(given["count"], "count", INPUT_LIMITS.listed, path=("count",))
    limit = seconds(given.get("time_limit"))
    stated = {key: given[key] for key in (OF, FAMILY) if key in given}
    stated |= {"design": rank, "within": given["within"], "count": count, "seed": seed(given.get("seed"))}
    return CheckedRequest(
        request={**stated, **({} if limit is None else {"time_limit": limit})},
        title=f"Near equals within {given['within']} of design {rank}: {front.frame.title}",
        families=(front.frame.family,),
    )


def work(request: Mapping[str, Any], sources: Sources, tell: ReportProgress) -> dict[str, Record]:
    """Find what is nearly as good."""
    front, tables = front_of(request, sources)
    found = near_equals(
        front,
        request["design"],
        request["within"],
        count=request["count"],
        catalogs=tables,
        seed=request["seed"],
        progress=told(tell),
        time_limit=request.get("time_limit"),
    )
    return {**of_files(found.files()), **by_name(question_record("near_equals", request, sources))}


def summary(records: Mapping[str, bytes]) -> dict[str, Any]:
    """Return the facts of near-equal designs."""
    content = read_json(records, MAIN)
    none = Status.INFEASIBLE if content["complete"] else Status.NOT_SOLVED
    return {
        "outcome": Status.FEASIBLE.value if content["found"] else none.value,
        "family": content["family"],
        "found": content["found"],
        "complete": content["complete"],
        "sentence": content["sentence"],
        "interrupted": content["interrupted"],
    }
