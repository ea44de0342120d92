"""The kind of job ``size_range``: ``of`` a batch, the standard variants that serve all its rows."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from synth.batches.batch import BatchResult
from synth.batches.store import Store
from synth.errors import Described, InputError
from synth.kinds.asked import catalogs_of, of_files, read_json
from synth.question.request_fields import shown_kind
from synth.queue.job_table import BATCH, LIVE
from synth.queue.models import Job
from synth.queue.records import CheckedRequest, Record, ReportProgress, Sources
from synth.variants.size_range import size_range
from synth.verbs.request import in_request, known_keys
from synth.verbs.requests import OF, VERBS, SizeRangeRequest

MAIN = "size_range.json"


def read(request: Mapping[str, object], sources: Sources) -> CheckedRequest:
    """Check a request: the batch must be there and done.

    Raises
    ------
    InputError
        For everything that is wrong with it.
    """
    stated = known_keys(request, tuple(VERBS["size_range"].fields()))
    asked = SizeRangeRequest.read(stated, in_request)
    job = _batch(stated.get(OF), sources)
    families = tuple(job.content["families"])
    return CheckedRequest(
        request={OF: job.id, **asked.to_json()}, title=f"Size range of {job.title}", families=families, bulk=True
    )


def work(request: Mapping[str, object], sources: Sources, tell: ReportProgress) -> dict[str, Record]:
    """Choose the variants."""
    job = _batch(request[OF], sources)
    stated = job.request.get("catalogs")
    source = BatchResult(
        folder=Path(),
        job=job.id,
        stopped="",
        counts={},
        database=sources.database,
        catalogs=catalogs_of(stated, sources) if stated else None,
    )
    asked = SizeRangeRequest.read(request, in_request)
    return of_files(size_range(source, **vars(asked)).files())


def summary(records: Mapping[str, bytes]) -> dict[str, Any]:
    """Return the facts of a size range."""
    content = read_json(records, MAIN)
    told = ("variants", "fewest", "fewest_proven", "objective", "unit", "total_excess", "gap")
    return {"outcome": "optimal", **{name: content[name] for name in told}}


def _batch(job: object, sources: Sources) -> Job:
    """Return the batch that is meant, which must be done.

    Raises
    ------
    InputError
        There is no such batch, or it is not done.
    """
    if isinstance(job, str) and job in sources.records:
        with Store(sources.database, create=False) as store:
            found = store.job(job)
        if found is not None and found.kind == BATCH:
            if found.state in LIVE:
                open_batch = Described(f"a batch that is {found.state}")
                raise InputError(in_request(OF), open_batch, "a batch that is done", (OF,))
            return found
    raise InputError(in_request(OF), None if job is None else shown_kind(job), "the id of a batch", (OF,))
