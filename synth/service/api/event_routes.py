"""Event streams: what happens to jobs, told as it happens."""

from __future__ import annotations

import asyncio
import json
from collections.abc import AsyncIterator, Sequence
from contextlib import suppress
from typing import Annotated, Any

from fastapi import APIRouter, Header, Query, Request
from fastapi.responses import StreamingResponse
from fastapi.sse import format_sse_event
from sqlalchemy.exc import SQLAlchemyError
from starlette.types import Receive, Scope, Send

from synth.batches.views import Standing
from synth.errors import InputError
from synth.queue.accounts import Principal
from synth.queue.job_table import LIVE
from synth.queue.models import Job
from synth.service.api.asking import LARGEST, LONGEST, OwnJob, own_job
from synth.service.api.presenting import job_answer
from synth.service.auth import Reader
from synth.service.context import API, Context, ServiceContext, in_thread
from synth.service.errors import ServiceError, again
from synth.service.event_hub import END, RESYNC, SNAPSHOT, EventHub, Listener, StreamEvent, end_of, remark_of, told_of
from synth.service.recording import log
from synth.service.wording import WORD

router = APIRouter(prefix=API, tags=["events"])
MEDIA = "text/event-stream"
HEADERS = {"X-Accel-Buffering": "no", "Cache-Control": "no-store"}
EVENT = {
    "type": "object",
    "properties": {name: {"type": "string"} for name in ("event", "data", "id")} | {"retry": {"type": "integer"}},
}
COMMENT = b": \n\n"
STREAM: dict[int | str, dict[str, Any]] = {
    200: {
        "description": (
            "Events: `snapshot` (the job as it stands), then `created`, `started`, `resumed`, `progress`, `remark` as "
            "they happen, `resync` before a new snapshot for who was too slow, and `end` with state and outcome."
        ),
        "content": {MEDIA: {"schema": EVENT}},
    }
}
LastEventId = Annotated[
    int | None, Header(ge=0, le=LARGEST, description="Number of the last event that was seen; what is newer is told.")
]


async def tail(context: ServiceContext) -> None:
    """Read what happens and tell all who listen, as long as the server lives."""
    hub, settings = context.hub, context.settings
    try:
        while not context.ending.is_set():
            try:
                await _round(context, hub)
            except (SQLAlchemyError, InputError, OSError) as error:
                log("not_tailed", error=type(error).__name__)
            with suppress(TimeoutError):
                async with asyncio.timeout(settings.stream_tail):
                    await context.ending.wait()
    finally:
        hub.close()


async def _round(context: ServiceContext, hub: EventHub) -> None:
    if principals := hub.principals():
        hub.shut_out(await context.read(context.accounts.lapsed, principals))
    jobs = hub.listened()
    hub.tell(jobs, *await context.read(hub.read, jobs))


class EventStream(StreamingResponse):
    """An answer that tells a listener what happens until nothing comes any more, or nobody is there."""

    def __init__(self, context: ServiceContext, listener: Listener, content: AsyncIterator[bytes]) -> None:
        super().__init__(content, media_type=MEDIA, headers=HEADERS)
        self._context, self._listener = context, listener

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Send what there is to tell."""
        self._context.metrics.event_streams.inc()
        try:
            await super().__call__(scope, receive, send)
        finally:
            self._context.metrics.event_streams.dec()
            self._context.hub.leave(self._listener)


@router.get("/jobs/{job}/events", response_class=StreamingResponse, responses=STREAM, summary="What happens to a job")
async def job_events(
    request: Request, found: OwnJob, principal: Reader, context: Context, last_event_id: LastEventId = None
) -> EventStream:
    """Tell how a job stands and what happens to it, until it has ended or the token has."""
    return _stream(request, context, principal, [found.id], last_event_id)


@router.get("/events", response_class=StreamingResponse, responses=STREAM, summary="What happens to several jobs")
async def events(
    request: Request,
    jobs: Annotated[
        str, Query(min_length=1, max_length=100 * LONGEST, pattern=WORD, description="Ids with commas between them.")
    ],
    principal: Reader,
    context: Context,
    last_event_id: LastEventId = None,
) -> EventStream:
    """Tell how some jobs stand and what happens to them, until all have ended."""
    names = list(dict.fromkeys(name.strip() for name in jobs.split(",") if name.strip()))
    most = context.settings.stream_jobs
    if not 0 < len(names) <= most:
        raise InputError("jobs", jobs, f"ids of 1 to {most} jobs with commas between them", ("jobs",))
    for name in names:
        await own_job(name, principal, context)
    return _stream(request, context, principal, names, last_event_id)


def _stream(
    request: Request, context: ServiceContext, principal: Principal, jobs: list[str], after: int | None
) -> EventStream:
    if context.ending.is_set():
        raise ServiceError(503, "the server is ending; please come again", headers=again(context.settings.retry_after))
    listener = context.hub.listen(jobs, (principal.tenant, principal.token), principal)
    if listener is None:
        most = context.settings.streams
        raise ServiceError(
            429, f"{most} streams are open, as many as you may have", headers=again(context.settings.retry_after)
        )
    return EventStream(context, listener, _Telling(request, context, principal.tenant, listener, jobs).told(after))


class _Telling:
    """What one stream says, in its order."""

    def __init__(
        self, request: Request, context: ServiceContext, tenant: int, listener: Listener, jobs: Sequence[str]
    ) -> None:
        self.request, self.context, self.tenant, self.listener = request, context, tenant, listener
        self.open = dict.fromkeys(jobs)  # jobs whose end was not told
        self.known: set[int] = set()  # numbers of events that were told from the database

    async def told(self, after: int | None) -> AsyncIterator[bytes]:
        """Yield everything that is told: how jobs stand, what was missed, and what happens."""
        settings = self.context.settings
        yield format_sse_event(retry=1000 * settings.stream_retry)
        standing = await self._jobs()
        for part in self._snapshots(standing):
            yield part
        if after is not None:
            for told in await in_thread(self._missed, after, standing):
                for part in self._said(told):
                    yield part
        for part in self._ends(standing):
            yield part
        while self.open and not self.listener.closed:
            news = await self.listener.next(settings.stream_comment)
            if news is None:
                if not self.listener.closed:
                    yield COMMENT
            elif news.kind == RESYNC:
                yield _event(news)
                standing = await self._jobs()
                for part in (*self._snapshots(standing), *self._ends(standing)):
                    yield part
            else:
                for part in self._said(news):
                    yield part

    async def _jobs(self) -> dict[str, Job | None]:
        """Return the jobs as they stand; None for those that are gone."""
        store = self.context.store
        return {name: await self.context.read(store.job, name, self.tenant) for name in self.open}

    def _snapshots(self, standing: dict[str, Job | None]) -> list[bytes]:
        found = [job for job in standing.values() if job is not None]
        return [
            _event(StreamEvent(SNAPSHOT, job.id, job_answer(self.request, job).model_dump(mode="json")))
            for job in found
        ]

    def _missed(self, after: int, standing: dict[str, Job | None]) -> list[StreamEvent]:
        """Events since one that was seen, as far as a stream holds them; no end but the last."""
        found: list[StreamEvent] = []
        for name, job in standing.items():
            happened = self.context.store.happenings(after, job=name, most=self.context.settings.stream_queue)
            told = [told_of(one) for one in happened]
            last = None if job is not None and job.state in LIVE else told[-1:]
            found += [remark_of(one) if one.kind == END and [one] != last else one for one in told]
        return sorted(found, key=lambda told: told.id or 0)

    def _ends(self, standing: dict[str, Job | None]) -> list[bytes]:
        """Return the ends of jobs that have ended."""
        parts: list[bytes] = []
        for name, job in standing.items():
            if job is None or job.state not in LIVE:
                stands = None if job is None else Standing(job.state, job.outcome, job.updated, None)
                parts += self._said(end_of(name, stands))
        return parts

    def _said(self, told: StreamEvent) -> list[bytes]:
        """Event on something; None where it was sent before."""
        if told.job not in self.open or told.id in self.known:
            return []
        if told.id is not None:
            self.known.add(told.id)
        if told.kind == END:
            del self.open[told.job]
        return [_event(told)]


def _event(told: StreamEvent) -> bytes:
    number = None if told.id is None else str(told.id)
    return format_sse_event(event=told.kind, data_str=json.dumps(told.data, allow_nan=False), id=number)
