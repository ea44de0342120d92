"""Why nothing is feasible, over the whole catalogue, and what would make it so."""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import casadi as ca

from synth.analysis import evaluate
from synth.deadline import Stopped, until
from synth.errors import InputError
from synth.files import frame_csv
from synth.instance import SIGNS, Instance, as_mapping, catalogs_for
from synth.output_folder import EXPLANATION, save_result
from synth.posed import posed
from synth.problem import DesignProblem, load
from synth.relaxation import AMOUNT, COLUMN, LIMIT, MOST, REQUIREMENT, Relaxed
from synth.results import Design, ParetoFront
from synth.search import one_best
from synth.special import expanded
from synth.tables import Catalogs
from synth.units import format_quantity, from_si, parse_unit

if TYPE_CHECKING:
    import pandas as pd

GAP = 8e-3  # of the amount by which something must give way
EFFORT = 100_000  # boxes for each way out
NOTHING = 1e-7  # an amount as small as this is none
DIGITS = 6
FIRST = 4  # limits that are looked at first


@dataclass(frozen=True)
class Relaxation:
    """One way out: what gives way, by how much, and the design that results.

    ``kind`` is requirement, limit, part or joint; ``given`` and ``needed`` are in SI (of a part: the nearest row's
    value and the one that would do; of a joint relaxation not-a-number). ``amount`` is the change as a fraction.
    ``proven`` tells whether nothing less would do, within 0.8 % of the amount.
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

    def requirement(self) -> str:
        """Return the needed value as text with its unit, rounded so that it still does."""
        return _rounded(self.needed, self.unit, self.sense)


@dataclass
class Explanation:
    """What ``explain`` found.

    Parameters
    ----------
    feasible : bool
        There is nothing to explain.
    conflict : tuple of str
        A minimal set of limits that cannot hold together: without any one of them the others can.
    minimal : bool
        Whether that is proven for every one of them.
    guards : tuple of str
        Limits without which formulas do not exist; they always count.
    single : list of Relaxation
        Requirements and limits of which one alone, given way to, makes it feasible; the smallest change first.
    joint : Relaxation or None
        All limits give way by the same fraction.
    parts : list of Relaxation
        Values of part columns that would do.
    not_settled : list of str
        What could be neither shown nor excluded.
    interrupted : str
        Why it ended early, or nothing.
    """

    feasible: bool = False
    conflict: tuple[str, ...] = ()
    minimal: bool = False
    guards: tuple[str, ...] = ()
    single: list[Relaxation] = field(default_factory=list)
    joint: Relaxation | None = None
    parts: list[Relaxation] = field(default_factory=list)
    not_settled: list[str] = field(default_factory=list)
    interrupted: str = ""
    seconds: float = 0.0

    @property
    def ways(self) -> list[Relaxation]:
        """Return all ways out: single ones, the joint one, other parts."""
        return [*self.single, *([] if self.joint is None else [self.joint]), *self.parts]

    @property
    def message(self) -> str:
        """Return the answer in one or two sentences."""
        if self.feasible:
            return "The question has feasible designs; there is nothing to explain."
        words = []
        if self.conflict:
            always = f" (beside {', '.join(self.guards)}, which always count)" if self.guards else ""
            names = ", ".join(self.conflict) + always
            words.append(f"These limits cannot hold together: {names}." if len(self.conflict) > 1 else
                         f"No design keeps {names}.")  # fmt: skip
        if self.ways:
            words.append(f"The smallest change that helps: {min(self.ways, key=lambda w: w.amount).sentence}.")
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
            rows.append({
                "kind": way.kind,
                "name": way.name,
                "unit": way.unit if shown else "",
                "given": float(from_si(way.given, unit)) if shown else None,
                "needed": float(from_si(way.needed, unit)) if shown else None,
                "change [%]": 100 * way.amount,
                "proven": "yes" if way.proven else "no",
                **{f"part: {slot}": str(row) for slot, row in way.design.parts.items()},
                "sentence": way.sentence,
            })  # fmt: skip
        return pd.DataFrame(rows)

    def save(self, folder: str | Path) -> list[Path]:
        """Write explanation.csv and explanation.json; return the files.

        What was stopped replaces no earlier result: it is written to a folder ``stopped`` beside that.
        """
        import json

        told = {
            "feasible": self.feasible,
            "message": self.message,
            "conflict": list(self.conflict),
            "minimal": self.minimal,
            "guards": list(self.guards),
            "ways": [
                {"kind": w.kind, "name": w.name, "change": w.amount, "proven": w.proven, "sentence": w.sentence}
                for w in self.ways
            ],
            "not_settled": self.not_settled,
            "interrupted": self.interrupted,
        }
        files = {
            "explanation.csv": frame_csv(self.to_frame()),
            "explanation.json": json.dumps(told, indent=2, ensure_ascii=False) + "\n",
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

    Returns
    -------
    Explanation

    Raises
    ------
    InputError
        For everything that is wrong with the input, in one sentence.
    """
    begin = time.monotonic()
    problem = posed(load(p), robust, limits)
    asking = _Question(problem, requirements, catalogs, parts, limits, fix, grid, seed, progress, time_limit)
    result = Explanation(guards=tuple(asking.guards))
    try:
        with until(asking.deadline):
            _explain(asking, result)
    except Stopped as stop:
        result.interrupted = stop.reason
    except KeyboardInterrupt:
        result.interrupted = "interrupted"
    result.single.sort(key=lambda w: w.amount)
    result.parts.sort(key=lambda w: w.amount)
    result.seconds = time.monotonic() - begin
    return result


def _explain(asking: _Question, result: Explanation) -> None:
    asking.say("joint", 0.0, "all limits together")
    found = asking.ask({(LIMIT, name): asking.sign(name) for name in asking.giving})
    if found.designs and found.designs[0].values[AMOUNT] <= NOTHING:
        result.feasible = True
        return
    if found.designs:
        result.joint = asking.joint(found)
    asking.say("conflict", 0.1, "which limits exclude each other")
    result.conflict, result.minimal = asking.conflict(result.joint)
    tasks: list[tuple[str, str, float]] = []
    # Where a limit is a requirement, the requirement is what a user can change.
    tasks += [
        (LIMIT, x, asking.sign(x)) for x in result.conflict if x in asking.giving and not asking.is_requirement(x)
    ]
    bound = [*result.conflict, *asking.guards]
    tasks += [(REQUIREMENT, name, sign) for name in asking.moving(REQUIREMENT, bound) for sign in (1.0, -1.0)]
    tasks += [(COLUMN, name, sign) for name in asking.moving(COLUMN, bound) for sign in (1.0, -1.0)]
    for k, (kind, name, sign) in enumerate(tasks):
        asking.say("ways out", 0.2 + 0.8 * k / len(tasks), f"{kind} {name} {'up' if sign > 0 else 'down'}")
        way = asking.single(kind, name, sign)
        if isinstance(way, Relaxation):
            (result.parts if kind == COLUMN else result.single).append(way)
        elif way is not None:
            result.not_settled.append(way)


class _Question:
    """The question that is explained, and its relaxed form."""

    def __init__(
        self,
        problem: DesignProblem,
        requirements: Mapping[str, Any],
        catalogs: Any,
        parts: Mapping[str, Any] | None,
        limits: Mapping[str, Any] | None,
        fix: Mapping[str, Any] | None,
        grid: bool,
        seed: int,
        progress: Callable[[Mapping[str, Any]], None] | None,
        time_limit: float | None,
    ) -> None:
        if progress is not None and not callable(progress):
            raise InputError("progress", progress, "a function of one mapping, or none")
        if time_limit is not None and not (isinstance(time_limit, (int, float)) and 0 < time_limit < math.inf):
            raise InputError("time_limit", time_limit, "a positive number of seconds")
        self.progress, self.seed, self.grid = progress, seed, grid
        self.deadline = math.inf if time_limit is None else time.monotonic() + time_limit
        self.asked = dict(requirements)
        self.catalogs: Catalogs = catalogs_for(problem, catalogs)
        self.instance = Instance(problem, requirements, self.catalogs, parts, limits, fix, grid)
        model = self.instance.model
        variables = {v.name: v for v in model.variables}
        bounded, own = dict[str, Any](), list(self.instance.extra)
        for name, conditions in model.by_name(
            self.instance.asked_limits, "limits", list(model.quantity_sx), "a quantity"
        ).items():
            if name in model.declaration.counts:
                bounded[name] = conditions
            elif name in variables:
                own += self.instance.conditions(name, conditions)
        kept = model.by_name(as_mapping(fix, "fix", ""), "fix", list(model.declaration.names().values()), "a name")
        self.fix = {name: value for name, value in kept.items() if name not in model.declaration.derived}
        self.parts, self.bounded = parts, bounded
        self.own = own
        self.limits = [x.name for x in model.limits] + [x.name for x in own]
        self.senses = {x.name: x.sense for x in model.limits} | {x.name: x.sense for x in own}
        self.units = {x.name: x.unit for x in model.limits} | {x.name: x.unit for x in own}
        self.guards = [x.name for x in model.limits if x.guard]
        # A guard, an equality and a limit of zero do not give way.
        firm = {x.name for x in model.limits if x.guard or x.sense == "equal" or x.limit.is_zero()}
        firm |= {x.name for x in own if x.sense == "equal" or x.limit == 0}
        self.giving = [name for name in self.limits if name not in firm]
        slots = model.declaration.slots.values()
        self.columns = {f"{part.slot}.{key}": part for part in slots for key in part.columns}
        self.given = {
            name: float(from_si(value, parse_unit(model.declaration.requirements[name].unit)))
            for name, value in self.instance.requirements.items()
            if name in self.instance.given
        }

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
        self, give: Mapping[tuple[str, str], float], kept: Sequence[str] | None = None, most: float = MOST
    ) -> ParetoFront:
        """Return the design that needs the least amount, of all that keep the limits."""
        left = self.deadline - time.monotonic()
        if left <= 0:
            raise Stopped("time limit")
        relaxed = Relaxed(self.instance, self.own, give, self.limits if kept is None else kept)
        # Where nothing gives way any design will do.
        fix = self.fix if give else {**self.fix, AMOUNT: 0.0}
        limits = {**self.bounded, AMOUNT: f"<= {most!r}"} if most < MOST else self.bounded
        instance = Instance(relaxed, self.given, self.catalogs, self.parts, limits, fix, self.grid)
        front = one_best(instance, AMOUNT, GAP, EFFORT, self.seed, None if left == math.inf else left)
        if front.interrupted:
            raise Stopped(front.interrupted)
        return front

    def moving(self, kind: str, limits: Sequence[str]) -> list[str]:
        """Return the requirements or part columns (``slot.column``) on which some of the limits depend."""
        model, d = self.instance.model, self.instance.model.declaration
        kinds = {REQUIREMENT: "requirement", COLUMN: "part"}
        own = {x.name: model.quantity_node[x.quantity] for x in self.own}
        nodes = [k for x in limits for k in ([own[x]] if x in own else model.limit_nodes[x])]
        first = len(model.variables)
        names = []
        for k, entry in enumerate(model.data_inputs):
            if entry.kind != kinds[kind]:
                continue
            followers = [k]
            if kind == REQUIREMENT:
                if not self.instance.requirements[entry.name] > 0:
                    continue
                for j, other in enumerate(model.data_inputs):
                    default = d.requirements[other.name].default if other.kind == "requirement" else None
                    if other.name not in self.instance.given and isinstance(default, ca.SX):
                        used = {str(s) for s in ca.symvar(expanded(default, model.calls))}
                        followers += [j] if str(entry.sx) in used else []
            marked = model.program.dependence([first + j for j in followers])
            if any(marked[node] for node in nodes):
                names.append(entry.name if kind == REQUIREMENT else f"{entry.name}.{'|'.join(entry.columns)}")
        return names

    def is_requirement(self, limit: str) -> bool:
        """Tell whether the limit side of a limit is a requirement, and nothing else."""
        records = {x.name: x for x in self.instance.model.limits}
        d = self.instance.model.declaration
        symbols = {str(r.sx) for r in d.requirements.values() if r.sx is not None}
        return limit in records and records[limit].limit.is_symbolic() and str(records[limit].limit) in symbols

    # -- which limits exclude each other ---------------------------------------------------------

    def conflict(self, joint: Relaxation | None) -> tuple[tuple[str, ...], bool]:
        """Return a minimal set of limits that cannot hold together, and whether it is proven to be minimal.

        Limits are added until no design keeps them, those first that the nearest design is stopped by; then each is
        left out in turn, and stays out where the others still exclude each other.
        """
        near = [] if joint is None else self._tightest(joint.design)
        kept = [x for x in near if x in self.limits][:FIRST]
        while True:
            found = self.ask({}, kept)
            if not found.designs:
                break
            broken = [x for x in self._broken(found.designs[0]) if x not in kept]
            if not broken:
                return tuple(kept), False
            kept += broken
        proven = found.certificate.kind == "global"
        for k, name in enumerate(list(kept)):
            self.say("conflict", 0.1 + 0.1 * k / len(kept), f"without {name}")
            found = self.ask({}, [x for x in kept if x != name])
            closed = found.certificate.kind == "global"
            if not found.designs and closed:
                kept.remove(name)
            proven &= bool(found.designs) or closed
        return tuple(x for x in self.limits if x in kept), proven

    @staticmethod
    def _tightest(design: Design) -> list[str]:
        used = {name: x for name, x in design.utilisation.items() if x is not None}
        return sorted(used, key=lambda name: -used[name])

    def _broken(self, found: Design) -> list[str]:
        """Return the limits that a design of the relaxed question breaks, the worst first."""
        design = self._as_asked(found, self.asked)
        missed = {name: r for name, r in design.residuals.items() if name in design.violated}
        return sorted(missed, key=lambda name: -missed[name])[:FIRST]

    # -- ways out ------------------------------------------------------------------------------------

    def joint(self, found: ParetoFront) -> Relaxation:
        """Return the relaxation of all limits by the same fraction."""
        design = self._as_asked(found.designs[0], self.asked)
        amount = math.expm1(found.designs[0].values[AMOUNT])
        sentence = f"all limits wider by {_percent(amount)}; that concerns {', '.join(design.violated) or 'none'}"
        return Relaxation(
            "joint", "all limits", "", math.nan, math.nan, "-", amount, design, found.certificate.kind == "global",
            sentence,
        )  # fmt: skip

    def single(self, kind: str, name: str, sign: float) -> Relaxation | str | None:
        """Return what one requirement, limit or column alone must become; a sentence where that is not settled."""
        most = self._room(name, sign) if kind == REQUIREMENT else MOST
        if most <= NOTHING:
            return None
        found = self.ask({(kind, name): sign}, most=most)
        closed = found.certificate.kind == "global"
        if not found.designs:
            direction = "larger" if sign > 0 else "smaller"
            return None if closed else f"{name}: whether a {direction} value alone would do is not settled"
        factor = math.exp(sign * found.designs[0].values[AMOUNT])
        return self._way(kind, name, sign, factor, found.designs[0], closed)

    def _room(self, name: str, sign: float) -> float:
        """Return how far a requirement may move before it leaves its declared range."""
        r, value = self.instance.model.declaration.requirements[name], self.instance.requirements[name]
        end = r.upper if sign > 0 else r.lower
        if not (end > 0 and math.isfinite(end)):
            return MOST
        return min(MOST, abs(math.log(end / value))) * (1 - 1e-12)

    def _way(self, kind: str, name: str, sign: float, factor: float, found: Design, proven: bool) -> Relaxation:
        amount = abs(factor - 1.0)
        change = f"{_percent(amount)} {'more' if factor > 1 else 'less'}"
        model, asked = self.instance.model, dict(self.asked)
        sense = "at_least" if factor > 1 else "at_most"
        if kind == REQUIREMENT:
            given, unit = self.instance.requirements[name], model.declaration.requirements[name].unit
            needed = _rounded(given * factor, unit, sense)
            asked = {w: v for w, v in asked.items() if model.declaration.names().get(w) != name} | {name: needed}
            words = f"{name} {needed} instead of {format_quantity(given, unit)} ({change})"
        elif kind == LIMIT:
            unit, given = self.units[name], self._as_asked(found, asked).limits[name][1]
            needed = _rounded(given * factor, unit, sense)
            own = next((f"{x.quantity} {SIGNS[x.sense]}" for x in self.own if x.name == name), name)
            words = f"limit {own} {needed} instead of {format_quantity(given, unit)} ({change})"
        else:
            part = self.columns[name]
            row = found.parts[part.slot]
            column = name.split(".", 1)[1]
            given = next(row[c] for c in column.split("|") if row.get(c) is not None)
            unit = self.catalogs.table(part.table).columns[column.split("|")[0]].unit or "-"
            shown = ">=" if sign > 0 else "<="
            words = (
                f"a {part.slot} with {column} {shown} {_rounded(given * factor, unit, sense)} would do; "
                f"{row} has {format_quantity(given, unit)} ({change})"
            )
        # The part that would do is none of the table: what it would give is the design of the relaxed question.
        design = found if kind == COLUMN else self._as_asked(found, asked)
        named = {REQUIREMENT: "requirement", LIMIT: "limit", COLUMN: "part"}[kind]
        return Relaxation(named, name, sense, given, given * factor, unit, amount, design, proven, words)

    def _as_asked(self, found: Design, requirements: Mapping[str, Any]) -> Design:
        """Return a design of the relaxed question as one of the question itself."""
        kinds = {name: kind for name, kind in found.frame.kinds.items() if name != AMOUNT}
        own = replace(found, frame=replace(found.frame, kinds=kinds))
        return evaluate(
            self.instance.problem, requirements, own, catalogs=self.catalogs, limits=self.instance.asked_limits
        )


def _percent(amount: float) -> str:
    return f"{100 * amount:.3g} %"


def _rounded(value: float, unit: str, sense: str) -> str:
    """Return a value with its unit, rounded up where at least so much is needed, otherwise down."""
    shown = float(from_si(value, parse_unit(unit)))
    step = 10.0 ** (math.floor(math.log10(abs(shown))) - DIGITS + 1) if shown else 1.0
    # A hundredth of the last digit is less than the tolerance of feasibility.
    whole = math.ceil(shown / step - 0.01) if sense == "at_least" else math.floor(shown / step + 0.01)
    text = f"{float(f'{whole * step:.{DIGITS}g}'):.{DIGITS}g}"
    return text if unit == "-" else f"{text} {unit}"
