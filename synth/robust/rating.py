"""How designs stand the scatter of their surroundings: worst limits and yield, proven where that is possible.

Of every limit the worst value over the range is wanted. Where intervals of derivatives show that the limit is monotone
in everything that scatters, it is the value at one corner, exactly. Elsewhere it is the worst point that an ascent from
corners and samples finds; that the limit holds counts as shown only where intervals prove it over the whole range.
"""

from __future__ import annotations

import math
import time
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import partial
from itertools import product
from typing import Any

import numpy as np

from synth.model.constraint import Constraint
from synth.model.model import Evaluation
from synth.model.program import InputValue
from synth.order.feasibility import SMALLEST, TOLERANCE, holds, most_used, utilisation
from synth.order.feasibility import residual as limit_residual
from synth.question.inputs import first_value, inputs_of_design
from synth.question.instance import Instance
from synth.question.request import Request
from synth.question.settings import Progress
from synth.question.uncertainty import Uncertainty
from synth.results import Design
from synth.results.ratings import SAMPLED, DesignRating, LimitRating
from synth.robust.limit_bounds import LimitBounds, MonotoneLimit, MovingInput
from synth.robust.settings import ROBUST, RobustLimits
from synth.robust.uncertainty import Member, check_values, scattered
from synth.robust.worst_points import stretched, worst_point
from synth.system.deadline import INTERRUPTED
from synth.text.row_cells import cell_value

PROVEN, BOUNDED = "proven", "bounded"


class Rater:
    """Rates designs of one question.

    Parameters
    ----------
    request : Request
        The problem without limits over the range, its requirements, tables and the user's own limits count.
    uncertainty : Uncertainty
        What scatters.
    settings : RobustLimits, optional

    Raises
    ------
    InputError
        When the problem has no such thing.
    """

    def __init__(self, request: Request, uncertainty: Uncertainty, settings: RobustLimits = ROBUST) -> None:
        self.settings = settings
        self.instance = Instance(replace(request, parts={}, fix={}), restrict=False)
        self.model, self.uncertainty = self.instance.model, uncertainty
        d = self.model.declaration
        self.quantities = scattered(uncertainty, d)
        check_values(self.quantities, d, self.instance.values.requirements)
        self.units = {x.name: x.unit for x in self.quantities}
        known = self.model.input_number
        moving = [(j, m, known[m.key]) for j, x in enumerate(self.quantities) for m in x.members if m.key in known]
        self.moving: list[tuple[int, Member, int]] = moving  # thing, member, number of the input
        self.limits = [x for x in self.instance.constraints if x.sense != "equal"]
        count = len(self.quantities)
        self.corners = np.array(list(product((0.0, 1.0), repeat=count)))
        self.samples = _sobol(count, uncertainty.samples, uncertainty.seed)
        program = self.model.program
        # What a limit depends on, per thing.
        marked = [program.dependence([k for i, _, k in self.moving if i == j]) for j in range(count)]
        self.matters = {x.name: [any(bool(m[k]) for k in x.nodes) for m in marked] for x in self.limits}

    # -- numbers -------------------------------------------------------------------------------

    def rate(
        self, designs: Sequence[Design], progress: Progress | None = None, deadline: float = math.inf
    ) -> tuple[list[DesignRating], str]:
        """Return the rating of each design, and what stopped the work before the last one.

        Parameters
        ----------
        designs : list of Design
        progress : callable, optional
            Called with a mapping: stage, done, incumbents, message.
        deadline : float
            As of ``time.monotonic``.

        Returns
        -------
        tuple
            The ratings (see ``Design.robust``) of the first designs, and "time limit", "interrupted" or nothing.
        """
        done: list[DesignRating] = []
        reason = ""
        try:
            for k, design in enumerate(designs):
                if progress is not None:
                    progress({"stage": "rating", "done": k / len(designs), "incumbents": len(designs)})
                if time.monotonic() > deadline:
                    reason = "time limit"
                    break
                done.append(self.one(design))
        except KeyboardInterrupt:
            reason = INTERRUPTED
        return done, reason

    def one(self, design: Design) -> DesignRating:
        """Rating of one design: see ``Design.robust``."""
        corners, samples = self.residuals(design, self.corners), self.residuals(design, self.samples)
        with np.errstate(all="ignore"):
            worst = self._worst_points(design, np.concatenate([corners, samples], axis=1))
        sides = self.sides(design, np.array([w.position for w in worst]).reshape(-1, len(self.quantities)))
        limit_ratings: dict[str, LimitRating] = {}
        for j, (limit, w) in enumerate(zip(self.limits, worst, strict=True)):
            if w.residual == -math.inf:
                continue
            value, bound = float(sides[j][0][j]), float(sides[j][1][j])
            limit_ratings[limit.name] = LimitRating(
                holds=w.holds,
                proof=w.proof,
                residual=_finite(w.residual),
                value=_finite(value),
                limit=_finite(bound),
                utilisation=_finite(float(utilisation(value, bound, limit.sense))),
                at=self.at(design, w.position, limit.name),
                position=[float(p) for p in w.position],
            )
        return self._summary(limit_ratings, samples)

    def _summary(self, limit_ratings: dict[str, LimitRating], samples: np.ndarray) -> DesignRating:
        fine = np.ones(samples.shape[1], dtype=bool)
        for x, residual in zip(self.limits, samples, strict=True):
            fine &= holds(residual, x.guard)
        hits, count = int(fine.sum()), samples.shape[1]
        verdicts = [x["holds"] for x in limit_ratings.values()]
        holding = False if False in verdicts else None if None in verdicts else True
        low, high = (1.0, 1.0) if holding else _interval(hits, count, self.uncertainty.confidence)
        share = hits / count if holding or hits < count else low  # samples alone never show a yield of 1
        if holding is False:
            high = min(high, math.nextafter(1.0, 0.0))
        # What decides comes first: limits that fail, then those that are not shown to hold.
        leading = {name: x["utilisation"] for name, x in limit_ratings.items() if x["holds"] is holding}
        # What has no share to tell is past all bounds, or cannot be computed.
        shares = {n: math.inf if used is None else used for n, used in leading.items()}
        name = next(iter(most_used(shares)), "")
        # Of limits that are used alike one that what scatters moves tells more, such as the torque beside a count.
        alike = (n for n, used in shares.items() if used >= (1 - TOLERANCE) * shares[name] and limit_ratings[n]["at"])
        name = next(alike, name)
        proven = holding or (holding is False and limit_ratings[name]["proof"] == PROVEN)
        return DesignRating(
            holds=holding,
            proof=PROVEN if proven else SAMPLED,
            share_good=share,
            yield_low=low,
            yield_high=high,
            confidence=self.uncertainty.confidence,
            samples=count,
            worst_limit=name,
            worst_utilisation=limit_ratings[name]["utilisation"] if limit_ratings else None,
            worst_residual=limit_ratings[name]["residual"] if limit_ratings else None,
            worst_at=limit_ratings[name]["at"] if limit_ratings else {},
            units=dict(self.units),
            limits=limit_ratings,
        )

    def sides(self, design: Design, positions: np.ndarray) -> list[tuple[np.ndarray, np.ndarray]]:
        """Return both sides of every limit at positions of the range."""
        result = self.instance.evaluate(*self._inputs(design, positions))
        return [result.limits[x.name] for x in self.limits]

    def residuals(self, design: Design, positions: np.ndarray) -> np.ndarray:
        """Return residuals (limits, positions): infinite where not met at all, minus infinite where void."""
        at_once = self.settings.points
        return np.concatenate(
            [self._residuals(design, positions[k : k + at_once]) for k in range(0, len(positions), at_once)], axis=1
        )

    def _residuals(self, design: Design, positions: np.ndarray) -> np.ndarray:
        result = self.instance.evaluate(*self._inputs(design, positions))
        rows = [_residual_of(result, x) for x in self.limits]
        return np.array(rows).reshape(len(self.limits), len(positions))

    def at(self, design: Design, position: np.ndarray, limit: str) -> dict[str, float]:
        """Return the values of what scatters at a position, in SI, as far as a limit depends on it."""
        return {
            x.name: float(self._moved(design, j, x.members[0], float(position[j])))
            for j, x in enumerate(self.quantities)
            if self.matters[limit][j]
        }

    def _moved(self, design: Design, j: int, member: Member, position: float | np.ndarray) -> Any:
        return self.quantities[j].moved(
            member, lambda m: self._nominal(design, m), position, lambda s, c: self._cell(design, s, c)
        )

    def _nominal(self, design: Design, member: Member) -> float:
        if member.kind == "requirement":
            return self.instance.values.requirements[member.name]
        if member.kind == "variable":
            return float(design.values[member.name])
        return self._cell(design, member.name, member.column)

    @staticmethod
    def _cell(design: Design, slot: str, column: str) -> float:
        return cell_value(design.parts[slot], column)

    def _cells(self, design: Design, slot: str, column: str) -> np.ndarray:
        return np.array([self._cell(design, slot, column)])

    def _inputs(self, design: Design, positions: np.ndarray) -> tuple[np.ndarray, list[InputValue]]:
        model = self.model
        variables = np.tile([float(design.values[v.name]) for v in model.variables], (len(positions), 1))
        data: list[InputValue] = [*self._data(design)]
        for j, member, k in self.moving:
            moved = self._moved(design, j, member, positions[:, j])
            if k < len(model.variables):
                variables[:, k] = moved
            else:
                data[k - len(model.variables)] = np.broadcast_to(np.asarray(moved, dtype=float), (len(positions),))
        return variables, data

    def _data(self, design: Design) -> list[float]:
        instance = self.instance
        return inputs_of_design(
            self.model,
            instance.values.requirements,
            instance.values.rows,
            design.values,
            design.choices,
            lambda entry: float(first_value([self._cells(design, entry.name, c) for c in entry.columns])[0]),
        )

    # -- worst points --------------------------------------------------------------------------

    def _worst_points(self, design: Design, residuals: np.ndarray) -> list[_Worst]:
        """Worst point of every limit, and its verdict over the whole range.

        Parameters
        ----------
        design : Design
        residuals : array (limits, points)
            At the corners and the samples.
        """
        moving = [MovingInput(j, k, partial(self._moved, design, j, m)) for j, m, k in self.moving]
        values = [*(float(design.values[v.name]) for v in self.model.variables), *self._data(design)]
        bounds = LimitBounds(self.model.program, values, moving, len(self.quantities), self.matters, self.settings)
        at_corners = self.sides(design, self.corners)
        worst: list[_Worst] = []
        for j, monotone in enumerate(bounds.monotone(self.limits)):
            limit, sampled = self.limits[j], residuals[j]
            if sampled.max() == -math.inf:
                worst.append(_Worst(self.corners[0], -math.inf, PROVEN, True))  # void for these parts
                continue
            if monotone.complete:
                row = int(np.flatnonzero((self.corners == monotone.worst).all(1))[0])
                fails = not holds(sampled[row], limit.guard)
                value, bound = (float(side[row]) for side in at_corners[j])
                proven = fails or (
                    bool(np.all(holds(sampled, limit.guard))) and monotone.holds_everywhere(limit, value, bound)
                )
                if proven:
                    worst.append(_Worst(self.corners[row], float(sampled[row]), PROVEN, not fails))
                    continue
            worst.append(self._searched(design, j, sampled, bounds, monotone))
        return worst

    def _searched(
        self, design: Design, j: int, sampled: np.ndarray, bounds: LimitBounds, monotone: MonotoneLimit
    ) -> _Worst:
        """Worst point found of a limit not shown to be monotone, and whether bounds show that it holds."""
        limit = self.limits[j]

        def residual(positions: np.ndarray) -> np.ndarray:
            return np.asarray(self.residuals(design, positions)[j])

        def used(positions: np.ndarray) -> np.ndarray:
            result = self.instance.evaluate(*self._inputs(design, positions))
            raw, share = _residual_of(result, limit), limit_residual(*result.limits[limit.name], limit.sense, SMALLEST)
            return np.where(np.isfinite(raw) & ~np.isnan(share), share, raw)

        points = np.concatenate([self.corners, self.samples])
        row = int(np.argmax(sampled))
        free = np.flatnonzero(np.isnan(monotone.worst))
        starts = np.concatenate([points, stretched(self.samples)])
        starts = np.where(np.isnan(monotone.worst), starts, monotone.worst)
        place, r = worst_point(residual, starts, free, self.settings.ascent)
        if sampled[row] > r:
            place, r = points[row], float(sampled[row])
        if not holds(r, limit.guard):
            return _Worst(place, r, SAMPLED, False)
        outcome = bounds.search(limit, monotone, residual)
        if outcome.violated is not None:
            place, r = worst_point(residual, outcome.violated[None, :], free, self.settings.ascent)
            return _Worst(place, r, SAMPLED, False)
        if limit.terms is not None:
            # It holds as far as is known: people read where most of it is used, whatever the size of its terms is.
            place, _ = worst_point(used, starts, free, self.settings.ascent)
            r = float(residual(place[None, :])[0])
            if not holds(r, limit.guard):
                return _Worst(place, r, SAMPLED, False)
        return _Worst(place, r, BOUNDED, True) if outcome.proven else _Worst(place, r, SAMPLED, None)


@dataclass(frozen=True)
class _Worst:
    """Worst point of a limit: its position, residual, what is known of the rest, and whether the limit holds."""

    position: np.ndarray
    residual: float
    proof: str
    holds: bool | None  # None: neither shown nor refuted


def _residual_of(result: Evaluation, limit: Constraint) -> np.ndarray:
    """Residual of a limit: infinite where it is not met at all, minus infinite where void."""
    r = result.residuals[limit.name]
    return np.where(np.isnan(r), np.where(result.holds[limit.name], -np.inf, np.inf), r)


def _sobol(dimensions: int, count: int, seed: int) -> np.ndarray:
    """Return points of a scrambled Sobol sequence."""
    from scipy.stats import qmc  # costly to import

    points: np.ndarray = qmc.Sobol(dimensions, scramble=True, rng=np.random.default_rng(seed)).random(count)
    return points


def _interval(hits: int, count: int, confidence: float) -> tuple[float, float]:
    """Clopper-Pearson interval of a share.

    C. J. Clopper, E. S. Pearson: The use of confidence or fiducial limits illustrated in the case of the binomial.
    Biometrika 26 (1934) 404-413.
    """
    from scipy.stats import binomtest  # costly to import

    interval = binomtest(hits, count).proportion_ci(confidence_level=confidence, method="exact")
    return float(interval.low), float(interval.high)


def _finite(value: float) -> float | None:
    return value if math.isfinite(value) else None
