"""What a claim says of objectives that may be zero: an amount, told and kept."""

import json
import math
from dataclasses import replace

import numpy as np
import pytest

import synth
from synth.declaration import DeclarationError
from synth.results.certificate import in_words
from synth.search import resolution
from synth.search.resolution import FINEST, gap_tolerance, goal_scales, ranges, rounded_up


class Fit(synth.DesignProblem):
    """A squared mismatch whose optimum is zero, and a lift of any sign."""

    name, title, sources = "fit", "Fit", ("none",)
    told = None

    def declare(self, d):
        x = d.variable("x", "mm", -3, 3)
        y = d.variable("y", "-", 0.5, 2)
        lift = d.derive("lift", "mm", x * y)
        d.derive("mismatch", "mm2", (lift - 0.0013) ** 2)
        d.derive("length", "mm", 0.004 + x)
        d.objective("mismatch", resolution=self.told)
        d.objective("lift", "max", default=False)
        d.objective("length", default=False)


class Coarse(Fit):
    """The same with a resolution of its own."""

    name, told = "coarse_fit", 0.01


class Fine(Fit):
    """The same with a resolution far below the usual size."""

    name, told = "fine_fit", 1e-10


def better_than(front, amounts):
    """Return the objectives of random designs that are better than a listed one by more in every objective."""
    rng = np.random.default_rng(0)
    names = list(front.frame.objectives)
    signs = np.array([1.0 if s == "min" else -1.0 for s in front.frame.objectives.values()])
    y = rng.uniform(0.5, 2.0, 200_000)
    x = np.clip(1.3e-3 / y + rng.normal(size=len(y)) * 10.0 ** rng.uniform(-12, -2, len(y)), -3e-3, 3e-3)
    values = {"lift": x * y, "mismatch": (x * y - 1.3e-3) ** 2, "length": 4e-3 + x}
    every = signs * np.stack([values[n] for n in names], axis=1)
    listed = signs * np.array([[d.objectives[n] for n in names] for d in front.designs])
    room = np.array([amounts.get(n, math.nan) for n in names])
    room = np.where(np.isnan(room), front.certificate.gap * np.abs(listed), room)
    return every[np.any(np.all(every[:, None, :] < (listed - room)[None, :, :] - 1e-18, axis=2), axis=1)]


@pytest.mark.slow
@pytest.mark.parametrize(("problem", "most"), [(Fit, 1e-12), (Coarse, 0.01e-6), (Fine, 1e-16)])
def test_a_mismatch_is_proven_to_the_amount_that_is_told(problem, most):
    front = synth.synthesize(problem, {}, points=1)
    told = front.certificate.resolution["mismatch"]
    assert front.certificate.kind == "global"
    found = front.designs[0].objectives["mismatch"]
    assert 0 <= found <= told <= most * (1 + 1e-9)
    assert told > 0 or found == 0
    assert not len(better_than(front, {"mismatch": told}))


def test_a_resolution_that_is_declared_is_the_one_that_counts():
    assert synth.synthesize(Coarse, {}).certificate.resolution == {"mismatch": pytest.approx(0.01e-6)}
    assert synth.synthesize(Fine, {}).certificate.resolution == {"mismatch": pytest.approx(1e-10 * 1e-6)}


def test_the_amount_is_told_in_the_unit_of_the_objective(tmp_path):
    front = synth.synthesize(Coarse, {})
    told = "0.1 % in every objective (differences below 0.01 mm² in mismatch do not count)"
    assert told in front.certificate.sentence()
    record = json.loads((front.save(tmp_path) / "front.json").read_text())["certificate"]
    assert record["units"] == {"mismatch": "mm2"}
    assert record["resolution"] == dict(front.certificate.resolution)
    again = synth.load_front(tmp_path)
    assert again.certificate == front.certificate


@pytest.mark.slow
@pytest.mark.parametrize("objectives", [["mismatch", "lift"], ["mismatch", "lift", "length"], ["lift"], ["length"]])
@pytest.mark.parametrize("points", [1, 4])
def test_what_may_be_zero_or_is_made_large_has_an_amount(objectives, points):
    front = synth.synthesize(Fit, {}, objectives=objectives, points=points, gap=0.01)
    assert front.certificate.kind == "global"
    assert set(front.certificate.resolution) == set(objectives) - {"length"}
    assert not len(better_than(front, front.certificate.resolution))
    found = front.verify(Fit)
    assert found.holds, found.findings
    assert found.amounts == front.certificate.amounts() != "" or objectives == ["length"]


def test_verify_takes_the_amount_that_is_told_and_asks_for_one():
    front = synth.synthesize(Coarse, {})
    best = front.designs[0].objectives["mismatch"]
    assert best > 0  # it was not sought further than the resolution
    finer = _with(front, {"mismatch": best / 2}).verify(Coarse)
    assert any("is wrong" in x for x in finer.findings), finer
    front = synth.synthesize(Fit, {}, objectives=["mismatch", "lift"], points=3, gap=0.01)
    own = front.certificate.resolution
    for wrong in ({"mismatch": own["mismatch"]}, {**own, "lift": -1.0}, {**own, "lift": 0.0}):
        found = _with(front, wrong).verify(Fit)
        assert any("does not tell by how much lift must be better" in x for x in found.findings)


def _with(front, told):
    return replace(front, certificate=replace(front.certificate, resolution=told))


def test_fewer_designs_than_objectives_are_not_called_the_only_ones():
    front = synth.synthesize(Fit, {}, objectives=["mismatch", "lift"], points=1)
    assert [d.note for d in front.designs] == [""]
    assert not front.complete
    assert front.verify(Fit).holds
    alone = synth.synthesize(Fit, {}, objectives=["length", "mismatch"], points=2, fix={"x": "1 mm", "y": 1.5})
    assert [d.note for d in alone.designs] == ["only non-dominated design"]
    assert alone.complete


def test_a_resolution_must_be_an_amount():
    class Wrong(Fit):
        """None at all."""

        told = 0.0

    with pytest.raises(DeclarationError, match="resolution"):
        synth.describe(Wrong)


def test_no_claim_is_finer_than_what_settling_ties_gives_away():
    log, sizes = np.array([True, False, False]), np.array([1.0, 5.0, 5.0])
    units, finest = goal_scales(log, sizes, [1e-3, None, 1e-12])
    assert finest.tolist() == [0.0, FINEST, FINEST]
    assert np.allclose(units * finest, [0.0, 5 * FINEST, 1e-12])
    distance = gap_tolerance(1e-3, log, finest, np.array([1.0, 0.0, 1e3]))
    assert distance == pytest.approx(
        [-math.log1p(-1e-3), FINEST - resolution.ROUNDING, 1.0 - resolution.ROUNDING], rel=1e-12
    )
    assert ranges(np.array([[1.0, 2.0], [4.0, 2.0]])).tolist() == [3.0, 2.0]


@pytest.mark.parametrize("unit", ["mm2", "-", "degC", "N*m", "%"])
def test_three_digits_tell_an_amount_that_is_not_less(unit):
    for amount in 10.0 ** np.linspace(-14, 3, 60):
        up = rounded_up(float(amount), unit)
        assert amount <= up * (1 + 1e-12)
        assert up <= 1.011 * amount
    assert ("K" in in_words({"a": 1.0}, {"a": unit})) == (unit == "degC")
