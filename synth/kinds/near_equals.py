"""The kind ``near_equals``: ``of`` a job with a front, the rank of a design, and what the verb takes beside it."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from synth.kinds.asked import about_front, front_of, of_files, read_json
from synth.order.feasibility import Status
from synth.queue.records import CheckedRequest, Record, ReportProgress, Sources
from synth.studies.near_optimal import chosen_design, near_equals, read_share
from synth.verbs.requests import NearEqualsRequest

MAIN = "near_equals.json"


def read(request: Mapping[str, object], sources: Sources) -> CheckedRequest:
    """Check a request.

    Raises
    ------
    InputError
        For everything that is wrong with it.
    """
    of, asked = about_front(request, NearEqualsRequest)
    front, _ = front_of(of, sources)
    chosen_design(front, asked.design)
    read_share(asked.within)
    return CheckedRequest(
        request={**of.to_json(), **asked.to_json()},
        title=f"Near equals within {asked.within} of design {asked.design}: {front.frame.title}",
        families=(front.frame.family,),
    )


def work(request: Mapping[str, object], sources: Sources, tell: ReportProgress) -> dict[str, Record]:
    """Find what is nearly as good."""
    of, asked = about_front(request, NearEqualsRequest)
    front, tables = front_of(of, sources)
    found = near_equals(front, catalogs=tables, progress=tell, **vars(asked))
    return of_files(found.files())


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
