"""Jobs as clients see them."""

from __future__ import annotations

from typing import Any

from fastapi import Request

from synth.queue.job_table import BATCH
from synth.queue.models import Job
from synth.service.api.schemas import JobAnswer, JobFault, JobLinks

FAMILIES = "families"  # what is kept with a job of those that it asks
STATED_ROWS = "stated_rows"  # how many a batch has whose rows are not planned yet


def job_place(request: Request, job: str) -> str:
    """Return the address of a job."""
    return f"{request.app.url_path_for('list_jobs')}/{job}"


def job_answer(request: Request, job: Job) -> JobAnswer:
    """Return a job as clients see it."""
    place = job_place(request, job.id)
    return JobAnswer(
        id=job.id,
        kind=job.kind,
        title=job.title,
        state=job.state,
        outcome=job.outcome,
        progress=job.progress,
        summary=job.summary,
        error=_fault(job.error),
        families=list(job.content.get(FAMILIES, ())),
        priority=job.priority,
        parent=job.parent,
        pinned=job.pinned,
        rows=job.rows or int(job.content.get(STATED_ROWS, 0)),
        seconds_limit=job.seconds_limit,
        created=job.created,
        started=job.started,
        updated=job.updated,
        ended=job.ended,
        expires=job.expires,
        links=JobLinks(
            self=place,
            request=f"{place}/request",
            result=f"{place}/result",
            designs=f"{place}/designs",
            files=f"{place}/files",
            events=f"{place}/events",
            rows=f"{place}/rows" if job.kind == BATCH else None,
        ),
    )


def job_bytes(request: Request, job: Job) -> bytes:
    """Return a job as it is sent."""
    return job_answer(request, job).model_dump_json().encode()


def _fault(error: dict[str, Any] | None) -> JobFault | None:
    return None if error is None else JobFault.model_validate(error)
