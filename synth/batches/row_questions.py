"""From a table to questions: what each row asks, checked before anything runs; every fault with line and column."""

from __future__ import annotations

import difflib
import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from synth.batches.cells import READERS
from synth.batches.entries import RowQuestion
from synth.batches.row_table import RowTable
from synth.batches.vocabulary import FAMILY, FIX, LIMITS, OPTIONS, PARTS, STRUCTURE, Universe, Word, words_of
from synth.batches.warm_starts import place
from synth.errors import InputError, UnknownOptionError, shortened
from synth.model.problem import DesignProblem
from synth.model.registry import families, load
from synth.question.arguments import Family, UserTables
from synth.question.catalogs import catalogs_for
from synth.question.count_domain import is_list
from synth.question.instance import Instance
from synth.question.objectives import chosen_objectives
from synth.question.request import Request
from synth.question.spec import read_content
from synth.queue.database import digest, encoded
from synth.units import check_number, parse_quantity, parse_unit, split_header

CARRY, REQUIREMENTS = "carry", "requirements"
REMEMBERED = 10_000  # questions that are not checked again
DIGITS = re.compile(r"([0-9]+)")
LETTER = re.compile(r"[^\W\d_]|[/%°]")  # then the cell has a unit of its own


@dataclass(frozen=True)
class RowColumn:
    """One column of the table: its heading as it stands there, and what it means."""

    position: int
    title: str
    name: str
    unit: str | None
    carried: bool


@dataclass(frozen=True)
class Fault:
    """Something wrong in a row: where, what, and what would be right."""

    line: int
    column: str
    value: str | None
    expected: str

    def __post_init__(self) -> None:
        """Keep no more of a cell than a message repeats."""
        if self.value is not None:
            object.__setattr__(self, "value", shortened(self.value))

    @classmethod
    def of(cls, line: int, column: str, error: InputError) -> Fault:
        """Fault of the content of a column."""
        return cls(line, column, None if error.value is None else str(error.value), error.expected)

    def sentence(self) -> str:
        """Return the fault in words."""
        where = f"line {self.line}{f', column {self.column}' if self.column else ''}"
        return str(InputError(where, self.value, self.expected))


@dataclass(frozen=True)
class ReadRow:
    """A row that was read: its question, or its faults.

    ``structure`` and ``alike`` are shared by questions that differ in limits, parts and numbers, and in the numbers of
    their requirements alone.
    """

    line: int
    cells: tuple[str, ...]
    family: str
    key: str | None
    question: RowQuestion | None
    structure: str
    alike: str
    place: tuple[float, ...]
    unused: tuple[str, ...]
    faults: tuple[Fault, ...]


@dataclass
class _Variant:
    """A family with the options of some row: what its columns mean."""

    problem: DesignProblem
    columns: list[tuple[RowColumn, Word]]
    unused: list[RowColumn]
    checked: set[frozenset[str]] = field(default_factory=set)


def read_mapping(path: str | Path | None) -> dict[str, str]:
    """Read a mapping file: the headings of a company, and the names they stand for.

    Raises
    ------
    InputError
        It cannot be read, or is not one heading per line with a name.
    """
    if path is None:
        return {}
    content = read_content(path, "--mapping")
    right = "lines such as 'Lastmoment [Nm]: load_torque' (or ': carry' for a column that is only carried along)"
    if not isinstance(content, Mapping) or not content:
        raise InputError(str(path), None if not content else "no mapping", right)
    for heading, name in content.items():
        if not isinstance(heading, str) or not isinstance(name, str) or not name.strip():
            raise InputError(f"{path}: {heading}", None if name is None else str(name), right)
    return {heading.strip(): name.strip() for heading, name in content.items()}


def read_columns(table: RowTable, mapping: Mapping[str, str], universe: Universe) -> tuple[RowColumn, ...]:
    """Read the header of a table.

    Parameters
    ----------
    table : RowTable
    mapping : mapping
        Heading of the table -> name, name with a unit, or ``carry``.
    universe : Universe
        The names that there are.

    Raises
    ------
    InputError
        A heading is misspelt or stands twice, or the mapping names one that is not there.
    """
    titles = table.header()
    where = f"{table.name}, line 1"
    for heading in mapping:
        if heading not in titles:
            close = difflib.get_close_matches(heading, titles, n=1, cutoff=0.5)
            raise InputError(f"mapping: {heading}", heading, close[0] if close else f"a heading of {table.name}")
    present = {mapping.get(title, title).partition("[")[0].strip() for title in titles}
    columns: list[RowColumn] = []
    for position, title in enumerate(titles):
        mapped = mapping.get(title, title)
        carried = mapped == CARRY
        try:
            name, unit = split_header(title if carried else mapped)
            if title in mapping and unit is None and not carried:
                unit = split_header(title)[1]
        except InputError as error:
            if title in mapping and not carried:
                raise InputError(f"mapping: {title}", mapped, error.expected) from None
            name, unit, carried = title, None, True  # no name of ours has brackets in its middle
        if not carried:
            meant = None if universe.knows(name) else universe.suggestion(name, unit, present)
            if meant is not None:
                hint = f"{meant} (or '{title}: carry' in the mapping, for a column of your own)"
                raise InputError(where, title, hint)
            if name in STRUCTURE and any(c.name == name and not c.carried for c in columns):
                raise InputError(where, title, f"one column {name}")
        columns.append(RowColumn(position, title, name, unit, carried))
    return tuple(columns)


class Questioner:
    """Reads the rows of a table one by one, and checks them as the search would.

    Parameters
    ----------
    table : RowTable
    problem : family name, DesignProblem subclass or instance, optional
        Of rows that name no family.
    mapping : mapping
        Headings of the table -> names.
    settings : mapping
        How all rows are searched: objectives, points, gap, grid, seed, time_limit.
    common : mapping
        ``parts``, ``limits`` and ``fix`` that all rows share.
    catalogs : optional
        As for ``synthesize``.
    named : set of str, optional
        The families that rows name, where they are known.

    Raises
    ------
    InputError
        Something is wrong with the table as a whole.
    """

    def __init__(
        self,
        table: RowTable,
        problem: Family | None,
        mapping: Mapping[str, str],
        settings: Mapping[str, Any],
        common: Mapping[str, Mapping[str, object]],
        catalogs: UserTables,
        named: set[str] | None = None,
    ) -> None:
        self.table, self.mapping, self.settings = table, mapping, dict(settings)
        self.common, self.catalogs = common, catalogs
        loaded = None if problem is None else load(problem)
        self.default = None if loaded is None else loaded.name
        self.user_options = {} if loaded is None else dict(loaded.options)
        # A problem of the user's own is known by its class; what options it has, its rows have.
        self.user_family = type(loaded) if loaded is not None and not isinstance(problem, str) else None
        header = _header(table, mapping, self.user_family)
        self.named = self._families_named(header, mapping) if named is None else named
        self.universe = Universe(self.named, self.user_family)
        self.columns = read_columns(table, mapping, self.universe)
        self.structural = {c.name: c for c in self.columns if c.name in STRUCTURE and not c.carried}
        if self.default is None and FAMILY not in self.structural:
            raise InputError(
                f"{table.name}, line 1, column {FAMILY}", None, "such a column, or one family for all rows", (FAMILY,)
            )
        for column in self.structural.values():
            if column.unit is not None:
                raise InputError(f"{table.name}, line 1", column.title, f"{column.name} without a unit")
        for column in self.columns:
            if column.unit is not None and any(column.name in options for options in self.universe.options.values()):
                raise InputError(f"{table.name}, line 1", column.title, f"{column.name} without a unit")
        self._variants: dict[str, _Variant | InputError] = {}
        self._checked: set[str] = set()  # keys of questions, the latest
        self.carried = tuple(c for c in self.columns if c.carried or not self.universe.knows(c.name))

    def _families_named(self, header: tuple[str, ...], mapping: Mapping[str, str]) -> set[str]:
        """Return the families that rows name, and the one for all others."""
        families = {self.default} if self.default is not None else set()
        places = [k for k, title in enumerate(header) if mapping.get(title, title).strip() == FAMILY]
        if places:
            families |= {cells[places[0]].strip() for _, cells in self.table.lines() if len(cells) > places[0]}
        return {name for name in families if name}

    # -- rows ----------------------------------------------------------------------------------

    def rows(self) -> Iterator[ReadRow]:
        """Read and check the rows, one after the other."""
        for line, cells in self.table.lines():
            yield self.row(line, cells)

    def row(self, line: int, cells: tuple[str, ...]) -> ReadRow:
        """Read and check one row."""
        family, structure = "", ""
        try:
            self._check_width(line, cells)
            family = self._cell(FAMILY, cells)
            family = self._family(line, cells)
            question, values, unused = self._question(line, cells, family)
            structure = digest([question["family"], question["options"], sorted(question["requirements"])])
            key = self._check(line, question)
        except _Wrong as wrong:
            return ReadRow(line, cells, family, None, None, structure, "", (), (), tuple(wrong.faults))
        where, alike = place(values), alikeness(question)
        return ReadRow(line, cells, family, key, question, structure, alike, where, tuple(unused), ())

    def _check_width(self, line: int, cells: tuple[str, ...]) -> None:
        if len(cells) != len(self.columns):
            right = f"{len(self.columns)} cells as in the header (and quotes around a text that has a comma)"
            raise _Wrong([Fault(line, "", f"{len(cells)} cells", right)])

    def _cell(self, name: str, cells: tuple[str, ...]) -> str:
        column = self.structural.get(name)
        return "" if column is None else cells[column.position].strip()

    def _family(self, line: int, cells: tuple[str, ...]) -> str:
        named = self._cell(FAMILY, cells)
        if not named:
            if self.default is None:
                right = f"one of {', '.join(families())}"
                raise _Wrong([Fault(line, self.structural[FAMILY].title, None, right)])
            return self.default
        if named != self.default and named not in families():
            close = difflib.get_close_matches(named, families(), n=1, cutoff=0.7)
            right = f"a registered family: {', '.join(families())}{f'; did you mean {close[0]}?' if close else ''}"
            raise _Wrong([Fault(line, self.structural[FAMILY].title, named, right)])
        return named

    def _question(
        self, line: int, cells: tuple[str, ...], family: str
    ) -> tuple[dict[str, Any], list[float], list[str]]:
        """Question of a row: its requirements in SI in the order of their names, and the columns not used."""
        variant, options, ignored = self._variant(line, cells, family)
        faults: list[Fault] = []
        requirements: dict[str, str] = {}
        numbers: dict[str, float] = {}
        by_block = self._blocks(line, cells, faults)
        sources: dict[str, RowColumn] = {}
        for column, word in variant.columns:
            text = cells[column.position].strip()
            if not text:
                continue
            if word.name in sources:
                right = f"each quantity once; column {sources[word.name].title} gives {word.name} too"
                faults.append(Fault(line, column.title, text, right))
                continue
            sources[word.name] = column
            try:
                value, number = self._value(column, word, text)
            except InputError as error:
                faults.append(Fault(line, column.title, text, error.expected))
                continue
            if word.kind == "requirement":
                requirements[word.name], numbers[word.name] = value, number
            elif word.name in by_block[FIX]:
                right = f"{word.name} in one place: it stands in column {FIX} too"
                faults.append(Fault(line, column.title, text, right))
            else:
                by_block[FIX][word.name] = value
        if faults:
            raise _Wrong(faults)
        unused = [c.title for c in variant.unused if cells[c.position].strip()] + ignored
        question = {
            "family": family,
            "options": dict(sorted(options.items())),
            "requirements": dict(sorted(requirements.items())),
            **{name: dict(sorted(entries.items())) for name, entries in by_block.items()},
        }
        return question, [numbers[name] for name in question["requirements"]], unused

    def _blocks(self, line: int, cells: tuple[str, ...], faults: list[Fault]) -> dict[str, dict[str, Any]]:
        """Limits, pins and rules of parts of a row over those of all rows; what is wrong joins the faults."""
        blocks: dict[str, dict[str, Any]] = {}
        for name in (LIMITS, FIX, PARTS):
            blocks[name] = {str(k): v for k, v in self.common.get(name, {}).items()}
            text = self._cell(name, cells)
            if text:
                column = self.structural[name]
                try:
                    blocks[name] |= READERS[name](text, f"column {column.title}")
                except InputError as error:
                    faults.append(Fault.of(line, column.title, error))
        return blocks

    @staticmethod
    def _value(column: RowColumn, word: Word, text: str) -> tuple[str, float]:
        """Return a cell with its unit, and its number in SI (0 for words); refuse what is no number of the kind."""
        if word.unit is None or (word.kind == "count" and is_list(text)):
            return text, 0.0
        quantity_text = text
        if column.unit not in (None, "-"):
            try:
                quantity_text = f"{check_number(text, column.title)} {column.unit}"
            except InputError:
                if not LETTER.search(text):
                    raise
        return quantity_text, parse_quantity(quantity_text, word.unit, column.title)

    def problems(self) -> list[type[DesignProblem]]:
        """Return the classes of the families that rows name, those registered and the user's own."""
        known = [type(load(name)) for name in sorted(self.named) if name in families()]
        return known if self.user_family is None else [*known, self.user_family]

    # -- families and options ------------------------------------------------------------------

    def _variant(self, line: int, cells: tuple[str, ...], family: str) -> tuple[_Variant, dict[str, str], list[str]]:
        text = self._cell(OPTIONS, cells)
        chosen: dict[str, str] = {}
        places: dict[str, RowColumn] = {}
        if text:
            try:
                chosen = dict(READERS[OPTIONS](text, ""))  # type: ignore[arg-type]
            except InputError as error:
                raise _Wrong([Fault.of(line, self.structural[OPTIONS].title, error)]) from None
            places = dict.fromkeys(chosen, self.structural[OPTIONS])
        spellings = self.universe.options.get(family, {})
        for column in self.columns:
            name = spellings.get(column.name)
            if name is not None and not column.carried and cells[column.position].strip():
                if name in chosen:
                    right = f"option {name} in one place: it stands in {places[name].title} too"
                    raise _Wrong([Fault(line, column.title, cells[column.position].strip(), right)])
                chosen[name], places[name] = cells[column.position].strip(), column
        if family == self.default:
            chosen = {**self.user_options, **chosen}
        ignored: list[str] = []
        variant = self._known_variant(family, chosen)
        while isinstance(variant, UnknownOptionError) and variant.path[-1] in places:
            # An option that another option takes away is not applied, where a column gives it.
            column = places[str(variant.path[-1])]
            if column.name == OPTIONS:
                break
            del chosen[str(variant.path[-1])]
            ignored.append(column.title)
            variant = self._known_variant(family, chosen)
        if isinstance(variant, InputError):
            named = str(variant.path[-1]) if variant.path else ""
            column_of = places.get(named) or self.structural.get(OPTIONS)
            title = column_of.title if column_of is not None else ""
            raise _Wrong([Fault.of(line, title, variant)])
        return variant, chosen, ignored

    def _known_variant(self, family: str, options: Mapping[str, str]) -> _Variant | InputError:
        label = encoded([family, options])
        if label not in self._variants:
            self._variants[label] = self._make_variant(family, options)
        return self._variants[label]

    def _make_variant(self, family: str, options: Mapping[str, str]) -> _Variant | InputError:
        try:
            problem = self.problem(family, options)
            declaration = problem.model(frozenset(), catalogs_for(problem, self.catalogs)).declaration
        except InputError as error:
            if error.path[:1] == ("catalogs",):
                raise
            return error
        words = words_of(declaration, problem.simulation_settings)
        used, unused = list[tuple[RowColumn, Word]](), list[RowColumn]()
        for column in self.columns:
            if column in self.carried or column.name in STRUCTURE:
                continue
            word = words.get(column.name)
            if word is None and column.name in self.universe.options.get(family, {}):
                continue  # an option that these options take away: the row says so
            if word is None or word.kind in ("derived", "setting"):
                unused.append(column)
            elif word.kind != "option":
                self._check_column(column, word)
                used.append((column, word))
        return _Variant(problem, used, unused)

    def problem(self, family: str, options: Mapping[str, str]) -> DesignProblem:
        """Return the problem of a family with the options of a row."""
        return load(self.user_family if self.user_family is not None and family == self.default else family, **options)

    def _check_column(self, column: RowColumn, word: Word) -> None:
        where = f"{self.table.name}, line 1, column {column.title}"
        if column.unit is None:
            return
        if word.unit is None:
            raise InputError(where, column.title, f"{word.name} without a unit")
        try:
            parse_unit(column.unit, word.unit.kind)
        except InputError as error:
            raise InputError(where, column.unit, error.expected) from None

    # -- the whole question --------------------------------------------------------------------

    def _check(self, line: int, question: RowQuestion) -> str:
        """Pose the question as the search would, and return its key."""
        variant = self._variants[encoded([question["family"], question["options"]])]
        assert isinstance(variant, _Variant)
        problem = variant.problem
        titles = {word.name: column.title for column, word in variant.columns}
        try:
            catalogs = catalogs_for(problem, self.catalogs)
            requirement_names = frozenset(question["requirements"])
            key = digest(question)
            if key not in self._checked:
                fields = {name: question[name] for name in (REQUIREMENTS, PARTS, LIMITS, FIX)}
                fields |= {"objectives": self.settings["objectives"], "grid": self.settings["grid"]}
                instance = Instance(Request(problem=problem, catalogs=catalogs, **fields))
                instance.ranges.grids()
                if requirement_names not in variant.checked:
                    chosen_objectives(instance.model, self.settings["objectives"])
                    variant.checked.add(requirement_names)
                if len(self._checked) >= REMEMBERED:
                    self._checked.clear()
                self._checked.add(key)
        except InputError as error:
            raise _Wrong([self._located(line, error, titles)]) from None
        return key

    def _located(self, line: int, error: InputError, titles: Mapping[str, str]) -> Fault:
        """Say in which column stands what the search refuses."""
        kind, name = (*map(str, error.path[:2]), "", "")[:2]
        if name in titles and kind in (REQUIREMENTS, FIX):
            return Fault.of(line, titles[name], error)
        if kind == REQUIREMENTS and name:
            return Fault.of(line, name, error)
        where = name if kind in (LIMITS, FIX, PARTS) else error.field
        value = "" if error.value is None else str(error.value)
        shown = ": ".join(x for x in dict.fromkeys((where, value)) if x)
        if kind in (LIMITS, FIX, PARTS):
            return Fault(line, self.structural[kind].title if kind in self.structural else kind, shown, error.expected)
        return Fault(line, "", shown, error.expected)


def _header(table: RowTable, mapping: Mapping[str, str], user_family: type[DesignProblem] | None) -> tuple[str, ...]:
    """Return the header of a table.

    Raises
    ------
    InputError
        Nothing in its first line is known, and another line is the header.
    """
    header, fault = tuple[str, ...](), None
    try:
        header = table.header()
    except InputError as error:
        fault = error
    universe = Universe(set(), user_family)

    def known(cells: Sequence[str]) -> int:
        names = (mapping.get(title.strip(), title).partition("[")[0].strip() for title in cells)
        return sum(universe.knows(name) for name in names if name)

    if not known(header):
        right = table.header_elsewhere(lambda cells: known(cells) > 1)
        if right:
            raise InputError(f"{table.name}, line 1", " ".join(header) or None, right)
    if fault is not None:
        raise fault
    return header


class _Wrong(Exception):
    """What is wrong with one row; never leaves this module."""

    def __init__(self, faults: list[Fault]) -> None:
        super().__init__("a row that asks no question")
        self.faults = faults


def alikeness(question: RowQuestion) -> str:
    """Digest that is shared by questions which differ in the numbers of their requirements alone."""
    return digest({**question, REQUIREMENTS: sorted(question[REQUIREMENTS])})


def canonical_position(cells: tuple[str, ...]) -> bytes:
    """Sort key of rows by their cells, left to right, numbers in a text by their size.

    Examples
    --------
    >>> sorted([("R10", "a"), ("R9", "b"), ("R9", "a")], key=canonical_position)
    [('R9', 'a'), ('R9', 'b'), ('R10', 'a')]
    """
    shown = b"\0".join(b"".join(_ordered(chunk) for chunk in DIGITS.split(cell)) for cell in cells)
    return shown + b"\0\0" + "\0".join(cells).encode("utf-8", "surrogatepass")


def _ordered(chunk: str) -> bytes:
    if chunk.isascii() and chunk.isdigit():
        digits = chunk.lstrip("0")
        return b"0" + len(digits).to_bytes(2, "big") + digits.encode()
    return chunk.encode("utf-8", "surrogatepass")
