"""Jobs as clients see them."""

from __future__ import annotations

from typing import Any

from fastapi import Request

from synth.queue.job_table import BATCH
from synth.queue.models import Job
from synth.service.api.schemas import JobAnswer, JobFault, JobLinks

FAMILIES = "families"  # what is kept with a job of those that it asks
MADE = ("error", FAMILIES, "rows", "links")  # fields of an answer that a job does not have as they are
STATED_ROWS = "stated_rows"  # how many a batch has whose rows are not planned yet


def job_place(request: Request, job: str) -> str:
    """Return the address of a job."""
    return f"{request.app.url_path_for('list_jobs')}/{job}"


def job_answer(request: Request, job: Job) -> JobAnswer:
    """Return a job as clients see it."""
    place = job_place(request, job.id)
    parts = {name: f"{place}/{name}" for name in JobLinks.model_fields if name not in ("self", "rows")}
    same = {name: getattr(job, name) for name in JobAnswer.model_fields if name not in MADE}
    return JobAnswer(
        **same,
        error=_fault(job.error),
        families=list(job.content.get(FAMILIES, ())),
        rows=job.rows or int(job.content.get(STATED_ROWS, 0)),
        links=JobLinks(self=place, rows=f"{place}/rows" if job.kind == BATCH else None, **parts),
    )


def job_bytes(request: Request, job: Job) -> bytes:
    """Return a job as it is sent."""
    return job_answer(request, job).model_dump_json().encode()


def _fault(error: dict[str, Any] | None) -> JobFault | None:
    return None if error is None else JobFault.model_validate(error)
