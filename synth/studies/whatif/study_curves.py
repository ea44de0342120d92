"""What is drawn of a what-if study: objectives over what is varied, and fronts."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Sequence
from typing import TYPE_CHECKING, Any

from synth.results import Design
from synth.studies.settings import STUDY_TEXTS
from synth.studies.whatif.study_answers import Break, StudyAnswers, StudyStep, best_design
from synth.studies.whatif.vary import Value, Varied
from synth.text.plain_text import words
from synth.units import finite_from_si, header

if TYPE_CHECKING:
    import pandas as pd

NO_DESIGN = "no design"


def curves_of(study: StudyAnswers) -> dict[str, pd.DataFrame]:
    """Drawings by file name, as the hooks of families make them."""
    frames = {"whatif": _objective_curves(study)}
    fronts = _front_curves(study)
    return frames if fronts is None else {**frames, "fronts": fronts}


# -- objectives over what is varied ----------------------------------------------------------------


def _objective_curves(study: StudyAnswers) -> pd.DataFrame:
    """Return least, leading and largest value of each objective over what is varied."""
    k, numeric = (0, False) if study.along is None else (study.along, True)
    varied = study.varied[k]
    # Words stand in the order in which they were given.
    places_of = {v: float(v) if isinstance(v, float) else n for n, v in enumerate(varied.values, start=1)}
    along = [float(places_of[s.values[k]]) for s in study.steps]
    groups = list(dict.fromkeys(_without(s.values, k) for s in _with_designs(study))) or [()]
    drawn = _spread(groups, STUDY_TEXTS.lines)
    x = header(varied.in_words, varied.unit if numeric else "-")
    frame, panels = _panels(study, k, x, along, drawn)
    ticks = [] if numeric else [{"x": n, "label": varied.shown(v)} for n, v in enumerate(varied.values, start=1)]
    marks, notes = _marks(study)
    spans = _without_design(study, along)
    legend = _omitted(len(drawn), len(groups), "lines") + _nowhere(study, k, groups)
    legend += ["lines: the best design of each step"] if len(study.varied) > 1 else []
    listed = "" if notes else ", each told in breaks.csv"
    legend += [f"vertical lines: break points, where the best parts or counts change{listed}"] if marks else []
    legend += [f"grey: {NO_DESIGN}"] if spans else []
    frame.attrs.update(
        title=f"{_title(study, study.objectives())} over {varied.in_words}{_by_others(study, k)}",
        x=x,
        panels=panels,
        ticks=_spread(ticks, STUDY_TEXTS.ticks),
        marks=marks,
        spans=spans,
        notes=notes,
        source=_footer(study, *legend),
    )
    return frame


def _panels(
    study: StudyAnswers, k: int, x: str, along: Sequence[float], drawn: Sequence[tuple[Value, ...]]
) -> tuple[pd.DataFrame, list[dict[str, Any]]]:
    """Return the lines and, per objective, what a panel shows of them.

    Parameters
    ----------
    study : StudyAnswers
    k : int
        The position of what the lines go over.
    x : str
        Its heading.
    along : list of float
        The place of each step on it.
    drawn : list of tuple
        What else is varied: a line for each.
    """
    import pandas as pd  # costly to import

    places, single = sorted(set(along)), len(study.varied) == 1
    data: dict[str, list[float]] = {x: places}
    panels: list[dict[str, Any]] = []
    for name, unit in study.objectives().items():
        columns = []
        for group in drawn:
            at = {place: s for place, s in zip(along, study.steps, strict=True) if _without(s.values, k) == group}
            lines = _lines(single, [at.get(p) for p in places], name)
            for label, values in lines.items():
                column = header(f"{label if single else _words(study, k, group)} {name}", unit)
                data[column] = [finite_from_si(v, unit, math.nan) for v in values]
                columns.append(column)
        apart = study.along is None
        panels.append({"label": header(name, unit), "columns": columns, "points": True, "apart": apart})
    return pd.DataFrame(data), panels


def _marks(study: StudyAnswers) -> tuple[list[dict[str, Any]], list[str]]:
    """Places of break points in a drawing, and the meaning of each number, where there is room for that."""
    groups: list[list[Break]] = []
    for b in sorted(study.breaks, key=lambda b: b.value):
        # The same happens to several objectives at one place, each of which is located by itself.
        like = next((group for group in groups if _same(group[0], b)), None)
        if like is None:
            groups.append([b])
        else:
            like.append(b)
    if study.along is None or len(groups) > STUDY_TEXTS.labels:
        return [{"x": group[0].value} for group in groups], []
    marks = [{"x": group[0].value, "label": str(n)} for n, group in enumerate(groups, start=1)]
    return marks, [f"{n}\t{_note(study, study.along, group)}" for n, group in enumerate(groups, start=1)]


def _same(a: Break, b: Break) -> bool:
    return (a.others, a.change) == (b.others, b.change) and a.low <= b.high and b.low <= a.high


def _note(study: StudyAnswers, k: int, group: Sequence[Break]) -> str:
    """Description of a break point: where, for which objective, and from which parts and counts to which."""
    first = group[0]
    place = study.varied[k].measured(first.value)
    others = f" ({_words(study, k, first.others)})" if first.others else ""
    if first.before is None or first.after is None:
        return f"{place}{others}: {first.change}"
    old, new = first.before.named, first.after.named
    changed = [
        f"{n.replace('_', ' ')} {old.get(n, '-')} \u2192 {new.get(n, '-')}"
        for n in {**old, **new}
        if old.get(n) != new.get(n)
    ]
    best = _and([b.objective for b in group], list(study.objectives()).index)
    return f"{place}{others}, best {best}: {', '.join(changed)}"


def _without_design(study: StudyAnswers, along: Sequence[float]) -> list[dict[str, Any]]:
    """Return the spans where no step has a design, up to the next break point or half the way to the next step.

    ``along`` has the place of each step; one that was not reached says nothing of its place.
    """
    places = sorted(set(along))
    empty = {*places} - {x for x, s in zip(along, study.steps, strict=True) if s.front is None or s.front.designs}
    ends = [b.value for b in study.breaks if b.before is None or b.after is None]
    spans: list[dict[str, Any]] = []
    for k, place in enumerate(places):
        if place not in empty:
            continue
        if k and places[k - 1] in empty:
            spans[-1]["to"] = _edge(places, k, 1, ends)
        else:
            spans.append({"from": _edge(places, k, -1, ends), "to": _edge(places, k, 1, ends), "shaded": True})
    if len(spans) <= STUDY_TEXTS.labels:
        spans = [{**span, "label": NO_DESIGN} for span in spans]
    return spans


# -- fronts ----------------------------------------------------------------------------------------


def _front_curves(study: StudyAnswers) -> pd.DataFrame | None:
    """Return the fronts of some steps in the first two objectives; None where there are not two."""
    import pandas as pd

    objectives = list(study.objectives().items())
    steps = _with_designs(study)
    if len(objectives) < 2 or not any(len(s.front.designs) > 1 for s in steps if s.front is not None):
        return None
    (first, unit), (second, other) = objectives[:2]
    x = header(first, unit)
    data: dict[str, list[float]] = {x: []}
    shown = _spread(steps, STUDY_TEXTS.lines)
    single = len(study.varied) == 1
    labels = [
        header(
            ", ".join(v.valued(w) if single else _valued(v, w) for v, w in zip(study.varied, s.values, strict=True)),
            other,
        )
        for s in shown
    ]
    data |= {label: [] for label in labels}
    for step, label in zip(shown, labels, strict=True):
        assert step.front is not None
        designs = sorted(step.front.designs, key=lambda d: d.values[first])
        for d in [*designs, None]:
            for column in data:
                data[column].append(math.nan)
            if d is None:
                data[x][-1] = data[x][-2]
            else:
                data[x][-1] = finite_from_si(d.values[first], unit, math.nan)
                data[label][-1] = finite_from_si(d.values[second], other, math.nan)
    frame = pd.DataFrame(data)
    # Straight lines between few designs would promise what lies between: fronts would seem to cross better ones.
    assert steps[0].front is not None
    stairs = "post" if steps[0].front.frame.objectives[first] == "min" else "pre"
    panel = {"label": header(second, other), "columns": labels, "points": True, "stairs": stairs}
    names = _and([v.in_words for v in study.varied])
    frame.attrs.update(
        title=f"{_title(study, [f'fronts of {first}', second])} by {names}",
        x=x,
        panels=[panel],
        source=_footer(study, *_omitted(len(shown), len(steps), "fronts"), "lines: what the designs reach at least"),
    )
    return frame


# -- words and lines -------------------------------------------------------------------------------


def _nowhere(study: StudyAnswers, k: int, groups: Sequence[tuple[Value, ...]]) -> list[str]:
    """Footer for values beside those along the axis that have no design anywhere."""
    empty = [g for g in dict.fromkeys(_without(s.values, k) for s in study.steps) if g not in groups]
    if not empty or len(study.varied) == 1:
        return []
    shown = "; ".join(_words(study, k, g) for g in empty[: STUDY_TEXTS.missed])
    more = f" and {len(empty) - STUDY_TEXTS.missed} more" if len(empty) > STUDY_TEXTS.missed else ""
    return [f"{NO_DESIGN}: {shown}{more}"]


def _with_designs(study: StudyAnswers) -> list[StudyStep]:
    return [s for s in study.steps if s.front is not None and s.front.designs]


def _words(study: StudyAnswers, k: int, group: Sequence[Value]) -> str:
    others = [x for j, x in enumerate(study.varied) if j != k]
    return ", ".join(_valued(x, v) for x, v in zip(others, group, strict=True))


def _valued(varied: Varied, value: Value) -> str:
    """Value in a list: parts, options and ranges by themselves, numbers with their names."""
    self_explanatory = not isinstance(value, float)
    return varied.valued(value) if self_explanatory else f"{varied.in_words} {varied.valued(value)}"


def _by_others(study: StudyAnswers, k: int) -> str:
    others = [x.in_words for j, x in enumerate(study.varied) if j != k]
    return f", by {_and(others)}" if others else ""


def _and(names: Iterable[str], key: Callable[[str], int] | None = None) -> str:
    *first, last = [words(name) for name in (names if key is None else sorted(names, key=key))]
    return f"{', '.join(first)} and {last}" if first else last


def _title(study: StudyAnswers, what: Iterable[str]) -> str:
    return f"{study.fronts[0].frame.title}: {_and(what)}" if study.fronts else "What if"


def _footer(study: StudyAnswers, *legend: str) -> str:
    """Summary of the answered steps, and the key of signs."""
    solved = [f.certificate.kind for f in study.fronts]
    answered = f"{len(solved)} of {len(study.steps)} steps answered, {solved.count('global')} of them proven"
    return "; ".join([answered, *legend])


def _lines(single: bool, steps: Sequence[StudyStep | None], name: str) -> dict[str, list[float]]:
    """Return the lines of one objective: best and, where there is room, leading and worst design of each front."""
    fronts = [None if s is None or s.front is None or not s.front.designs else s.front for s in steps]
    best = [math.nan if f is None else _value(best_design(f, name), name) for f in fronts]
    if not single or all(f is None or len(f.designs) < 2 for f in fronts):
        return {"best": best}
    values = [[] if f is None else [d.values[name] for d in f.designs] for f in fronts]
    worst = [
        math.nan if not v else max(v) if abs(min(v) - b) <= abs(max(v) - b) else min(v)
        for v, b in zip(values, best, strict=True)
    ]
    leading = [math.nan if f is None else f.designs[0].values[name] for f in fronts]
    return {"best": best, "leading design #1": leading, "other end of the front": worst}


def _edge(places: Sequence[float], k: int, way: int, ends: Sequence[float]) -> float:
    """Extent, upwards (1) or downwards (-1), of what holds at a place: to the next end on the way."""
    place, beyond = places[k], k + way
    if not 0 <= beyond < len(places):
        return place
    between = [x for x in ends if 0 <= way * (x - place) <= way * (places[beyond] - place)]
    return min(between, key=lambda x: abs(x - place), default=0.5 * (place + places[beyond]))


def _value(design: Design | None, name: str) -> float:
    return math.nan if design is None else design.values[name]


def _omitted(drawn: int, count: int, what: str) -> list[str]:
    """Footer with the number of omitted lines; none where all are drawn."""
    return [f"{drawn} of {count} {what} drawn"] if drawn < count else []


def _without(values: Sequence[Value], k: int) -> tuple[Value, ...]:
    return tuple(v for j, v in enumerate(values) if j != k)


def _spread(items: Sequence[Any], most: int) -> list[Any]:
    """Return at most so many, at equal distances but for the last."""
    stride = -(-(len(items) - 1) // (most - 1)) if len(items) > most else 1
    chosen = list(range(0, len(items), stride))
    return [items[k] for k in (chosen if not items or chosen[-1] == len(items) - 1 else [*chosen, len(items) - 1])]
