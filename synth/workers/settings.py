"""Settings of workers and their engine processes: memory, intervals, attempts."""

from __future__ import annotations

from dataclasses import dataclass, field

from synth.batches.settings import RunnerSettings


@dataclass(frozen=True, kw_only=True)
class EngineSettings:
    """How engine processes live.

    Parameters
    ----------
    nice : int
        By how much they yield to others: with two engines on two processors, a server answers eight times faster.
    memory : int
        In bytes, that one may use before it is ended.
    addresses : int
        In bytes, that it may reserve, where the system bounds that: far more than it uses.
    worn : int
        In bytes, from which on it is replaced between two things: caches grow.
    calls : int
        After which it is replaced.
    start : float
        In s of a processor, that it may take until it is warm.
    stuck : float
        Times a limit of processor time that may pass on the clock while a process hardly gets any: on a busy machine it
        waits for its turn, one that waits for ever is stuck.
    stirs : float
        Share of the limit that it must have had by then, to have as long again.
    poll : float
        In s, between two readings of how much processor time it has had.
    report_pause : float
        In s, between two reports of how far it is.
    """

    nice: int = 10
    memory: int = 2 * 1024**3
    addresses: int = 4 * 1024**3
    worn: int = 1024**3
    calls: int = 500
    start: float = 60.0
    stuck: float = 10.0
    stirs: float = 0.01
    poll: float = 0.2
    report_pause: float = 0.25


# Somebody waits for the answer: no search of a worker comes before it.
INTERACTIVE = EngineSettings(nice=0)


@dataclass(frozen=True, kw_only=True)
class WorkerSettings:
    """How a worker serves the queue.

    Parameters
    ----------
    poll : float
        In s, between two looks at a queue that is empty.
    watch : float
        In s, between two looks at whether what is computed is still wanted.
    weigh : float
        In s, between two readings of how much memory it takes.
    lease : float
        In s, that a claim lasts without a sign of life: so long a job waits whose machine has gone.
    sign : float
        In s, between two signs of life.
    tidy : float
        In s, between two looks for what others have left behind.
    alive : float
        In s, within which a sign of life counts.
    grace : float
        In s, that a job may go on beyond its limit, for its search to stop by itself.
    patience : float
        In s, that somebody waits before bulk work makes room for him.
    kept : float
        In s, between two counts of the rows of a batch.
    attempts : int
        At a job whose process ends, before it is given up: what killed it may have been something else.
    """

    poll: float = 0.25
    watch: float = 0.2
    weigh: float = 1.0
    lease: float = 15.0
    sign: float = 4.0
    tidy: float = 30.0
    alive: float = 30.0
    grace: float = 5.0
    patience: float = 0.25
    kept: float = 1.0
    attempts: int = 3


@dataclass(frozen=True, kw_only=True)
class WorkSettings:
    """All settings of a worker.

    Parameters
    ----------
    runner : RunnerSettings
    engine : EngineSettings
    worker : WorkerSettings
    """

    runner: RunnerSettings = field(default_factory=RunnerSettings)
    engine: EngineSettings = field(default_factory=EngineSettings)
    worker: WorkerSettings = field(default_factory=WorkerSettings)


WORK = WorkSettings()
