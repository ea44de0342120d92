"""A what-if study: its steps, its break points, the tables they become and the files they are saved to."""

from __future__ import annotations

import shutil
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

from synth.folders.csv_style import ENGLISH, CsvStyle
from synth.folders.files import csv_text, table_frame
from synth.folders.output_folder import STUDY, claimed, loses_nothing, save_files, save_result
from synth.results.drawings import report
from synth.results.notebook import notebook_html
from synth.studies.study_store import STEPS, StudyStore
from synth.studies.whatif.study_answers import NOT_REACHED, StudyAnswers
from synth.studies.whatif.study_curves import curves_of
from synth.studies.whatif.study_tables import breaks_table, steps_table

if TYPE_CHECKING:
    import pandas as pd


@dataclass(frozen=True)
class Study(StudyAnswers):
    """Fronts for all values of what is varied, and where the best parts change; told and saved.

    Parameters
    ----------
    varied, steps, breaks, along
        As for :class:`StudyAnswers`.
    interrupted : str
        What stopped the study; nothing where it was finished.
    statistics : mapping
        How many steps there are and were answered, and how long it took.
    store : StudyStore
        Where the answers of steps are kept.
    """

    interrupted: str = ""
    statistics: Mapping[str, Any] = field(default_factory=dict)
    store: StudyStore = field(default_factory=lambda: StudyStore(None), repr=False, compare=False)

    def to_frame(self) -> pd.DataFrame:
        """Return one row per step and design, with units in the headers; a step without designs has one row."""
        return table_frame(*steps_table(self))

    def breaks_frame(self) -> pd.DataFrame:
        """Return one row per break point."""
        return table_frame(*breaks_table(self))

    def curves(self) -> dict[str, pd.DataFrame]:
        """Drawings by file name, as the hooks of families make them: objectives over the varied quantity, fronts."""
        return curves_of(self)

    def _repr_html_(self) -> str:
        """Show the study in a notebook: its steps, and where other parts become best."""
        columns, rows = steps_table(self)
        heads, breaks = breaks_table(self)
        sentences = [
            f"{len(self.steps)} steps, {len(breaks)} break points",
            self.interrupted and f"stopped: {self.interrupted}",
        ]
        steps = notebook_html("What-if study", sentences, columns, rows, "open" if self.interrupted else "")
        return steps + (notebook_html("Break points", (), heads, breaks) if breaks else "")

    # -- files ---------------------------------------------------------------------------------

    def files(self) -> dict[str, str]:
        """Files that ``save`` writes: file name -> text."""
        files = {"whatif.csv": csv_text(*steps_table(self)), "breaks.csv": csv_text(*breaks_table(self))}
        draw = report("figure")
        if draw is not None and self.feasible:
            files |= {f"{key}.svg": draw(frame) for key, frame in self.curves().items()}
        return files

    def save(self, folder: str | Path, csv: CsvStyle = ENGLISH) -> Path:
        """Write whatif.csv, breaks.csv and the drawings; return the folder.

        A study that was stopped replaces no earlier result: it is written to a folder ``stopped..`` beside that, where
        its finished steps are, and goes there when it is finished.
        """
        target, files, kept = Path(folder), csv.files(self.files()), self.store.folder
        if kept is None or kept == target:
            known = loses_nothing(target, files, ("whatif.csv", "breaks.csv"), NOT_REACHED)
            return save_result(target, files, STUDY, bool(self.interrupted), known)
        if self.interrupted:
            return save_files(kept, files)
        with claimed(target):
            earlier = [f"{STEPS}/{path.name}" for path in (target / STEPS).glob("step_*.json")]
            save_result(target, {**files, **self.store.files()}, STUDY, False, drop=earlier)
            shutil.rmtree(kept, ignore_errors=True)  # all of it stands in the result now
        return target
