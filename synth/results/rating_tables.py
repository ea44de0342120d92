"""What tables say of designs that were rated over a range: a few columns per design, and a row per limit."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

from synth.units import finite_from_si, format_quantity, header

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
    return ", ".join(f"{name} {format_quantity(value, units[name], 5)}" for name, value in at.items())


def rating_row(design: Design) -> list[Any]:
    """Return what belongs under ``COLUMNS``; nothing of a design that was not rated."""
    told = design.robust
    if not told:
        return [None] * len(COLUMNS)
    return [
        "yes" if told["holds"] else "no",
        told["proof"],
        told["yield"],
        told["yield_low"],
        told["yield_high"],
        told["worst_limit"],
        told["worst_utilisation"],
        shown_at(told["worst_at"], told["units"]),
    ]


def limits_table(designs: Sequence[Design]) -> tuple[list[str], list[list[Any]]]:
    """Return headers and rows of robust.csv: every limit of every design at its worst point of the range."""
    units: dict[str, str] = {n: unit for d in designs if d.robust for n, unit in d.robust["units"].items()}
    columns = ["rank", "limit", "robust", "proof", "value", "limit value", "unit", "utilisation", "residual"]
    columns += [f"worst at: {header(name, unit)}" for name, unit in units.items()]
    rows: list[list[Any]] = []
    for design in designs:
        for name, told in (design.robust.get("limits") or {}).items():
            unit = design.frame.limit_units[name]
            sides = [finite_from_si(told[k], unit, None) for k in ("value", "limit")]
            at = [finite_from_si(told["at"][n], u, None) if n in told["at"] else None for n, u in units.items()]
            rows.append(
                [
                    design.rank,
                    name,
                    "yes" if told["holds"] else "no",
                    told["proof"],
                    *sides,
                    unit,
                    told["utilisation"],
                    told["residual"],
                    *at,
                ]
            )
    return columns, rows
