"""Searching few combinations to the bottom where hardly any design is known."""

from __future__ import annotations

import numpy as np
import pandas as pd
import pytest

import synth
from synth.question.catalogs import catalogs_for
from synth.search.budget import Clock
from synth.search.formulation import Formulation
from synth.search.large_neighbourhood import large_neighbourhood_search
from tests.asking import instance_of

WIDTHS = np.round(np.geomspace(1.0, 8.0, 25), 2)
ROWS = pd.DataFrame({"designation": [f"r{k}" for k in range(25)], "width [-]": WIDTHS})


class Fits(synth.DesignProblem):
    """Two bars and two lengths in coarse steps that must nearly fit: good optima are hardly ever makeable."""

    name, title = "fits", "Fits"

    def declare(self, d):
        bars = [d.part(name, "rows") for name in ("first", "second")]
        lengths = [d.variable(f"length_{k}", "-", 1, 10, grid=0.5) for k in (1, 2)]
        areas = [bar.width * length for bar, length in zip(bars, lengths, strict=True)]
        d.at_least("area", areas[0], 20, "-")
        d.at_most("close", areas[1], areas[0] * 1.01, "-")
        d.at_least("not_less", areas[1], areas[0], "-")
        d.derive("mass", "kg", bars[0].width + bars[1].width + 0.1 * lengths[0] + 0.2 * lengths[1])
        d.derive("length", "-", lengths[0] + lengths[1])
        d.objective("mass")
        d.objective("length")


def every_design():
    steps = np.arange(1.0, 10.25, 0.5)
    first, second, one, two = np.meshgrid(WIDTHS, WIDTHS, steps, steps, indexing="ij")
    area, other = first * one, second * two
    keep = (area >= 20) & (other >= area) & (other <= 1.01 * area)
    return (first + second + 0.1 * one + 0.2 * two)[keep], (one + two)[keep]


@pytest.mark.parametrize("seed", range(3))
def test_turns_come_near_the_best_and_keep_only_feasible_designs(seed):
    problem, rng = Fits(), np.random.default_rng(seed)
    instance = instance_of(problem, {}, catalogs_for(problem, {"rows": ROWS}))
    form = Formulation(instance, {"mass": "min", "length": "min"}, 2)
    points = form.makeable.nearest(form.lower + rng.random((20000, 2)) * (form.upper - form.lower))
    own = rng.integers(instance.combinations.count, size=len(points))
    rows, phi = form.points.feasible_rows(points, own)
    worst = rows[[int(np.argmax(phi[rows, 0]))]]
    form.archive.add(own[worst], points[worst], phi[worst])
    large_neighbourhood_search(form, [0, 1], np.full(2, 1e-3), Clock(), rng)
    archive = form.archive
    assert len(form.points.feasible_rows(archive.variables, archive.combination)[0]) == len(archive)
    mass, length = every_design()
    assert np.exp(archive.phi[:, 0].min()) == pytest.approx(mass.min(), rel=0.02)
    assert np.exp(archive.phi[:, 1].min()) == pytest.approx(length.min(), rel=0.02)
