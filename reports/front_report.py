"""The report of a front: task, proof, ranked designs and the chosen ones in full, as neutral blocks."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

from synth.order.feasibility import binds, most_used
from synth.results import Design, ParetoFront, foremost
from synth.results.calculation import Calculation, NamedQuantity
from synth.results.design import near_ones
from synth.results.plain import finite
from synth.results.report_request import About
from synth.text.numbers import DIGITS, FULL_DIGITS, MINUS, gap_text, page_text, signed, used_share
from synth.units import miss_text, unit_text

from .formula.layout import Amount, Letter
from .front_plot import front_in_words, front_svg
from .numbers import in_its_unit, printed
from .reasons import SIGN_OF, why
from .sheet.blocks import (
    Block,
    Bullets,
    Cell,
    Code,
    Column,
    Document,
    Figure,
    Heading,
    Link,
    Listing,
    Paragraph,
    State,
    Strong,
    TableBlock,
    TableRow,
    inline,
)
from .sheet.design_sheet import (
    DRAWN,
    DRAWN_ALT,
    front_details,
    front_state,
    next_in_tables,
    over_range_in_words,
    program_name,
)

SCORE, OVER_RANGE = "score", "over the range"
PAGE = 86.0  # letters beside each other in a table
LISTED_ROWS = 40  # rows that are listed one by one
NEAR = 20  # near-equal designs that are listed
ELASTICITIES = 8  # of a design, the largest first
NOT_COVERED = (
    "The certificate speaks of the model and its tables, in floating-point arithmetic: not of physics that the model "
    "leaves out, and not of figures of tables that are marked typical."
)


@dataclass(frozen=True)
class FrontReportRequest:
    """What a report of a front is made of.

    Parameters
    ----------
    front : ParetoFront
    calculation : Calculation
    about : About
    full : int
        How many designs are told in full: rank 1, the knee, the best of each objective, then by rank.
    sheets : mapping
        Rank -> file of its calculation sheet, where there is one.
    prices : list of mapping
        Rows of prices.json, if it is there.
    near_equals : list of mapping
        ``rank`` of a design, ``sentence`` and ``rows`` of what comes near it.
    curves : list of str
        Files of curves and simulations in the folder.
    explorer : str
        File of the explorer beside the report, if there is one.
    drawings : mapping
        Rank -> drawing as SVG, of designs that have one.
    """

    front: ParetoFront
    calculation: Calculation
    about: About = field(default_factory=About)
    full: int = 5
    sheets: Mapping[int, str] = field(default_factory=dict)
    prices: Sequence[Mapping[str, Any]] = ()
    near_equals: Sequence[Mapping[str, Any]] = ()
    curves: Sequence[str] = ()
    explorer: str = ""
    drawings: Mapping[int, str] = field(default_factory=dict)


def front_report(request: FrontReportRequest) -> Document:
    """Return the report of a front."""
    return _Report(request).document()


def first_design(request: FrontReportRequest) -> list[Block]:
    """Blocks on the designs of a front, the first in full, and on the task."""
    report = _Report(replace(request, full=1))
    several = report.ranked() if len(request.front.designs) > 1 else []
    return [*several, *(block for design in report.full for block in report.design(design)), *report.task()]


class _Report:
    def __init__(self, request: FrontReportRequest) -> None:
        self.request, self.front, self.calculation = request, request.front, request.calculation
        self.frame = request.front.frame
        self.quantities = request.calculation.quantities
        self.full = foremost(self.front, request.full)
        # What is told in full, or has a sheet of its own, has a line to be found by.
        named = {*(d.rank for d in self.full), *request.sheets}
        self.lines = [d for d in self.front.designs if d.group is None or d.rank in named]

    def document(self) -> Document:
        level, head = front_state(self.front)
        blocks: list[Block] = [State(level, head, tuple(front_details(self.front)))]
        if not self.front.designs:
            blocks += self._nothing()
        blocks += self.ranked() if self.front.designs else []
        for design in self.full:
            blocks += self.design(design)
        blocks += [*self._runners_up(), *self.task(), *self._search(), *self._excluded(), *self._certificate()]
        blocks += [*self._files(), *self._again()]
        return Document(
            kind="Design report",
            title=self.request.about.title or f"{self.frame.title}: {self._counted()}",
            facts=self.request.about.facts(),
            blocks=tuple(blocks),
            program=program_name(self.front),
            logo=self.request.about.logo,
            data=self._data(),
        )

    def _data(self) -> str:
        """Return the table of all designs, in five digits, where not all are told in full."""
        if len(self.full) == len(self.front.designs):
            return ""
        columns, rows = self.front.table()
        short = [[_short(x) for x in row] for row in rows]
        return json.dumps({"columns": columns, "rows": short}, separators=(",", ":"), ensure_ascii=False)

    def _counted(self) -> str:
        count = len(self.front.designs)
        return "no design" if not count else "one design" if count == 1 else f"{count} designs"

    # -- what was found ------------------------------------------------------------------------

    def _nothing(self) -> list[Block]:
        explanation = self.front.explanation
        if not explanation:
            return []
        blocks: list[Block] = [Heading("Why", anchor="why"), Paragraph(explanation.headline)]
        rows = []
        for miss in explanation.conflicts or ():
            unit = str(miss.unit or "-")
            sides = [
                Amount(in_its_unit(float(side), unit, FULL_DIGITS)) if isinstance(side, float) else ""
                for side in (miss.value, miss.limit_value)
            ]
            missed = ""
            if isinstance(miss.value, float) and isinstance(miss.limit_value, float):
                missed = miss_text(miss.value, miss.limit_value, unit)
            rows.append(TableRow((Code(str(miss.limit)), *sides, missed), mark="bad"))
        if rows:
            blocks.append(TableBlock.of("Limits that the nearest design misses", MISSED_COLUMNS, rows))
        nearest = {**(explanation.nearest or {}), **(explanation.parts or {})}
        if nearest:
            blocks.append(Paragraph("The nearest design: " + ", ".join(f"{k} {v}" for k, v in nearest.items()) + "."))
        blocks.append(
            Paragraph(
                inline(
                    "What would help, and which limits exclude each other, tells ",
                    Code("clutchsynth explain SPEC.yaml"),
                    ".",
                )
            )
        )
        return blocks

    def ranked(self) -> list[Block]:
        svg = front_svg(self.front, [d.rank or 0 for d in self.full])
        blocks: list[Block] = [Heading("The designs", anchor="designs")]
        if svg:
            blocks.append(Figure(svg, f"The front. {front_in_words(self.front)}", _plot_caption(self.front)))
        if self.request.explorer:
            link = Link(self.request.explorer, self.request.explorer)
            blocks.append(Paragraph(inline("To filter, to compare and to see any design: ", link, ".")))
        for number, names in enumerate(self._column_groups()):
            columns = (Column("rank", number=True, width=4), *(self._column(name) for name in names))
            caption = "All designs of the front, the best rank first" + (" (continued)" if number else "")
            rows = [self._ranked_row(design, names, number == 0) for design in self.lines]
            blocks.append(TableBlock.of(caption, columns, rows))
        groups = [(d.rank, d.group) for d in self.front.designs]
        near = tuple(f"#{d.rank}: {others}" for d in self.lines if (others := near_ones(d.rank, groups)))
        return [*blocks, Bullets(near)] if near else blocks

    def _column_groups(self) -> list[list[str]]:
        """Return the columns of the ranked table in groups that a page holds beside each other."""
        first, kinds = self.front.designs[0], self.frame.kinds
        sizes = [n for n, kind in kinds.items() if kind in ("variable", "count") and n not in self.frame.objectives]
        rated = [OVER_RANGE] if any(d.robust for d in self.front.designs) else []
        names = [SCORE, *rated, *self.frame.objectives, *sizes, *first.choices, *first.parts]
        groups: list[list[str]] = [[]]
        remaining = PAGE
        for name in names:
            needed = self._column(name).width + 2
            if needed > remaining and groups[-1]:
                groups.append([])
                remaining = PAGE
            groups[-1].append(name)
            remaining -= needed
        return groups

    def _column(self, name: str) -> Column:
        """Return a column as wide as its longest word."""
        number = name in self.frame.units or name == SCORE
        unit = unit_text(self.frame.units.get(name, "-"))
        title = name.replace("_", " ") + (f" [{unit}]" if unit else "")
        words = [*title.split(), *(str(self._ranked_cell(design, name)) for design in self.lines)]
        return Column(title, number=number, width=float(max(map(len, words))))

    def _ranked_row(self, design: Design, names: Sequence[str], anchored: bool) -> TableRow:
        rank: Cell = Link(f"#{design.rank}", f"#full-{design.rank}") if design in self.full else f"#{design.rank}"
        cells = (rank, *(self._ranked_cell(design, name) for name in names))
        return TableRow(cells, anchor=f"design-{design.rank}" if anchored else "")

    def _ranked_cell(self, design: Design, name: str) -> str:
        if name == SCORE:
            return page_text(design.score)
        if name == OVER_RANGE:
            return str(design.robust.verdict or "not rated")
        if name in design.parts:
            return str(design.parts[name])
        if name in design.choices:
            return design.choices[name]
        return printed(
            in_its_unit(design.values[name], "-" if name not in self.frame.units else self.frame.units[name]).bare()
        )

    # -- one design ----------------------------------------------------------------------------

    def design(self, design: Design) -> list[Block]:
        rank = design.rank or 0
        blocks: list[Block] = [Heading(f"Design #{rank}", anchor=f"full-{rank}")]
        reason = why(self.front, design)
        blocks.append(Paragraph(reason[:1].upper() + reason[1:] + "."))
        if design.robust:
            blocks.append(Paragraph(over_range_in_words(design)))
        if rank in self.request.sheets:
            blocks.append(
                Paragraph(inline("Calculation sheet: ", Link(self.request.sheets[rank], self.request.sheets[rank])))
            )
        if rank in self.request.drawings:
            blocks.append(Figure(self.request.drawings[rank], f"Design #{rank}. {DRAWN_ALT}", DRAWN))
        blocks.append(Bullets((*self._choices(design), *self._parts(design), *next_in_tables(design))))
        blocks.append(TableBlock("Sizes and results", VALUE_COLUMNS, self._values(design)))
        blocks.append(TableBlock.of("Limits, the most used first", USED_COLUMNS, self._limits(design)))
        blocks += self._prices(design)
        remarks = [*design.advice, *design.not_checked]
        if remarks:
            blocks += [Heading(f"Remarks on #{rank}", level=2), Bullets(tuple(remarks))]
        return blocks

    def _choices(self, design: Design) -> list[Cell]:
        return [f"{self._meaning(name)}: {word}" for name, word in design.choices.items()]

    def _parts(self, design: Design) -> list[Cell]:
        """Rows that fill the slots, with table, source and confidence."""
        parts: list[Cell] = []
        for slot, row in design.parts.items():
            confidence = f"confidence: {row['confidence']}" if row.get("confidence") else ""
            source = "; ".join(str(x) for x in (f"table {row['table']}", row.get("source"), confidence) if x)
            parts.append(inline(f"{slot.replace('_', ' ')}: ", Code(str(row)), f" ({source})"))
        return parts

    def _values(self, design: Design) -> tuple[tuple[str, tuple[TableRow, ...]], ...]:
        groups: list[tuple[str, tuple[TableRow, ...]]] = []
        for label, kinds in (("Sizes and counts", ("variable", "count")), ("Results", ("derived",))):
            names = [n for n, kind in self.frame.kinds.items() if kind in kinds]
            groups.append((label, tuple(self._value_row(design, name) for name in names)))
        return tuple((label, rows) for label, rows in groups if rows)

    def _meaning(self, name: str) -> str:
        q = self.quantities.get(name)
        return q.text if q is not None and q.text else name

    def _symbol(self, name: str) -> Cell:
        q = self.quantities.get(name)
        return Letter(q.symbol) if q is not None else ""

    def _value_row(self, design: Design, name: str) -> TableRow:
        remark = design.off_grid.get(name, "")
        return TableRow(
            (
                self._meaning(name),
                self._symbol(name),
                Amount(in_its_unit(design.values[name], self.frame.units[name])),
                remark or Code(name),
            )
        )

    def _limits(self, design: Design) -> list[TableRow]:
        texts = {x.name: x.text for x in self.calculation.limits}

        known = most_used(design.utilisation)
        ranked = [*known, *(name for name in design.limits if name not in known)]
        rows = []
        for name in sorted(ranked, key=lambda name: name not in design.violated):
            value, limit = design.limits[name]
            used, unit = design.utilisation.get(name), self.frame.limit_units.get(name, "-")
            bad, tight = (name in design.violated, binds(used, self.frame.limit_senses[name]))
            verdict: Cell = Strong("VIOLATED") if bad else "holds" if used is not None else "not checked"
            digits = FULL_DIGITS if bad else DIGITS
            sides: list[Cell] = (
                ["", ""] if used is None else [Amount(in_its_unit(x, unit, digits)) for x in (value, limit)]
            )
            rows.append(
                TableRow(
                    (
                        inline(texts.get(name) or name, " ", Code(name)),
                        sides[0],
                        SIGN_OF[self.frame.limit_senses[name]],
                        sides[1],
                        "" if used is None else used_share(used),
                        verdict,
                    ),
                    mark="bad" if bad else "tight" if tight else "",
                    used=used,
                )
            )
        return rows

    def _prices(self, design: Design) -> list[Block]:
        of_design = [row for row in self.request.prices if row.get("design") == design.rank]
        if of_design:
            sentences = [str(row["sentence"]) for row in of_design if row.get("status") != "no influence"]
            return [Heading(f"Prices at #{design.rank}", level=2), Bullets(tuple(sentences[:12]))] if sentences else []
        steepest = sorted(
            (
                (abs(slope), objective, name, slope)
                for objective, slopes in design.elasticity.items()
                for name, slope in slopes.items()
                if slope and abs(slope) > 1e-3
            ),
            key=lambda entry: (-entry[0], entry[1], entry[2]),
        )
        if not steepest:
            return []
        rows = [
            TableRow((Code(name), Code(objective), f"{_signed(slope)} %"))
            for _, objective, name, slope in steepest[:ELASTICITIES]
        ]
        return [
            Heading(f"What 1 % more changes at #{design.rank}", level=2),
            TableBlock.of(
                "Elasticities: parts kept, sizes taken as continuous, good for a few per cent", PRICE_COLUMNS, rows
            ),
        ]

    def _runners_up(self) -> list[Block]:
        same: list[Cell] = [
            f"#{d.rank}: the same objectives with {'; '.join(d.alternatives)}" for d in self.full if d.alternatives
        ]
        blocks: list[Block] = []
        if same:
            blocks.append(Bullets(tuple(same)))
        for near in self.request.near_equals:
            rows = [_near_row(row) for row in near["rows"][:NEAR]]
            blocks.append(Paragraph(f"Near #{near['rank']}: {near['sentence']}."))
            if rows:
                blocks.append(
                    TableBlock.of(f"Designs of other parts that come near #{near['rank']}", NEAR_COLUMNS, rows)
                )
        if not blocks and not self.front.designs:
            return []
        hint = inline(
            "A design that is not listed is beaten: some design here is at least as good in every objective and better "
            "in one, up to the gap. Which other parts come near, and by how much they lose, tells ",
            Code("clutchsynth near-equals DIR --design 1"),
            ".",
        )
        return [Heading("Runners-up", anchor="runners-up"), *blocks, Paragraph(hint)]

    # -- what was asked ------------------------------------------------------------------------

    def _of_kind(self, *kinds: str) -> list[NamedQuantity]:
        return [q for q in self.quantities.values() if q.kind in kinds]

    def task(self) -> list[Block]:
        values = self.frame.requirement_values
        typed = [q for q in self._of_kind("requirement") if q.name in self.frame.requirements]
        usual = [q for q in self._of_kind("requirement") if q.name not in self.frame.requirements]

        def rows(quantities: Sequence[NamedQuantity]) -> tuple[TableRow, ...]:
            return tuple(
                TableRow(
                    (q.text or q.name, Letter(q.symbol), Amount(in_its_unit(values[q.name], q.unit)), Code(q.name))
                )
                for q in quantities
                if q.name in values
            )

        options = tuple(
            TableRow((name, "", word, "stated" if name in self.frame.options else "default"))
            for name, word in self.calculation.options.items()
        )
        sections = (("Stated", rows(typed)), ("Options", options), ("Assumed: defaults of the family", rows(usual)))
        groups = tuple(group for group in sections if group[1])
        blocks: list[Block] = [Heading("The task", anchor="task")]
        blocks.append(TableBlock("Requirements", VALUE_COLUMNS, groups) if groups else Paragraph("No requirements."))
        if self.frame.not_asked:
            blocks.append(Paragraph(f"Not asked: {', '.join(self.frame.not_asked)}.", small=True))
        return blocks

    def _search(self) -> list[Block]:
        settings = self.front.settings
        lines: list[Cell] = [
            "Objectives: "
            + ", ".join(
                f"{name} ({'small' if sense == 'min' else 'large'})" for name, sense in self.frame.objectives.items()
            )
        ]
        for key, words in (
            ("parts", "Parts held to"),
            ("limits", "Own limits"),
            ("fix", "Fixed"),
            ("robust", "Scatters"),
        ):
            if settings.get(key):
                lines.append(f"{words}: {_in_words(settings[key])}")
        gap, sizes = gap_text(float(settings.get("gap") or 0)), "makeable" if settings.get("grid") else "continuous"
        lines.append(f"At most {settings.get('points')} designs, gap {gap}, {sizes} sizes, seed {settings.get('seed')}")
        weights = settings.get("weights")
        if weights:
            lines.append(f"Weights of the ranking: {_in_words(weights)}")
        return [Heading("What was asked of the search", anchor="search"), Bullets(tuple(lines))]

    def _excluded(self) -> list[Block]:
        statistics = self.front.statistics
        rows = list(statistics.get("rows_left_out") or ())
        others = list(statistics.get("combinations_left_out") or ())
        if not rows and not others:
            return []
        table = [
            TableRow(tuple(str(row.get(key, "")) for key in ("slot", "designation", "reason")))
            for row in rows[:LISTED_ROWS]
        ]
        blocks: list[Block] = [Heading("Rows left out, and why", anchor="left-out")]
        if table:
            blocks.append(TableBlock.of("Rows of tables that were not searched", OUT_COLUMNS, table))
        if len(rows) > LISTED_ROWS:
            blocks.append(Paragraph(f"{len(rows) - LISTED_ROWS} more are named in front.json."))
        return blocks + ([Bullets(tuple(map(str, others)))] if others else [])

    def _certificate(self) -> list[Block]:
        c, statistics = self.front.certificate, self.front.statistics
        lines: list[Cell] = [*front_details(self.front), NOT_COVERED]
        numbers = [f"{c.combinations:,} combinations of parts and counts".replace(",", " ")]
        numbers += [
            f"{c.excluded_by_bound:,} excluded by bounds".replace(",", " "),
            f"{c.solved:,} solved".replace(",", " "),
        ]
        if statistics.get("boxes"):
            numbers.append(f"{statistics['boxes']:,} boxes".replace(",", " "))
        lines.append("; ".join(numbers) + ".")
        lines.append(inline("It can be checked by other code: ", Code("clutchsynth verify DIR"), "."))
        return [Heading("The certificate", anchor="certificate"), Bullets(tuple(lines))]

    def _files(self) -> list[Block]:
        if not self.request.curves:
            return []
        return [
            Heading("Curves in the folder", anchor="curves"),
            Bullets(tuple(Link(name, name) for name in self.request.curves)),
        ]

    def _again(self) -> list[Block]:
        record = self.front.record or {}
        versions = record.get("versions", {})
        lines: list[Cell] = [inline("Checksum of the result: ", Code(self.front.result_digest))]
        lines.append(inline("Checksum of the calculation: ", Code(self.calculation.digest)))
        if versions:
            lines.append("Computed with " + ", ".join(f"{name} {version}" for name, version in versions.items()))
        digests = sorted(
            {f"{row['table']}: {row} {str(row['hash'])[:12]}" for d in self.front.designs for row in d.parts.values()}
        )
        if digests:
            lines.append("Rows of tables used, with the first digits of their hashes: " + "; ".join(digests[:60]))
        sources: list[Cell] = list(self.calculation.sources)
        return [
            Heading("Sources of the model", anchor="sources"),
            Bullets(tuple(sources)),
            Heading("To reproduce", anchor="again"),
            Bullets(tuple(lines)),
            Paragraph(inline("The question, as ", Code("clutchsynth run"), " reads it:")),
            Listing(_spec_text(self.front)),
        ]


def _plot_caption(front: ParetoFront) -> str:
    words = "Each point is a design and leads to its row; filled points are told in full below"
    if any("knee" in d.note for d in front.designs):
        words += ", the ringed one is the knee"
    if len(front.frame.objectives) == 2:
        words += "; beyond the dashed line nothing was found or, where it is proven, nothing exists"
    return words + "."


def _signed(change: float) -> str:
    return signed(change, 2).replace("-", MINUS)


def _short(x: Any) -> Any:
    """Cell of a table as JSON knows it, numbers in seven digits."""
    return float(f"{x:.7g}") if isinstance(x, float) and math.isfinite(x) else finite(x)


def _near_row(row: Mapping[str, str]) -> TableRow:
    """Return a row of near_equals.csv: in what it differs, and by how much it is worse."""
    changes = [
        f"{key.removeprefix('change: ').removesuffix(' [%]')} {_signed(float(value))} %"
        for key, value in row.items()
        if key.startswith("change: ") and value
    ]
    return TableRow((row.get("number", ""), row.get("differences", ""), ", ".join(changes)))


def _in_words(value: Any) -> str:
    if isinstance(value, Mapping):
        return ", ".join(f"{key} {_in_words(inner)}" for key, inner in value.items())
    if isinstance(value, (list, tuple)):
        return " and ".join(map(_in_words, value))
    return page_text(value, FULL_DIGITS) if isinstance(value, float) else str(value)


def _spec_text(front: ParetoFront) -> str:
    """Return the question of a front as a spec; what is JSON is YAML as well."""
    frame, settings = front.frame, front.settings
    spec: dict[str, Any] = {"family": frame.family}
    if frame.options:
        spec["options"] = dict(frame.options)
    spec["requirements"] = dict(frame.requirements)
    for key in ("parts", "limits", "fix", "robust"):
        if settings.get(key):
            spec[key] = settings[key]
    if frame.restated.get("catalogs"):
        spec["catalogs"] = frame.restated["catalogs"]
    spec["objectives"] = {name: sense for name, sense in frame.objectives.items()}
    for key in ("points", "gap", "grid", "seed"):
        if settings.get(key) is not None:
            spec[key] = settings[key]
    lines = []
    for key, value in spec.items():
        lines.append(f"{key}: {json.dumps(value, ensure_ascii=False) if not isinstance(value, str) else value}")
    return "\n".join(lines) + "\n"


VALUE_COLUMNS = (
    Column("meaning", width=3.4),
    Column("symbol", width=0.8),
    Column("value", number=True, width=1.3),
    Column("", width=2.0),
)
USED_COLUMNS = (
    Column("limit", width=4.0),
    Column("value", number=True, width=1.3),
    Column("", width=0.3),
    Column("limit value", number=True, width=1.3),
    Column("used", number=True, width=0.9),
    Column("verdict", width=1.0),
)
MISSED_COLUMNS = (
    Column("limit", width=2),
    Column("value", number=True),
    Column("limit value", number=True),
    Column("missed by", number=True),
)
PRICE_COLUMNS = (
    Column("requirement or limit", width=2),
    Column("objective", width=1.5),
    Column("changes by", number=True),
)
NEAR_COLUMNS = (Column("design"), Column("other", width=3), Column("worse by", width=2))
OUT_COLUMNS = (Column("slot"), Column("row", width=1.5), Column("reason", width=3))
