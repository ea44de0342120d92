"""What tables and sentences say of designs that were rated over a range."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from typing import TYPE_CHECKING, Any

from synth.text.numbers import DIGITS, percent
from synth.units import finite_from_si, header, typed_quantity

if TYPE_CHECKING:
    from synth.results.design import Design

COLUMNS = ("robust", "proof", "yield", "yield low", "yield high", "worst limit", "worst utilisation", "worst at")


def shown_at(at: Mapping[str, float], units: Mapping[str, str]) -> str:
    """Return values of what scatters in words.

    Examples
    --------
    >>> shown_at({"friction": 0.08, "length": 0.0995}, {"friction": "-", "length": "mm"})
    'friction 0.08, length 99.5 mm'
    """
    return ", ".join(f"{name} {typed_quantity(value, units[name], 5)}" for name, value in at.items())


def yield_percent(share: float) -> float:
    """Return a yield in per cent, rounded down: what is not all is never shown as all.

    Examples
    --------
    >>> yield_percent(1.0), yield_percent(0.99999), yield_percent(0.4846)
    (100.0, 99.99, 48.46)
    """
    return math.floor(1e4 * share) / 100 if share < 1 else 100.0


def yield_text(share: float) -> str:
    """Return a yield for people.

    Examples
    --------
    >>> yield_text(1.0), yield_text(0.99999)
    ('100 %', '99.99 %')
    """
    return percent(yield_percent(share) / 100, DIGITS)


def rating_row(design: Design) -> list[Any]:
    """Cells under ``COLUMNS``; empty for a design that was not rated."""
    rating = design.robust
    if not rating:
        return [None] * len(COLUMNS)
    return [
        rating["verdict"],
        rating["proof"],
        rating["yield"],
        rating["yield_low"],
        rating["yield_high"],
        rating["worst_limit"],
        rating["worst_utilisation"],
        shown_at(rating["worst_at"], rating["units"]),
    ]


def limits_table(designs: Sequence[Design]) -> tuple[list[str], list[list[Any]]]:
    """Return headers and rows of robust.csv: every limit of every design at its worst point of the range."""
    units: dict[str, str] = {n: unit for d in designs if d.robust for n, unit in d.robust["units"].items()}
    columns = ["rank", "limit", "robust", "proof", "value", "limit value", "unit", "utilisation", "residual"]
    columns += [f"worst at: {header(name, unit)}" for name, unit in units.items()]
    rows: list[list[Any]] = []
    for design in designs:
        for name, verdict in (design.robust.get("limits") or {}).items():
            unit = design.frame.limit_units[name]
            sides = [finite_from_si(verdict[k], unit, None) for k in ("value", "limit")]
            at = [finite_from_si(verdict["at"][n], u, None) if n in verdict["at"] else None for n, u in units.items()]
            rows.append(
                [
                    design.rank,
                    name,
                    verdict["verdict"],
                    verdict["proof"],
                    *sides,
                    unit,
                    verdict["utilisation"],
                    verdict["residual"],
                    *at,
                ]
            )
    return columns, rows


def robust_sentence(designs: Iterable[Design]) -> str:
    """Return in words how designs stand the range."""
    rated = [d.robust for d in designs if d.robust]
    if not rated:
        return "no design was rated"
    holding = sum(rating["holds"] is True for rating in rated)
    unknown = sum(rating["holds"] is None for rating in rated)
    of = "1 design" if len(rated) == 1 else f"{len(rated)} designs"
    searched = f"no violation was found, from the corners and {rated[0]['samples']} samples on, and none is excluded"
    if len(rated) == 1 and not holding:
        if unknown:
            return f"not shown that the design keeps all limits over the whole range: {searched}"
        return "the design does not keep all limits over the whole range"
    keeps = ("keeps" if holding == 1 else "keep") if holding else "is shown to keep" if unknown else "keeps"
    sentence = f"{holding or 'none'} of {of} {keeps} all limits over the whole range{' (proven)' if holding else ''}"
    return f"{sentence}; not shown of {unknown}: {searched}" if unknown else sentence


def removed_sentence(count: int) -> str:
    """Return in words how many designs are missing because they do not stand the range."""
    designs = "1 design was" if count == 1 else f"{count} designs were"
    return f"{designs} taken off: not all limits hold over the whole range"
