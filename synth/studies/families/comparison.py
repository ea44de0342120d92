"""What a comparison of several families gives: one ranked front, and a line for each family that lost and why."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

from synth.folders.csv_style import ENGLISH, CsvStyle
from synth.folders.files import csv_text, table_frame
from synth.folders.output_folder import FRONT, save_result
from synth.order.feasibility import Status
from synth.results import Certificate, Design, ParetoFront, design_columns, design_row
from synth.results.assembly import without_design
from synth.results.certificate import all_of, none_of
from synth.results.design import with_groups
from synth.results.drawings import front_picture
from synth.results.loading import COMPARISON
from synth.results.rating_tables import COLUMNS, limits_table, rating_row
from synth.text.numbers import gap_text, typed_number
from synth.units import typed_quantity

if TYPE_CHECKING:
    import pandas as pd

COMPARISON_FORMAT = 1  # of comparison.json


@dataclass(frozen=True)
class FamilyOutcome:
    """How one family came out.

    ``outcome`` is listed (it has designs on the common front), beaten, infeasible (proven), not_found (not proven),
    refused (it does not understand the sheet, lacks something, or refuses a value), not_covered (it cannot do what is
    asked) or stopped; ``sentence`` says why, and which requirements do not matter to it.
    ``instead`` names what serves where it does not, ``not_used`` the requirements that do not matter to it.
    ``front`` is its own front, where it was searched, ``listed`` how many of its designs are on the common one,
    ``meanings`` what the objectives mean in it,
    ``offers`` its own objectives, and whether they count where none is named; nothing where some were named.
    """

    family: str
    title: str
    outcome: str
    sentence: str
    listed: int = 0
    front: ParetoFront | None = None
    beaten_by: Design | None = None
    meanings: Mapping[str, str] = field(default_factory=dict)
    offers: Mapping[str, bool] = field(default_factory=dict)
    instead: str = ""
    not_used: str = ""


@dataclass(frozen=True)
class Comparison:
    """One front over the designs of several families.

    ``designs`` are in rank order; ``families`` names, design by design, the family as ``outcomes`` does.
    """

    objectives: Mapping[str, str]
    designs: list[Design]
    families: list[str]
    outcomes: list[FamilyOutcome]
    certificate: Certificate
    settings: Mapping[str, Any]
    interrupted: str = ""
    seconds: float = 0.0

    @property
    def status(self) -> Status:
        """State of the comparison, as of a front."""
        if self.designs:
            return Status.OPTIMAL if self.certificate.kind == "global" else Status.FEASIBLE
        return without_design(self.certificate, self.interrupted)

    @property
    def not_compared(self) -> list[str]:
        """Return, in a sentence each, objectives that families have by themselves and that are none here."""
        searched = [x for x in self.outcomes if x.front is not None]
        names = dict.fromkeys(n for x in searched for n, default in x.offers.items() if default)
        sentences = []
        for name in (n for n in names if n not in self.objectives):
            whose = ", ".join(x.family for x in searched if x.offers.get(name))
            without = [x.family for x in searched if name not in x.offers]
            lacking = f"{', '.join(without)} {'have' if len(without) > 1 else 'has'} no such objective"
            why = lacking if without else "name it under objectives to compare by it"
            sentences.append(f"not compared by {name}, an objective of {whose} alone: {why}")
        return sentences

    def sentence(self) -> str:
        """Sentence on how far the common front is proven."""
        searched = sum(x.front is not None for x in self.outcomes)
        those = "the family" if searched == 1 else f"the {searched} families"
        count = self.certificate.combinations
        if self.certificate.kind == "global" and self.designs:
            return (
                f"proven: over {all_of(count)} of parts and counts of {those} searched no design improves one "
                f"listed here by more than {gap_text(self.certificate.gap or 0)} in every objective"
                f"{self.certificate.amounts()}"
            )
        if self.certificate.kind == "global":
            return f"proven: {none_of(count)} of parts and counts of {those} searched is feasible"
        if self.interrupted:
            return f"not proven: stopped ({self.interrupted}) before every family was searched to the end"
        if self.certificate.budget is not None:
            budget = typed_number(self.certificate.budget)
            return f"not proven: best found in the budget of {budget} s; a longer time limit may find and prove more"
        return f"not proven ({self.certificate.kind}): the certificate of each family says how far it is"

    def to_frame(self) -> pd.DataFrame:
        """Return one row per design, with units in the headers; what a family does not have is empty."""
        return table_frame(*self._table())

    def families_frame(self) -> pd.DataFrame:
        """Return one row per family."""
        return table_frame(*self._family_table())

    def files(self, folder: Path | None = None) -> dict[str, str]:
        """Files that ``save`` writes into its folder: file name -> text; ``folder``: where they will stand."""
        width = max(2, len(str(len(self.designs))))
        files = {
            "designs.csv": csv_text(*self._table()),
            "families.csv": csv_text(*self._family_table()),
            COMPARISON: self._json(),
        }
        if any(d.robust for d in self.designs):
            files["robust.csv"] = csv_text(*limits_table(self.designs))
        for design in self.designs:
            placed = design if folder is None else design.placed(folder)
            files[f"design_{design.rank:0{width}d}.yaml"] = placed.yaml()
        return files

    def family_files(self, folder: Path | None = None) -> dict[str, str]:
        """Return the files of each family's own front, in a folder of its name; ``folder``: where that will stand."""
        return {
            f"{outcome.family}/{name}": text
            for outcome in self.outcomes
            if outcome.front is not None
            for name, text in outcome.front.files(None if folder is None else folder / outcome.family).items()
        }

    def save(self, folder: str | Path, csv: CsvStyle = ENGLISH) -> Path:
        """Write designs.csv, families.csv, comparison.json, design_NN.yaml, and each family's own front in a folder.

        What was stopped replaces no earlier result: it is written to a folder ``stopped`` beside that.
        """

        def files(place: Path) -> dict[str, str]:
            return csv.files({**self.files(place), **self.family_files(place)})

        return save_result(folder, files, FRONT, bool(self.interrupted))

    def svg(self) -> str:
        """Return the common front drawn as an SVG file; nothing where it has no two designs or objectives."""
        proven = self.sentence()
        return front_picture(self.designs, self.objectives, "Common front", proven, self.interrupted, self.families)

    def _table(self) -> tuple[list[str], list[list[Any]]]:
        known = [
            dict(zip(design_columns(d.frame, d.choices, d.parts), design_row(d.frame, d), strict=True))
            for d in self.designs
        ]
        every = sorted({c: None for columns in known for c in columns}, key=lambda c: c.startswith("utilisation: "))
        rated = any(d.robust for d in self.designs)
        rows: list[list[Any]] = [
            [
                d.rank,
                d.score,
                name,
                d.status.value,
                d.gap,
                d.note,
                "; ".join(d.alternatives),
                *map(values.get, every),
                *(rating_row(d) if rated else ()),
            ]
            for d, name, values in zip(self.designs, self.families, known, strict=True)
        ]
        columns = ["rank", "score", "family", "status", "gap", "note", "alternatives", *every]
        columns += COLUMNS if rated else ()
        return with_groups(columns, rows, self.designs)

    def _family_table(self) -> tuple[list[str], list[list[Any]]]:
        columns = [
            "family",
            "title",
            "outcome",
            "listed",
            "why",
            "instead",
            "not_used",
            "designs",
            "certificate",
            "gap",
        ]
        columns += ["combinations", *(f"{what} {n}" for what in ("best", "meaning of") for n in self.objectives)]
        rows: list[list[Any]] = []
        for x in self.outcomes:
            front_cells: list[Any] = [None] * 4
            if x.front is not None:
                certificate = x.front.certificate
                front_cells = [len(x.front.designs), certificate.kind, certificate.gap, certificate.combinations]
            best = [best_value(x.front, n, sense) for n, sense in self.objectives.items()]
            meanings = [x.meanings.get(n) for n in self.objectives]
            rows.append(
                [
                    x.family,
                    x.title,
                    x.outcome,
                    x.listed,
                    x.sentence,
                    x.instead,
                    x.not_used,
                    *front_cells,
                    *best,
                    *meanings,
                ]
            )
        return columns, rows

    def _json(self) -> str:
        content = {
            "format": COMPARISON_FORMAT,
            "objectives": dict(self.objectives),
            "status": self.status.value,
            "interrupted": self.interrupted,
            "certificate": self.certificate.__dict__,
            "sentence": self.sentence(),
            "settings": dict(self.settings),
            "seconds": self.seconds,
            "families": [
                {
                    "family": x.family,
                    "title": x.title,
                    "outcome": x.outcome,
                    "why": x.sentence,
                    "listed": x.listed,
                    "folder": None if x.front is None else x.family,
                    "beaten_by": None if x.beaten_by is None else x.beaten_by.rank,
                }
                for x in self.outcomes
            ],
            "designs": [
                {
                    "rank": d.rank,
                    **({} if d.group is None else {"group": d.group}),
                    "score": d.score,
                    "family": name,
                    "note": d.note,
                    "objectives": dict(d.objectives),
                    **({"robust": d.robust.to_json()} if d.robust else {}),
                }
                for d, name in zip(self.designs, self.families, strict=True)
            ],
        }
        return json.dumps(content, indent=1, allow_nan=False, ensure_ascii=False) + "\n"


def best_value(front: ParetoFront | None, name: str, sense: str) -> str | None:
    """Return the best value of an objective on a front with its unit; None where there is no design."""
    if front is None or not front.designs:
        return None
    values = [d.values[name] for d in front.designs]
    return typed_quantity(min(values) if sense == "min" else max(values), front.frame.units[name])
