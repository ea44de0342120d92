"""The certificate: how far a result is proven."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field

from synth.text.numbers import gap_text, number_text, thousands, typed_number
from synth.text.plain_text import counted, words
from synth.units import parse_unit, unit_text


def in_words(amounts: Mapping[str, float], units: Mapping[str, str]) -> str:
    """Return as a remark in brackets below which amounts, in SI, differences do not count; nothing where all do.

    Examples
    --------
    >>> in_words({"lift": 2e-6}, {"lift": "mm"})
    ' (differences below 0.002 mm in lift do not count)'
    """
    amounts_shown = []
    for name, amount in amounts.items():
        if amount == 0:
            continue
        unit = parse_unit(units.get(name, "-"))
        # A difference of temperatures is one in kelvin.
        word = "K" if unit.offset else unit_text(units.get(name, "-"))
        amounts_shown.append(f"{number_text(amount / float(unit.ratio), 3)} {word}".rstrip() + f" in {words(name)}")
    return f" (differences below {', '.join(amounts_shown)} do not count)" if amounts_shown else ""


def all_of(combinations: int) -> str:
    """Scope of all combinations.

    Examples
    --------
    >>> all_of(52920), all_of(1)
    ('all 52 920 combinations', 'the only combination')
    """
    return "the only combination" if combinations == 1 else f"all {number_text(combinations)} combinations"


def none_of(combinations: int) -> str:
    """Scope of none, without the verb's number in doubt.

    Examples
    --------
    >>> none_of(52920), none_of(1)
    ('none of the 52 920 combinations', 'not even the only combination')
    """
    return f"not even {all_of(1)}" if combinations == 1 else f"none of the {number_text(combinations)} combinations"


@dataclass(frozen=True)
class Certificate:
    """How far a front is proven.

    ``kind`` is ``global`` (valid bounds prove the gap), ``exhaustive`` (every combination that no valid
    bound excludes was solved from several starts) or ``heuristic``. ``gap`` is what bounds prove, whatever the kind;
    None where they prove nothing, or there is no design. ``budget`` is the time, in seconds, that ended the search
    where it was the default budget; such a search may end otherwise on another machine.

    ``resolution`` tells, in SI, by how much a design must be better in an objective for the claim to speak of it, where
    that is no share of its value because it may be zero or negative, or is to be made large; ``units`` are theirs.
    """

    kind: str
    gap: float | None
    combinations: int
    excluded_by_bound: int
    solved: int
    unresolved: int = 0
    budget: float | None = None
    resolution: Mapping[str, float] = field(default_factory=dict)
    units: Mapping[str, str] = field(default_factory=dict)

    def of_no_design(self) -> str:
        """How far it is proven that no design is feasible, in words."""
        if self.kind == "global":
            return f"proven: {none_of(self.combinations)} of parts and counts is feasible"
        if self.combinations == 1:
            what = f"{all_of(1)} of parts and counts was {'solved' if self.solved else 'not solved'}"
        else:
            excluded, solved = thousands(self.excluded_by_bound), f"{thousands(self.solved)} {_was(self.solved)} solved"
            what = f"of {all_of(self.combinations)} of parts and counts bounds exclude {excluded}, and {solved}"
        return f"not proven: {what}; no feasible design was found"

    def amounts(self) -> str:
        """Return in words what the gap stands for where it is no share of the value."""
        return in_words(self.resolution, self.units)

    def sentence(self) -> str:
        """Return the certificate in words."""
        if self.kind == "global" and self.gap is None:
            return f"proven: {none_of(self.combinations)} of parts and counts can meet the requirements"
        if self.kind == "global":
            return (
                f"proven: over {all_of(self.combinations)} of parts and counts no design improves one listed here "
                f"by more than {gap_text(self.gap or 0)} in every objective{self.amounts()}"
            )
        end = (
            ""
            if self.budget is None
            else f"; more time than the budget of {typed_number(self.budget)} s may prove more"
        )
        if self.kind == "exhaustive":
            boxes = counted(self.unresolved, "box", "boxes")
            return (
                f"exhaustive: {self._solved()} from several starts ({boxes} could not be closed by bounds, which prove "
                f"a gap of {_gap_text(self.gap)}{self.amounts()}{end})"
            )
        gap = f"gap {_gap_text(self.gap)}{self.amounts()}{end}"
        if not self.unresolved and self.gap is not None:
            return f"not proven to the gap asked for: over {all_of(self.combinations)} bounds prove a {gap}"
        return f"not proven: stopped before {all_of(self.combinations)} {_was(self.combinations)} covered; {gap}"

    def _solved(self) -> str:
        """Return in words which combinations were solved."""
        count, excluded = self.combinations, self.excluded_by_bound
        if count == 1:
            return f"{all_of(1)} was solved"
        are = "is" if excluded == 1 else "are"
        return f"of {all_of(count)} {thousands(excluded)} {are} excluded by bounds; every other one was solved"


def _was(number: int) -> str:
    return "was" if number == 1 else "were"


def _gap_text(gap: float | None) -> str:
    return "unknown" if gap is None or not math.isfinite(gap) else gap_text(gap)
