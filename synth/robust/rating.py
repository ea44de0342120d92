"""How designs stand the scatter of their surroundings: worst limits and yield, proven where that is possible.

Of every limit the worst value over the range is wanted. Where intervals of derivatives show that the limit is monotone
in everything that scatters, it is the value at one corner, exactly. Elsewhere it is the worst of all corners and of a
scrambled Sobol sequence; intervals may still prove that the limit holds over the whole range.
"""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import product
from typing import Any

import casadi as ca
import numpy as np

from synth.feasibility import holds, utilisation
from synth.model.program import OP_SELECT, InputValue
from synth.proof.enclosure import Enclosed, Encloser, Slopes
from synth.proof.interval_arithmetic import ZERO, Pair
from synth.proof.tape import Tape
from synth.question.inputs import first_value, inputs_of_design
from synth.question.instance import Instance
from synth.question.request import Request
from synth.question.uncertainty import Uncertainty
from synth.results import Design
from synth.results.ratings import DesignRating, LimitRating
from synth.robust.uncertainty import Member, check_values, scattered
from synth.row_cells import cell_value
from synth.tuning import TUNING, RobustLimits

PROVEN, BOUNDED, SAMPLED = "proven", "bounded", "sampled"


class Rater:
    """Rates designs of one question.

    Parameters
    ----------
    request : Request
        The problem without limits over the range, its requirements, tables and the user's own limits count.
    asked : Uncertainty
        What scatters.
    settings : RobustLimits, optional

    Raises
    ------
    InputError
        When the problem has no such thing.
    """

    def __init__(self, request: Request, asked: Uncertainty, settings: RobustLimits = TUNING.robust) -> None:
        self.settings = settings
        self.instance = Instance(replace(request, parts={}, fix={}), restrict=False)
        self.model, self.asked = self.instance.model, asked
        d = self.model.declaration
        self.things = scattered(asked, d)
        check_values(self.things, d, self.instance.values.requirements)
        self.units = {x.name: x.unit for x in self.things}
        known = self.model.input_number
        moving = [(j, m, known[m.key]) for j, x in enumerate(self.things) for m in x.members if m.key in known]
        self.moving: list[tuple[int, Member, int]] = moving  # thing, member, number of the input
        self.limits = [x for x in self.instance.constraints if x.sense != "equal"]
        count = len(self.things)
        self.corners = np.array(list(product((0.0, 1.0), repeat=count)))
        self.samples = _sobol(count, asked.samples, asked.seed)
        program = self.model.program
        self._depends = program.dependence([k for _, _, k in self.moving])
        # What a limit depends on, per thing.
        marked = [program.dependence([k for i, _, k in self.moving if i == j]) for j in range(count)]
        self.matters = {x.name: [any(bool(m[k]) for k in x.nodes) for m in marked] for x in self.limits}

    # -- numbers -------------------------------------------------------------------------------

    def rate(
        self,
        designs: Sequence[Design],
        progress: Callable[[Mapping[str, Any]], None] | None = None,
        deadline: float = math.inf,
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
            reason = "interrupted"
        return done, reason

    def one(self, design: Design) -> DesignRating:
        """Return the rating of one design: see ``Design.robust``."""
        corners, samples = self.residuals(design, self.corners), self.residuals(design, self.samples)
        with np.errstate(all="ignore"):
            proofs = self._proofs(design)
        every = np.concatenate([self.corners, self.samples])
        worst: list[tuple[int, float]] = []
        for j in range(len(self.limits)):
            values = np.concatenate([corners[j], samples[j]])
            corner = proofs[j].corner
            row = int(np.argmax(values)) if corner is None else int(np.flatnonzero((self.corners == corner).all(1))[0])
            worst.append((row, float(values[row])))
        rows = [row for row, _ in worst]
        sides = self.sides(design, every[rows])
        told: dict[str, LimitRating] = {}
        for j, limit in enumerate(self.limits):
            row, r = worst[j]
            if r == -math.inf:
                continue  # void for these parts
            value, bound = float(sides[j][0][j]), float(sides[j][1][j])
            fine = bool(holds(r, limit.guard))
            proof = proofs[j].kind if fine or proofs[j].kind != BOUNDED else SAMPLED
            told[limit.name] = LimitRating(
                holds=fine,
                proof=proof,
                residual=_finite(r),
                value=_finite(value),
                limit=_finite(bound),
                utilisation=_finite(float(utilisation(value, bound, limit.sense))),
                at=self.at(design, every[row], limit.name),
                position=[float(p) for p in every[row]],
            )
        return self._summary(told, samples)

    def _summary(self, told: dict[str, LimitRating], samples: np.ndarray) -> DesignRating:
        fine = np.ones(samples.shape[1], dtype=bool)
        for x, own in zip(self.limits, samples, strict=True):
            fine &= holds(own, x.guard)
        hits, count = int(fine.sum()), samples.shape[1]
        holding = all(x["holds"] for x in told.values())
        proven = holding and all(x["proof"] != SAMPLED for x in told.values())
        low, high = (1.0, 1.0) if proven else _interval(hits, count, self.asked.confidence)
        name = max(told, key=lambda n: math.inf if told[n]["residual"] is None else told[n]["residual"], default="")
        return DesignRating(
            holds=holding,
            proof=PROVEN if proven or (not holding and told[name]["proof"] == PROVEN) else SAMPLED,
            share_good=hits / count,
            yield_low=low,
            yield_high=high,
            confidence=self.asked.confidence,
            samples=count,
            worst_limit=name,
            worst_utilisation=told[name]["utilisation"] if told else None,
            worst_residual=told[name]["residual"] if told else None,
            worst_at=told[name]["at"] if told else {},
            units=dict(self.units),
            limits=told,
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
        rows = []
        for x in self.limits:
            r, held = result.residuals[x.name], result.holds[x.name]
            rows.append(np.where(np.isnan(r), np.where(held, -np.inf, np.inf), r))
        return np.array(rows).reshape(len(self.limits), len(positions))

    def at(self, design: Design, position: np.ndarray, limit: str) -> dict[str, float]:
        """Return the values of what scatters at a position, in SI, as far as a limit depends on it."""
        return {
            x.name: float(self._moved(design, j, x.members[0], float(position[j])))
            for j, x in enumerate(self.things)
            if self.matters[limit][j]
        }

    def _moved(self, design: Design, j: int, member: Member, position: Any) -> Any:
        return self.things[j].moved(
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

    # -- proofs --------------------------------------------------------------------------------

    def _proofs(self, design: Design) -> list[_Proof]:
        """Return, per limit, what intervals prove of it."""
        whole = [(0.0, 1.0)] * len(self.things)
        found = self._enclosed(design, whole, range(len(self.limits)))
        proofs = [found[j].proof(len(self.things), self.settings.steep) for j in range(len(self.limits))]
        unproven = [j for j, proof in enumerate(proofs) if proof.kind == SAMPLED]
        for j in self._bounded(design, whole, unproven):
            proofs[j] = _Proof(BOUNDED)
        return proofs

    def _bounded(self, design: Design, whole: list[tuple[float, float]], limits: list[int]) -> list[int]:
        """Return those limits that intervals over parts of the range show to hold in all of them."""
        stack = [(whole, limits)]
        failed: set[int] = set()
        for _ in range(self.settings.parts):
            if not stack:
                break
            box, rest = stack.pop()
            rest = [j for j in rest if j not in failed]
            found = self._enclosed(design, box, rest)
            rest = [j for j in rest if not found[j].below()]
            if not rest:
                continue
            middle = [0.5 * (low + high) for low, high in box]
            r = self._residuals(design, np.array([middle]))[:, 0]
            failed.update(j for j in rest if not r[j] < 0.0)
            rest = [j for j in rest if j not in failed]
            steepest = [sum(found[j].reach(k) for j in rest) for k in range(len(box))]
            widths = [high - low for low, high in box]
            known = [s if math.isfinite(s) else math.inf for s in steepest]
            k = max(range(len(box)), key=lambda i: (known[i], widths[i]) if widths[i] > 0 else (-1.0, 0.0))
            if math.isinf(known[k]):
                k = max(range(len(box)), key=lambda i: widths[i])
            halves = ((box[k][0], middle[k]), (middle[k], box[k][1]))
            stack += [([*box[:k], half, *box[k + 1 :]], rest) for half in halves]
        left = {j for _, rest in stack for j in rest}
        return [j for j in limits if j not in failed and j not in left]

    def _enclosed(self, design: Design, box: Sequence[tuple[float, float]], limits: Sequence[int]) -> dict[int, _Sides]:
        """Return both sides of limits over a part of the range, with their slopes."""
        program = self.model.program
        inputs, reach = self._leaves(design, box)
        wanted = [n for j in limits for n in self.limits[j].nodes]
        encloser = Encloser(Tape(), program)
        found = encloser.run(program.nodes, program.needed(wanted), inputs)
        result = {}
        for j in limits:
            x = self.limits[j]
            sides = [found[n] if isinstance(n, int) else Enclosed.constant(float(n)) for n in (x.value, x.bound)]
            small, large = sides if x.sense == "at_most" else sides[::-1]
            result[j] = _Sides(encloser, small, large, self._smooth(x.nodes, found), reach)
        return result

    def _smooth(self, nodes: Sequence[int], found: Mapping[int, Enclosed]) -> bool:
        """Tell whether no choice that reaches these nodes is open: then nothing jumps over the range."""
        program = self.model.program
        for k in program.needed(nodes):
            node = program.nodes[k]
            if node.op in (OP_SELECT, ca.OP_IF_ELSE_ZERO) and self._depends[node.args[0]]:
                low, high = found[node.args[0]].range
                if not (low == high or low > 0 or high < 0):
                    return False
        return all(found[k].whole for k in nodes)

    def _leaves(self, design: Design, box: Sequence[tuple[float, float]]) -> tuple[list[Enclosed], list[float]]:
        """Return the inputs over a part of the range, and half the width of each coordinate."""
        model = self.model
        values = [*(float(design.values[v.name]) for v in model.variables), *self._data(design)]
        inputs = [Enclosed.constant(float(x)) for x in values]
        reach = [0.0] * len(self.things)
        for j, thing in enumerate(self.things):
            ends = [sorted(float(self._moved(design, j, m, p)) for p in box[j]) for m in thing.members]
            log = all(low > 0 for low, _ in ends)
            numbers = {m.key: k for i, m, k in self.moving if i == j}
            for member, (low, high) in zip(thing.members, ends, strict=True):
                middle = math.sqrt(low * high) if log else 0.5 * (low + high)
                half = 0.5 * (math.log(high / low) if log else high - low)
                if member == thing.members[0]:
                    reach[j] = half
                # Further members move in proportion to the first: by the same logarithm.
                own = 1.0 if log or not reach[j] else half / reach[j]
                sign = 1 if low > 0 else -1 if high < 0 else 0
                least = min(abs(low), abs(high)) if sign else 0.0
                pair = (low, high)
                if member.key in numbers:
                    inputs[numbers[member.key]] = Enclosed(
                        pair, (middle, middle), log, {j: (own, own)}, sign, pair, pair, least
                    )
        return inputs, reach


@dataclass(frozen=True)
class _Proof:
    """What intervals prove of a limit: ``proven`` (with its worst corner), ``bounded`` (it holds) or nothing."""

    kind: str
    corner: tuple[float, ...] | None = None


class _Sides:
    """Both sides of a limit ``small <= large`` over a box of the range."""

    def __init__(self, encloser: Encloser, small: Enclosed, large: Enclosed, smooth: bool, reach: list[float]) -> None:
        self.small, self.large, self.smooth, self._reach = small, large, smooth, reach
        self.log = small.sign > 0 and large.sign > 0
        own = encloser.logarithmic(small) if self.log else encloser.linear(small)
        its = encloser.logarithmic(large) if self.log else encloser.linear(large)
        self.slopes: Slopes = encloser.merged(own, its, encloser.subtract)

    def slope(self, k: int) -> Pair:
        """Return the range of the derivative of small over large (or small less large) with something that scatters."""
        return self.slopes.get(k, ZERO)

    def reach(self, k: int) -> float:
        """Return by how much one thing moves the limit."""
        return float(max(abs(self.slope(k)[0]), abs(self.slope(k)[1])) * self._reach[k])

    def proof(self, count: int, least: float) -> _Proof:
        """Return the worst corner where the limit is monotone in everything; slopes below ``least`` have no sign."""
        if not self.smooth:
            return _Proof(SAMPLED)
        corner = []
        for k in range(count):
            low, high = (float(x) for x in self.slope(k))
            steep = least * max(1.0, abs(low), abs(high)) if math.isfinite(low + high) else least
            if low >= -steep:
                corner.append(1.0)
            elif high <= steep:
                corner.append(0.0)
            else:
                return _Proof(SAMPLED)
        return _Proof(PROVEN, tuple(corner))

    def below(self) -> bool:
        """Tell whether the limit holds everywhere in the box."""
        most, least = self.small.range[1], self.large.range[0]
        if bool(most < least):
            return True
        reach = sum(self.reach(k) for k in self.slopes)
        top, bottom = self.small.center[1], self.large.center[0]
        if self.log:
            return bool(top > 0 and bottom > 0 and math.log(top) - math.log(bottom) + reach < 0.0)
        return bool(top - bottom + reach < 0.0)


def _sobol(dimensions: int, count: int, seed: int) -> np.ndarray:
    """Return points of a scrambled Sobol sequence."""
    from scipy.stats import qmc  # costly to import

    points: np.ndarray = qmc.Sobol(dimensions, scramble=True, rng=np.random.default_rng(seed)).random(count)
    return points


def _interval(hits: int, count: int, confidence: float) -> tuple[float, float]:
    """Return the Clopper-Pearson interval of a share.

    C. J. Clopper, E. S. Pearson: The use of confidence or fiducial limits illustrated in the case of the binomial.
    Biometrika 26 (1934) 404-413.
    """
    from scipy.stats import binomtest  # costly to import

    found = binomtest(hits, count).proportion_ci(confidence_level=confidence, method="exact")
    return float(found.low), float(found.high)


def _finite(value: float) -> float | None:
    return value if math.isfinite(value) else None
