"""What becomes of each family of a comparison, in a sentence: listed, beaten, infeasible, stopped or refused."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from synth.errors import InputError
from synth.results import Design
from synth.robust.robust_front import NOTHING_STANDS
from synth.studies.families.common_front import CommonFront, beaten
from synth.studies.families.comparison import FamilyOutcome
from synth.studies.families.competitor import Competitor
from synth.studies.families.requirement_sheet import Applicant
from synth.units import typed_quantity


@dataclass(frozen=True)
class Outcomes:
    """Tells what becomes of families.

    Parameters
    ----------
    front : CommonFront
    designs : list of Design
        Those listed, in order of rank.
    owners : list of str
        Labels of their families.
    every : list of (Competitor, Design)
        All designs that nothing beats.
    faults : mapping
        Label of a family -> why it could not be searched.
    interrupted : str
        What stopped the comparison; nothing where it was finished.
    chosen : bool
        Whether the objectives were asked for by name.
    """

    front: CommonFront
    designs: Sequence[Design]
    owners: Sequence[str]
    every: Sequence[tuple[Competitor, Design]]
    faults: Mapping[str, InputError]
    interrupted: str
    chosen: bool

    def of(self, one: Applicant) -> FamilyOutcome:
        """Outcome of a family, with the requirements that do not matter to it."""
        outcome = self._of(one)
        front = outcome.front
        if front is not None and front.interrupted and front.designs:
            outcome = replace(outcome, sentence=f"{outcome.sentence}; best found, its search was not finished")
        not_used = ", ".join(one.not_used)
        limits = "" if one.misfits else ", ".join(f"{name} {comparison}" for name, comparison in one.as_limits.items())
        sentence = outcome.sentence + (f"; as limits: {limits}" if limits else "")
        sentence += f"; not used: {not_used}" if not_used else ""
        instead = "; ".join(m.partition(": use ")[2] for m in one.misfits) if one.declined else ""
        return replace(outcome, sentence=sentence, instead=instead, not_used=not_used)

    def _of(self, one: Applicant) -> FamilyOutcome:
        d = one.declaration
        quantities: Mapping[str, Any] = {**d.variables, **d.counts, **d.derived}
        meanings = {n: quantities[n].text for n in self.front.objectives if n in quantities}
        offers = {} if self.chosen else {n: objective.default for n, objective in d.objectives.items()}
        kind = "not_covered" if one.declined else "refused"
        outcome = FamilyOutcome(one.label, one.title, kind, "", meanings=meanings, offers=offers)
        if one.misfits:
            return replace(outcome, sentence=f"it {' and '.join(one.misfits)}")
        if one.label in self.faults:
            return replace(outcome, sentence=str(self.faults[one.label]))
        member = next((m for m in self.front.members if m.one is one), None)
        if member is None:
            return replace(outcome, outcome="stopped", sentence=f"not searched ({self.interrupted})")
        listed = self.owners.count(one.label)
        outcome = replace(outcome, front=member.front, listed=listed)
        if listed:
            words = "1 design" if listed == 1 else f"{listed} designs"
            return replace(outcome, outcome="listed", sentence=f"{words} on the common front")
        return self._without_place(member, outcome) if member.designs else _without_design(member, outcome)

    def _without_place(self, member: Competitor, outcome: FamilyOutcome) -> FamilyOutcome:
        """Outcome of a family none of whose designs is listed."""
        if any(m is member for m, _ in self.every):
            reason = "it has designs that nothing beats, but there is no room for them among so few points"
            return replace(outcome, outcome="beaten", sentence=reason)
        winner, sentence = self._beaten(member)
        return replace(outcome, outcome="beaten", sentence=sentence, beaten_by=winner)

    def _beaten(self, member: Competitor) -> tuple[Design | None, str]:
        """Say by which design a family is beaten in most of its own, and how its best values compare with that one's.

        Where no listed design beats any, they are compared with the best values of all.
        """
        signed, designs = self.front.signed, self.designs
        points = signed(member.designs)
        beats = [int(beaten(points, row, of_others=True).sum()) for row in signed(designs)]
        best = int(np.argmax(beats)) if beats else -1
        if best < 0 or not beats[best]:
            words = self._against(member, points, signed([d for _, d in self.every]))
            return None, f"everywhere, by designs between those listed: {words}"
        by = f"by #{designs[best].rank} ({self.owners[best]})"
        if len(points) > 1:
            by = f"in {'all' if beats[best] == len(points) else f'{beats[best]} of {len(points)}'} of its designs {by}"
        return designs[best], f"everywhere, {by}: {self._against(member, points, signed([designs[best]]))}"

    def _against(self, member: Competitor, points: np.ndarray, others: np.ndarray) -> str:
        """Return the best values of a family's designs beside those of others."""
        words = []
        for k, (name, sense) in enumerate(self.front.objectives.items()):
            mine, theirs = (
                typed_quantity(float(rows[:, k].min() * self.front.senses[k]), member.front.frame.units[name], 4)
                for rows in (points, others)
            )
            words.append(f"{'least' if sense == 'min' else 'largest'} {name} {mine} against {theirs}")
        return ", ".join(words)


def _without_design(member: Competitor, outcome: FamilyOutcome) -> FamilyOutcome:
    """Outcome of a family of which no design was found."""
    if member.front.interrupted:
        reason = f"no design was found until it was stopped ({member.front.interrupted})"
        return replace(outcome, outcome="stopped", sentence=reason)
    nothing = NOTHING_STANDS if member.incomplete else "No design is feasible."
    explanation = member.front.explanation
    message = nothing if explanation is None else explanation.get("message", nothing)
    return replace(outcome, outcome=member.front.status.value, sentence=str(message))
