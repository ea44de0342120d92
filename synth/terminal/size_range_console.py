"""What the command line shows of a size range."""

from __future__ import annotations

from typing import TYPE_CHECKING

from synth.terminal.console import output, plain_table
from synth.text.numbers import gap_text, number_text
from synth.text.plain_text import counted

if TYPE_CHECKING:
    from synth.variants.size_range import SizeRange


def print_size_range(found: SizeRange) -> None:
    """Print the variants of a size range, and how good it is."""
    rows = counted(found.statistics["rows_served"], "row")
    print(f"{counted(len(found.variants), 'variant')} for {rows}")
    excess = f"{number_text(found.cost)}{'' if found.unit == '-' else f' {found.unit}'}"
    print(f"total excess of {found.objective} over each row's own best: {excess}, proven to {gap_text(found.gap)}")
    fewest = "the fewest that serve all" if found.fewest_proven else "the fewest found that serve all"
    print(f"{fewest}: {found.fewest}")
    for family, names in found.taken_from_row.items():
        print(f"{family}: {', '.join(names)} is each row's own, no part of a variant")
    if found.variants:
        names = [name for name in found.variants[0] if name not in ("total_excess",)][:4]
        table = plain_table(*(name.split(" [")[0] for name in names), "design", right=(0, 2, 3), wide=len(names))
        for variant in found.variants:
            rest = [f"{_short(n, v)}" for n, v in list(variant.items())[len(names) :] if v is not None]
            table.add_row(*(_figure(variant[n]) for n in names), ", ".join(rest))
        output().print(table)
    if found.unserved:
        print(f"{counted(len(found.unserved), 'row')} not served; unserved.csv says why")


def _figure(value: object) -> str:
    return number_text(value) if isinstance(value, float) else str(value)


def _short(heading: str, value: object) -> str:
    name, _, unit = heading.partition(" [")
    unit = unit.removesuffix("]")
    return f"{name} {_figure(value)}{'' if unit in ('', '-') else f' {unit}'}"
