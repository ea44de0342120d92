"""Rows with empty cells: candidates where nothing asks for the value, else left out and named; beside enumeration."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from itertools import product
from typing import Any

import numpy as np
import pandas as pd
import pytest

import synth
from synth import DesignProblem
from synth.order.pareto import non_dominated
from tests.repetitions import repetitions

COLUMNS = ("a", "b", "c")  # a without an empty cell is needed; b and c may be empty, c may be zero or negative
LABELS = ("plain", "other")


@dataclass(frozen=True)
class Formula:
    """A quantity of two parts, a count, a choice and a variable; ``reads``: cells without which limits on it are void.

    ``needs``: slots of which column a is read.
    """

    compute: Callable[[Any], Any]
    reads: tuple[tuple[str, str], ...] = ()
    needs: tuple[str, ...] = ()


B1, C1, B2 = ("first", "b"), ("first", "c"), ("second", "b")
FORMULAS = (
    Formula(lambda x: x.a("first"), needs=("first",)),
    Formula(lambda x: x.a("first") * x.n + x.a("second"), needs=("first", "second")),
    Formula(lambda x: x.a("first") + x.v, needs=("first",)),
    Formula(lambda x: x.opt("first", "b"), (B1,)),
    Formula(lambda x: x.opt("first", "b") * x.n, (B1,)),
    Formula(lambda x: x.opt("first", "b") + x.opt("second", "b") * x.v, (B1, B2)),
    Formula(lambda x: 1.0 / x.opt("first", "c"), (C1,)),
    Formula(lambda x: x.n / x.opt("first", "c") + x.v, (C1,)),
    Formula(lambda x: np.sqrt(x.opt("first", "c")), (C1,)),
    Formula(lambda x: np.log(x.v - 1.0)),
    Formula(lambda x: 1.0 / (x.n - 1.0)),
    Formula(lambda x: x.select(x.opt("first", "b"), x.a("first")), (B1,), ("first",)),
    Formula(lambda x: np.where(x.opt("first", "c") > 1.0, x.opt("first", "b"), x.a("first")), (B1, C1), ("first",)),
    Formula(lambda x: np.where(x.v > 1.6, x.opt("first", "b"), 1.5 * x.v), (B1,)),
    Formula(lambda x: x.filled("second", "b", 2.25) + x.v),
    Formula(lambda x: np.maximum(x.opt("second", "b"), 2.0) * x.n, (B2,)),
)


@dataclass(frozen=True)
class Drawn:
    """A random question: tables, formulas of its quantities, limits, and what is asked of them."""

    tables: Mapping[str, pd.DataFrame]
    formulas: tuple[Formula, ...]
    family_limits: Mapping[int, float]
    limits: Mapping[int, float]
    objectives: tuple[int, ...]
    condition: str
    maximised: bool

    @staticmethod
    def random(rng: np.random.Generator) -> Drawn:
        """Return one."""
        tables = {}
        for name in ("firsts", "seconds"):
            rows = int(rng.integers(3, 7))
            cells: dict[str, Any] = {"designation": [f"{name[0]}{k}" for k in range(rows)]}
            for column in COLUMNS:
                numbers = rng.integers(-1 if column == "c" else 1, 9, rows) / 2
                empty = rng.random(rows) < (0.15 if column == "a" else 0.4)
                cells[f"{column} [-]"] = np.where(empty, np.nan, numbers)
            tables[name] = pd.DataFrame(cells)
        chosen = rng.choice(len(FORMULAS), 4, replace=False)
        limited = rng.permutation(4)
        return Drawn(
            tables=tables,
            formulas=tuple(FORMULAS[k] for k in chosen),
            family_limits={int(k): float(rng.integers(4, 24)) / 2 + 0.13 for k in limited[: rng.integers(0, 3)]},
            limits={int(k): float(rng.integers(4, 24)) / 2 + 0.13 for k in limited[2 : 2 + rng.integers(0, 2)]},
            objectives=tuple(int(k) for k in rng.choice(4, rng.integers(1, 3), replace=False)),
            condition="b < 3.3" if rng.random() < 0.25 else "",
            maximised=bool(rng.random() < 0.2),
        )


class Symbols:
    """What formulas read, as a declaration has it."""

    def __init__(self, d: Any) -> None:
        self.slots = {"first": d.part("first", "firsts"), "second": d.part("second", "seconds")}
        self.n, self.v = d.count("n", 1, 3), d.variable("v", "-", 1, 2, grid=0.5)
        self.choice = d.choice("kind", LABELS)

    def a(self, slot: str) -> Any:
        return self.slots[slot].a

    def opt(self, slot: str, column: str) -> Any:
        return self.slots[slot].optional(column)

    def filled(self, slot: str, column: str, value: float) -> Any:
        return self.slots[slot].filled(column, value)

    def select(self, plain: Any, other: Any) -> Any:
        return self.choice.select(dict(zip(LABELS, (plain, other), strict=True)))


@dataclass(frozen=True)
class Numbers:
    """What formulas read, as numbers of one design."""

    rows: Mapping[str, Mapping[str, Any]]
    n: float
    v: float
    kind: str

    def a(self, slot: str) -> Any:
        return np.float64(self.rows[slot]["a [-]"])

    def opt(self, slot: str, column: str) -> Any:
        return np.float64(self.rows[slot][f"{column} [-]"])

    def filled(self, slot: str, column: str, value: float) -> Any:
        cell = self.opt(slot, column)
        return value if np.isnan(cell) else cell

    def select(self, plain: Any, other: Any) -> Any:
        return plain if self.kind == LABELS[0] else other


class Asked(DesignProblem):
    """A random question as a problem."""

    name = "asked"

    def __init__(self, drawn: Drawn) -> None:
        super().__init__()
        self.drawn = drawn

    def declare(self, d: Any) -> None:
        """Declare the quantities, and all of them as objectives."""
        x, drawn = Symbols(d), self.drawn
        for k, formula in enumerate(drawn.formulas):
            value = d.derive(f"q{k}", "-", formula.compute(x))
            d.objective(f"q{k}", "max" if drawn.maximised else "min", default=k in drawn.objectives)
            if k in drawn.family_limits:
                d.at_most(f"limit{k}", value, drawn.family_limits[k], "-")


def designs_of(drawn: Drawn) -> list[tuple[Numbers, list[float], bool, bool]]:
    """Return all designs that conditions offer: numbers, objectives, whether all they ask for exists, and feasible."""
    needed = {slot for formula in drawn.formulas for slot in formula.needs}
    firsts, seconds = (drawn.tables[name].to_dict("records") for name in ("firsts", "seconds"))
    found = []
    for first, second, n, v, kind in product(firsts, seconds, (1, 2, 3), (1.0, 1.5, 2.0), LABELS):
        x = Numbers({"first": first, "second": second}, np.float64(n), np.float64(v), kind)
        if drawn.condition and not x.opt("first", "b") < 3.3:
            continue
        with np.errstate(all="ignore"):
            values = [float(formula.compute(x)) for formula in drawn.formulas]
        void = {k: any(np.isnan(x.opt(*cell)) for cell in drawn.formulas[k].reads) for k in drawn.family_limits}
        there = not any(np.isnan(x.a(slot)) for slot in needed)
        there &= all(np.isfinite(values[k]) for k in drawn.objectives)
        there &= all(np.isfinite(values[k]) for k in drawn.limits)
        kept = all(
            void[k] or (np.isfinite(values[k]) and values[k] <= bound) for k, bound in drawn.family_limits.items()
        )
        kept &= all(values[k] <= bound for k, bound in drawn.limits.items())
        found.append((x, [values[k] for k in drawn.objectives], there, there and kept))
    return found


@pytest.mark.slow
def test_random_tables_with_empty_cells_as_enumeration_says():
    rng, fronts, named, partial = np.random.default_rng(43), 0, 0, 0
    for _ in range(repetitions(40, 1500)):
        drawn = Drawn.random(rng)
        every = designs_of(drawn)
        asked = {
            "catalogs": dict(drawn.tables),
            "objectives": [f"q{k}" for k in drawn.objectives],
            "limits": {f"q{k}": f"<= {bound}" for k, bound in drawn.limits.items()},
            "parts": {"first": drawn.condition} if drawn.condition else {},
        }
        if not any(there for _, _, there, _ in every):
            with pytest.raises(synth.InputError, match=r"no value in column|not a finite number|table firsts"):
                synth.synthesize(Asked(drawn), {}, points=200, **asked)
            named += 1
            continue
        front = synth.synthesize(Asked(drawn), {}, points=200, **asked)
        sense = -1.0 if drawn.maximised else 1.0
        feasible = np.array([sense * np.array(objectives) for _, objectives, _, yes in every if yes])
        best = np.unique(feasible[non_dominated(feasible)].round(9), axis=0) if len(feasible) else feasible
        found = np.array([[sense * d.objectives[f"q{k}"] for k in drawn.objectives] for d in front.designs])
        # A value that is zero in all designs has no share that could be proven: the amount that is stays above it.
        zero = len(best) > 0 and bool(np.any(np.abs(best).max(axis=0) == 0.0))
        if not (zero and front.certificate.kind == "heuristic"):
            assert (front.certificate.kind, front.complete) == ("global", len(best) > 0), (drawn, front.certificate)
        assert len(found) == len(best), (drawn, found, best)
        if len(best):
            np.testing.assert_allclose(
                np.unique(found.round(9), axis=0), best, rtol=1e-6, atol=1e-9, err_msg=str(drawn)
            )
            fronts += 1
        verification = front.verify()
        assert verification.holds, (drawn, verification.sentence(), verification.findings)
        gone = {(row["slot"], row["designation"]) for row in front.statistics["rows_left_out"]}
        for slot, table in (("first", "firsts"), ("second", "seconds")):
            for designation in drawn.tables[table]["designation"]:
                own = [yes for x, _, yes, _ in every if x.rows[slot]["designation"] == designation]
                if own and not any(own):
                    assert (slot, designation) in gone, (drawn, designation)
                if any(own):
                    assert (slot, designation) not in gone, drawn
                    partial += not all(own)
        named += bool(gone)
    assert min(fronts, named, partial) > 10


class Unit(DesignProblem):
    """A part of which the mass need not be known."""

    name = "unit"

    def declare(self, d: Any) -> None:
        """Declare a part that stands a load, as small as may be."""
        load, unit = d.requirement("load", "N*m", lower=0.1, upper=100), d.part("unit", "units")
        d.derive("mass", "kg", unit.optional("mass"))
        d.derive("outer_diameter", "mm", unit.diameter)
        d.at_least("torque", unit.torque, load, "N*m")
        d.objective("outer_diameter")
        d.objective("mass", default=False)


UNITS = pd.DataFrame(
    {"designation": ["A", "B"], "torque [N*m]": [10.0, 8.0], "mass [kg]": [None, 4.0], "diameter [mm]": [80.0, 85.0]}
)
NEEDED = "no value in column mass, which mass needs"


@pytest.mark.parametrize(
    ("asked", "listed", "reason"),
    [
        ({}, "A", ""),
        ({"objectives": ["mass"]}, "B", NEEDED),
        ({"objectives": ["outer_diameter", "mass"]}, "B", NEEDED),
        ({"limits": {"mass": "<= 5 kg"}}, "B", NEEDED),
        ({"limits": {"mass": ">= 1 kg"}}, "B", NEEDED),
        ({"parts": {"unit": "mass < 5"}}, "B", "no value in column mass, which the condition mass < 5 asks for"),
        ({"parts": {"unit": "mass < 5 or torque > 9"}}, "A", ""),
        ({"parts": {"unit": "mass < 5 and torque > 11 or torque < 9"}}, "B", ""),
    ],
)
def test_a_row_without_a_value_is_a_candidate_or_is_named(asked: dict[str, Any], listed: str, reason: str) -> None:
    front = synth.synthesize(Unit, {"load": "5 N*m"}, catalogs={"units": UNITS}, **asked)
    assert [str(design.parts["unit"]) for design in front.designs] == [listed]
    named = [{"slot": "unit", "designation": "A", "reason": reason}] if reason else []
    assert front.statistics["rows_left_out"] == named
    assert front.certificate.kind == "global"
    assert front.verify().holds


def test_where_every_row_lacks_a_value_the_column_is_named() -> None:
    with pytest.raises(
        synth.InputError, match=r"unit: got 'A'; expected one with which mass can be computed \(no value"
    ):
        synth.synthesize(Unit, {"load": "9 N*m"}, ["mass"], catalogs={"units": UNITS[:1]})
