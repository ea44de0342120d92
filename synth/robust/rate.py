"""Rating: how designs fare under scatter."""

from __future__ import annotations

import json
import math
import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from synth.errors import InputError
from synth.folders.csv_style import ENGLISH, CsvStyle
from synth.folders.files import csv_text, table_frame
from synth.folders.output_folder import RATING, save_result
from synth.model.registry import load
from synth.question.arguments import Family, Scatter, UserTables, Value
from synth.question.catalogs import catalogs_for
from synth.question.request import Request
from synth.question.settings import Progress, SearchSettings, check_progress
from synth.question.uncertainty import Uncertainty, read_block
from synth.results import Design, Frame, ParetoFront, design_columns, design_row
from synth.results.rating_tables import COLUMNS, limits_table, rating_row, robust_sentence
from synth.robust.counterpart import nominal
from synth.robust.rating import Rater
from synth.verbs.requests import RateRequest

if TYPE_CHECKING:
    import pandas as pd


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
        """Number of designs that keep their limits over the range, and how far that is certain."""
        return robust_sentence(self.designs)

    def to_frame(self) -> pd.DataFrame:
        """Return one row per design, with units in the headers."""
        return table_frame(*self._table())

    def files(self) -> dict[str, str]:
        """Files that ``save`` writes: file name -> text."""
        record = {
            "family": self.designs[0].frame.family if self.designs else None,
            "robust": dict(self.asked),
            "rated": len(self.designs),
            "missing": self.missing,
            "interrupted": self.interrupted,
            "sentence": self.sentence(),
            "designs": [{"rank": d.rank, **d.robust.to_json()} for d in self.designs],
        }
        return {
            "rating.csv": csv_text(*self._table()),
            "robust.csv": csv_text(*limits_table(self.designs)),
            "rating.json": json.dumps(record, indent=1, allow_nan=False, ensure_ascii=False) + "\n",
        }

    def save(self, folder: str | Path, csv: CsvStyle = ENGLISH) -> Path:
        """Write rating.csv, robust.csv and rating.json; return the folder.

        What was stopped replaces no earlier result: it is written to a folder ``stopped`` beside that.
        """
        return save_result(folder, csv.files(self.files()), RATING, bool(self.interrupted))

    def _table(self) -> tuple[list[str], list[list[Any]]]:
        if not self.designs:
            return ["rank", *COLUMNS], []
        first = self.designs[0]
        columns = ["rank", *COLUMNS, *design_columns(first.frame, first.choices, first.parts)]
        return columns, [[d.rank, *rating_row(d), *design_row(d.frame, d)] for d in self.designs]


def rater_for(
    frame: Frame, uncertainty: Uncertainty, problem: Family | None = None, catalogs: UserTables = None
) -> Rater:
    """Rating function for the designs of a frame.

    Parameters
    ----------
    frame : Frame
    uncertainty : Uncertainty
        What scatters.
    problem, catalogs : optional
        As for :func:`rate`.

    Raises
    ------
    InputError
        When the block does not fit the family, or its tables cannot be had.
    """
    base = nominal(load(frame.family, **frame.options) if problem is None else load(problem))
    tables = catalogs_for(base, frame.restated.get("catalogs") if catalogs is None else catalogs)
    limits = frame.restated.get("limits") or {}
    return Rater(Request(problem=base, requirements=frame.requirements, catalogs=tables, limits=limits), uncertainty)


def rate(
    source: ParetoFront | Design | Sequence[Design],
    robust: Scatter | None = None,
    *,
    problem: Family | None = None,
    catalogs: UserTables = None,
    samples: int | None = None,
    confidence: Value | None = None,
    seed: int | None = None,
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
    samples, confidence, seed : optional
        In place of these entries of the block.
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
    block = frame.restated.get("robust") if robust is None else robust
    block = block.block() if isinstance(block, Uncertainty) else block
    if isinstance(block, Mapping):
        block = RateRequest(samples=samples, confidence=confidence, seed=seed).block(block)
    uncertainty = read_block(block)
    question = source.question if isinstance(source, ParetoFront) else None
    if question is not None and problem is None:
        problem, catalogs = nominal(question.problem), question.catalogs if catalogs is None else catalogs
    rater = rater_for(frame, uncertainty, problem, catalogs)
    deadline = math.inf if settings.time_limit is None else time.monotonic() + settings.time_limit
    ratings, stopped = rater.rate(designs, progress, deadline)
    rated = [replace(d, robust=r) for d, r in zip(designs, ratings, strict=False)]
    return Ratings(rated, uncertainty.block(), len(designs) - len(rated), stopped)
