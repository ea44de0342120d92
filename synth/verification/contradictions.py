"""Whether a front that was read from a file is a front at all: the first thing that verification asks of it.

The types are those of the records of :mod:`synth.results`, read from their annotations. What passes can be evaluated,
compared and proven without a thought of how it was written; whatever fails later is a fault of the program.
"""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, fields, is_dataclass
from types import UnionType
from typing import TYPE_CHECKING, Any, Union, get_args, get_origin, get_type_hints

from synth.errors import InputError
from synth.results.told import Told
from synth.units import parse_unit

if TYPE_CHECKING:
    from synth.results import Design, ParetoFront

SENSES = ("min", "max")


@dataclass(frozen=True)
class _Settings:
    """What verification reads of the settings of a search; what is asked in words is read by the question itself."""

    points: int
    grid: bool
    weights: Mapping[str, float]
    parts: Mapping[str, Any]
    limits: Mapping[str, Any]
    fix: Mapping[str, Any]


@dataclass(frozen=True)
class _LimitOfRange:
    """How a limit stands the range of what scatters, as ``robust`` of a design tells it."""

    holds: bool | None
    proof: str
    value: float | None
    limit: float | None
    utilisation: float | None
    residual: float | None
    at: Mapping[str, float]


@dataclass(frozen=True)
class _Robust:
    """How a design stands the range, as its ``robust`` tells it."""

    holds: bool | None
    proof: str
    worst_limit: str | None
    worst_at: Mapping[str, float]
    units: Mapping[str, str]
    limits: Mapping[str, Any]


def contradiction(front: ParetoFront) -> str:
    """Return the first thing by which a front that was read from a file is none; nothing where it is one.

    Parameters
    ----------
    front : ParetoFront
        From ``load_front`` or ``unchecked_front``.

    Returns
    -------
    str
        Where it is, and what.
    """
    return next(_contradictions(front), "")


def _contradictions(front: ParetoFront) -> Iterator[str]:
    try:
        json.dumps(front.record, allow_nan=False, ensure_ascii=False).encode("utf-8")
    except (ValueError, RecursionError) as error:
        yield str(error)
    frame, certificate = front.frame, front.certificate
    yield from _misfits(vars(front), type(front), "the front")
    yield from _misfits(vars(frame), type(frame), "the front")
    yield from _misfits(vars(certificate), type(certificate), "certificate")
    yield from _misfits(front.settings, _Settings, "settings")
    yield from _without_units({**frame.kinds, **frame.objectives}, frame.units, "units")
    yield from _without_units(frame.limit_senses, frame.limit_units, "limit_units")
    yield from _without_units(certificate.resolution, certificate.units, "units of the certificate")
    for name, sense in frame.objectives.items():
        if sense not in SENSES:
            yield f"objectives: {name} is {sense!r}"
    if not all(weight >= 0 for weight in front.settings["weights"].values()):
        yield "settings: a weight is negative"
    if not sum(front.settings["weights"].get(name, 1.0) for name in frame.objectives) > 0 < len(frame.objectives):
        yield "settings: no objective has a weight"
    for k, design in enumerate(front.designs, 1):
        yield from _of_design(design, f"design {k}")


def _of_design(design: Design, label: str) -> Iterator[str]:
    frame = design.frame
    yield from _misfits(vars(design), type(design), label)
    if design.rank is None or design.score is None:
        yield f"{label}: it has no rank or no score"
    for name in (*frame.kinds, *frame.objectives):
        if name not in design.values:
            yield f"{label}: {name} has no value"
    for slot, row in design.parts.items():
        if not isinstance(row.get("designation"), str):
            yield f"{label}: {slot} has no designation"
    told = design.robust
    if not told:
        return
    yield from _misfits(told, _Robust, f"{label}: robust")
    yield from _without_units(told["worst_at"], told["units"], f"{label}: robust")
    for name, limit in told["limits"].items():
        yield from _misfits(limit, _LimitOfRange, f"{label}: robust {name}")
        yield from _without_units({name: limit}, frame.limit_units, "limit_units")


def _without_units(names: Mapping[str, Any], units: Mapping[str, str], place: str) -> Iterator[str]:
    for name in names:
        if name not in units:
            yield f"{place}: {name} is missing"
    for name, unit in units.items():
        try:
            parse_unit(unit)
        except InputError:
            yield f"{place}: {name} is in {unit!r}"


def _misfits(values: Any, record: type, place: str) -> Iterator[str]:
    """Yield the fields of a record whose values are not of its types."""
    hints = get_type_hints(record)
    if not isinstance(values, Mapping):
        yield f"{place}: not names with values"
        return
    for own in fields(record):
        if own.name not in values:
            yield f"{place}: {own.name} is missing"
        elif not _fits(values[own.name], hints[own.name]):
            yield f"{place}: {own.name} is {values[own.name]!r:.60}"


def _fits(value: Any, hint: Any) -> bool:
    """True if a value that was read from JSON is of a type.

    Examples
    --------
    >>> _fits({"a": 1}, Mapping[str, float]), _fits({"a": "1"}, Mapping[str, float])
    (True, False)
    >>> _fits(None, float | None), _fits(True, int), _fits((1.0, 2.0), tuple[float, float])
    (True, False, True)
    """
    kind, inner = get_origin(hint), get_args(hint)
    if isinstance(hint, type) and issubclass(hint, Told):
        return _fits(value, Mapping[str, Any])
    if hint is Any or is_dataclass(hint):  # those are looked at by themselves
        return True
    if kind in (Union, UnionType):
        return any(_fits(value, one) for one in inner)
    if kind is None:
        if isinstance(value, bool):
            return hint is bool
        return isinstance(value, (int, float) if hint is float else hint)
    if not isinstance(value, kind):
        return False
    if issubclass(kind, Mapping):
        return all(_fits(name, inner[0]) and _fits(own, inner[1]) for name, own in value.items())
    if kind is tuple and inner[-1] is not Ellipsis:
        return len(value) == len(inner) and all(_fits(own, one) for own, one in zip(value, inner, strict=True))
    return all(_fits(own, inner[0]) for own in value)
