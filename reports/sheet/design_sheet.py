"""The calculation sheet of one design: what an engineer wants to check, in the order in which it is checked."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field

from synth.order.feasibility import binds, most_used
from synth.results import Design, ParetoFront
from synth.results.calculation import CalculatedDesign, Calculation, LimitRule, LimitVerdict, NamedQuantity
from synth.results.provenance import installed_versions
from synth.results.rating_tables import robust_sentence, yield_text
from synth.results.ratings import NOT_SHOWN
from synth.results.report_request import About
from synth.text.numbers import gap_text, used_share

from ..formula.layout import Amount, Letter, Word, textbook
from ..numbers import in_step, printed
from .blocks import (
    Block,
    Bullets,
    Cell,
    Code,
    Column,
    Document,
    Figure,
    Heading,
    Listing,
    Paragraph,
    State,
    Strong,
    TableBlock,
    TableRow,
    inline,
)
from .steps import Steps

LENGTHS = ("summary", "normal", "full")
DRAWN = "Design layout: computed sizes without tolerances. The scale holds on a sheet of the size in the title block."
DRAWN_ALT = "Dimensioned drawing of the design, with its parts list and what is not part of the model."
CONFIDENCE_NOTED = ("typical", "assumed")


@dataclass(frozen=True)
class SheetRequest:
    """What a sheet is made of.

    Parameters
    ----------
    calculation : Calculation
    design : Design
    front : ParetoFront, optional
        The front it stands on; a design that was only checked has none.
    about : About
    length : {"summary", "normal", "full"}
        ``summary`` leaves out the steps, ``full`` adds the list of symbols.
    drawing : str
        The drawing as SVG; nothing where there is none.
    """

    calculation: Calculation
    design: Design
    front: ParetoFront | None = None
    about: About = field(default_factory=About)
    length: str = "normal"
    drawing: str = field(default="", repr=False)


def design_sheet(request: SheetRequest) -> Document:
    """Return the calculation sheet of a design.

    Raises
    ------
    InputError
        A recorded value differs from what its formula gives.
    """
    return _Sheet(request).document()


def program_name(front: ParetoFront | None) -> str:
    """Program that computed a front, with its version."""
    versions = installed_versions() if front is None or front.record is None else front.record.get("versions", {})
    return f"clutchsynth {versions.get('clutchsynth', '')}".strip()


class _Sheet:
    def __init__(self, request: SheetRequest) -> None:
        self.request = request
        self.calculation, self.design, self.front = request.calculation, request.design, request.front
        self.outcome: CalculatedDesign = self.calculation.of_design(self.design)
        self.steps = Steps(self.calculation, self.outcome)

    def document(self) -> Document:
        frame = self.design.frame
        name = f"Design #{self.design.rank}" if self.design.rank else "Design"
        blocks: list[Block] = [state_of(self.design, self.front), *self._input(), *self._sizes(), *self._parts()]
        blocks += self._drawing()
        blocks += self._limits()
        steps = self.steps.all()
        if self.request.length != "summary":
            blocks.append(Heading("Calculation", anchor="calculation"))
            blocks.append(Paragraph("Each line carries its units; numbers are shown rounded.", small=True))
            blocks += steps
        blocks += self._remarks()
        if self.request.length == "full":
            blocks += self._symbols()
        blocks += [*self._sources(), *self._notes()]
        return Document(
            kind="Calculation sheet",
            title=f"{frame.title}: {name.lower() if self.design.rank else 'design that was checked'}",
            facts=self.request.about.facts(),
            blocks=tuple(blocks),
            program=program_name(self.front),
            logo=self.request.about.logo,
        )

    # -- what was given ------------------------------------------------------------------------

    def _of_kind(self, *kinds: str) -> list[NamedQuantity]:
        return [q for q in self.calculation.quantities.values() if q.kind in kinds]

    def _input(self) -> list[Block]:
        frame = self.design.frame
        typed = [q for q in self._of_kind("requirement") if q.name in frame.requirements]
        usual = [q for q in self._of_kind("requirement") if q.name not in frame.requirements]
        blocks: list[Block] = [Heading("Input", anchor="input")]
        lines = [self._input_row(q) for q in typed]
        blocks.append(TableBlock.of("Stated", INPUT_COLUMNS, lines) if lines else Paragraph("Nothing was stated."))
        options = [
            TableRow((Code(name), word, "stated" if name in frame.options else "default"))
            for name, word in self.calculation.options.items()
        ]
        if options:
            blocks.append(
                TableBlock.of(
                    "Options", (Column("option", width=2), Column("in force", width=2), Column("from")), options
                )
            )
        groups = _grouped(usual)
        defaults = tuple((label, tuple(self._input_row(q) for q in members)) for label, members in groups)
        if usual:
            blocks.append(TableBlock("Assumed: defaults of the family", INPUT_COLUMNS, defaults))
        if frame.not_asked:
            blocks.append(Paragraph(f"Not asked: {', '.join(frame.not_asked)}.", small=True))
        return blocks

    def _input_row(self, q: NamedQuantity) -> TableRow:
        follows: Cell = q.source
        if q.expression is not None:
            laid = self.steps.symbols.lay(textbook(q.expression))
            follows = inline(f"{q.source}; " if q.source else "", "follows: ", laid)
        return TableRow((q.text or q.name, Letter(q.symbol), Amount(in_step(self._value(q), q.unit)), follows))

    def _value(self, q: NamedQuantity) -> float:
        return self.outcome.values[q.name] if q.value is None else q.value

    def _sizes(self) -> list[Block]:
        rows = []
        for q in self._of_kind("variable", "count", "choice"):
            word = q.word(self._value(q))
            amount: Cell = Word(word) if word is not None else Amount(in_step(self._value(q), q.unit))
            remark = self.design.off_grid.get(q.name) or ""
            if q.name in self.design.outside:
                remark = f"outside of what is searched: {self.design.outside[q.name]}"
            rows.append(TableRow((q.text or q.name, Letter(q.symbol), amount, remark)))
        return [Heading("Sizes", anchor="sizes"), TableBlock.of("Sizes of this design", SIZE_COLUMNS, rows)]

    def _parts(self) -> list[Block]:
        groups = []
        for slot, row in self.design.parts.items():
            columns = [q for q in self._of_kind("part") if q.slot == slot]
            rows = []
            for q in columns:
                word, value = q.word(self._value(q)), self._value(q)
                shown: Cell = word or "another text" if q.is_text else Amount(in_step(value, q.unit))
                if math.isnan(value):
                    shown = "no value"
                rows.append(TableRow((q.text or q.name, Letter(q.symbol), shown)))
            confidence = str(row.get("confidence") or "")
            source = "; ".join(str(x) for x in (row.get("source"), confidence and f"confidence: {confidence}") if x)
            label = f"{slot}: {row} ({row['table']}" + (f"; {source})" if source else ")")
            groups.append((label, tuple(rows)))
        fixed = self._of_kind("row")
        for slot in dict.fromkeys(q.slot for q in fixed):
            rows = [
                TableRow((q.text or q.name, Letter(q.symbol), Amount(in_step(self._value(q), q.unit))))
                for q in fixed
                if q.slot == slot
            ]
            table, _, designation = slot.partition(":")
            groups.append((f"{designation} ({table}; fixed by an option)", tuple(rows)))
        blocks: list[Block] = [TableBlock("What tables say", PART_COLUMNS, tuple(groups))] if groups else []
        following = next_in_tables(self.design)
        blocks += [Bullets(tuple(following))] if following else []
        return [Heading("Parts", anchor="parts"), *blocks] if blocks else []

    def _drawing(self) -> list[Block]:
        """Return the drawing, to the scale that its title block tells on a sheet of the size told there."""
        if not self.request.drawing:
            return []
        return [Heading("Drawing", anchor="drawing"), Figure(self.request.drawing, DRAWN_ALT, DRAWN)]

    # -- limits --------------------------------------------------------------------------------

    def _limits(self) -> list[Block]:
        ranked = _ranked(self.calculation.limits, self.outcome.verdicts)
        rows = [self._limit_row(x, self.outcome.verdicts[x.name]) for x in ranked]
        blocks: list[Block] = [Heading("Limits", anchor="limits"), Paragraph(self._governing(ranked))]
        blocks.append(TableBlock.of("Limits, the most used first", LIMIT_COLUMNS, rows))
        return blocks + self._over_a_range()

    def _governing(self, ranked: Sequence[LimitRule]) -> str:
        broken = [x.name for x in ranked if not self.outcome.verdicts[x.name].holds]
        if broken:
            return f"Violated: {', '.join(broken)}."
        tight = [x.name for x in ranked if binds(self.outcome.verdicts[x.name].used, x.sense)]
        reach = f"The design is at the limit of {', '.join(tight)}." if tight else "No limit is reached."
        worst = self.design.robust.worst_limit if self.design.robust else ""
        return f"At the nominal point: {reach} Over the range that scatters the worst is {worst}." if worst else reach

    def _limit_row(self, x: LimitRule, verdict: LimitVerdict) -> TableRow:
        condition = self.steps.limit_condition(x.value, x.limit, x.sense)
        name = inline(x.text or x.name, " ", Code(x.name))
        if verdict.void:
            lacking = [name for name in x.optional if math.isnan(self.outcome.values[name])]
            return TableRow((name, condition, "", "", f"not checked: no {', '.join(lacking)}"))
        if verdict.failed:
            failure = f"not checked: {', '.join(verdict.failed)} fails"
            return TableRow((name, condition, "", "", failure))
        numbers = self.steps.limit_numbers(verdict, x.sense, x.unit)
        used = "" if verdict.used is None else used_share(verdict.used)
        words: Cell = "holds" if verdict.holds else Strong("VIOLATED")
        if x.source and "unsourced" in x.source:
            words = inline(words, " (rule of practice)")
        mark = "bad" if not verdict.holds else "tight" if binds(verdict.used, x.sense) else ""
        return TableRow((name, condition, numbers, used, words), mark=mark, used=verdict.used)

    def _over_a_range(self) -> list[Block]:
        """Robustness of limits: each at its worst point."""
        rating = self.design.robust
        if not rating or not rating.limits:
            return self._at_corners()
        units = rating.units or {}
        rows = []
        for name, rated in rating.limits.items():
            unit = self.design.frame.limit_units.get(name, "-")
            sides = " / ".join(
                "–" if side is None or not isinstance(side, float) else printed(in_step(side, unit))
                for side in (rated.value, rated.limit)
            )
            at = rated.at if isinstance(rated.at, Mapping) else {}
            place = ", ".join(f"{key} {printed(in_step(value, units.get(key, '-')))}" for key, value in at.items())
            used = used_share(rated.utilisation) if isinstance(rated.utilisation, float) else ""
            words: Cell = "holds" if rated.holds else Strong("VIOLATED") if rated.holds is False else NOT_SHOWN
            mark = "bad" if rated.holds is False else ""
            rows.append(TableRow((Code(name), place, sides, used, words, str(rated.proof or "")), mark=mark))
        return [
            Heading("Limits over the range that scatters", level=2, anchor="range"),
            TableBlock.of("Each limit at its worst point", RANGE_COLUMNS, rows),
        ]

    def _at_corners(self) -> list[Block]:
        """Return the limits that were posed because something scatters, of a design that was not rated."""
        declared = {x.name for x in self.calculation.limits}
        rows = []
        for name in (n for n in self.design.limits if n not in declared):
            value, limit = self.design.limits[name]
            used, unit = self.design.utilisation.get(name), self.design.frame.limit_units.get(name, "-")
            bad = name in self.design.violated
            words: Cell = Strong("VIOLATED") if bad else "not checked" if used is None else "holds"
            sides = f"{printed(in_step(value, unit))} / {printed(in_step(limit, unit))}"
            rows.append(
                TableRow((Code(name), sides, "" if used is None else used_share(used), words), "bad" if bad else "")
            )
        if not rows:
            return []
        heading = Heading("Limits at the corners of the range that scatters", level=2, anchor="range")
        return [heading, TableBlock.of("Posed beside the limits above", CORNER_COLUMNS, rows)]

    # -- words ---------------------------------------------------------------------------------

    def _remarks(self) -> list[Block]:
        notes: list[Cell] = [*self.design.advice, *self.design.not_checked]
        if self.design.note:
            notes.append(f"On the front: {self.design.note}.")
        if self.design.alternatives:
            notes.append(f"The same objectives with: {'; '.join(self.design.alternatives)}.")
        for slot, row in self.design.parts.items():
            if str(row.get("confidence")) in CONFIDENCE_NOTED:
                notes.append(f"{slot} {row}: figures of this row are {row['confidence']}; confirm them with the maker.")
        if not notes:
            return []
        return [Heading("Remarks", anchor="remarks"), Bullets(tuple(notes))]

    def _symbols(self) -> list[Block]:
        rows = [
            TableRow((Letter(q.symbol), Code(q.name), q.text, "" if q.unit in ("-", "") else q.unit))
            for q in sorted(self.calculation.quantities.values(), key=lambda q: (q.symbol.casefold(), q.symbol))
        ]
        return [Heading("Symbols", anchor="symbols"), TableBlock.of("Symbols and public names", SYMBOL_COLUMNS, rows)]

    def _sources(self) -> list[Block]:
        listed: dict[str, None] = dict.fromkeys(self.calculation.sources)
        blocks: list[Block] = [Heading("Sources", anchor="sources"), Bullets(tuple(listed))]
        return blocks

    def _notes(self) -> list[Block]:
        notes: list[Cell] = [
            "Numbers are shown to five digits, more where a difference needs them; the calculation carries sixteen. "
            "A pocket calculator may differ in the last digit shown.",
            "A limit holds within a millionth of its size; sides that differ by less are shown alike.",
            "Formulas are read back from the graph that was solved: the sheet cannot say anything else than the model.",
        ]
        if self.steps.negligible:
            notes.append(
                "Numbers of 1e-9 and less that only keep a sum away from zero are left out of the lines shown; "
                "the files for programs have them."
            )
        if self.steps.in_si and self.request.length != "summary":
            symbols = list(dict.fromkeys(self.steps.in_si))
            line: list[Cell] = ["In SI alone: "]
            for k, symbol in enumerate(symbols):
                line += [", ", Letter(symbol)] if k else [Letter(symbol)]
            notes.append(inline(*line))
        digests: list[Cell] = [inline("Checksum of the calculation: ", Code(self.calculation.digest))]
        if self.front is not None:
            digests.append(inline("Checksum of the result: ", Code(self.front.result_digest)))
        return [
            Heading("Notes", anchor="notes"),
            Bullets((*notes, *digests)),
            Paragraph("The design, as clutchsynth check reads it:"),
            Listing(self.design.yaml()),
        ]


def next_in_tables(design: Design) -> list[Cell]:
    """Return the rows of tables that come next to sizes which no table decides: a shaft end and its key."""
    return [f"Next in the tables: {name.replace('_', ' ')} {row}" for name, row in design.next_rows.items()]


def _ranked(limits: Sequence[LimitRule], verdicts: Mapping[str, LimitVerdict]) -> list[LimitRule]:
    """Return limits, those that fail first, of each kind the most used first; last what is not checked."""
    used = {x.name: verdicts[x.name].used for x in limits}
    failing = {name: math.inf if x is None else x for name, x in used.items() if not verdicts[name].holds}
    names = [*most_used(failing), *most_used({name: x for name, x in used.items() if name not in failing})]
    place = {name: k for k, name in enumerate(names)}
    return sorted(limits, key=lambda x: place.get(x.name, len(place)))


def _grouped(quantities: Iterable[NamedQuantity]) -> list[tuple[str, list[NamedQuantity]]]:
    groups: dict[str, list[NamedQuantity]] = {}
    for q in quantities:
        groups.setdefault(q.group, []).append(q)
    return list(groups.items())


def state_of(design: Design, front: ParetoFront | None) -> State:
    """Notes that belong at the head of a design."""
    details: list[str] = []
    if design.robust:
        details.append(over_range_in_words(design))
    if design.violated:
        count = len(design.violated)
        head = f"NOT FEASIBLE: {count} limit{'s' if count > 1 else ''} violated"
        return State("bad", head, (f"Violated: {', '.join(design.violated)}.", *details))
    if front is None:
        return State(
            "good", "Feasible: all limits that apply hold", ("One design was checked; none was searched.", *details)
        )
    return State(*front_state(front, feasible="Feasible"), details=tuple([*front_details(front), *details]))


def front_state(front: ParetoFront, feasible: str = "") -> tuple[str, str]:
    """Return the level and the head line of the state of a front."""
    before = f"{feasible}; " if feasible else ""
    if not front.designs:
        proven = front.certificate.kind == "global"
        return "bad", "NOT FEASIBLE, proven: nothing meets the task" if proven else "NO DESIGN FOUND, not proven"
    if front.interrupted:
        return "open", f"{before}the search was stopped: NOT PROVEN to the end"
    if front.certificate.kind == "global":
        gap = gap_text(front.certificate.gap or 0)
        what = "the front is proven" if before else "Proven"
        return "good", f"{before}{what} to {gap} over all combinations"
    if front.certificate.kind == "exhaustive":
        return "open", f"{before}every combination was solved, bounds are not closed"
    return "open", f"{before}NOT PROVEN: better designs may exist"


def front_details(front: ParetoFront) -> list[str]:
    """Return the certificate in words, why a search was stopped, and how the designs stand what scatters."""
    sentences = [as_sentence(front.certificate.sentence())]
    if front.interrupted:
        sentences.append(f"Stopped: {front.interrupted}.")
    if any(d.robust for d in front.designs):
        sentences.append(as_sentence(robust_sentence(front.designs)))
    return sentences


def as_sentence(text: str) -> str:
    """Return a text with a capital and a full stop."""
    return text[:1].upper() + text[1:] + ("" if text.endswith(".") else ".")


def over_range_in_words(design: Design) -> str:
    """Robustness of a design."""
    rating = design.robust
    holds = "holds (proven)" if rating.holds else "DOES NOT HOLD" if rating.holds is False else "is NOT SHOWN to hold"
    sentence = f"Over the range that scatters it {holds}"
    if isinstance(rating.share_good, float) and not rating.holds:
        ends = [yield_text(x) for x in (rating.yield_low, rating.yield_high) if isinstance(x, float)]
        sentence += f"; yield {yield_text(rating.share_good)} ({' to '.join(ends)}, from {rating.samples} samples)"
    if rating.worst_limit:
        sentence += f"; the worst limit is {rating.worst_limit}"
    return sentence + "."


INPUT_COLUMNS = (
    Column("meaning", width=3.2),
    Column("symbol"),
    Column("value", number=True, width=1.3),
    Column("source", width=2.5),
)
SIZE_COLUMNS = (
    Column("meaning", width=3.2),
    Column("symbol"),
    Column("value", number=True, width=1.3),
    Column("", width=2.5),
)
PART_COLUMNS = (Column("meaning", width=4), Column("symbol"), Column("value", number=True, width=1.5))
LIMIT_COLUMNS = (
    Column("limit", width=2.6),
    Column("condition", width=2.6),
    Column("in numbers", width=2.1),
    Column("used", number=True, width=0.8),
    Column("verdict", width=1.1),
)
RANGE_COLUMNS = (
    Column("limit", width=1.5),
    Column("worst point", width=2.4),
    Column("value / limit there", width=1.6),
    Column("used", number=True, width=0.7),
    Column("verdict", width=0.9),
    Column("proof", width=0.8),
)
CORNER_COLUMNS = (
    Column("limit", width=3),
    Column("value / limit", width=2),
    Column("used", number=True, width=0.7),
    Column("verdict", width=0.9),
)
SYMBOL_COLUMNS = (Column("symbol"), Column("name", width=2), Column("meaning", width=4), Column("unit"))
