"""The kind of job ``size_range``: ``of`` a batch, the standard variants that serve all its rows."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from synth.batches.batch import BatchResult
from synth.batches.store import Store
from synth.errors import Described, InputError
from synth.kinds.asked import OF, WHERE, catalogs_of, known_keys, of_files, read_json, seconds
from synth.kinds.request_schemas import keys_of
from synth.question.spec_keys import shown_kind
from synth.queue.job_table import BATCH, LIVE
from synth.queue.models import Job
from synth.queue.records import CheckedRequest, Record, ReportProgress, Sources
from synth.variants.size_range import check_size_range, size_range
from synth.variants.variant_settings import VARIANTS

MAIN = "size_range.json"
KEYS = keys_of("size_range")


def read(request: Mapping[str, Any], sources: Sources) -> CheckedRequest:
    """Check a request: the batch must be there and done.

    Raises
    ------
    InputError
        For everything that is wrong with it.
    """
    stated = known_keys(request, KEYS)  # each of its own meaning
    asked = _asked(stated)
    job = _batch(stated.get(OF), sources)
    families = tuple(job.content["families"])
    title = f"Size range of {job.title}"
    return CheckedRequest(request={OF: job.id, **asked}, title=title, families=families, bulk=True)


def work(request: Mapping[str, Any], sources: Sources, tell: ReportProgress) -> dict[str, Record]:
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
    return of_files(size_range(source, **_asked(request)).files())


def summary(records: Mapping[str, bytes]) -> dict[str, Any]:
    """Return the facts of a size range."""
    content = read_json(records, MAIN)
    told = ("variants", "fewest", "fewest_proven", "objective", "unit", "total_excess", "gap")
    return {"outcome": "optimal", **{name: content[name] for name in told}}


def _asked(stated: Mapping[str, Any]) -> dict[str, Any]:
    """Selection of the variants, as ``synth.size_range`` takes it.

    Raises
    ------
    InputError
        Something of it is not of its kind.
    """
    usual = {"variants": None, "objective": None, "per_row": None, "candidates": VARIANTS.candidates, "gap": 1e-3}
    asked = {name: stated.get(name, value) for name, value in usual.items()}
    asked["time_limit"] = seconds(stated.get("time_limit")) or VARIANTS.seconds
    check_size_range(*(asked[name] for name in ("variants", "candidates", "gap", "time_limit")))
    objective, per_row = asked["objective"], asked["per_row"]
    if objective is not None and not isinstance(objective, str):
        raise InputError(f"{WHERE}: objective", shown_kind(objective), "the name of a quantity", ("objective",))
    if per_row is not None and not (isinstance(per_row, list) and all(isinstance(name, str) for name in per_row)):
        raise InputError(f"{WHERE}: per_row", shown_kind(per_row), "a list of names of variables", ("per_row",))
    return asked


def _batch(job: Any, sources: Sources) -> Job:
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
                raise InputError(f"{WHERE}: {OF}", open_batch, "a batch that is done", (OF,))
            return found
    raise InputError(f"{WHERE}: {OF}", None if job is None else shown_kind(job), "the id of a batch", (OF,))
