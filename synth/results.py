"""Results: designs and fronts, immutable, and the tables that are made of them."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

from synth.feasibility import Status
from synth.files import csv_text, yaml_text
from synth.front_record import digest_of, front_record, record_text
from synth.output_folder import FRONT, save_result
from synth.rated import COLUMNS, limits_table, rating_row
from synth.resolution import in_words
from synth.statistics import SearchStatistics
from synth.units import format_quantity, from_si, header

if TYPE_CHECKING:
    import pandas as pd

    from synth.verification import Verification


class PartRow(Mapping[str, Any]):
    """One catalogue row that fills a slot: designation, columns in SI, source, confidence, table.

    ``str()`` is the designation.
    """

    def __init__(self, table: str, digest: str, columns: Mapping[str, Any]) -> None:
        self._columns = {**columns, "table": table, "hash": digest}

    def __getitem__(self, key: str) -> Any:
        return self._columns[key]

    def __iter__(self) -> Iterator[str]:
        return iter(self._columns)

    def __len__(self) -> int:
        return len(self._columns)

    def __str__(self) -> str:
        return str(self._columns["designation"])

    def __repr__(self) -> str:
        return f"PartRow({self._columns['table']}: {self})"


@dataclass(frozen=True)
class Frame:
    """What the designs of one front share: how to show them and how to state them again.

    ``restated`` holds what a DESIGN.yaml must repeat so that a check sees the same question: limits, catalogs.
    """

    family: str
    title: str
    options: Mapping[str, str]
    requirements: Mapping[str, str]
    requirement_values: Mapping[str, float]
    not_asked: tuple[str, ...]
    objectives: Mapping[str, str]
    units: Mapping[str, str]
    kinds: Mapping[str, str]
    limit_units: Mapping[str, str]
    limit_senses: Mapping[str, str]
    restated: Mapping[str, Any] = field(default_factory=dict)


@dataclass(frozen=True)
class Design:
    """One evaluated design.

    ``values`` holds every variable, count and derived quantity in SI (not-a-number where it does not
    exist), ``utilisation`` every limit (None where it is void), ``limits`` both sides of it in SI. ``outside`` tells
    which values of a given design lie outside of the range that is searched, and what that is. ``steps`` holds, for a
    design that was just evaluated, quantities on the way to others by name in SI, which hooks read. ``robust`` tells,
    where that was asked, how the design stands what scatters: ``holds``, ``proof``, ``yield`` with ``yield_low`` and
    ``yield_high``, ``worst_limit``, and per limit its worst point.
    """

    frame: Frame
    values: Mapping[str, float]
    parts: Mapping[str, PartRow]
    choices: Mapping[str, str]
    objectives: Mapping[str, float]
    limits: Mapping[str, tuple[float, float]]
    residuals: Mapping[str, float]
    utilisation: Mapping[str, float | None]
    status: Status
    elasticity: Mapping[str, Mapping[str, float]] = field(default_factory=dict)
    gap: float | None = None
    rank: int | None = None
    score: float | None = None
    note: str = ""
    alternatives: tuple[str, ...] = ()
    off_grid: Mapping[str, str] = field(default_factory=dict)
    outside: Mapping[str, str] = field(default_factory=dict)
    advice: tuple[str, ...] = ()
    violated: tuple[str, ...] = ()
    not_checked: tuple[str, ...] = ()
    robust: Mapping[str, Any] = field(default_factory=dict)
    steps: Mapping[str, float] = field(default_factory=dict)

    def to_spec(self) -> dict[str, Any]:
        """Return the design as a DESIGN.yaml mapping: strings with units that read back exactly."""
        frame = self.frame
        named = [n for n, kind in frame.kinds.items() if kind in ("variable", "count")]
        values: dict[str, str] = {n: format_quantity(self.values[n], frame.units[n], None) for n in named}
        values.update(self.choices)
        spec: dict[str, Any] = {"family": frame.family}
        if frame.options:
            spec["options"] = dict(frame.options)
        spec["requirements"] = dict(frame.requirements)
        spec.update(frame.restated)
        spec["values"] = values
        spec["parts"] = {slot: str(row) for slot, row in self.parts.items()}
        return spec

    def yaml(self) -> str:
        """Return the text of a DESIGN.yaml."""
        return yaml_text(self.to_spec())


@dataclass(frozen=True)
class Certificate:
    """How far a front is proven.

    ``kind`` is ``global`` (valid bounds prove the gap), ``exhaustive`` (every combination that no valid
    bound excludes was solved from several starts) or ``heuristic``. ``gap`` is what bounds prove, whatever the kind;
    None where they prove nothing, or there is no design. ``budget`` is the time, in seconds, that ended the search
    where it was the default budget; such a search may end otherwise on another machine.

    ``resolution`` tells, in SI, by how much a design must be better in an objective for the claim to speak of it, where
    that is no share of its value because it may be zero or negative, or is to be made large; ``units`` are theirs.
    """

    kind: str
    gap: float | None
    combinations: int
    excluded_by_bound: int
    solved: int
    unresolved: int = 0
    budget: float | None = None
    resolution: Mapping[str, float] = field(default_factory=dict)
    units: Mapping[str, str] = field(default_factory=dict)

    def amounts(self) -> str:
        """Return in words what the gap stands for where it is no share of the value."""
        return in_words(self.resolution, self.units)

    def sentence(self) -> str:
        """Return the certificate in words."""
        n = f"{self.combinations:,}".replace(",", " ")
        if self.kind == "global" and self.gap is None:
            return f"proven: none of the {n} combinations of parts and counts can meet the requirements"
        if self.kind == "global":
            return (
                f"proven: over all {n} combinations of parts and counts no design improves one listed here "
                f"by more than {100 * (self.gap or 0):.3g} % in every objective{self.amounts()}"
            )
        end = "" if self.budget is None else f"; more time than the budget of {self.budget:g} s may prove more"
        if self.kind == "exhaustive":
            return (
                f"exhaustive: of {n} combinations {self.excluded_by_bound} are excluded by bounds; every other one "
                f"was solved from several starts ({self.unresolved} boxes could not be closed by bounds, "
                f"which prove a gap of {_percent(self.gap)}{self.amounts()}{end})"
            )
        gap = f"gap {_percent(self.gap)}{self.amounts()}{end}"
        return f"not proven: stopped before all of {n} combinations were covered; {gap}"


@dataclass(frozen=True)
class ParetoFront:
    """The ranked non-dominated designs for one requirement.

    ``question`` is the instance it answers, ``record`` and ``folder`` what it was read from: of these three a front
    that was just computed has the first, one that was loaded the others.
    """

    frame: Frame
    designs: list[Design]
    status: Status
    complete: bool
    statistics: SearchStatistics
    certificate: Certificate
    explanation: Mapping[str, Any] | None
    settings: Mapping[str, Any]
    interrupted: str = ""
    question: Any = field(default=None, repr=False, compare=False)
    record: Mapping[str, Any] | None = field(default=None, repr=False, compare=False)
    folder: Path | None = field(default=None, repr=False, compare=False)

    def to_frame(self) -> pd.DataFrame:
        """Return one row per design, with units in the headers."""
        import pandas as pd  # costly to import; most runs write CSV only

        columns, rows = self.table()
        frame = pd.DataFrame(rows, columns=columns)
        return frame.set_index("rank", drop=False).rename_axis(None) if len(frame) else frame

    def save(self, folder: str | Path) -> Path:
        """Write designs.csv, front.json and one design_NN.yaml per design, all or none; return the folder.

        A search that was stopped replaces no earlier result: it is written to a folder ``stopped`` beside that.
        """
        return save_result(folder, self.files(), FRONT, bool(self.interrupted))

    def files(self) -> dict[str, str]:
        """Return what ``save`` writes: file name -> text."""
        width = max(2, len(str(len(self.designs))))
        found = {"designs.csv": self._csv(), "front.json": record_text(front_record(self))}
        if any(design.robust for design in self.designs):
            found["robust.csv"] = csv_text(*limits_table(self.designs))
        for design in self.designs:
            found[f"design_{design.rank:0{width}d}.yaml"] = design.yaml()
        return found

    def verify(self, problem: Any = None, catalogs: Any = None, time_limit: float = 120.0) -> Verification:
        """Check the front without help of the search: the record, every design, and the claim of the certificate.

        Parameters
        ----------
        problem : family name, DesignProblem subclass or instance, optional
            For a loaded front of a problem of your own.
        catalogs : folder or mapping, optional
            Own tables that were in memory; those that were files are read again.
        time_limit : float
            Seconds for the proof.

        Returns
        -------
        Verification
            ``holds``, ``findings``, ``proven_gap`` and a ``sentence()``.

        Raises
        ------
        InputError
            When the problem or its tables cannot be had.
        """
        from synth.verify import verify  # most runs do not need it

        return verify(self, problem, catalogs, time_limit)

    def improve(
        self,
        time_limit: float | None = None,
        problem: Any = None,
        catalogs: Any = None,
        workers: int = 1,
        progress: Callable[[Mapping[str, Any]], None] | None = None,
    ) -> ParetoFront:
        """Go on with the search from the designs of this front; the result is never worse.

        Parameters
        ----------
        time_limit : float, optional
            Seconds; by default the search goes on as long as one from the start would.
        problem : family name, DesignProblem subclass or instance, optional
            For a loaded front of a problem of your own.
        catalogs : folder or mapping, optional
            Own tables that were in memory; those that were files are read again.
        workers, progress
            As for ``synthesize``.

        Returns
        -------
        ParetoFront

        Raises
        ------
        InputError
            When the question cannot be posed again.
        """
        import synth  # it knows who searches; results do not

        return synth.improve(self, problem, catalogs, time_limit=time_limit, workers=workers, progress=progress)

    def table(self) -> tuple[list[str], list[list[Any]]]:
        """Return headers with units, and one row per design; None where there is no value."""
        first = self.designs[0] if self.designs else None
        columns = ["rank", "score", "status", "gap", "note", "alternatives"]
        columns += design_columns(self.frame, first.choices if first else (), first.parts if first else ())
        rows: list[list[Any]] = [
            [d.rank, d.score, d.status.value, d.gap, d.note, "; ".join(d.alternatives), *design_row(self.frame, d)]
            for d in self.designs
        ]
        if any(d.robust for d in self.designs):
            columns += COLUMNS
            rows = [[*row, *rating_row(d)] for row, d in zip(rows, self.designs, strict=True)]
        return columns, rows

    def _csv(self) -> str:
        return csv_text(*self.table())

    @staticmethod
    def digest_of(content: Mapping[str, Any]) -> str:
        """Return the SHA-256 of the content of a front.json, without regard to the order of its keys."""
        return digest_of(content)


def _order(frame: Frame) -> tuple[list[str], list[str]]:
    """Return the quantities that stand before choices and parts, and those that stand behind."""
    early = [n for n, kind in frame.kinds.items() if n not in frame.objectives and kind in ("variable", "count")]
    early.sort(key=lambda n: frame.kinds[n] != "variable")
    late = [n for n, kind in frame.kinds.items() if n not in frame.objectives and kind == "derived"]
    return [*frame.objectives, *early], late


def design_columns(frame: Frame, choices: Iterable[str], slots: Iterable[str]) -> list[str]:
    """Return headers of what tables say of a design: objectives, sizes, choices, parts, derived, utilisation."""
    early, late = _order(frame)
    columns = [header(n, frame.units[n]) for n in early] + [*choices] + [*slots]
    return columns + [header(n, frame.units[n]) for n in late] + [f"utilisation: {n}" for n in frame.limit_units]


def design_row(frame: Frame, design: Design) -> list[Any]:
    """Return what belongs under ``design_columns``; None where there is no value."""
    early, late = _order(frame)
    row: list[Any] = [shown_value(design.values[n], frame.units[n]) for n in early]
    row += [*design.choices.values(), *(str(part) for part in design.parts.values())]
    row += [shown_value(design.values[n], frame.units[n]) for n in late]
    return row + [design.utilisation.get(n) for n in frame.limit_units]


def shown_value(value: float, unit: str) -> float | None:
    """Return an SI value in the unit of its column; None where it does not exist."""
    return float(from_si(value, unit)) if math.isfinite(value) else None


def _percent(gap: float | None) -> str:
    return "unknown" if gap is None or not math.isfinite(gap) else f"{100 * gap:.3g} %"
