"""Independent check of a front, saved or just computed: the record, every design, and the claim itself.

What decides is not shared with the search: designs are evaluated by CasADi on the written-out formulas, not by the
generated evaluator of the model, limits are read here, and the claim is proven again by a tree of its own
(``synth.proof.tree``) with an interval arithmetic of its own. What says *what was asked* is shared, so that a fault
there is not found here: the reading of units, tables, options and declarations into the question
(``synth.question.instance``, with requirement values, bounds, grids and the combinations that are allowed), the
recorded formulas (``synth.model.program``, ``synth.special``) and the tolerance at which a limit holds
(``synth.order.feasibility``). Elasticities, statistics and explanations are only covered by the checksum of the file.

On purpose limits are read a second time, here and in ``synth.proof.tree``: sides, scales, guards and what makes a limit
void come from the declaration itself, not from the constraints that everything else reads. Of what a user limits both
take the quantity, sense and bound of the question, and nothing else.

A file that contradicts itself is told in a sentence (``synth.verification.contradictions``) before anything is
computed from it; whatever fails after that is a fault of the program and is not caught.
"""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import casadi as ca
import numpy as np

from synth.analysis.restate import problem_of, rebuilt_question, table_differences
from synth.errors import InputError
from synth.folders.csv_style import STYLES
from synth.folders.files import read_bytes
from synth.model.program import Node, Program
from synth.order.feasibility import TOLERANCE, Status, holds, residual, utilisation
from synth.proof.levels import prove_regions
from synth.proof.questions import Point, ProofOutcome
from synth.proof.settings import PROOF, ProofLimits
from synth.proof.tree import ProofTree, moved_limits, void_without
from synth.question.arguments import Family, UserTables
from synth.question.inputs import inputs_of_design
from synth.question.instance import Instance
from synth.results.calculation import load_calculation
from synth.results.front_record import changed
from synth.results.offered import load_offered
from synth.results.verification import Verification
from synth.special import expanded
from synth.text.numbers import gap_text, percent, typed_number
from synth.text.plain_text import counted
from synth.units import typed_quantity
from synth.verification.contradictions import contradiction
from synth.verification.pareto_regions import uncovered
from synth.verification.ranking import ranking_faults

if TYPE_CHECKING:
    from synth.results import Design, ParetoFront

# Files beside front.json, by the name of their digest there.
LOADERS: Mapping[str, Callable[[Path, str], object]] = {"calculation": load_calculation, "offered": load_offered}


def verify(
    front: ParetoFront, problem: Family | None = None, catalogs: UserTables = None, time_limit: float = 120.0
) -> Verification:
    """Check a front without help of the search that made it.

    Parameters
    ----------
    front : ParetoFront
        From ``synthesize`` or ``load_front``.
    problem : family name, DesignProblem subclass or instance, optional
        For a front of a problem of your own that was loaded from a file.
    catalogs : folder or mapping, optional
        Own tables that were in memory; those that were files are read again.
    time_limit : float
        Seconds for the proof.

    Returns
    -------
    Verification

    Raises
    ------
    InputError
        When the problem or its tables cannot be had.
    """
    started = time.monotonic()
    check = checked(front, problem, catalogs, started + time_limit)
    return Verification(
        findings=tuple(check.findings),
        open=tuple(check.open),
        certificate=front.certificate.kind,
        designs=len(front.designs),
        claimed_gap=front.certificate.gap,
        amounts=front.certificate.amounts() if check.readable else "",
        proven_gap=check.proven,
        nodes=check.nodes,
        seconds=time.monotonic() - started,
    )


def checked(
    front: ParetoFront, problem: Family | None, catalogs: UserTables, deadline: float, limits: ProofLimits = PROOF
) -> VerificationRun:
    """Return the check of a front, done; see ``verify``."""
    check = VerificationRun(front, deadline, limits)
    if not check.read():
        return check
    if front.question is not None and problem is None and catalogs is None:
        check.ask(front.question)
    else:
        resolved, tables = problem_of(front, problem, catalogs, kept=True)
        check.compare_tables(*table_differences(front, tables))
        try:
            check.ask(rebuilt_question(front, resolved, tables))
        except InputError as error:
            check.find(f"the question of the record cannot be asked: {error}")
            return check
    if check.listed():
        check.claim()
    return check


@dataclass(frozen=True)
class _LimitReading:
    """How a limit stands at a design."""

    name: str
    value: float
    bound: float
    sense: str
    scale: float
    guard: bool = False
    void: bool = False

    @property
    def residual(self) -> float:
        """How far the limit is missed; not a number where a side does not exist, and then it does not hold."""
        with np.errstate(all="ignore"):
            return float(residual(np.float64(self.value), self.bound, self.sense, self.scale))

    @property
    def holds(self) -> bool:
        """Whether the limit is kept."""
        return self.keeps(1.0)

    def keeps(self, share: float) -> bool:
        """Whether the limit is kept within a share of the tolerance."""
        return bool(holds(self.residual, self.guard, share * TOLERANCE))


class VerificationRun:
    """One verification in progress."""

    def __init__(self, front: ParetoFront, deadline: float, limits: ProofLimits = PROOF) -> None:
        self.front, self.deadline, self.limits = front, deadline, limits
        self.readable = True
        self.findings: list[str] = []
        self.open: list[str] = []
        self.proven: float | None = None
        self.nodes = 0
        self._points: dict[int | None, Point | None] = {}
        self._guided_tree: ProofTree | None = None
        self._away = False  # whether rows kept stand in for a table: then other rows cannot be spoken of

    def find(self, sentence: str) -> None:
        """Note what is not as claimed."""
        self.findings.append(sentence)

    # -- the record ----------------------------------------------------------------------------

    def read(self) -> bool:
        """Compare what was read with its checksum and with the other files; tell whether it can be read at all."""
        record, folder = self.front.record, self.front.folder
        if record is None:
            return True
        fault = changed(record)
        if fault:
            self.find(fault)
        strange = contradiction(self.front)
        self.readable = not strange
        if strange:
            self.find(f"front.json contradicts itself ({strange})")
        elif folder is not None:
            self._files(folder)
        if not self.findings and record.get("result", self.front.result_digest) != self.front.result_digest:
            self.find("front.json has a checksum of its result that does not fit")
        return self.readable

    def compare_tables(self, away: Sequence[str], changed: Sequence[str]) -> None:
        """Note missing tables and changed ones."""
        self.open += away
        self.findings += changed
        self._away = bool(away)

    def _files(self, folder: Path) -> None:
        for name, digest in self.front.kept.items():
            try:
                LOADERS[name](folder, digest)
            except InputError:
                self.find(f"{name}.json is missing, or is not what was saved with front.json")
        for name, text in self.front.record_files().items():
            path = folder / name
            try:
                same = name == "front.json" or _is_text(read_bytes(path, name).decode("utf-8"), name, text)
            except InputError:
                self.find(f"{name} is missing")
            except UnicodeDecodeError:
                self.find(f"{name} is not the text that was saved")
            else:
                if not same:
                    self.find(f"{name} says something else than front.json")

    # -- the designs ---------------------------------------------------------------------------

    def ask(self, instance: Instance) -> None:
        """Take the question that the front answers."""
        self.instance, self.model = instance, instance.model
        self._evaluate = _evaluator(instance)
        self._refused = _refusal_functions(instance)
        self._void_without = void_without(instance.model)
        self._moved = moved_limits(instance)

    def listed(self) -> bool:
        """Check what the record says of the question and of the designs; tell whether it claims what can be proven."""
        front, frame = self.front, self.front.frame
        self._frame()
        for design in front.designs:
            self._design(design)
        if any(name not in self.model.quantity_sx for name in frame.objectives) or not frame.objectives:
            self.find(f"objectives: {', '.join(frame.objectives) or 'none'} is not what the problem can give")
            return False
        self.senses = np.array([1.0 if sense == "min" else -1.0 for sense in frame.objectives.values()])
        values = [[d.objectives.get(name, math.nan) for name in frame.objectives] for d in front.designs]
        self.signed = np.array(values, dtype=float).reshape(-1, len(self.senses)) * self.senses
        if len(front.designs):
            if not np.isfinite(self.signed).all():
                self.find("an objective of a design has no value")
                return False
            for fault in ranking_faults(self.front, self.signed, self.limits):
                self.find(fault)
            self._dominance()
        self._numbers()
        if front.certificate.kind != "global" or self._away:
            return False
        gap = front.certificate.gap
        if front.designs and not (isinstance(gap, float) and 0 < gap < 1):
            self.find("the certificate claims a proof but no gap")
            return False
        return not front.designs or self._measured(front.certificate.resolution, gap or 0.0)

    def _frame(self) -> None:
        frame, model = self.front.frame, self.model
        for name, value in self.instance.values.requirements.items():
            if not self.limits.agree(frame.requirement_values.get(name, math.nan), value):
                self.find(f"requirement_values_si: {name} is not what the requirements say")
        judging = self.instance.limits.judging
        limits = {x.name: x.sense for x in model.limits} | {x.name: x.sense for x in judging}
        units = {x.name: x.unit for x in model.limits} | {x.name: x.unit for x in judging}
        kinds = {name: kind for name, _, kind in model.declaration.quantities()}
        claims = {
            "limit_senses": (frame.limit_senses, limits),
            "limit_units": (frame.limit_units, units),
            "units": (frame.units, model.units),
            "kinds": (frame.kinds, kinds),
        }
        for name, (saved, right) in claims.items():
            if dict(saved) != right:
                self.find(f"{name}: they are not those of the problem")
        if list(frame.not_asked) != list(self.instance.values.not_asked):
            self.find("not_asked: other requirements were left out")

    def _design(self, design: Design) -> None:
        label = f"design {design.rank}"
        point = self._points[design.rank] = self._point(design, label)
        if point is None:
            return
        values, limits, remarks = self._evaluate(point)
        for name, value in values.items():
            if name not in design.values or not self.limits.agree(design.values[name], value):
                self.find(f"{label}: {name} is {design.values.get(name)}, evaluated it is {value}")
        for name in self.front.frame.objectives:
            if name in values and not self.limits.agree(design.objectives.get(name, math.nan), values[name]):
                self.find(f"{label}: objective {name} is {design.objectives.get(name)}, evaluated {values[name]}")
        if {text.split(":")[0] for text in design.advice} - {"unusual_part"} != remarks:
            self.find(f"{label}: the remarks are {sorted(design.advice)}, evaluated they are {sorted(remarks)}")
        self._next_rows(design, label, point)
        self._limits(design, label, point, limits, values)
        self._bounds(design, label, point)
        self._claims_of_design(design, label)

    def _next_rows(self, design: Design, label: str, point: Point) -> None:
        """Find rows of tables that are not the next ones to the design."""
        (right,) = self.model.next_rows(point.variables[None, :], point.data)
        for name, designation in design.next_rows.items():
            row = right.get(name)
            if row is None or str(designation) != str(row):
                self.find(f"{label}: {name} is told as {designation}, by the tables it is {row or 'none'}")

    def _point(self, design: Design, label: str) -> Point | None:
        """Inputs of a design, or None where they do not exist."""
        rows: dict[str, int] = {}
        for slot in self.instance.selection.slots:
            part = design.parts.get(slot.slot)
            offered = [slot.table.designations[r] for r in slot.rows]
            if part is None or str(part) not in offered:
                self.find(f"{label}: {slot.slot} {part} is not a row that this question may use")
                return None
            index = slot.table.row_index(str(part))
            current = {k: v for k, v in slot.table.row(index).items() if v is not None}
            saved = {k: v for k, v in part.items() if k not in ("table", "hash") and v is not None}
            if part["table"] != slot.table.name or part["hash"] != slot.table.hashes[index] or saved != current:
                self.find(f"{label}: {slot.slot} {part} is not the row of table {slot.table.name} in force")
            rows[slot.slot] = offered.index(str(part))
        selection = self.instance.selection
        for name, allowed in selection.counts.items():
            if not np.any(np.abs(allowed - design.values.get(name, math.nan)) < self.limits.same):
                self.find(f"{label}: {name} {design.values.get(name)} is not a value that this question may use")
                return None
        for name, indices in selection.choices.items():
            labels = [self.model.declaration.choices[name].labels[int(k)] for k in indices]
            if design.choices.get(name) not in labels:
                self.find(f"{label}: {name} {design.choices.get(name)} is not a label that this question may use")
                return None
        variables = np.array([design.values.get(v.name, math.nan) for v in self.model.variables], dtype=float)
        slots = {s.slot: s for s in selection.slots}
        data = inputs_of_design(
            self.model,
            self.instance.values.requirements,
            self.instance.values.rows,
            design.values,
            design.choices,
            lambda entry: float(slots[entry.name].columns[entry.column][rows[entry.name]]),
        )
        return Point(variables, data, rows)

    def _limits(
        self,
        design: Design,
        label: str,
        point: Point,
        limits: Mapping[str, tuple[float, float]],
        values: Mapping[str, float],
    ) -> None:
        for x in self._readings(point, values, limits):
            name, value, bound, void = x.name, x.value, x.bound, x.void
            r = math.nan if void else x.residual
            used = None if void else float(utilisation(value, bound, x.sense))
            if not void and not x.holds:
                self.find(f"{label}: limit {name} does not hold")
            saved = design.limits.get(name, (math.nan, math.nan))
            listed = design.utilisation.get(name)
            if not all(self.limits.agree(a, b, x.scale) for a, b in zip(saved, (value, bound), strict=True)):
                self.find(f"{label}: limit {name} has sides {saved}, evaluated they are {(value, bound)}")
            # Where both sides vanish beside the terms they are rounding, and so is one as a share of the other.
            vanish = max(abs(value), abs(bound)) <= self.limits.same * x.scale
            differs = listed is not None and used is not None and not self.limits.agree(listed, used)
            if (listed is None) != (used is None) or (differs and not vanish):
                self.find(f"{label}: utilisation of {name} is {listed}, evaluated it is {used}")
            if not self.limits.close(design.residuals.get(name, math.nan), r):
                self.find(f"{label}: residual of {name} is {design.residuals.get(name)}, evaluated it is {r}")
            if void != any(text.startswith(f"not checked: {name},") for text in design.not_checked):
                self.find(f"{label}: limit {name} is {'void' if void else 'not void'}, which not_checked does not say")
        if design.violated:
            self.find(f"{label}: {', '.join(design.violated)} are said to be violated")

    def _bounds(self, design: Design, label: str, point: Point) -> None:
        instance = self.instance
        for k, (v, grid) in enumerate(zip(self.model.variables, instance.ranges.grids(), strict=True)):
            x = float(point.variables[k])
            reach = self.limits.same * max(abs(instance.ranges.lower[k]), abs(instance.ranges.upper[k]))
            if not instance.ranges.lower[k] - reach <= x <= instance.ranges.upper[k] + reach:
                self.find(f"{label}: {v.name} {typed_quantity(x, v.unit)} is outside of its bounds")
            elif len(grid) and not np.any(np.abs(grid - x) <= self.limits.same * np.abs(grid)):
                self.find(f"{label}: {v.name} {typed_quantity(x, v.unit)} is not on its grid")
        for code, refused in self._refusals(point):
            if refused:
                self.find(f"{label}: refused, {code}")

    def _readings(
        self, point: Point, values: Mapping[str, float], limits: Mapping[str, tuple[float, float]]
    ) -> Iterator[_LimitReading]:
        """Yield how every limit stands at a design; behind a guard that fails the guard alone says that it is none."""
        scales = self.instance.evaluate(point.variables[None, :], point.data).scales
        for x in self.model.limits:
            void = any(math.isnan(point.data[k]) for k in self._void_without[x.name])
            scale = float(np.ravel(scales[x.name])[0])
            yield _LimitReading(x.name, *limits[x.name], x.sense, scale, x.guard, void)
        for limit in self.instance.limits.judging:
            scale = float(np.ravel(scales[limit.name])[0])
            yield _LimitReading(limit.name, values[limit.quantity], float(limit.bound), limit.sense, scale)

    def _refusals(self, point: Point) -> Iterator[tuple[str, bool]]:
        """Yield the refusals over several slots, and whether each forbids a design."""
        inputs = [*point.variables, *point.data]
        for code, places, function in self._refused:
            yield code, float(function.call([inputs[k] for k in places])[0]) > 0.5

    def _claims_of_design(self, design: Design, label: str) -> None:
        certificate = self.front.certificate
        if design.status not in (Status.OPTIMAL, Status.FEASIBLE):
            self.find(f"{label}: status {design.status.value} on a front of feasible designs")
        proven = certificate.kind == "global" and certificate.gap is not None
        if design.status is Status.OPTIMAL and not proven:
            self.find(f"{label}: status optimal, but the certificate proves no gap")
        if design.gap is not None and (not proven or design.gap > (certificate.gap or 0.0) * (1 + self.limits.same)):
            self.find(f"{label}: gap {gap_text(design.gap)} is above what the certificate claims")

    # -- the front -----------------------------------------------------------------------------

    def _dominance(self) -> None:
        reach = self.limits.same * np.abs(self.signed)
        for k, row in enumerate(self.signed):
            better = np.all(self.signed <= row + reach[k], axis=1)
            better[k] = False
            for j in np.flatnonzero(better)[:1]:
                other = self.front.designs[int(j)]
                equal = np.all(np.abs(self.signed[j] - row) <= reach[k])
                word = "equals" if equal else "dominates"
                if not equal or j < k:
                    self.find(f"design {other.rank} {word} design {self.front.designs[k].rank}")

    def _numbers(self) -> None:
        front = self.front
        points = front.settings.get("points")
        proven = front.certificate.kind == "global"
        if not isinstance(points, int) or len(front.designs) > points:
            self.find(f"{len(front.designs)} designs where at most {points} were asked for")
        elif front.designs and proven and len(front.designs) < points and not front.complete:
            few = f"{len(front.designs)} designs where {points} were asked for"
            self.find(f"{few}, and not said to be complete: some are missing")
        if front.complete and not proven:
            self.find("complete is claimed without a proof")
        if front.interrupted and proven:
            self.find("the search was stopped, so that it cannot have proven anything")
        if not self._away and front.certificate.combinations != self.instance.combinations.count:
            self.find(
                f"the certificate speaks of {counted(front.certificate.combinations, 'combination')}, "
                f"the question has {self.instance.combinations.count}"
            )
        if not front.designs and front.status not in (Status.INFEASIBLE, Status.NOT_FOUND, Status.NOT_SOLVED):
            self.find(f"status {front.status.value} without a design")
        if front.status is Status.INFEASIBLE and not proven:
            self.find("status infeasible, but the certificate is no proof")
        if front.designs and front.status not in (Status.OPTIMAL, Status.FEASIBLE):
            self.find(f"status {front.status.value} with designs")
        if front.status is Status.OPTIMAL and not proven:
            self.find("status optimal, but the certificate is no proof")

    def against(self, values: Mapping[str, np.ndarray], gap: float, resolution: Mapping[str, float]) -> None:
        """Prove that no design of this question improves some others by more than a gap in every objective.

        ``values``: objectives of the others in SI, and of the designs of this front; ``resolution``: as certified.
        """
        self.signed = np.stack([values[name] for name in self.front.frame.objectives], axis=1) * self.senses
        if not self._measured(resolution, gap):
            return
        self._begin(gap)
        outcome = self._prove(self._thresholds(gap))
        self._judge(outcome, f"no design improves one listed by more than {gap_text(gap)}", "feasible")

    # -- the claim -----------------------------------------------------------------------------

    def claim(self) -> None:
        """Prove the claim of the certificate; where that fails, determine the gap that can be proven."""
        front = self.front
        self._begin(front.certificate.gap if front.designs else None)
        if not front.designs:
            everywhere = np.full((1, len(self.senses)), math.inf)
            self._judge(self._prove(everywhere), "no design is feasible", "feasible")
            return
        gap = front.certificate.gap or 0.0
        if front.complete:
            outcome = self._prove(uncovered(self._thresholds(gap)), gap)
            if self._judge(outcome, "the front is complete", "feasible and no listed design covers it"):
                self.proven = gap
                return
        first = self._prove(self._thresholds(gap), gap)
        self.proven, decisive = (gap, first) if first.closed else self._smallest_gap(gap, first)
        still_open = f"{len(first.open_regions)} of {len(front.designs)} designs stay open"
        self._judge(decisive, f"no design improves a listed one by more than {gap_text(gap)}", "", still_open)

    def _begin(self, gap: float | None) -> None:
        """Prepare a proof to a gap, or that nothing is feasible."""
        self.share = self.limits.share_for(gap)
        self.tree = ProofTree(self.instance, self.front.frame.objectives, self.limits, share=self.share)

    def _measured(self, resolution: Mapping[str, float], gap: float) -> bool:
        """Read what a gap is a share of: the value, or what makes it the amount that the certificate tells."""
        amounts = np.array([resolution.get(name, math.nan) for name in self.front.frame.objectives])
        self.per_gap = amounts / gap
        nothing = (amounts == 0) & np.all(self.signed == 0, axis=0)  # of what is zero every share is
        unclear = np.isnan(amounts) & ~np.all(self.signed > 0, axis=0) | ~(np.isnan(amounts) | (amounts > 0) | nothing)
        for name, doubtful in zip(self.front.frame.objectives, unclear, strict=True):
            if doubtful:
                self.find(f"the certificate does not tell by how much {name} must be better to count")
        return not unclear.any()

    def _prove(self, ends: np.ndarray, gap: float | None = None) -> ProofOutcome:
        """Prove that no feasible design lies below any of the ends (rows) in all objectives.

        ``gap``: what ends were computed with, where they are those of the designs of this front.
        """

        def confirm(point: Point) -> bool:
            return self._lies_below(point, ends)

        near = [] if gap is None else self._next_to(ends, gap)
        if any(near):
            outcome = prove_regions(self.tree, self._guided, ends, near, confirm, self.deadline)
        else:
            outcome = self.tree.prove(ends, confirm, self.deadline)
        self.nodes += outcome.nodes
        return outcome

    def _guided(self) -> ProofTree:
        """Return the tree that proves regions one by one, made once."""
        if self._guided_tree is None:
            objectives = self.front.frame.objectives
            self._guided_tree = ProofTree(self.instance, objectives, self.limits, guided=True, share=self.share)
        return self._guided_tree

    def _next_to(self, ends: np.ndarray, gap: float) -> list[list[Point]]:
        """Return, per region, the designs that bound it; they tell the proof what to look at."""
        bounding = np.all(self._thresholds(gap)[None, :, :] <= ends[:, None, :], axis=2)
        points = [self._points[design.rank] for design in self.front.designs]
        return [[p for p, near in zip(points, row, strict=True) if near and p is not None] for row in bounding]

    def _lies_below(self, point: Point, ends: np.ndarray) -> bool:
        """True if a design is feasible, read as ``evaluate`` does, and lies below an end in all objectives."""
        values, limits, _ = self._evaluate(point)
        signed = self._signed_values(values)
        if not (np.isfinite(signed).all() and np.any(np.all(signed < ends, axis=1))):
            return False  # what has no finite value of an objective is no candidate
        kept = all(
            x.void or x.keeps(self.share if self._moved[x.name] else 1.0) for x in self._readings(point, values, limits)
        )
        return kept and not any(refused for _, refused in self._refusals(point))

    def _signed_values(self, values: Mapping[str, float]) -> np.ndarray:
        signed: np.ndarray = np.array([values[name] for name in self.front.frame.objectives]) * self.senses
        return signed

    def _thresholds(self, gap: float) -> np.ndarray:
        """Return, per design, what a design must undercut in every objective to improve it by more than the gap."""
        # What is exactly zero has no share; it is undercut by what is not zero but for rounding.
        least = np.where(
            (self.signed == 0) & (self._sizes() == 0), self.limits.noise, self.limits.same * np.abs(self.signed)
        )
        ends: np.ndarray = self.signed - gap * self._sizes() - least
        return ends

    def _sizes(self) -> np.ndarray:
        """Reference of the gap of an objective: its value, or the amount that the claim states."""
        return np.where(np.isnan(self.per_gap), np.abs(self.signed), self.per_gap)

    def _improvement(self, point: Point) -> tuple[float, int]:
        """Return by how much a design improves a listed one in every objective, and which."""
        signed = self._signed_values(self._evaluate(point)[0])
        with np.errstate(all="ignore"):
            share = np.min((self.signed - signed) / self._sizes(), axis=1)
        best = int(np.argmax(share))
        return float(share[best]), best

    def _smallest_gap(self, gap: float, outcome: ProofOutcome) -> tuple[float | None, ProofOutcome]:
        """Return a gap that can be proven, near the smallest one, and the first outcome that refutes the one claimed.

        A design that improves one by more than a larger gap refutes the smaller gap as well.
        """
        decisive, refuted = outcome, gap
        while True:
            if outcome.witness is not None:
                refuted = max(refuted, self._improvement(outcome.witness)[0])
            gap = 2 * refuted
            if gap > self.limits.widest_gap or time.monotonic() > self.deadline:
                return None, decisive
            outcome = self._prove(self._thresholds(gap), gap)
            if outcome.closed:
                break
            decisive, refuted = (outcome if decisive.witness is None else decisive), max(refuted, gap)
        for _ in range(self.limits.narrowings):
            between = math.sqrt(refuted * gap)
            outcome = self._prove(self._thresholds(between), between)
            if outcome.closed:
                gap = between
            else:
                decisive, refuted = (outcome if decisive.witness is None else decisive), between
        return gap, decisive

    def _judge(self, outcome: ProofOutcome, claim: str, what: str, still_open: str = "") -> bool:
        """True if a proof closed; else note the design that refutes the claim, or that the claim stays open.

        ``still_open``: text on the open part.
        """
        point = outcome.witness
        if point is not None:
            self.find(f"the claim that {claim} is wrong: {self._design_text(point)} is {what or self._gain(point)}")
        elif not outcome.closed:
            sentence = f"the claim that {claim} could not be proven again with {outcome.nodes} boxes"
            self.open.append(sentence + (f": {still_open}" if still_open else ""))
        return outcome.closed

    def _gain(self, point: Point) -> str:
        share, k = self._improvement(point)
        return f"feasible and improves design {self.front.designs[k].rank} by {percent(share)} in every objective"

    def _design_text(self, point: Point) -> str:
        """Variables, parts, counts and choices of a design as text."""
        words = [
            f"{v.name} {typed_quantity(float(x), v.unit)}"
            for v, x in zip(self.model.variables, point.variables, strict=True)
        ]
        words += [f"{s.slot} {s.table.designations[s.rows[point.rows[s.slot]]]}" for s in self.instance.selection.slots]
        for entry, value in zip(self.model.data_inputs, point.data, strict=True):
            if entry.kind == "count":
                words.append(f"{entry.name} {typed_number(value)}")
            elif entry.kind == "choice":
                words.append(f"{entry.name} {self.model.declaration.choices[entry.name].labels[int(value)]}")
        return ", ".join(words)


def _is_text(content: str, name: str, text: str) -> bool:
    """True if the content of a file is a text; a table may have any style."""
    return content == text or (name.endswith(".csv") and any(content == style.text(text) for style in STYLES.values()))


class _LackingProgram(Program):
    """Formulas by which the larger or smaller of two has no value where one has none; CasADi takes the other one."""

    def apply(self, node: Node, args: Sequence[Any]) -> Any:
        """Return one instruction carried out on CasADi symbols."""
        result = super().apply(node, args)
        if node.op not in (ca.OP_FMIN, ca.OP_FMAX):
            return result
        return ca.if_else(ca.logic_and(args[0] <= math.inf, args[1] <= math.inf), result, math.nan)


def _evaluator(instance: Instance) -> Any:
    """Return a function of a point: values, sides of limits and remarks, by CasADi on the written-out formulas."""
    model = instance.model
    outputs = list(model.quantity_sx.values()) + [side for x in model.limits for side in (x.value, x.limit)]
    outputs += [a.when for a in model.declaration.advices]
    written = expanded(ca.vertcat(*outputs), model.calls)
    if not all(entry.required for entry in model.data_inputs):
        written = ca.vertcat(*_LackingProgram(model.inputs, ca.vertsplit(written)).symbolic(model.inputs))
    function = ca.Function("check", [ca.vertcat(*model.inputs)], [written])

    def evaluate(point: Point) -> tuple[dict[str, float], dict[str, tuple[float, float]], set[str]]:
        numbers = iter(np.asarray(function([*point.variables, *point.data])).ravel().tolist())
        values = {name: next(numbers) for name in model.quantity_sx}
        limits = {x.name: (next(numbers), next(numbers)) for x in model.limits}
        return values, limits, {a.code for a in model.declaration.advices if next(numbers) > 0.5}

    return evaluate


def _refusal_functions(instance: Instance) -> list[tuple[str, list[int], Any]]:
    """Return the refusals over several slots: code, positions of the inputs they read, and the condition."""
    place = {str(symbol): k for k, symbol in enumerate(instance.model.inputs)}
    functions = []
    for refusal in instance.selection.joint_refusals:
        when = expanded(refusal.when, instance.model.calls)
        used = ca.symvar(when)
        functions.append((refusal.code, [place[str(s)] for s in used], ca.Function("refused", used, [when])))
    return functions
