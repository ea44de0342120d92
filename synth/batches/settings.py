"""Settings of batches: intervals, attempts, sizes of units.

None of them is part of an answer, apart from ``WarmStartSettings`` and ``GroupSettings``: they decide which row is
answered with the experience of another, and which rows are searched together, and so which of two designs that are
equal to the gap is found first. ``BATCHES`` is the default; for other numbers make a record of them and pass it to
``BatchJob``.
"""

from __future__ import annotations

from dataclasses import dataclass, field

from synth.queue.settings import StoreSettings


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
class BatchSettings:
    """All settings of a batch.

    A unit of work should take 0.2 to 5 s: less and the database costs too much, more and an interruption does.

    Parameters
    ----------
    store : StoreSettings
    runner : RunnerSettings
    cluster : ClusterSettings
    warm_starts : WarmStartSettings
    groups : GroupSettings
    plan : PlanSettings
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
    rows_per_unit: int = 4
    fronts_per_unit: int = 1


BATCHES = BatchSettings()
