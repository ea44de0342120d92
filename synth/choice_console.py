"""What the command line shows of near-equal designs and of families that are compared."""

from __future__ import annotations

from typing import TYPE_CHECKING

from rich.console import Console

from synth.console import explanation_text, plain_table
from synth.units import format_quantity

if TYPE_CHECKING:
    from synth.comparison import Comparison
    from synth.near import NearEquals

SHOWN = 10  # designs on one screen


def print_near_equals(found: NearEquals, console: Console) -> None:
    """Print how many designs there are nearly as good, and those that differ most."""
    own, frame = found.reference, found.reference.frame
    names = list(frame.objectives)
    console.print(f"{frame.title} ({frame.family}): near-equals of design {own.rank or ''}".rstrip())
    console.print()
    table = plain_table("", *names, "differences", right=range(1, len(names) + 1), wide=len(names) + 1)
    table.add_row("#0", *(format_quantity(own.values[n], frame.units[n], 5) for n in names), "the chosen design")
    for number, (design, change, other) in enumerate(
        zip(found.designs, found.changes, found.differences, strict=True), start=1
    ):
        values = [f"{format_quantity(design.values[n], frame.units[n], 5)} ({100 * change[n]:+.2f} %)" for n in names]
        table.add_row(f"#{number}", *values, ", ".join(other))
    console.print(table)
    console.print()
    if found.interrupted:
        console.print(f"stopped: {found.interrupted}; what was found until then is shown and saved")
    console.print(found.sentence())
    if len(found.designs) < found.found:
        console.print(f"shown are {len(found.designs)} that differ most from the chosen one and from each other")


def print_comparison(found: Comparison, console: Console, every: bool = False) -> None:
    """Print the common front, what became of each family, and how far it is proven."""
    count = len(found.designs) if every else min(SHOWN, len(found.designs))
    names = list(found.objectives)
    if found.designs:
        number = "1 design" if len(found.designs) == 1 else f"{len(found.designs)} designs"
        families = len(set(found.families))
        console.print(f"{number} of {'1 family' if families == 1 else f'{families} families'}")
        console.print()
        table = plain_table(
            "rank", "score", "family", *names, "note", right=(1, *range(3, 3 + len(names))), wide=3 + len(names)
        )
        for design, family in list(zip(found.designs, found.families, strict=True))[:count]:
            values = [format_quantity(design.values[n], design.frame.units[n], 5) for n in names]
            table.add_row(f"#{design.rank}", f"{design.score:.4f}", family, *values, design.note)
        console.print(table)
        if count < len(found.designs):
            console.print(f"{len(found.designs) - count} more with --all, and in designs.csv")
        console.print()
    table = plain_table("family", "outcome", "why", wide=2)
    for outcome in found.outcomes:
        table.add_row(outcome.family, outcome.outcome, outcome.sentence)
    console.print(table)
    console.print()
    for name in names:
        meanings = {x.family: x.meanings[name] for x in found.outcomes if x.listed and x.meanings.get(name)}
        if len(set(meanings.values())) > 1:
            console.print(f"{name} means: " + "; ".join(f"{text} ({family})" for family, text in meanings.items()))
    if found.interrupted:
        console.print(f"stopped: {found.interrupted}; what was found until then is shown and saved")
    console.print(found.sentence())


def comparison_explanation(found: Comparison) -> str:
    """Return in words why no family has a feasible design."""
    parts = []
    for outcome in found.outcomes:
        told = (
            explanation_text(outcome.front) if outcome.outcome == "infeasible" and outcome.front else outcome.sentence
        )
        parts.append(f"{outcome.family} ({outcome.outcome})\n{told.rstrip()}\n")
    return "\n".join(parts)
