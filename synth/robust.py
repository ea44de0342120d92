"""Designs that stand what scatters around them: rated, or made so that their limits hold over a whole range."""

from __future__ import annotations

import json
import math
import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, Protocol

from synth.assembly import ranked
from synth.errors import InputError
from synth.feasibility import Status
from synth.files import csv_text
from synth.instance import Instance, catalogs_for
from synth.output_folder import RATING, save_result
from synth.posed import nominal
from synth.problem import load
from synth.rated import COLUMNS, limits_table, rating_row
from synth.rating import PROVEN, Rater
from synth.request import Request
from synth.results import Design, ParetoFront, design_columns, design_row
from synth.scatter import check_rows
from synth.search_settings import Progress, SearchSettings, check_progress
from synth.tuning import RobustLimits, Tuning
from synth.uncertainty import LIMITS, Uncertainty, read_block

if TYPE_CHECKING:
    import pandas as pd

SHORTEST, GRACE = 1e-3, 2.0  # seconds
NOTHING_STANDS = "no design was found that keeps its limits over the whole range"


@dataclass(frozen=True)
class Ratings:
    """Designs with what a range does to them; each ``design.robust`` tells it.

    ``asked`` is the block in full; ``interrupted`` tells why designs are missing, where some are.
    """

    designs: list[Design]
    asked: Mapping[str, Any]
    missing: int = 0
    interrupted: str = ""

    def sentence(self) -> str:
        """Return how many designs keep their limits over the range, and how far that is certain."""
        return told_of(self.designs, self.asked["samples"])

    def to_frame(self) -> pd.DataFrame:
        """Return one row per design, with units in the headers."""
        import pandas as pd  # costly to import; most runs write CSV only

        columns, rows = self._table()
        return pd.DataFrame(rows, columns=columns)

    def files(self) -> dict[str, str]:
        """Return what ``save`` writes: file name -> text."""
        told = {
            "family": self.designs[0].frame.family if self.designs else None,
            "robust": dict(self.asked),
            "rated": len(self.designs),
            "missing": self.missing,
            "interrupted": self.interrupted,
            "sentence": self.sentence(),
            "designs": [{"rank": d.rank, **d.robust} for d in self.designs],
        }
        return {
            "rating.csv": csv_text(*self._table()),
            "robust.csv": csv_text(*limits_table(self.designs)),
            "rating.json": json.dumps(told, indent=1, allow_nan=False, ensure_ascii=False) + "\n",
        }

    def save(self, folder: str | Path) -> Path:
        """Write rating.csv, robust.csv and rating.json; return the folder.

        What was stopped replaces no earlier result: it is written to a folder ``stopped`` beside that.
        """
        return save_result(folder, self.files(), RATING, bool(self.interrupted))

    def _table(self) -> tuple[list[str], list[list[Any]]]:
        if not self.designs:
            return ["rank", *COLUMNS], []
        first = self.designs[0]
        columns = ["rank", *COLUMNS, *design_columns(first.frame, first.choices, first.parts)]
        return columns, [[d.rank, *rating_row(d), *design_row(d.frame, d)] for d in self.designs]


def told_of(designs: Sequence[Design], samples: int) -> str:
    """Return in words how designs stand the range."""
    rated = [d for d in designs if d.robust]
    if not rated:
        return "no design was rated"
    holding = [d for d in rated if d.robust["holds"]]
    proven = sum(d.robust["proof"] == PROVEN for d in holding)
    of = "1 design" if len(rated) == 1 else f"{len(rated)} designs"
    if not holding:
        return f"none of {of} keeps all limits over the whole range"
    keeps = "keeps" if len(holding) == 1 else "keep"
    how = "proven" if proven == len(holding) else f"{proven} of them proven, else at the corners and {samples} samples"
    if not proven:
        how = f"not proven: at the corners and at {samples} samples"
    return f"{len(holding)} of {of} {keeps} all limits over the whole range ({how})"


def taken_off(count: int) -> str:
    """Return in words how many designs are missing because they do not stand the range."""
    designs = "1 design was" if count == 1 else f"{count} designs were"
    return f"{designs} taken off: not all limits hold over the whole range"


def rate(
    source: ParetoFront | Design | Sequence[Design],
    robust: Any = None,
    *,
    problem: Any = None,
    catalogs: Any = None,
    progress: Progress | None = None,
    time_limit: float | None = None,
) -> Ratings:
    """Tell how designs stand what scatters around them.

    Parameters
    ----------
    source : ParetoFront, Design or list of Design
        From ``synthesize``, ``load_front`` or ``evaluate``.
    robust : mapping, optional
        What scatters, as for ``synthesize``; by default what the question of the front says.
    problem, catalogs : optional
        As for ``ParetoFront.verify``: for designs of a problem, or with tables, of one's own.
    progress : callable, optional
        Called with a mapping: stage, done, incumbents.
    time_limit : float, optional
        Seconds after which the designs rated so far are returned.

    Returns
    -------
    Ratings

    Raises
    ------
    InputError
        When the block is not understood, or there are no designs.
    """
    settings = SearchSettings(time_limit=time_limit)
    check_progress(progress)
    designs = (
        list(source.designs)
        if isinstance(source, ParetoFront)
        else [source]
        if isinstance(source, Design)
        else list(source)
    )
    if not designs:
        raise InputError("front", "no designs", "a front with designs")
    frame = designs[0].frame
    asked = read_block(frame.restated.get("robust") if robust is None else robust)
    question = source.question if isinstance(source, ParetoFront) else None
    if question is not None and problem is None:
        problem, catalogs = nominal(question.problem), question.catalogs if catalogs is None else catalogs
    own = nominal(load(frame.family, **frame.options) if problem is None else load(problem))
    tables = catalogs_for(own, frame.restated.get("catalogs") if catalogs is None else catalogs)
    limits = frame.restated.get("limits") or {}
    request = Request(problem=own, requirements=frame.requirements, catalogs=tables, limits=limits)
    rater = Rater(request, asked)
    deadline = math.inf if settings.time_limit is None else time.monotonic() + settings.time_limit
    found, stopped = rater.rate(designs, progress, deadline)
    rated = [replace(d, robust=r) for d, r in zip(designs, found, strict=False)]
    return Ratings(rated, asked.block(), len(designs) - len(rated), stopped)


# ---- fronts ---------------------------------------------------------------------------------------------------------


class Asks(Protocol):
    """A question that was checked: see ``synth.search``."""

    @property
    def instance(self) -> Instance:
        """The model with its requirements and restrictions."""
        ...

    @property
    def tuning(self) -> Tuning:
        """What its search goes by."""
        ...

    def within(self, seconds: float | None) -> Asks:
        """Return the same with another time limit; None: without any."""
        ...

    def answer(self, progress: Progress | None = None, known: Sequence[Design] = ()) -> ParetoFront:
        """Search the designs."""
        ...


def robust_front(
    pose: Callable[[Uncertainty], Asks],
    rater: Rater,
    progress: Progress | None = None,
    time_limit: float | None = None,
    known: Sequence[Design] = (),
    first: ParetoFront | None = None,
) -> ParetoFront:
    """Search designs and rate them; where limits are to hold over the range, until they do.

    Designs that keep all limits that were posed, but not everywhere in the range, tell where they fail: there those
    limits are posed as well, and the search begins again from what is known. What still fails in the end is taken off
    the front. Each question asked leaves out limits at most, so that its bounds hold for all robust designs.

    Parameters
    ----------
    pose : callable
        Returns the question with the limits posed that a block asks for.
    rater : Rater
        Rates designs of the nominal problem.
    progress, time_limit
        As for ``synthesize``.
    known : list of Design
        Where to look first.
    first : ParetoFront, optional
        The answer to the first question, where it is known.
    """
    deadline = math.inf if time_limit is None else time.monotonic() + time_limit

    def ask(asked: Uncertainty, known: Sequence[Design], front: ParetoFront | None = None) -> _Answer:
        question = pose(asked)
        check_rows(rater.things, question.instance.selection.slots)
        if front is None:
            left = None if time_limit is None else max(deadline - time.monotonic(), SHORTEST)
            front = question.within(left).answer(progress, known)
        # Designs that nobody rated are of little use: that takes a moment even where the time is over.
        ratings, stopped = rater.rate(front.designs, progress, max(deadline, time.monotonic() + GRACE))
        more = len(question.instance.model.limits) - len(rater.model.limits)
        return _Answer(asked, front, ratings, front.interrupted or stopped, more, question.tuning.robust)

    got, searches = ask(rater.asked, known, first), 1
    while got.asked.mode == LIMITS and got.failing and not got.stopped and searches < got.limits.searches:
        try:
            better = ask(got.asked.with_scenarios(got.scenarios()), got.front.designs)
        except KeyboardInterrupt:
            got = replace(got, stopped="interrupted")
            break
        searches += 1
        # A search that was not finished counts only where it brought more designs that hold.
        got = replace(got, stopped=better.stopped) if better.stopped and better.holding <= got.holding else better
    return got.told(searches)


@dataclass(frozen=True)
class _Answer:
    """A front with the ratings of its designs, and what stopped the work if something did."""

    asked: Uncertainty
    front: ParetoFront
    ratings: list[dict[str, Any]]
    stopped: str
    posed: int  # limits beside those of the problem
    limits: RobustLimits

    @property
    def failing(self) -> list[int]:
        """Return the places of the designs that do not keep all limits."""
        return [j for j, told in enumerate(self.ratings) if not told["holds"]]

    @property
    def holding(self) -> int:
        """Return how many designs keep all limits."""
        return len(self.ratings) - len(self.failing)

    def scenarios(self) -> dict[str, list[tuple[float, ...]]]:
        """Return the points at which limits fail, the worst first, and a few of each limit."""
        found: dict[str, list[tuple[float, tuple[float, ...]]]] = {}
        for j in self.failing:
            for name, limit in self.ratings[j]["limits"].items():
                if not limit["holds"]:
                    worst = math.inf if limit["residual"] is None else limit["residual"]
                    found.setdefault(name, []).append((worst, tuple(limit["position"])))
        few = {name: sorted(points, key=lambda x: -x[0])[: self.limits.scenarios] for name, points in found.items()}
        return {name: [point for _, point in points] for name, points in few.items()}

    def told(self, searches: int) -> ParetoFront:
        """Return the front: its designs tell how they stand the range, its question repeats what scatters."""
        front, block = self.front, self.asked.block()
        counts = {"searches": searches, "rated": len(self.ratings), "samples": self.asked.samples}
        if self.asked.mode == LIMITS:
            counts |= {"limits_posed": self.posed, "taken_off": len(self.failing)}
        frame = replace(front.frame, restated={**front.frame.restated, "robust": block})
        known = [*self.ratings, *({} for _ in range(len(front.designs) - len(self.ratings)))]
        done = replace(
            front,
            frame=frame,
            designs=[replace(d, frame=frame, robust=told) for d, told in zip(front.designs, known, strict=True)],
            statistics=replace(front.statistics, robust=counts),
            settings={**front.settings, "robust": block},
            interrupted=self.stopped,
        )
        return _without(done, self.failing) if self.asked.mode == LIMITS and self.failing else done


def _without(front: ParetoFront, failing: Sequence[int]) -> ParetoFront:
    """Return a front without some of its designs, ranked again."""
    kept = [d for j, d in enumerate(front.designs) if j not in failing]
    chosen = dict(front.frame.objectives)
    weights = front.settings.get("weights") or {}
    _, kept = ranked(kept, chosen, [weights.get(n, 1.0) for n in chosen])
    if not kept:
        # Nothing says that there is no robust design; there is none here that anything could be proven of.
        certificate = replace(front.certificate, kind="heuristic", gap=None, resolution={}, units={})
        return replace(front, designs=[], complete=False, status=Status.NOT_SOLVED, certificate=certificate)
    return replace(front, designs=kept, complete=False)
