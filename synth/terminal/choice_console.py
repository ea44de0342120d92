"""What the command line shows of near-equal designs, of prices, and of families that are compared."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from rich.console import Console

from synth.results.drawings import report
from synth.results.rating_tables import robust_sentence
from synth.studies.prices.price_list import NOTHING
from synth.studies.settings import COMPARING
from synth.terminal.console import explanation_text, named_file, plain_table, print_wrapped
from synth.terminal.plots import show_plot
from synth.text.numbers import column_texts, percent, signed, typed_number
from synth.text.plain_text import counted, words
from synth.units import finite_from_si, in_words, unit_text

if TYPE_CHECKING:
    from synth.results import ParetoFront
    from synth.studies.families.comparison import Comparison
    from synth.studies.near_optimal import NearEquals
    from synth.studies.prices.price_list import Price, Prices

SHOWN = 10  # designs on one screen
CHANGE = len(" (+1.23 %)")  # characters of a change behind a value


def print_near_equals(found: NearEquals, console: Console) -> None:
    """Print how many designs there are nearly as good, and those that differ most."""
    own, frame = found.reference, found.reference.frame
    names = list(frame.objectives)
    console.print(f"{frame.title} ({frame.family}): near-equals of design {own.rank or ''}".rstrip())
    console.print()
    headings = [f"{words(n)} [{unit_text(frame.units[n])}]".removesuffix(" []") for n in names]
    table = plain_table("", *headings, "differences", right=range(1, len(names) + 1), wide=len(names) + 1)
    columns = [
        column_texts([finite_from_si(d.values[n], frame.units[n], None) for d in (own, *found.designs)]) for n in names
    ]
    table.add_row("#0", *(f"{cells[0]}{' ' * CHANGE}" for cells in columns), "the chosen design")
    for k, (design, change, rank) in enumerate(zip(found.designs, found.changes, found.ranks, strict=True), start=1):
        moved = [f"({signed(round(100 * change[n], 2))} %)" for n in names]
        values = [f"{cells[k]} {by:>{CHANGE - 1}}" for cells, by in zip(columns, moved, strict=True)]
        other = in_words(", ".join(found.differences[k - 1]), design.names)
        table.add_row(f"#{k}", *values, other if rank is None else f"design {rank} of the front: {other}")
    console.print(table)
    console.print()
    if found.interrupted:
        console.print(f"stopped: {found.interrupted}; what was found until then is shown")
    print_wrapped(console, found.sentence())
    if len(found.designs) < found.found:
        shown = f"shown are {len(found.designs)} that differ most from the chosen one and from each other"
        print_wrapped(console, shown)


def print_prices(found: Prices, front: ParetoFront, console: Console, every: bool, kept: bool) -> None:
    """Print what a per cent costs in each objective, the dearest first, and what costs nothing.

    ``every``: of all designs; ``kept``: whether they are written as well.
    """
    frame, size = found.frame, percent(found.step)
    shown = found.finished if every else found.finished[:1]
    named = front.designs[0].names
    for rank in shown:
        console.print(f"{frame.title} ({frame.family}): prices of design {rank}")
        for objective in frame.objectives:
            rows = [r for r in found.rows if (r.design, r.objective) == (rank, objective)]
            console.print()
            table = plain_table(words(objective), "up", "down", "status", "why", right=(1, 2), wide=4)
            for row in sorted((r for r in rows if r.status != NOTHING), key=_dearness, reverse=True):
                reason = in_words(row.reason, named)
                table.add_row(_priced(row), _shown(row.up), _shown(row.down), row.status, reason)
            console.print(table)
            idle = sum(r.status == NOTHING for r in rows)
            if idle:
                have = "requirement or limit has" if idle == 1 else "requirements and limits have"
                console.print(f"{idle} more {have} no influence ({named_file('prices.csv', kept)})")
            for compared in dict.fromkeys(r.compared for r in rows if r.compared):
                print_wrapped(console, f"other parts: {compared}" if "combinations" in compared else compared)
        console.print()
    if len(shown) < len(found.finished):
        more = len(found.finished) - len(shown)
        console.print(f"{counted(more, 'more design')} with --all, and in {named_file('prices.csv', kept)}")
    up_and_down = f"up: per cent of the objective per per cent more, down: per per cent less; tried with {size}"
    print_wrapped(console, up_and_down)
    held = ["the other objectives are held"] if len(frame.objectives) > 1 else []
    held += ["makeable sizes are taken as continuous"] if found.makeable else []
    if held:
        console.print("; ".join(held))
    if found.interrupted:
        done, asked = len(found.finished), len(found.asked)
        state = "kept, run again to go on" if kept else "finished"
        console.print(f"stopped: {found.interrupted}; {done} of {asked} designs are {state}")


def _priced(row: Price) -> str:
    return f"limit {words(row.quantity)}" if row.kind == "limit" else words(row.quantity)


def _dearness(row: Price) -> float:
    return max(round(abs(x), 4) if x is not None else -1.0 for x in (row.up, row.down))


def _shown(price: float | None) -> str:
    return "withheld" if price is None else signed(price)


def print_comparison(found: Comparison, console: Console, every: bool = False, plot: bool = False) -> None:
    """Print the common front, what became of each family, and how far it is proven; draw it where that is asked."""
    if found.designs:
        (report("comparison_table") or _plain_common_front)(found, console, every)
        console.print()
    if plot:
        show_plot(found.designs, found.objectives, console, found.families)
        console.print()
    table = plain_table("family", "outcome", "why", wide=2)
    for outcome in found.outcomes:
        table.add_row(outcome.family, outcome.outcome, outcome.sentence)
    console.print(table)
    console.print()
    for name in found.objectives:
        meanings: dict[str, list[str]] = {}
        for x in found.outcomes:
            if x.meanings.get(name) and x.outcome not in ("refused", "not_covered"):
                meanings.setdefault(x.meanings[name], []).append(x.family)
        if len(meanings) > 1:
            told_of_each = "; ".join(f"{text} ({', '.join(families)})" for text, families in meanings.items())
            print_wrapped(console, f"{words(name)} means: {told_of_each}")
    for sentence in found.not_compared:
        print_wrapped(console, sentence)
    told = [d for d in found.designs if d.robust]
    if told:
        print_wrapped(console, robust_sentence(told))
        unrated = len(found.designs) - len(told)
        if unrated:
            designs = "1 design is" if unrated == 1 else f"{unrated} designs are"
            console.print(f"{designs} not rated: in the family nothing scatters")
    if found.interrupted:
        console.print(f"stopped: {found.interrupted}; what was found until then is shown")
    print_wrapped(console, found.sentence())


def _plain_common_front(found: Comparison, console: Console, every: bool) -> None:
    """Print ranks, families and objectives, where reports are not installed."""
    shown = found.to_frame() if every else found.to_frame().head(SHOWN)
    names = [c for c in shown.columns if c.split(" [")[0] in ("rank", "family", *found.objectives)]
    console.print(shown[names].to_string(index=False))


def how_long(families: Sequence[str], time_limit: float | None) -> str:
    """Time that a comparison takes, and what stops it."""
    count, seconds = len(families), typed_number(COMPARING.budget if time_limit is None else time_limit)
    spent = f"They share {seconds} s, those with the fewest combinations first" if count > 1 else f"It has {seconds} s"
    stops = "Ctrl-C keeps what is found" + ("" if time_limit is not None else "; --time-limit gives more time")
    who = "1 family serves" if count == 1 else f"{count} families serve"
    return f"{who} this sheet: {', '.join(families)}. {spent}. {stops}."


def comparison_explanation(found: Comparison) -> str:
    """Return in words why no family has a feasible design."""
    parts = []
    for outcome in found.outcomes:
        explained = outcome.outcome in ("infeasible", "not_found")
        told = explanation_text(outcome.front) if explained and outcome.front else outcome.sentence
        parts.append(f"{outcome.family} ({outcome.outcome})\n{told.rstrip()}\n")
    return "\n".join(parts)
