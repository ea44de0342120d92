"""Changes of a question as entries of a spec, and the designs of the question that is changed so."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from synth.analysis.designs import make_design, make_frame
from synth.analysis.evaluate import evaluate
from synth.declaration import Origin
from synth.errors import InputError
from synth.model.constraint import SYMBOLS
from synth.question.instance import Instance
from synth.question.request import Request
from synth.question.selection import part_row
from synth.question.spec_patch import patched
from synth.results import Design
from synth.robust.counterpart import nominal, robust_counterpart
from synth.studies.infeasibility.explained_question import ExplainedQuestion, Pin
from synth.studies.infeasibility.explanation import roundings
from synth.studies.infeasibility.relaxation import AMOUNT
from synth.units import typed_quantity


def chosen_in(design: Design, name: str) -> str:
    """Return the part or word that a design has for a slot or choice."""
    return str(design.parts[name]) if name in design.parts else str(design.choices[name])


class Patches:
    """States changes of a question in the words of its user, and tells what they do.

    Parameters
    ----------
    question : ExplainedQuestion
    slack : float
        Relative: how far outside its bounds a variable of a design may lie, by rounding.
    """

    def __init__(self, question: ExplainedQuestion, slack: float) -> None:
        self.question, self.request, self.slack = question, question.request, slack

    # -- changes -------------------------------------------------------------------------------

    def requirement(self, name: str, text: str) -> dict[str, Any]:
        """Return the entry with another value of a requirement."""
        return {"requirements": {self._word("requirements", name): text}}

    def limits(self, texts: Mapping[str, str]) -> dict[str, Any]:
        """Return the entries of ``limits`` with other bounds for some limits of the user's own."""
        user_limits = self.question.user_limits
        entries: dict[str, Any] = {}
        for quantity in sorted({x.quantity for x in user_limits if x.name in texts}):
            same = [x for x in user_limits if x.quantity == quantity and x.origin is Origin.USER]
            bounds = [f"{SYMBOLS[x.sense]} {texts.get(x.name) or typed_quantity(x.bound, x.unit, None)}" for x in same]
            entries[self._word("limits", quantity)] = bounds[0] if len(bounds) == 1 else bounds
        return {"limits": entries} if entries else {}

    def pin(self, pin: Pin, text: str) -> dict[str, Any]:
        """Return the entry with another value of what is pinned."""
        if pin.key == "fix":
            return {"fix": {self._word("fix", pin.name): text}}
        ends = min(pin.low, float(text)), max(pin.high, float(text))
        return {"limits": {self._word("limits", pin.name): f"{ends[0]:g} .. {ends[1]:g}"}}

    def choices(self, design: Design, names: Sequence[str]) -> dict[str, Any]:
        """Return the entries with the parts and words of a design."""
        question = self.question
        patch: dict[str, Any] = {}
        for name in names:
            key = "fix" if name in question.fix else "parts"
            chosen = chosen_in(design, name)
            patch = patched(patch, {key: {self._word(key, name): chosen if key == "fix" else [chosen]}})
            if key == "fix" and name in question.parts:
                patch = patched(patch, {"parts": {self._word("parts", name): [chosen]}})
        return patch

    def _word(self, key: str, name: str) -> str:
        """User's name for something under a key of the spec; its own name where it does not stand there."""
        entries, names = getattr(self.request, key), self.question.names
        return next((str(word) for word in entries if names.get(str(word)) == name), name)

    # -- what they do --------------------------------------------------------------------------

    def works(self, patch: Mapping[str, object], relaxed: Design) -> bool:
        """True if a design is one of the question with a patch."""
        request = self._with(patch)
        try:
            problem = robust_counterpart(nominal(request.problem), request.robust, request.limits)
            instance = Instance(replace(request, problem=problem))
            design = self.original(relaxed, patch)
            instance.combinations.number(design)
        except InputError:
            return False
        values = [design.values[v.name] for v in instance.model.variables]
        inside = all(
            low - self.slack * abs(low) <= x <= high + self.slack * abs(high)
            for x, low, high in zip(values, instance.ranges.lower, instance.ranges.upper, strict=True)
        )
        return inside and not design.violated

    def first_that_works(
        self, patch: Callable[[str], Mapping[str, object]], needed: float, unit: str, up: bool, design: Design
    ) -> tuple[Mapping[str, Any] | None, str]:
        """Return the patch with the value nearest to what is needed that surely does, and that value.

        Parameters
        ----------
        patch : callable
            Takes the value as text with its unit.
        needed : float
            In SI.
        unit : str
        up : bool
            Whether larger values do as well; otherwise smaller ones.
        design : Design
            That the question with the patch must allow.
        """
        texts = roundings(needed, unit, up)
        for text in texts:
            if self.works(patch(text), design):
                return patch(text), text
        return None, texts[0]

    def original(self, relaxed: Design, patch: Mapping[str, object] | None = None) -> Design:
        """Return a design of the relaxed question as one of the question itself, or of that with a patch."""
        kinds = {name: kind for name, kind in relaxed.frame.kinds.items() if name != AMOUNT}
        without_amount = replace(relaxed, frame=replace(relaxed.frame, kinds=kinds))
        request, problem = self._with(patch or {}), self.question.instance.problem
        if patch is not None:
            problem = robust_counterpart(nominal(request.problem), request.robust, request.limits)
        return evaluate(problem, request.requirements, without_amount, catalogs=request.catalogs, limits=request.limits)

    def missing(self, relaxed: Design) -> Design:
        """Return a design of the relaxed question as it stands in the question, also where it is refused there."""
        instance = self.question.instance
        number = instance.combinations.number(relaxed)
        variables = np.array([[relaxed.values[v.name] for v in instance.model.variables]])
        result = instance.evaluate(variables, instance.data(np.array([number])))
        rows = {slot: part_row(table, row) for slot, (table, row) in instance.combinations.describe(number)[0].items()}
        return make_design(instance, make_frame(instance, {}), variables[0], result, 0, rows, relaxed.choices)

    def _with(self, patch: Mapping[str, object]) -> Request:
        """Return the request with a patch."""
        entries = {key: getattr(self.request, key) for key in ("requirements", "limits", "fix", "parts")}
        return replace(self.request, **patched(entries, patch))
