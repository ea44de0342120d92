"""Which design can serve which question: every design against every question, by the model's own evaluator."""

from __future__ import annotations

import json
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from synth.batches.entries import RowQuestion
from synth.model.model import DataInput, Evaluation, Model
from synth.model.problem import DesignProblem
from synth.model.program import InputValue
from synth.order.feasibility import missed_share, most_used
from synth.order.margins import MARGINS, within
from synth.question.inputs import inputs_of, part_value
from synth.question.instance import Instance
from synth.question.request import Request
from synth.tables.catalogs import Catalogs
from synth.units import miss_text

FloatArray = NDArray[np.float64]
NAMED_LIMITS = 3  # limits that a sentence names


@dataclass(frozen=True)
class Variant:
    """A design without what belongs to its use: sizes and counts in SI, choices, parts by designation."""

    family: str
    values: Mapping[str, float]
    choices: Mapping[str, str]
    parts: Mapping[str, str]

    @property
    def label(self) -> str:
        """What tells it from others."""
        values = {name: float(f"{value:.12g}") for name, value in self.values.items()}
        return json.dumps([self.family, values, dict(self.choices), dict(self.parts)], sort_keys=True)


@dataclass(frozen=True)
class ServedQuestion:
    """A question that variants are to serve: how often it is asked, and its own best value of the objective."""

    key: str
    question: RowQuestion
    weight: int
    best: float


@dataclass
class SharedModel:
    """Questions of one structure: one model, and an instance of it for each."""

    problem: DesignProblem
    catalogs: Catalogs
    questions: list[ServedQuestion] = field(default_factory=list)


def objective_of_pairs(
    structure: SharedModel, variants: Sequence[Variant], objective: str, used: frozenset[str], pairs: int
) -> tuple[FloatArray, list[str]]:
    """Evaluate every variant for every question of a structure.

    Parameters
    ----------
    structure : SharedModel
    variants : sequence of Variant
        Of the same family.
    objective : str
        A quantity.
    used : set of str
        Variables that belong to the use: each question pins them, variants have none.
    pairs : int
        That are evaluated at a time.

    Returns
    -------
    array (questions, variants), list of str
        The objective in SI, not-a-number where the variant cannot serve the question; and, per question that none can
        serve, which limits the nearest one misses (an empty text otherwise).
    """
    result = np.full((len(structure.questions), len(variants)), np.nan)
    reasons = [""] * len(structure.questions)
    if not structure.questions or not variants:
        return result, reasons
    instances = [_instance(structure, served.question, objective) for served in structure.questions]
    model = instances[0].model
    columns = _VariantColumns(model, structure, variants)
    if not columns.complete.any():
        return result, ["no design of this family fits its options"] * len(structure.questions)
    step = max(pairs // len(variants), 1)
    for begin in range(0, len(instances), step):
        chunk = instances[begin : begin + step]
        evaluation = _evaluate(model, chunk, columns, used)
        serves = _serves(model, chunk, columns, used, evaluation).reshape(len(chunk), -1)
        values = evaluation.values[objective].reshape(serves.shape)
        result[begin : begin + len(chunk)] = np.where(serves, values, np.nan)
        for k in np.flatnonzero(~serves.any(axis=1)):
            reasons[begin + int(k)] = _nearest_miss(model, chunk[k], int(k), columns, evaluation)
    return result, reasons


def _instance(structure: SharedModel, question: RowQuestion, objective: str) -> Instance:
    request = {name: question[name] for name in ("requirements", "parts", "limits", "fix")}
    # Its sense is of no account here.
    return Instance(
        Request(problem=structure.problem, catalogs=structure.catalogs, objectives={objective: "min"}, **request)
    )


class _VariantColumns:
    """What the variants have for each input of a model; variants that lack something are not complete."""

    def __init__(self, model: Model, structure: SharedModel, variants: Sequence[Variant]) -> None:
        d = model.declaration
        count = len(variants)
        self.count = count
        self._made = structure, variants
        self._of: dict[Model, _VariantColumns] = {model: self}
        self.complete = np.ones(count, dtype=bool)
        self.values = np.full((count, len(model.variables)), np.nan)
        self.counts: dict[str, FloatArray] = {}
        self.choices: dict[str, FloatArray] = {}
        self.rows: dict[str, NDArray[np.int_]] = {}
        self.parts: list[dict[str, FloatArray]] = []
        for k, variable in enumerate(model.variables):
            self.values[:, k] = [v.values.get(variable.name, np.nan) for v in variants]
        for name in d.counts:
            self.counts[name] = np.array([v.values.get(name, np.nan) for v in variants])
            self.complete &= ~np.isnan(self.counts[name])
        for name, choice in d.choices.items():
            places = [
                choice.labels.index(v.choices[name]) if v.choices.get(name) in choice.labels else -1 for v in variants
            ]
            self.choices[name] = np.array(places, dtype=float)
            self.complete &= self.choices[name] >= 0
        self.columns: dict[tuple[str, str], FloatArray] = {}
        for slot, part in d.slots.items():
            table = structure.catalogs.table(part.table)
            known = {name: k for k, name in enumerate(table.designations)}
            rows = np.array([known.get(v.parts.get(slot, ""), -1) for v in variants])
            self.rows[slot] = rows
            self.complete &= rows >= 0
            for key, column in part.columns.items():
                values = part_value(table, rows, column.columns)
                self.columns[slot, key] = np.where(rows >= 0, values, np.nan)
                if column.required:
                    self.complete &= ~np.isnan(self.columns[slot, key])

    def column(self, entry: DataInput) -> FloatArray:
        """Values of the variants for an input that belongs to a slot, count or choice."""
        if entry.columns:
            return self.columns[entry.name, entry.column]
        return self.counts[entry.name] if entry.kind == "count" else self.choices[entry.name]

    def of(self, model: Model) -> _VariantColumns:
        """Return the columns of the same variants for another model: a question may compare slots by more of them."""
        if model not in self._of:
            self._of[model] = _VariantColumns(model, *self._made)
        return self._of[model]


def _evaluate(
    model: Model, instances: Sequence[Instance], columns: _VariantColumns, used: frozenset[str]
) -> Evaluation:
    """Evaluate all pairs of a question and a variant, question by question."""
    variables, data = _inputs(model, instances, columns, used)
    return model.evaluate(variables, data)


def _inputs(
    model: Model, instances: Sequence[Instance], columns: _VariantColumns, used: frozenset[str]
) -> tuple[FloatArray, list[InputValue]]:
    questions, count = len(instances), columns.count
    variables = np.tile(columns.values, (questions, 1))
    for k, variable in enumerate(model.variables):
        if variable.name in used:
            variables[:, k] = np.repeat([i.ranges.lower[k] for i in instances], count)
    values = [i.values for i in instances]
    requirements = {n: np.repeat([v.requirements[n] for v in values], count) for n in values[0].requirements}
    rows = {n: np.repeat([v.rows[n] for v in values], count) for n in values[0].rows}
    return variables, inputs_of(model, requirements, rows, lambda entry: np.tile(columns.column(entry), questions))


def _serves(
    model: Model, instances: Sequence[Instance], columns: _VariantColumns, used: frozenset[str], evaluation: Evaluation
) -> NDArray[np.bool_]:
    """Tell, per pair, whether all limits hold and the question allows these parts, counts, choices and sizes."""
    count = columns.count
    serves = evaluation.feasible & np.tile(columns.complete, len(instances))
    for q, instance in enumerate(instances):
        allowed = np.ones(count, dtype=bool)
        for slot in instance.selection.slots:
            allowed &= np.isin(columns.rows[slot.slot], slot.rows)
        for name, values in {**instance.selection.counts, **instance.selection.choices}.items():
            column = columns.counts[name] if name in columns.counts else columns.choices[name]
            allowed &= (np.abs(column[:, None] - values[None, :]) < MARGINS.step).any(axis=1)
        for k, variable in enumerate(model.variables):
            if variable.name not in used:
                low, high = instance.ranges.lower[k], instance.ranges.upper[k]
                column = columns.values[:, k]
                allowed &= within(column, low, high, MARGINS.end)
        pairs = slice(q * count, (q + 1) * count)
        allowed &= evaluation.take(pairs).also(instance.limits.judging).feasible
        compared = columns.of(instance.model)
        allowed &= compared.complete & ~_refused(instance.model, instance, compared, used)
        serves[pairs] &= allowed
    return np.asarray(serves)


def _refused(model: Model, instance: Instance, columns: _VariantColumns, used: frozenset[str]) -> NDArray[np.bool_]:
    """Mask of the variants that a refusal over several parts or counts forbids."""
    refused = np.zeros(columns.count, dtype=bool)
    if not instance.selection.joint_refusals:
        return refused
    _, data = _inputs(model, [instance], columns, used)
    known = {str(e.sx): np.asarray(v, dtype=float) for e, v in zip(model.data_inputs, data, strict=True)}
    for refusal in instance.selection.joint_refusals:
        function, names = model.numeric(refusal.when)
        forbidden = np.asarray(function.call([known[name][None, :] for name in names])[0].full()).ravel()
        refused |= np.broadcast_to(forbidden > 0.5, refused.shape)
    return refused


def _nearest_miss(model: Model, instance: Instance, q: int, columns: _VariantColumns, evaluation: Evaluation) -> str:
    """Text on the limits that the nearest variant misses: that whose most used limit is used least."""
    evaluated = evaluation.take(slice(q * columns.count, (q + 1) * columns.count)).also(instance.limits.judging)
    limits = (*model.constraints, *instance.limits.judging)
    missed = np.zeros((len(limits), columns.count))
    for k, x in enumerate(limits):
        share = missed_share(*evaluated.limits[x.name], x.sense, evaluated.scales[x.name])
        missed[k] = np.where(evaluated.holds[x.name], 0.0, np.nan_to_num(share, nan=np.inf))
    worst = np.where(columns.complete, missed.max(axis=0, initial=0.0), np.inf)
    nearest = int(np.argmin(worst))
    broken = {x.name: float(missed[k, nearest]) for k, x in enumerate(limits) if not evaluated.holds[x.name][nearest]}
    if not broken:
        return "the designs that keep its limits have parts, counts or sizes that it does not allow"
    units = {x.name: x.unit for x in limits}
    sides = {name: evaluated.limits[name] for name in most_used(broken)[:NAMED_LIMITS]}
    missed_by = (f"{n} by {miss_text(float(v[nearest]), float(x[nearest]), units[n])}" for n, (v, x) in sides.items())
    return f"the nearest design misses {', '.join(missed_by)}"


def pinned_by_all(questions: Iterable[RowQuestion], model: Model) -> frozenset[str]:
    """Variables that every question pins: they belong to the use, not to the variant."""
    variables, names = {v.name for v in model.variables}, model.declaration.names()
    common: set[str] | None = None
    for question in questions:
        pinned = {names.get(word, word) for word in question["fix"]} & variables
        common = pinned if common is None else common & pinned
    return frozenset(common or ())
