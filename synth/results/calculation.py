"""How the numbers of designs are computed: every quantity and limit with its formula, as one record for reports.

A calculation is read back from the very graph that was solved (``synth.analysis.calculation``) and saved beside the
front. It belongs to a question, not to a design: inputs come from the record of each design.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

from synth.errors import InputError
from synth.folders.files import read_json
from synth.order.feasibility import holds, residual, utilisation
from synth.results.design import Design
from synth.results.expression import Expression, value_of
from synth.results.plain import compact_json, digest_of, finite, intact
from synth.text.numbers import percent
from synth.text.row_cells import CODE_OF, Cell, cell_value, named_column, text_code

CALCULATION_FORMAT = 1
CALCULATION = "calculation.json"
AGREES = 1e-9  # relative; what a record and its formula may differ by: what is recorded has 17 digits
RIGHT = "a calculation.json as clutchsynth has written it"


@dataclass(frozen=True, kw_only=True)
class NamedQuantity:
    """One quantity of a calculation.

    Parameters
    ----------
    name : str
        Public name; ``slot.column`` for what a part says, ``u_1`` for a part of a long formula.
    kind : str
        What it comes from: ``requirement``, ``variable``, ``count``, ``choice``, ``part`` and ``row`` are inputs,
        ``constant`` is a number of nature or of a source; ``step``, ``derived`` and ``helper`` are computed.
    symbol, unit, text, source : str
        As declared; of a part as its table says, without a unit where the table does not have the column. A part of a
        long formula has no unit where those of the formula do not close: it is a number in SI.
    expression : Expression, optional
        Of what is computed, and of a requirement whose default follows from others.
    value : float, optional
        SI, of rows and constants: the same for all designs.
    needs : tuple of str
        Guards without which it does not exist.
    bounds : (float, float), optional
        SI; what may be stated or is searched.
    group : str
        Of a requirement: what it belongs to, in the words of the family.
    step : float, optional
        Of a count: from one value to the next.
    slot, columns : str, tuple of str
        Of a part or row: where it is found; the first column that has a value counts.
    labels : tuple of str
        Of a choice: what its numbers 0, 1, ... mean. Of a text column: texts that formulas ask for.
    """

    name: str
    kind: str
    symbol: str
    unit: str
    text: str = ""
    source: str = ""
    expression: Expression | None = None
    value: float | None = None
    needs: tuple[str, ...] = ()
    bounds: tuple[float, float] | None = None
    group: str = ""
    step: float | None = None
    slot: str = ""
    columns: tuple[str, ...] = ()
    labels: tuple[str, ...] = ()

    @property
    def computed(self) -> bool:
        """True if it follows from others in every design."""
        return self.kind in ("step", "derived", "helper")

    def word(self, number: float) -> str | None:
        """Meaning of a number: the label of a choice, or a text that formulas ask for."""
        if self.kind == "choice":
            is_label = float(number).is_integer() and 0 <= number < len(self.labels)
            return self.labels[int(number)] if is_label else None
        if not self.is_text:
            return None
        return next((text or "nothing" for text in self.labels if text_code(text) == number), None)

    @property
    def column(self) -> str:
        """Name of the first column that it is found in, as its table has it."""
        return named_column(self.columns[0])

    @property
    def is_text(self) -> bool:
        """True if it stands for a text of a row."""
        return self.kind in ("part", "row") and self.columns[0].startswith(CODE_OF)


@dataclass(frozen=True, kw_only=True)
class LimitRule:
    """One limit of a calculation: both sides as formulas.

    Parameters
    ----------
    name, sense, unit, text, source : str
    value, limit : Expression
    guard : bool
        Whether formulas exist only where it holds; then it holds strictly.
    scale : float
        SI; smallest size that counts.
    needs : tuple of str
        Guards that alone tell why where they fail.
    optional : tuple of str
        Quantities without whose value it is void.
    stated_by : str
        ``family`` or ``user``.
    """

    name: str
    sense: str
    unit: str
    text: str = ""
    source: str = ""
    value: Expression
    limit: Expression
    guard: bool = False
    scale: float
    needs: tuple[str, ...] = ()
    optional: tuple[str, ...] = ()
    stated_by: str = "family"


@dataclass(frozen=True, kw_only=True)
class RemarkRule:
    """A remark on the designs for which its condition holds."""

    code: str
    condition: Expression
    message: str
    source: str = ""


@dataclass(frozen=True)
class LimitVerdict:
    """How a design stands at a limit.

    Parameters
    ----------
    value, limit : float
        Both sides in SI, as formulas give them, whatever guards say.
    void : bool
        Whether an optional column has no value, so that the limit is undecided.
    failed : tuple of str
        Guards that fail without which its sides do not exist: they alone tell why.
    holds : bool
        Also where it is void, or where guards have failed.
    used : float or None
        Share of the limit that is used; None where it is undecided.
    """

    value: float
    limit: float
    void: bool
    failed: tuple[str, ...]
    holds: bool
    used: float | None


@dataclass(frozen=True)
class CalculatedDesign:
    """What a calculation gives for one design.

    Parameters
    ----------
    values : mapping
        Every quantity in SI; not-a-number where a guard fails that it needs, or a column has no value.
    verdicts : mapping
        Limit -> :class:`LimitVerdict`.
    """

    values: Mapping[str, float]
    verdicts: Mapping[str, LimitVerdict]


@dataclass(frozen=True, kw_only=True)
class Calculation:
    """Everything that is computed of a design of one question, in order of dependency.

    Parameters
    ----------
    family, title : str
    sources : tuple of str
    options : mapping
        All that are in force.
    quantities : mapping
        Name -> :class:`NamedQuantity`; what is computed stands behind what it is computed from.
    limits : tuple of LimitRule
    remarks : tuple of RemarkRule
    """

    family: str
    title: str
    sources: tuple[str, ...]
    options: Mapping[str, str]
    quantities: Mapping[str, NamedQuantity]
    limits: tuple[LimitRule, ...]
    remarks: tuple[RemarkRule, ...] = ()

    # -- numbers -------------------------------------------------------------------------------

    def inputs(self, design: Design) -> dict[str, float]:
        """Return the inputs of a design by name, in SI; not-a-number where an optional column has no value.

        Raises
        ------
        InputError
            The design is of another question.
        """
        return {q.name: _input(q, design) for q in self.quantities.values() if not q.computed}

    def outcome(self, inputs: Mapping[str, float]) -> CalculatedDesign:
        """Return every quantity and limit, computed from inputs.

        Parameters
        ----------
        inputs : mapping
            As :meth:`inputs` returns them.
        """
        raw = dict(inputs)
        for q in self.quantities.values():
            if q.computed:
                assert q.expression is not None
                raw[q.name] = value_of(q.expression, raw)
        sides = {x.name: (value_of(x.value, raw), value_of(x.limit, raw)) for x in self.limits}
        missed = {x.name: residual(*sides[x.name], x.sense, x.scale) for x in self.limits}
        held = {x.name: bool(holds(missed[x.name], x.guard)) for x in self.limits}
        failing = {x.name for x in self.limits if x.guard and not held[x.name]}
        values = {
            name: math.nan if failing.intersection(self.quantities[name].needs) else value
            for name, value in raw.items()
        }
        verdicts = {}
        for x in self.limits:
            void = any(math.isnan(raw[name]) for name in x.optional)
            failed = tuple(guard for guard in x.needs if not held[guard])
            held[x.name] = held[x.name] or void or bool(failed)
            decidable = not void and not failed and not math.isnan(missed[x.name])
            used = float(utilisation(*sides[x.name], x.sense)) if decidable else None
            value, limit = sides[x.name]
            verdicts[x.name] = LimitVerdict(value, limit, void, failed, held[x.name], used)
        return CalculatedDesign(values, verdicts)

    def of_design(self, design: Design) -> CalculatedDesign:
        """Return every quantity and limit of a design, computed anew and compared with its record.

        Raises
        ------
        InputError
            A recorded value differs: the design was computed by other formulas, or was changed.
        """
        outcome = self.outcome(self.inputs(design))
        for name, recorded in (*design.values.items(), *design.steps.items()):
            if name in outcome.values:
                self._compare(name, recorded, outcome.values[name])
        for name, verdict in outcome.verdicts.items():
            if name in design.limits and not verdict.void and not verdict.failed:
                for recorded, recomputed in zip(design.limits[name], (verdict.value, verdict.limit), strict=True):
                    self._compare(f"limit {name}", recorded, recomputed)
        return outcome

    def values(self, design: Design) -> Mapping[str, float]:
        """Return every quantity of a design in SI, computed anew and compared with its record.

        Raises
        ------
        InputError
            As for :meth:`of_design`.
        """
        return self.of_design(design).values

    def _compare(self, name: str, recorded: float, recomputed: float) -> None:
        if math.isnan(recorded) and math.isnan(recomputed):
            return
        if recorded == recomputed or abs(recorded - recomputed) <= AGREES * max(abs(recorded), abs(recomputed)):
            return
        smaller = min(abs(recorded), abs(recomputed))
        differs = f"differs by {percent(abs(recorded - recomputed) / smaller)}" if smaller else "differs"
        right = f"a value as its formula gives it ({name} {differs}): run it again, or use the version that computed it"
        raise InputError(f"design: {name}", finite(recorded), right)

    # -- files ---------------------------------------------------------------------------------

    @cached_property
    def content(self) -> dict[str, Any]:
        """The content of a calculation.json."""
        record: dict[str, Any] = {
            "format": CALCULATION_FORMAT,
            "family": self.family,
            "title": self.title,
            "sources": list(self.sources),
            "options": dict(self.options),
            "quantities": [_non_default_fields(q) for q in self.quantities.values()],
            "limits": [_non_default_fields(x) for x in self.limits],
            "remarks": [_non_default_fields(x) for x in self.remarks],
        }
        record["digest"] = digest_of(record)
        return record

    @property
    def digest(self) -> str:
        """What tells it from every other calculation."""
        return str(self.content["digest"])

    def to_json(self) -> str:
        """Return the text of a calculation.json."""
        return compact_json(self.content)

    @staticmethod
    def from_json(content: object, field: str = "calculation") -> Calculation:
        """Read a calculation.

        Parameters
        ----------
        content : dict
            The content of a calculation.json.
        field : str
            What names it, for messages.

        Raises
        ------
        InputError
            It is none, it is of another format, or it was changed after it was saved.
        """
        if not isinstance(content, dict):
            raise InputError(field, None if content is None else type(content).__name__, RIGHT)
        if content.get("format") != CALCULATION_FORMAT:
            raise InputError(f"{field}: format", content.get("format"), f"format {CALCULATION_FORMAT}")
        try:
            if not intact(content):
                raise InputError(
                    field, "a changed file", f"{RIGHT}; its checksum does not fit: it was changed after it was saved"
                )
            return Calculation(
                family=content["family"],
                title=content["title"],
                sources=tuple(content["sources"]),
                options=dict(content["options"]),
                quantities={q["name"]: _read(NamedQuantity, q) for q in content["quantities"]},
                limits=tuple(_read(LimitRule, x) for x in content["limits"]),
                remarks=tuple(_read(RemarkRule, x) for x in content["remarks"]),
            )
        except (KeyError, TypeError, ValueError, AttributeError, RecursionError) as error:
            if isinstance(error, InputError):
                raise
            raise InputError(field, str(error), f"{RIGHT}; this one is not complete") from error


def load_calculation(folder: Path, digest: str) -> Calculation:
    """Read the calculation that was saved in a folder with a front.

    Parameters
    ----------
    folder : Path
    digest : str
        What the front says of it.

    Raises
    ------
    InputError
        It is missing, was changed, or belongs to another front.
    """
    path = folder / CALCULATION
    calculation = Calculation.from_json(read_json(path, "calculation", RIGHT), f"calculation {path}")
    if calculation.digest != digest:
        raise InputError(
            f"calculation {path}", calculation.digest[:12], f"{RIGHT} with this front; it belongs to another one"
        )
    return calculation


def _input(q: NamedQuantity, design: Design) -> float:
    """Return one input of a design."""
    frame = design.frame
    if q.value is not None:
        return q.value
    try:
        if q.kind == "requirement":
            return float(frame.requirement_values[q.name])
        if q.kind == "choice":
            return float(q.labels.index(design.choices[q.name]))
        if q.kind == "part":
            return part_value(design.parts[q.slot], q.columns)
        return math.nan if q.kind == "row" else float(design.values[q.name])
    except (KeyError, ValueError):
        raise InputError(f"design: {q.name}", None, "a design of the question that is calculated") from None


def part_value(row: Mapping[str, Cell], columns: Iterable[str]) -> float:
    """Cell of a row in the first of several columns that has a value.

    Parameters
    ----------
    row : mapping
        Column -> number in SI, or text.
    columns : list of str
        Names as models use them.
    """
    cells = (cell_value(row, column) for column in columns)
    return next((value for value in cells if not math.isnan(value)), math.nan)


def _non_default_fields(record: NamedQuantity | LimitRule | RemarkRule) -> dict[str, Any]:
    """Fields of a record that differ from the usual ones."""
    usual = {f.name: f.default for f in type(record).__dataclass_fields__.values()}
    kept: dict[str, Any] = {}
    for name, value in vars(record).items():
        if value != usual[name] and name in usual:
            kept[name] = (
                [finite(x) for x in value] if name == "bounds" else list(value) if isinstance(value, tuple) else value
            )
    return kept


def _read(kind: type[Any], entry: Mapping[str, Any]) -> Any:
    """Record of an entry; JSON knows lists in place of tuples."""
    fields = dict(entry)
    for name in ("needs", "optional", "columns", "labels"):
        if name in fields:
            fields[name] = tuple(fields[name])
    if "bounds" in fields:
        low, high = fields["bounds"]
        fields["bounds"] = (float(low), float(high))
    return kind(**fields)
