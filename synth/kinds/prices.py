"""The kind ``prices``: ``of`` a job with a front, and what the verb takes beside it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

from synth.kinds.asked import about_front, front_of, of_files, read_json
from synth.order.feasibility import Status
from synth.queue.records import QUESTION, CheckedRequest, Record, ReportProgress, Sources
from synth.studies.prices.run import chosen_designs, prices, read_step
from synth.verbs.requests import PricesRequest

MAIN = "prices.json"


def read(request: Mapping[str, object], sources: Sources) -> CheckedRequest:
    """Check a request; ``design`` is a rank or a list of ranks, all where it is left out.

    Raises
    ------
    InputError
        For everything that is wrong with it.
    """
    of, asked = about_front(request, PricesRequest)
    front, _ = front_of(of, sources)
    ranks = tuple(int(d.rank or 0) for d in chosen_designs(front, asked.design))
    read_step(asked.step)
    return CheckedRequest(
        request={**of.to_json(), **replace(asked, design=ranks).to_json()},
        title=f"Prices: {front.frame.title}, {asked.step}",
        families=(front.frame.family,),
    )


def work(request: Mapping[str, object], sources: Sources, tell: ReportProgress) -> dict[str, Record]:
    """Price everything."""
    of, asked = about_front(request, PricesRequest)
    front, tables = front_of(of, sources)
    found = prices(front, catalogs=tables, progress=tell, **vars(asked))
    return of_files(found.files())


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
