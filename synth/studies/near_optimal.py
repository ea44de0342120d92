"""Designs of other parts, counts or choices that are nearly as good as a chosen one.

Boxes of everything that keeps within so many per cent of the chosen design are tightened and split until every
combination is shown to hold such a design or shown to hold none: the tree of the search with fixed cutoffs. Of those
that do, a few that differ most are made as good as their parts allow.
"""

from __future__ import annotations

import math
import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from synth.analysis.designs import make_design
from synth.analysis.restate import question_of
from synth.analysis.written_digits import written_digits
from synth.bounds.boxes import Boxes
from synth.errors import InputError, at, whole_number
from synth.folders.csv_style import ENGLISH, CsvStyle
from synth.folders.files import csv_text, table_frame
from synth.folders.output_folder import NEAR_EQUALS, save_result
from synth.nlp.batch import Tasks
from synth.order.feasibility import Status
from synth.order.margins import MARGINS
from synth.question.arguments import Family, UserTables, Value
from synth.question.instance import Instance
from synth.question.selection import part_row
from synth.question.settings import Progress, SearchSettings, check_progress
from synth.results import Design, ParetoFront, design_columns, design_row
from synth.results.front_record import design_record, record_text
from synth.results.plain import plain
from synth.search.archive import Archive, Candidate
from synth.search.branch_and_bound import branch_and_bound
from synth.search.budget import Clock
from synth.search.fathoming import unresolved_small
from synth.search.formulation import Formulation
from synth.search.goals import goals_of
from synth.search.polishing import polish_discrete, polish_variables
from synth.search.primal_heuristics import PrimalHeuristics, roundings
from synth.search.pruning import EpsilonCover
from synth.studies.settings import NEAR, NearLimits
from synth.system.deadline import INTERRUPTED, Stopped, stoppable
from synth.text.input_limits import INPUT_LIMITS
from synth.text.numbers import percent, thousands
from synth.units import parse_quantity
from synth.verbs.requests import NearEqualsRequest

if TYPE_CHECKING:
    import pandas as pd


@dataclass(frozen=True)
class NearEquals:
    """Designs of other parts, counts or choices within so many per cent of a chosen one.

    ``found`` counts all such combinations; ``complete`` tells that no further one exists, ``undecided`` how many could
    be neither shown nor excluded (None: the enumeration ended before all were looked at). ``changes`` holds, per
    design, the relative change of every objective against the chosen design, ``differences`` what is other than there,
    ``ranks`` which design of the front it is (None: it is not listed there).
    """

    reference: Design
    designs: list[Design]
    within: float
    found: int
    complete: bool
    undecided: int | None
    changes: list[dict[str, float]]
    differences: list[tuple[str, ...]]
    ranks: list[int | None]
    statistics: Mapping[str, Any]
    interrupted: str = ""

    def sentence(self) -> str:
        """Number of near-equal designs, and how far that is certain."""
        share = percent(self.within)
        number = thousands(self.found)
        those = "1 other combination comes" if self.found == 1 else f"{number} other combinations come"
        if self.complete:
            if not self.found:
                return f"proven: no other combination of parts, counts and choices comes within {share}"
            return f"{those} within {share}; no further one does (proven)"
        open_ones = "" if not self.undecided else f"; {self.undecided} more could not be decided"
        return f"at least {those} within {share}{open_ones}"

    def to_frame(self) -> pd.DataFrame:
        """Return one row per design, the chosen one first, with units in the headers."""
        return table_frame(*self._table())

    def files(self, folder: Path | None = None) -> dict[str, str]:
        """Files that ``save`` writes: file name -> text; ``folder``: where they will stand."""
        record = {
            "family": self.reference.frame.family,
            "within": self.within,
            "found": self.found,
            "complete": self.complete,
            "undecided": self.undecided,
            "interrupted": self.interrupted,
            "sentence": self.sentence(),
            "statistics": dict(self.statistics),
            "units": dict(self.reference.frame.units),
            "chosen": plain(design_record(self.reference)),
            "designs": [
                {"number": number, "change": plain(change), "differs_in": list(other), **plain(design_record(design))}
                for number, (design, change, other) in enumerate(
                    zip(self.designs, self.changes, self.differences, strict=True), start=1
                )
            ],
        }
        files = {"near_equals.csv": csv_text(*self._table()), "near_equals.json": record_text(record)}
        for number, design in enumerate([self.reference, *self.designs]):
            placed = design if folder is None else design.placed(folder)
            files[f"design_{number:02d}.yaml"] = placed.yaml()
        return files

    def save(self, folder: str | Path, csv: CsvStyle = ENGLISH) -> Path:
        """Write near_equals.csv, near_equals.json and design_00.yaml (the chosen one), 01 ..; return the folder.

        What was stopped replaces no earlier result: it is written to a folder ``stopped`` beside that.
        """
        return save_result(folder, lambda place: csv.files(self.files(place)), NEAR_EQUALS, bool(self.interrupted))

    def _table(self) -> tuple[list[str], list[list[Any]]]:
        objectives = list(self.reference.frame.objectives)
        columns = ["number", "differs in", "differences", *(f"change: {n} [%]" for n in objectives)]
        reference, frame = self.reference, self.reference.frame
        columns += design_columns(frame, reference.choices, reference.parts)
        rows: list[list[Any]] = [[0, 0, "the chosen design", *(0.0 for _ in objectives), *design_row(frame, reference)]]
        for number, (design, change, other) in enumerate(
            zip(self.designs, self.changes, self.differences, strict=True), start=1
        ):
            moved = [100 * change[n] if math.isfinite(change[n]) else None for n in objectives]
            rows.append([number, len(other), "; ".join(other), *moved, *design_row(frame, design)])
        return columns, rows


def near_equals(
    front: ParetoFront,
    design: int | Design,
    within: Value = NearEqualsRequest.within,
    *,
    count: int = NearEqualsRequest.count,
    problem: Family | None = None,
    catalogs: UserTables = None,
    seed: int = NearEqualsRequest.seed,
    progress: Progress | None = None,
    time_limit: float | None = NearEqualsRequest.time_limit,
) -> NearEquals:
    """Find designs of other parts, counts or choices that are nearly as good as a chosen one.

    Parameters
    ----------
    front : ParetoFront
        From ``synthesize`` or ``load_front``: it says what was asked for.
    design : int or Design
        The rank of one of its designs, or any design of the same question.
    within : text or float
        By how much every chosen objective may be worse, "2 %" or 0.02; being better is no fault. An objective that is
        0 in the chosen design is measured by its range on the front.
    count : int
        At most so many designs, as different from the chosen one and from each other as possible.
    problem, catalogs : optional
        As for ``ParetoFront.verify``: for a loaded front of a problem, or with tables, of one's own.
    seed : int
        Of all random choices.
    progress : callable, optional
        Called with a mapping: stage, done, combinations, incumbents, message.
    time_limit : float, optional
        Seconds after which what is found is returned.

    Returns
    -------
    NearEquals

    Raises
    ------
    InputError
        When the design is not one of the question, or a number is not of its kind.
    """
    settings = SearchSettings(seed=seed, time_limit=time_limit)
    check_progress(progress)
    reference = chosen_design(front, design)
    share = read_share(within)
    whole_number(count, "count", INPUT_LIMITS.listed, path=("count",))
    instance = question_of(front, problem, catalogs)
    search = _Enumeration(instance, reference, front, share, settings, progress)
    return search.run(int(count))


def chosen_design(front: ParetoFront, design: object) -> Design:
    """Return the design of a front that is asked for: by its rank, or as it stands.

    Raises
    ------
    InputError
        There is no such design.
    """
    if isinstance(design, Design):
        if design.frame.family != front.frame.family:
            raise InputError("design", design.frame.family, f"a design of {front.frame.family}, as the front is")
        return design
    ranks = {d.rank: d for d in front.designs}
    if not front.designs:
        raise InputError("front", "no designs", "a front with designs")
    if isinstance(design, bool) or design not in ranks:
        raise InputError("design", design, f"a rank from 1 to {len(front.designs)}, or one of the designs", ("design",))
    return ranks[design]


def read_share(within: object) -> float:
    """Return by which share objectives may be worse.

    Raises
    ------
    InputError
        It is none that near-equal designs can be searched for.
    """
    with at("within"):
        share = parse_quantity(within, "-", "within")
    if not 0 < share <= NEAR.widest:
        raise InputError(
            "within", within, f"more than 0 and at most {percent(NEAR.widest)}, for example '2 %'", ("within",)
        )
    return share


class _Near:
    """The rule of the tree: every combination that holds a design within the cutoffs.

    ``best`` holds, per combination, the design that is least worse than the chosen one, and by how much.
    """

    proves = False

    def __init__(self, traded: int, base: np.ndarray, cutoffs: np.ndarray, sizes: np.ndarray, tie: float) -> None:
        self.columns, self.tie = list(range(traded)), tie
        self.tolerance, self.fixed_cutoffs = sizes, cutoffs
        self.base = base
        self.best: dict[int, tuple[float, Candidate]] = {}

    def cutoffs(self, lower: np.ndarray, cell: np.ndarray | None = None) -> np.ndarray:
        """Return the cutoffs, the same for every box."""
        return np.tile(self.fixed_cutoffs[: lower.shape[1]] + self.tie, (len(lower), 1))

    def possible_gain(self, lower: np.ndarray, cell: np.ndarray | None = None) -> np.ndarray:
        """Possible distance of a box within the cutoffs."""
        with np.errstate(all="ignore"):
            distance = (self.fixed_cutoffs[self.columns] + self.tie - lower[:, self.columns]).min(axis=1)
        gain: np.ndarray = np.where(np.isnan(distance), np.inf, np.maximum(distance, 0.0))
        return gain

    def take(self, combinations: np.ndarray, variables: np.ndarray, phi: np.ndarray) -> int:
        """Take feasible designs; return how many combinations are new."""
        kept = np.flatnonzero(np.all(phi[:, self.columns] <= self.fixed_cutoffs[self.columns] + self.tie, axis=1))
        worse = self.worse(phi[kept])
        order = np.lexsort((worse, combinations[kept]))
        _, first = np.unique(combinations[kept][order], return_index=True)
        new = 0
        for row in order[first]:
            k, combination = kept[row], int(combinations[kept[row]])
            known = self.best.get(combination)
            new += known is None
            if known is None or worse[row] < known[0]:
                self.best[combination] = float(worse[row]), Candidate(combination, variables[k].copy(), phi[k])
        return new

    def worse(self, phi: np.ndarray) -> np.ndarray:
        """Return by how much designs are worse than the chosen one, as a share of what is allowed."""
        worse: np.ndarray = ((phi[:, self.columns] - self.base[self.columns]) / self.tolerance).max(axis=1)
        return worse

    def leading(self, archive: Archive) -> list[Candidate]:
        """Return nothing: no design here is better than another."""
        return []


class _Enumeration:
    """One enumeration: the combinations, the choice among them, and the designs made of it."""

    def __init__(
        self,
        instance: Instance,
        reference: Design,
        front: ParetoFront,
        share: float,
        settings: SearchSettings,
        progress: Progress | None,
        limits: NearLimits = NEAR,
    ) -> None:
        self.started, self.limits = time.monotonic(), limits
        self.instance, self.reference, self.front, self.share = instance, reference, front, share
        self.chosen = dict(front.frame.objectives)
        self.m = len(self.chosen)
        self.number = instance.combinations.number(reference)
        self.form = Formulation(instance, goals_of(instance, self.chosen), self.m)
        self.rng = np.random.default_rng(settings.seed)
        self.progress, self.stage = progress, "enumerate"
        limit = settings.time_limit
        self.clock = Clock(math.inf if limit is None else self.started + limit, self._working)
        self.near = self._rule(front)
        self.tried: set[int] = set()
        self.undecided: set[int] = set()
        self.looked = 0

    def _rule(self, front: ParetoFront) -> _Near:
        form, m = self.form, self.m
        directions = np.array([g.sign for g in form.goals[:m]], dtype=float)
        values = np.array([[d.values[n] for n in self.chosen] for d in [self.reference, *front.designs]]) * directions
        if not np.isfinite(values[0]).all():
            raise InputError("design", self.reference.rank, "a design whose objectives all exist")
        span = np.ptp(values, axis=0)
        size = np.where(values[0] != 0, np.abs(values[0]), span)
        reference_phi = np.full(len(form.goals), np.inf)
        reference_phi[:m] = form.objectives.phi_of(values[:1])[0]
        slack = np.where(form.objectives.log[:m], np.log1p(self.share), self.share * size / form.objectives.scales[:m])
        cutoffs = np.full(len(form.goals), np.inf)
        cutoffs[:m] = reference_phi[:m] + slack
        tie = form.tuning.tolerances.tie
        return _Near(m, reference_phi, cutoffs, np.maximum(slack, tie), tie)

    def _working(self, open_boxes: int) -> None:
        if self.progress is not None:
            self.progress(
                {
                    "stage": self.stage,
                    "done": 0.0 if self.stage == "enumerate" else 1.0,
                    "combinations": self.instance.combinations.count,
                    "incumbents": len(self.near.best),
                    "message": f"{open_boxes} boxes open" if open_boxes else "",
                }
            )

    # -- the run -------------------------------------------------------------------------------

    def run(self, count: int) -> NearEquals:
        complete = False
        with stoppable(self.clock.deadline) as ending:
            complete = self._enumerate()
        interrupted = ending.reason
        self.stage = "settle"
        members = self._members()
        picked = self._spread(members, count)
        designs: list[Candidate] = []
        for combination in picked:
            try:
                designs.append(self._settled(combination, members[combination][1], hurried=bool(interrupted)))
            except (Stopped, KeyboardInterrupt) as stop:
                interrupted = interrupted or (stop.reason if isinstance(stop, Stopped) else INTERRUPTED)
                designs.append(members[combination][1])
        return self._result(designs, len(members), complete and not interrupted, interrupted)

    def _enumerate(self) -> bool:
        """Search all boxes; return whether every combination is decided."""
        form, near, batch_size = self.form, self.near, self.limits.batch
        heuristics = PrimalHeuristics(form, near, self.rng, every_goal=False)
        cutoffs = near.fixed_cutoffs[: form.bounded] + near.tie
        stack = [form.boxes.lean(form.boxes.root())]
        while stack:
            boxes = stack.pop()
            batch, waiting = boxes.take(slice(0, batch_size)), boxes.take(slice(batch_size, None))
            stack += [waiting] if len(waiting) else []
            self.clock.check([batch, *stack])
            if self.looked > self.limits.boxes or len(near.best) > self.limits.most:
                return False
            self.looked += len(batch)
            batch = form.boxes.contract(batch, cutoffs)
            batch = self._open(batch.take(near.possible_gain(form.objectives.phi_of(batch.bounds)) > 0))
            if not len(batch):
                continue
            self._try(batch)
            batch = self._open(batch)
            batch, small = form.boxes.split(batch)
            if len(small):
                undecided = self._open(unresolved_small(form, small, near, heuristics))
                self.undecided.update(form.boxes.cells.all_members(undecided.cell, self.limits.most).tolist())
            if len(batch):
                stack.append(batch)
        return not self.undecided - set(near.best)

    def _open(self, boxes: Boxes) -> Boxes:
        """Return the boxes that are not of a combination that is known to belong."""
        single = np.flatnonzero(self.form.boxes.cells.single(boxes.cell))
        keep = np.ones(len(boxes), dtype=bool)
        numbers = self.form.boxes.combination(boxes.take(single))
        keep[single] = [int(c) not in self.near.best for c in numbers]
        return boxes.take(keep)

    def _try(self, boxes: Boxes) -> None:
        """Solve, once for each combination that stands alone in a box, for the design that is least worse."""
        form = self.form
        numbers = form.boxes.combination(boxes)
        rows = [k for k in np.flatnonzero(form.boxes.cells.single(boxes.cell)) if int(numbers[k]) not in self.tried]
        _, first = np.unique(numbers[rows], return_index=True)
        rows = [rows[int(k)] for k in np.sort(first)]
        self.tried.update(int(numbers[k]) for k in rows)
        for start in range(0, len(rows), self.limits.problems):
            chosen = np.array(rows[start : start + self.limits.problems], dtype=np.int64)
            self._solve(numbers[chosen], form.boxes.inside(boxes.take(chosen), 0.5))
        # Boxes of combinations tried before have become smaller since.
        for share in (form.tuning.heuristics.primal.inside, 0.5):
            points = form.makeable.nearest(form.boxes.inside(boxes, share))
            self._offer(points, numbers)

    def _solve(self, combinations: np.ndarray, start: np.ndarray) -> None:
        form, near, m = self.form, self.near, self.m
        if not form.n:
            self._offer(start, combinations)
            return
        count, goals = len(combinations), len(form.goals)
        slopes, cutoffs = np.zeros((count, goals)), np.full((count, goals), np.inf)
        slopes[:, :m], cutoffs[:, :m] = near.tolerance / near.tolerance.max(), near.base[:m]
        tasks = Tasks(np.zeros((count, goals)), slopes, cutoffs, form.objectives.scales, t_weight=1.0)
        answer = form.continuous.solve_batch(tasks, combinations, start)
        if not form.gridded.any():
            self._offer(answer.variables, combinations)
            return
        phi = answer.phi[:, :m]
        within = np.all(phi <= near.fixed_cutoffs[:m] + near.tie, axis=1)
        good = np.flatnonzero((answer.violation <= form.tuning.nlp.missed) & within)
        for k in good:
            self._round(int(combinations[k]), answer.variables[[k]])

    def _round(self, combination: int, variables: np.ndarray) -> None:
        """Try makeable points around a continuous optimum."""
        form, near = self.form, self.near
        low, high, _ = roundings(form, variables)
        if len(low) > self.limits.rounded:
            chosen = self.rng.choice(len(low), self.limits.rounded, replace=False)
            low, high = low[chosen], high[chosen]
        cell = form.boxes.box_of(combination).cell
        leaves = form.boxes.leaves(np.full(len(low), combination), low, high)
        around = replace(leaves, cell=np.repeat(cell, len(low), axis=0))
        around = form.boxes.contract(form.boxes.lean(around), near.fixed_cutoffs[: form.bounded] + near.tie)
        for share in (form.tuning.heuristics.primal.inside, 0.5):
            points = form.makeable.nearest(form.boxes.inside(around, share))
            self._offer(points, form.boxes.combination(around))

    def _offer(self, points: np.ndarray, combinations: np.ndarray) -> None:
        rows, phi = self.form.points.feasible_rows(points, combinations)
        self.near.take(combinations[rows], points[rows], phi[rows])

    # -- the choice ----------------------------------------------------------------------------

    def _members(self) -> dict[int, tuple[float, Candidate]]:
        """Return all combinations that belong, without the chosen one: rows that are equal in all that counts too."""
        form, result = self.form, dict[int, tuple[float, Candidate]]()
        for combination, (worse, candidate) in self.near.best.items():
            for other in form.boxes.cells.members(form.boxes.box_of(combination).cell[0], self.limits.most):
                result[int(other)] = worse, replace(candidate, combination=int(other))
        result.pop(self.number, None)
        return dict(sorted(result.items()))

    def _spread(self, members: Mapping[int, tuple[float, Candidate]], count: int) -> list[int]:
        """Return combinations as different as possible: always the one that differs most from those chosen before."""
        numbers = np.array(list(members), dtype=np.int64)
        codec = self.instance.combinations
        digits = np.stack(codec.digits(numbers), axis=1) if codec.radix else np.zeros((len(numbers), 0))
        reference_digits = np.array([int(d[0]) for d in codec.digits(np.array([self.number]))])
        worse = np.array([w for w, _ in members.values()])
        least = np.sum(digits != reference_digits, axis=1)
        total = np.zeros(len(numbers), dtype=np.int64)
        chosen: list[int] = []
        while len(chosen) < min(count, len(numbers)):
            open_ones = np.setdiff1d(np.arange(len(numbers)), chosen)
            order = np.lexsort((worse[open_ones], -total[open_ones], -least[open_ones]))
            best = int(open_ones[order[0]])
            chosen.append(best)
            apart = np.sum(digits != digits[best], axis=1)
            least, total = np.minimum(least, apart), total + apart
        return [int(numbers[k]) for k in chosen]

    def _settled(self, combination: int, known: Candidate, hurried: bool) -> Candidate:
        """Return the design of a combination that is least worse, as good as its parts allow, ties settled."""
        form, near, m = self.form, self.near, self.m
        if hurried:
            return known
        gap = self.limits.settling_gap
        slack = np.where(form.objectives.log[:m], -np.log1p(-gap), gap / self.share * near.tolerance)
        cutoffs = near.fixed_cutoffs.copy()
        cutoffs[:m] = near.base[:m] + max(float(near.worse(known.phi[None, :])[0]), 0.0) * near.tolerance + near.tie
        rule = EpsilonCover(range(m), slack, cutoffs, form.new_archive(range(m)))
        rule.take(np.array([combination]), known.variables[None, :], known.phi[None, :])
        branch_and_bound(
            form, form.boxes.leaves(np.array([combination])), rule, self.clock, self.rng, self.limits.settling_boxes
        )
        worst = near.worse(rule.known.phi)
        best = rule.known[int(np.lexsort((*rule.known.phi.T[::-1], np.round(worst, 9)))[0])]
        (better,) = polish_discrete(form, [best], m, range(len(form.goals)), parts=False)
        (exact,) = polish_variables(form, [better], m)
        return exact

    # -- the report ----------------------------------------------------------------------------

    def _result(self, candidates: Sequence[Candidate], count: int, complete: bool, interrupted: str) -> NearEquals:
        form = self.form
        points = np.array([c.variables for c in candidates]).reshape(len(candidates), form.n)
        numbers = np.array([c.combination for c in candidates], dtype=np.int64)
        result = form.points.evaluate(points, numbers)
        objectives = list(self.reference.frame.objectives)
        digits = written_digits(self.instance, points, self.instance.data(numbers), result, objectives)
        designs, changes, differences = [], [], []
        for k, c in enumerate(candidates):
            parts, _, choices = self.instance.combinations.describe(c.combination)
            rows = {slot: part_row(table, row) for slot, (table, row) in parts.items()}
            design = make_design(
                self.instance,
                self.reference.frame,
                c.variables,
                result,
                k,
                rows,
                choices,
                status=Status.FEASIBLE,
                rank=k + 1,
                digits=digits[k],
            )
            designs.append(design)
            changes.append({n: _change(design.objectives[n], self.reference.objectives[n]) for n in self.chosen})
            others = self.instance.combinations.differences(self.number, c.combination)
            differences.append(tuple(f"{name} {its}" for name, _, its in others))
        undecided = (
            None
            if self.looked > self.limits.boxes or count > self.limits.most or interrupted
            else len(self.undecided - set(self.near.best))
        )
        statistics = {
            "combinations": self.instance.combinations.count,
            "boxes": form.counters.contracted,
            "nlp_solves": form.counters.nlp_solves,
            "seconds": time.monotonic() - self.started,
        }
        return NearEquals(
            self.reference,
            designs,
            self.share,
            count,
            complete,
            undecided,
            changes,
            differences,
            [self._rank(design) for design in designs],
            statistics,
            interrupted,
        )

    def _rank(self, design: Design) -> int | None:
        """Return the rank of the design of the front that is the same."""
        codec = self.instance.combinations
        number = codec.number(design)
        return next((d.rank for d in self.front.designs if codec.number(d) == number and _same(d, design)), None)


def _same(one: Design, other: Design) -> bool:
    """True if two designs of the same parts have the same sizes."""
    sizes = [n for n, kind in one.frame.kinds.items() if kind == "variable"]
    return all(math.isclose(one.values[n], other.values[n], rel_tol=MARGINS.same) for n in sizes)


def _change(value: float, reference: float) -> float:
    return (value - reference) / abs(reference) if reference else math.nan if value else 0.0
