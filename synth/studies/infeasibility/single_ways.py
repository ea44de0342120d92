"""Ways out that change one thing alone: a requirement, a limit, a pin, a part or word, a column of a part."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from synth.analysis.fired_guards import FiredGuard, columns_of, requirements_of
from synth.model.constraint import SIGNS, Constraint
from synth.results import Design
from synth.studies.infeasibility.explained_question import ExplainedQuestion, Pin
from synth.studies.infeasibility.explanation import Relaxation, as_given, rounded
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
    own = {x.name for x in question.own}
    giving = [x for x in conflict if x in question.giving]
    limits = [x for x in giving if x in own]
    if physics:
        # Where a limit is a requirement, the requirement is what a user can change.
        limits += [x for x in giving if x not in own and not question.requirement_of(x)]
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
            most = self.question.room(trial.name, trial.sign, most)
        if most <= nothing:
            return None
        found = self.search.least(self._giving(trial, most))
        if found.design is None:
            value = {0.0: "another", 1.0: "a larger", -1.0: "a smaller"}[trial.sign]
            return None if found.closed else f"{trial.name}: whether {value} value alone would do is not settled"
        if trial.kind == PIN:
            return self._repinned(self.question.pins[trial.name], found, found.design)
        own = self.question.own_limit(trial.name) if trial.kind == LIMIT else None
        way = self._moved(trial, own, found, found.design)
        if way.patch is None and (trial.kind == REQUIREMENT or own is not None):
            # Within the tolerance of a limit both sides of a refusal look allowed.
            return None if found.amount <= nothing else f"{way.sentence}: not shown to do as it is written"
        return way

    def _giving(self, trial: Trial, most: float) -> Giving:
        """Relaxed requirement of a trial."""
        if trial.kind == PIN:
            return Giving(give={}, most=most, pins=[self.question.pins[trial.name]])
        names = self.question.at_corners(trial.name) if trial.kind == LIMIT else [trial.name]
        return Giving(give={(trial.kind, x): trial.sign for x in names}, most=most)

    # -- other values --------------------------------------------------------------------------

    def _moved(self, trial: Trial, own: Constraint | None, found: LeastAmount, design: Design) -> Relaxation:
        """Return the way out by another value of a requirement, a limit or a column of a part."""
        up, factor = trial.sign > 0, math.exp(trial.sign * found.amount)
        if trial.kind == REQUIREMENT:
            value = self._requirement(trial.name, up, factor, design)
        elif own is not None:
            value = self._own_limit(own, up, factor, design)
        elif trial.kind == LIMIT:
            value = self._family_limit(trial.name, up, factor, design)
        else:
            value = self._column(trial.name, up, factor, design)
        amount = abs(factor - 1.0)
        return Relaxation(
            kind={REQUIREMENT: "requirement", LIMIT: "limit", COLUMN: "part"}[trial.kind],
            name=trial.name,
            sense="at_least" if up else "at_most",
            given=value.given,
            needed=value.needed,
            unit=value.unit,
            amount=amount,
            # The part that would do is none of the table: what it would give is the design of the relaxed question.
            # So it is of a limit of the family, too.
            design=design if value.patch is None else self.patches.as_asked(design, value.patch),
            proven=found.closed,
            sentence=f"{value.words} ({more_or_less(amount, up)})",
            patch=value.patch,
        )

    def _requirement(self, name: str, up: bool, factor: float, design: Design) -> _Value:
        instance = self.question.instance
        given, unit = instance.values.requirements[name], instance.model.declaration.requirements[name].unit
        patch, needed = self.patches.first_that_works(
            lambda text: self.patches.requirement(name, text), given * factor, unit, up, design
        )
        words = f"{name} {needed} instead of {as_given(given, unit)}"
        return _Value(given, given * factor, unit, words, patch)

    def _own_limit(self, own: Constraint, up: bool, factor: float, design: Design) -> _Value:
        given = own.bound
        factor = 1 / factor if given < 0 else factor
        patch, needed = self.patches.first_that_works(
            lambda text: self.patches.limits({own.name: text}), given * factor, own.unit, up, design
        )
        words = f"limit {own.quantity} {SIGNS[own.sense]} {needed} instead of {as_given(given, own.unit)}"
        return _Value(given, given * factor, own.unit, words, patch)

    def _family_limit(self, name: str, up: bool, factor: float, design: Design) -> _Value:
        unit, given = self.question.by_name[name].unit, self.patches.as_asked(design).limits[name][1]
        factor = 1 / factor if given < 0 else factor
        needed = rounded(given * factor, unit, "at_least" if up else "at_most")
        return _Value(given, given * factor, unit, f"limit {name} {needed} instead of {as_given(given, unit)}")

    def _column(self, name: str, up: bool, factor: float, design: Design) -> _Value:
        part, column = self.question.columns[name], name.split(".", 1)[1]
        row = design.parts[part.slot]
        given = next(row[c] for c in column.split("|") if row.get(c) is not None)
        tables = self.question.request.catalogs
        unit = tables.table(part.table).columns[column.split("|")[0]].unit or "-"
        needed = rounded(given * factor, unit, "at_least" if up else "at_most")
        words = f"a {part.slot} with {column} {'>=' if up else '<='} {needed} would do; "
        return _Value(given, given * factor, unit, f"{words}{row} has {as_given(given, unit)}")

    # -- what was asked outright ---------------------------------------------------------------

    def _repinned(self, pin: Pin, found: LeastAmount, design: Design) -> Relaxation | None:
        """Return the way out by another value of what is pinned."""
        value = design.values[pin.name]
        given = pin.high if value > pin.high else pin.low
        patch = self.patches.pin(pin, typed_quantity(value, pin.unit, None))
        if not self.patches.works(patch, design):
            return None
        amount, more = abs(value / given - 1.0), value > given
        shown = f"{pin.name} {as_given(value, pin.unit)} instead of {as_given(given, pin.unit)}"
        return Relaxation(
            kind="fix" if pin.key == "fix" else "limit",
            name=pin.name,
            sense="at_least" if more else "at_most",
            given=given,
            needed=value,
            unit=pin.unit,
            amount=amount,
            design=self.patches.as_asked(design, patch),
            proven=found.closed,
            sentence=f"{shown} ({more_or_less(amount, more)})",
            patch=patch,
        )

    def _chosen(self, name: str) -> Relaxation | str | None:
        """Return the way out by another part or word than those asked for."""
        found = self.search.least(Giving(give={}, free=[name]))
        if found.design is None:
            return None if found.closed else f"{name}: whether another choice alone would do is not settled"
        patch = self.patches.choices(found.design, [name])
        if not self.patches.works(patch, found.design):
            return None
        words = f"{name} {chosen_in(found.design, name)} in place of what was asked"
        design = self.patches.as_asked(found.design, patch)
        return Relaxation("choice", name, "", math.nan, math.nan, "-", math.nan, design, True, words, patch)


@dataclass(frozen=True)
class _Value:
    """A value as asked and as needed, in SI, in words, and as entries of a spec where one can state it."""

    given: float
    needed: float
    unit: str
    words: str
    patch: Mapping[str, Any] | None = None
