"""Whether a front that was read from a file is a front at all: the first thing that verification asks of it.

Types were checked when the file was read (:mod:`synth.results.front_file`). What passes can be evaluated, compared and
proven without a thought of how it was written; whatever fails later is a fault of the program.
"""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING

from synth.errors import InputError
from synth.results.record import FileRecord
from synth.units import parse_unit

if TYPE_CHECKING:
    from synth.results import Design, ParetoFront

SENSES = ("min", "max")

# What verification reads of records whose fields may all be missing.
SETTINGS = ("points", "grid", "weights", "parts", "limits", "fix")
ROBUST = ("holds", "proof", "worst_limit", "worst_at", "units", "limits")
LIMIT = ("holds", "proof", "value", "limit", "utilisation", "residual", "at")


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
    yield from _missing(front.settings, SETTINGS, "settings")
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
    if design.rank is None or design.score is None:
        yield f"{label}: it has no rank or no score"
    for name in (*frame.kinds, *frame.objectives):
        if name not in design.values:
            yield f"{label}: {name} has no value"
    for slot, row in design.parts.items():
        if not isinstance(row.get("designation"), str):
            yield f"{label}: {slot} has no designation"
    rating = design.robust
    if not rating:
        return
    yield from _missing(rating, ROBUST, f"{label}: robust")
    yield from _without_units(rating["worst_at"], rating["units"], f"{label}: robust")
    for name, limit in rating["limits"].items():
        yield from _missing(limit, LIMIT, f"{label}: robust {name}")
        yield from _without_units({name: limit}, frame.limit_units, "limit_units")


def _without_units(names: Mapping[str, object], units: Mapping[str, str], place: str) -> Iterator[str]:
    for name in names:
        if name not in units:
            yield f"{place}: {name} is missing"
    for name, unit in units.items():
        try:
            parse_unit(unit)
        except InputError:
            yield f"{place}: {name} is in {unit!r}"


def _missing(record: FileRecord, keys: tuple[str, ...], place: str) -> Iterator[str]:
    for key in keys:
        if key not in record:
            yield f"{place}: {key} is missing"
