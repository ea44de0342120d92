"""A small problem with one of everything, for tests of instances, results and elasticities."""

import numpy as np
import pandas as pd

import synth
from synth.question.catalogs import catalogs_for
from synth.search.archive import Candidate
from synth.search.formulation import Formulation
from synth.search.settings import TUNING
from tests.asking import instance_of

RODS = pd.DataFrame(
    {
        "designation": ["soft", "hard", "odd"],
        "stress_allow [N/mm2]": [80.0, 160.0, None],
        "density [kg/m3]": [7850.0, 7850.0, 7900.0],
        "source": ["handbook", "handbook", "guess"],
    }
)
NEEDED = {"load": "20 kN"}


class Strut(synth.DesignProblem):
    """A bar in tension: mass against flexibility."""

    name, title = "strut", "Strut"
    sources = ("statics",)

    def declare(self, d):
        finish = d.option("finish", ("plain", "coated"), "plain", symbol="fin")
        load = d.requirement("load", "kN", lower=1, upper=100, symbol="F")
        room = d.requirement("room", "mm", lower=1, upper=500, optional=True, symbol="b_max")
        safety = d.requirement("safety", "-", 1.5, lower=1, upper=10, symbol="k")
        width = d.variable("width", "mm", 5, 200, grid=1, symbol="b")
        length = d.variable("length", "mm", 100, 300, symbol="L")
        plates = d.count("plates", 1, 4, symbol="n")
        end = d.choice("end", ("hook", "eye"), symbol="e")
        plate = d.part("plate", "core_plates", where="thickness >= 1 and thickness <= 4", symbol="pl")
        rod = d.part("material", "rods", symbol="mat")
        area = d.derive("area", "mm2", plates * width * plate.thickness, symbol="A")
        weight = 1.01 if finish == "coated" else 1.0
        d.derive("mass", "kg", rod.density * area * length * weight * end.select({"hook": 1.2, "eye": 1.1}), symbol="m")
        d.derive("flexibility", "-", 1e6 * length / (210e9 * area))
        d.at_most("stress", safety * load / area, rod.optional("stress_allow"), "N/mm2")
        d.at_least("reach", length, 0.1 + 0.02 * plates, "mm")
        if room is not None:
            d.at_most("room", width, room, "mm")
        d.objective("mass")
        d.objective("flexibility")
        d.objective("width", default=False)
        d.refuse("heavy_hook", load > 90e3, "at most 90 kN")
        d.advise("wide", width > 0.05, "a wide bar")


def strut_form(grid=True, tuning=TUNING, workers=1):
    """Return the problem ready to be searched."""
    problem = Strut()
    instance = instance_of(problem, NEEDED, catalogs_for(problem, {"rods": RODS}), grid=grid)
    return Formulation(
        instance, {"mass": "min", "flexibility": "min", "width": "min"}, 2, workers=workers, tuning=tuning
    )


def designs_of(form, rng, count):
    """Return random feasible makeable designs of random combinations, and phi."""
    share = rng.random((count, form.n))
    points = form.makeable.nearest(form.lower + share * (form.upper - form.lower))
    combinations = rng.integers(form.instance.combinations.count, size=count)
    rows, phi = form.points.feasible_rows(points, combinations)
    return points[rows], combinations[rows], phi[rows]


def lost(form, boxes, points, combinations):
    """Tell which designs no box holds."""
    held, digits = np.zeros(len(points), dtype=bool), form.instance.combinations.digits(combinations)
    for k in range(len(boxes)):
        low, high = boxes.low[k, : form.n] - 1e-9, boxes.high[k, : form.n] + 1e-9
        inside = np.all((points >= low) & (points <= high), axis=1)
        for f, tree in enumerate(form.boxes.cells.trees):
            inside &= np.isin(digits[f], tree.rows(int(boxes.cell[k, f])))
        held |= inside
    return ~held


def feasible_candidates(form, points, combinations):
    """Return those of some designs that are feasible, without the search learning of them."""
    rows, phi = form.points.feasible_rows(points, combinations)
    return [Candidate(int(combinations[k]), points[k].copy(), phi[k]) for k in rows]
