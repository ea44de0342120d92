"""What the command line shows of a study: the steps, the break points, and how far both are proven."""

from __future__ import annotations

from typing import TYPE_CHECKING

from synth.question.uncertainty import RATE
from synth.robust.rate import taken_off, told_of
from synth.studies.whatif.study_answers import Break, Composition, StudyStep, best_design
from synth.terminal.console import plain_table
from synth.terminal.robust_console import percent
from synth.units import format_quantity

if TYPE_CHECKING:
    from rich.console import Console

    from synth.studies.whatif.study import Study
    from synth.studies.whatif.vary import Varied

MOST_ROWS = 40
MOST_BREAKS = 20
MOST_REASONS, MOST_PLACES = 8, 4


def print_study(study: Study, console: Console) -> None:
    """Print a line per step with the best of each objective, the break points, and what is proven."""
    title = study.fronts[0].frame.title if study.fronts else ""
    varied = " and ".join(x.label for x in study.varied)
    console.print(f"{title}{': ' if title else ''}{varied}, {len(study.steps)} steps")
    for x in study.varied:
        if x.remark:
            console.print(f"{x.label}: {x.remark}")
    console.print()
    names = list(study.objectives())
    rates = any(f.settings.get("robust", {}).get("mode") == RATE for f in study.fronts)
    heads = [*(x.label for x in study.varied), "designs", *(f"best {n}" for n in names)]
    heads += [*(["yield"] if rates else []), "of the leading design"]
    last = len(heads) - 1
    table = plain_table(*heads, right=range(len(study.varied), last), wide=last)
    for step in study.steps[:MOST_ROWS]:
        table.add_row(*_row(study, step, names, rates))
    console.print(table)
    if len(study.steps) > MOST_ROWS:
        console.print(f"{len(study.steps) - MOST_ROWS} more in whatif.csv")
    console.print()
    _print_reasons(study, console)
    if study.breaks:
        _print_breaks(study, console)
    if study.interrupted:
        done = sum(s.front is not None for s in study.steps)
        console.print(f"stopped: {study.interrupted}; {done} of {len(study.steps)} steps are kept, run again to go on")
    for line in _robust(study):
        console.print(line)
    console.print(_proven(study))


def _row(study: Study, step: StudyStep, names: list[str], rates: bool) -> list[str]:
    cells = [x.shown(v) for x, v in zip(study.varied, step.values, strict=True)]
    if step.front is None or not step.front.designs:
        return [
            *cells,
            "0",
            *("" for _ in names),
            *([""] if rates else []),
            "not reached" if step.front is None else "-",
        ]
    frame, leader = step.front.frame, step.front.designs[0]
    best = [(n, best_design(step.front, n)) for n in names]
    cells.append(str(len(step.front.designs)))
    cells += [
        "" if d is None or n not in frame.units else format_quantity(d.values[n], frame.units[n], 5) for n, d in best
    ]
    if rates:
        cells.append(percent(leader.robust["yield"]) if leader.robust else "")
    made = Composition.of(leader, names[0])
    words = [*made.parts.values(), *(f"{n} {v:g}" for n, v in made.counts.items()), *made.choices.values()]
    return [*cells, ", ".join(words)]


def _print_reasons(study: Study, console: Console) -> None:
    """Print why steps have no design, those with the same reason together."""
    reasons: dict[str, list[StudyStep]] = {}
    for step in study.steps:
        if step.front is not None and not step.front.designs:
            reasons.setdefault(step.brief_reason, []).append(step)
    for reason, steps in list(reasons.items())[:MOST_REASONS]:
        places = [", ".join(x.shown(v) for x, v in zip(study.varied, s.values, strict=True)) for s in steps]
        shown = places if len(places) <= MOST_PLACES else [*places[:MOST_PLACES], f"{len(places) - MOST_PLACES} more"]
        console.print(f"no design at {'; '.join(shown)}: {reason}")
    if len(reasons) > MOST_REASONS:
        console.print(f"{len(reasons) - MOST_REASONS} more reasons in whatif.csv")
    if reasons:
        console.print()


def _print_breaks(study: Study, console: Console) -> None:
    assert study.along is not None
    along = study.varied[study.along]
    others = [x for k, x in enumerate(study.varied) if k != study.along]
    table = plain_table("break in", *(x.label for x in others), along.label, "change", "proven", wide=len(others) + 2)
    for b in study.breaks[:MOST_BREAKS]:
        table.add_row(b.objective, *(x.shown(v) for x, v in zip(others, b.others, strict=True)), *_told(b, along))
    console.print(table)
    if len(study.breaks) > MOST_BREAKS:
        console.print(f"{len(study.breaks) - MOST_BREAKS} more in breaks.csv")
    console.print()


def _told(b: Break, along: Varied) -> list[str]:
    return [
        along.shown(float(f"{b.value:.5g}")),
        b.change,
        "yes" if b.proven else f"no{': ' if b.remark else ''}{b.remark}",
    ]


def _robust(study: Study) -> list[str]:
    """Return how the designs of all steps stand what scatters, where anything does."""
    blocks = [f.settings["robust"] for f in study.fronts if "robust" in f.settings]
    if not blocks:
        return []
    designs = [d for f in study.fronts for d in f.designs]
    lines = [told_of(designs, blocks[0]["samples"])] if any(d.robust for d in designs) else []
    gone = sum(f.statistics["robust"].get("taken_off", 0) for f in study.fronts if "robust" in f.settings)
    if gone:
        lines.append(taken_off(gone))
    return lines


def _proven(study: Study) -> str:
    kinds = [front.certificate.kind for front in study.fronts]
    if len(kinds) == len(study.steps) and all(kind == "global" for kind in kinds):
        return "proven: every step over all its combinations of parts and counts (certificate and gap in whatif.csv)"
    return f"{kinds.count('global')} of {len(study.steps)} steps are proven; the certificates stand in whatif.csv"
