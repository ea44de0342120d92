"""How a request becomes a job: what it refers to is found, an engine process reads it, limits are looked at."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from synth.errors import InputError
from synth.kinds import Kind, kind
from synth.queue.accounts import Principal
from synth.queue.database import digest
from synth.queue.job_table import BATCH, JOB_TASK, PLAN, NewJob
from synth.queue.tenant_files import TenantFiles
from synth.service.api.presenting import FAMILIES, STATED_ROWS
from synth.service.context import ServiceContext, in_thread
from synth.service.settings import ServiceSettings
from synth.service.small_work import asker_of
from synth.text.numbers import typed_number
from synth.workers.engine_tasks import READ_TASK

TIME_LIMIT, POINTS = "time_limit", "points"


@dataclass(frozen=True, kw_only=True)
class Wish:
    """What a client asks for as a job; fields as in :class:`synth.service.api.schemas.JobRequest`."""

    kind: str
    request: dict[str, Any]
    title: str | None = None
    parent: str | None = None
    priority: int | None = None
    seconds_limit: float | None = None

    def body(self) -> str:
        """Content by which a submission is told from another one with the same key."""
        told = (self.kind, self.request, self.title, self.parent, self.priority, self.seconds_limit)
        return digest(list(told))


async def submit(context: ServiceContext, principal: Principal, wish: Wish, key: str | None) -> tuple[str, bool]:
    """Make a job; return its id, and whether it is a new one.

    Raises
    ------
    InputError
        Something of it is wrong, or more than the tenant may have.
    KeyInUseError, QueueFullError
    """
    store, settings = context.store, context.settings
    body = wish.body()
    if key is not None:
        known = await in_thread(store.job_with_key, key, body, principal.tenant)
        if known is not None:
            return known, False
    chosen = kind(wish.kind)
    if wish.parent is not None and await in_thread(store.job, wish.parent, principal.tenant) is None:
        raise InputError("parent", wish.parent, "the id of a job", ("parent",))
    limit = seconds_limit(wish.seconds_limit, principal.limits.seconds_limit)
    asked = wish.request
    if chosen.name == BATCH and asked.get(TIME_LIMIT) is None and limit is not None:
        asked = {**asked, TIME_LIMIT: limit}  # of each row, and a part of what is asked
    sources = await in_thread(TenantFiles(store).sources, principal.tenant, asked)
    payload = {"kind": chosen.name, "request": asked, "sources": sources}
    pool = context.files if sources.files or chosen.name == BATCH else context.small
    read = await pool.ask(asker_of(principal), READ_TASK, payload)
    refuse_large(read, settings, principal.limits.rows)
    own = 0 if read["bulk"] else 1
    new = NewJob(
        kind=chosen.name,
        title=wish.title or read["title"],
        request=in_time(chosen, read["request"], wish.request, limit),
        fingerprint=read["fingerprint"],
        code=read["code"],
        tenant=principal.tenant,
        task=PLAN if chosen.name == BATCH else JOB_TASK,
        priority=own if wish.priority is None else min(own, wish.priority),
        content={FAMILIES: read["families"], STATED_ROWS: read["rows"]},
        idempotency=key,
        body=body,
        parent=wish.parent,
        seconds_limit=limit,
        keep=settings.keep_seconds,
        kept=read["kept"],
    )
    return await in_thread(store.submit, new)


def seconds_limit(asked: float | None, most: float | None) -> float | None:
    """Time limit of a job.

    Raises
    ------
    InputError
        More is asked for than the tenant may have.
    """
    if asked is not None and most is not None and asked > most:
        raise InputError("seconds_limit", asked, f"at most {typed_number(most)} s", ("seconds_limit",))
    return most if asked is None else asked


def in_time(chosen: Kind, read: Mapping[str, Any], stated: Mapping[str, object], limit: float | None) -> dict[str, Any]:
    """Return a request that ends by itself in the time that its job has: what was found is kept then.

    Raises
    ------
    InputError
        The request states more.
    """
    if limit is None or not chosen.timed:
        return dict(read)
    own = read.get(TIME_LIMIT)
    if own is not None and own > limit and stated.get(TIME_LIMIT) is not None:
        raise InputError(f"request: {TIME_LIMIT}", own, f"at most {typed_number(limit)} s", (TIME_LIMIT,))
    return {**read, TIME_LIMIT: limit if own is None else min(own, limit)}


def refuse_large(read: Mapping[str, Any], settings: ServiceSettings, rows: int | None) -> None:
    """Refuse more points, steps or rows than may be asked for over HTTP.

    Raises
    ------
    InputError
    """
    points = read["request"].get(POINTS)
    if points is not None and points > settings.points_limit:
        raise InputError(f"request: {POINTS}", points, f"at most {settings.points_limit}", (POINTS,))
    if read["steps"] > settings.steps_limit:
        raise InputError("request: vary", f"{read['steps']} values", f"at most {settings.steps_limit}", ("vary",))
    if rows is not None and read["rows"] > rows:
        raise InputError("request: rows", f"{read['rows']} rows", f"at most {rows}", ("rows",))
