"""Ways out by all that was asked together, or by all limits together, each by the same fraction."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from synth.bounds.structure import classified
from synth.model.constraint import SYMBOLS
from synth.question.spec_patch import patched
from synth.results import Design
from synth.studies.infeasibility.explained_question import ExplainedQuestion
from synth.studies.infeasibility.explanation import Relaxation, present_value, roundings
from synth.studies.infeasibility.least_amount import Giving, LeastAmount, RelaxedSearch
from synth.studies.infeasibility.patches import Patches, chosen_in
from synth.studies.infeasibility.relaxation import LIMIT, REQUIREMENT
from synth.studies.infeasibility.single_ways import PIN
from synth.text.numbers import percent
from synth.units import typed_quantity


def widened(patches: Patches, least: LeastAmount, design: Design) -> Relaxation:
    """Return the relaxation of all limits by the same fraction."""
    shown, amount = patches.original(design), math.expm1(least.amount)
    sentence = f"all limits wider by {percent(amount)}; that concerns {', '.join(shown.violated) or 'none'}"
    return Relaxation("physics", "all limits", "", math.nan, math.nan, "-", amount, shown, least.closed, sentence)


@dataclass(frozen=True)
class _Change:
    """One of several things that give way together: what people call it, its values there, and the present one."""

    kind: str
    name: str
    shown: str
    texts: tuple[str, ...]  # the first is nearest, each other one further on the side where it does
    present: str
    rounded: str = ""  # shown in place of the text, where that has all digits

    def words(self, k: int) -> str:
        """Changes at the k-th of the values."""
        return f"{self.shown} {self.rounded or self.texts[k]} instead of {self.present}"


class JointWay:
    """Finds the change of everything that the user asked, by the same fraction, and of no more than is needed.

    Parameters
    ----------
    search : RelaxedSearch
    patches : Patches
    single : list of Relaxation
        Ways out by one change: they show in which direction a requirement is easier.
    conflict : list of str
        Limits that exclude each other.
    """

    def __init__(
        self, search: RelaxedSearch, patches: Patches, single: Sequence[Relaxation], conflict: Sequence[str]
    ) -> None:
        self.search, self.patches, self.question = search, patches, search.question
        flat, requirements = search.ways.flat, self.question.requirements
        directions = {name: direction(self.question, name, single, conflict, flat) for name in requirements}
        self.directions = {name: sign for name, sign in directions.items() if sign}
        farthest = search.ways.farthest
        self.rooms = {name: self.question.reach(name, sign, farthest) for name, sign in self.directions.items()}
        self.user_limits = [x.name for x in self.question.user_limits if x.name in self.question.giving]

    def way(self) -> Relaxation | None:
        """Return the change; None where nothing can give way, or all together does not help.

        Raises
        ------
        Stopped
            When time is over.
        """
        question, pins = self.question, list(self.question.pins.values())
        if not self.directions and not self.user_limits and not pins:
            return None
        give = {(REQUIREMENT, name): sign for name, sign in self.directions.items()}
        give |= {(LIMIT, x): question.sign(x) for name in self.user_limits for x in question.at_corners(name)}
        least = self.search.least(Giving(give=give, pins=pins, rooms=self.rooms))
        freed: list[str] = []
        if least.design is None and question.words():
            freed = question.words()
            least = self.search.least(Giving(give=give, pins=pins, rooms=self.rooms, free=freed))
        return None if least.design is None else self._relaxation(least, least.design, freed)

    def _relaxation(self, least: LeastAmount, design: Design, freed: Sequence[str]) -> Relaxation | None:
        """Return the change that leads to a design; ``freed``: slots and choices in which anything was allowed."""
        needed = self._needed(self._changes(least, design), self.patches.choices(design, freed), design)
        if needed is None:
            return None
        patch, shown = needed
        amount = math.expm1(least.amount)
        shown += [f"{name} {chosen_in(design, name)}" for name in freed]
        sentence = f"together, each by {percent(amount)}: {'; '.join(shown)}"
        # A design that the original question does not offer is evaluated with the patch.
        offered = all(pin.low <= design.values[x] <= pin.high for x, pin in self.question.pins.items())
        outcome = self.patches.missing(design) if offered and not freed else self.patches.original(design, patch)
        return Relaxation(
            "joint", "all that was asked", "", math.nan, math.nan, "-", amount, outcome, least.closed, sentence, patch
        )

    # -- what changes --------------------------------------------------------------------------

    def _changes(self, least: LeastAmount, design: Design) -> list[_Change]:
        """Return everything that gives way, with its value there."""
        return [*self._requirements(least.amount), *self._limits(least.amount), *self._pins(design)]

    def _requirements(self, amount: float) -> list[_Change]:
        instance, changes = self.question.instance, list[_Change]()
        for name, sign in self.directions.items():
            r, present = instance.model.declaration.requirements[name], instance.values.requirements[name]
            needed = min(max(present * math.exp(sign * min(amount, self.rooms[name])), r.lower), r.upper)
            texts = roundings(needed, r.unit, sign > 0)
            changes.append(_Change(REQUIREMENT, name, name, texts, present_value(present, r.unit)))
        return changes

    def _limits(self, amount: float) -> list[_Change]:
        changes = []
        for x in (x for x in self.question.user_limits if x.name in self.user_limits):
            factor = math.exp(self.question.sign(x.name) * amount * (1 if x.bound > 0 else -1))
            texts = roundings(x.bound * factor, x.unit, x.sense == "at_most")
            shown = f"limit {x.quantity} {SYMBOLS[x.sense]}"
            changes.append(_Change(LIMIT, x.name, shown, texts, present_value(x.bound, x.unit)))
        return changes

    def _pins(self, design: Design) -> list[_Change]:
        changes = []
        for pin in self.question.pins.values():
            value = design.values[pin.name]
            if not pin.low <= value <= pin.high:
                end = pin.high if value > pin.high else pin.low
                texts = (typed_quantity(value, pin.unit, None),) * self.search.ways.further
                shown, present = present_value(value, pin.unit), present_value(end, pin.unit)
                changes.append(_Change(PIN, pin.name, pin.name, texts, present, shown))
        return changes

    def _needed(
        self, changes: Sequence[_Change], choices: Mapping[str, object], design: Design
    ) -> tuple[dict[str, Any], list[str]] | None:
        """Return the patch of as few changes as the design needs, and their words."""
        for k in range(self.search.ways.further):
            if not self.patches.works(self._together(changes, k, choices), design):
                continue
            kept = list(changes)
            for change in changes:
                fewer = [x for x in kept if x is not change]
                if self.patches.works(self._together(fewer, k, choices), design):
                    kept = fewer
            return self._together(kept, k, choices), [x.words(k) for x in kept]
        return None

    def _together(self, changes: Sequence[_Change], k: int, choices: Mapping[str, object]) -> dict[str, Any]:
        """Return several changes as one patch."""
        patch = dict(choices)
        for x in changes:
            if x.kind == REQUIREMENT:
                patch = patched(patch, self.patches.requirement(x.name, x.texts[k]))
            elif x.kind == PIN:
                patch = patched(patch, self.patches.pin(self.question.pins[x.name], x.texts[k]))
        return patched(patch, self.patches.limits({x.name: x.texts[k] for x in changes if x.kind == LIMIT}))


def direction(
    question: ExplainedQuestion, name: str, single: Sequence[Relaxation], conflict: Sequence[str], flat: float
) -> float:
    """Direction in which a requirement asks less: as it helps alone, as a limit, or by the signs of all limits.

    Parameters
    ----------
    question : ExplainedQuestion
    name : str
        Of the requirement.
    single : list of Relaxation
        Ways out by one thing alone.
    conflict : list of str
        Limits that exclude each other.
    flat : float
        Elasticities below this are none.

    Returns
    -------
    float
        1 or -1, upwards or downwards; 0 where neither is known to ask less.
    """
    if not question.instance.values.requirements[name] > 0:
        return 0.0
    by_itself = [way for way in single if way.kind == "requirement" and way.name == name]
    if by_itself:
        return 1.0 if min(by_itself, key=lambda x: x.amount).sense == "at_least" else -1.0
    for limit in question.giving:
        if question.requirement_of(limit) == name:
            return question.sign(limit)
    model = question.instance.model
    position = model.input_number["requirement", name, ""] - len(model.variables)
    shapes = classified(model, question.request.catalogs)
    for names in (question.limits, conflict):
        ends = [shapes.limits[x] for x in names if x in shapes.limits]
        spans = [x.elasticity[question.followers(position)] for x in ends if x.sign == 1]
        low, high = min((s.min() for s in spans), default=0.0), max((s.max() for s in spans), default=0.0)
        if low >= -flat and high > flat:
            return -1.0
        if high <= flat and low < -flat:
            return 1.0
    return 0.0
