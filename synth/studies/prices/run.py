"""Prices of requirements and limits: the multipliers, and what solving again makes of them.

Each requirement and limit is moved a little up and down. With the parts of the design the continuous problem solved
again must cost what the multipliers say; with the other parts tried nothing may become better, or the price is theirs.
All problems of a design and objective that differ in one of these are solved at once.
"""

from __future__ import annotations

import math
import time
from collections.abc import Sequence
from contextlib import nullcontext
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from synth.analysis.restate import question_of
from synth.errors import InputError, at
from synth.folders.output_folder import claimed
from synth.model.constraint import void_limits
from synth.nlp.batch import Solutions, Tasks
from synth.question.arguments import Family, UserTables, Value
from synth.question.instance import Instance
from synth.question.settings import Progress, SearchSettings, check_progress
from synth.results import Design, ParetoFront
from synth.results.provenance import hash_of
from synth.search.formulation import Formulation
from synth.search.sensitivity import Optima, optima
from synth.studies.prices.price_list import (
    CHANGE,
    CONFIRMED,
    FIXED,
    NOTHING,
    PRICES_FORMAT,
    WITHHELD,
    Price,
    Prices,
    PriceStore,
    price_sentence,
)
from synth.studies.prices.resolve import Move, Resolver
from synth.studies.settings import PRICES, PriceLimits
from synth.system.deadline import Stopped, stoppable
from synth.text.numbers import more_or_less, number_text, percent
from synth.units import parse_quantity
from synth.verbs.requests import PricesRequest

LEAST_STEP, WIDEST_STEP = 1e-4, 0.1


def prices(
    front: ParetoFront,
    design: int | Sequence[int] | None = None,
    step: Value = PricesRequest.step,
    *,
    problem: Family | None = None,
    catalogs: UserTables = None,
    progress: Progress | None = None,
    time_limit: float | None = None,
    folder: str | Path | None = None,
) -> Prices:
    """Tell what a per cent of each requirement and limit costs in each objective, as solving again confirms it.

    Parameters
    ----------
    front : ParetoFront
        From ``synthesize`` or ``load_front``.
    design : int or list of int, optional
        Ranks of the designs; all when not given.
    step : text or float
        By how much each requirement and limit is moved up and down, "1 %" or 0.01.
    problem, catalogs : optional
        As for ``ParetoFront.verify``: for a loaded front of a problem, or with tables, of one's own.
    progress : callable, optional
        Called with a mapping: stage, done, combinations, message.
    time_limit : float, optional
        Seconds after which the designs that are finished are returned.
    folder : path, optional
        Where finished designs are kept; the same call does not solve them again.

    Returns
    -------
    Prices

    Raises
    ------
    InputError
        When a design is not one of the front, or the step is not of its kind.
    """
    settings = SearchSettings(time_limit=time_limit)
    check_progress(progress)
    chosen = chosen_designs(front, design)
    share = read_step(step)
    instance = question_of(front, problem, catalogs)
    digest = front.result_digest
    key = hash_of([PRICES_FORMAT, digest, share, instance.fingerprint().combined])
    place = None if folder is None else Path(folder)
    with nullcontext() if place is None else claimed(place):
        store = PriceStore.of(place, key, str(digest))
        return _Pricing(instance, front, share, settings, progress).run(chosen, store)


def read_step(step: object) -> float:
    """Return by which share each requirement and limit is moved.

    Raises
    ------
    InputError
        It is no share, or not one for which prices can be told.
    """
    with at("step"):
        share = parse_quantity(step, "-", "step")
        if not LEAST_STEP <= share <= WIDEST_STEP:
            raise InputError("step", step, f"from {percent(LEAST_STEP)} to {percent(WIDEST_STEP)}, for example '1 %'")
    return share


def chosen_designs(front: ParetoFront, design: object) -> list[Design]:
    """Requested designs of a front by rank; all where none is named.

    Raises
    ------
    InputError
        One of them is no design of the front, or there is none.
    """
    if not front.designs:
        raise InputError("front", "no designs", "a front with designs")
    ranks = {d.rank: d for d in front.designs}
    requested = list(ranks) if design is None else list(design) if isinstance(design, (list, tuple)) else [design]
    for rank in requested:
        if isinstance(rank, bool) or not isinstance(rank, (int, np.integer)) or rank not in ranks:
            raise InputError("design", rank, f"a rank from 1 to {len(front.designs)}", ("design",))
    if not requested:
        raise InputError("design", requested, f"at least one rank from 1 to {len(front.designs)}", ("design",))
    return [ranks[rank] for rank in dict.fromkeys(requested)]


@dataclass(frozen=True)
class _Side:
    """The price in one direction: None where withheld; why, and what else changes."""

    price: float | None
    reason: str = ""
    change: str = ""
    share: float = 1.0  # of the step, for which it holds


class _Pricing:
    """The prices of some designs of one question."""

    def __init__(
        self,
        instance: Instance,
        front: ParetoFront,
        step: float,
        settings: SearchSettings,
        progress: Progress | None,
        limits: PriceLimits = PRICES,
    ) -> None:
        self.started = time.monotonic()
        self.deadline = math.inf if settings.time_limit is None else self.started + settings.time_limit
        self.instance, self.frame, self.step, self.progress = instance, front.frame, step, progress
        self.again = Resolver(instance, front, step, limits)

    # -- the run -------------------------------------------------------------------------------

    def run(self, designs: Sequence[Design], store: PriceStore) -> Prices:
        """Price the designs one after the other; what is finished when time is over is kept."""
        rows: tuple[Price, ...] = ()
        kept = 0
        with stoppable(self.deadline) as ending:
            for number, design in enumerate(designs):
                rank = int(design.rank or 0)
                known = store.get(rank)
                kept += known is not None
                if known is None:
                    known = self._design(design, number, len(designs))
                    store.put(rank, known)
                rows += tuple(known)
        statistics = {
            "combinations": self.instance.combinations.count,
            "nlp_solves": self.again.form.counters.nlp_solves,
            "kept": kept,
            "seconds": time.monotonic() - self.started,
        }
        ranks, makeable = tuple(int(d.rank or 0) for d in designs), bool(self.again.form.gridded.any())
        return Prices(
            self.frame, ranks, self.step, rows, makeable, store.fingerprint, statistics, ending.reason, store.front
        )

    def _say(self, number: int, of: int, share: float) -> None:
        if self.progress is not None:
            self.progress(
                {
                    "stage": f"design {number + 1} of {of}",
                    "done": (number + share) / of,
                    "combinations": self.instance.combinations.count,
                    "message": "",
                }
            )
        if time.monotonic() > self.deadline:
            raise Stopped("time limit")

    def _design(self, design: Design, number: int, of: int) -> list[Price]:
        again, form = self.again, self.again.form
        combination = self.instance.combinations.number(design)
        point = np.array([[design.values[v.name] for v in self.instance.model.variables]]).reshape(1, form.n)
        _, phi = form.points.feasible_rows(point, np.array([combination]))
        others = again.others(combination)
        rows: list[Price] = []
        for k in range(again.m):
            self._say(number, of, k / again.m)
            best = optima(form, np.array([combination]), point, phi, again.m, k)
            rows += _Case(again, design, combination, phi[0], k, best, others).rows()
        return rows


class _Case:
    """The prices in one objective of one design."""

    def __init__(
        self, again: Resolver, design: Design, chosen: int, phi: np.ndarray, k: int, best: Optima, others: np.ndarray
    ) -> None:
        self.again, self.design, self.chosen, self.phi, self.k, self.best = (again, design, chosen, phi, k, best)
        form = again.form
        self.goal = form.goals[k]
        self.objective = form.names[k]
        self.base = float(best.phi[0])
        self.others = others
        # phi times this is the share of the objective; nothing where the objective is 0.
        self.noise = form.tuning.tolerances.multiplier_noise
        size = abs(self.base)
        self.unit = 1.0 if form.objectives.log[k] else 1.0 / size if size > self.noise else math.nan
        self.compared = ""
        self.already: dict[int, float] = {}

    def rows(self) -> list[Price]:
        """Return the price of everything that is moved."""
        why = ""
        if not bool(self.best.converged[0]):
            why = "the solver does not confirm that these parts can do no better"
        elif not math.isfinite(self.unit):
            why = f"{self.objective} is 0 here: there is no per cent of it"
        if why:
            return [self._withheld(up, why) for up in self.again.moves[: self.again.count : 2]]
        held = self._with_parts_held()
        better = self._elsewhere(held)
        if self.already:
            self.compared += f"; {self._ahead()}"
        return [self._row(number, held, better) for number in range(0, self.again.count, 2)]

    # -- re-solves -----------------------------------------------------------------------------

    def _with_parts_held(self) -> tuple[Solutions, np.ndarray, np.ndarray]:
        """Solve again with the parts of the design, each thing moved."""
        count = len(self.again.moves)
        start = np.repeat(self.best.variables, count, axis=0)
        return self.again.solved(np.full(count, self.chosen), start, np.arange(count), self.phi, self.k)

    def _elsewhere(self, held: tuple[Solutions, np.ndarray, np.ndarray]) -> list[tuple[float, int] | None]:
        """Return, per move, how good the best of the other parts become there, if they overtake; and which."""
        best: list[tuple[float, int] | None] = [None] * self.again.count
        if self.again.instance.combinations.count == 1:
            self.compared = "no other parts are offered"
        if not len(self.others):
            return best
        reached = self._reached(held, *self._still())
        for number in range(self.again.count):
            c = int(np.argmin(reached[:, number]))
            if reached[c, number] == np.inf:
                continue
            gain = np.inf
            if held[1][number]:
                mine = float(held[0].phi[number, self.k])
                gain = (mine - reached[c, number]) * self.unit / self.again.step
                gain -= self.again.limits.share * abs(self._price(mine, number)) + self.again.limits.slack
            if gain > 0:
                best[number] = float(reached[c, number]), int(self.others[c])
        return best

    def _still(self) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Results of :meth:`_without_a_step` for other parts, and for more that are like the best of them."""
        total = self.again.instance.combinations.count
        values, start, near = self._without_a_step(self.others)
        every, parents = total <= self.again.limits.all, np.argsort(values, kind="stable")[: self.again.limits.parents]
        if not every:
            further = self.again.around(self.others[parents[near[parents]]], np.append(self.others, self.chosen))
            more = self._without_a_step(further)
            values, start, near = (np.concatenate(pair) for pair in zip((values, start, near), more, strict=True))
            self.others = np.concatenate([self.others, further])
        self.compared = (
            f"over all {total} combinations tried"
            if every
            else f"over the {len(self.others) + 1} combinations tried, of {total}"
        )
        return values, start, near

    def _reached(
        self, held: tuple[Solutions, np.ndarray, np.ndarray], values: np.ndarray, start: np.ndarray, near: np.ndarray
    ) -> np.ndarray:
        """Gain by other parts per move (parts, moves); infinite where they are not worth a look.

        What is ahead of the design without any move is noted, and no price.
        """
        # Where a step leaves nothing of these parts, others may be far worse and still the best.
        refused = np.array([bool(m.refused) for m in self.again.moves])
        tried = near[:, None] | (~held[1] & ~refused)[None, : self.again.count]
        rows, moves = np.nonzero(tried)
        solutions, kept, _ = self.again.solved(self.others[rows], start[rows], moves, self.phi, self.k)
        reached = np.full(tried.shape, np.inf)
        reached[rows[kept], moves[kept]] = solutions.phi[kept, self.k]
        ahead = (values - self.base) * self.unit < -self.again.limits.even
        self.already = {int(self.others[c]): float((self.base - values[c]) * self.unit) for c in np.flatnonzero(ahead)}
        reached[ahead] = np.inf
        return reached

    def _without_a_step(self, others: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Values of other combinations, their places, and those that a step may bring within reach."""
        form, k, count = self.again.form, self.k, len(others)
        still = np.full(count, -1)
        start = np.repeat(self.best.variables, count, axis=0)
        solutions, kept, _ = self.again.solved(others, start, still, self.phi, k)
        values, start = np.where(kept, solutions.phi[:, k], np.inf), solutions.variables.copy()
        reach = self.again.step * self.again.limits.reach / self.unit
        near = values - self.base <= reach
        lost = np.flatnonzero(~kept)
        if len(lost) and form.n:
            looser = self._looser(others[lost], start[lost], reach)
            met = looser.violation <= form.tuning.nlp.missed
            near[lost] = met & (looser.t <= self.again.limits.looser * self.again.step)
            start[lost] = looser.variables
        elif len(lost):
            near[lost] = True
        return values, start, near

    def _looser(self, combinations: np.ndarray, start: np.ndarray, reach: float) -> Solutions:
        """Solve for the least by which limits and objectives would have to give way."""
        form, count = self.again.form, len(combinations)
        nothing = np.zeros((count, len(form.goals)))
        cutoffs, slopes = np.full(nothing.shape, np.inf), nothing.copy()
        cutoffs[:, : self.again.m] = self.phi[: self.again.m] + form.tuning.tolerances.tie
        cutoffs[:, self.k] = self.base + reach
        slopes[:, : self.again.m] = np.where(form.objectives.log, 1.0, np.abs(self.phi))[: self.again.m]
        tasks = Tasks(nothing, slopes, cutoffs, form.objectives.scales, elastic=1.0)
        return form.continuous.solve_batch(tasks, combinations, start, skipped=self.again.fixed)

    # -- prices --------------------------------------------------------------------------------

    def _price(self, reached: float, number: int) -> float:
        """Return the price that a re-solve tells: per cent of the objective per per cent."""
        worse = (reached - self.base) * self.unit
        return self.goal.sign * worse / math.log(self.again.moves[number].factor)

    def _jump(self, reached: float, number: int) -> float:
        """Return the whole change over the step, per cent per per cent: with other parts there is no slope."""
        worse = (reached - self.base) * self.unit
        share = math.expm1(worse) if self.again.form.objectives.log[self.k] else worse
        return float(self.goal.sign * share / (self.again.moves[number].factor - 1.0))

    def _slope(self, move: Move) -> float:
        """Return the price by the multipliers."""
        if move.kind == "range":
            k, _ = self.again.ranges[move.position]
            lower, upper = self.again.holds_range(move.position)
            slope = float(self.best.ends[0, k])
            # At its lower end an objective would fall with less, at its upper end with more.
            slope = max(slope, 0.0) * lower + min(slope, 0.0) * upper
        else:
            slopes = self.best.limits if move.kind == "limit" else self.best.requirements
            slope = float(slopes[0, move.position])
        price = self.goal.sign * slope * self.unit
        return price if math.isnan(price) or abs(price) > self.noise else 0.0

    def _row(
        self, number: int, held: tuple[Solutions, np.ndarray, np.ndarray], better: list[tuple[float, int] | None]
    ) -> Price:
        move = self.again.moves[number]
        missing = self._no_per_cent(move)
        if missing:
            return self._withheld(move, missing)
        slope = self._slope(move)
        slope = 0.0 if math.isnan(slope) else slope  # void: the limit says nothing of these parts
        up, down = (self._side(n, slope, held, better[n]) for n in (number, number + 1))
        changed = bool(up.change or down.change)
        if up.price is None and down.price is None:
            status = WITHHELD
        elif changed:
            status = CHANGE
        elif up.price is None or down.price is None:
            status = f"{WITHHELD} {'up' if up.price is None else 'down'}"
        elif up.price == 0 and down.price == 0:
            status = NOTHING
        else:
            status = FIXED if self.already else CONFIRMED
        words = (
            [up.reason]
            if up.reason == down.reason
            else [f"{side}wards {x.reason}" for side, x in (("up", up), ("down", down)) if x.reason]
        )
        shares = (up.share, down.share)
        return self._priced(
            move,
            slope,
            up.price,
            down.price,
            status,
            "; ".join(w for w in words if w),
            (up.change, down.change),
            shares,
        )

    def _no_per_cent(self, move: Move) -> str:
        if move.kind == "requirement":
            value = self.again.instance.values.requirements[move.name]
            return "" if value else f"{move.name} is 0: there is no per cent of it"
        if move.kind == "range":
            limit = self.again.ranges[move.position][1].bound
            return "" if limit else f"the limit {move.name} is 0: there is no per cent of it"
        void = bool(
            void_limits(self.again.form.constraints, self.again.instance.data(np.array([self.chosen])), 1)[
                0, move.position
            ]
        )
        if void or math.isfinite(float(self.best.limits[0, move.position])):
            return ""
        return f"the limit {move.name} is 0 here: there is no per cent of it"

    def _side(
        self,
        number: int,
        slope: float,
        held: tuple[Solutions, np.ndarray, np.ndarray],
        better: tuple[float, int] | None,
    ) -> _Side:
        move = self.again.moves[number]
        way = self._way(move)
        if move.refused:
            return _Side(None, f"{way} {move.refused}")
        if better is not None:
            reached, other = better
            parts = self.again.difference(self.chosen, other)
            kept = bool(held[1][number])
            why = "other parts become better" if kept else f"with {way} these parts cannot keep all limits, others can"
            return _Side(self._jump(reached, number), f"{why}: {parts}", parts)
        why = self._trouble(number, slope, held)
        if not why:
            return _Side(slope)
        fine = number + self.again.count
        again = self._trouble(fine, slope, held)
        if not again:
            return _Side(
                slope,
                f"holds for {percent(self.again.limits.fine * self.again.step)}; {why}",
                share=self.again.limits.fine,
            )
        prefix = f"the multipliers say {number_text(slope, 3)}, but " if held[1][number] else ""
        return _Side(None, f"{prefix}{why}" if again == why else f"{prefix}{why}, {again}")

    def _way(self, move: Move) -> str:
        return more_or_less(abs(move.factor - 1.0), move.factor > 1)

    def _trouble(self, number: int, slope: float, held: tuple[Solutions, np.ndarray, np.ndarray]) -> str:
        """Reason why solving again with the parts of the design does not confirm a price; empty where it does."""
        solutions, kept, broken = held
        way = self._way(self.again.moves[number])
        if not kept[number] and broken[number] >= 0:
            return f"{way} breaks {self.again.limit_names[broken[number]]}, which no size of these parts can restore"
        if not kept[number]:
            others = " and the other objectives" if self.again.m > 1 else ""
            return f"with {way} no design of these parts was found that keeps all limits{others}"
        if not bool(solutions.converged[number]):
            return f"with {way} the solver does not confirm the optimum"
        again = self._price(float(solutions.phi[number, self.k]), number)
        if self._agree(again, slope):
            return ""
        return f"solving again with {way} gives {number_text(again, 3)}{self._what_binds(solutions, number)}"

    def _agree(self, again: float, slope: float) -> bool:
        limits = self.again.limits
        return abs(again - slope) <= limits.share * max(abs(again), abs(slope)) + limits.slack

    def _what_binds(self, solutions: Solutions, number: int) -> str:
        """Limits that begin or end to bind on the way, as the reasons of a bend."""
        before, after = self.best.multipliers[0], solutions.constraint_multipliers[number]
        names = self.again.limit_names
        binds = self.again.limits.binds
        begins = [names[j] for j in np.flatnonzero((np.abs(after) > binds) & (np.abs(before) <= binds))]
        ends = [names[j] for j in np.flatnonzero((np.abs(before) > binds) & (np.abs(after) <= binds))]
        form = self.again.form
        old, new = (self._at_end(form, x) for x in (self.best.variables[0], solutions.variables[number]))
        begins += [f"the range of {form.model.variables[j].name}" for j in sorted(new - old)]
        ends += [f"the range of {form.model.variables[j].name}" for j in sorted(old - new)]
        words = [f"{' and '.join(begins)} begin{'s' if len(begins) == 1 else ''} to bind"] if begins else []
        words += [f"{' and '.join(ends)} no longer bind{'s' if len(ends) == 1 else ''}"] if ends else []
        return f" ({', '.join(words)})" if words else ""

    @staticmethod
    def _at_end(form: Formulation, x: np.ndarray) -> set[int]:
        free = form.lower < form.upper
        slack = 1e-6 * np.maximum(np.abs(form.lower), np.abs(form.upper))
        return set(np.flatnonzero(free & ((x <= form.lower + slack) | (x >= form.upper - slack))).tolist())

    def _ahead(self) -> str:
        """Return in words which parts would be better without any step, were sizes continuous."""
        other = max(self.already, key=lambda c: self.already[c])
        parts, share = self.again.difference(self.chosen, other), percent(self.already[other])
        more = f" (and {len(self.already) - 1} more)" if len(self.already) > 1 else ""
        within = (
            "with sizes that need not be makeable" if self.again.form.gridded.any() else "within the gap of the front"
        )
        return f"{within}, {parts} is {share} better already{more}"

    # -- rows ----------------------------------------------------------------------------------

    def _withheld(self, move: Move, why: str) -> Price:
        return self._priced(move, None, None, None, WITHHELD, why, ("", ""))

    def _priced(
        self,
        move: Move,
        slope: float | None,
        up: float | None,
        down: float | None,
        status: str,
        reason: str,
        changes: tuple[str, str],
        shares: tuple[float, float] = (1.0, 1.0),
    ) -> Price:
        sense = "min" if self.goal.sign > 0 else "max"
        shown, kind = move.name, "requirement" if move.kind == "requirement" else "limit"
        if move.kind == "requirement" and self.again.instance.model.declaration.requirements[move.name].unit == "degC":
            shown = f"{move.name} (in kelvin)"
        steps = (shares[0] * self.again.step, shares[1] * self.again.step)
        sentence = price_sentence(shown, kind, self.objective, sense, steps, up, down, changes)
        compared = self.compared if status != WITHHELD else ""
        return Price(
            int(self.design.rank or 0),
            self.objective,
            move.name,
            kind,
            slope,
            up,
            down,
            status,
            reason,
            compared,
            sentence,
        )
