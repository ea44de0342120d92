"""Random small design problems of many structures, each fixed by its structure and seed.

A problem is a ``Case``: unknowns, own tables and formulas in plain NumPy. ``RandomProblem`` declares it to the engine;
``tests.certificates.reference`` evaluates the same formulas on numbers, without the engine.
"""

from __future__ import annotations

import itertools
import zlib
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cache
from typing import Any

import numpy as np
import pandas as pd

import synth
from synth.special import special

Unknowns = Mapping[str, Any]
Formula = Callable[[Unknowns], Any]
SEEDS = 1000
CLOUD = 400


class Label:
    """The labels of a choice for a batch of designs, as positions; the counterpart of the engine's symbol."""

    def __init__(self, labels: Sequence[str], positions: np.ndarray) -> None:
        self.labels, self.positions = tuple(labels), np.asarray(positions)

    def select(self, values: Mapping[str, Any]) -> Any:
        """Return, per design, the value of its label."""
        assert set(values) == set(self.labels)
        result: Any = np.nan
        for k, label in enumerate(self.labels):
            result = np.where(self.positions == k, values[label], result)
        return result


@dataclass(frozen=True)
class Variable:
    """A continuous or gridded unknown; numbers in ``unit``, ``factor`` makes them SI."""

    lower: float
    upper: float
    grid: tuple[float, ...] = ()
    unit: str = "-"
    factor: float = 1.0


@dataclass(frozen=True)
class Quantity:
    """A derived quantity and the guards without which it does not exist."""

    formula: Formula
    needs: tuple[str, ...] = ()


@dataclass(frozen=True)
class Limit:
    """A limit between two sides; ``void_without`` names optional columns whose absence makes it void.

    ``terms`` is the size of its largest term, where one side is zero.
    """

    sense: str
    value: Formula
    limit: Formula
    guard: bool = False
    void_without: tuple[str, ...] = ()
    terms: Formula | None = None


@dataclass(frozen=True)
class Refusal:
    """Combinations that must not be used, and the slots, counts and choices it speaks of."""

    when: Formula
    over: tuple[str, ...]


@dataclass
class Case:
    """One random problem and the question asked of it.

    ``positive`` tells that every objective is positive by construction, ``solved`` gives a variable by closed form
    from an equality, ``seconds`` is the time limit.
    """

    structure: str
    seed: int
    variables: dict[str, Variable] = field(default_factory=dict)
    counts: dict[str, tuple[float, ...]] = field(default_factory=dict)
    choices: dict[str, tuple[str, ...]] = field(default_factory=dict)
    slots: dict[str, str] = field(default_factory=dict)
    tables: dict[str, pd.DataFrame] = field(default_factory=dict)
    optional: set[str] = field(default_factory=set)
    derived: dict[str, Quantity] = field(default_factory=dict)
    limits: dict[str, Limit] = field(default_factory=dict)
    refusals: dict[str, Refusal] = field(default_factory=dict)
    objectives: dict[str, str] = field(default_factory=dict)
    asked: list[tuple[str, str, float]] = field(default_factory=list)  # limits of the question, numbers in the unit
    fix: dict[str, Any] = field(default_factory=dict)
    parts: dict[str, Any] = field(default_factory=dict)  # designations of a slot, or "column > number"
    requirements: dict[str, float] = field(default_factory=dict)
    solved: dict[str, Formula] = field(default_factory=dict)
    grid: bool = True
    gap: float = 1e-2
    points: int = 5
    positive: bool = True
    seconds: float = 5.0

    def unit(self, name: str) -> tuple[str, float]:
        """Return the unit of a quantity and its size in SI."""
        variable = self.variables.get(name)
        return (variable.unit, variable.factor) if variable else ("-", 1.0)

    def question(self) -> dict[str, Any]:
        """Return the arguments of ``synthesize``."""
        signs = {"at_most": "<=", "at_least": ">=", "equal": "=="}
        limits: dict[str, list[str]] = {}
        for name, sense, bound in self.asked:
            unit = self.unit(name)[0]
            limits.setdefault(name, []).append(f"{signs[sense]} {bound!r} {'' if unit == '-' else unit}".strip())
        fix = {n: f"{v!r} {self.unit(n)[0]}" if n in self.variables else v for n, v in self.fix.items()}
        question: dict[str, Any] = {
            "objectives": self.objectives,
            "points": self.points,
            "gap": self.gap,
            "grid": self.grid,
            "time_limit": self.seconds,
        }
        if self.tables:
            units = {c: f"{c} [-]" for t in self.tables.values() for c in t.columns if c != "designation"}
            question["catalogs"] = {name: table.rename(columns=units) for name, table in self.tables.items()}
        restricted = {"limits": limits, "fix": fix, "parts": self.parts}
        return question | {name: value for name, value in restricted.items() if value}


class RandomProblem(synth.DesignProblem):
    """The problem of one case; its options tell which, so that class and options suffice to make it again."""

    name, title = "random_problem", "Random problem"
    sources = ("none",)

    def declare(self, d):
        structure = d.option("structure", tuple(STRUCTURES), next(iter(STRUCTURES)))
        seed = d.option("seed", tuple(str(k) for k in range(SEEDS)), "0")
        case = make(structure, int(seed))
        u: dict[str, Any] = {}
        for name, value in case.requirements.items():
            u[name] = d.requirement(name, "-", default=2 * value)
        for name, v in case.variables.items():
            u[name] = d.variable(name, v.unit, v.lower, v.upper, grid=list(v.grid) or None)
        for name, values in case.counts.items():
            step = values[1] - values[0] if len(values) > 1 else 1
            u[name] = d.count(name, values[0], values[-1], step)
        for name, labels in case.choices.items():
            u[name] = d.choice(name, labels)
        for slot, table in case.slots.items():
            part = d.part(slot, table)
            for column in case.tables[table].columns[1:]:
                symbol = f"{slot}.{column}"
                if column.startswith("unused"):
                    continue
                u[symbol] = part.optional(column) if symbol in case.optional else getattr(part, column)
        for name, q in case.derived.items():
            d.derive(name, "-", q.formula(u), needs=q.needs)
        for name, x in case.limits.items():
            verb = {"at_most": d.at_most, "at_least": d.at_least, "equal": d.equal}[x.sense]
            verb(name, x.value(u), x.limit(u), "-", **({"guard": True} if x.guard else {}))
        for name, refusal in case.refusals.items():
            d.refuse(name, refusal.when(u), "another combination")
        for name, sense in case.objectives.items():
            d.objective(name, sense)


class Builder:
    """Draws the unknowns of a case, then limits that a random design, the witness, keeps."""

    def __init__(self, structure: str, seed: int) -> None:
        self.case = Case(structure, seed, gap=1e-3 if seed % 4 == 0 else 1e-2)
        self.rng = np.random.default_rng([zlib.crc32(structure.encode()), seed])
        self._cloud: dict[str, Any] | None = None

    # -- unknowns --------------------------------------------------------------------------------

    def uniform(self, low: float, high: float) -> float:
        return round(float(self.rng.uniform(low, high)), 4)

    def integer(self, low: int, high: int) -> int:
        """Return a whole number, both ends included."""
        return int(self.rng.integers(low, high + 1))

    def chance(self, share: float = 0.5) -> bool:
        return bool(self.rng.random() < share)

    def variable(self, name: str, low: float, high: float, **more: Any) -> Formula:
        self.case.variables[name] = Variable(low, high, **more)
        return lambda u: u[name]

    def variables(self, count: int, low: float = 0.5, high: float = 5.0) -> list[str]:
        for name in "xyz"[:count]:
            self.variable(name, round(low * self.uniform(0.7, 1.3), 3), round(high * self.uniform(0.7, 1.3), 3))
        return list("xyz"[:count])

    def slots(self, count: int, rows: tuple[int, int] = (2, 5), columns: int = 2) -> list[str]:
        """Add slots, each with a table of its own; return the names of their columns."""
        names = []
        for slot in ("rod", "disc", "pad")[:count]:
            size = self.integer(*rows)
            data = {f"{c}": np.round(self.rng.uniform(0.5, 2.5, size), 3) for c in "ks"[:columns]}
            self.table(slot, pd.DataFrame({"designation": [f"{slot} {k}" for k in range(size)], **data}))
            names += [f"{slot}.{c}" for c in "ks"[:columns]]
        return names

    def table(self, slot: str, rows: pd.DataFrame) -> None:
        self.case.slots[slot] = f"table_{slot}"
        self.case.tables[f"table_{slot}"] = rows

    def count(self, low: int = 1, high: int = 4) -> list[str]:
        self.case.counts["n"] = tuple(float(k) for k in range(low, high + 1))
        return ["n"]

    def maybe_count(self) -> list[str]:
        return self.count(1, self.integer(2, 4)) if self.chance() else []

    # -- limits ----------------------------------------------------------------------------------

    def cloud(self) -> dict[str, Any]:
        """Return random designs by name; the first is the witness."""
        if self._cloud is None:
            case, u = self.case, dict[str, Any](self.case.requirements)
            for name, v in case.variables.items():
                values = self.rng.uniform(v.lower, v.upper, CLOUD)
                u[name] = v.factor * (self.rng.choice(v.grid, CLOUD) if v.grid and case.grid else values)
            for name, counted in case.counts.items():
                u[name] = self.rng.choice(counted, CLOUD)
            for name, labels in case.choices.items():
                u[name] = Label(labels, self.rng.integers(0, len(labels), CLOUD))
            for slot, table in case.slots.items():
                rows = self.rng.integers(0, len(case.tables[table]), CLOUD)
                for column in case.tables[table].columns[1:]:
                    u[f"{slot}.{column}"] = case.tables[table][column].to_numpy(float)[rows]
            for name, formula in case.solved.items():
                u[name] = formula(u)
            self._cloud = u
        return self._cloud

    def keeps(
        self, name: str, sense: str, value: Formula, slack: float = 0.3, factor: bool = False, **more: Any
    ) -> None:
        """Limit a value so that the witness keeps it: by a share of its spread, or by a factor."""
        values = np.broadcast_to(value(self.cloud()), (CLOUD,))
        if not np.isfinite(values[0]):
            raise ValueError(f"{name} is not defined at the witness")
        room = self.rng.uniform(0, slack)
        step = room * (abs(values[0]) if factor else float(np.subtract(*np.nanpercentile(values, [75, 25]))))
        bound = float(values[0] + (step if sense == "at_most" else -step))
        self.case.limits[name] = Limit(sense, value, lambda u: bound, **more)

    def derive(self, name: str, formula: Formula, needs: tuple[str, ...] = ()) -> None:
        self.case.derived[name] = Quantity(formula, needs)

    def objective(self, name: str, formula: Formula, sense: str = "min", needs: tuple[str, ...] = ()) -> None:
        self.derive(name, formula, needs)
        self.case.objectives[name] = sense

    # -- random formulas -------------------------------------------------------------------------

    def monomial(self, names: Sequence[str], exponents: Sequence[float] = (-2, -1, -0.5, 0.5, 1, 1.5, 2)) -> Formula:
        used = [str(n) for n in self.rng.permutation(names)[: self.integer(1, min(3, len(names)))]]
        powers = [(n, float(self.rng.choice(exponents))) for n in used]
        factor = self.uniform(0.3, 2.0)

        def formula(u: Unknowns) -> Any:
            result: Any = factor
            for n, p in powers:
                result = result * u[n] ** p
            return result

        return formula

    def posynomial(self, names: Sequence[str], terms: int = 3) -> Formula:
        return add(*(self.monomial(names) for _ in range(self.integer(2, terms))))

    def wave(self, name: str, periods: float = 1.5) -> Formula:
        """Return a sine over a range of a variable, from -1 to 1."""
        v = self.case.variables[name]
        pace, phase = self.uniform(0.6, 1.0) * 2 * np.pi * periods / (v.upper - v.lower), self.uniform(0, 6.28)
        function = np.sin if self.chance() else np.cos
        return lambda u: function(pace * u[name] + phase)

    def polynomial(self, name: str) -> Formula:
        """Return a polynomial of degree four with two minima inside the range of a variable."""
        v = self.case.variables[name]
        middle, half = (v.lower + v.upper) / 2 + self.uniform(-0.1, 0.1), (v.upper - v.lower) / 2
        tilt, depth = self.uniform(-0.3, 0.3), self.uniform(0.8, 1.2)

        def formula(u: Unknowns) -> Any:
            s = (u[name] - middle) / half
            return 4 * s**4 - 4 * depth * s**2 + tilt * s

        return formula


def add(*formulas: Formula) -> Formula:
    """Return the sum of formulas."""
    return lambda u: sum(f(u) for f in formulas)


def times(*formulas: Formula) -> Formula:
    """Return the product of formulas."""

    def formula(u: Unknowns) -> Any:
        result: Any = 1.0
        for f in formulas:
            result = result * f(u)
        return result

    return formula


def scaled(factor: float, formula: Formula, shift: float = 0.0) -> Formula:
    """Return factor times the formula, plus a shift."""
    return lambda u: factor * formula(u) + shift


def of(function: Callable[..., Any], *formulas: Formula) -> Formula:
    """Return a function of formulas."""
    return lambda u: function(*(f(u) for f in formulas))


def ratio(over: Formula, under: Formula) -> Formula:
    """Return one formula over another."""
    return lambda u: over(u) / under(u)


# -- the structures -------------------------------------------------------------------------------


def _posynomial(b: Builder) -> None:
    """Log-convex: posynomials below bounds."""
    names = b.variables(b.integer(1, 3)) + b.slots(b.integer(1, 2)) + b.maybe_count()
    for k in range(b.integer(1, 3)):
        b.keeps(f"load_{k}", "at_most", b.posynomial(names), factor=True)
    b.keeps("least", "at_least", b.monomial(names), factor=True)
    b.objective("cost", b.posynomial(names))
    if b.case.seed % 2:
        b.objective("loss", b.posynomial(names))


def _three_objectives(b: Builder) -> None:
    """Three posynomials traded off, over few rows."""
    names = b.variables(2) + b.slots(1, (2, 4)) + b.maybe_count()
    b.keeps("load", "at_most", b.posynomial(names), factor=True)
    for name in ("cost", "loss", "size"):
        b.objective(name, b.posynomial(names))
    b.case.gap, b.case.points = 2e-2, 6


def _signomial(b: Builder) -> None:
    """Differences of posynomials in limits and objectives."""
    names = b.variables(b.integer(1, 2)) + b.slots(b.integer(1, 2), (2, 4)) + b.maybe_count()
    b.keeps("net", "at_most", add(b.posynomial(names), scaled(-0.5, b.monomial(names))))
    b.keeps("reserve", "at_least", add(b.monomial(names), scaled(-0.4, b.posynomial(names))))
    difference = add(b.posynomial(names), scaled(-0.3, b.monomial(names)))
    b.objective("cost", of(np.maximum, difference, lambda u: 0.05) if b.chance(0.3) else difference)
    if b.case.seed % 2:
        b.objective("loss", b.posynomial(names))
    b.case.positive = False


def _denominators(b: Builder) -> None:
    """Sums below fraction bars."""
    names = b.variables(b.integer(1, 3)) + b.slots(1) + b.maybe_count()
    b.keeps("share", "at_most", ratio(b.monomial(names), b.posynomial(names)))
    b.keeps("series", "at_least", of(lambda p, q: 1 / (1 / p + 1 / q), b.posynomial(names), b.monomial(names)))
    b.objective("cost", add(ratio(b.posynomial(names), scaled(1.0, b.posynomial(names), 1.0)), b.monomial(names)))
    if b.case.seed % 2:
        b.objective("loss", ratio(b.monomial(names), add(b.monomial(names), b.monomial(names))))


def _products(b: Builder) -> None:
    """Rings and boxes: products of sums and differences of powers."""
    b.variable("x", 1.2, b.uniform(3, 5))  # outer
    b.variable("y", 0.3, b.uniform(1.8, 2.6))  # inner
    names = b.slots(b.integer(1, 2)) + b.maybe_count()
    wall = b.uniform(0.1, 0.3)
    b.case.limits["wall"] = Limit("at_least", lambda u: u["x"] - u["y"], lambda u: wall)
    k, extra = "rod.k", b.uniform(0.5, 2.0)
    size = "n" if "n" in names else "rod.s"
    b.keeps("stress", "at_most", lambda u: u[k] * extra * u["x"] / (u["x"] ** 4 - u["y"] ** 4), factor=True)
    b.keeps("room", "at_most", lambda u: (u["x"] + extra) * (u["x"] + 0.3 * u["y"] * u[size]))
    b.objective("cost", lambda u: u[k] * (u["x"] ** 2 - u["y"] ** 2) * (1 + 0.2 * u[size]))
    if b.case.seed % 2:
        b.objective("loss", lambda u: (u["x"] + extra * u[size]) / (u["x"] ** 2 + u["y"] ** 2))


def _waves(b: Builder) -> None:
    """Several local minima from sines."""
    names = b.variables(b.integer(1, 2))
    columns = b.slots(b.integer(0, 1), (2, 4)) + b.maybe_count()
    part = b.monomial(columns) if columns else (lambda u: 1.0)
    waves = [b.wave(n, 1.5) for n in names]
    b.keeps("beat", "at_most", add(times(part, waves[0]), *waves[1:]))
    b.objective("cost", add(scaled(0.4, times(part, b.wave("x", 2.0))), b.monomial(names, (0.5, 1)), part))
    if b.case.seed % 3 == 0:
        b.objective("loss", add(b.monomial(names, (-1, -0.5)), scaled(0.1, b.wave("x")), lambda u: 0.3))
    b.case.positive = False


def _polynomials(b: Builder) -> None:
    """Several local minima from polynomials over ranges that hold zero."""
    for name in "xy"[: b.integer(1, 2)]:
        b.variable(name, b.uniform(-3, -1), b.uniform(1, 3))
    names = list(b.case.variables)
    columns = b.slots(b.integer(0, 1), (2, 4)) + b.maybe_count()
    part = b.monomial(columns, (0.5, 1)) if columns else (lambda u: 1.0)
    product = times(*(lambda u, n=n: u[n] for n in names))
    b.keeps("sum", "at_least", add(part, scaled(0.5, product)))
    b.objective(
        "cost", add(times(part, b.polynomial("x")), *(b.polynomial(n) for n in names[1:]), scaled(0.2, product))
    )
    if b.case.seed % 2:
        shift = b.uniform(-1, 1)
        b.objective("loss", add(*(lambda u, n=n: (u[n] - shift) ** 2 for n in names), part))
    b.case.positive = False


def _signed(b: Builder) -> None:
    """Logarithms and differences: limits and objectives that may be negative, zero or change their sign."""
    names = b.variables(b.integer(1, 2), 0.2, 4.0) + b.slots(1, (2, 4)) + b.maybe_count()
    log = of(np.log, b.monomial(names))
    b.keeps("level", "at_most", add(log, scaled(-0.2, b.monomial(names, (0.5, 1)))))
    kind = b.case.seed % 4
    if kind == 0:
        b.objective("cost", add(log, b.monomial(names, (-1, 1))))
    elif kind == 1:
        aim = b.uniform(1, 2)
        b.objective("cost", lambda u: (u["x"] * u["rod.k"] - aim) ** 2)  # zero is reached
        b.objective("loss", of(np.log, b.posynomial(names)))
    elif kind == 2:
        b.objective("cost", add(b.monomial(names, (1,)), scaled(-1.0, b.monomial(names, (1,)))))
        b.objective("loss", add(b.monomial(names), scaled(-0.8, b.monomial(names))))
    else:
        b.objective("cost", of(lambda p, q: np.sqrt(p) - np.log(1 + q) - 2.0, b.posynomial(names), b.monomial(names)))
    b.case.positive = False


def _equality(b: Builder) -> None:
    """An equality fixes a variable; by declaration or by the question."""
    b.variable("x", b.uniform(0.4, 0.8), b.uniform(3, 5))
    free = ["x"]
    if b.chance():
        b.variable("z", 0.5, b.uniform(2, 3))
        free.append("z")
    b.variable("y", 0.05, b.uniform(6, 12))
    columns = b.slots(1) + b.maybe_count()
    level, kind = b.uniform(2, 4), b.case.seed % 3
    if kind == 0:

        def balance(u: Unknowns) -> Any:
            return u["x"] * u["y"] * u["rod.k"]

        b.case.solved["y"] = lambda u: level / (u["x"] * u["rod.k"])
    elif kind == 1:

        def balance(u: Unknowns) -> Any:
            return u["y"] + u["rod.k"] * np.sin(u["x"])

        b.case.solved["y"] = lambda u: level - u["rod.k"] * np.sin(u["x"])
    else:

        def balance(u: Unknowns) -> Any:
            return u["y"] ** 2 + u["rod.k"] * u["x"]

        b.case.solved["y"] = lambda u: np.sqrt(np.maximum(level - u["rod.k"] * u["x"], 0.0))
    if b.case.seed % 2:
        b.case.limits["balance"] = Limit("equal", balance, lambda u: level)
    else:
        b.derive("balance", balance)
        if b.chance():
            b.case.fix["balance"] = level
        else:
            b.case.asked.append(("balance", "equal", level))
    names = free + columns
    b.keeps("load", "at_most", b.posynomial(names), factor=True)
    b.objective("cost", add(b.posynomial(names), lambda u: 0.5 * u["y"]))
    if b.chance(0.3):
        b.objective("loss", add(b.monomial(names), lambda u: u["x"] / (1 + u["y"])))


def _maximised(b: Builder) -> None:
    """Objectives to be made large, alone or against one to be made small."""
    names = b.variables(b.integer(1, 2)) + b.slots(b.integer(1, 2), (2, 4)) + b.maybe_count()
    b.keeps("load", "at_most", b.posynomial(names), factor=True)
    kind = b.case.seed % 3
    if kind == 0:
        b.objective("gain", b.posynomial(names), "max")
    elif kind == 1:
        b.objective("efficiency", of(lambda p, q: p / (p + q), b.monomial(names), b.posynomial(names)), "max")
        b.objective("cost", b.posynomial(names))
    else:
        b.objective("gain", add(b.monomial(names), scaled(-0.7, b.monomial(names))), "max")
        b.objective("life", of(np.log, b.posynomial(names)), "max")
    b.case.positive = False


def _infeasible(b: Builder) -> None:
    """No design, or hardly one: limits that contradict each other by a little or by much."""
    b.variable("x", 0.3, 5.0)
    b.variable("y", 0.3, 5.0)
    columns = b.slots(b.integer(1, 2), (2, 4)) + b.maybe_count()
    factor = (0.5, 0.9, 0.98, 0.999, 1.001, 1.03)[b.case.seed % 6]
    kind = b.case.seed % 4
    rows = b.case.tables["table_rod"]
    if kind == 0:  # a x/y + b y/x >= 2 sqrt(a b), reached at y/x = sqrt(a/b) <= 2.3
        bound = factor * 2 * float(np.sqrt(rows["k"] * rows["s"]).min())
        b.case.limits["ratio"] = Limit(
            "at_most", lambda u: u["rod.k"] * u["x"] / u["y"] + u["rod.s"] * u["y"] / u["x"], lambda u: bound
        )
    elif kind == 1:  # x >= x_min and a x**2 <= bound, y free
        least = b.uniform(1, 2)
        bound = factor * least**2 * float(rows["k"].min())
        b.case.limits["reach"] = Limit("at_least", lambda u: u["x"] + 0.1 * np.sin(u["y"]), lambda u: least + 0.1)
        b.case.limits["heavy"] = Limit("at_most", lambda u: u["rod.k"] * u["x"] ** 2, lambda u: bound)
    elif kind == 2:  # x y >= p and x + y <= q, with q a little below 2 sqrt(p)
        product = b.uniform(2, 4)
        least = product * float(rows["k"].min())
        b.case.limits["area"] = Limit("at_least", lambda u: u["x"] * u["y"], lambda u: product * u["rod.k"])
        b.case.limits["girth"] = Limit("at_most", lambda u: u["x"] + u["y"], lambda u: factor * 2 * np.sqrt(least))
    else:  # two waves that never are low together
        pace = b.uniform(1.5, 2.5)
        scale = float(rows["k"].min())
        b.case.limits["sine"] = Limit(
            "at_most",
            lambda u: u["rod.k"] * (np.sin(pace * u["x"]) ** 2 + np.cos(pace * u["x"]) ** 2 + 0.05 * (u["y"] - 1) ** 2),
            lambda u: factor * scale,
        )
    b.objective("cost", b.posynomial(["x", "y", *columns]))
    if b.chance(0.3):
        b.objective("loss", b.monomial(["x", "y"]))


def _one_feasible(b: Builder) -> None:
    """Exactly one combination can meet the limits."""
    b.slots(b.integer(2, 3), (3, 5))
    kind = b.case.seed % 2
    slots = list(b.case.slots)
    product = times(*(lambda u, s=s: u[f"{s}.k"] for s in slots))
    products = sorted(np.prod(c) for c in itertools.product(*(b.case.tables[f"table_{s}"]["k"] for s in slots)))
    between = products[0] + b.uniform(0.1, 0.9) * (products[1] - products[0])
    if kind == 0:
        b.variable("x", 0.2, 6.0)  # product x + 1/x >= 2 sqrt(product)
        b.case.limits["narrow"] = Limit(
            "at_most", lambda u: product(u) * u["x"] + 1 / u["x"], lambda u: 2 * float(np.sqrt(between))
        )
        b.objective("cost", add(lambda u: u["x"], lambda u: u["rod.s"]))
        b.objective("loss", lambda u: (1 + u["disc.s"]) / u["x"])
    else:
        b.case.limits["narrow"] = Limit("at_most", product, lambda u: float(between))
        b.objective("cost", lambda u: u["rod.s"] + u["disc.s"])
        b.objective("loss", lambda u: u["rod.s"] / u["disc.s"])


def _discrete(b: Builder) -> None:
    """Counts and parts only."""
    names = b.slots(b.integer(1, 3), (2, 6)) + b.count(1, b.integer(3, 8))
    if b.chance(0.3):
        b.case.counts["n"] = tuple(np.arange(0.5, 4.1, 0.5))
    b.keeps("load", "at_most", b.posynomial(names))
    b.keeps("net", "at_least", add(b.monomial(names), scaled(-0.5, b.monomial(names))))
    b.objective("cost", b.posynomial(names))
    for name in ("loss", "size")[: b.case.seed % 3]:
        b.objective(name, b.posynomial(names), "max" if b.chance(0.2) else "min")
    b.case.gap, b.case.points = 1e-3, (30 if b.chance() else 4)
    b.case.positive = "max" not in b.case.objectives.values()


def _continuous(b: Builder) -> None:
    """No parts, no counts: only dimensions."""
    names = b.variables(b.integer(1, 3))
    kind = b.case.seed % 3
    if kind == 0:
        b.keeps("load", "at_most", b.posynomial(names), factor=True)
        b.objective("cost", b.posynomial(names))
        b.objective("loss", b.posynomial(names))
    elif kind == 1:
        b.keeps("net", "at_least", add(b.monomial(names), scaled(-0.5, b.posynomial(names))))
        b.objective("cost", add(ratio(b.monomial(names), b.posynomial(names)), b.monomial(names)))
    else:
        b.keeps("beat", "at_most", add(b.wave("x"), scaled(0.3, b.monomial(names))))
        b.objective("cost", add(b.monomial(names, (1, 2)), b.wave("x"), lambda u: 2.0))
        b.case.positive = False


def _choices(b: Builder) -> None:
    """Labels that the search decides, through values and through comparisons."""
    names = b.variables(b.integer(1, 2)) + b.slots(b.integer(0, 1), (2, 4))
    b.case.choices["mode"] = ("open", "closed", "mixed")[: b.integer(2, 3)]
    labels = b.case.choices["mode"]
    if b.chance():
        b.case.choices["side"] = ("left", "right")
    factors = {label: b.uniform(0.5, 2.0) for label in labels}
    loads = {label: b.posynomial(names) for label in labels}
    switch = b.uniform(1, 3)
    b.keeps("load", "at_most", lambda u: u["mode"].select({label: f(u) for label, f in loads.items()}))
    if "side" in b.case.choices:
        first, second = b.monomial(names), b.monomial(names)
        level = {"left": 1.0, "right": 0.0}
        b.keeps("side", "at_least", lambda u: np.where(u["side"].select(level) > 0.5, first(u), second(u)))
    base = b.posynomial(names)
    b.objective("cost", lambda u: base(u) * u["mode"].select(factors))
    if b.case.seed % 2:
        other = b.posynomial(names)
        b.objective("loss", lambda u: other(u) + np.where(u["x"] * u["mode"].select(factors) > switch, 0.5, 0.0))


def _pieces(b: Builder) -> None:
    """Pieces of formulas: where, min, max and abs in limits and objectives."""
    names = b.variables(b.integer(1, 2)) + b.slots(1, (2, 4)) + b.maybe_count()
    first, second, third = b.posynomial(names), b.monomial(names), b.posynomial(names)
    middle = b.uniform(1.5, 3.0)
    b.keeps("worst", "at_most", of(np.maximum, first, second))
    b.keeps("best", "at_least", of(np.minimum, third, b.monomial(names)))
    b.keeps("off", "at_most", of(lambda p: np.abs(p - middle), b.monomial(names)))
    regime = b.monomial(names)
    b.keeps("regime", "at_most", lambda u: np.where(u["x"] > middle, regime(u), 0.8 * regime(u) + 0.1))
    kind = b.case.seed % 3
    if kind == 0:
        b.objective("cost", lambda u: np.maximum(u["x"], middle) + np.abs(second(u) - 1) + 0.1)
    elif kind == 1:
        b.objective("cost", lambda u: np.where(second(u) < middle, first(u), first(u) + 0.5))
        b.objective("loss", lambda u: np.minimum(third(u), 2 * first(u) + 0.5))
    else:
        b.objective("cost", lambda u: np.clip(second(u), 0.5, middle) + 0.2 * u["x"])


def _optional(b: Builder) -> None:
    """Columns that some rows lack: limits that use them are void there."""
    names = b.variables(b.integer(1, 2)) + b.slots(b.integer(1, 2), (3, 6))
    rows = b.case.tables["table_rod"]
    allowed = np.round(b.rng.uniform(0.5, 4.0, len(rows)), 3)
    allowed[b.rng.random(len(rows)) < 0.4] = np.nan
    allowed[0] = np.nan if b.chance() else allowed[0]
    rows["allow"] = allowed
    b.case.optional.add("rod.allow")
    if b.chance(0.3):  # a column that all rows need: the row without it is left out
        rows.loc[len(rows) - 1, "s"] = np.nan
    b.keeps("load", "at_most", b.posynomial(["x"]), factor=True)
    hot, other = b.posynomial(names), b.monomial(names)
    b.case.limits["heat"] = Limit("at_most", hot, lambda u: u["rod.allow"], void_without=("rod.allow",))
    b.case.limits["flow"] = Limit(
        "at_least", lambda u: other(u) * u["rod.allow"], lambda u: 0.3, void_without=("rod.allow",)
    )
    b.objective("cost", b.posynomial(names))
    if b.case.seed % 2:
        b.objective("loss", b.posynomial(names))


def _guards(b: Builder) -> None:
    """Quantities that exist only where a guard holds."""
    b.variable("x", 0.3, 4.0)
    b.variable("y", 0.2, 3.0)
    b.slots(1, (2, 5))
    kind = b.case.seed % 4

    def reserve(u: Unknowns) -> Any:
        return u["rod.k"] * u["x"] - u["y"]

    if b.chance():
        b.case.limits["carries"] = Limit("at_least", lambda u: u["rod.k"] * u["x"], lambda u: u["y"], guard=True)
    else:
        b.case.limits["carries"] = Limit("at_least", reserve, lambda u: 0.0, guard=True)
    if kind == 0:  # what is left of the capacity is worth something only where there is any
        b.objective("gain", times(reserve, b.monomial(["y", "rod.s"], (0.5, 1))), "max", needs=("carries",))
        b.objective("cost", b.posynomial(["x", "rod.s"]))
        b.case.positive = False
    elif kind == 1:  # a root that does not exist beyond the guard
        b.derive("root", lambda u: np.sqrt(u["rod.k"] * u["x"] - u["y"]), needs=("carries",))
        bound = b.uniform(0.3, 0.9)
        b.case.limits["root"] = Limit("at_least", lambda u: np.sqrt(u["rod.k"] * u["x"] - u["y"]), lambda u: bound)
        b.objective("cost", add(b.posynomial(["x", "rod.s"]), lambda u: 1 / u["y"]))
    elif kind == 2:  # nothing but the guard keeps from what is best: the best is approached, not reached
        wanted = b.uniform(0.8, 1.6)
        b.case.limits["wanted"] = Limit("at_least", lambda u: u["y"], lambda u: wanted)
        b.objective("cost", lambda u: u["x"] * (1 + u["rod.s"]))
        if b.chance():
            b.objective("loss", lambda u: u["rod.k"] / u["y"])
    else:  # a logarithm of the ratio; the objective need not know of the guard

        def decay(u: Unknowns) -> Any:
            return -np.log(1 - u["y"] / (u["rod.k"] * u["x"]))

        b.derive("decay", decay, needs=("carries",))
        bound = b.uniform(0.5, 1.5)
        b.case.limits["decay"] = Limit("at_most", decay, lambda u: bound)
        b.objective("cost", b.monomial(["x", "rod.s"], (1, 2)))
        b.objective("gain", lambda u: u["y"] * u["rod.s"], "max")
        b.case.positive = False


def _refusals(b: Builder) -> None:
    """Pairs of rows, and rows with counts, that must not be combined."""
    names = b.slots(2, (3, 5)) + b.count(1, 4) + (b.variables(1) if b.chance() else [])
    pair, alone = b.uniform(0.8, 1.2), b.uniform(2.2, 2.4)
    b.case.refusals["pair"] = Refusal(lambda u: u["rod.k"] > pair * u["disc.k"], ("rod", "disc"))
    b.case.refusals["crowd"] = Refusal(lambda u: u["rod.s"] * u["n"] > 6, ("rod", "n"))
    least = {s: float(b.case.tables[f"table_{s}"]["k"].min()) for s in ("rod", "disc")}
    if least["rod"] <= alone:
        b.case.refusals["alone"] = Refusal(lambda u: u["rod.k"] > alone, ("rod",))
    b.keeps("load", "at_most", b.posynomial(names))
    b.objective("cost", b.posynomial(names))
    if b.case.seed % 2:
        b.objective("loss", b.posynomial(names))


def _gridded(b: Builder) -> None:
    """Makeable sizes only, or beside a continuous one."""
    whole = b.chance(0.6)
    b.variable("x", 1, 8, grid=tuple(np.arange(1, 8.01, 0.5)))
    b.variable("y", 0.5, 6, grid=tuple(sorted(set(np.round(b.rng.uniform(0.5, 6, 12), 2)))))
    if not whole:
        b.variable("z", 0.5, b.uniform(2, 4))
    names = [*b.case.variables, *b.slots(1, (2, 4)), *b.maybe_count()]
    b.keeps("load", "at_most", b.posynomial(names), factor=True)
    b.keeps("net", "at_least", add(b.monomial(names), scaled(-0.3, b.monomial(names))))
    b.objective("cost", b.posynomial(names))
    if b.case.seed % 2:
        b.objective("loss", b.posynomial(names))
    b.case.gap = 1e-3


def _grid_off(b: Builder) -> None:
    """The same sizes, but any value is asked for."""
    _gridded(b)
    b.case.grid = False
    b.case.gap = 1e-2


def _alternatives(b: Builder) -> None:
    """Rows that are equal in all that is used: one point of the front, the others named."""
    b.slots(2, (2, 3))
    for slot in b.case.slots:
        rows = b.case.tables[f"table_{slot}"]
        # Every rod has a twin, so that every design has an alternative.
        chosen = range(len(rows)) if slot == "rod" else [b.integer(0, len(rows) - 1) for _ in range(b.integer(1, 2))]
        twins = rows.iloc[chosen].copy()
        twins["designation"] = [f"{slot} twin {k}" for k in range(len(twins))]
        both = pd.concat([rows, twins], ignore_index=True)
        both["unused"] = np.round(b.rng.uniform(1, 2, len(both)), 3)
        b.case.tables[f"table_{slot}"] = both
    names = [f"{s}.{c}" for s in b.case.slots for c in "ks"] + (b.variables(1) if b.case.seed % 3 else [])
    b.keeps("load", "at_most", b.posynomial(names))
    b.objective("cost", b.posynomial(names))
    if b.case.seed % 2:
        b.objective("loss", b.posynomial(names))


def _asked(b: Builder) -> None:
    """Limits and pins of the question, in millimetres."""
    b.variable("x", 10.0, 80.0, unit="mm", factor=1e-3, grid=tuple(np.arange(10.0, 80.1, 2.0)))
    b.variable("y", 5.0, 60.0, unit="mm", factor=1e-3)
    b.slots(2, (3, 5))
    b.count(1, 6)
    b.case.choices["mode"] = ("open", "closed")
    stiff = {"open": 1.0, "closed": b.uniform(1.2, 2.0)}
    b.case.requirements["demand"] = b.uniform(0.5, 1.5)

    def area(u: Unknowns) -> Any:
        return 1e4 * u["x"] * u["y"] * u["n"]

    b.derive("area", area)
    b.derive("slender", lambda u: u["x"] / u["y"])
    b.keeps("stress", "at_most", lambda u: u["demand"] * u["rod.k"] / (area(u) * u["mode"].select(stiff)), factor=True)
    b.objective("mass", lambda u: area(u) * u["disc.k"] * (0.5 + u["rod.s"]) * u["mode"].select(stiff))
    if b.case.seed % 2:
        b.objective("loss", lambda u: u["disc.s"] / area(u) + u["x"] * 10)
    b.case.asked += [("y", "at_least", b.uniform(6, 12)), ("y", "at_most", b.uniform(30, 50))]
    b.case.asked += [("slender", "at_most", b.uniform(1.5, 3)), ("n", "at_most", float(b.integer(3, 5)))]
    if b.chance():
        b.case.asked.append(("area", "at_least", b.uniform(1, 8)))
    if b.chance():
        b.case.fix["x"] = b.uniform(20, 60)  # pins may lie off the grid
    if b.chance():
        b.case.fix["mode"] = "closed"
    if b.chance():
        b.case.fix["rod"] = "rod 1"
    if b.chance(0.3):
        b.case.fix["n"] = b.integer(1, 3)
    if b.chance():
        largest = float(b.case.tables["table_disc"]["k"].max())
        b.case.parts["disc"] = ["disc 0", "disc 2"] if b.chance() else f"k > {round(0.7 * largest, 3)}"


def _knife_edge(b: Builder) -> None:
    """Makeable values and rows that touch a limit, or miss it by less or by more than its tolerance."""
    b.variable("x", 1, 6, grid=tuple(np.arange(1, 6.01, 0.5)))
    b.slots(1, (2, 4), 1)
    b.count(1, 3)
    if traded := b.chance():
        b.variable("y", 0.5, 2.0)
    kind = b.case.seed % 4
    missed = (0.0, 5e-7, -3e-6, 3e-6)[kind]
    witness = {name: float(np.asarray(values)[0]) for name, values in b.cloud().items()}

    def value(u: Unknowns) -> Any:
        return u["x"] ** 2 * u["rod.k"] / u["n"]

    touched = float(value(witness))
    b.case.limits["touch"] = Limit("at_most", value, lambda u: touched / (1 + missed))
    b.case.limits["other"] = Limit("at_least", value, lambda u: touched * (1 - 1e-9))
    b.objective("cost", lambda u: 3 + u["rod.k"] - u["x"] / 10)
    if traded:
        b.keeps("free", "at_most", lambda u: u["y"] + 1 / u["y"])
        b.objective("loss", lambda u: u["y"] + u["rod.k"] / u["y"])
    b.case.gap = 1e-3


def _degenerate(b: Builder) -> None:
    """Objectives that are constant, variables that do not matter, limits without variables, pins of all."""
    names = b.variables(2) + b.slots(1, (2, 4)) + b.maybe_count()
    kind = b.case.seed % 5
    b.keeps("load", "at_most", b.posynomial(["x", "rod.k"]), factor=True)
    b.keeps("fit", "at_most", b.monomial(["rod.s"]), 0.6)
    if kind == 0:
        b.objective("cost", lambda u: 2.0 + 0.0 * u["x"])
        b.objective("loss", b.monomial(names))
    elif kind == 1:
        b.objective("cost", lambda u: u["rod.k"])
        b.objective("loss", lambda u: u["rod.s"])
    elif kind == 2:
        b.case.objectives["x"] = "min"
        b.case.objectives["y"] = "max"
        b.case.positive = False
    elif kind == 3:
        cost = b.posynomial(names)
        b.objective("cost", cost)
        b.objective("loss", lambda u: 2 * cost(u))
    else:
        b.objective("cost", b.posynomial(names))
        b.case.fix |= {n: b.uniform(0.8, 2.0) for n in ("x", "y")}


def _expressions(b: Builder) -> None:
    """Random formulas of all operations."""
    for name in "xy"[: b.integer(1, 2)]:
        low = b.uniform(-1.5, 0.5) if b.chance() else b.uniform(0.2, 1.0)
        b.variable(name, low, low + b.uniform(1.5, 3))
    names = [*b.case.variables, *b.slots(b.integer(0, 1), (2, 3)), *(b.count(-1, 2) if b.chance() else [])]
    for k in range(b.integer(1, 2)):
        b.keeps(f"limit_{k}", "at_most" if b.chance() else "at_least", _expression(b, names, 3), 0.4)
    b.objective("cost", add(_expression(b, names, 3), lambda u: 0.3 * u["x"]), "max" if b.chance(0.2) else "min")
    if b.case.seed % 2:
        b.objective("loss", add(_expression(b, names, 2), lambda u: 0.2 * u["x"]), "max" if b.chance(0.2) else "min")
    b.case.positive = False
    b.case.seconds = 2.0


def _expression(b: Builder, names: Sequence[str], depth: int) -> Formula:
    """Return a random formula that is finite everywhere."""
    if depth == 0 or b.chance(0.1):
        name, factor, shift = str(b.rng.choice(names)), b.uniform(0.5, 1.5), b.uniform(-1, 1)
        return lambda u: factor * u[name] + shift
    p, q = _expression(b, names, depth - 1), _expression(b, names, depth - 1)
    switch = b.uniform(-0.5, 0.5)
    forms: list[Formula] = [
        lambda u: p(u) + q(u),
        lambda u: p(u) - q(u),
        lambda u: p(u) * q(u),
        lambda u: p(u) / (0.5 + q(u) ** 2),
        lambda u: np.sqrt(np.abs(p(u)) + 0.1),
        lambda u: np.log(1.0 + p(u) ** 2),
        lambda u: np.exp(np.clip(p(u), -2, 2)),
        lambda u: np.sin(p(u)),
        lambda u: np.cos(p(u)) * q(u),
        lambda u: np.arctan(p(u)),
        lambda u: np.tanh(p(u)) + q(u),
        lambda u: np.maximum(p(u), q(u)),
        lambda u: np.minimum(p(u), q(u)),
        lambda u: np.abs(p(u) - q(u)),
        lambda u: np.where(p(u) > switch, p(u), q(u)),
        lambda u: np.hypot(p(u), q(u)),
        lambda u: np.clip(p(u), -2, 2) ** 3 / 4,
        lambda u: p(u) / (1.5 + np.sin(q(u))),
        lambda u: np.sinh(np.clip(p(u), -2, 2)) - np.cosh(np.clip(q(u), -1, 1)),
        lambda u: np.tan(np.clip(p(u), -1, 1)),
        lambda u: np.arcsin(np.clip(p(u), -0.9, 0.9)) + q(u),
        lambda u: np.arctan2(p(u), 0.5 + q(u) ** 2),
        lambda u: np.log1p(np.abs(p(u))) - np.expm1(np.clip(q(u), -1, 1)),
        lambda u: p(u) + 0.3 * np.floor(q(u)),
        lambda u: np.where(np.logical_and(p(u) > switch, q(u) < 1), 0.5 * p(u), q(u)),
    ]
    return forms[b.integer(0, len(forms) - 1)]


def _mixed(b: Builder) -> None:
    """A little of everything in one problem."""
    b.variable("x", 0.5, 4.0, **({"grid": tuple(np.arange(0.5, 4.01, 0.25))} if b.chance() else {}))
    b.variable("y", 0.4, 3.0)
    b.slots(2, (2, 4))
    b.count(1, 3)
    b.case.choices["mode"] = ("open", "closed")
    rows = b.case.tables["table_disc"]
    rows["allow"] = np.where(b.rng.random(len(rows)) < 0.4, np.nan, np.round(b.rng.uniform(0.5, 3, len(rows)), 3))
    b.case.optional.add("disc.allow")
    names = ["x", "y", "rod.k", "disc.k", "n"]
    factors = {"open": 1.0, "closed": b.uniform(0.6, 1.6)}

    def reserve(u: Unknowns) -> Any:
        return u["rod.s"] * u["x"] * u["n"] - u["y"]

    # A quarter of the problems bound the time only through a guard: there a search may stop without a proof.
    b.case.limits["carries"] = Limit("at_least", reserve, lambda u: 0.0, guard=True)
    if b.case.seed % 4:
        b.case.limits["reserve"] = Limit("at_least", reserve, lambda u: 0.1)
    else:
        b.case.seconds = 1.0
    b.objective("time", lambda u: u["y"] * u["mode"].select(factors) / reserve(u), needs=("carries",))
    b.objective("cost", add(b.posynomial(names), lambda u: np.maximum(u["x"] - 2, 0.0) + u["mode"].select(factors)))
    hot = b.monomial(["x", "y", "rod.k"])
    b.case.limits["heat"] = Limit("at_most", hot, lambda u: u["disc.allow"], void_without=("disc.allow",))
    b.keeps("net", "at_least", lambda u: u["y"] - 0.2 * u["x"] * u["disc.k"])
    b.case.refusals["pair"] = Refusal(lambda u: u["rod.k"] > 1.5 * u["disc.k"], ("rod", "disc"))


def _scales(b: Builder) -> None:
    """Sizes in millimetres, so that quantities in SI range from 1e-12 to 1e9."""
    b.variable("x", 4.0, b.uniform(20, 60), unit="mm", factor=1e-3)
    b.variable("y", 1.0, b.uniform(5, 20), unit="mm", factor=1e-3, **({"grid": (1, 2, 3, 5, 8)} if b.chance() else {}))
    b.slots(1, (2, 5))
    names = b.count(1, 3)

    def yield_point(u: Unknowns) -> Any:
        return 2e8 * u["rod.k"]

    def inertia(u: Unknowns) -> Any:
        return u[names[0]] * u["y"] * u["x"] ** 3 / 12

    witness = {n: v[0] for n, v in b.cloud().items()}
    moment = float(0.7 * yield_point(witness) * 2 * inertia(witness) / witness["x"])
    b.case.limits["stress"] = Limit("at_most", lambda u: moment * u["x"] / 2 / inertia(u), yield_point)
    b.keeps("stiff", "at_least", inertia, factor=True)
    b.keeps("slim", "at_most", lambda u: u["x"] / u["y"], factor=True)
    b.objective("mass", lambda u: 7800 * u["x"] * u["y"] * 0.01 * (0.5 + u["rod.s"]))
    kind = b.case.seed % 3
    if kind == 1:
        b.objective("inertia", inertia, "max")
        b.case.positive = False
    elif kind == 2:
        b.objective("inertia", inertia)


def _poles(b: Builder) -> None:
    """Formulas that have no finite value inside the box, where a limit lets nothing be."""
    half = b.uniform(1.5, 3)
    middle = 0.0 if b.chance() else b.uniform(-0.3, 0.3)
    b.variable("x", -half, half)
    names = b.slots(1, (2, 4)) + b.maybe_count()
    if b.chance():
        b.variable("y", 0.5, 2.0)
        names.append("y")
    kept = b.uniform(0.2, 0.8)

    def square(u: Unknowns) -> Any:
        return (u["x"] - middle) ** 2

    b.case.limits["clear"] = Limit("at_least", square, lambda u: kept)
    b.keeps("load", "at_most", add(b.posynomial(names), lambda u: 0.2 * u["x"]), 0.6)
    kind, factor = b.case.seed % 4, b.monomial(names, (0.5, 1))
    if kind == 0:
        b.objective("cost", lambda u: factor(u) / square(u) + 0.5 * np.abs(u["x"]) + 0.2 * u["x"])
    elif kind == 1:
        b.objective("cost", lambda u: factor(u) / (square(u) - 0.5 * kept) + 0.3 * u["x"])
        b.objective("loss", lambda u: np.log(square(u)) * factor(u))
    elif kind == 2:
        b.objective("cost", lambda u: factor(u) - np.log(square(u)) + 0.8 * square(u))
    else:
        b.objective("cost", lambda u: np.sqrt(square(u) - 0.9 * kept) + factor(u) / square(u))
    b.case.positive = False


@special((0.0, 1.0))
def saturating(load: Any) -> Any:
    """Return x/(1 + x)."""
    return load / (1 + load)


@special((-1.0, 0.0), (-1.0, 0.0))
def relief(first: Any, second: Any) -> Any:
    """Return 1/(1 + x y)."""
    return 1 / (1 + first * second)


def _special(b: Builder) -> None:
    """Special functions with declared elasticities."""
    names = b.variables(b.integer(1, 2)) + b.slots(1) + b.maybe_count()
    soft = of(saturating, b.posynomial(names))
    eased = of(relief, b.monomial(names), b.monomial(names))
    b.keeps("sag", "at_most", soft)
    b.keeps("play", "at_least", add(eased, scaled(0.1, b.monomial(names))))
    b.objective("cost", add(b.posynomial(names), of(relief, b.monomial(names), b.posynomial(names))))
    if b.case.seed % 2:
        b.objective("loss", times(soft, b.monomial(names)))


def _hard(b: Builder) -> None:
    """More than any search proves in a second: waves in three variables, three objectives, many rows."""
    names = b.variables(3) + b.slots(3, (6, 6)) + b.count(1, 8)
    b.keeps("beat", "at_most", add(*(times(b.wave(n, 4), b.monomial(names)) for n in "xyz")))
    for name in ("cost", "loss", "size"):
        b.objective(name, add(*(times(b.wave(n, 4), b.monomial(names)) for n in "xyz"), b.posynomial(names)))
    b.case.gap, b.case.points, b.case.positive = 1e-4, 300, False


STRUCTURES: dict[str, Callable[[Builder], None]] = {
    "posynomial": _posynomial,
    "three_objectives": _three_objectives,
    "signomial": _signomial,
    "denominators": _denominators,
    "products": _products,
    "waves": _waves,
    "polynomials": _polynomials,
    "signed": _signed,
    "equality": _equality,
    "maximised": _maximised,
    "infeasible": _infeasible,
    "one_feasible": _one_feasible,
    "discrete": _discrete,
    "continuous": _continuous,
    "choices": _choices,
    "pieces": _pieces,
    "optional": _optional,
    "guards": _guards,
    "refusals": _refusals,
    "gridded": _gridded,
    "grid_off": _grid_off,
    "alternatives": _alternatives,
    "asked": _asked,
    "knife_edge": _knife_edge,
    "degenerate": _degenerate,
    "expressions": _expressions,
    "mixed": _mixed,
    "scales": _scales,
    "special": _special,
    "poles": _poles,
    "hard": _hard,
}


@cache
def make(structure: str, seed: int) -> Case:
    """Return the case of a structure and a seed."""
    builder = Builder(structure, seed)
    STRUCTURES[structure](builder)
    return builder.case
