"""A what-if study: its steps, its break points, the tables they become and the files they are saved to."""

from __future__ import annotations

import math
import shutil
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

from synth.feasibility import Status
from synth.files import csv_text
from synth.output_folder import STUDY, claimed, loses_nothing, save_files, save_result
from synth.results import Design, Frame, ParetoFront
from synth.results.drawings import report
from synth.results.rating_tables import COLUMNS, rating_row
from synth.robust.robust_front import NOTHING_STANDS
from synth.studies.study_store import STEPS, StudyStore
from synth.studies.whatif.vary import Value, Varied
from synth.study_limits import STUDY_TEXTS
from synth.units import format_quantity, from_si, header

if TYPE_CHECKING:
    import pandas as pd

NO_DESIGN = "no design"
NOT_REACHED = "not reached"


@dataclass(frozen=True)
class StudyStep:
    """The question at some values, and its answer; ``front`` is None where the study was stopped before."""

    number: int
    values: tuple[Value, ...]
    front: ParetoFront | None
    fingerprint: str = ""
    stopped: str = ""

    @property
    def status(self) -> Status:
        """Return how the step stands."""
        return Status.NOT_SOLVED if self.front is None else self.front.status

    @property
    def reason(self) -> str:
        """Return in a few words why there is no design; nothing where there is one."""
        if self.front is None:
            return f"{NOT_REACHED}: {self.stopped}" if self.stopped else NOT_REACHED
        if self.front.designs:
            return ""
        if self.front.status is Status.NOT_SOLVED:
            return NOTHING_STANDS
        missed = [_missed(c) for c in self._conflicts()]
        return f"the nearest design misses {', '.join(missed)}" if missed else "no design keeps all limits"

    @property
    def brief_reason(self) -> str:
        """Return the reason with the limits alone that are missed by most."""
        conflicts = sorted(self._conflicts(), key=lambda c: -c["missed_by"])
        more = len(conflicts) - STUDY_TEXTS.missed
        if more <= 0:
            return self.reason
        missed = ", ".join(_missed(c) for c in conflicts[: STUDY_TEXTS.missed])
        return f"the nearest design misses {missed} and {more} more"

    def _conflicts(self) -> Sequence[Mapping[str, Any]]:
        explanation = None if self.front is None else self.front.explanation
        return [] if explanation is None else explanation.get("conflicts") or []


@dataclass(frozen=True)
class Composition:
    """Parts, counts and choices of a best design, with the value that it reaches."""

    parts: Mapping[str, str]
    counts: Mapping[str, float]
    choices: Mapping[str, str]
    value: float

    @staticmethod
    def of(design: Design, objective: str) -> Composition:
        """Return what a design is made of."""
        kinds = design.frame.kinds
        return Composition(
            {slot: str(row) for slot, row in design.parts.items()},
            {n: design.values[n] for n, kind in kinds.items() if kind == "count"},
            dict(design.choices),
            design.values[objective],
        )

    @property
    def named(self) -> dict[str, str]:
        """Return everything discrete by name."""
        return {**self.parts, **{n: f"{v:g}" for n, v in self.counts.items()}, **self.choices}


@dataclass(frozen=True)
class Break:
    """A value at which the best design in one objective changes its parts or counts, or begins or ends to exist.

    It lies between ``low`` and ``high``, in the unit of what is varied; ``before`` is best at ``low``, ``after`` at
    ``high`` (None: nothing is feasible). ``others`` are the values of what else is varied. ``proven``: over all
    combinations, on both sides, or on the side that has no design where the other one has; where it is not, ``remark``
    says why.
    """

    objective: str
    others: tuple[Value, ...]
    low: float
    high: float
    before: Composition | None
    after: Composition | None
    proven: bool
    remark: str = ""

    @property
    def value(self) -> float:
        """Return the middle of the range that holds the break."""
        return 0.5 * (self.low + self.high)

    @property
    def kind(self) -> str:
        """Return what changes: feasible, parts, counts or choices, the first that applies."""
        if self.before is None or self.after is None:
            return "feasible"
        for kind in ("parts", "choices", "counts"):
            if getattr(self.before, kind) != getattr(self.after, kind):
                return kind
        return "none"

    @property
    def change(self) -> str:
        """Return in words what changes."""
        if self.before is None:
            return "feasible from here on"
        if self.after is None:
            return "nothing feasible from here on"
        old, new = self.before.named, self.after.named
        return ", ".join(
            f"{n} {old.get(n, '-')} -> {new.get(n, '-')}" for n in {**old, **new} if old.get(n) != new.get(n)
        )


@dataclass(frozen=True)
class Study:
    """Fronts for all values of what is varied, and where the best parts change.

    ``along`` is the position of what breaks are sought along (None: nothing numeric is varied); ``settings`` are those
    of the question that stays.
    """

    varied: tuple[Varied, ...]
    steps: tuple[StudyStep, ...]
    breaks: tuple[Break, ...]
    along: int | None
    interrupted: str = ""
    statistics: Mapping[str, Any] = field(default_factory=dict)
    store: StudyStore = field(default_factory=lambda: StudyStore(None), repr=False, compare=False)

    @property
    def fronts(self) -> list[ParetoFront]:
        """Return the fronts of the steps that were answered."""
        return [s.front for s in self.steps if s.front is not None]

    @property
    def feasible(self) -> bool:
        """Tell whether any step has a design."""
        return any(front.designs for front in self.fronts)

    # -- tables --------------------------------------------------------------------------------

    def to_frame(self) -> pd.DataFrame:
        """Return one row per step and design, with units in the headers; a step without designs has one row."""
        import pandas as pd  # costly to import

        columns, rows = self._table()
        return pd.DataFrame(rows, columns=columns)

    def breaks_frame(self) -> pd.DataFrame:
        """Return one row per break point."""
        import pandas as pd

        columns, rows = self._breaks_table()
        return pd.DataFrame(rows, columns=columns)

    def _headers(self) -> list[str]:
        return [header(x.label, x.unit) if x.numeric else x.label for x in self.varied]

    def _cells(self, values: Sequence[Value]) -> list[Any]:
        return [v if x.numeric else x.shown(v) for x, v in zip(self.varied, values, strict=True)]

    def objectives(self) -> dict[str, str]:
        """Return the objectives of all steps with their unit."""
        return {n: f.frame.units[n] for f in self.fronts for n in f.frame.objectives}

    def _table(self) -> tuple[list[str], list[list[Any]]]:
        frames = [f.frame for f in self.fronts]
        designs = [d for f in self.fronts for d in f.designs]
        objectives = self.objectives()
        units = {n: u for frame in frames for n, u in frame.units.items()}
        searched = [
            n
            for kind in ("variable", "count")
            for n in _union(_of_kind(f, kind) for f in frames)
            if n not in objectives
        ]
        choices, slots = _union(d.choices for d in designs), _union(d.parts for d in designs)
        prices = [
            (objective, name)
            for objective in objectives
            for name in _union(d.elasticity.get(objective, {}) for d in designs)
        ]
        columns = ["step", *self._headers(), "status", "rank", "note"]
        columns += [header(n, objectives[n]) for n in objectives] + ["binding", *slots, *choices]
        columns += [header(n, units[n]) for n in searched]
        columns += [f"elasticity: {objective} by {name}" for objective, name in prices]
        rated = any(d.robust for d in designs)
        columns += [*(COLUMNS if rated else ()), "certificate", "gap", "reason"]
        rows = []
        for step in self.steps:
            front, start = step.front, [step.number, *self._cells(step.values)]
            kind = "" if front is None else front.certificate.kind
            if front is None or not front.designs:
                blank: list[Any] = [None] * (len(columns) - len(start) - 4)
                rows.append([*start, step.status.value, *blank, kind, None, step.reason])
                continue
            for d in front.designs:
                row: list[Any] = [*start, d.status.value, d.rank, d.note]
                row += [_shown(d.values.get(n), objectives[n]) for n in objectives]
                row.append("; ".join(binding(d)))
                row += [str(d.parts[s]) if s in d.parts else None for s in slots]
                row += [d.choices.get(c) for c in choices]
                row += [_shown(d.values.get(n), units[n]) for n in searched]
                row += [d.elasticity.get(objective, {}).get(name) for objective, name in prices]
                row += rating_row(d) if rated else []
                rows.append([*row, kind, front.certificate.gap, ""])
        return columns, rows

    def _breaks_table(self) -> tuple[list[str], list[list[Any]]]:
        k, units = self.along, self.objectives()
        if k is None:
            return ["objective", "kind", "change", "proven", "remark"], []
        varied, heads = self.varied[k], self._headers()
        others = [x for j, x in enumerate(self.varied) if j != k]
        columns = ["objective", *(h for j, h in enumerate(heads) if j != k), heads[k], "from", "to", "kind", "change"]
        columns += ["objective before", "objective after", "parts before", "parts after", "proven", "remark"]
        rows = []
        for b in self.breaks:
            row: list[Any] = [b.objective]
            row += [v if x.numeric else x.shown(v) for x, v in zip(others, b.others, strict=True)]
            row += [b.value, b.low, b.high, b.kind, b.change]
            for side in (b.before, b.after):
                row.append(None if side is None or b.objective not in units else _shown(side.value, units[b.objective]))
            for side in (b.before, b.after):
                row.append("" if side is None else ", ".join(f"{n} {w}" for n, w in side.named.items()))
            rows.append([*row, "yes" if b.proven else "no", b.remark])
        assert varied.numeric
        return columns, rows

    # -- drawings ------------------------------------------------------------------------------

    def curves(self) -> dict[str, pd.DataFrame]:
        """Return what is drawn, by file name, as the hooks of families do: objectives over what is varied, fronts."""
        found = {"whatif": self._objective_curves()}
        fronts = self._front_curves()
        return found if fronts is None else {**found, "fronts": fronts}

    def _objective_curves(self) -> pd.DataFrame:
        """Return least, leading and largest value of each objective over what is varied."""
        import pandas as pd

        k = 0 if self.along is None else self.along
        varied = self.varied[k]
        numeric = self.along is not None
        ticks = [] if numeric else [{"x": n, "label": varied.shown(v)} for n, v in enumerate(varied.values, start=1)]
        x = self._headers()[k] if numeric else header(varied.label, "-")
        single = len(self.varied) == 1
        groups = list(dict.fromkeys(_without(s.values, k) for s in self._with_designs())) or [()]
        drawn = _spread(groups, STUDY_TEXTS.lines)
        # Words stand in the order in which they were given.
        places_of = {v: float(v) if isinstance(v, float) else n for n, v in enumerate(varied.values, start=1)}
        along = [float(places_of[s.values[k]]) for s in self.steps]
        places = sorted(set(along))
        data: dict[str, list[float]] = {x: places}
        panels: list[dict[str, Any]] = []
        for name, unit in self.objectives().items():
            columns = []
            for group in drawn:
                at = {place: s for place, s in zip(along, self.steps, strict=True) if _without(s.values, k) == group}
                lines = _lines(single, [at.get(p) for p in places], name)
                for label, values in lines.items():
                    words = "" if single else f"{self._words(k, group)}: "
                    column = header(f"{words}{label} {name}", unit)
                    data[column] = [_in_unit(v, unit) for v in values]
                    columns.append(column)
            panels.append({"label": header(name, unit), "columns": columns, "points": True, "apart": not numeric})
        frame = pd.DataFrame(data)
        marks: list[dict[str, Any]] = [{"x": b.value} for b in self.breaks] if numeric else []
        if len(marks) <= STUDY_TEXTS.labels:
            marks = [{"x": b.value, "label": f"{b.objective.replace('_', ' ')}: {_brief(b)}"} for b in self.breaks]
        spans = self._without_design(along)
        legend = _left_out(len(drawn), len(groups), "lines") + self._nowhere(k, groups)
        legend += ["vertical lines: break points"] if marks else []
        legend += [f"grey: {NO_DESIGN}"] if spans else []
        frame.attrs.update(
            title=f"{self._title()} over {varied.label.replace('_', ' ')}",
            x=x,
            panels=panels,
            ticks=_spread(ticks, STUDY_TEXTS.ticks),
            marks=marks,
            spans=spans,
            source=self._footer(*legend),
        )
        return frame

    def _without_design(self, along: Sequence[float]) -> list[dict[str, Any]]:
        """Return the spans where no step has a design, up to the next break point or half the way to the next step.

        ``along`` has the place of each step; one that was not reached says nothing of its place.
        """
        places = sorted(set(along))
        empty = {*places} - {x for x, s in zip(along, self.steps, strict=True) if s.front is None or s.front.designs}
        ends = [b.value for b in self.breaks if b.before is None or b.after is None]
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

    def _front_curves(self) -> pd.DataFrame | None:
        """Return the fronts of some steps in the first two objectives; None where there are not two."""
        import pandas as pd

        objectives = list(self.objectives().items())
        steps = [s for s in self._with_designs() if s.front is not None and len(s.front.designs) > 1]
        if len(objectives) < 2 or not steps:
            return None
        (first, unit), (second, other) = objectives[:2]
        x = header(first, unit)
        data: dict[str, list[float]] = {x: []}
        shown = _spread(steps, STUDY_TEXTS.lines)
        labels = [
            header(", ".join(v.shown(w) for v, w in zip(self.varied, s.values, strict=True)), other) for s in shown
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
                    data[x][-1] = _in_unit(d.values[first], unit)
                    data[label][-1] = _in_unit(d.values[second], other)
        frame = pd.DataFrame(data)
        # Straight lines between few designs would promise what lies between: fronts would seem to cross better ones.
        assert steps[0].front is not None
        stairs = "post" if steps[0].front.frame.objectives[first] == "min" else "pre"
        panel = {"label": header(second, other), "columns": labels, "points": True, "stairs": stairs}
        names = " and ".join(v.label.replace("_", " ") for v in self.varied)
        frame.attrs.update(
            title=f"{self._title()}: the front for {names}",
            x=x,
            panels=[panel],
            source=self._footer(*_left_out(len(shown), len(steps), "fronts"), "lines: what the designs reach at least"),
        )
        return frame

    def _nowhere(self, k: int, groups: Sequence[tuple[Value, ...]]) -> list[str]:
        """Return what a footer says of values beside those along the axis that have no design anywhere."""
        empty = [g for g in dict.fromkeys(_without(s.values, k) for s in self.steps) if g not in groups]
        if not empty or len(self.varied) == 1:
            return []
        shown = "; ".join(self._words(k, g) for g in empty[: STUDY_TEXTS.missed])
        more = f" and {len(empty) - STUDY_TEXTS.missed} more" if len(empty) > STUDY_TEXTS.missed else ""
        return [f"{NO_DESIGN}: {shown}{more}"]

    def _with_designs(self) -> list[StudyStep]:
        return [s for s in self.steps if s.front is not None and s.front.designs]

    def _words(self, k: int, group: Sequence[Value]) -> str:
        others = [x for j, x in enumerate(self.varied) if j != k]
        return ", ".join(x.stated(v) for x, v in zip(others, group, strict=True)).replace("_", " ")

    def _title(self) -> str:
        return self.fronts[0].frame.title if self.fronts else "What if"

    def _footer(self, *legend: str) -> str:
        """Return how far the steps are answered, and what stands for what."""
        solved = [f.certificate.kind for f in self.fronts]
        answered = f"{len(solved)} of {len(self.steps)} steps answered, {solved.count('global')} of them proven"
        return "; ".join([answered, *legend])

    # -- files ---------------------------------------------------------------------------------

    def files(self) -> dict[str, str]:
        """Return what ``save`` writes: file name -> text."""
        found = {"whatif.csv": csv_text(*self._table()), "breaks.csv": csv_text(*self._breaks_table())}
        draw = report("figure")
        if draw is not None and self.feasible:
            found |= {f"{key}.svg": draw(frame) for key, frame in self.curves().items()}
        return found

    def save(self, folder: str | Path) -> Path:
        """Write whatif.csv, breaks.csv and the drawings; return the folder.

        A study that was stopped replaces no earlier result: it is written to a folder ``stopped..`` beside that, where
        its finished steps are, and goes there when it is finished.
        """
        target, files, kept = Path(folder), self.files(), self.store.folder
        if kept is None or kept == target:
            known = loses_nothing(target, files, ("whatif.csv", "breaks.csv"), NOT_REACHED)
            return save_result(target, files, STUDY, bool(self.interrupted), known)
        if self.interrupted:
            return save_files(kept, files)
        with claimed(target):
            earlier = [f"{STEPS}/{path.name}" for path in (target / STEPS).glob("step_*.json")]
            save_result(target, {**files, **self.store.files()}, STUDY, False, drop=earlier)
            shutil.rmtree(kept, ignore_errors=True)  # all of it stands in the result now
        return target


def _missed(conflict: Mapping[str, Any]) -> str:
    return f"{conflict['limit']} by {format_quantity(conflict['missed_by'], '%', 3)}"


def binding(design: Design) -> list[str]:
    """Return the limits that a design has reached; an equality is one always and says nothing."""
    return [
        name
        for name, used in design.utilisation.items()
        if used is not None and used >= STUDY_TEXTS.binding and design.frame.limit_senses[name] != "equal"
    ]


def best_design(front: ParetoFront | None, objective: str) -> Design | None:
    """Return the design of a front that is best in one objective."""
    if front is None or not front.designs:
        return None
    sign = 1.0 if front.frame.objectives.get(objective, "min") == "min" else -1.0
    return min(front.designs, key=lambda d: sign * d.values[objective])


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
    return {"best": best, "leading design": leading, "other end of the front": worst}


def _edge(places: Sequence[float], k: int, way: int, ends: Sequence[float]) -> float:
    """Return how far, upwards (1) or downwards (-1), what holds at a place is shown: to the next end on the way."""
    place, beyond = places[k], k + way
    if not 0 <= beyond < len(places):
        return place
    between = [x for x in ends if 0 <= way * (x - place) <= way * (places[beyond] - place)]
    return min(between, key=lambda x: abs(x - place), default=0.5 * (place + places[beyond]))


def _brief(b: Break) -> str:
    if b.before is None or b.after is None:
        return "feasible" if b.before is None else "infeasible"
    old, new = b.before.named, b.after.named
    changed = [new[n] for n in new if old.get(n) != new[n]]
    return ", ".join(changed[:2]) + (" ..." if len(changed) > 2 else "")


def _value(design: Design | None, name: str) -> float:
    return math.nan if design is None else design.values[name]


def _in_unit(value: float, unit: str) -> float:
    return float(from_si(value, unit)) if math.isfinite(value) else math.nan


def _shown(value: float | None, unit: str) -> float | None:
    return None if value is None or not math.isfinite(value) else float(from_si(value, unit))


def _union(groups: Iterable[Iterable[str]]) -> list[str]:
    return list(dict.fromkeys(name for group in groups for name in group))


def _of_kind(frame: Frame, kind: str) -> list[str]:
    return [n for n, k in frame.kinds.items() if k == kind]


def _left_out(drawn: int, count: int, what: str) -> list[str]:
    """Return what a footer says where not all is drawn."""
    return [f"{drawn} of {count} {what} drawn"] if drawn < count else []


def _without(values: Sequence[Value], k: int) -> tuple[Value, ...]:
    return tuple(v for j, v in enumerate(values) if j != k)


def _spread(items: Sequence[Any], most: int) -> list[Any]:
    """Return at most so many, at equal distances but for the last."""
    stride = -(-(len(items) - 1) // (most - 1)) if len(items) > most else 1
    chosen = list(range(0, len(items), stride))
    return [items[k] for k in (chosen if not items or chosen[-1] == len(items) - 1 else [*chosen, len(items) - 1])]
