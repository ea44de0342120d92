"""Robust fronts: their limits hold wherever one looks in the range, and nothing better does so."""

import numpy as np
import pytest
from scipy.optimize import brentq

import synth
import synth.analysis.restate
import synth.robust.robust_front
from synth.question.catalogs import as_catalogs
from synth.question.uncertainty import read_block
from synth.robust.counterpart import RobustProblem, robust_counterpart
from synth.search.settings import TUNING
from tests.asking import rater_of
from tests.sample_problems.shaft_brake import CATALOGS, FACE, NEEDED, PAIRS, ShaftBrake
from tests.tuned import synthesize, tuned

RANGES = {"friction": "catalogue range", "torque": "+-10 %", "wear": "new and worn", "tolerance": {"radius": "+-1 mm"}}
DUTY = {**NEEDED, "torque_limit": "400 N*m"}


ONE_SEARCH = tuned(robust={"searches": 1, "searches_for_first": 1})


def synthesized(robust=None, requirements=DUTY, problem=ShaftBrake, tuning=TUNING, **settings):
    settings = {"points": 4, "catalogs": CATALOGS, **settings}
    return synthesize(tuning, problem(), requirements, robust=robust, **settings)


def worst(design, block, count=4000, limits=None):
    """Return the largest residual over random points of the range and its corners."""
    rater = rater_of(ShaftBrake(), design.frame.requirements, as_catalogs(CATALOGS), limits, read_block(block))
    points = np.random.default_rng(7).random((count, len(rater.quantities)))
    residuals = rater.residuals(design, np.concatenate([rater.corners, points]))
    return residuals.max()


@pytest.fixture(scope="module")
def fronts():
    return synthesized(), synthesized(RANGES)


def test_robust_designs_keep_their_limits_everywhere_and_nominal_ones_do_not(fronts):
    plain, robust = fronts
    assert len(robust.designs) == 4
    assert all(worst(d, RANGES) > 1e-3 for d in plain.designs)
    assert all(worst(d, RANGES) <= 1e-6 for d in robust.designs)
    assert all(d.robust["holds"] and d.robust["yield"] == 1.0 for d in robust.designs)
    assert robust.certificate.kind == "global"
    assert robust.statistics["robust"]["taken_off"] == 0


def test_the_robust_optimum_is_that_of_the_worst_corner(fronts):
    # Least force of the firm or soft lining: mu_min F (r - 1 mm - 2 mm) = 110 N*m, while mu_static at mu_max times
    # F (r + 1 mm) stays within 400 N*m, which never binds here, and the hum stays 10 % away.
    best = min(synthesized(RANGES, points=1, objectives=["force"]).designs, key=lambda d: d.values["force"])
    row = PAIRS.set_index("designation").loc[str(best.parts["pair"])]
    force = 110 / (row["mu_min [-]"] * (best.values["radius"] - 0.003))
    assert best.values["force"] == pytest.approx(force, rel=1e-6)
    assert best.values["radius"] == pytest.approx(0.2, rel=1e-6)
    # The least size: the force is at most what the pressure allows.
    small = min(synthesized(RANGES, points=1, objectives=["size"]).designs, key=lambda d: d.values["size"])
    needed = []
    for name, pair in PAIRS.set_index("designation").iterrows():
        most = pair["pressure_allow [N/mm2]"] * 1e6 * FACE
        radius = brentq(lambda r, p=pair, f=most: p["mu_min [-]"] * f * (r - 0.003) - 110, 0.01, 1)
        loudest = pair["mu_static [-]"] * pair["mu_max [-]"] / pair["mu_dynamic [-]"]
        needed.append((radius, name, loudest * most * (radius + 0.001)))
    radius, name, loudest = min(x for x in needed if x[2] <= 400)
    assert small.values["size"] == pytest.approx(2 * radius, rel=1e-4)
    assert str(small.parts["pair"]) == name


def test_a_robust_front_is_verified_and_read_back(fronts, tmp_path):
    robust = fronts[1]
    assert robust.verify().holds
    robust.save(tmp_path / "out")
    again = synth.load_front(tmp_path / "out")
    assert [d.robust for d in again.designs] == [d.robust for d in robust.designs]
    assert again.files() == robust.files()
    assert {"designs.csv", "front.json", "robust.csv"} <= set(again.files())
    header = again.files()["designs.csv"].splitlines()[0]
    assert header.endswith("robust,proof,yield,yield low,yield high,worst limit,worst utilisation,worst at")
    instance = synth.analysis.restate.question_of(
        again, robust_counterpart(ShaftBrake(), again.frame.restated["robust"], None), CATALOGS
    )
    assert [x.name for x in instance.model.limits] == [x for x in robust.frame.limit_units]


def test_the_same_seed_gives_the_same_front(fronts):
    again = synthesized(RANGES)
    assert [d.robust for d in again.designs] == [d.robust for d in fronts[1].designs]
    assert [d.values for d in again.designs] == [d.values for d in fronts[1].designs]


# 1200 1/min hums at radii from 90 to 110 mm. Speeds 30 per cent lower and higher hum from 129 to 157 and from 69 to
# 85 mm, so that a radius of 115 mm is quiet at both ends of the range and at its middle, but not between.
WIDE = {"speed": "+-30 %", "samples": 512}
SIZE = {"fix": {"force": "3 kN"}, "objectives": ["size"], "points": 1}


def test_limits_that_are_not_monotone_are_searched_again_until_they_hold():
    limits = {"size": ">= 200 mm"}
    (plain,) = synthesized(requirements=NEEDED, limits=limits, **SIZE).designs
    assert worst(plain, WIDE) > 0.1
    front = synthesized(WIDE, requirements=NEEDED, limits=limits, **SIZE)
    (robust,) = front.designs
    assert front.statistics["robust"]["searches"] > 1
    assert front.frame.restated["robust"]["scenarios"]["hum"]
    assert robust.robust["holds"]
    assert robust.values["radius"] == pytest.approx(0.1 * 1.1 / 0.7, rel=1e-6)
    assert worst(robust, WIDE) <= 1e-6
    assert front.verify().holds


def test_a_range_that_leaves_nothing_is_told_as_infeasible():
    front = synthesized(WIDE, requirements=NEEDED, limits={"size": "200 mm .. 250 mm"}, **SIZE)
    assert front.status.value == "infeasible"
    assert front.certificate.kind == "global"
    assert "hum" in [c["limit"].split(" (")[0] for c in front.explanation["conflicts"]]


def test_what_still_fails_in_the_last_search_is_taken_off():
    front = synthesized(WIDE, requirements=NEEDED, tuning=ONE_SEARCH, limits={"size": ">= 200 mm"}, **SIZE)
    assert front.designs == []
    assert front.statistics["robust"]["taken_off"] == 1
    assert (front.status.value, front.certificate.kind) == ("not_solved", "heuristic")
    assert front.statistics["robust"]["searches"] == 1
    front = synthesized(
        WIDE,
        requirements=NEEDED,
        tuning=ONE_SEARCH,
        limits={"size": ">= 200 mm"},
        points=3,
        fix={"force": "3 kN"},
        objectives={"size": "min", "worth": "min"},
    )
    assert not front.complete
    assert [d.rank for d in front.designs] == list(range(1, len(front.designs) + 1))


def test_the_limits_of_the_user_hold_over_the_range_as_well():
    limits = {"braking_torque": "<= 300 N*m"}
    block = {"friction": "catalogue range"}
    plain = synthesized(requirements=NEEDED, limits={"braking_torque": [">= 150 N*m", "<= 300 N*m"]})
    robust = synthesized(block, requirements=NEEDED, limits={"braking_torque": [">= 150 N*m", "<= 300 N*m"]})
    assert any(worst(d, block, limits=limits) > 1e-3 for d in plain.designs)
    for design in robust.designs:
        row = design.parts["pair"]
        reach = design.values["force"] * (design.values["radius"] - 0.002)
        assert row["mu_max"] * reach <= 300 * (1 + 1e-6)
        assert row["mu_min"] * reach >= 150 * (1 - 1e-6)


def test_mode_rate_leaves_the_front_as_it_is(fronts):
    rated = synthesized({**RANGES, "mode": "rate"})
    assert [d.values for d in rated.designs] == [d.values for d in fronts[0].designs]
    assert not any(d.robust["holds"] for d in rated.designs)
    assert all(d.robust["yield_high"] < 1 for d in rated.designs)
    assert rated.verify().holds


def test_limits_are_posed_once_per_corner_that_matters():
    problem = robust_counterpart(ShaftBrake(), RANGES, None)
    assert isinstance(problem, RobustProblem)
    given = frozenset(["torque", "speed", "torque_limit"])
    names = list(problem.model(given, as_catalogs(CATALOGS)).declaration.limits)
    grip = [n for n in names if n.startswith("grip (")]
    assert grip == ["grip (friction low, torque high, wear high, radius low)"]
    assert [n for n in names if n.startswith("harshness (")] == ["harshness (friction high, radius high)"]
    assert not [n for n in names if n.startswith(("pressure (", "warmth ("))]
    assert robust_counterpart(problem, {**RANGES, "mode": "rate"}, None) is problem


def test_the_shifted_formulas_are_those_of_the_family(fronts):
    design = fronts[1].designs[0]
    row = design.parts["pair"]
    value, limit = design.limits["grip (friction low, torque high, wear high, radius low)"]
    assert value == pytest.approx(row["mu_min"] * design.values["force"] * (design.values["radius"] - 0.003))
    assert limit == pytest.approx(110)
    value, _ = design.limits["harshness (friction high, radius high)"]
    static = row["mu_static"] * row["mu_max"] / row["mu_dynamic"]
    assert value == pytest.approx(static * design.values["force"] * (design.values["radius"] + 0.001))


def test_what_a_family_refuses_at_the_end_of_a_range_is_refused():
    from tests.sample_problems.strut import RODS, Strut

    with pytest.raises(synth.InputError, match=r"heavy_hook.*at most 90 kN, over the whole range of load"):
        synth.synthesize(Strut(), {"load": "85 kN"}, catalogs={"rods": RODS}, robust={"load": "+-10 %"})


def test_nothing_is_left_where_the_range_is_too_wide():
    front = synthesized({"torque": "50 .. 1000 N*m"}, requirements=NEEDED)
    assert front.designs == []
    assert front.status.value == "infeasible"
    assert "grip (torque high)" in front.explanation["message"]


def test_interrupted_before_all_is_rated_says_so():
    def interrupt(state):
        if state["stage"] == "rating":
            raise KeyboardInterrupt

    front = synthesized(RANGES, progress=interrupt)
    assert front.interrupted == "interrupted"
    assert front.designs
    assert not any(d.robust for d in front.designs)
    front = synthesized(RANGES, time_limit=1e-6)
    assert front.interrupted == "time limit"


def test_a_second_search_that_is_stopped_leaves_what_the_first_one_proved():
    seen = []

    def interrupt(state):
        seen.append(state["stage"])
        if state["stage"] == "bounds" and "rating" in seen:
            raise KeyboardInterrupt

    limits = {"size": "<= 260 mm"}
    front = synthesized(
        WIDE,
        requirements=NEEDED,
        limits=limits,
        points=2,
        progress=interrupt,
        fix={"force": "3 kN", "pair": "firm"},
        objectives={"size": "max"},
    )
    assert front.interrupted == "interrupted"
    assert front.statistics["robust"]["taken_off"] == 1
    assert front.designs == []
    assert front.certificate.kind == "heuristic"


def test_why_nothing_is_robust_is_explained_by_the_corner():
    found = synth.explain(
        ShaftBrake(), NEEDED, catalogs=CATALOGS, parts={"pair": ["firm"]}, robust={"torque": "50 .. 1000 N*m"}
    )
    assert set(found.conflict) == {"pressure", "grip (torque high)"}


@pytest.mark.parametrize("block", [{"friction": "rough"}, {"torque": "+-99.5 %"}, {"frition": "+-5 %"}, {}])
def test_careless_blocks_are_refused_before_the_search(block):
    with pytest.raises(synth.InputError, match="robust"):
        synthesized(block)


@pytest.mark.parametrize("searches", [1, 5])
def test_the_first_that_holds_is_the_same_however_many_are_listed(searches):
    # With one search designs are taken off in the end, but never the first or the best in an objective.
    first = [
        synthesized(
            WIDE,
            requirements=NEEDED,
            tuning=tuned(robust={"searches": searches}),
            limits={"size": ">= 200 mm"},
            points=points,
            objectives={"size": "min", "force": "min"},
        ).designs[0]
        for points in (3, 6, 20, 100)
    ]
    assert [d.objectives for d in first] == [pytest.approx(first[0].objectives, rel=1e-3)] * 4
    assert [d.score for d in first] == pytest.approx([first[0].score] * 4, rel=1e-3)
