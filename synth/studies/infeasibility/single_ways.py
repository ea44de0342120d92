"""Ways out that change one thing alone: a requirement, a limit, a pin, a part or word, a column of a part."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from synth.analysis.fired_guards import FiredGuard, columns_of, requirements_of
from synth.model.constraint import SYMBOLS, Constraint
from synth.results import Design
from synth.studies.infeasibility.explained_question import ExplainedQuestion, Pin
from synth.studies.infeasibility.explanation import Relaxation, present_value, rounded
from synth.studies.infeasibility.least_amount import Giving, LeastAmount, RelaxedSearch
from synth.studies.infeasibility.patches import Patches, chosen_in
from synth.studies.infeasibility.relaxation import COLUMN, LIMIT, REQUIREMENT
from synth.text.numbers import more_or_less
from synth.units import typed_quantity

PIN, CHOICE = "pin", "choice"


@dataclass(frozen=True)
class Trial:
    """What is tried alone: its kind and name, and 1 or -1, upwards or downwards; 0 where either will do."""

    kind: str
    name: str
    sign: float = 0.0

    def __str__(self) -> str:
        return f"{self.kind} {self.name}" + {0.0: "", 1.0: " up", -1.0: " down"}[self.sign]


def trials(
    question: ExplainedQuestion, fired: Sequence[FiredGuard], conflict: Sequence[str], physics: bool
) -> list[Trial]:
    """Changes that are tried alone.

    Parameters
    ----------
    question : ExplainedQuestion
    fired : list of FiredGuard
        What is refused outright: then only what it depends on can help.
    conflict : list of str
        Limits that exclude each other.
    physics : bool
        Whether limits of the family may give way as well.
    """
    both = (1.0, -1.0)
    if fired:
        instance = question.instance
        moving = dict.fromkeys(name for guard in fired for name in requirements_of(instance, guard.name))
        columns = list(dict.fromkeys(name for guard in fired for name in columns_of(instance, guard.name)))
        requirements = [name for name in moving if instance.values.requirements[name] > 0]
    else:
        bound = [*conflict, *question.guards]
        requirements = question.moving(REQUIREMENT, bound)
        columns = list(dict.fromkeys(question.moving(COLUMN, bound)))
    user_limits = {x.name for x in question.user_limits}
    giving = [x for x in conflict if x in question.giving]
    limits = [x for x in giving if x in user_limits]
    if physics:
        # Where a limit is a requirement, the requirement is what a user can change.
        limits += [x for x in giving if x not in user_limits and not question.requirement_of(x)]
    return [
        *(Trial(LIMIT, x, question.sign(x)) for x in limits),
        *(Trial(PIN, name) for name in question.pins),
        *(Trial(REQUIREMENT, name, sign) for name in requirements for sign in both),
        *(Trial(CHOICE, name) for name in question.words()),
        *(Trial(COLUMN, name, sign) for name in columns for sign in both),
    ]


class SingleWays:
    """Finds what one thing alone must become.

    Parameters
    ----------
    search : RelaxedSearch
    patches : Patches
    """

    def __init__(self, search: RelaxedSearch, patches: Patches) -> None:
        self.search, self.patches, self.question = search, patches, search.question

    def way(self, trial: Trial) -> Relaxation | str | None:
        """Value that one thing alone must take; None where nothing would do, a sentence where that is not settled.

        Raises
        ------
        Stopped
            When time is over.
        """
        if trial.kind == CHOICE:
            return self._chosen(trial.name)
        nothing, most = self.search.ways.nothing, self.search.ways.farthest
        if trial.kind == REQUIREMENT:
            most = self.question.reach(trial.name, trial.sign, most)
        if most <= nothing:
            return None
        least = self.search.least(self._giving(trial, most))
        if least.design is None:
            value = {0.0: "another", 1.0: "a larger", -1.0: "a smaller"}[trial.sign]
            return None if least.closed else f"{trial.name}: whether {value} value alone would do is not settled"
        if trial.kind == PIN:
            return self._repinned(self.question.pins[trial.name], least, least.design)
        limit = self.question.user_limit(trial.name) if trial.kind == LIMIT else None
        way = self._moved(trial, limit, least, least.design)
        if way.patch is None and (trial.kind == REQUIREMENT or limit is not None):
            # Within the tolerance of a limit both sides of a refusal look allowed.
            return None if least.amount <= nothing else f"{way.sentence}: not shown to do as it is written"
        return way

    def _giving(self, trial: Trial, most: float) -> Giving:
        """Relaxed requirement of a trial."""
        if trial.kind == PIN:
            return Giving(give={}, most=most, pins=[self.question.pins[trial.name]])
        names = self.question.at_corners(trial.name) if trial.kind == LIMIT else [trial.name]
        return Giving(give={(trial.kind, x): trial.sign for x in names}, most=most)

    # -- other values --------------------------------------------------------------------------

    def _moved(self, trial: Trial, limit: Constraint | None, least: LeastAmount, design: Design) -> Relaxation:
        """Return the way out by another value of a requirement, a limit or a column of a part."""
        up, factor = trial.sign > 0, math.exp(trial.sign * least.amount)
        if trial.kind == REQUIREMENT:
            value = self._requirement(trial.name, up, factor, design)
        elif limit is not None:
            value = self._user_limit(limit, up, factor, design)
        elif trial.kind == LIMIT:
            value = self._family_limit(trial.name, up, factor, design)
        else:
            value = self._column(trial.name, up, factor, design)
        amount = abs(factor - 1.0)
        return Relaxation(
            kind={REQUIREMENT: "requirement", LIMIT: "limit", COLUMN: "part"}[trial.kind],
            name=trial.name,
            sense="at_least" if up else "at_most",
            given=value.present,
            needed=value.needed,
            unit=value.unit,
            amount=amount,
            # The part that would do is none of the table: what it would give is the design of the relaxed question.
            # So it is of a limit of the family, too.
            design=design if value.patch is None else self.patches.original(design, value.patch),
            proven=least.closed,
            sentence=f"{value.words} ({more_or_less(amount, up)})",
            patch=value.patch,
        )

    def _requirement(self, name: str, up: bool, factor: float, design: Design) -> _Value:
        instance = self.question.instance
        present, unit = instance.values.requirements[name], instance.model.declaration.requirements[name].unit
        patch, needed = self.patches.first_that_works(
            lambda text: self.patches.requirement(name, text), present * factor, unit, up, design
        )
        words = f"{name} {needed} instead of {present_value(present, unit)}"
        return _Value(present, present * factor, unit, words, patch)

    def _user_limit(self, limit: Constraint, up: bool, factor: float, design: Design) -> _Value:
        bound = limit.bound
        factor = 1 / factor if bound < 0 else factor
        patch, needed = self.patches.first_that_works(
            lambda text: self.patches.limits({limit.name: text}), bound * factor, limit.unit, up, design
        )
        words = f"limit {limit.quantity} {SYMBOLS[limit.sense]} {needed} instead of {present_value(bound, limit.unit)}"
        return _Value(bound, bound * factor, limit.unit, words, patch)

    def _family_limit(self, name: str, up: bool, factor: float, design: Design) -> _Value:
        unit, bound = self.question.by_name[name].unit, self.patches.original(design).limits[name][1]
        factor = 1 / factor if bound < 0 else factor
        needed = rounded(bound * factor, unit, "at_least" if up else "at_most")
        return _Value(bound, bound * factor, unit, f"limit {name} {needed} instead of {present_value(bound, unit)}")

    def _column(self, name: str, up: bool, factor: float, design: Design) -> _Value:
        part, column = self.question.columns[name], name.split(".", 1)[1]
        row = design.parts[part.slot]
        present = next(row[c] for c in column.split("|") if row.get(c) is not None)
        tables = self.question.request.catalogs
        unit = tables.table(part.table).columns[column.split("|")[0]].unit or "-"
        needed = rounded(present * factor, unit, "at_least" if up else "at_most")
        words = f"a {part.slot} with {column} {'>=' if up else '<='} {needed} would do; "
        return _Value(present, present * factor, unit, f"{words}{row} has {present_value(present, unit)}")

    # -- what was asked outright ---------------------------------------------------------------

    def _repinned(self, pin: Pin, least: LeastAmount, design: Design) -> Relaxation | None:
        """Return the way out by another value of what is pinned."""
        value = design.values[pin.name]
        present = pin.high if value > pin.high else pin.low
        patch = self.patches.pin(pin, typed_quantity(value, pin.unit, None))
        if not self.patches.works(patch, design):
            return None
        amount, more = abs(value / present - 1.0), value > present
        shown = f"{pin.name} {present_value(value, pin.unit)} instead of {present_value(present, pin.unit)}"
        return Relaxation(
            kind="fix" if pin.key == "fix" else "limit",
            name=pin.name,
            sense="at_least" if more else "at_most",
            given=present,
            needed=value,
            unit=pin.unit,
            amount=amount,
            design=self.patches.original(design, patch),
            proven=least.closed,
            sentence=f"{shown} ({more_or_less(amount, more)})",
            patch=patch,
        )

    def _chosen(self, name: str) -> Relaxation | str | None:
        """Return the way out by another part or word than those asked for."""
        least = self.search.least(Giving(give={}, free=[name]))
        if least.design is None:
            return None if least.closed else f"{name}: whether another choice alone would do is not settled"
        patch = self.patches.choices(least.design, [name])
        if not self.patches.works(patch, least.design):
            return None
        words = f"{name} {chosen_in(least.design, name)} in place of what was asked"
        design = self.patches.original(least.design, patch)
        return Relaxation("choice", name, "", math.nan, math.nan, "-", math.nan, design, True, words, patch)


@dataclass(frozen=True)
class _Value:
    """A value as asked and as needed, in SI, in words, and as entries of a spec where one can state it."""

    present: float
    needed: float
    unit: str
    words: str
    patch: Mapping[str, Any] | None = None
