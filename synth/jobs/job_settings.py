"""The numbers that batches go by: how long is waited, how often is tried again, and how much goes at a time.

None of them is part of an answer, apart from ``WarmStartSettings`` and ``GroupSettings``: they decide which row is
answered with the experience of another, and which rows are searched together, and so which of two designs that are
equal to the gap is found first. ``JOBS`` are those that everybody gets; whoever wants others makes a record of them and
hands it to ``BatchJob``.
"""

from __future__ import annotations

from dataclasses import dataclass, field


@dataclass(frozen=True, kw_only=True)
class StoreSettings:
    """How the job database is used.

    Parameters
    ----------
    patience : float
        In s, that whoever opens or writes waits for others: a checkpoint of SQLite may take seconds, nothing a minute.
    lease : float
        In s, that a claim lasts without a sign of life: so long a unit is idle whose worker died on another machine.
    chunk : int
        Rows that are written or read at a time: enough that statements cost little, and little memory.
    overflow : int
        Connections at a time beside the five that stay open: more than a server has threads, as whoever waits for one
        in its loop holds up all others.
    starving : float
        In s, after which bulk work that nobody has served counts as work that somebody waits for.
    forgotten : float
        In s, after which a worker that has given no sign of life is listed no more.
    given_back : int
        Pages of a SQLite file, of 4 kB mostly, that are given back at a time after jobs were removed: others wait for
        as long, some hundredths of a second.
    """

    patience: float = 60.0
    lease: float = 60.0
    chunk: int = 500
    overflow: int = 45
    starving: float = 60.0
    forgotten: float = 86400.0
    given_back: int = 5000


@dataclass(frozen=True, kw_only=True)
class RunnerSettings:
    """How a process works off a job.

    Parameters
    ----------
    attempts : int
        At a question that fails, before it is answered by its error: what kills a worker may have been something else.
    tick : float
        In s, between looks at what is going on: as long as Ctrl-C or a cancelled job may go unnoticed.
    pause : float
        In s, between two reports of progress, at least.
    report_share : float
        Of the time, that counting the rows for reports may take, as reports get rarer in a large job.
    outage : float
        In s, for which a database that does not answer is asked again: a restart of its server.
    """

    attempts: int = 3
    tick: float = 0.5
    pause: float = 1.0
    report_share: float = 0.05
    outage: float = 60.0


@dataclass(frozen=True, kw_only=True)
class ClusterSettings:
    """How long a Dask scheduler is waited for.

    Parameters
    ----------
    answer : float
        In s, that a scheduler has to answer.
    recount : float
        In s, after which the threads of the cluster are counted again: workers come and go.
    retry : float
        In s, between two tries to reach a scheduler that has gone.
    patience : float
        In s, for which a scheduler that has gone is waited for: whoever restarts it may have to be called first.
    """

    answer: float = 5.0
    recount: float = 5.0
    retry: float = 0.5
    patience: float = 600.0


@dataclass(frozen=True, kw_only=True)
class WarmStartSettings:
    """Which questions of a job teach others.

    Parameters
    ----------
    one_in : int
        Of so many questions one is a teacher: few enough that what they cost is little, in a job that is large enough.
    """

    one_in: int = 100


@dataclass(frozen=True, kw_only=True)
class GroupSettings:
    """Which rows of a job are answered by one search.

    Parameters
    ----------
    least : int
        Rows that ask alike, from which on they are: 32 at once take a third of what they take alone, 4 hardly less;
        rows of smaller tables are answered as ``run`` answers them.
    units : int
        Groups that a job is divided into at least, as far as they hold ``smallest`` rows: enough for many workers, and
        for progress that moves.
    smallest : int
        Rows below which no group is made smaller for the sake of ``units``: 200 rows took 7 s in one group, 9 s in
        groups of 32, 12 s of 16, 23 s of 8 and 44 s of 4.
    most : int
        Rows of a group: from 128 to 1 024 a row costs the same; smaller groups are sooner done, shared out more evenly,
        and less is lost with one.
    cache : int
        In kB, of what waits to be grouped, that is kept in memory.
    portion : int
        Rows that are divided in memory; of more, halves are written to files before.
    """

    least: int = 32
    units: int = 64
    smallest: int = 16
    most: int = 512
    cache: int = 16_384
    portion: int = 65_536

    def size(self, rows: int) -> int:
        """Most rows of a group in a job of so many rows: a power of two, so that a row more rarely changes it.

        Examples
        --------
        >>> [GroupSettings().size(rows) for rows in (200, 1024, 2047, 2048, 10_000, 1_000_000)]
        [16, 16, 16, 32, 128, 512]
        """
        each = max(rows // self.units, self.smallest, 1)
        return min(1 << each.bit_length() - 1, self.most)


@dataclass(frozen=True, kw_only=True)
class PlanSettings:
    """How the rows of a table are checked.

    Parameters
    ----------
    few : int
        Rows that are checked without other processes, as those take longer to begin: a row takes 0.5 to 1 ms.
    lines : int
        Rows that a process is given at a time.
    shown_faults : int
        Kinds of faults in a table, and its first rows, that are remembered for the screen.
    shown_lines : int
        Lines of one kind that are.
    pause : float
        In s, between two reports of progress, at least.
    """

    few: int = 2000
    lines: int = 500
    shown_faults: int = 20
    shown_lines: int = 8
    pause: float = 0.5


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
        Times a limit of processor time that may pass on the clock: on a busy machine a process waits for its turn, one
        that waits for ever is stuck.
    look : float
        In s, between two looks at how much processor time it has had.
    tell : float
        In s, between two reports of how far it is.
    """

    nice: int = 10
    memory: int = 2 * 1024**3
    addresses: int = 4 * 1024**3
    worn: int = 1024**3
    calls: int = 500
    start: float = 60.0
    stuck: float = 10.0
    look: float = 0.2
    tell: float = 0.25


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
        In s, between two looks at how much memory it takes.
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
class JobSettings:
    """All numbers that batches go by.

    A unit of work should take 0.2 to 5 s: less and the database costs too much, more and an interruption does.

    Parameters
    ----------
    store : StoreSettings
    runner : RunnerSettings
    cluster : ClusterSettings
    warm_starts : WarmStartSettings
    groups : GroupSettings
    plan : PlanSettings
    engine : EngineSettings
    worker : WorkerSettings
    rows_per_unit : int
        Rows of one best design that are a unit of work, each answered alone.
    fronts_per_unit : int
        Rows of a whole front that are.
    """

    store: StoreSettings = field(default_factory=StoreSettings)
    runner: RunnerSettings = field(default_factory=RunnerSettings)
    cluster: ClusterSettings = field(default_factory=ClusterSettings)
    warm_starts: WarmStartSettings = field(default_factory=WarmStartSettings)
    groups: GroupSettings = field(default_factory=GroupSettings)
    plan: PlanSettings = field(default_factory=PlanSettings)
    engine: EngineSettings = field(default_factory=EngineSettings)
    worker: WorkerSettings = field(default_factory=WorkerSettings)
    rows_per_unit: int = 4
    fronts_per_unit: int = 1


JOBS = JobSettings()
