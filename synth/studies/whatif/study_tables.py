"""The tables of a what-if study: a row per step and design, and a row per break point."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Any

from synth.results import Design, Frame
from synth.results.design import reached_limits
from synth.results.rating_tables import COLUMNS, rating_row
from synth.studies.whatif.study_answers import Break, StudyAnswers, StudyStep
from synth.studies.whatif.vary import Value
from synth.units import finite_from_si, header

Rows = list[list[Any]]


@dataclass(frozen=True)
class _Columns:
    """What has columns of its own, in the order of all steps: with units where there are any.

    ``prices`` are pairs of an objective and what it is elastic to; ``rated``: whether any design is.
    """

    objectives: dict[str, str]
    searched: dict[str, str]
    slots: list[str]
    choices: list[str]
    prices: list[tuple[str, str]]
    rated: bool

    @classmethod
    def of(cls, study: StudyAnswers) -> _Columns:
        """Columns of the designs of a study."""
        frames = [f.frame for f in study.fronts]
        designs = [d for f in study.fronts for d in f.designs]
        objectives = study.objectives()
        units = {n: u for frame in frames for n, u in frame.units.items()}
        names = [n for kind in ("variable", "count") for n in _union(_of_kind(f, kind) for f in frames)]
        return cls(
            objectives=objectives,
            searched={n: units[n] for n in names if n not in objectives},
            slots=_union(d.parts for d in designs),
            choices=_union(d.choices for d in designs),
            prices=[(x, name) for x in objectives for name in _union(d.elasticity.get(x, {}) for d in designs)],
            rated=any(d.robust for d in designs),
        )

    def headings(self) -> list[str]:
        """Return the headings, from the status of a design to the reason why there is none."""
        return [
            *("status", "rank", "note"),
            *(header(n, unit) for n, unit in self.objectives.items()),
            *("binding", *self.slots, *self.choices),
            *(header(n, unit) for n, unit in self.searched.items()),
            *(f"elasticity: {objective} by {name}" for objective, name in self.prices),
            *(COLUMNS if self.rated else ()),
            *("certificate", "gap", "reason"),
        ]

    def cells(self, d: Design) -> list[Any]:
        """Return the cells of a design, from its status to what it is rated."""
        return [
            *(d.status.value, d.rank, d.note),
            *(finite_from_si(d.values.get(n), unit, None) for n, unit in self.objectives.items()),
            "; ".join(reached_limits(d)),
            *(str(d.parts[s]) if s in d.parts else None for s in self.slots),
            *(d.choices.get(c) for c in self.choices),
            *(finite_from_si(d.values.get(n), unit, None) for n, unit in self.searched.items()),
            *(d.elasticity.get(objective, {}).get(name) for objective, name in self.prices),
            *(rating_row(d) if self.rated else []),
        ]


def steps_table(study: StudyAnswers) -> tuple[list[str], Rows]:
    """Return headings and one row per step and design; a step without designs has one row."""
    columns = _Columns.of(study)
    headings = columns.headings()
    rows = [row for step in study.steps for row in _rows(study, step, columns, len(headings))]
    return ["step", *study.headers(), *headings], rows


def _rows(study: StudyAnswers, step: StudyStep, columns: _Columns, width: int) -> Rows:
    front, start = step.front, [step.number, *_cells(study, step.values)]
    kind = "" if front is None else front.certificate.kind
    if front is None or not front.designs:
        return [[*start, step.status.value, *[None] * (width - 4), kind, None, step.reason]]
    return [[*start, *columns.cells(d), kind, front.certificate.gap, ""] for d in front.designs]


def _cells(study: StudyAnswers, values: Sequence[Value]) -> list[Any]:
    return [v if x.numeric else x.shown(v) for x, v in zip(study.varied, values, strict=True)]


def breaks_table(study: StudyAnswers) -> tuple[list[str], Rows]:
    """Return headings and one row per break point."""
    k, units = study.along, study.objectives()
    if k is None:
        return ["objective", "kind", "change", "proven", "remark"], []
    heads = study.headers()
    others = [x for j, x in enumerate(study.varied) if j != k]
    columns = ["objective", *(h for j, h in enumerate(heads) if j != k), heads[k], "from", "to", "kind", "change"]
    columns += ["objective before", "objective after", "parts before", "parts after", "proven", "remark"]
    rows = []
    for b in study.breaks:
        row: list[Any] = [b.objective]
        row += [v if x.numeric else x.shown(v) for x, v in zip(others, b.others, strict=True)]
        row += [b.value, b.low, b.high, b.kind, b.change, *_sides(b, units)]
        rows.append([*row, "yes" if b.proven else "no", b.remark])
    return columns, rows


def _sides(b: Break, units: dict[str, str]) -> list[Any]:
    """Values reached on both sides of a break, and of which objectives."""
    sides = (b.before, b.after)
    unit = units.get(b.objective)
    reached = [None if side is None or unit is None else finite_from_si(side.value, unit, None) for side in sides]
    parts = ["" if side is None else ", ".join(f"{n} {w}" for n, w in side.named.items()) for side in sides]
    return [*reached, *parts]


def _union(groups: Iterable[Iterable[str]]) -> list[str]:
    return list(dict.fromkeys(name for group in groups for name in group))


def _of_kind(frame: Frame, kind: str) -> list[str]:
    return [n for n, k in frame.kinds.items() if k == kind]
