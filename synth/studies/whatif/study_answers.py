"""What a what-if study has found: the answers of its steps, and where the best design changes between them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from synth.order.feasibility import Status
from synth.results import Design, ParetoFront
from synth.robust.robust_front import NOTHING_STANDS
from synth.studies.settings import STUDY_TEXTS
from synth.studies.whatif.vary import Value, Varied
from synth.units import header, miss_text

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
        """State of the step."""
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
        return (
            f"the nearest design misses {', '.join(missed)}" if missed else "no design was found that keeps all limits"
        )

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
        """Parts and counts of a design."""
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
        """First change that applies: feasible, parts, counts or choices."""
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
class StudyAnswers:
    """Fronts for all values of what is varied, and where the best parts change.

    Parameters
    ----------
    varied : tuple of Varied
    steps : tuple of StudyStep
    breaks : tuple of Break
    along : int, optional
        The position of what breaks are sought along; None where nothing numeric is varied.
    """

    varied: tuple[Varied, ...]
    steps: tuple[StudyStep, ...]
    breaks: tuple[Break, ...]
    along: int | None

    @property
    def fronts(self) -> list[ParetoFront]:
        """Return the fronts of the steps that were answered."""
        return [s.front for s in self.steps if s.front is not None]

    @property
    def feasible(self) -> bool:
        """True if any step has a design."""
        return any(front.designs for front in self.fronts)

    def objectives(self) -> dict[str, str]:
        """Return the objectives of all steps with their unit."""
        return {n: f.frame.units[n] for f in self.fronts for n in f.frame.objectives}

    def headers(self) -> list[str]:
        """Return the heading of each thing that is varied."""
        return [header(x.label, x.unit) if x.numeric else x.label for x in self.varied]


def _missed(conflict: Mapping[str, Any]) -> str:
    return f"{conflict['limit']} by {miss_text(conflict['value'], conflict['limit_value'], conflict['unit'])}"


def best_design(front: ParetoFront | None, objective: str) -> Design | None:
    """Return the design of a front that is best in one objective."""
    if front is None or not front.designs:
        return None
    sign = 1.0 if front.frame.objectives.get(objective, "min") == "min" else -1.0
    return min(front.designs, key=lambda d: sign * d.values[objective])
