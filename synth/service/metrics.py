"""Figures of the service for those who watch it, as Prometheus reads them. No label takes a value that clients choose.

What happens in this process is counted as it happens; what jobs do is read from the database when somebody asks, so
that servers and workers on other machines need not talk to each other. Each server tells the same of jobs.
"""

from __future__ import annotations

import threading
import time
from collections.abc import Callable, Iterator
from importlib.metadata import version
from typing import Any

import sqlalchemy as sa
from prometheus_client import CollectorRegistry, Counter, Gauge, Histogram, Info, generate_latest
from prometheus_client.core import CounterMetricFamily, GaugeMetricFamily
from prometheus_client.registry import Collector

from synth.batches.store import Store
from synth.plugins import family_names
from synth.queue.job_table import LIVE
from synth.queue.models import Job, moment
from synth.service.settings import ServiceSettings

METHODS = ("GET", "HEAD", "POST", "PUT", "PATCH", "DELETE", "OPTIONS")
OPERATIONS = ("SELECT", "INSERT", "UPDATE", "DELETE")
OTHER = "other"
QUICK = (0.001, 0.0025, 0.005, 0.01, 0.025, 0.05, 0.1, 0.25, 0.5, 1.0, 2.5, 5.0, 10.0)  # s, of requests
LONG = (0.1, 0.25, 0.5, 1.0, 2.5, 5.0, 10.0, 30.0, 60.0, 120.0, 300.0, 600.0, 3600.0)  # s, of jobs


class QuestionFigures:
    """What is counted of the questions to one kind of engine processes."""

    def __init__(self, name: str, ends: Counter, seconds: Histogram, now: Gauge) -> None:
        self._name, self._ends, self._seconds, self._now = name, ends, seconds, now

    def ended(self, outcome: str) -> None:
        """Count a question: answered, refused, failed, ended or crashed (with its process), late, or busy."""
        self._ends.labels(self._name, outcome).inc()

    def waited(self, seconds: float) -> None:
        """Count how long a question has waited for a process."""
        self._seconds.labels(self._name, "waiting").observe(seconds)

    def worked(self, seconds: float) -> None:
        """Count how long a process has worked on a question."""
        self._seconds.labels(self._name, "working").observe(seconds)

    def watch(self, waiting: Callable[[], int], working: Callable[[], int], late: Callable[[], int]) -> None:
        """Tell how many questions there are whenever somebody reads the figures."""
        for state, count in (("waiting", waiting), ("working", working), ("late", late)):
            self._now.labels(self._name, state).set_function(count)


class ServiceMetrics:
    """What is counted.

    Parameters
    ----------
    settings : ServiceSettings
    store : Store
    """

    def __init__(self, settings: ServiceSettings, store: Store) -> None:
        self.registry = CollectorRegistry()
        common: dict[str, Any] = {"namespace": "clutchsynth", "registry": self.registry}
        self._requests = Counter("http_requests", "Requests", ["method", "route", "code"], **common)
        self._seconds = Histogram("http_request_seconds", "Time of requests", ["route"], buckets=QUICK, **common)
        self._database = Histogram("database_seconds", "Time of statements", ["operation"], buckets=QUICK, **common)
        self.event_streams = Gauge("event_streams", "Event streams that are open", **common)
        self.refused_tokens = Counter("refused_tokens", "Wrong tokens", **common)
        self.places = Gauge("http_requests_now", "Requests", ["state"], **common)
        self.refused_places = Counter("http_requests_refused", "Requests without a place", ["reason"], **common)
        self.facts = Gauge("code_facts", "What depends on the code alone", ["state"], **common)
        self._questions = (
            Counter("questions", "Questions to engine processes", ["pool", "outcome"], **common),
            Histogram("question_seconds", "Time of questions", ["pool", "part"], buckets=QUICK, **common),
            Gauge("questions_now", "Questions at hand", ["pool", "state"], **common),
        )
        self.worker_starts = Counter("supervisor_starts", "Starts of the supervisor by this server", **common)
        Info("build", "What this is", **common).info({"version": version("clutchsynth")})
        self.registry.register(_JobFigures(settings, store))
        self.registry.register(_EndedJobs(store))
        self._watch(store.engine)

    def requested(self, method: str, route: str, code: int, seconds: float) -> None:
        """Count a request; ``route`` is the pattern of its path."""
        self._requests.labels(method if method in METHODS else OTHER, route, str(code)).inc()
        self._seconds.labels(route).observe(seconds)

    def questions(self, pool: str) -> QuestionFigures:
        """Counter of the questions to a kind of engine processes."""
        return QuestionFigures(pool, *self._questions)

    def text(self) -> bytes:
        """Return all figures as Prometheus reads them."""
        return generate_latest(self.registry)

    def _watch(self, engine: sa.Engine) -> None:
        """Time every statement."""

        def begin(
            connection: sa.Connection, cursor: object, statement: str, parameters: object, context: object, many: bool
        ) -> None:
            connection.info["begun"] = time.perf_counter()

        def end(
            connection: sa.Connection, cursor: object, statement: str, parameters: object, context: object, many: bool
        ) -> None:
            word = statement.lstrip()[:6].upper()
            operation = word if word in OPERATIONS else OTHER
            self._database.labels(operation.lower()).observe(time.perf_counter() - connection.info["begun"])

        sa.event.listen(engine, "before_cursor_execute", begin)
        sa.event.listen(engine, "after_cursor_execute", end)


class _JobFigures(Collector):
    """How many jobs, units and workers there are, and for how long the oldest job waits: as they are now."""

    def __init__(self, settings: ServiceSettings, store: Store) -> None:
        self.settings, self.store = settings, store

    def describe(self) -> list[Any]:
        """Tell nothing: at the start the database may be away."""
        return []

    def collect(self) -> Iterator[Any]:
        """Yield the figures."""
        census = self.store.census()
        jobs = GaugeMetricFamily("clutchsynth_jobs", "Jobs", labels=["kind", "state"])
        for (kind, state), count in census["jobs"].items():
            jobs.add_metric([kind, state], count)
        units = GaugeMetricFamily("clutchsynth_units", "Units of work", labels=["state"])
        for state, count in census["units"].items():
            units.add_metric([state], count)
        yield jobs
        yield units
        yield GaugeMetricFamily("clutchsynth_queue_oldest_seconds", "Age of the oldest open job", census["oldest"])
        yield from self._of_workers()

    def _of_workers(self) -> Iterator[Any]:
        """Yield what workers say of themselves: ``slots`` of their signs of life holds these counts."""
        signs = self.store.workers(self.settings.ready_worker)
        slots, busy, lost = (sum(int(sign.slots.get(name, 0)) for sign in signs) for name in ("slots", "busy", "lost"))
        restarts: dict[str, int] = {}
        for sign in signs:
            for reason, count in dict(sign.slots.get("restarts") or {}).items():
                restarts[reason] = restarts.get(reason, 0) + int(count)
        yield GaugeMetricFamily("clutchsynth_workers", "Workers that have given a sign of life", len(signs))
        places = GaugeMetricFamily("clutchsynth_slots", "Engine processes for jobs", labels=["state"])
        places.add_metric(["busy"], busy)
        places.add_metric(["idle"], slots - busy)
        ended = CounterMetricFamily("clutchsynth_engine_restarts", "Engine processes replaced", labels=["reason"])
        for reason, count in sorted(restarts.items()):
            ended.add_metric([reason], count)
        yield places
        yield ended
        yield CounterMetricFamily("clutchsynth_leases_lost", "Units that were lost to other workers", lost)


class _EndedJobs(Collector):
    """How long jobs have waited and run, and how they ended, since this server started.

    Jobs are found by the time of their end, some seconds late: a transaction that ends a job may be seen later than
    one that ends another job after it.
    """

    def __init__(self, store: Store, late: float = 5.0) -> None:
        self.store, self.late = store, late
        common: dict[str, Any] = {"namespace": "clutchsynth", "registry": None}
        self.waits = Histogram("job_wait_seconds", "Time before jobs are begun", ["kind"], buckets=LONG, **common)
        self.runs = Histogram("job_run_seconds", "Time of jobs", ["kind", "family"], buckets=LONG, **common)
        self.ends = Counter("job_ends", "Jobs that have ended", ["kind", "outcome"], **common)
        self._families = set(family_names())
        self._until: float | None = None
        self._guard = threading.Lock()

    def describe(self) -> list[Any]:
        """Tell nothing: at the start the database may be away."""
        return []

    def collect(self) -> Iterator[Any]:
        """Count what has ended since the last time, and yield the figures."""
        with self._guard:
            self._count()
        for figure in (self.waits, self.runs, self.ends):
            yield from figure.collect()

    def _count(self) -> None:
        with self.store.engine.connect() as connection:
            until = float(connection.scalar(sa.select(moment() - self.late)) or 0.0)
            if self._until is not None:
                asked = sa.select(
                    Job.kind, Job.created, Job.started, Job.ended, Job.outcome, Job.state, Job.request["family"]
                ).where(Job.ended > self._until, Job.ended <= until, Job.state.not_in(LIVE))
                for kind, created, started, ended, outcome, state, family in connection.execute(asked):
                    self.ends.labels(kind, outcome or state).inc()
                    if started is not None:
                        self.waits.labels(kind).observe(max(started - created, 0.0))
                        known = family if isinstance(family, str) and family in self._families else OTHER
                        self.runs.labels(kind, known).observe(max(ended - started, 0.0))
        self._until = until
