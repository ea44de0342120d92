"""Which stage a search is in, how far it is, and how long each stage took."""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager

from synth.question.settings import Progress, ProgressState
from synth.search.settings import TUNING, ProgressLimits


class StageProgress:
    """Reports the stage of a search and its progress, and records the time of each stage.

    Parameters
    ----------
    report : callable, optional
        Told a mapping: stage, done (0..1), combinations, incumbents, message; now and then what ``shown`` returns as
        well. None where nobody wants to know.
    combinations : int
        Of the question.
    incumbents : callable
        Returns how many designs are known.
    shown : callable, optional
        Returns what is to be told of these designs (``columns`` and ``points``); nothing where they are the same as
        before.
    limits : ProgressLimits
        How often that is told.
    """

    def __init__(
        self,
        report: Progress | None,
        combinations: int,
        incumbents: Callable[[], int],
        shown: Callable[[], ProgressState] = ProgressState,
        limits: ProgressLimits = TUNING.progress,
    ) -> None:
        self.started = time.monotonic()
        self.seconds: dict[str, float] = {}  # per stage that has ended
        self.report, self._combinations, self._incumbents = report, combinations, incumbents
        self._shown, self._limits, self._reported_at = shown, limits, -math.inf
        self._stage, self._done = "", 0.0

    @property
    def elapsed(self) -> float:
        """Seconds since the search began."""
        return time.monotonic() - self.started

    @contextmanager
    def stage(self, name: str) -> Iterator[None]:
        """Take the time of a block, which is a stage of the search or a part of one."""
        begin = time.monotonic()
        self.say(name, 0.0)
        try:
            yield
        finally:
            self.seconds[name] = self.seconds.get(name, 0.0) + time.monotonic() - begin
            self.say(name, 1.0)

    def enter(self, stage: str) -> None:
        """Begin a stage whose boxes alone are told of."""
        self._stage, self._done = stage, 0.0

    def working(self, open_boxes: int) -> None:
        """Show that work goes on inside a stage."""
        if open_boxes:
            self.say(self._stage, self._done, f"{open_boxes} boxes open")

    def say(self, stage: str, done: float, message: str = "") -> None:
        """Tell how far a stage is."""
        self._stage, self._done = stage, done
        if self.report is not None:
            self.report(
                {
                    "stage": stage,
                    "done": float(min(max(done, 0.0), 1.0)),
                    "combinations": self._combinations,
                    "incumbents": self._incumbents(),
                    "message": message,
                    **self._designs(),
                }
            )

    def _designs(self) -> ProgressState:
        """Progress report on the known designs, where one is due."""
        now = time.monotonic()
        if now - self._reported_at < self._limits.pause:
            return {}
        report = self._shown()
        self._reported_at = now if report else self._reported_at
        return report
