"""Size ranges: from the designs of a batch, the standard variants that serve all its rows."""

from __future__ import annotations

import json
import math
import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from synth.batches.batch import BatchResult
from synth.batches.batch_folder import job_of_folder, opened_batch
from synth.batches.outputs import SHORT, explanation_of, status_of
from synth.batches.store import Answered, Store
from synth.errors import InputError
from synth.folders.csv_style import ENGLISH, CsvStyle
from synth.folders.files import csv_text, frame_csv
from synth.folders.output_folder import SIZE_RANGE, save_result
from synth.model.model import Model
from synth.model.problem import DesignProblem
from synth.model.registry import load
from synth.question.arguments import UserTables
from synth.question.catalogs import as_catalogs
from synth.results import cell_value
from synth.units import header
from synth.variants.coverage import ServedQuestion, SharedModel, Variant, objective_of_pairs, pinned_by_all
from synth.variants.p_median import Chooser, Medians
from synth.variants.variant_settings import VARIANTS, VariantSettings
from synth.verbs.requests import SizeRangeRequest

if TYPE_CHECKING:
    import pandas as pd

    from synth.queue.models import Job

SIZE_RANGE_FORMAT = 1  # of size_range.json


@dataclass(frozen=True)
class SizeRange:
    """The variants chosen, which row each serves, and how the cost falls with their number."""

    objective: str
    unit: str
    sense: str
    variants: list[dict[str, Any]]
    assignment: list[dict[str, Any]]
    unserved: list[dict[str, Any]]
    points: list[dict[str, Any]]
    fewest: int
    fewest_proven: bool
    cost: float
    gap: float
    statistics: Mapping[str, Any]
    taken_from_row: Mapping[str, Sequence[str]] = field(default_factory=dict)

    def curve(self) -> pd.DataFrame:
        """Return the number of variants against the total excess, ready to be drawn."""
        import pandas as pd

        excess = header("total_excess", self.unit)
        frame = pd.DataFrame(
            {
                "variants [-]": [point["variants"] for point in self.points],
                excess: [point["cost"] for point in self.points],
                "gap [-]": [point["gap"] for point in self.points],
            }
        )
        frame.attrs = {
            "title": f"Size range: excess of {self.objective} over the number of variants",
            "x": "variants [-]",
            "panels": [{"label": excess, "columns": [excess], "points": True}],
            "marks": [{"x": len(self.variants), "label": "chosen"}],
        }
        return frame

    def files(self) -> dict[str, str]:
        """Files that ``save`` writes: file name -> text."""
        record = {
            "format": SIZE_RANGE_FORMAT,
            "objective": self.objective,
            "unit": self.unit,
            "sense": self.sense,
            "variants": len(self.variants),
            "fewest": self.fewest,
            "fewest_proven": self.fewest_proven,
            "total_excess": self.cost,
            "gap": self.gap,
            "taken_from_row": {family: list(names) for family, names in self.taken_from_row.items()},
            "statistics": dict(self.statistics),
        }
        return {
            "variants.csv": _csv(self.variants),
            "assignment.csv": _csv(self.assignment),
            "unserved.csv": _csv(self.unserved, ("line", "row", "family", "status", "reason")),
            "curve.csv": frame_csv(self.curve()),
            "size_range.json": json.dumps(record, indent=1, ensure_ascii=False) + "\n",
        }

    def save(self, folder: str | Path, csv: CsvStyle = ENGLISH) -> Path:
        """Write variants.csv, assignment.csv, unserved.csv, curve.csv and size_range.json, all or none."""
        return save_result(folder, csv.files(self.files()), SIZE_RANGE, False)


def _csv(rows: Sequence[Mapping[str, object]], columns: Sequence[str] = ()) -> str:
    names = list(columns) or list(dict.fromkeys(name for row in rows for name in row))
    return csv_text(names, [[row.get(name) for name in names] for row in rows])


def size_range(
    source: str | Path | BatchResult,
    variants: int | None = None,
    objective: str | None = None,
    *,
    per_row: Sequence[str] | None = None,
    candidates: int = SizeRangeRequest.candidates,
    gap: float = SizeRangeRequest.gap,
    time_limit: float = SizeRangeRequest.time_limit,
    database: str | None = None,
    job: str | None = None,
) -> SizeRange:
    """Choose standard variants among the designs of a batch, so that every feasible row is served.

    Parameters
    ----------
    source : folder of a batch, or BatchResult
    variants : int, optional
        How many; the fewest that serve all rows if not given. Those with the least total excess are chosen.
    objective : str, optional
        The quantity whose excess over each row's own best counts; the first objective of the batch if not given.
    per_row : sequence of str, optional
        Variables that each row decides for itself, so that they are no part of a variant (the ramp time of a
        controller, not a diameter). By default those that every row of a family pins.
    candidates : int
        At most about this many designs are considered.
    gap : float
        Share of the total excess that need not be proven.
    time_limit : float
        Seconds for choosing.
    database, job : str, optional
        Where the batch is kept, if not in its folder.

    Returns
    -------
    SizeRange

    Raises
    ------
    InputError
        There is no such batch, or so few variants cannot serve all rows.
    """
    SizeRangeRequest.read({"variants": variants, "candidates": candidates, "gap": gap, "time_limit": time_limit})
    started = time.monotonic()
    batch = _read_batch(source, database, job, objective)
    batch.prepare(per_row)
    chosen_from = batch.thinned(candidates)
    costs, values = batch.costs(chosen_from)
    evaluated = time.monotonic() - started
    served = np.isfinite(costs).any(axis=1)
    if not served.any():
        raise InputError("rows", batch.job.source, "at least one row with a feasible design")
    weights = np.array([served.weight for served in batch.questions], dtype=float)
    begin = time.monotonic()
    chooser = Chooser(costs[served], weights[served], gap, VARIANTS.medians)
    fewest, bound = chooser.fewest(begin + 0.25 * time_limit)
    number = len(fewest) if variants is None else variants
    _refuse_too_few(number, len(fewest), bound)
    choice = chooser.best(number, begin + 0.6 * time_limit, fewest)
    points = _curve(chooser, choice, number, fewest, begin + time_limit, VARIANTS.curve_points)
    statistics = {
        "rows_served": int(weights[served].sum()),
        "questions": len(batch.questions),
        "designs": batch.designs,
        "candidates": len(chosen_from),
        "candidates_not_dominated": chooser.columns,
        "pairs": int(np.isfinite(costs).sum()),
        "seconds": {"evaluate": evaluated, "choose": time.monotonic() - begin},
    }
    return batch.result(choice, chosen_from, costs, values, points, (fewest, bound), statistics)


def _refuse_too_few(variants: int, fewest: int, bound: int) -> None:
    if variants < fewest:
        proven = "" if bound == fewest else f" (not fewer than {bound} in any case)"
        raise InputError("variants", variants, f"at least {fewest}: fewer do not serve all rows{proven}")


def _read_batch(
    source: str | Path | BatchResult, database: str | None, job: str | None, objective: str | None
) -> _Batch:
    catalogs: UserTables = None
    problem = None
    if isinstance(source, BatchResult):
        database, job, catalogs, problem = source.database, source.job, source.catalogs, source.user_family
        source = source.folder
    with opened_batch(source, database) as store:
        return _Batch(store, job_of_folder(store, source, job), objective, catalogs, problem, VARIANTS)


def _row_record(row: Answered) -> dict[str, Any]:
    """Row of a batch with what became of it, and its designs."""
    return {
        "line": row.line,
        "key": row.key,
        "family": row.family,
        "status": status_of(row),
        "explanation": explanation_of(row),
        "designs": [] if row.content is None else row.content.get("designs", []),
    }


@dataclass(frozen=True)
class _Served:
    """A row with the variant that serves it: best and objective in SI, excess in the unit of the objective."""

    row: Mapping[str, Any]
    variant: int
    best: float
    value: float
    excess: float


class _Batch:
    """Questions and designs of a job, with the structures and variants made of them."""

    def __init__(
        self,
        store: Store,
        job: Job,
        objective: str | None,
        catalogs: UserTables,
        user_problem: type[DesignProblem] | None,
        settings: VariantSettings,
    ) -> None:
        self.job, self.settings = job, settings
        content = job.content
        if content["own"] is not None and user_problem is None:
            raise InputError("DIR", job.source, "the BatchResult itself: its problem is not registered")
        self.problem = user_problem
        if content["catalogs"] == "memory" and catalogs is None:
            raise InputError("DIR", job.source, "the BatchResult itself: its tables were in memory")
        self.catalogs = as_catalogs(content["catalogs"] if catalogs is None else catalogs)
        self.rows = [_row_record(row) for row in store.rows(job.id, canonical=False)]
        self.layouts = list(store.layouts(job.id).values())
        questions = {key: content for key, _, content in store.questions(job.id)}
        self.objective, self.sense = self._objective(objective)
        self.sign = 1.0 if self.sense == "min" else -1.0
        self.designs = 0
        self.reasons: dict[str, str] = {}
        self.questions: list[ServedQuestion] = []
        self.designs_by_key: dict[str, list[dict[str, Any]]] = {}
        weight: dict[str, int] = {}
        for row in self.rows:
            if row["designs"]:
                weight[row["key"]] = weight.get(row["key"], 0) + 1
                self.designs_by_key[row["key"]] = row["designs"]
        for key in sorted(weight):
            best = min(self.sign * d["objectives"][self.objective] for d in self.designs_by_key[key])
            self.questions.append(ServedQuestion(key, questions[key], weight[key], best))

    def _objective(self, requested: str | None) -> tuple[str, str]:
        """Objective by which variants are chosen, and its sense; every row must have it."""
        if not self.layouts:
            raise InputError("DIR", self.job.source, "a batch with at least one feasible row")
        shared = [name for name in self.layouts[0]["senses"] if all(name in x["senses"] for x in self.layouts)]
        if requested is None and not shared:
            raise InputError("objective", None, "an objective that all families of the batch have")
        if requested is not None and requested not in shared:
            raise InputError("objective", requested, f"an objective of the whole batch: {', '.join(shared) or 'none'}")
        name = shared[0] if requested is None else requested
        return name, str(self.layouts[0]["senses"][name])

    # -- structures and candidates -------------------------------------------------------------

    def prepare(self, per_row: Sequence[str] | None) -> None:
        """Sort the questions by structure, and make variants of the designs."""
        problems: dict[str, Any] = {}
        self.structures: dict[str, SharedModel] = {}
        self.place: dict[str, list[int]] = {}  # structure -> its questions among all
        self.models: dict[str, Model] = {}
        for k, served in enumerate(self.questions):
            question = served.question
            label = json.dumps([question["family"], question["options"]])
            if label not in problems:
                users, family = self.problem, question["family"]
                chosen = users if users is not None and users.name == family else family
                problems[label] = load(chosen, **question["options"])
            name = json.dumps([label, sorted(question["requirements"])])
            if name not in self.structures:
                self.structures[name] = SharedModel(problems[label], self.catalogs)
                self.place[name] = []
                specified = frozenset(question["requirements"])
                self.models[name] = problems[label].model(specified, self.catalogs)
            self.structures[name].questions.append(served)
            self.place[name].append(k)
        self.used: dict[str, frozenset[str]] = {}
        for family in sorted({a.question["family"] for a in self.questions}):
            is_users = [a.question for a in self.questions if a.question["family"] == family]
            model = next(m for n, m in self.models.items() if self.structures[n].problem.name == family)
            pinned = pinned_by_all(is_users, model)
            if per_row is not None:
                names = [n for n in per_row if n in {v.name for v in model.variables}]
                loose = next((n for n in names if n not in pinned), None)
                if loose is not None:
                    raise InputError("per_row", loose, f"variables that every row of {family} pins")
                pinned = frozenset(names)
            self.used[family] = pinned
        self._collect()

    def _collect(self) -> None:
        """Collect the distinct variants of all designs, each with the questions it is the answer to."""
        known: dict[str, int] = {}
        self.candidates: list[Variant] = []
        self.source: list[list[int]] = []  # per candidate
        for k, served in enumerate(self.questions):
            family = served.question["family"]
            for design in self.designs_by_key[served.key]:
                self.designs += 1
                values = {n: v for n, v in design["values"].items() if n not in self.used[family]}
                variant = Variant(family, values, design["choices"], design["parts"])
                place = known.setdefault(variant.label, len(self.candidates))
                if place == len(self.candidates):
                    self.candidates.append(variant)
                    self.source.append([])
                self.source[place].append(k)

    def thinned(self, most: int) -> list[int]:
        """About ``most`` candidates: over all sizes those that serve most, and one for every row."""
        if len(self.candidates) <= most:
            return list(range(len(self.candidates)))
        step = max(len(self.questions) // self.settings.sample, 1)
        sample = set(range(0, len(self.questions), step))
        costs, values = self.costs(list(range(len(self.candidates))), sample)
        finite = np.isfinite(costs)
        serves = finite.sum(axis=0)
        size = np.where(serves > 0, np.nansum(np.where(finite, values, np.nan), axis=0) / np.maximum(serves, 1), np.inf)
        order = np.lexsort((np.arange(len(size)), size))
        chosen = {int(group[np.argmax(serves[group])]) for group in np.array_split(order, most)}
        unserved = finite.any(axis=1) & ~finite[:, sorted(chosen)].any(axis=1)
        while unserved.any():
            best = int(np.argmax(finite[unserved].sum(axis=0)))
            chosen.add(best)
            unserved &= ~finite[:, best]
        return sorted(chosen)

    def costs(self, chosen: list[int], only: set[int] | None = None) -> tuple[NDArray[Any], NDArray[Any]]:
        """Excess per question and candidate (infinite where it cannot serve), and the objective in SI."""
        values = np.full((len(self.questions), len(chosen)), np.nan)
        reasons = [""] * len(self.questions)
        for name, structure in self.structures.items():
            family = structure.problem.name
            columns = [j for j, c in enumerate(chosen) if self.candidates[c].family == family]
            places = [k for k in self.place[name] if only is None or k in only]
            part = SharedModel(structure.problem, structure.catalogs, [self.questions[k] for k in places])
            part_excess, why = objective_of_pairs(
                part,
                [self.candidates[chosen[j]] for j in columns],
                self.objective,
                self.used[family],
                self.settings.pairs,
            )
            if places and columns:
                values[np.ix_(places, columns)] = part_excess
            for k, text in zip(places, why, strict=True):
                reasons[k] = text
        signed = self.sign * values
        least = np.nanmin(np.where(np.isnan(signed), np.inf, signed), axis=1, initial=np.inf)
        excess = np.where(np.isnan(signed), np.inf, signed - np.where(np.isfinite(least), least, 0.0)[:, None])
        self.reasons = {a.key: text for a, text in zip(self.questions, reasons, strict=True)}
        return excess, values

    # -- the result ----------------------------------------------------------------------------

    def result(
        self,
        choice: Medians,
        chosen_from: list[int],
        costs: NDArray[Any],
        values: NDArray[Any],
        points: list[Medians],
        fewest: tuple[list[int], int],
        statistics: Mapping[str, object],
    ) -> SizeRange:
        """Say everything in terms of rows and designs."""
        serving = self._serving(choice, costs)
        chosen = {j: self.candidates[chosen_from[j]] for j in serving.values()}
        order = sorted(chosen, key=lambda j: (chosen[j].family, float(np.nanmean(values[:, j])), chosen[j].label))
        number = {j: k + 1 for k, j in enumerate(order)}
        index = {served.key: k for k, served in enumerate(self.questions)}
        scale = float(cell_value(1.0, self.unit) or 1.0)
        answered = [(row, index.get(row["key"])) for row in self.rows]
        served = [
            _Served(row, number[j], self.sign * self.questions[k].best, float(values[k, j]), float(costs[k, j]) * scale)
            for row, k in answered
            if k is not None and k in serving
            for j in [serving[k]]
        ]
        return SizeRange(
            objective=self.objective,
            unit=self.unit,
            sense=self.sense,
            variants=[self._variant(n, chosen[j], served) for j, n in number.items()],
            assignment=[self._assignment(x) for x in served],
            unserved=[self._unserved(row, k) for row, k in answered if k not in serving],
            points=[{"variants": len(p.columns), "cost": p.cost * scale, "gap": p.gap} for p in points],
            fewest=len(fewest[0]),
            fewest_proven=fewest[1] == len(fewest[0]),
            cost=choice.cost * scale,
            gap=choice.gap,
            statistics=statistics,
            taken_from_row={family: sorted(names) for family, names in self.used.items() if names},
        )

    def _serving(self, choice: Medians, costs: NDArray[Any]) -> dict[int, int]:
        """Return question -> column of the cheapest chosen variant; of equal ones the first."""
        columns = list(choice.columns)
        part = costs[:, columns]
        best = np.argmin(part, axis=1)
        return {k: columns[int(best[k])] for k in range(len(costs)) if np.isfinite(part[k, best[k]])}

    def _unserved(self, row: Mapping[str, Any], k: int | None) -> dict[str, Any]:
        reason = row["explanation"] or "it has not been solved"
        if k is not None:
            reason = self.reasons.get(row["key"]) or "no candidate serves it"
        return {
            "line": row["line"],
            "row": (row["key"] or "")[:SHORT],
            "family": row["family"],
            "status": row["status"],
            "reason": reason,
        }

    @property
    def unit(self) -> str:
        """Unit of the objective."""
        return next(iter(self.models.values())).units[self.objective]

    def _assignment(self, x: _Served) -> dict[str, Any]:
        return {
            "line": x.row["line"],
            "row": x.row["key"][:SHORT],
            "family": x.row["family"],
            "variant": x.variant,
            header(self.objective, self.unit): cell_value(x.value, self.unit),
            header("own_best", self.unit): cell_value(x.best, self.unit),
            header("excess", self.unit): x.excess,
        }

    def _variant(self, number: int, variant: Variant, served: Sequence[_Served]) -> dict[str, Any]:
        """Record of a variant, with the worst of the rows that it serves."""
        units = next(m for n, m in self.models.items() if self.structures[n].problem.name == variant.family).units
        served = [x for x in served if x.variant == number]
        worst = self.sign * max(self.sign * x.value for x in served)
        return {
            "variant": number,
            "family": variant.family,
            "rows": len(served),
            header("total_excess", self.unit): sum((x.excess for x in served), 0.0),
            header(self.objective, self.unit): cell_value(worst, self.unit),
            **{header(n, units[n]): cell_value(v, units[n]) for n, v in variant.values.items() if n in units},
            **variant.choices,
            **variant.parts,
        }


def _curve(
    chooser: Chooser, choice: Medians, number: int, fewest: list[int], deadline: float, points: int
) -> list[Medians]:
    """Return the best choice for every number of variants, from the fewest until no row has an excess.

    Where the time does not reach for every number, numbers further and further apart are taken.
    """
    curve = {number: choice}
    start, before, k = fewest, math.inf, len(fewest)
    step = 1
    while k <= chooser.columns and before > 0.0 and time.monotonic() < deadline:
        if k not in curve:
            remaining = deadline - time.monotonic()
            curve[k] = chooser.best(k, time.monotonic() + max(remaining / 4, 0.5), start, exact=remaining > 30.0)
        start, before = chooser.inner(curve[k].columns), curve[k].cost
        if len(curve) > points / 2:
            step = max(step, k // 8)
        k += step
    if before > 0.0 and chooser.columns >= len(fewest):
        curve.setdefault(chooser.columns, chooser.best(chooser.columns, deadline, start, exact=False))
    return [curve[k] for k in sorted(curve)]
