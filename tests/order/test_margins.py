"""Ends are moved outward whatever their sign: no makeable, pinned or thin range is lost."""

import numpy as np
import pytest

import synth
from synth.kernels.loading import best_variant
from synth.order.margins import above, below, within
from synth.question.catalogs import catalogs_for
from synth.question.settings import SearchSettings
from synth.search.formulation import Formulation
from synth.search.question import one_best
from tests.asking import instance_of

BUILT = pytest.mark.skipif(best_variant("boxes") is None, reason="no kernel was built")
COMPILED = [False, pytest.param(True, marks=BUILT)]


@pytest.fixture(params=COMPILED, ids=["arrays", "kernel"])
def code(request, monkeypatch):
    """Take boxes over arrays, or by the kernel."""
    monkeypatch.setenv("CLUTCHSYNTH_NATIVE", "1" if request.param else "0")


class Tilt(synth.DesignProblem):
    """An angle of both signs with makeable values."""

    name, title, sources = "tilt", "Tilt", ("none",)

    def declare(self, d):
        angle = d.variable("angle", "deg", -10, 10, grid=2.5)
        width = d.variable("width", "-", -3.0, -1.0)
        d.at_most("tilted", angle, -0.06, "rad")
        d.derive("cost", "-", 5 + 10 * angle + width**2)
        d.derive("lean", "-", angle * width)
        d.objective("cost")
        d.objective("lean", default=False)


class Pole(synth.DesignProblem):
    """A quotient whose divisor is zero inside the range."""

    name, title, sources = "pole", "Pole", ("none",)

    def declare(self, d):
        x = d.variable("x", "-", -3, -1.5)
        z = d.variable("z", "-", 0.5, 1)
        d.derive("cost", "-", z / (x + 1.5))
        d.objective("cost")


def test_ends_of_any_sign_move_outward():
    ends = np.array([-np.inf, -2.0, -1e-300, 0.0, 1e-300, 2.0, np.inf])
    assert np.all(below(ends, 1e-9) <= ends)
    assert np.all(above(ends, 1e-9) >= ends)
    assert below(ends, 1e-9)[[1, 5]] == pytest.approx([-2 - 2e-9, 2 - 2e-9], abs=1e-15)
    assert below(0.0, 1e-9, 1e-12) == -1e-12
    assert above(0.0, 1e-9, 1e-12) == 1e-12
    assert within(-2.0 - 1e-9, -2.0, -1.0, 1e-9)
    assert not within(-2.0 - 5e-9, -2.0, -1.0, 1e-9)


@pytest.mark.parametrize("pinned", [None, -5.0, -10.0, -3.75])
@pytest.mark.usefixtures("code")
def test_negative_makeable_and_pinned_values_are_found(pinned):
    front = synth.synthesize(Tilt, {}, points=1, fix={} if pinned is None else {"angle": pinned})
    assert front.status.value == "optimal"
    assert np.rad2deg(front.designs[0].values["angle"]) == pytest.approx(-10.0 if pinned is None else pinned)
    assert front.verify().holds


@pytest.mark.usefixtures("code")
def test_a_front_of_negative_makeable_values_is_whole():
    front = synth.synthesize(Tilt, {}, objectives=["cost", "lean"], points=10)
    assert front.certificate.kind == "global"
    angles = {round(float(np.rad2deg(d.values["angle"])), 6) for d in front.designs}
    assert angles == {-10.0, -7.5, -5.0}
    assert front.verify().holds


@pytest.mark.usefixtures("code")
def test_thin_boxes_of_any_sign_are_kept_and_split():
    form = Formulation(
        instance_of(synth.load(Tilt), {}, catalogs_for(synth.load(Tilt), None), grid=False), {"cost": "min"}, 1
    )
    size = 4096
    rng = np.random.default_rng(0)
    middle = np.stack([rng.uniform(-0.17, -0.07, size), rng.uniform(-2.9, -1.1, size)], axis=1)
    half = np.abs(middle) * 10.0 ** rng.uniform(-16, -6, (size, 1))
    boxes = form.boxes.leaves(np.zeros(size, dtype=np.int64), middle - half, middle + half)
    kept = form.boxes.contract(boxes, np.full(len(form.goals), np.inf))
    assert len(kept) == size
    assert np.all((kept.low <= middle * (1 - 1e-12)) & (kept.high >= middle * (1 + 1e-12)))


def test_what_falls_without_end_beside_a_pole_is_not_proven():
    problem = synth.load(Pole)
    instance = instance_of(problem, {}, catalogs_for(problem, None))
    front = one_best(instance, "cost", SearchSettings(points=1), 3000)
    assert front.statistics["boxes"] > 3000
    assert front.certificate.kind != "global"


class Cube(synth.DesignProblem):
    """A cube of a size below zero."""

    name, title, sources = "cube", "Cube", ("none",)

    def declare(self, d):
        x = d.variable("x", "-", -3, -1)
        d.derive("volume", "-", x**3)
        d.objective("volume")


@pytest.mark.filterwarnings("error")
def test_a_size_below_zero_is_found_from_what_it_gives():
    design = synth.evaluate(Cube, {}, values={"volume": -8.0})
    assert design.values["x"] == pytest.approx(-2.0, rel=1e-12)
