"""What the command line shows of a study: the steps, the break points, and how far both are proven."""

from __future__ import annotations

from typing import TYPE_CHECKING

from synth.question.uncertainty import RATE
from synth.results.rating_tables import removed_sentence, robust_sentence, yield_text
from synth.studies.whatif.study_answers import Break, Composition, StudyStep, best_design
from synth.terminal.console import in_common, made_of, named_file, plain_table, print_wrapped
from synth.text.numbers import column_texts
from synth.text.plain_text import words
from synth.units import finite_from_si, in_words, unit_text

if TYPE_CHECKING:
    from rich.console import Console
    from rich.table import Table

    from synth.results import Design
    from synth.studies.whatif.study import Study
    from synth.studies.whatif.vary import Varied

MOST_ROWS = 40
MOST_BREAKS = 20
MOST_REASONS, MOST_PLACES = 8, 4


def print_study(study: Study, console: Console, kept: bool) -> None:
    """Print a line per step with the best of each objective, the break points, and what is proven.

    ``kept``: whether it is written as well.
    """
    title = study.fronts[0].frame.title if study.fronts else ""
    varied = " and ".join(words(x.label) for x in study.varied)
    console.print(f"{title}{': ' if title else ''}{varied}, {len(study.steps)} steps")
    for x in study.varied:
        if x.remark:
            print_wrapped(console, f"{words(x.label)}: {in_words(x.remark, ())}")
    console.print()
    console.print(_steps(study))
    if len(study.steps) > MOST_ROWS:
        console.print(f"{len(study.steps) - MOST_ROWS} more in {named_file('whatif.csv', kept)}")
    console.print()
    shared = _shared(study)
    if shared:
        print_wrapped(console, f"#1 of every step: {made_of(shared)}")
        console.print()
    _print_reasons(study, console, kept)
    if study.breaks:
        _print_breaks(study, console, kept)
    if study.interrupted:
        done = sum(s.front is not None for s in study.steps)
        state = "kept, run again to go on" if kept else "finished"
        console.print(f"stopped: {study.interrupted}; {done} of {len(study.steps)} steps are {state}")
    for line in _robust(study):
        print_wrapped(console, line)
    print_wrapped(console, _proven(study, kept))


def _steps(study: Study) -> Table:
    """Return a row per step: what is varied, the best of each objective, and what the leading design is made of."""
    names = list(study.objectives())
    rates = any(f.settings.get("robust", {}).get("mode") == RATE for f in study.fronts)
    units = [next((f.frame.units[n] for f in study.fronts if n in f.frame.units), "-") for n in names]
    heads = [
        f"best {words(n)}{f' [{unit_text(u)}]' if unit_text(u) else ''}" for n, u in zip(names, units, strict=True)
    ]
    heads = [*(words(x.label) for x in study.varied), "designs", *heads, *(["yield"] if rates else []), "parts of #1"]
    last = len(heads) - 1
    table = plain_table(*heads, right=range(len(study.varied), last), wide=last)
    steps, shared = study.steps[:MOST_ROWS], _shared(study)
    best = [column_texts([_best(s, n, u) for s in steps]) for n, u in zip(names, units, strict=True)]
    for k, step in enumerate(steps):
        cells = [x.valued(v) for x, v in zip(study.varied, step.values, strict=True)]
        leader = step.front.designs[0] if step.front is not None and step.front.designs else None
        cells += [str(len(step.front.designs)) if step.front is not None else "0", *(column[k] for column in best)]
        if rates:
            cells.append(yield_text(leader.robust["yield"]) if leader is not None and leader.robust else "")
        if leader is None:
            cells.append("not reached" if step.front is None else "")
        else:
            own = {name: text for name, text in _made(leader).items() if name not in shared}
            cells.append(made_of(own) or "as all")
        table.add_row(*cells)
    return table


def _best(step: StudyStep, objective: str, unit: str) -> float | None:
    design = best_design(step.front, objective)
    return None if design is None else finite_from_si(design.values.get(objective), unit, None)


def _made(design: Design) -> dict[str, str]:
    """Return the parts, counts and choices of a design by name."""
    return Composition.of(design, next(iter(design.frame.objectives))).named


def _shared(study: Study) -> dict[str, str]:
    """Parts and counts that the leading designs of all steps share."""
    return in_common([_made(f.designs[0]) for f in study.fronts if f.designs])


def _print_reasons(study: Study, console: Console, kept: bool) -> None:
    """Print why steps have no design, those with the same reason together."""
    reasons: dict[str, list[StudyStep]] = {}
    for step in study.steps:
        if step.front is not None and not step.front.designs:
            reasons.setdefault(step.brief_reason, []).append(step)
    for reason, steps in list(reasons.items())[:MOST_REASONS]:
        places = [", ".join(x.valued(v) for x, v in zip(study.varied, s.values, strict=True)) for s in steps]
        shown = places if len(places) <= MOST_PLACES else [*places[:MOST_PLACES], f"{len(places) - MOST_PLACES} more"]
        names = {n for s in steps if s.front is not None for n in s.front.frame.limit_units}
        print_wrapped(console, in_words(f"no design at {'; '.join(shown)}: {reason}", names))
    if len(reasons) > MOST_REASONS:
        console.print(f"{len(reasons) - MOST_REASONS} more reasons in {named_file('whatif.csv', kept)}")
    if reasons:
        console.print()


def _print_breaks(study: Study, console: Console, kept: bool) -> None:
    assert study.along is not None
    along = study.varied[study.along]
    others = [x for k, x in enumerate(study.varied) if k != study.along]
    heads = [words(x.label) for x in (*others, along)]
    table = plain_table("break in", *heads, "change", "proven", wide=len(others) + 2)
    names = {name for f in study.fronts for design in f.designs for name in design.names}
    for b in study.breaks[:MOST_BREAKS]:
        values = [x.valued(v) for x, v in zip(others, b.others, strict=True)]
        table.add_row(words(b.objective), *values, *_told(b, along, names))
    console.print(table)
    if len(study.breaks) > MOST_BREAKS:
        console.print(f"{len(study.breaks) - MOST_BREAKS} more in {named_file('breaks.csv', kept)}")
    console.print()


def _told(b: Break, along: Varied, names: set[str]) -> list[str]:
    return [
        along.measured(b.value),
        in_words(b.change, names),
        "yes" if b.proven else f"no{': ' if b.remark else ''}{b.remark}",
    ]


def _robust(study: Study) -> list[str]:
    """Robustness of the designs of all steps, where anything scatters."""
    designs = [d for f in study.fronts for d in f.designs]
    lines = [robust_sentence(designs)] if any(d.robust for d in designs) else []
    gone = sum(f.statistics["robust"].get("taken_off", 0) for f in study.fronts if "robust" in f.settings)
    if gone:
        lines.append(removed_sentence(gone))
    return lines


def _proven(study: Study, kept: bool) -> str:
    kinds, place = [front.certificate.kind for front in study.fronts], named_file("whatif.csv", kept)
    if len(kinds) == len(study.steps) and all(kind == "global" for kind in kinds):
        return f"proven: every step over all its combinations of parts and counts (certificate and gap in {place})"
    return f"{kinds.count('global')} of {len(study.steps)} steps are proven; the certificates stand in {place}"
