"""What explains that nothing is feasible: limits that exclude each other, ways out of it, and how they are told."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

from synth.analysis.fired_guards import FiredGuard
from synth.analysis.settings import WAYS_OUT
from synth.errors import InputError
from synth.folders.csv_style import ENGLISH, CsvStyle
from synth.folders.files import frame_csv
from synth.folders.output_folder import EXPLANATION, save_result
from synth.question.spec_patch import patched
from synth.results import Design
from synth.results.notebook import notebook_html
from synth.units import from_si, outward, parse_unit, written_quantity

if TYPE_CHECKING:
    import pandas as pd


@dataclass(frozen=True)
class Relaxation:
    """One way out: what gives way, by how much, and the design that results.

    ``kind`` is requirement, limit, fix, choice, part, joint or physics; ``given`` and ``needed`` are in SI (of a part:
    the nearest row's value and the one that would do; not-a-number where several things change, or words do).
    ``amount`` is the change as a fraction, not-a-number for other parts or choices. ``proven`` tells whether nothing
    less would do, within 0.8 % of the amount. ``patch`` has the entries of the spec that change, so that the design
    is feasible; None for what no spec can state: limits of the family, parts that no table has. ``design`` is told
    as it stands with that change; of what gives way together, as it stands in the question (what it misses there).
    """

    kind: str
    name: str
    sense: str
    given: float
    needed: float
    unit: str
    amount: float
    design: Design
    proven: bool
    sentence: str
    patch: Mapping[str, Any] | None = None

    def requirement(self) -> str:
        """Return the needed value as text with its unit, rounded so that it still does."""
        return rounded(self.needed, self.unit, self.sense)

    def applied(self, spec: Mapping[str, object]) -> dict[str, Any]:
        """Return a spec (``requirements``, ``limits``, ``fix``, ``parts`` ...) with this change.

        Raises
        ------
        InputError
            No spec can state it.
        """
        if self.patch is None:
            raise InputError("way", self.sentence, "a way out that a spec can state")
        return patched(spec, self.patch)


@dataclass
class Explanation:
    """What ``explain`` found.

    Parameters
    ----------
    feasible : bool
        There is nothing to explain.
    fired : list of FiredGuard
        What the family refuses outright, with amounts; then no design is looked for as the question stands.
    conflict : tuple of str
        A minimal set of limits that cannot hold together: without any one of them the others can.
    minimal : bool
        Whether that is proven for every one of them.
    guards : tuple of str
        Limits without which formulas do not exist; they always count.
    single : list of Relaxation
        Requirements, limits and pins of which one alone, given way to, makes it feasible; the smallest change first.
    choices : list of Relaxation
        Other parts or words than those asked for that alone would do.
    joint : Relaxation or None
        What the user asked (requirements, limits, pins) gives way by the same fraction.
    physics : Relaxation or None
        All limits, those of the family as well, give way by the same fraction; only where that was asked.
    parts : list of Relaxation
        Values of part columns that would do.
    not_settled : list of str
        What could be neither shown nor excluded.
    interrupted : str
        Why it ended early, or nothing.
    """

    feasible: bool = False
    fired: list[FiredGuard] = field(default_factory=list)
    conflict: tuple[str, ...] = ()
    minimal: bool = False
    guards: tuple[str, ...] = ()
    single: list[Relaxation] = field(default_factory=list)
    choices: list[Relaxation] = field(default_factory=list)
    joint: Relaxation | None = None
    physics: Relaxation | None = None
    parts: list[Relaxation] = field(default_factory=list)
    not_settled: list[str] = field(default_factory=list)
    interrupted: str = ""
    seconds: float = 0.0

    @property
    def ways(self) -> list[Relaxation]:
        """Return all ways out: single ones, other choices, together, other parts."""
        together = [way for way in (self.joint, self.physics) if way is not None]
        return [*self.single, *self.choices, *together, *self.parts]

    @property
    def message(self) -> str:
        """Return the answer in a few sentences."""
        if self.feasible:
            return "The question has feasible designs; there is nothing to explain."
        words = [f"Refused as it stands: {guard.sentence}." for guard in self.fired]
        if self.conflict:
            names = ", ".join(self.conflict)
            words.append(
                f"These limits cannot hold together: {names}."
                if len(self.conflict) > 1
                else f"No design keeps {names}."
            )
        together = [way for way in (self.joint, self.physics) if way is not None]
        measured = [*self.single, *self.parts] or together
        if measured:
            words.append(f"The smallest change that helps: {min(measured, key=lambda w: w.amount).sentence}.")
        elif self.choices:
            words.append(f"What helps: {self.choices[0].sentence}.")
        elif not self.interrupted:
            words.append("No single change up to a factor of twenty helps.")
        if self.interrupted:
            words.append(f"Stopped early ({self.interrupted}).")
        return " ".join(words)

    @property
    def names(self) -> set[str]:
        """Return the names that its sentences may have."""
        return {*self.conflict, *(name for way in self.ways for name in (way.name, *way.design.names))}

    def to_frame(self) -> pd.DataFrame:
        """Return one row per way out."""
        import pandas as pd

        rows = []
        for way in self.ways:
            unit = parse_unit(way.unit)
            shown = not math.isnan(way.needed)
            rows.append(
                {
                    "kind": way.kind,
                    "name": way.name,
                    "unit": way.unit if shown else "",
                    "given": float(from_si(way.given, unit)) if shown else None,
                    "needed": float(from_si(way.needed, unit)) if shown else None,
                    "change [%]": None if math.isnan(way.amount) else 100 * way.amount,
                    "proven": "yes" if way.proven else "no",
                    **{f"part: {slot}": str(row) for slot, row in way.design.parts.items()},
                    "sentence": way.sentence,
                }
            )
        return pd.DataFrame(rows)

    def _repr_html_(self) -> str:
        """Show the explanation in a notebook: the conflict in words, and the ways out."""
        rows = [[way.sentence, "yes" if way.proven else "no"] for way in self.ways]
        columns = ["way out", "nothing less would do (proven)"]
        level = "good" if self.feasible else "bad"
        return notebook_html("Why nothing is feasible", [self.message, *self.not_settled], columns, rows, level)

    def files(self) -> dict[str, str]:
        """Files that ``save`` writes: file name -> text."""
        return {
            "explanation.csv": frame_csv(self.to_frame()),
            "explanation.json": json.dumps(self._record(), indent=2, ensure_ascii=False, allow_nan=False) + "\n",
        }

    def save(self, folder: str | Path, csv: CsvStyle = ENGLISH) -> list[Path]:
        """Write explanation.csv and explanation.json; return the files.

        What was stopped replaces no earlier result: it is written to a folder ``stopped`` beside that.
        """
        files = csv.files(self.files())
        target = save_result(folder, files, EXPLANATION, bool(self.interrupted))
        return [target / name for name in files]

    def _record(self) -> dict[str, Any]:
        """Content of explanation.json."""
        return {
            "feasible": self.feasible,
            "message": self.message,
            "refused": [_refusal(guard) for guard in self.fired],
            "conflict": list(self.conflict),
            "minimal": self.minimal,
            "guards": list(self.guards),
            "ways": [_way(way) for way in self.ways],
            "not_settled": self.not_settled,
            "interrupted": self.interrupted,
        }


def _refusal(guard: FiredGuard) -> dict[str, Any]:
    return {
        "name": guard.name,
        "message": guard.message,
        "requirement": guard.requirement,
        "part": guard.part,
        "missed_by": _number(guard.missed_by),
        "lifted_by": dict(guard.lifted_by),
        "sentence": guard.sentence,
    }


def _way(way: Relaxation) -> dict[str, Any]:
    return {
        "kind": way.kind,
        "name": way.name,
        "change": _number(way.amount),
        "proven": way.proven,
        "sentence": way.sentence,
        "patch": way.patch,
    }


def _number(value: float) -> float | None:
    return None if math.isnan(value) else value


def rounded(value: float, unit: str, sense: str) -> str:
    """Return a value with its unit, rounded up where at least so much is needed, otherwise down."""
    return roundings(value, unit, sense == "at_least")[0]


def roundings(value: float, unit: str, up: bool) -> tuple[str, ...]:
    """Return a value with its unit, rounded to one side: to few digits, then to more, further and further."""
    return (next(outward(value, unit, up, WAYS_OUT.digits)), *outward(value, unit, up))[: WAYS_OUT.further]


def present_value(si: float, unit: str) -> str:
    """Present value in a question, beside the one needed: with as many digits, whole parts in full."""
    integer_digits = math.floor(math.log10(abs(shown))) + 1 if (shown := float(from_si(si, unit))) else 0
    return written_quantity(si, unit, max(WAYS_OUT.digits, integer_digits))
