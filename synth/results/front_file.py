"""front.json: the types by which it is checked when it is read, and of which its JSON schema is made."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated, Any, Literal

import msgspec

from synth.order.feasibility import Status
from synth.results.front_record import FRONT_FORMAT
from synth.results.least_infeasible import LeastInfeasible
from synth.results.next_row import NextRow
from synth.results.ratings import DesignRating
from synth.results.record import UNSET, Number, Unset
from synth.results.search_record import SettingsRecord
from synth.results.statistics import SearchStatistics

MOST_DIGITS = 17  # that tell any number apart from its neighbours

Numbers = Mapping[str, Number]
Texts = Mapping[str, str]


class PartEntry(msgspec.Struct, frozen=True, kw_only=True):
    """A row of a part table; it has the columns of its table too, in SI."""

    designation: str
    table: str
    hash: str
    units: Texts = {}


class DesignEntry(msgspec.Struct, frozen=True, kw_only=True):
    """A design of a front; the docstring of :class:`synth.results.Design` says what its fields mean."""

    rank: int
    group: int | None = None
    score: float
    status: Status
    gap: float | None
    note: str
    alternatives: tuple[str, ...]
    objectives: Numbers
    values: Numbers
    choices: Texts
    parts: Texts
    rows: tuple[str, ...] = ()
    limits: Mapping[str, tuple[Number, Number]]
    residuals: Numbers
    utilisation: Numbers
    elasticity: Mapping[str, Numbers]
    off_grid: Texts
    advice: tuple[str, ...]
    violated: tuple[str, ...]
    not_checked: tuple[str, ...]
    outside: Texts = {}
    steps: Numbers = {}
    next_rows: Mapping[str, NextRow] = {}
    digits: Annotated[int, msgspec.Meta(ge=0, le=MOST_DIGITS)] | None = None
    robust: DesignRating = msgspec.field(default_factory=DesignRating)


class CertificateEntry(msgspec.Struct, frozen=True, kw_only=True):
    """How far a front is proven: :class:`synth.results.certificate.Certificate`."""

    kind: str
    gap: Number
    combinations: int
    excluded_by_bound: int
    solved: int
    unresolved: int = 0
    budget: float | None = None
    resolution: Mapping[str, float] = {}
    units: Texts = {}


class FrontFile(msgspec.Struct, frozen=True, kw_only=True):
    """The content of a front.json; quantities in SI, ``units`` are those in which people read them."""

    format: Annotated[int, msgspec.Meta(ge=FRONT_FORMAT, le=FRONT_FORMAT)]
    family: str
    title: str
    options: Texts
    requirements: Texts
    requirement_values_si: Mapping[str, float]
    not_asked: tuple[str, ...]
    objectives: Mapping[str, Literal["min", "max"]]
    units: Texts
    kinds: Texts
    limit_units: Texts
    limit_senses: Texts
    restated: Mapping[str, Any]
    headline: tuple[str, ...] = ()
    sized_by: str = ""
    tables: Texts = {}
    settings: SettingsRecord
    versions: Texts = {}
    status: Status
    interrupted: str
    complete: bool
    certificate: CertificateEntry
    statistics: SearchStatistics
    explanation: LeastInfeasible | None
    parts: Mapping[str, PartEntry]
    scale: Mapping[str, tuple[float, float]] | Unset = UNSET
    calculation: str = ""
    designs: tuple[DesignEntry, ...]
    result: str = ""
    digest: str = ""


def front_schema() -> dict[str, Any]:
    """JSON schema of front.json."""
    return {"$schema": "https://json-schema.org/draft/2020-12/schema", **msgspec.json.schema(FrontFile)}
