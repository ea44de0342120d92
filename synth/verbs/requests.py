"""The verbs: what each takes beside the question, front or table that it is about."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass, replace
from enum import Enum
from types import MappingProxyType
from typing import Any

from synth.errors import InputError
from synth.question.request_fields import (
    FIELDS,
    LISTED,
    NUMBER,
    OF_A_DESIGN,
    OWN,
    QUANTITY,
    RANK,
    SECONDS,
    TABLES,
    TEXT,
    RequestField,
    Schema,
    TypedForm,
    ValueKind,
    by_name,
    family_schema,
    listed,
    one_of,
    pair,
    shown_kind,
    some,
    text,
    whole,
    whole_schema,
)
from synth.text.input_limits import INPUT_LIMITS
from synth.verbs.request import WORKERS, VerbRequest, field, schema_of, shared

REPORT_FORMATS = ("html", "explorer", "pdf", "xlsx", "json", "svg", "dxf")
REPORT_LENGTHS = ("summary", "normal", "full")
VARIED_ENDS = ("from", "to", "count")
VARIES = "names with values, {'load_torque': '500:700:50 N*m'}"
LOGO = "logo"  # of ``about`` names a file: no request does
ROW = '{"load_torque": "600 N*m"}'


# ---- kinds of values ------------------------------------------------------------------------------------------------


def as_stated(where: str, value: object) -> object:
    """Value that is read where more is known: of a front, a family or the tables that there are."""
    return value


def _flag(where: str, value: object) -> bool:
    if not isinstance(value, bool):
        raise InputError(where, shown_kind(value), "true or false")
    return value


def _fraction(where: str, value: object) -> float:
    if not isinstance(value, (int, float)) or isinstance(value, bool) or not 0 <= value < 1:
        raise InputError(where, shown_kind(value), "a fraction from 0 to below 1, for example 0.001")
    return float(value)


def _names(where: str, value: object) -> tuple[str, ...]:
    if not isinstance(value, (list, tuple)) or not all(isinstance(name, str) for name in value):
        raise InputError(where, shown_kind(value), "a list of names of variables")
    return tuple(value)


def _vary(where: str, value: object) -> Mapping[str, Any]:
    if not isinstance(value, Mapping) or not value:
        raise InputError(where, shown_kind(value), VARIES)
    for name, values in value.items():
        if isinstance(values, Mapping) and set(values) != set(VARIED_ENDS):
            right = "a text or list of values, or {'from': '200 mm', 'to': '300 mm', 'count': 11}"
            raise InputError(where, ", ".join(map(str, values)), right, (str(name),))
    return value


VARIED_TEXT = re.compile(r"^\s*([^<>=]+?)\s*(<=|>=|==|=|<|>)\s*(\S.*?)\s*$", re.DOTALL)


def typed_vary(where: str, texts: list[str]) -> dict[str, str]:
    """Varied quantities in ``mass <= 40:60:5 kg`` and ``load_torque=500,600 N*m``.

    Examples
    --------
    >>> typed_vary("--vary", ["mass <= 40:60:5 kg", "outer_diameter_limit=200:300:10 mm"])
    {'mass <=': '40:60:5 kg', 'outer_diameter_limit': '200:300:10 mm'}
    """
    values_of: dict[str, str] = {}
    for one in texts:
        match = VARIED_TEXT.match(one)
        if match is None:
            right = "NAME=VALUES or QUANTITY <= VALUES, for example 'load_torque=500:700:50 N*m'"
            raise InputError(where, one, right)
        name, sign, values = match.groups()
        label = name if sign == "=" else f"{name} {sign}"
        if label in values_of:
            raise InputError(where, one, "each thing once")
        values_of[label] = values
    return values_of


def _typed_spread(where: str, texts: list[str]) -> dict[str, str]:
    """What scatters, in ``load_torque=+-10 %``."""
    spread: dict[str, str] = {}
    for name, value in (pair(where, one) for one in texts):
        if spread.setdefault(name, value) is not value:
            raise InputError(where, name, "each thing once")
    return spread


def _split(where: str, words: str) -> list[str]:
    return [word.strip() for word in words.split(",")]


def _sheets(where: str, value: object) -> tuple[str, ...]:
    words = value if isinstance(value, (list, tuple)) else [value]
    if any(isinstance(word, bool) or not isinstance(word, (int, str)) for word in words):
        raise InputError(where, shown_kind(value), "ranks, or knee")
    return tuple(map(str, words))


def _formats(where: str, value: object) -> tuple[str, ...]:
    formats = [value] if isinstance(value, str) else value
    if not isinstance(formats, (list, tuple)) or not formats or not all(word in REPORT_FORMATS for word in formats):
        raise InputError(where, shown_kind(value), f"some of {', '.join(REPORT_FORMATS)}")
    return tuple(word for word in REPORT_FORMATS if word in formats)


def _length(where: str, value: object) -> str:
    if value not in REPORT_LENGTHS:
        raise InputError(where, shown_kind(value), f"one of {', '.join(REPORT_LENGTHS)}")
    return str(value)


def _about(where: str, value: object) -> Mapping[str, Any]:
    """Labels by name; :class:`synth.results.report_request.About` reads them."""
    if not isinstance(value, Mapping):
        raise InputError(where, shown_kind(value), "names with texts, {'project': 'Crane 4'}")
    if LOGO in value:
        raise InputError(where, LOGO, "no logo: requests name no files", (LOGO,))
    return dict(value)


def _headings(where: str, value: object) -> Mapping[str, str]:
    right = 'an object such as {"Lastmoment [Nm]": "load_torque"} ("carry" for a column that is only carried along)'
    if not isinstance(value, Mapping) or not all(isinstance(k, str) and isinstance(v, str) for k, v in value.items()):
        raise InputError(where, shown_kind(value), right)
    return {heading.strip(): name.strip() for heading, name in value.items()}


FLAG = ValueKind({"type": "boolean"}, _flag, bool)
SHARE = ValueKind(some(NUMBER, TEXT), as_stated, str)
FRACTION = ValueKind({**NUMBER, "minimum": 0, "exclusiveMaximum": 1}, _fraction, float)
RANKS_SCHEMA = some(whole_schema(1, INPUT_LIMITS.points), listed(whole_schema(1, INPUT_LIMITS.points), 1))
RANKS = ValueKind(RANKS_SCHEMA, as_stated, list[int])
SAMPLES = whole(1, INPUT_LIMITS.samples)
NAMES = ValueKind(listed({"type": "string"}), _names, list[str])
OWN_TABLES = ValueKind(TABLES, as_stated)
VARIED = ValueKind(
    by_name(
        some(
            TEXT,
            listed(some(QUANTITY, listed(TEXT, 1)), 1),
            {
                "type": "object",
                "properties": {"from": QUANTITY, "to": QUANTITY, "count": whole_schema(2, INPUT_LIMITS.steps)},
                "required": list(VARIED_ENDS),
                "additionalProperties": False,
            },
        ),
        minProperties=1,
        maxProperties=2,
    ),
    _vary,
)
WORD: Schema = {"type": ["string", "integer"]}
SHEETS = ValueKind(some(WORD, listed(WORD)), _sheets)
FORMATS = ValueKind(some(one_of(REPORT_FORMATS), listed(one_of(REPORT_FORMATS), 1)), _formats)
LENGTH = ValueKind(one_of(REPORT_LENGTHS), _length, str)
ABOUT = ValueKind(by_name({"type": "string"}), _about)
ROWS = ValueKind(listed({"type": "object"}, 1), as_stated)
HEADINGS = ValueKind(by_name({"type": "string"}), _headings)


OF = "of"
JOB = "0j3k5m7n9pqrstvwxyz0123456"
# Of a job: whoever runs the workers says how much is worked at.
JOB_FIELDS = {
    **FIELDS,
    WORKERS: replace(FIELDS[WORKERS], value=ValueKind({"const": 1}, as_stated), help="Of a job always one."),
}
SPEC = tuple(name for name in FIELDS if name not in OF_A_DESIGN)


def _families_schema() -> Schema:
    one = schema_of("A family, with what concerns it alone.", {name: FIELDS[name] for name in OWN})
    return some({"const": "any"}, listed(some(FIELDS["family"].schema(), {**one, "required": ["family"]}), 1))


SEVERAL = ValueKind(_families_schema, FIELDS["family"].value.read)


def design_schema(**more: RequestField) -> Schema:
    """JSON Schema of a design as a spec, perhaps with more fields."""
    spec = schema_of("A design: a spec with `values` and the parts that are meant.", {**JOB_FIELDS, **more})
    return {**spec, "required": ["family", "values"]}


# ---- requests -------------------------------------------------------------------------------------------------------


@dataclass(frozen=True, kw_only=True)
class FrontRequest(VerbRequest):
    """The front that a job is about."""

    of: str = field(
        ValueKind(TEXT, text("the id of a job that has ended")),
        "Id of a job that has found a front.",
        examples=(JOB,),
        needed="the id of a job that has found a front",
    )
    family: str | None = field(
        ValueKind(family_schema, text("the name of a family")), "Of a job that compares several: which front is meant."
    )


@dataclass(frozen=True, kw_only=True)
class SynthesisRequest(VerbRequest):
    """A spec alone."""


@dataclass(frozen=True, kw_only=True)
class CompareRequest(VerbRequest):
    """Several families."""

    family: Any = field(
        SEVERAL,
        "Families that are compared: `any` for all, or a list of names, each perhaps with entries of its own.",
        examples=("any",),
    )


@dataclass(frozen=True, kw_only=True)
class WhatIfRequest(VerbRequest):
    """What varies."""

    vary: Mapping[str, Any] = field(
        VARIED,
        "One or two requirements, limits (`mass <=`), `weights.NAME`, `parts.SLOT`, `options.NAME` or `robust.NAME`, "
        "each with its values: a text such as `500:700:50 N*m`, a list, or two ends and a count.",
        unit="that of what varies",
        examples=({"load_torque": "500:700:50 N*m"}, {"mass <=": {"from": "40 kg", "to": "60 kg", "count": 3}}),
        needed=VARIES,
        typed=TypedForm(
            "--vary",
            "TEXT",
            "What to vary: 'load_torque=500:700:50 N*m', 'mass <= 40,50,60 kg', 'weights.mass=1:4:1', "
            "'parts.SLOT=a,b', 'options.NAME=a,b' or 'robust.friction=+-5 %, +-10 %'; give it once or twice.",
            list[str],
            typed_vary,
        ),
    )
    breaks: bool = field(
        FLAG, "Find where the best parts or counts change.", usual=True, examples=(False,), flag="--breaks/--no-breaks"
    )


@dataclass(frozen=True, kw_only=True)
class ExplainRequest(VerbRequest):
    """What may give way."""

    physics: bool = field(FLAG, "Let limits of the family give way as well.", usual=False, examples=(True,))


@dataclass(frozen=True, kw_only=True)
class PricesRequest(VerbRequest):
    """Which designs, and by how much everything is moved."""

    design: tuple[int, ...] | None = field(
        RANKS, "Ranks of designs, all by default.", examples=(1, [1, 2]), metavar="RANK"
    )
    step: Any = field(SHARE, "By how much each requirement and limit is moved.", usual="1 %", examples=("2 %", 0.02))
    time_limit: float | None = shared(FIELDS["time_limit"])


@dataclass(frozen=True, kw_only=True)
class NearEqualsRequest(VerbRequest):
    """Which design, and what counts as nearly as good."""

    design: int = field(RANK, "Rank of the chosen design.", usual=1, examples=(2,))
    within: Any = field(SHARE, "By how much every objective may be worse.", usual="2 %", examples=("5 %", 0.05))
    count: int = field(LISTED, "At most this many designs.", usual=5, examples=(10,))
    seed: int = shared(FIELDS["seed"])
    time_limit: float | None = shared(FIELDS["time_limit"])


@dataclass(frozen=True, kw_only=True)
class RateRequest(VerbRequest):
    """Which designs, and what scatters."""

    design: tuple[int, ...] | None = field(
        ValueKind(RANKS_SCHEMA, as_stated), "Ranks of designs, all by default.", examples=(1, [1, 2])
    )
    robust: Mapping[str, Any] | None = shared(
        FIELDS["robust"],
        typed=TypedForm(
            "--over",
            "NAME=RANGE",
            "What scatters: 'friction=catalogue range', 'load_torque=+-10 %', 'ambient_temperature=0 .. 60 degC', "
            "'ring_outer_diameter=+-0.1 mm'; repeat it. By default what the question says under robust.",
            list[str],
            _typed_spread,
        ),
    )
    samples: int | None = field(SAMPLES, "Points of the range, a power of 2.", examples=(256,))
    confidence: Any = field(SHARE, "Of the interval of the yield, such as '95 %'.", examples=("99 %", 0.9))
    seed: int | None = shared(FIELDS["seed"], usual=None, help="Seed of the points.")
    time_limit: float | None = shared(FIELDS["time_limit"])

    def block(self, known: Mapping[str, Any]) -> dict[str, Any]:
        """What scatters: this, or else what is known, with the entries that are stated beside it."""
        beside = {"samples": self.samples, "confidence": self.confidence, "seed": self.seed}
        block = self.robust or known
        return {**block, **{name: one for name, one in beside.items() if one is not None}} if block else {}


@dataclass(frozen=True, kw_only=True)
class VerifyRequest(VerbRequest):
    """How long a proof is tried."""

    time_limit: float = field(
        SECONDS,
        "Give the proof up after this time, in seconds or such as '2 min'.",
        unit="s",
        usual=120.0,
        examples=(60, "2 min"),
    )


@dataclass(frozen=True, kw_only=True)
class FrontReportRequest(VerbRequest):
    """What is written, of which designs, for whom."""

    design: tuple[str, ...] = field(
        SHEETS,
        "Designs that get sheets: ranks, or `knee`.",
        usual=("1",),
        examples=([1, 3, "knee"], 2),
        typed=TypedForm(
            "--design", None, "Designs that get sheets, such as 1,3,knee; by default the first.", str, _split
        ),
    )
    full: int = field(
        whole(0, INPUT_LIMITS.points), "Designs that report.html tells in full.", usual=5, examples=(0, 10)
    )
    formats: tuple[str, ...] = field(FORMATS, "What is written.", usual=("html",), examples=("pdf", ["html", "xlsx"]))
    length: str = field(LENGTH, "Of the sheets: summary, normal or full.", usual="normal", examples=("full",))
    about: Mapping[str, Any] | None = field(
        ABOUT, "Whom the report is for: `project`, `author` and the like.", examples=({"project": "Crane 4"},)
    )


@dataclass(frozen=True, kw_only=True)
class BatchRequest(VerbRequest):
    """A table, and what is asked of all its rows."""

    upload: str | None = field(
        ValueKind(TEXT, text("the id of a file that was uploaded, or rows")),
        "Id of a file that was uploaded.",
        examples=(JOB,),
    )
    rows: Any = field(ROWS, "The rows, by names of requirements.", examples=([{"load_torque": "600 N*m"}],))
    mapping: Mapping[str, str] | None = field(
        HEADINGS,
        "What headings of your own mean: the name of a requirement, or `carry`.",
        examples=({"Lastmoment [Nm]": "load_torque"},),
    )
    family: str | None = field(
        ValueKind(family_schema, text("the name of a family"), str),
        "Family of the rows that name none.",
        metavar="FAMILY",
    )
    objectives: Any = shared(FIELDS["objectives"])
    points: int = shared(FIELDS["points"], help="At most this many designs per row.")
    gap: float = shared(FIELDS["gap"])
    grid: bool = shared(FIELDS["grid"])
    seed: int = shared(FIELDS["seed"])
    time_limit: float | None = shared(
        FIELDS["time_limit"], help="Stop each row after this time, in seconds or such as '2 min'."
    )
    parts: Mapping[str, Any] | None = shared(FIELDS["parts"])
    limits: Mapping[str, Any] | None = shared(FIELDS["limits"])
    fix: Mapping[str, Any] | None = shared(FIELDS["fix"])
    catalogs: Any = shared(FIELDS["catalogs"], value=OWN_TABLES)


@dataclass(frozen=True, kw_only=True)
class SizeRangeRequest(VerbRequest):
    """How variants are chosen."""

    variants: int | None = field(LISTED, "How many variants; by default the fewest that serve all rows.", examples=(3,))
    objective: str | None = field(
        ValueKind(TEXT, text("the name of a quantity"), str),
        "What should exceed each row's own best as little as possible.",
        examples=("mass",),
        metavar="NAME",
    )
    per_row: tuple[str, ...] | None = field(
        NAMES, "Variables that each row decides, no part of a variant.", examples=(["ramp_time"],), metavar="NAME"
    )
    candidates: int = field(LISTED, "Consider at most about this many designs.", usual=500, examples=(100,))
    gap: float = field(FRACTION, "How far from proven the choice may be, as a fraction.", usual=1e-3, examples=(0.01,))
    time_limit: float = field(
        SECONDS, "Time for choosing, in seconds or such as '2 min'.", unit="s", usual=60.0, examples=(60, "2 min")
    )


# ---- verbs ----------------------------------------------------------------------------------------------------------


class Subject(Enum):
    """What a verb is about, and how a job names it."""

    QUESTION = "a spec; or `of`, the id of an earlier job, with the entries that change"
    FRONT = "`of`, the id of a job that has found a front; `family` where it compares several"
    DESIGNS = "`of`, the id of a job that has found a front; or a design: a spec with `values`"
    ROWS = "`upload` or `rows`, and what is asked of all rows"
    BATCH = "`of`, the id of a batch that is done"


EARLIER = RequestField(
    OF,
    ValueKind(TEXT, text("the id of a job that has ended")),
    "Id of an earlier job, whose question is taken with the entries that stand here.",
    examples=(JOB,),
)
BATCH_DONE = RequestField(
    OF,
    ValueKind(TEXT, text("the id of a batch")),
    "Id of a batch that is done.",
    examples=(JOB,),
    needed="the id of a batch",
)


@dataclass(frozen=True)
class Verb:
    """A verb that can be asked as a job.

    Parameters
    ----------
    name : str
    title : str
        One line for people.
    about : Subject
    request : type
        What it takes beside its subject.
    """

    name: str
    title: str
    about: Subject
    request: type[VerbRequest]

    def subject(self) -> Mapping[str, RequestField]:
        """Fields that name what it is about."""
        if self.about is Subject.QUESTION:
            return {**{name: JOB_FIELDS[name] for name in SPEC}, OF: EARLIER}
        if self.about in (Subject.FRONT, Subject.DESIGNS):
            return FrontRequest.fields()
        return {OF: BATCH_DONE} if self.about is Subject.BATCH else {}

    def fields(self) -> dict[str, RequestField]:
        """All fields of its request as a job, by name."""
        return {**self.subject(), **self.request.fields()}

    def schema(self) -> Schema:
        """JSON Schema of its request as a job."""
        either = {Subject.QUESTION: ("family", OF), Subject.ROWS: ("upload", "rows")}.get(self.about, ())
        schema = schema_of(f"{self.title}.", self.fields(), either=either)
        of_one = {name: one for name, one in self.request.fields().items() if name != "design"}
        return {"anyOf": [schema, design_schema(**of_one)]} if self.about is Subject.DESIGNS else schema


def _verbs(*verbs: Verb) -> Mapping[str, Verb]:
    return MappingProxyType({verb.name: verb for verb in verbs})


VERBS: Mapping[str, Verb] = _verbs(
    Verb("synthesis", "Ranked Pareto designs for a requirement", Subject.QUESTION, SynthesisRequest),
    Verb("compare", "Several families asked the same", Subject.QUESTION, CompareRequest),
    Verb(
        "whatif",
        "A question at many values of a requirement, limit, weight, part or option",
        Subject.QUESTION,
        WhatIfRequest,
    ),
    Verb("explain", "Why nothing is feasible, and what would make it so", Subject.QUESTION, ExplainRequest),
    Verb("prices", "What a per cent of each requirement and limit costs", Subject.FRONT, PricesRequest),
    Verb("near_equals", "Other parts, counts or choices that are nearly as good", Subject.FRONT, NearEqualsRequest),
    Verb("rate", "How designs stand what scatters", Subject.DESIGNS, RateRequest),
    Verb("verify", "A front checked again without the search", Subject.FRONT, VerifyRequest),
    Verb("report", "The report of a front, with calculation sheets", Subject.FRONT, FrontReportRequest),
    Verb("batch", "A table of requirements, answered row by row", Subject.ROWS, BatchRequest),
    Verb("size_range", "A few variants that serve a whole table of applications", Subject.BATCH, SizeRangeRequest),
)
