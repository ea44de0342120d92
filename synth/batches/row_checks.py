"""The rows of a table read and checked, in this process or, where they are many, in several at once."""

from __future__ import annotations

import time
from collections import deque
from collections.abc import Iterable, Iterator, Mapping
from concurrent.futures import Future
from concurrent.futures.process import BrokenProcessPool
from dataclasses import dataclass
from functools import cached_property, lru_cache
from itertools import chain, islice
from typing import Any, TypeVar

from synth.batches.entries import BatchProgress
from synth.batches.executors import Processes
from synth.batches.row_questions import Questioner, ReadRow
from synth.batches.row_table import RowTable
from synth.batches.settings import PlanSettings
from synth.model.registry import load
from synth.question.arguments import UserTables
from synth.question.catalogs import as_catalogs

Lines = list[tuple[int, tuple[str, ...]]]
T = TypeVar("T")


class PlanProgress:
    """Tells now and then how far the planning of a table is.

    Parameters
    ----------
    show : callable, optional
        Called with a mapping: ``rows`` of the table, ``done`` of them, and the ``stage``: ``checked``,
        ``grouped`` or ``written``.
    pause : float
        In s, between two calls, at least.
    table : RowTable
        Its rows are counted only where it takes so long that somebody is told.
    """

    def __init__(self, show: BatchProgress | None, pause: float, table: RowTable) -> None:
        self._show, self._pause, self._table = show, pause, table

    @cached_property
    def _rows(self) -> int:
        return self._table.count()

    def each(self, items: Iterable[T], stage: str) -> Iterator[T]:
        """Yield items, and tell how many there were."""
        shown = time.monotonic()
        for done, item in enumerate(items, start=1):
            yield item
            if self._show is not None and time.monotonic() - shown >= self._pause:
                shown = time.monotonic()
                self._show({"stage": stage, "rows": self._rows, "done": done})


@dataclass(frozen=True, eq=False)
class RowChecker:
    """What a process needs to check rows of a table that it does not read itself.

    Parameters
    ----------
    job : str
        By which a process knows that it has checked rows of this table before.
    name, header
        Of the table.
    families : frozenset of str
        That rows name.
    problem : str, DesignProblem subclass or None
        Of rows that name no family.
    options : mapping
        Of a problem that is a class.
    mapping, settings, common, catalogs
        As for ``Questioner``.
    """

    job: str
    name: str
    header: tuple[str, ...]
    families: frozenset[str]
    problem: Any
    options: Mapping[str, Any]
    mapping: Mapping[str, str]
    settings: Mapping[str, Any]
    common: Mapping[str, Mapping[str, Any]]
    catalogs: Any

    def __eq__(self, other: object) -> bool:
        return isinstance(other, RowChecker) and self.job == other.job

    def __hash__(self) -> int:
        return hash(self.job)

    @classmethod
    def of(cls, questioner: Questioner, job: str, catalogs: UserTables) -> RowChecker:
        """Checker of the rows of a questioner; ``catalogs`` as they were stated."""
        user_family, table = questioner.user_family, questioner.table
        return cls(
            job,
            table.name,
            table.header(),
            frozenset(questioner.named),
            questioner.default if user_family is None else user_family,
            questioner.user_options if user_family is not None else {},
            questioner.mapping,
            questioner.settings,
            questioner.common,
            catalogs,
        )


def check_lines(checker: RowChecker, lines: Lines) -> list[ReadRow]:
    """Read and check some lines."""
    questioner = _questioner(checker)
    return [questioner.row(line, cells) for line, cells in lines]


@lru_cache(maxsize=1)
def _questioner(checker: RowChecker) -> Questioner:
    """Questioner of a process; made once, so that problems are traced once."""
    problem = checker.problem
    return Questioner(
        RowTable(checker.name, (checker.header, ())),
        problem if problem is None or isinstance(problem, str) else load(problem, **checker.options),
        checker.mapping,
        checker.settings,
        checker.common,
        as_catalogs(checker.catalogs),
        set(checker.families),
    )


def checked_rows(
    questioner: Questioner, job: str, catalogs: UserTables, workers: int | None, settings: PlanSettings
) -> Iterator[ReadRow]:
    """Read and check the rows of a table, in its order.

    Parameters
    ----------
    questioner : Questioner
    job : str
        As for ``RowChecker``.
    catalogs : optional
        Own tables as they were stated.
    workers : int or None
        Processes; None or 1 works in this one, and so do tables of few rows.
    settings : PlanSettings
    """
    lines = questioner.table.lines()
    few = list(islice(lines, settings.few))
    more = next(lines, None) if (workers or 1) > 1 else None
    if more is None:
        yield from (questioner.row(line, cells) for line, cells in chain(few, lines))
        return
    chunks = _chunks(chain(few, [more], lines), settings.lines)
    with Processes(workers or 1) as executor:
        checker = RowChecker.of(questioner, job, catalogs)
        under_way: deque[tuple[Lines, Future[list[ReadRow]]]] = deque()

        def begin() -> None:
            chunk = next(chunks, None)
            if chunk is not None:
                under_way.append((chunk, executor.submit(check_lines, checker, chunk)))

        for _ in range(executor.slots):
            begin()
        while under_way:
            chunk, future = under_way.popleft()
            try:
                rows = future.result()
            except BrokenProcessPool:  # something has ended the process: its lines are checked here
                rows = [questioner.row(line, cells) for line, cells in chunk]
            begin()
            yield from rows


def _chunks(lines: Iterator[tuple[int, tuple[str, ...]]], size: int) -> Iterator[Lines]:
    while chunk := list(islice(lines, size)):
        yield chunk
