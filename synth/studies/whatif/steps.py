"""The questions of a study: one for each value of what is varied, all checked beforehand."""

from __future__ import annotations

import math
import re
from collections.abc import Mapping, Sequence
from dataclasses import replace
from itertools import product
from typing import Any

from synth.declaration import Declaration
from synth.errors import InputError
from synth.model.problem import DesignProblem
from synth.question.arguments import Pins, Variations
from synth.question.count_domain import entries
from synth.question.objectives import chosen_objectives
from synth.question.request import Request
from synth.question.settings import SearchSettings
from synth.question.uncertainty import RATE, Uncertainty, name_in_block, read_remaining
from synth.question.user_limits import SENSES
from synth.results import Design
from synth.robust.counterpart import robust_counterpart
from synth.robust.rating import Rater
from synth.robust.uncertainty import check_rows
from synth.search.question import Question, pose
from synth.search.settings import TUNING, Tuning
from synth.studies.whatif.vary import Value, Varied, read_vary


def at_value(request: Request, varied: Varied, value: Value) -> Request:
    """Request with one entry at a value, which replaces an earlier one."""
    name, typed = varied.name, varied.spec_value(value)
    if varied.kind == "requirement":
        return replace(request, requirements={**_without(request, request.requirements, name), name: typed})
    if varied.kind == "weight":
        return replace(request, weights={**_without(request, request.weights, name), name: typed})
    if varied.kind == "part":
        return replace(request, parts={**_without(request, request.parts, name), name: typed})
    if varied.kind == "option":
        return replace(request, problem=_with_option(request, name, str(value)))
    if varied.kind == "scatter":
        return replace(request, robust=_scattering(request, name, str(value)))
    kept = _other_limits(request, varied)
    return replace(request, limits={**_without(request, request.limits, name), name: [*kept, f"{varied.sign} {typed}"]})


def _rater_of(request: Request) -> Rater | None:
    """Rating function over the range; None where nothing scatters.

    Raises
    ------
    InputError
        When the range does not fit what is asked.
    """
    if request.robust is None:
        return None
    return Rater(request, request.robust)


def _with_option(request: Request, name: str, word: str) -> DesignProblem:
    """Return the problem with another word for an option."""
    problem = request.problem
    option = _declared(request).options[name]
    others = {n: w for n, w in problem.options.items() if n not in (name, option.symbol)}
    return type(problem)(**{**others, name: word})


def _scattering(request: Request, name: str, text: str) -> Uncertainty | None:
    """Scatter of a problem, with one entry over another range or, for "none", without it."""
    names = _declared(request).names()

    def others(ranges: Mapping[str, object]) -> dict[str, Any]:
        return {key: value for key, value in ranges.items() if name_in_block(key, names) != name}

    block = {} if request.robust is None else others(request.robust.block())
    if "tolerance" in block:
        block["tolerance"] = others(block["tolerance"])
    return read_remaining({**block, name: text})


def _without(request: Request, entries: Mapping[str, object], name: str) -> dict[str, Any]:
    """Values given by name or symbol, without one name."""
    spellings = _declared(request).names()
    return {word: value for word, value in entries.items() if spellings.get(str(word)) != name}


def _declared(request: Request) -> Declaration:
    return request.problem.model(frozenset(), request.catalogs).declaration


def _other_limits(request: Request, varied: Varied) -> list[str]:
    """Return the limits on the quantity of a varied one that point another way."""
    spellings, kept = _declared(request).names(), list[str]()
    for word, texts in request.limits.items():
        if spellings.get(str(word)) == varied.name:
            for text in entries(texts):
                low, dots, high = str(text).partition("..")
                for one in [f">= {low.strip()}", f"<= {high.strip()}"] if dots else [str(text)]:
                    sign = re.match(r"^\s*(<=|>=|==|=|<|>)", one)
                    if sign is None or SENSES[sign.group(1)] != SENSES[varied.sign]:
                        kept.append(one)
    return kept


def check_steps(request: Request, settings: SearchSettings, vary: Variations, most: int) -> tuple[list[str], int]:
    """Refuse what a study would refuse before it is searched, as far as some of its steps tell.

    Parameters
    ----------
    request, settings, vary
        As for :class:`Steps`.
    most : int
        Steps that are posed, spread evenly from the first to the last.

    Returns
    -------
    tuple
        What is varied in words, and how many steps there are.

    Raises
    ------
    InputError
        For whatever is wrong at any of these.
    """
    steps = Steps(request, settings, vary, most=most)
    labels = [f"{x.label} {x.shown(x.values[0])} .. {x.shown(x.values[-1])}" for x in steps.varied]
    return labels, math.prod(len(x.values) for x in steps.varied)


def _spread(values: Sequence[Any], most: int) -> list[Any]:
    """Return at most so many of some values, spread evenly, the first and the last among them."""
    if len(values) <= most:
        return list(values)
    return [values[round(k * (len(values) - 1) / (most - 1))] for k in range(most)]


class Steps:
    """The questions of a study, in their order: of two things varied the second runs through for each of the first.

    Parameters
    ----------
    request : Request
        What stays.
    settings : SearchSettings
        How every step is searched; the time limit is that of the whole study.
    vary : mapping
        What does not.
    tuning : Tuning
    most : int, optional
        Steps that are looked at, where not all are wanted.

    Raises
    ------
    InputError
        For whatever is wrong at any step, before anything is searched.
    """

    def __init__(
        self,
        request: Request,
        settings: SearchSettings,
        vary: Variations,
        tuning: Tuning = TUNING,
        most: int | None = None,
    ) -> None:
        self.request, self.settings, self.tuning = request, settings, tuning
        d = _declared(request)
        keys = [str(k) for k in vary] if isinstance(vary, Mapping) else []
        named = {d.names().get(str(w)) for w in [*request.requirements, *keys]} & set(d.requirements)
        model = request.problem.model(frozenset(n for n in named if n is not None), request.catalogs)
        self.varied = read_vary(vary, model, list(chosen_objectives(model, request.objectives)))
        grid = list(product(*(x.values for x in self.varied)))
        self.values = grid if most is None else _spread(grid, most)
        self._problems: dict[Value, DesignProblem] = {}
        self._with_limits: dict[tuple[DesignProblem, str], DesignProblem] = {}
        self._learned: dict[tuple[str, ...], Uncertainty] = {}
        self.raters: list[Rater | None] = []  # by step; None where nothing scatters
        self.questions = self._questions()
        self.combinations = max(q.instance.combinations.count for q in self.questions)  # of the largest step

    def __len__(self) -> int:
        return len(self.values)

    def one_best(
        self,
        values: Sequence[Value],
        objective: Mapping[str, str],
        gap: float,
        slots: Mapping[str, list[str]],
        pins: Pins,
    ) -> Question:
        """Return the question for the best design in one objective at some values, among some parts.

        Parameters
        ----------
        values : list
            One per thing varied.
        objective : mapping
            The objective with its sense.
        gap : float
        slots : mapping
            Slot -> the designations that may fill it; others stay as they are asked.
        pins : mapping
            Counts and choices -> the value that they must have.
        """
        request = replace(self._at(values), objectives=dict(objective), weights={})
        for slot, rows in slots.items():
            request = replace(request, parts={**_without(request, request.parts, slot), slot: rows})
        for name, value in pins.items():
            request = replace(request, fix={**_without(request, request.fix, name), name: value})
        return self._pose(self._with_learned(request), replace(self.settings, points=1, gap=gap))

    def question(self, position: int, robust: Uncertainty) -> Question:
        """Return the question of a step with limits posed for another block of what scatters."""
        request = replace(self._at(self.values[position]), robust=robust)
        return self._pose(request, self.settings)

    def learn(self, robust: Uncertainty) -> None:
        """Take note where designs of a step failed within a range: there limits are posed between the steps as well."""
        known = self._learned.get(robust.names)
        self._learned[robust.names] = robust if known is None else known.with_scenarios(robust.scenarios)

    def stands(self, values: Sequence[Value], design: Design) -> bool:
        """True if a design is shown to keep its limits over the whole range, if that is asked at some values."""
        rater = _rater_of(self._at(values))
        return rater is None or rater.uncertainty.mode == RATE or bool(rater.one(design)["holds"])

    def _with_learned(self, request: Request) -> Request:
        if request.robust is None or request.robust.names not in self._learned:
            return request
        return replace(request, robust=request.robust.with_scenarios(self._learned[request.robust.names].scenarios))

    def _pose(self, request: Request, settings: SearchSettings) -> Question:
        """Return a question; limits that are posed alike at several steps are traced once."""
        key = request.problem, repr((request.robust, request.limits))
        if key not in self._with_limits:
            self._with_limits[key] = robust_counterpart(request.problem, request.robust, request.limits)
        return pose(request, settings.within(None), self._with_limits[key], self.tuning)

    def text(self, values: Sequence[Value]) -> str:
        """Return the values of a step for people."""
        return ", ".join(x.text(v) for x, v in zip(self.varied, values, strict=True))

    def _at(self, values: Sequence[Value]) -> Request:
        request = self.request
        for varied, value in zip(self.varied, values, strict=True):
            if varied.kind == "option":
                # One problem per word, so that each is traced once.
                if value not in self._problems:
                    self._problems[value] = at_value(request, varied, value).problem
                request = replace(request, problem=self._problems[value])
            else:
                request = at_value(request, varied, value)
        return request

    def _questions(self) -> list[Question]:
        """Return the question of every step; what is wrong with all of them is no matter of the values."""
        questions, faults = list[Question](), dict[int, InputError]()
        for k, values in enumerate(self.values):
            try:
                request = self._at(values)
                rater, question = _rater_of(request), self._pose(request, self.settings)
                if rater is not None:
                    check_rows(rater.quantities, question.instance.selection.slots)
                questions.append(question)
                self.raters.append(rater)
            except InputError as error:
                faults[k] = error
        if not faults:
            return questions
        first, fault = next(iter(faults.items()))
        same = len({(e.path, e.field, e.expected, repr(e.value)) for e in faults.values()}) == 1
        if same and len(faults) == len(self.values) > 1:
            raise fault
        where = f"vary, {self.text(self.values[first])}: {fault.field}"
        raise InputError(where, fault.value, fault.expected, fault.path)
