"""A small problem whose best parts over a range of loads are known in closed form, for tests of what-if studies."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from itertools import product
from typing import Any

import numpy as np
import pandas as pd

import synth
from synth.tables.catalogs import Catalogs

KEEPS = 1000.0  # kN: a rope that carries every load


class Ropes(synth.DesignProblem):
    """Ropes that are dear to buy or dear to load; how thick they are is chosen, in one way or another."""

    name, title = "ropes", "Ropes"
    sources = ("made up",)

    def declare(self, d: Any) -> None:
        thick = d.option("thick", ("free", "makeable", "given"), "free")
        price = d.option("price", ("fixed", "indexed"), "fixed")
        load = d.requirement("load", "kN", lower=0.5, upper=500, symbol="F")
        share = d.requirement("share", "-", 1, lower=0.1, upper=10)
        income = d.requirement("income", "-", 50, lower=0, upper=1000)
        jolt = d.requirement("jolt", "kN", 1.25 * load, lower=0.5, upper=1000)
        d.requirement("idle", "-", 1, lower=0, upper=100)
        most = d.requirement("most_cost", "-", lower=0, upper=1e4, optional=True)
        index = d.requirement("index", "-", 1.5, lower=0.5, upper=2) if price == "indexed" else 1.0
        rope = d.part("rope", "ropes")
        strands = d.count("strands", 1, 3)
        end = d.choice("end", ("knot", "clamp"))
        if thick == "given":
            strength = load
        else:
            strength = d.variable("strength", "kN", 0.5, 600, grid=0.5 if thick == "makeable" else None)
            d.at_least("hold", strength, load, "kN")
        ends = end.select({"knot": 1.0, "clamp": 1.5})
        cost = rope.fixed * share * strands * ends * index + rope.rate * strength / 1e3
        d.derive("cost", "-", cost)
        d.derive("gain", "-", income - cost)
        d.derive("loss", "-", cost - income)
        d.derive("bulk", "-", strands / rope.fixed)
        d.at_most("carry", load, rope.most * (1 + (strands - 1) / 4), "kN")
        d.at_most("jerk", jolt, rope.jolt, "kN")
        if most is not None:
            d.at_most("budget", cost, most, "-")
        # One over a slot and the load, one over slot, count and load, one over the load alone.
        d.refuse("worn", load > rope.worn, "a rope that wears less")
        d.refuse("bundle", np.logical_and(strands > 1, load > rope.bundle), "single strands for such loads")
        d.refuse("heavy", load > 400e3, "at most 400 kN")
        d.objective("cost")
        d.objective("gain", sense="max", default=False)
        d.objective("loss", default=False)
        d.objective("bulk", default=False)


LIMITS = ("most", "jolt", "worn", "bundle")  # loads in kN, or jolts, that a rope bears in one sense or another


def ropes(*rows: tuple[float, float], **limits: list[float]) -> Catalogs:
    """Return a table of ropes: fixed cost and cost per kN of each, and loads that it bears where they are given."""
    table = {
        "designation": [f"rope {'abcdefgh'[k]}" for k in range(len(rows))],
        "fixed [-]": [row[0] for row in rows],
        "rate [-]": [row[1] for row in rows],
        "source": ["made up"] * len(rows),
    }
    table |= {f"{name} [kN]": limits.get(name, [KEEPS] * len(rows)) for name in LIMITS}
    return Catalogs({"ropes": pd.DataFrame(table)})


@dataclass(frozen=True)
class Made:
    """The least cost, and what costs that."""

    cost: float
    made: tuple[tuple[str, float, str], ...]


def best_ropes(
    problem: synth.DesignProblem, r: Mapping[str, float], catalogs: Catalogs, grid: bool = True
) -> Made | None:
    """Return the cheapest ropes from the formulas, requirements being in SI; None where none will do.

    >>> best_ropes(Ropes(), {"load": 5e3, "jolt": 6e3, "share": 1.0}, ropes((10, 2), (20, 1)))
    Made(cost=20.0, made=(('rope a', 1.0, 'knot'),))
    """
    table, load = catalogs.table("ropes"), r["load"] / 1e3
    number = {name: table.number(name) for name in ("fixed", "rate")}
    bears = {name: table.number(name) / 1e3 for name in LIMITS}
    strength = max(load, 0.5)
    if problem.options.get("thick") == "makeable" and grid:
        strength = math.ceil(2 * strength - 1e-6) / 2
    found = []
    for k, n, (end, share) in product(range(len(table)), (1, 2, 3), (("knot", 1.0), ("clamp", 1.5))):
        cost = number["fixed"][k] * r["share"] * n * share * r.get("index", 1.0) + number["rate"][k] * strength
        held = load <= bears["most"][k] * (1 + (n - 1) / 4) and r["jolt"] / 1e3 <= bears["jolt"][k]
        refused = load > bears["worn"][k] or (n > 1 and load > bears["bundle"][k])
        if held and not refused and cost <= r.get("most_cost", math.inf):
            found.append((float(cost), (str(table.designations[k]), float(n), end)))
    least = min((cost for cost, _ in found), default=math.inf)
    made = tuple(words for cost, words in found if cost <= least + 1e-9 * abs(least))
    return Made(least, made) if found else None
