"""Why nothing is feasible, over the whole catalogue, and what would make it so."""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import casadi as ca
import numpy as np

from synth.analysis.designs import make_design, make_frame, part_row
from synth.analysis.evaluate import evaluate
from synth.analysis.fired_guards import FiredGuard, columns_of, fired_guards, requirements_of
from synth.bounds.structure import classify
from synth.deadline import Stopped, until
from synth.declaration import Origin
from synth.errors import InputError, RefusedError
from synth.files import frame_csv
from synth.model.constraint import SIGNS, Constraint
from synth.model.problem import DesignProblem
from synth.output_folder import EXPLANATION, save_result
from synth.question.instance import Instance
from synth.question.ranges import declared_ranges
from synth.question.request import Request
from synth.question.settings import Progress, SearchSettings, check_progress
from synth.question.spec_patch import patched
from synth.results import Design
from synth.robust.counterpart import nominal, robust_counterpart
from synth.search.question import one_best
from synth.special import expanded
from synth.studies.infeasibility.relaxation import AMOUNT, COLUMN, LIMIT, REQUIREMENT, Relaxed
from synth.study_limits import WAYS_OUT, WayOutLimits
from synth.units import Quantity, format_quantity, from_si, outward, parse_unit

if TYPE_CHECKING:
    import pandas as pd

    from synth.model.model import Model

PIN, CHOICE = "pin", "choice"


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
        return _rounded(self.needed, self.unit, self.sense)

    def applied(self, spec: Mapping[str, Any]) -> dict[str, Any]:
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
            always = f" (beside {', '.join(self.guards)}, which always count)" if self.guards else ""
            names = ", ".join(self.conflict) + always
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

    def save(self, folder: str | Path) -> list[Path]:
        """Write explanation.csv and explanation.json; return the files.

        What was stopped replaces no earlier result: it is written to a folder ``stopped`` beside that.
        """
        import json

        told = {
            "feasible": self.feasible,
            "message": self.message,
            "refused": [
                {
                    "name": g.name,
                    "message": g.message,
                    "requirement": g.requirement,
                    "part": g.part,
                    "missed_by": _number(g.missed_by),
                    "lifted_by": dict(g.lifted_by),
                    "sentence": g.sentence,
                }
                for g in self.fired
            ],
            "conflict": list(self.conflict),
            "minimal": self.minimal,
            "guards": list(self.guards),
            "ways": [
                {
                    "kind": w.kind,
                    "name": w.name,
                    "change": _number(w.amount),
                    "proven": w.proven,
                    "sentence": w.sentence,
                    "patch": w.patch,
                }
                for w in self.ways
            ],
            "not_settled": self.not_settled,
            "interrupted": self.interrupted,
        }
        files = {
            "explanation.csv": frame_csv(self.to_frame()),
            "explanation.json": json.dumps(told, indent=2, ensure_ascii=False, allow_nan=False) + "\n",
        }
        target = save_result(folder, files, EXPLANATION, bool(self.interrupted))
        return [target / name for name in files]


def explain(
    p: str | type[DesignProblem] | DesignProblem,
    requirements: Mapping[str, Any],
    catalogs: Any = None,
    parts: Mapping[str, Any] | None = None,
    limits: Mapping[str, Any] | None = None,
    fix: Mapping[str, Any] | None = None,
    grid: bool = True,
    seed: int = 0,
    progress: Callable[[Mapping[str, Any]], None] | None = None,
    time_limit: float | None = None,
    robust: Mapping[str, Any] | None = None,
    physics: bool = False,
) -> Explanation:
    """Tell why nothing is feasible, over all combinations of parts and counts, and what would make it so.

    Parameters
    ----------
    p, requirements, catalogs, parts, limits, fix, grid, seed, robust
        As for ``synthesize``.
    progress : callable, optional
        Called with a mapping: stage, done (0..1), message.
    time_limit : float, optional
        Seconds; what was found until then is returned.
    physics : bool
        Whether limits of the family may give way as well: alone, and all together with the user's own.

    Returns
    -------
    Explanation

    Raises
    ------
    InputError
        For everything that is wrong with the input, in one sentence.
    """
    begin = time.monotonic()
    settings = SearchSettings(points=1, gap=WAYS_OUT.gap, seed=seed, time_limit=time_limit)
    check_progress(progress)
    request = Request.of(p, requirements, catalogs, robust, parts=parts, limits=limits, fix=fix, grid=grid)
    return explanation_of(request, settings.since(begin), progress, physics)


def explanation_of(
    request: Request, settings: SearchSettings, progress: Progress | None = None, physics: bool = False
) -> Explanation:
    """Tell why nothing is feasible; of the settings the seed and the time limit count.

    Raises
    ------
    InputError
        For everything that is wrong with the request, in one sentence.
    """
    begin = time.monotonic()
    asking = _Explaining(request, settings, progress)
    result = Explanation(guards=tuple(asking.guards))
    try:
        with until(asking.deadline):
            _explain(asking, result, physics)
    except Stopped as stop:
        result.interrupted = stop.reason
    except KeyboardInterrupt:
        result.interrupted = "interrupted"
    result.single.sort(key=lambda w: w.amount)
    result.parts.sort(key=lambda w: w.amount)
    result.seconds = time.monotonic() - begin
    return result


def _explain(asking: _Explaining, result: Explanation, physics: bool) -> None:
    asking.say("guards", 0.0, "what is refused outright")
    result.fired = fired_guards(asking.instance)
    if not result.fired:
        asking.say("limits", 0.02, "all limits together")
        widest = asking.ask({(LIMIT, name): asking.sign(name) for name in asking.giving})
        if widest.design is not None and widest.amount <= asking.ways.nothing:
            result.feasible = True
            return
        asking.say("conflict", 0.1, "which limits exclude each other")
        result.conflict, result.minimal = asking.conflict(widest.design)
        if physics and widest.design is not None:
            result.physics = asking.widened(widest)
    tasks = asking.tasks(result.fired, result.conflict, physics)
    for k, (kind, name, sign) in enumerate(tasks):
        direction = {0.0: "", 1.0: " up", -1.0: " down"}[sign]
        asking.say("ways out", 0.2 + 0.7 * k / len(tasks), f"{kind} {name}{direction}")
        way = asking.single(kind, name, sign)
        if isinstance(way, Relaxation):
            place = {COLUMN: result.parts, CHOICE: result.choices}.get(kind, result.single)
            place.append(way)
        elif way is not None:
            result.not_settled.append(way)
    asking.say("joint", 0.9, "all that was asked together")
    result.joint = asking.together(result.single, result.conflict)


@dataclass(frozen=True)
class _LeastAmount:
    """The design that needs the least amount; ``closed`` where nothing less does, or surely none is."""

    design: Design | None
    closed: bool

    @property
    def amount(self) -> float:
        return math.inf if self.design is None else self.design.values[AMOUNT]


@dataclass(frozen=True)
class _Pin:
    """What was asked to have a value, or of a count one of some values: its ends in SI, and where that stands."""

    name: str
    key: str
    low: float
    high: float
    unit: str

    def ends(self, model: Model) -> list[tuple[Constraint, float]]:
        """Return the limits that take its place where it gives way, each with the way that it gives way."""
        return [
            (model.constraint_on(self.name, sense, bound, f"{self.key}: {self.name} {SIGNS[sense]}"), sign)
            for sense, bound, sign in (("at_most", self.high, 1.0), ("at_least", self.low, -1.0))
        ]


@dataclass(frozen=True)
class _Change:
    """One of several things that give way together: what people call it, its values there, and what was asked."""

    kind: str
    name: str
    shown: str
    texts: tuple[str, ...]  # the first is nearest, each other one further on the side where it does
    given: str


class _Explaining:
    """The request that is explained, and its relaxed form."""

    def __init__(
        self,
        request: Request,
        settings: SearchSettings,
        progress: Progress | None,
        ways: WayOutLimits = WAYS_OUT,
    ) -> None:
        self.request, self.progress, self.ways = request, progress, ways
        self.settings = replace(settings, points=1, gap=ways.gap, workers=1)
        self.deadline = math.inf if settings.time_limit is None else time.monotonic() + settings.time_limit
        self.catalogs = request.catalogs
        whole = robust_counterpart(request.problem, request.robust, request.limits)
        asked = replace(request, problem=whole)
        self.instance = Instance(asked, refuse=False)
        model, d = self.instance.model, self.instance.model.declaration
        self.names = d.names()
        variables = {v.name for v in model.variables}
        # What is asked of counts bounds them here as well; limits on variables may give way.
        limits = self.instance.limits
        self.own = [*limits.judging, *(x for x in limits.bounding if x.quantity in variables)]
        self.bounded = {name: asked for name, asked in limits.asked.items() if name in d.counts}
        kept = model.by_name(request.fix, "fix", list(self.names.values()), "a name")
        self.fix = {name: value for name, value in kept.items() if name not in d.derived}
        self.parts = model.by_name(request.parts, "parts", list(d.slots), "a slot")
        self.pins = self._pins(kept)
        self.constraints = (*model.constraints, *self.own)
        self.limits = [x.name for x in self.constraints]
        self.senses = {x.name: x.sense for x in self.constraints}
        self.units = {x.name: x.unit for x in self.constraints}
        self.guards = [x.name for x in model.constraints if x.guard]
        # A guard, an equality and a limit of zero do not give way.
        firm = {x.name for x in model.limits if x.guard or x.sense == "equal" or x.limit.is_zero()}
        firm |= {x.name for x in self.own if x.sense == "equal" or x.bound == 0}
        self.giving = [name for name in self.limits if name not in firm]
        slots = d.slots.values()
        self.columns = {f"{part.slot}.{key}": part for part in slots for key in part.columns}
        self.given = {
            name: Quantity(value, d.requirements[name].unit)
            for name, value in self.instance.values.requirements.items()
            if name in self.instance.values.given
        }
        if not fired_guards(self.instance):
            # What is refused only because several refusals leave out all rows between them.
            Instance(asked)

    def _pins(self, fix: Mapping[str, Any]) -> dict[str, _Pin]:
        """Return what is pinned to a number, and the counts of which comparisons leave some values."""
        model, found = self.instance.model, dict[str, _Pin]()
        for k, variable in enumerate(model.variables):
            if variable.name in fix:
                value = float(self.instance.ranges.lower[k])
                found[variable.name] = _Pin(variable.name, "fix", value, value, variable.unit)
        # A set of values is kept as it is: between them lies nothing that would be nearer.
        sets = {name for name, _ in self.instance.limits.count_sets}
        for name, left in self.instance.selection.counts.items():
            if name not in sets and len(left) < len(model.declaration.counts[name].values):
                found[name] = _Pin(name, "fix" if name in fix else "limits", float(left[0]), float(left[-1]), "-")
        return found

    def say(self, stage: str, done: float, message: str) -> None:
        """Show progress, and stop where time is over."""
        if time.monotonic() > self.deadline:
            raise Stopped("time limit")
        if self.progress is not None:
            self.progress({"stage": stage, "done": done, "message": message})

    def sign(self, limit: str) -> float:
        """Return which way a limit gives way."""
        return -1.0 if self.senses[limit] == "at_least" else 1.0

    def ask(
        self,
        give: Mapping[tuple[str, str], float],
        kept: Sequence[str] | None = None,
        most: float | None = None,
        pins: Sequence[_Pin] = (),
        free: Collection[str] = (),
        rooms: Mapping[str, float] | None = None,
    ) -> _LeastAmount:
        """Return the design that needs the least amount, of all that keep the limits.

        ``pins`` give way as well; what is ``free`` (slots, choices) may be anything that the family offers.
        """
        left = self.deadline - time.monotonic()
        if left <= 0:
            raise Stopped("time limit")
        ends = [end for pin in pins for end in pin.ends(self.instance.model)]
        give = {**give, **{(LIMIT, x.name): sign for x, sign in ends if x.bound}}
        limits = [*(self.limits if kept is None else kept), *(x.name for x, _ in ends)]
        relaxed = Relaxed(
            self.instance, [*self.own, *(x for x, _ in ends)], give, limits, rooms, free, self.ways.farthest
        )
        loose = {*free, *(pin.name for pin in pins)}
        fix: dict[str, Any] = {name: value for name, value in self.fix.items() if name not in loose}
        bounds: dict[str, Any] = {name: value for name, value in self.bounded.items() if name not in loose}
        # Where nothing gives way any design will do.
        fix |= {} if give else {AMOUNT: 0.0}
        bounds |= {AMOUNT: f"<= {most!r}"} if most is not None and most < self.ways.farthest else {}
        parts = {name: rule for name, rule in self.parts.items() if name not in loose}
        try:
            instance = Instance(
                replace(self.request, problem=relaxed, requirements=self.given, parts=parts, limits=bounds, fix=fix)
            )
        except RefusedError:
            return _LeastAmount(None, True)
        front = one_best(instance, AMOUNT, self.settings.within(None if left == math.inf else left), self.ways.boxes)
        if front.interrupted:
            raise Stopped(front.interrupted)
        return _LeastAmount(front.designs[0] if front.designs else None, front.certificate.kind == "global")

    # -- what may give way -----------------------------------------------------------------------

    def tasks(
        self, fired: Sequence[FiredGuard], conflict: Sequence[str], physics: bool
    ) -> list[tuple[str, str, float]]:
        """Return what is tried alone: kind, name, and upwards or downwards."""
        both = (1.0, -1.0)
        if fired:
            moving = dict.fromkeys(name for guard in fired for name in requirements_of(self.instance, guard.name))
            columns = dict.fromkeys(name for guard in fired for name in columns_of(self.instance, guard.name))
            requirements = [name for name in moving if self.instance.values.requirements[name] > 0]
        else:
            bound = [*conflict, *self.guards]
            requirements, columns = self.moving(REQUIREMENT, bound), dict.fromkeys(self.moving(COLUMN, bound))
        own = {x.name for x in self.own}
        found = [(LIMIT, x, self.sign(x)) for x in conflict if x in self.giving and x in own]
        if physics:
            # Where a limit is a requirement, the requirement is what a user can change.
            family = [x for x in conflict if x in self.giving and x not in own and not self.is_requirement(x)]
            found += [(LIMIT, x, self.sign(x)) for x in family]
        found += [(PIN, name, 0.0) for name in self.pins]
        found += [(REQUIREMENT, name, sign) for name in requirements for sign in both]
        found += [(CHOICE, name, 0.0) for name in self._words()]
        found += [(COLUMN, name, sign) for name in columns for sign in both]
        return found

    def _words(self) -> list[str]:
        """Return the slots and choices for which the user asked something."""
        d = self.instance.model.declaration
        return [name for name in {**self.fix, **self.parts} if name in d.slots or name in d.choices]

    def moving(self, kind: str, limits: Sequence[str]) -> list[str]:
        """Return the requirements or part columns (``slot.column``) on which some of the limits depend."""
        model = self.instance.model
        kinds = {REQUIREMENT: "requirement", COLUMN: "part"}
        sides = {x.name: x.nodes for x in self.constraints}
        nodes = [k for x in limits for k in sides[x]]
        names, values = [], self.instance.values.requirements
        for k, entry in enumerate(model.data_inputs):
            if entry.kind != kinds[kind] or (kind == REQUIREMENT and not values[entry.name] > 0):
                continue
            marked = model.program.dependence(self._followers(k))
            if any(marked[node] for node in nodes):
                names.append(entry.name if kind == REQUIREMENT else entry.label)
        return names

    def _followers(self, position: int) -> list[int]:
        """Return the inputs of the program that move with a data input: itself, and defaults that are made of it."""
        model = self.instance.model
        entry, first = model.data_inputs[position], len(model.variables)
        found = [first + position]
        for j, other in enumerate(model.data_inputs if entry.kind == "requirement" else ()):
            default = model.declaration.requirements[other.name].default if other.kind == "requirement" else None
            if other.name not in self.instance.values.given and isinstance(default, ca.SX):
                used = {str(s) for s in ca.symvar(expanded(default, model.calls))}
                found += [first + j] if str(entry.sx) in used else []
        return found

    def is_requirement(self, limit: str) -> bool:
        """Tell whether the limit side of a limit is a requirement, and nothing else."""
        return bool(self._requirement_of(limit))

    def _requirement_of(self, limit: str) -> str:
        d, records = self.instance.model.declaration, {x.name: x for x in self.instance.model.limits}
        symbols = {str(r.sx): r.name for r in d.requirements.values() if r.sx is not None}
        if limit not in records or not records[limit].limit.is_symbolic():
            return ""
        return symbols.get(str(records[limit].limit), "")

    # -- which limits exclude each other ---------------------------------------------------------

    def conflict(self, nearest: Design | None) -> tuple[tuple[str, ...], bool]:
        """Return a minimal set of limits that cannot hold together, and whether it is proven to be minimal.

        Limits are added until no design keeps them, those first that the nearest design is stopped by; then each is
        left out in turn, and stays out where the others still exclude each other.
        """
        near = [] if nearest is None else self._tightest(self._as_asked(nearest))
        kept = [x for x in near if x in self.limits][: self.ways.first]
        while True:
            found = self.ask({}, kept)
            if found.design is None:
                break
            broken = [x for x in self._broken(found.design) if x not in kept]
            if not broken:
                return tuple(kept), False
            kept += broken
        proven = found.closed
        for k, name in enumerate(list(kept)):
            self.say("conflict", 0.1 + 0.1 * k / len(kept), f"without {name}")
            found = self.ask({}, [x for x in kept if x != name])
            if found.design is None and found.closed:
                kept.remove(name)
            proven &= found.design is not None or found.closed
        return tuple(x for x in self.limits if x in kept), proven

    @staticmethod
    def _tightest(design: Design) -> list[str]:
        used = {name: x for name, x in design.utilisation.items() if x is not None}
        return sorted(used, key=lambda name: -used[name])

    def _broken(self, found: Design) -> list[str]:
        """Return the limits that a design of the relaxed question breaks, the worst first."""
        design = self._as_asked(found)
        missed = {name: r for name, r in design.residuals.items() if name in design.violated}
        return sorted(missed, key=lambda name: -missed[name])[: self.ways.first]

    # -- ways out ------------------------------------------------------------------------------------

    def widened(self, found: _LeastAmount) -> Relaxation:
        """Return the relaxation of all limits by the same fraction."""
        assert found.design is not None
        design, amount = self._as_asked(found.design), math.expm1(found.amount)
        sentence = f"all limits wider by {_percent(amount)}; that concerns {', '.join(design.violated) or 'none'}"
        return Relaxation("physics", "all limits", "", math.nan, math.nan, "-", amount, design, found.closed, sentence)

    def single(self, kind: str, name: str, sign: float) -> Relaxation | str | None:
        """Return what one thing alone must become; a sentence where that is not settled."""
        if kind == CHOICE:
            return self._chosen(name)
        most = self._room(name, sign) if kind == REQUIREMENT else self.ways.farthest
        if most <= self.ways.nothing:
            return None
        pins = [self.pins[name]] if kind == PIN else []
        give = {} if pins else {(kind, x): sign for x in ([name] if kind != LIMIT else self._at_corners(name))}
        found = self.ask(give, most=most, pins=pins)
        if found.design is None:
            value = "another" if kind == PIN else "a larger" if sign > 0 else "a smaller"
            return None if found.closed else f"{name}: whether {value} value alone would do is not settled"
        if kind == PIN:
            return self._repinned(self.pins[name], found)
        way = self._way(kind, name, sign, math.exp(sign * found.amount), found)
        stated = kind == REQUIREMENT or (kind == LIMIT and any(x.name == name for x in self.own))
        if way.patch is None and stated:
            # Within the tolerance of a limit both sides of a refusal look allowed.
            return None if found.amount <= self.ways.nothing else f"{way.sentence}: not shown to do as it is written"
        return way

    def _at_corners(self, limit: str) -> list[str]:
        """Return a limit of the user's own, and what it was posed as over a range."""
        return [limit, *(x for x in self.limits if x.startswith(f"{limit} ("))]

    def _room(self, name: str, sign: float) -> float:
        """Return how far a requirement may move before it leaves its declared range."""
        r, value = self.instance.model.declaration.requirements[name], self.instance.values.requirements[name]
        end = r.upper if sign > 0 else r.lower
        if not (end > 0 and math.isfinite(end)):
            return self.ways.farthest
        return min(self.ways.farthest, abs(math.log(end / value))) * (1 - 1e-12)

    def _way(self, kind: str, name: str, sign: float, factor: float, found: _LeastAmount) -> Relaxation:
        assert found.design is not None
        amount, up = abs(factor - 1.0), sign > 0
        change = f"{_percent(amount)} {'more' if up else 'less'}"
        model = self.instance.model
        patch: Mapping[str, Any] | None = None
        if kind == REQUIREMENT:
            given, unit = self.instance.values.requirements[name], model.declaration.requirements[name].unit
            patch, needed = self._first_that_works(
                lambda text: self._requirement_patch(name, text), given * factor, unit, up, found.design
            )
            words = f"{name} {needed} instead of {format_quantity(given, unit)} ({change})"
        elif kind == LIMIT:
            unit, own = self.units[name], next((x for x in self.own if x.name == name), None)
            given = own.bound if own is not None else self._as_asked(found.design).limits[name][1]
            factor = 1 / factor if given < 0 else factor
            if own is None:
                needed = _rounded(given * factor, unit, "at_least" if up else "at_most")
                words = f"limit {name} {needed} instead of {format_quantity(given, unit)} ({change})"
            else:
                patch, needed = self._first_that_works(
                    lambda text: self._limit_patch({name: text}), given * factor, unit, up, found.design
                )
                words = f"limit {own.quantity} {SIGNS[own.sense]} {needed} instead of {format_quantity(given, unit)}"
                words += f" ({change})"
        else:
            part = self.columns[name]
            row = found.design.parts[part.slot]
            column = name.split(".", 1)[1]
            given = next(row[c] for c in column.split("|") if row.get(c) is not None)
            unit = self.catalogs.table(part.table).columns[column.split("|")[0]].unit or "-"
            shown = ">=" if sign > 0 else "<="
            words = (
                f"a {part.slot} with {column} {shown} "
                f"{_rounded(given * factor, unit, 'at_least' if up else 'at_most')} would do; "
                f"{row} has {format_quantity(given, unit)} ({change})"
            )
        # The part that would do is none of the table: what it would give is the design of the relaxed question.
        # So it is of a limit of the family, too.
        design = found.design if patch is None else self._as_asked(found.design, patch)
        named = {REQUIREMENT: "requirement", LIMIT: "limit", COLUMN: "part"}[kind]
        sense = "at_least" if up else "at_most"
        return Relaxation(named, name, sense, given, given * factor, unit, amount, design, found.closed, words, patch)

    def _repinned(self, pin: _Pin, found: _LeastAmount) -> Relaxation | None:
        """Return the way out by another value of what is pinned."""
        assert found.design is not None
        value = found.design.values[pin.name]
        given = pin.high if value > pin.high else pin.low
        patch = self._pin_patch(pin, format_quantity(value, pin.unit, None))
        if not self._works(patch, found.design):
            return None
        amount = abs(value / given - 1.0)
        change = f"{_percent(amount)} {'more' if value > given else 'less'}"
        words = (
            f"{pin.name} {format_quantity(value, pin.unit)} instead of {format_quantity(given, pin.unit)} ({change})"
        )
        return Relaxation(
            "fix" if pin.key == "fix" else "limit",
            pin.name,
            "at_least" if value > given else "at_most",
            given,
            value,
            pin.unit,
            amount,
            self._as_asked(found.design, patch),
            found.closed,
            words,
            patch,
        )

    def _chosen(self, name: str) -> Relaxation | str | None:
        """Return the way out by another part or word than those asked for."""
        found = self.ask({}, free=[name])
        if found.design is None:
            return None if found.closed else f"{name}: whether another choice alone would do is not settled"
        patch = self._choice_patch(found.design, [name])
        if not self._works(patch, found.design):
            return None
        words = f"{name} {self._choice(found.design, name)} in place of what was asked"
        design = self._as_asked(found.design, patch)
        return Relaxation("choice", name, "", math.nan, math.nan, "-", math.nan, design, True, words, patch)

    @staticmethod
    def _choice(design: Design, name: str) -> str:
        return str(design.parts[name]) if name in design.parts else str(design.choices[name])

    # -- all that was asked together -----------------------------------------------------------------

    def together(self, single: Sequence[Relaxation], conflict: Sequence[str]) -> Relaxation | None:
        """Return the change of everything that the user asked, by the same fraction, and of no more than is needed."""
        signs = {name: self._direction(name, single, conflict) for name in self.given}
        signs = {name: sign for name, sign in signs.items() if sign}
        own = [x.name for x in self.own if x.name in self.giving]
        pins = list(self.pins.values())
        if not signs and not own and not pins:
            return None
        give = {(REQUIREMENT, name): sign for name, sign in signs.items()}
        give |= {(LIMIT, x): self.sign(x) for name in own for x in self._at_corners(name)}
        rooms = {name: self._room(name, sign) for name, sign in signs.items()}
        words = self._words()
        found = self.ask(give, pins=pins, rooms=rooms)
        freed: list[str] = []
        if found.design is None and words:
            found, freed = self.ask(give, pins=pins, rooms=rooms, free=words), words
        if found.design is None:
            return None
        changes = self._changes(found, signs, rooms, own)
        needed = self._needed(changes, self._choice_patch(found.design, freed), found.design)
        if needed is None:
            return None
        patch, shown = needed
        amount = math.expm1(found.amount)
        shown += [f"{name} {self._choice(found.design, name)}" for name in freed]
        sentence = f"together, each by {_percent(amount)}: {'; '.join(shown)}"
        # What is not offered as it was asked can only be told with the change.
        offered = all(pin.low <= found.design.values[x] <= pin.high for x, pin in self.pins.items())
        design = self._missing(found.design) if offered and not freed else self._as_asked(found.design, patch)
        return Relaxation(
            "joint", "all that was asked", "", math.nan, math.nan, "-", amount, design, found.closed, sentence, patch
        )

    def _direction(self, name: str, single: Sequence[Relaxation], conflict: Sequence[str]) -> float:
        """Return which way a requirement asks less: as it helps alone, as a limit, or by the signs of all limits."""
        if not self.instance.values.requirements[name] > 0:
            return 0.0
        alone = [way for way in single if way.kind == "requirement" and way.name == name]
        if alone:
            way = min(alone, key=lambda x: x.amount)
            return 1.0 if way.sense == "at_least" else -1.0
        for limit in self.giving:
            if self._requirement_of(limit) == name:
                return self.sign(limit)
        model = self.instance.model
        position = model.input_number["requirement", name, ""] - len(model.variables)
        shapes, flat = self._shapes(), self.ways.flat
        for some in (self.limits, conflict):
            ends = [shapes.limits[x] for x in some if x in shapes.limits]
            spans = [x.elasticity[self._followers(position)] for x in ends if x.sign == 1]
            low, high = min((s.min() for s in spans), default=0.0), max((s.max() for s in spans), default=0.0)
            if low >= -flat and high > flat:
                return -1.0
            if high <= flat and low < -flat:
                return 1.0
        return 0.0

    def _shapes(self) -> Any:
        model = self.instance.model
        return model.function("shapes", lambda: classify(model, *declared_ranges(model, self.catalogs)))

    def _changes(
        self, found: _LeastAmount, signs: Mapping[str, float], rooms: Mapping[str, float], own: Sequence[str]
    ) -> list[_Change]:
        """Return everything that gives way, with its value there."""
        assert found.design is not None
        declared, changes = self.instance.model.declaration.requirements, list[_Change]()
        for name, sign in signs.items():
            r, given = declared[name], self.instance.values.requirements[name]
            needed = min(max(given * math.exp(sign * min(found.amount, rooms[name])), r.lower), r.upper)
            texts = tuple(outward(needed, r.unit, up=sign > 0))
            changes.append(_Change(REQUIREMENT, name, name, texts, format_quantity(given, r.unit)))
        for x in (x for x in self.own if x.name in own):
            factor = math.exp(self.sign(x.name) * found.amount * (1 if x.bound > 0 else -1))
            texts = tuple(outward(x.bound * factor, x.unit, up=x.sense == "at_most"))
            shown = f"limit {x.quantity} {SIGNS[x.sense]}"
            changes.append(_Change(LIMIT, x.name, shown, texts, format_quantity(x.bound, x.unit)))
        for pin in self.pins.values():
            value = found.design.values[pin.name]
            if not pin.low <= value <= pin.high:
                end = pin.high if value > pin.high else pin.low
                texts = (format_quantity(value, pin.unit, None),) * self.ways.further
                changes.append(_Change(PIN, pin.name, pin.name, texts, format_quantity(end, pin.unit)))
        return changes

    def _needed(
        self, changes: list[_Change], rest: Mapping[str, Any], design: Design
    ) -> tuple[dict[str, Any], list[str]] | None:
        """Return the patch of as few changes as the design needs, and their words."""
        for k in range(self.ways.further):
            if not self._works(self._together(changes, k, rest), design):
                continue
            some = list(changes)
            for change in changes:
                fewer = [x for x in some if x is not change]
                if self._works(self._together(fewer, k, rest), design):
                    some = fewer
            return self._together(some, k, rest), [f"{x.shown} {x.texts[k]} instead of {x.given}" for x in some]
        return None

    def _together(self, changes: Sequence[_Change], k: int, rest: Mapping[str, Any]) -> dict[str, Any]:
        """Return several changes as one patch."""
        patch = dict(rest)
        for x in changes:
            if x.kind == REQUIREMENT:
                patch = patched(patch, self._requirement_patch(x.name, x.texts[k]))
            elif x.kind == PIN:
                patch = patched(patch, self._pin_patch(self.pins[x.name], x.texts[k]))
        return patched(patch, self._limit_patch({x.name: x.texts[k] for x in changes if x.kind == LIMIT}))

    # -- patches ---------------------------------------------------------------------------------------

    def _word(self, key: str, name: str) -> str:
        """Return what the user calls something under a key of the spec; its name where it does not stand there."""
        return next((str(word) for word in getattr(self.request, key) if self.names.get(str(word)) == name), name)

    def _requirement_patch(self, name: str, text: str) -> Mapping[str, Any]:
        return {"requirements": {self._word("requirements", name): text}}

    def _limit_patch(self, texts: Mapping[str, str]) -> dict[str, Any]:
        """Return the entries of ``limits`` with other bounds for some limits of the user's own."""
        quantities = {x.quantity for x in self.own if x.name in texts}
        entries: dict[str, Any] = {}
        for quantity in sorted(quantities):
            word = self._word("limits", quantity)
            whole = [x for x in self.own if x.quantity == quantity and x.origin is Origin.USER]
            stated = [f"{SIGNS[x.sense]} {texts.get(x.name) or format_quantity(x.bound, x.unit, None)}" for x in whole]
            entries[word] = stated[0] if len(stated) == 1 else stated
        return {"limits": entries} if entries else {}

    def _pin_patch(self, pin: _Pin, text: str) -> dict[str, Any]:
        if pin.key == "fix":
            return {"fix": {self._word("fix", pin.name): text}}
        ends = min(pin.low, float(text)), max(pin.high, float(text))
        return {"limits": {self._word("limits", pin.name): f"{ends[0]:g} .. {ends[1]:g}"}}

    def _choice_patch(self, design: Design, names: Sequence[str]) -> dict[str, Any]:
        patch: dict[str, Any] = {}
        for name in names:
            key = "fix" if name in self.fix else "parts"
            chosen = self._choice(design, name)
            patch = patched(patch, {key: {self._word(key, name): chosen if key == "fix" else [chosen]}})
            if key == "fix" and name in self.parts:
                patch = patched(patch, {"parts": {self._word("parts", name): [chosen]}})
        return patch

    def _first_that_works(
        self, patch: Callable[[str], Mapping[str, Any]], needed: float, unit: str, up: bool, design: Design
    ) -> tuple[Mapping[str, Any] | None, str]:
        """Return the patch with the value nearest to what is needed that surely does, and that value."""
        texts = list(outward(needed, unit, up))
        for text in texts:
            if self._works(patch(text), design):
                return patch(text), text
        return None, texts[0]

    def _with(self, patch: Mapping[str, Any]) -> Request:
        """Return the request with a patch."""
        stated = {key: getattr(self.request, key) for key in ("requirements", "limits", "fix", "parts")}
        return replace(self.request, **patched(stated, patch))

    def _works(self, patch: Mapping[str, Any], found: Design) -> bool:
        """Tell whether a design is one of the question with a patch."""
        asked = self._with(patch)
        try:
            problem = robust_counterpart(nominal(asked.problem), asked.robust, asked.limits)
            instance = Instance(replace(asked, problem=problem))
            design = self._as_asked(found, patch)
            instance.combinations.number(design)
        except InputError:
            return False
        values = [design.values[v.name] for v in instance.model.variables]
        slack = self.ways.slack
        inside = all(
            low - slack * abs(low) <= x <= high + slack * abs(high)
            for x, low, high in zip(values, instance.ranges.lower, instance.ranges.upper, strict=True)
        )
        return inside and not design.violated

    def _missing(self, found: Design) -> Design:
        """Return a design of the relaxed question as it stands in the question, also where it is refused there."""
        instance = self.instance
        number = instance.combinations.number(found)
        variables = np.array([[found.values[v.name] for v in instance.model.variables]])
        result = instance.evaluate(variables, instance.data(np.array([number])))
        rows = {slot: part_row(table, row) for slot, (table, row) in instance.combinations.describe(number)[0].items()}
        return make_design(instance, make_frame(instance, {}), variables[0], result, 0, rows, found.choices)

    def _as_asked(self, found: Design, patch: Mapping[str, Any] | None = None) -> Design:
        """Return a design of the relaxed question as one of the question itself, or of that with a patch."""
        kinds = {name: kind for name, kind in found.frame.kinds.items() if name != AMOUNT}
        own = replace(found, frame=replace(found.frame, kinds=kinds))
        asked, problem = self._with(patch or {}), self.instance.problem
        if patch is not None:
            problem = robust_counterpart(nominal(asked.problem), asked.robust, asked.limits)
        return evaluate(problem, asked.requirements, own, catalogs=asked.catalogs, limits=asked.limits)


def _percent(amount: float) -> str:
    return f"{100 * amount:.3g} %"


def _number(value: float) -> float | None:
    return None if math.isnan(value) else value


def _rounded(value: float, unit: str, sense: str) -> str:
    """Return a value with its unit, rounded up where at least so much is needed, otherwise down."""
    return next(outward(value, unit, up=sense == "at_least"))
