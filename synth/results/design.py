"""One design as it is returned and saved."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from types import MappingProxyType
from typing import Any

from synth.errors import InputError
from synth.folders.files import named_from, resolved_source, yaml_text
from synth.order.feasibility import Status, binds
from synth.order.pareto import LISTED
from synth.results.next_row import NextRow
from synth.results.notebook import notebook_html
from synth.results.plain import finite
from synth.results.ratings import DesignRating
from synth.text.numbers import percent
from synth.text.row_cells import Cell
from synth.units import finite_from_si, header, in_words, typed_quantity, written_quantity

SOURCE = re.compile(r" \[[^\[\]]*\]$")  # behind a remark


class PartRow(Mapping[str, Any]):
    """One catalogue row that fills a slot: designation, columns in SI, source, confidence, table.

    ``str()`` is the designation. ``units`` holds units of columns that no shipped table has, as people read them.
    """

    def __init__(
        self, table: str, digest: str, columns: Mapping[str, Cell], units: Mapping[str, str] = MappingProxyType({})
    ) -> None:
        self._columns = {**columns, "table": table, "hash": digest}
        self.units = units

    @classmethod
    def read(cls, entry: Mapping[str, Any]) -> PartRow:
        """Entry of a file."""
        cells = {name: x for name, x in entry.items() if name not in ("table", "hash", "units")}
        return cls(entry["table"], entry["hash"], cells, dict(entry.get("units", {})))

    def record(self) -> dict[str, Any]:
        """Entries of files."""
        cells = {name: finite(x) for name, x in self.items()}
        return {**cells, "units": dict(self.units)} if self.units else cells

    def __getitem__(self, key: str) -> Any:
        return self._columns[key]

    def __iter__(self) -> Iterator[str]:
        return iter(self._columns)

    def __len__(self) -> int:
        return len(self._columns)

    def __str__(self) -> str:
        return str(self._columns["designation"])

    @property
    def key(self) -> str:
        """What tells it from the rows of all tables."""
        return f"{self['table']}/{self}"

    def __repr__(self) -> str:
        return f"PartRow({self._columns['table']}: {self})"


@dataclass(frozen=True)
class Frame:
    """What the designs of one front share: how to show them and how to state them again.

    ``restated`` holds what a DESIGN.yaml must repeat so that a check sees the same question: limits, catalogs;
    ``headline`` names what people decide by beside the objectives, ``sized_by`` the limit whose sides are what a design
    carries and what it is sized for. ``tables`` holds hashes of the user's own tables by name.
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
    headline: tuple[str, ...] = ()
    sized_by: str = ""
    tables: Mapping[str, str] = field(default_factory=dict)

    def placed(self, folder: Path) -> Frame:
        """Return the frame with tables named from a folder, as files in it name them."""
        return self._renamed(lambda text: named_from(text, folder))

    def located(self, folder: Path) -> Frame:
        """Return the frame with tables that files in a folder name found again."""
        return self._renamed(lambda text: resolved_source(text, folder))

    def _renamed(self, rename: Callable[[str], str]) -> Frame:
        named = self.restated.get("catalogs")
        if not isinstance(named, Mapping):
            return self
        renamed = {
            table: rename(source) if isinstance(source, str) else [source[0], *map(rename, source[1:])]
            for table, source in named.items()
        }
        return replace(self, restated={**self.restated, "catalogs": renamed})


class DesignSteps(dict[str, float]):
    """Quantities on the way to others, by name in SI."""

    def __missing__(self, name: str) -> float:
        """Say what to do about a design that was saved before its family named this quantity."""
        right = "a design of synth.evaluate, or of a front that this version has found"
        raise InputError(f"design: {name}", None, right)


@dataclass(frozen=True)
class Design:
    """One evaluated design.

    ``values`` holds every variable, count and derived quantity in SI (not-a-number where it does not exist),
    ``utilisation`` every limit (None where it is void), ``limits`` both sides of it in SI. ``outside`` tells which
    values of a given design lie outside of the range that is searched, and what that is. ``steps`` holds quantities
    on the way to others by name in SI, which hooks read, ``next_rows`` the rows of tables that come next to some of its
    quantities, ``rows`` those of the user's own tables that it reads beside its parts. ``robust`` tells, where that was
    asked, how the design stands what scatters: ``holds``, ``verdict``, ``proof``, ``yield`` with ``yield_low`` and
    ``yield_high``, ``worst_limit``, and per limit its worst point. ``digits`` is how many of a variable its file needs
    to say the same design (0: all of them); None: it says all of them as text, counts too. ``group`` is the rank of a
    better design of the same parts, counts and choices that is nearly the same in all objectives, if there is one.
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
    group: int | None = None
    score: float | None = None
    note: str = ""
    alternatives: tuple[str, ...] = ()
    off_grid: Mapping[str, str] = field(default_factory=dict)
    outside: Mapping[str, str] = field(default_factory=dict)
    advice: tuple[str, ...] = ()
    violated: tuple[str, ...] = ()
    not_checked: tuple[str, ...] = ()
    robust: DesignRating = field(default_factory=DesignRating)
    steps: Mapping[str, float] = field(default_factory=DesignSteps)
    next_rows: Mapping[str, NextRow] = field(default_factory=dict)
    digits: int | None = None
    rows: tuple[PartRow, ...] = ()

    def placed(self, folder: Path) -> Design:
        """Return the design with tables named from a folder, as files in it name them."""
        return replace(self, frame=self.frame.placed(folder))

    @property
    def names(self) -> set[str]:
        """Return the names that sentences about it may have: of quantities, limits, requirements, slots and so on."""
        frame = self.frame
        inputs = {*frame.requirement_values, *frame.not_asked, *frame.options}
        return {*frame.units, *frame.limit_units, *inputs, *self.parts, *self.choices}

    @property
    def bare_advice(self) -> list[str]:
        """Return the remarks in words, without codes and sources, which ``describe`` and the sheet of a design tell."""
        return [in_words(SOURCE.sub("", remark.partition(": ")[2] or remark), self.names) for remark in self.advice]

    def to_spec(self) -> dict[str, Any]:
        """Return the design as a DESIGN.yaml mapping: strings with units that read back exactly."""
        frame = self.frame
        named = [n for n, kind in frame.kinds.items() if kind in ("variable", "count")]
        return self._spec({n: typed_quantity(self.values[n], frame.units[n], None) for n in named})

    def _spec(self, sizes: Mapping[str, object]) -> dict[str, Any]:
        """Return the mapping of a DESIGN.yaml with sizes as they are written there."""
        frame = self.frame
        values = {**sizes, **self.choices}
        spec: dict[str, Any] = {"family": frame.family}
        if frame.options:
            spec["options"] = dict(frame.options)
        spec["requirements"] = dict(frame.requirements)
        spec.update(frame.restated)
        spec["values"] = values
        spec["parts"] = {slot: str(row) for slot, row in self.parts.items()}
        kept = [row for row in (*self.parts.values(), *self.rows) if row["table"] in frame.tables]
        if kept:
            spec["rows"] = {row.key: row.record() for row in kept}
        return spec

    def _repr_html_(self) -> str:
        """Show the design in a notebook: whether it is feasible, its sizes, parts and results."""
        frame = self.frame
        violated = f"NOT FEASIBLE: {', '.join(self.violated)} violated"
        state = violated if self.violated else "feasible: all limits that apply hold"
        columns = design_columns(frame, self.choices, self.parts)
        rows = [
            [name, value]
            for name, value in zip(columns, design_row(frame, self), strict=True)
            if not name.startswith("utilisation: ")
        ]
        title = f"{frame.title}: design" + (f" #{self.rank}" if self.rank else "")
        level = "bad" if self.violated else "good"
        return notebook_html(title, [state, *self.advice], ["quantity", "value"], rows, level)

    def yaml(self) -> str:
        """Return the text of a DESIGN.yaml: each size with as many digits as it needs, counts as numbers."""
        if self.digits is None:
            return yaml_text(self.to_spec())
        frame, sizes = self.frame, dict[str, Any]()
        for name, kind in frame.kinds.items():
            if kind in ("variable", "count"):
                si, unit = self.values[name], frame.units[name]
                short = kind == "variable" and self.digits
                text = written_quantity(si, unit, self.digits) if short else typed_quantity(si, unit, None)
                sizes[name] = _number_or_text(text)
        return yaml_text(self._spec(sizes))


def _number_or_text(text: str) -> int | float | str:
    """Return a number where a text is one as YAML writes it."""
    try:
        return int(text) if text.lstrip("-").isdigit() else float(text)
    except ValueError:
        return text


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
    """Cells under ``design_columns``; None where there is no value."""
    early, late = _order(frame)
    row: list[Any] = [cell_value(design.values[n], frame.units[n]) for n in early]
    row += [*design.choices.values(), *(str(part) for part in design.parts.values())]
    row += [cell_value(design.values[n], frame.units[n]) for n in late]
    return row + [design.utilisation.get(n) for n in frame.limit_units]


def cell_value(value: float, unit: str) -> float | None:
    """Return an SI value in the unit of its column; None where it does not exist."""
    return finite_from_si(value, unit, None)


def reached_limits(design: Design) -> list[str]:
    """Return the limits that a design reaches."""
    return [name for name, used in design.utilisation.items() if binds(used, design.frame.limit_senses[name])]


def lines_of(designs: Sequence[Design], every: bool = False) -> list[Design]:
    """Designs that have a line in lists: without those that are nearly the same as a better one, or ``every`` one."""
    return [design for design in designs if every or design.group is None]


def near_ones(leader: int | None, groups: Iterable[tuple[int | None, int | None]]) -> str:
    """Return how many designs are nearly the same as a leader, and which, by ranks and groups; empty where none is."""
    ranks = [f"#{rank}" for rank, group in groups if group is not None and group == leader]
    return f"and {len(ranks)} within {percent(LISTED.merge_within)}: {', '.join(ranks)}" if ranks else ""


def with_groups(
    columns: Sequence[str], rows: Sequence[list[Any]], designs: Sequence[Design]
) -> tuple[list[str], list[list[Any]]]:
    """Return a table of designs with the rank of the one that leads each, last, where any two are nearly the same."""
    if len(lines_of(designs)) == len(designs):
        return list(columns), list(rows)
    return [*columns, "group"], [[*row, d.group or d.rank] for row, d in zip(rows, designs, strict=True)]
