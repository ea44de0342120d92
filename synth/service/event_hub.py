"""What happens to jobs, told to all who listen: one reader of the database for a whole server.

Numbers of events are given when they are written, but seen when their transaction ends: where several write at once,
one with a lower number may come later. So the last seconds are read again each time, and what was told is left out.
"""

from __future__ import annotations

import asyncio
import time
from collections import Counter, deque
from collections.abc import Collection, Hashable, Mapping
from dataclasses import dataclass
from typing import Any

from synth.batches.store import Store
from synth.batches.views import Standing, standings
from synth.queue.accounts import Principal
from synth.queue.job_table import LIVE, Happening
from synth.service.settings import ServiceSettings

END, PROGRESS, REMARK, RESYNC, SNAPSHOT = "end", "progress", "remark", "resync", "snapshot"
SAME = ("created", "started", "resumed", "cancelling", "points", "rows")  # kinds of events that are told by their names
DELETED = "deleted"  # the state of a job that is gone
READ_AT_ONCE = 1000


@dataclass(frozen=True)
class StreamEvent:
    """Something that a listener is told: of what kind, of which job, and its number where it is kept."""

    kind: str
    job: str
    data: Mapping[str, Any]
    id: int | None = None


def told_of(happening: Happening) -> StreamEvent:
    """Return an event as listeners are told of it."""
    text = "" if happening.kind == "started" else happening.text  # which process does it is for the log
    data = {"job": happening.job, "time": happening.time, "text": text, **(happening.data or {})}
    state = (happening.data or {}).get("state")
    if state is not None and state not in LIVE:
        return StreamEvent(END, happening.job, {"outcome": None, **data}, happening.id)
    kind = happening.kind if happening.kind in SAME else REMARK
    return StreamEvent(kind, happening.job, data, happening.id)


def remark_of(end: StreamEvent) -> StreamEvent:
    """Return the end of a job that has gone on since as what it was: a remark, which tells no state."""
    told = {"job": end.job, "time": end.data["time"], "text": str(end.data["state"])}
    return StreamEvent(REMARK, end.job, told, end.id)


def end_of(job: str, standing: Standing | None) -> StreamEvent:
    """End of a job, by its state; None stands for one that is gone."""
    state, outcome = (DELETED, None) if standing is None else (standing.state, standing.outcome)
    return StreamEvent(END, job, {"job": job, "state": state, "outcome": outcome})


def _has_ended(standing: Standing | None) -> bool:
    """True if a job has ended: one that has gone on since, as far as events tell, has not."""
    return standing is None or standing.state not in LIVE


class Listener:
    """One stream: what waits to be told. A slow one is told to read the state anew instead of everything.

    Parameters
    ----------
    jobs : collection of str
    most : int
        That may wait.
    principal : Principal, optional
        Who listens, as long as they would be let in.
    """

    def __init__(self, jobs: Collection[str], most: int, principal: Principal | None = None) -> None:
        self.jobs, self.principal = frozenset(jobs), principal
        self.closed = False
        self._most = most
        self._waiting: deque[StreamEvent] = deque()
        self._news = asyncio.Event()

    def put(self, told: StreamEvent) -> None:
        """Let something wait to be told."""
        if len(self._waiting) >= self._most:
            self._waiting.clear()
            self._waiting.append(StreamEvent(RESYNC, "", {}))
        else:
            self._waiting.append(told)
        self._news.set()

    def close(self) -> None:
        """Tell that nothing comes any more."""
        self.closed = True
        self._news.set()

    async def next(self, within: float) -> StreamEvent | None:
        """Next event; None where none comes in time, or any more."""
        if not self._waiting and not self.closed:
            try:
                async with asyncio.timeout(within):
                    await self._news.wait()
            except TimeoutError:
                return None
        self._news.clear()
        if self._waiting and not self.closed:
            return self._waiting.popleft()
        return None


class EventHub:
    """Reads what happens, and tells whoever listens.

    Parameters
    ----------
    settings : ServiceSettings
    store : Store
    """

    def __init__(self, settings: ServiceSettings, store: Store) -> None:
        self._settings, self._store = settings, store
        self._listeners: dict[Listener, Hashable] = {}
        self._streams: Counter[Hashable] = Counter()
        self._told: dict[str, float] = {}  # job -> when that was noted of it which was told last
        self._seen: set[int] = set()
        self._latest: deque[tuple[float, int]] = deque()  # when, and the highest number that was seen then
        self._floor: int | None = None  # all up to this number is told

    def listen(self, jobs: Collection[str], who: Hashable, principal: Principal | None = None) -> Listener | None:
        """Return a listener; None where somebody has as many as they may have."""
        if self._streams[who] >= self._settings.streams:
            return None
        listener = Listener(jobs, self._settings.stream_queue, principal)
        self._listeners[listener] = who
        self._streams[who] += 1
        return listener

    def leave(self, listener: Listener) -> None:
        """Tell a listener no more."""
        who = self._listeners.pop(listener, None)
        if who is not None:
            self._streams[who] -= 1
            if not self._streams[who]:
                del self._streams[who]

    def close(self) -> None:
        """End all streams."""
        for listener in self._listeners:
            listener.close()

    def principals(self) -> set[Principal]:
        """Return who listens."""
        return {listener.principal for listener in self._listeners if listener.principal is not None}

    def shut_out(self, lapsed: Collection[Principal]) -> None:
        """End the streams of those who would not be let in any more."""
        for listener in self._listeners:
            if listener.principal in lapsed:
                listener.close()

    # -- a round -------------------------------------------------------------------------------

    def listened(self) -> set[str]:
        """Return the jobs that somebody listens to."""
        return {job for listener in self._listeners for job in listener.jobs}

    def read(self, jobs: Collection[str]) -> tuple[list[Happening], dict[str, Standing]]:
        """Events since the last round, and the state of some jobs."""
        if self._floor is None:
            self._floor = self._store.last_event()
        found: list[Happening] = []
        after = self._floor
        while True:
            some = self._store.happenings(after, most=READ_AT_ONCE)
            found += [happening for happening in some if happening.id not in self._seen]
            if len(some) < READ_AT_ONCE:
                break
            after = some[-1].id
        return found, standings(self._store, jobs) if jobs else {}

    def tell(self, jobs: Collection[str], found: list[Happening], standing: Mapping[str, Standing]) -> None:
        """Tell what was read."""
        self._note(found)
        for happening in found:
            told = told_of(happening)
            ended = told.job in jobs and _has_ended(standing.get(told.job))
            self._hand_out(told if ended or told.kind != END else remark_of(told))
        for job in jobs:
            now = standing.get(job)
            if now is None or _has_ended(now):
                self._hand_out(end_of(job, now))
            elif now.progress and now.updated != self._told.get(job):
                self._hand_out(StreamEvent(PROGRESS, job, {"job": job, "state": now.state, **now.progress}))
        self._told = {job: now.updated for job, now in standing.items()}

    def _hand_out(self, told: StreamEvent) -> None:
        for listener in self._listeners:
            if told.job in listener.jobs:
                listener.put(told)

    def _note(self, found: list[Happening]) -> None:
        """Remember what was told, as far back as it may be read again."""
        now = time.monotonic()
        self._seen.update(happening.id for happening in found)
        if self._seen:
            self._latest.append((now, max(self._seen)))
        while self._latest and self._latest[0][0] < now - self._settings.stream_margin:
            self._floor = max(self._floor or 0, self._latest.popleft()[1])
        self._seen = {number for number in self._seen if number > (self._floor or 0)}
