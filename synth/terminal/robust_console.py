"""What the command line shows of designs that were rated over a range."""

from __future__ import annotations

from typing import TYPE_CHECKING

from synth.question.uncertainty import LIMITS
from synth.results import Design
from synth.results.rating_tables import removed_sentence, robust_sentence, shown_at, yield_text
from synth.terminal.console import plain_table, print_wrapped
from synth.text.numbers import used_share

if TYPE_CHECKING:
    from collections.abc import Sequence

    from rich.console import Console

    from synth.results import ParetoFront
    from synth.robust.rate import Ratings

SHOWN = 20


def print_ratings(found: Ratings, console: Console) -> None:
    """Print a line per design: whether it is shown to keep its limits, its yield, its worst limit and where that is."""
    if found.designs:
        frame = found.designs[0].frame
        console.print(f"{frame.title} ({frame.family}): {_scatter(found)}")
        console.print()
        print_designs(found.designs, console)
        console.print()
    if found.interrupted:
        console.print(f"stopped: {found.interrupted}; {found.missing} designs are not rated")
    print_wrapped(console, found.sentence())


def print_robust(front: ParetoFront, console: Console) -> None:
    """Print how the designs of a front stand the range that was asked."""
    told, gone = front.settings["robust"], front.statistics["robust"].get("taken_off", 0)
    console.print()
    if front.designs:
        print_designs(front.designs, console)
        console.print()
        print_wrapped(console, robust_sentence(front.designs))
    if gone:
        console.print(removed_sentence(gone))
    if front.designs and told["mode"] == LIMITS and front.certificate.kind == "global":
        console.print("what is proven below counts for all designs that keep their limits over the whole range")


def print_designs(designs: Sequence[Design], console: Console) -> None:
    """Print a line per rated design."""
    rated = [d for d in designs if d.robust]
    table = plain_table("", "robust", "proof", "yield", "interval", "used", "worst limit", right=(3, 5), wide=6)
    for design in rated[:SHOWN]:
        told = design.robust
        used = "" if told["worst_utilisation"] is None else used_share(float(told["worst_utilisation"]))
        where = shown_at(told["worst_at"], told["units"])
        table.add_row(
            f"#{design.rank}" if design.rank else "",
            told["verdict"],
            told["proof"],
            yield_text(told["yield"]),
            f"{yield_text(told['yield_low'])} .. {yield_text(told['yield_high'])}",
            used,
            f"{told['worst_limit']}{' at ' if where else ''}{where}",
        )
    console.print(table)
    if len(rated) > SHOWN:
        console.print(f"{len(rated) - SHOWN} more in the files that -o writes")


def _scatter(found: Ratings) -> str:
    asked = {k: v for k, v in found.asked.items() if isinstance(v, str) and k != "mode"}
    asked |= dict(found.asked.get("tolerance", {}))
    return ", ".join(f"{name} {text}" for name, text in asked.items())
