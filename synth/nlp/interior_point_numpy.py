"""The interior-point method over arrays: one lane per problem, all lanes take a step together.

See :mod:`synth.nlp.interior_point` for the method.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, fields
from typing import Any

import numpy as np

from synth.nlp.interior_point import (
    CONVERGED,
    INFEASIBLE,
    STOPPED,
    STUCK,
    Ends,
    Problems,
    SparsityPattern,
    solve_shifted,
    split,
)
from synth.nlp.row_functions import RowFunctions
from synth.nlp.settings import NLP, InteriorPointSettings, NlpSettings
from synth.system import deadline


class InteriorPoint:
    """The solver of one set of row functions.

    Parameters
    ----------
    functions : RowFunctions
    settings : NlpSettings
    """

    def __init__(self, functions: RowFunctions, settings: NlpSettings = NLP) -> None:
        self.functions, self.settings = functions, settings
        self.point = functions.compile_point()
        self.layout = SparsityPattern(functions)

    def solve(self, problems: Problems) -> Ends:
        """Solve all problems, each from its start."""
        n, rows, count = self.functions.n, self.functions.n_rows, len(problems)
        ends = Ends.empty(n, rows, count)
        waiting, most, refill = 0, self.settings.lanes, self.settings.refill
        lanes: InteriorPointBatch | None = None
        with np.errstate(all="ignore"):
            while lanes is not None or waiting < count:
                if waiting < count and (lanes is None or len(lanes) < refill * most):
                    upto = min(count, waiting + most - (0 if lanes is None else len(lanes)))
                    fresh = InteriorPointBatch.of(self.layout, self.settings.method, problems, np.arange(waiting, upto))
                    lanes = fresh if lanes is None else lanes.joined(fresh)
                    waiting = upto
                assert lanes is not None
                deadline.check()
                lanes.advance(self.point)
                lanes = lanes.without_finished(ends)
        return ends


@dataclass
class InteriorPointBatch:
    """Problems on their way: numbers, point, trial point and direction of each, one column per lane.

    ``multipliers`` are those of the rows, above the least they can be (0, or minus the penalty for an equality);
    names that end in ``_change`` belong to the full step, ``uncorrected`` and ``forecast`` to the last Newton step.
    """

    layout: SparsityPattern
    method: InteriorPointSettings
    stored: list[Any]
    number: np.ndarray
    # the problem
    low: np.ndarray
    high: np.ndarray
    free: np.ndarray
    counts: np.ndarray
    slopes: np.ndarray
    rights: np.ndarray
    weights: np.ndarray
    t_weight: np.ndarray
    t_free: np.ndarray
    # the point
    y: np.ndarray
    t: np.ndarray
    form: np.ndarray
    values: np.ndarray
    absent: np.ndarray
    missing: np.ndarray
    multipliers: np.ndarray
    low_dual: np.ndarray
    high_dual: np.ndarray
    barrier: np.ndarray
    penalty: np.ndarray
    next_penalty: np.ndarray
    restoring: np.ndarray
    merit: np.ndarray
    # the step
    direction: np.ndarray
    change: np.ndarray
    low_change: np.ndarray
    high_change: np.ndarray
    slope: np.ndarray
    step: np.ndarray
    dual_step: np.ndarray
    rejected: np.ndarray
    uncorrected: np.ndarray
    forecast: np.ndarray
    evaluations: np.ndarray
    late: np.ndarray
    status: np.ndarray

    @staticmethod
    def of(
        layout: SparsityPattern, method: InteriorPointSettings, problems: Problems, number: np.ndarray
    ) -> InteriorPointBatch:
        """Return lanes for some of the problems, at their starts."""
        n, rows, count = layout.n, layout.rows, len(number)
        low, high = problems.low[:, number], problems.high[:, number]
        width = high - low
        free = width > method.pinned_width
        inside = np.clip(problems.start[:, number], low + method.inside * width, high - method.inside * width)
        counts, slopes, t_weight = problems.counts[:, number], problems.slopes[:, number], problems.t_weight[number]
        t_free = (t_weight != 0) & np.any((slopes != 0) & counts, axis=0)
        zeros = {
            ("form", "values", "multipliers", "forecast", "change"): np.zeros((rows, count)),
            ("low_dual", "high_dual", "low_change", "high_change"): np.zeros((n, count)),
            ("direction", "uncorrected"): np.zeros((n + 1, count)),
            ("t", "merit", "slope", "step", "dual_step"): np.zeros(count),
            ("rejected", "evaluations", "late", "status"): np.zeros(count, dtype=np.int64),
        }
        return InteriorPointBatch(
            layout=layout,
            method=method,
            stored=[x if np.ndim(x) == 0 else x[number] for x in problems.stored],
            number=number,
            low=low,
            high=high,
            free=free,
            counts=counts,
            slopes=np.where(counts & t_free, slopes, 0.0),
            rights=problems.rights[:, number],
            weights=problems.weights[:, number],
            t_weight=t_weight,
            t_free=t_free,
            y=np.where(free, inside, 0.5 * (low + high)),
            absent=np.ones((rows, count), dtype=bool),
            missing=np.full(count, rows + 2),
            barrier=np.full(count, method.first_barrier),
            penalty=np.full(count, method.first_penalty),
            next_penalty=np.full(count, method.first_penalty),
            restoring=np.zeros(count, dtype=bool),
            **{name: zero for names, zero in zeros.items() for name in names},
        )

    def __len__(self) -> int:
        return len(self.number)

    def joined(self, other: InteriorPointBatch) -> InteriorPointBatch:
        """Return these lanes and others after them."""
        mine, its = self._arrays(), other._arrays()
        stored = [
            x if np.ndim(x) == 0 else np.concatenate([x, y]) for x, y in zip(self.stored, other.stored, strict=True)
        ]
        return InteriorPointBatch(
            self.layout, self.method, stored, **{k: np.concatenate([mine[k], its[k]], axis=-1) for k in mine}
        )

    def _arrays(self) -> dict[str, np.ndarray]:
        return {field.name: getattr(self, field.name) for field in fields(self)[3:]}

    def without_finished(self, ends: Ends) -> InteriorPointBatch | None:
        """Write finished lanes to their places and return those that go on."""
        done = self.status != 0
        if not done.any():
            return self
        number = self.number[done]
        ends.y[:, number], ends.t[number] = self.y[:, done], self.t[done]
        ends.rows[:, number] = self.form[:, done]
        ends.multipliers[:, number] = np.where(self.counts & ~self.absent, self._signed(self.multipliers), 0.0)[:, done]
        ends.status[number], ends.evaluations[number] = self.status[done], self.evaluations[done]
        if done.all():
            return None
        keep = np.flatnonzero(~done)
        stored = [x if np.ndim(x) == 0 else x[keep] for x in self.stored]
        return InteriorPointBatch(
            self.layout, self.method, stored, **{k: v[..., keep] for k, v in self._arrays().items()}
        )

    # -- one step ------------------------------------------------------------------------------

    def advance(self, point: Callable[..., list[Any]]) -> None:
        """Evaluate all trial points, take those that are good enough, and find the next ones."""
        method = self.method
        y, t = self.y + self.step * self.direction[:-1], self.t + self.step * self.direction[-1]
        multipliers = self.multipliers + self.dual_step * self.change
        form, jacobian, hessian = self._evaluate(point, y, multipliers)
        absent, missing = self._absent(form, jacobian)
        values = self._values(form, t, absent, missing)
        merit = self._merit(y, t, form, values, missing)
        enough = self.merit + method.armijo * self.step * self.slope + method.rounding * (1 + np.abs(self.merit))
        fresh = missing < self.missing
        accepted = fresh | ((missing == self.missing) & (merit <= enough))
        self._set(
            accepted,
            y=y,
            t=t,
            form=form,
            values=values,
            absent=absent,
            missing=missing,
            multipliers=multipliers,
            low_dual=self.low_dual + self.dual_step * self.low_change,
            high_dual=self.high_dual + self.dual_step * self.high_change,
        )
        self.evaluations = self.evaluations + 1
        self.late = self.late + (self.barrier <= method.late_barrier)
        self.rejected = np.where(accepted, 0, self.rejected + 1)
        if fresh.any():
            self._begin(fresh)
        slopes = np.where(self._idle(absent, missing) | self._first(missing), 0.0, self.slopes)
        again = self._judge(accepted, jacobian, slopes)
        bent = (self.rejected == 1) & (missing == self.missing) & np.isfinite(merit)
        self._direct(accepted, bent, jacobian, hessian, slopes, values)
        self._restart(again | self._stuck(~accepted))

    def _set(self, where: np.ndarray, **values: np.ndarray) -> None:
        every = bool(where.all())
        for name, value in values.items():
            setattr(self, name, value if every else np.where(where, value, getattr(self, name)))

    def _evaluate(
        self, point: Callable[..., list[Any]], y: np.ndarray, multipliers: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray, list[np.ndarray]]:
        layout, count = self.layout, len(self)
        weights = np.where(self.counts & ~self.absent, self._signed(multipliers), 0.0)
        weights[layout.constraints :] += self._objective()
        out = point(list(y), list(weights), self.stored)
        form, jacobian = np.empty((layout.rows, count)), np.empty((len(layout.row), count))
        for k in range(layout.rows):
            form[k] = out[k]
        for k in range(len(layout.row)):
            jacobian[k] = out[layout.rows + k]
        return form, jacobian, out[layout.rows + len(layout.row) :]

    def _objective(self) -> np.ndarray:
        """Return the weights of the objectives; while rows are to be met at all there are none."""
        return np.where(self._first(self.missing), 0.0, self.weights)

    def _first(self, missing: np.ndarray) -> np.ndarray:
        """Lanes that only look for a point where all rows exist and hold."""
        first: np.ndarray = (missing > 0) | self.restoring
        return first

    def _absent(self, form: np.ndarray, jacobian: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Relevant rows that do not exist at a point, and their number; their form and derivatives are cleared."""
        layout = self.layout
        relevant = self.counts.copy()
        relevant[layout.constraints :] |= self.weights != 0
        absent = ~(np.abs(form) < self.method.largest_row)
        strange = ~np.isfinite(jacobian)
        if strange.any():
            np.logical_or.at(absent, layout.row, strange)
        absent &= relevant
        missing = absent.sum(axis=0)
        if layout.has_guard:
            guard = layout.guard[:, None]
            beyond = np.any(self.counts & guard & ~(form <= 0), axis=0)
            absent |= beyond & relevant & ~guard
            missing = absent.sum(axis=0) + beyond
        form[absent] = np.nan
        silent = ~relevant | self._idle(absent, missing)
        jacobian[silent[layout.row] | ~self.free[layout.column]] = 0.0
        return absent, missing

    def _idle(self, absent: np.ndarray, missing: np.ndarray) -> np.ndarray:
        """Return rows that do not count at a point.

        As long as rows are to be met, those that t can meet do not; as long as rows are to exist, limits all do.
        """
        soft: np.ndarray = (self.slopes != 0) & (self.restoring | (self.layout.is_goal & (missing > 0)))
        idle: np.ndarray = absent | soft
        return idle

    def _values(self, form: np.ndarray, t: np.ndarray, absent: np.ndarray, missing: np.ndarray) -> np.ndarray:
        """Excess of each row over its right side; -1 where there is no row."""
        here = self.counts & ~self._idle(absent, missing)
        return np.where(here, form - self.slopes * t - self.rights, -1.0)

    def _signed(self, multipliers: np.ndarray) -> np.ndarray:
        """Return multipliers with the sign of their row; those of equalities are kept from minus the penalty on."""
        return multipliers - np.where(self.layout.equal, self.penalty, 0.0) if self.layout.has_equal else multipliers

    def _prices(self) -> np.ndarray:
        return np.where(self.layout.equal, 2 * self.penalty, self.penalty) if self.layout.has_equal else self.penalty

    def _bound_distances(self, y: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        return np.where(self.free, y - self.low, 1.0), np.where(self.free, self.high - y, 1.0)

    def _merit(
        self, y: np.ndarray, t: np.ndarray, form: np.ndarray, values: np.ndarray, missing: np.ndarray
    ) -> np.ndarray:
        """Return the function that the line search makes smaller, but for a constant."""
        prices = self._prices()
        least = 2 * self.barrier / prices
        length = np.sqrt(values * values + least * least)
        rows = 0.5 * prices * (values + length) - self.barrier * np.log(least + length)
        if self.layout.has_equal:
            rows -= np.where(self.layout.equal, self.penalty * values, 0.0)
        below, above = self._bound_distances(y)
        goals = form[self.layout.constraints :]
        objective = np.where(self.weights != 0, self.weights * goals, 0.0).sum(axis=0) + self.t_weight * t
        barrier = self.barrier * np.log(below * above).sum(axis=0)
        result: np.ndarray = rows.sum(axis=0) - barrier + np.where(self._first(missing), 0.0, objective)
        return result

    def _begin(self, fresh: np.ndarray) -> None:
        """Set multipliers, barrier and t where the rows that count have just changed."""
        method = self.method
        soft = self.counts & (self.slopes > 0) & ~self.layout.equal & ~self.absent
        needed = np.where(soft, (self.form - self.rights) / np.where(soft, self.slopes, 1.0), -np.inf)
        first = needed.max(axis=0, initial=-np.inf) + method.first_slack
        held = ~self.t_free | self._first(self.missing) | ~np.isfinite(first)
        self._set(fresh, t=np.where(held, 0.0, first))
        self._set(
            fresh,
            values=self._values(self.form, self.t, self.absent, self.missing),
            barrier=np.full(len(self), method.first_barrier),
            penalty=np.where(self._first(self.missing), method.first_penalty, self.next_penalty),
        )
        below, above = self._bound_distances(self.y)
        _, _, implied = split(self.values, self.barrier, self._prices())
        self._set(fresh, multipliers=implied, low_dual=self.barrier / below, high_dual=self.barrier / above)

    def _bring_in(self, implied: np.ndarray, below: np.ndarray, above: np.ndarray) -> None:
        """Keep multipliers within reach of those that the point itself implies."""
        method = self.method
        prices = self._prices()
        top = np.minimum(implied * method.multiplier_spread, prices - (prices - implied) / method.multiplier_spread)
        self.multipliers = np.clip(self.multipliers, implied / method.multiplier_spread, top)
        for name, distance in (("low_dual", below), ("high_dual", above)):
            implied = self.barrier / distance
            kept = np.clip(getattr(self, name), implied / method.multiplier_spread, implied * method.multiplier_spread)
            setattr(self, name, kept)

    def _judge(self, accepted: np.ndarray, jacobian: np.ndarray, slopes: np.ndarray) -> np.ndarray:
        """End lanes whose point is good enough, or will never be; else set the barrier.

        Returns which lanes must start again where they are, because what they look for has changed.
        """
        method, first = self.method, self._first(self.missing)
        dual, least, largest = self._optimality(jacobian, slopes)
        over = np.where(self.layout.equal, np.abs(self.values), self.values).max(axis=0, initial=0.0)
        over = np.where(self.missing > 0, np.inf, over)
        good = (dual < method.dual_tolerance) & (largest < method.gap_tolerance) & (over < method.row_tolerance)
        hopeless = (
            first
            & (dual < method.hopeless_dual)
            & (self.barrier < method.hopeless_barrier)
            & (over > method.hopeless_ratio * self.barrier)
        )
        self._set(accepted & good & ~first, status=np.full(len(self), CONVERGED))
        self._set(accepted & hopeless, status=np.full(len(self), INFEASIBLE))
        # Along a flat and bent valley the last steps are tiny: what they could still gain is not worth them.
        tired = (self.evaluations >= method.max_evaluations) | (self.late >= method.max_late)
        self._set((self.status == 0) & tired, status=np.full(len(self), STOPPED))
        again = self._restore(accepted, first, over)
        for _ in range(method.barrier_cuts):
            error = np.maximum(dual, np.maximum(largest - self.barrier, self.barrier - least))
            smaller = np.minimum(method.barrier_factor * self.barrier, self.barrier * np.sqrt(self.barrier))
            lower = accepted & ~again & (error < method.barrier_error * self.barrier)
            self._set(lower, barrier=np.maximum(method.least_barrier, smaller))
        return again

    def _optimality(self, jacobian: np.ndarray, slopes: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Dual residual of the point, and the least and largest product of a distance and its multiplier."""
        layout = self.layout
        below, above = self._bound_distances(self.y)
        slack, excess, implied = split(self.values, self.barrier, self._prices())
        self._bring_in(implied, below, above)
        signed = self._signed(self.multipliers)
        weights = signed.copy()
        weights[layout.constraints :] += self._objective()
        residual = layout.transposed(jacobian, weights)
        residual += np.where(self.free, self.high_dual - self.low_dual, 0.0)
        pulled = self.t_free & ~self._first(self.missing)
        along_t = np.where(pulled, self.t_weight - (slopes * signed).sum(axis=0), 0.0)
        dual = np.maximum(np.abs(residual).max(axis=0, initial=0.0), np.abs(along_t))
        dual /= np.maximum(1.0, self.method.multiplier_share * np.abs(signed).max(axis=0, initial=0.0))
        products = np.concatenate(
            [
                self.multipliers * slack,
                (self._prices() - self.multipliers) * excess,
                np.where(self.free, self.low_dual * below, self.barrier),
                np.where(self.free, self.high_dual * above, self.barrier),
                self.barrier[None],
            ]
        )
        return dual, products.min(axis=0), products.max(axis=0)

    def _restore(self, accepted: np.ndarray, first: np.ndarray, over: np.ndarray) -> np.ndarray:
        """Put the objective aside where rows press against the penalty, until they are met; lanes that change."""
        method = self.method
        pressed = np.any(self.multipliers > method.pressed_share * self._prices(), axis=0)
        leaves = accepted & ~first & pressed & (self.barrier <= method.penalty_barrier)
        leaves &= over > method.unmet_ratio * self.barrier
        comes = accepted & self.restoring & (over <= method.met)
        again: np.ndarray = (leaves | comes) & (self.status == 0)
        if again.any():
            self._set(leaves, next_penalty=np.minimum(method.penalty_factor * self.penalty, method.last_penalty))
            self.restoring = (self.restoring | leaves) & ~comes
            self._begin(again)
        return again

    def _direct(
        self,
        accepted: np.ndarray,
        bent: np.ndarray,
        jacobian: np.ndarray,
        hessian: Sequence[np.ndarray],
        slopes: np.ndarray,
        values: np.ndarray,
    ) -> None:
        """Find the next step of lanes that have moved; correct that of lanes in ``bent``, halve that of the others.

        A first step that was refused is corrected by what the rows at the trial point differ from their linear
        forecast: rows that bend would otherwise keep steps small.
        """
        layout, n = self.layout, self.layout.n
        below, above = self._bound_distances(self.y)
        prices = self._prices()
        slack, excess, implied = split(self.values, self.barrier, prices)
        self._bring_in(implied, below, above)
        excess_duals = prices - self.multipliers
        both = self.multipliers * excess_duals
        stiffness = both / (slack * excess_duals + excess * self.multipliers)
        # Gradient of the merit function, and its curvature with the multipliers at hand.
        weights = self._signed(implied)
        along_t = self.t_weight - (slopes * weights).sum(axis=0)
        weights = weights.copy()
        weights[layout.constraints :] += self._objective()
        gradient = np.empty((n + 1, len(self)))
        gradient[:n] = layout.transposed(jacobian, weights) - self.barrier / below + self.barrier / above
        held = ~self.t_free | self._first(self.missing)
        gradient[n] = np.where(held, 0.0, along_t)
        right = gradient
        if bent.any():
            off = stiffness * (values - self.forecast)
            along_t = np.where(held, 0.0, -(slopes * off).sum(axis=0))
            right = np.where(bent, np.concatenate([layout.transposed(jacobian, off), along_t[None]]), gradient)
        matrix = layout.gram(jacobian, slopes, stiffness)
        shift = self._add_curvature(matrix, hessian)
        for a in range(n):
            matrix[a][a] = matrix[a][a] + self.low_dual[a] / below[a] + self.high_dual[a] / above[a]
        matrix[n][n] = matrix[n][n] + held
        direction = -solve_shifted(matrix, right, shift, accepted | bent, self.method)
        moved = layout.times(jacobian, slopes, direction)
        change = implied - self.multipliers + stiffness * moved
        low_change = self.barrier / below - self.low_dual * (1 + direction[:n] / below)
        high_change = self.barrier / above - self.high_dual * (1 - direction[:n] / above)
        # Each row is a rate of decrease.
        step = self._share(1 + (change - implied) * excess_duals / both, -direction[:n] / below, direction[:n] / above)
        dual_step = self._share(
            -change * excess_duals / both,
            change * self.multipliers / both,
            -low_change / self.low_dual,
            -high_change / self.high_dual,
        )
        merit = self._merit(self.y, self.t, self.form, self.values, self.missing)
        self._set(
            accepted,
            direction=direction,
            change=change,
            low_change=low_change,
            high_change=high_change,
            merit=merit,
            slope=(gradient * direction).sum(axis=0),
            dual_step=dual_step,
        )
        corrected = self.uncorrected + direction / np.where(self.step > 0, self.step, 1.0)
        self._set(~accepted, direction=np.where(bent, corrected, self.uncorrected))
        self._set(accepted, uncorrected=direction, forecast=self.values + step * moved)
        self.step = np.where(accepted, step, np.where(bent, self.step, self.method.backtracking * self.step))

    def _share(self, *rates: np.ndarray) -> np.ndarray:
        """Largest share of a step that keeps everything positive that decreases at these rates."""
        nearly = np.maximum(self.method.to_boundary, 1 - self.barrier)
        share: np.ndarray = nearly / np.maximum(nearly, np.concatenate(rates).max(axis=0, initial=0.0))
        return share

    def _add_curvature(self, matrix: list[list[np.ndarray]], hessian: Sequence[np.ndarray]) -> np.ndarray:
        """Add the second derivatives of the rows; return a first shift where there are none to be had."""
        total = np.zeros(len(self))
        for part in hessian:
            total = total + part
        strange = ~np.isfinite(total)
        for (a, b), part in zip(self.layout.hessian, hessian, strict=True):
            use = self.free[a] & self.free[b] & ~strange
            matrix[a][b] = matrix[a][b] + np.where(use, part, 0.0)
        return np.where(strange, self.method.unknown_shift, 0.0)

    def _stuck(self, refused: np.ndarray) -> np.ndarray:
        """End lanes where no step along their direction helps; return those that may go on with a smaller barrier."""
        stuck = refused & (self.rejected > self.method.max_rejected) & (self.status == 0)
        self._set(stuck & (self.barrier <= self.method.stuck_barrier), status=np.full(len(self), STUCK))
        again: np.ndarray = stuck & (self.status == 0)
        self._set(again, barrier=np.maximum(self.method.least_barrier, self.method.stuck_factor * self.barrier))
        return again

    def _restart(self, again: np.ndarray) -> None:
        """Make the point itself the next trial point, to be taken whatever its merit."""
        if again.any():
            zero = np.zeros(len(self))
            self._set(again, merit=zero + np.inf, step=zero, dual_step=zero, rejected=zero.astype(np.int64))
