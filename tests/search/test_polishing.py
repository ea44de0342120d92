"""What the best design in one objective leaves free is settled by the other objectives, makeable values included."""

from dataclasses import replace

import numpy as np
import pytest

import synth
from synth import DesignProblem
from synth.errors import DeclarationError
from synth.search.archive import Candidate
from synth.search.box_operations import BoxOperations
from synth.search.joint.joint_search import JointSearch
from synth.search.polishing import polish_discrete
from synth.search.settings import TUNING, PolishingLimits
from tests.asking import pose
from tests.sample_problems.strut import RODS, Strut, feasible_candidates
from tests.tuned import synthesize, tuned

TIE = TUNING.tolerances.tie


class Beam(DesignProblem):
    """A clamped beam with a cover: the deflection does not see the cover, which only weighs."""

    name, title, sources = "covered_beam", "Covered beam", ("textbook",)

    def declare(self, d):
        load = d.requirement("load", "kN", 1, lower=0.1, upper=10)
        height = d.variable("height", "mm", 20, 90, grid=1)
        width = d.variable("width", "mm", 10, 40)
        cover = d.variable("cover", "mm", 2, 12, grid=0.5)
        clamp = d.variable("clamp", "N", 10, 1e5)
        d.derive("deflection", "mm", load * 1e-9 / (width * height**3) * (1 + clamp / 1e5))
        d.derive("mass", "kg", 7850 * height * (width + cover))
        d.at_most("slenderness", height, 3.5 * width, "mm")
        d.at_least("hold", clamp * height, load / 2, "N*m")
        d.objective("deflection")
        d.objective("mass")


@pytest.mark.parametrize("points", [6, 30])
def test_the_stiffest_beam_has_no_cover_that_only_weighs(points):
    front = synth.synthesize(Beam, {}, points=points)
    assert front.certificate.kind == "global"
    stiffest = min(front.designs, key=lambda d: d.values["deflection"]).values
    assert stiffest["height"] == pytest.approx(0.090)
    assert stiffest["cover"] == pytest.approx(0.002)


@pytest.mark.slow
def test_the_parts_that_an_objective_does_not_see_are_the_lightest():
    requirements = {
        "load_torque": "200 N*m",
        "driver_speed": "700 rpm",
        "driven_inertia": "2 kg*m2",
        "jerk_limit": "600 rad/s3",
        "outer_diameter_limit": "400 mm",
        "engagements_per_hour": 30,
    }
    front = synth.synthesize(synth.load("cone_clutch", practice="off"), requirements, points=30)
    least = min(front.designs, key=lambda d: d.values["actuation_force"])
    assert str(least.parts["cone_layout"]) == "outer_spring"  # the inner cone is heavier and needs the same force
    assert least.values["shell_thickness"] == pytest.approx(0.003)


def test_a_makeable_value_that_is_pinned_stays():
    front = synth.synthesize(Beam, {}, points=6, fix={"cover": "7.5 mm"})
    assert {round(d.values["cover"], 9) for d in front.designs} == {0.0075}


# -- many designs at once ------------------------------------------------------------------------------


def forms(tuning=TUNING):
    """Return formulations with two variables of which one is makeable, parts, voids and refusals; of two questions."""
    strut = Strut()
    more = {"catalogs": {"rods": RODS}, "limits": {"area": ">= 60 mm2"}, "tuning": tuning}
    ask = [pose(strut, {"load": load, "room": "150 mm"}, ["mass"], 1, **more) for load in ("20 kN", "30 kN")]
    return {"one question": ask[0].search().state.form, "two together": JointSearch(ask).search.form}


FORMS = forms()
AT_ONCE = 7  # points that are evaluated at a time where designs are polished piece by piece
IN_PIECES = forms(tuned(heuristics={"polishing": PolishingLimits(tried_at_once=300, evaluated_at_once=AT_ONCE)}))


def some_designs(form, count):
    rng = np.random.default_rng(7)
    low, high = form.lower, form.upper
    points = form.makeable.nearest(low + (high - low) * rng.random((20 * count, form.n)))
    found = feasible_candidates(form, points, rng.integers(0, form.instance.combinations.count, len(points)))
    assert len(found) >= count
    return found[:count]


def step(form, own, trials, combinations, traded, order):
    """Return the best of some points by the objectives in their order, where it is better than a design."""
    rows, phi = form.points.feasible_rows(trials, combinations)
    left = [k for k in rows if np.all(phi[k, :traded] <= own.phi[:traded] + TIE)]
    for j in order:
        least = min((phi[k, j] for k in left), default=np.inf)
        left = [k for k in left if phi[k, j] <= least + TIE]
    gains = [g for k in left[:1] for g in own.phi[order] - phi[k, order] if abs(g) > TIE]
    return Candidate(int(combinations[left[0]]), trials[left[0]], phi[left[0]]) if gains and gains[0] > 0 else own


def polished_alone(form, own, traded, order, parts):
    """Return what a design becomes that takes its steps alone, all points of each looked at."""
    for _ in range(TUNING.heuristics.polishing.moves):
        before = own
        for k in np.flatnonzero(form.gridded & (form.lower < form.upper)):
            grid = form.makeable.grids[k]
            trials = np.tile(own.variables, (len(grid), 1))
            trials[:, k] = grid
            own = step(form, own, trials, np.full(len(grid), own.combination), traded, order)
        if parts:
            others = form.instance.combinations.neighbours(own.combination)
            own = step(form, own, np.tile(own.variables, (len(others), 1)), others, traded, order)
        if own is before:
            break
    return own


@pytest.mark.slow
@pytest.mark.parametrize("which", FORMS)
@pytest.mark.parametrize("parts", [True, False])
@pytest.mark.parametrize(("traded", "order"), [(0, [0, 1, 2]), (1, [1, 0]), (2, [0, 1, 2]), (2, [1])])
def test_designs_that_are_polished_at_once_go_where_each_goes_alone(which, parts, traded, order, monkeypatch):
    form = FORMS[which]
    designs = some_designs(form, 60)
    together = polish_discrete(form, designs, traded, order, parts)
    alone = [polished_alone(form, own, traded, order, parts) for own in designs]
    if traded == 0 or (parts and 0 in order):
        assert any(a is not own for a, own in zip(alone, designs, strict=True))
    pieces, sizes = IN_PIECES[which], []
    evaluated = pieces.points.feasible_rows

    def counted(points, own):
        sizes.append(len(own))
        return evaluated(points, own)

    monkeypatch.setattr(pieces.points, "feasible_rows", counted)
    in_pieces = polish_discrete(pieces, designs, traded, order, parts)
    assert 0 < max(sizes) <= AT_ONCE
    for found in (together, in_pieces):
        assert [c.combination for c in found] == [c.combination for c in alone]
        np.testing.assert_array_equal([c.variables for c in found], [c.variables for c in alone])
        np.testing.assert_array_equal([c.phi for c in found], [c.phi for c in alone])


def test_no_designs_are_polished_to_none():
    assert polish_discrete(FORMS["one question"], [], 1, [0]) == []


@pytest.mark.parametrize("which", FORMS)
def test_what_is_feasible_and_as_good_is_promising(which):
    form = FORMS[which]
    rng = np.random.default_rng(3)
    combinations = rng.integers(0, form.instance.combinations.count, (40, 1))
    points = form.lower + (form.upper - form.lower) * rng.random((40, form.n))
    cutoffs = np.array([c.phi[:2] for c in some_designs(form, 40)])
    grid = np.linspace(form.lower[0], form.upper[0], 50)
    columns = [grid[None, :], *points.T[1:, :, None]]
    keep = form.points.promising(columns, combinations, cutoffs)
    every = np.repeat(points, 50, axis=0)
    every[:, 0] = np.tile(grid, 40)
    rows, phi = form.points.feasible_rows(every, np.repeat(combinations[:, 0], 50))
    good = rows[np.all(phi[rows, :2] <= np.repeat(cutoffs, 50, axis=0)[rows] + TIE, axis=1)]
    assert len(good)
    assert keep.ravel()[good].all()
    assert keep.mean() < 0.5


# -- ties --------------------------------------------------------------------------------------------


class ManyTies(DesignProblem):
    """A bar whose mass does not see how often it is marked, which a limit does that hardly excludes any of 240 000."""

    name, title, sources = "many_ties", "Many ties", ("made up",)

    def declare(self, d):
        length = d.variable("length", "m", 1, 2)
        marks = [d.count(f"marks_{k}", 1, 62) for k in range(3)]
        d.at_most("marked", length * sum(marks), 185, "m")
        d.derive("mass", "kg", 3 * length)
        d.objective("mass")


@pytest.mark.parametrize("at_once", [100, 65_536])
def test_no_more_ties_are_sought_than_are_told_and_few_at_a_time(at_once, monkeypatch):
    sizes: list[int] = []
    contract = BoxOperations.contract

    def watched(self, boxes, cutoffs=None, passes=None, **more):
        if passes == 1:
            sizes.append(len(boxes))
        return contract(self, boxes, cutoffs, passes, **more)

    monkeypatch.setattr(BoxOperations, "contract", watched)
    limits = replace(TUNING.heuristics.polishing, evaluated_at_once=at_once)
    tuning = tuned(heuristics={"polishing": limits})
    (design,) = synthesize(tuning, ManyTies, {}, points=1).designs
    assert len(design.alternatives) == limits.ties - 1
    assert len({str(other) for other in design.alternatives}) == limits.ties - 1
    assert max(sizes) <= at_once
    assert sum(sizes) < 100_000


# -- preferences ---------------------------------------------------------------------------------------


class Ramp(DesignProblem):
    """A size that its objective sees, and a ramp that it does not: a long one is cool, a short one lasts."""

    name = "ramp"

    def declare(self, d):
        size, ramp = d.variable("size", "mm", 1, 9), d.variable("ramp", "s", 1, 10)
        plies = d.count("plies", 1, 2)
        d.derive("mass", "kg", 1000 * size)
        d.derive("life", "-", 100 * plies / ramp)
        d.derive("heat", "K", 50 / ramp + size)
        d.at_least("strength", size, 0.002, "mm")
        d.objective("mass")
        d.objective("heat", default=False)
        self.preferred(d)

    def preferred(self, d):
        d.prefer("life", "max")
        d.prefer("heat")
        d.prefer("of_another_option")


class NothingPreferred(Ramp):
    def preferred(self, d):
        pass


def test_what_a_family_prefers_settles_what_the_objectives_leave_open():
    (preferred,), (other,) = (synth.synthesize(p, {}, points=1).designs for p in (Ramp, NothingPreferred))
    assert preferred.objectives == pytest.approx(other.objectives, rel=1e-8)
    assert other.values["ramp"] == pytest.approx(10, rel=1e-6)
    assert (preferred.values["ramp"], preferred.values["life"]) == pytest.approx((1, 200), rel=1e-6)


def test_a_preference_has_a_sense():
    class Odd(Ramp):
        def preferred(self, d):
            d.prefer("life", "long")

    with pytest.raises(DeclarationError, match="preference life has sense 'long'"):
        synth.synthesize(Odd, {}, points=1)


@pytest.mark.slow
def test_a_magnet_does_not_slip_for_seconds_where_its_mass_does_not_see_it():
    duty = {"load_torque": "1.36 N*m", "driver_speed": "1000 1/min", "driven_inertia": "0.001 kg*m2"}
    first = synth.synthesize("electromagnetic_clutch", duty, points=2).designs[0]
    assert first.values["mass"] == pytest.approx(0.3209, rel=1e-3)
    assert first.values["ramp_time"] < 0.1
    assert first.values["wear_life"] > 3e6
