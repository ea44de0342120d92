"""Prices of requirements and limits against closed forms, another solver, and plain enumeration of all parts."""

import csv
import json
import math

import numpy as np
import pandas as pd
import pytest
from scipy.optimize import minimize

import synth
from synth.question.settings import SearchSettings
from synth.studies.prices import run as pricing
from synth.studies.prices.price_list import PriceStore
from synth.studies.settings import PriceLimits
from tests.sample_problems.strut import RODS, Strut
from tests.search.test_sensitivity import Followed, Hung

# -- one bar: the parts stay ---------------------------------------------------------------------------

BAR = {"fix": {"plates": 1, "end": "eye", "material": "hard"}, "parts": {"plate": ["core 2"]}, "gap": 1e-5}
ASKED = {"load": "20 kN", "room": "150 mm"}


def bar(requirements=ASKED, **more):
    return synth.synthesize(Strut(), requirements, catalogs={"rods": RODS}, **{**BAR, "grid": False, **more})


def test_a_bar_costs_what_statics_says():
    # width = safety load / (stress t), length = 120 mm: mass grows with load, safety and reach, falls with stress.
    found = synth.prices(bar(objectives=["mass"]))
    for name in ("load", "safety"):
        price = found.of(1, "mass", name)
        assert (price.status, price.up) == ("confirmed", price.down)
        assert price.up == pytest.approx(1.0, rel=1e-6)
        assert price.sentence == f"1 % more {name} costs 1 % mass"
    stress = found.of(1, "mass", "stress", "limit")
    assert stress.up == stress.down == pytest.approx(-1.0, rel=1e-6)
    assert stress.sentence == "raising the limit stress by 1 % saves 1 % mass"
    assert found.of(1, "mass", "load").compared == "no other parts are offered"


def test_what_has_room_to_spare_has_no_influence_and_it_is_said():
    found = synth.prices(bar(objectives=["mass"]))
    for kind in ("requirement", "limit"):
        price = found.of(1, "mass", "room", kind)
        assert (price.status, price.up, price.down, price.elasticity) == ("no influence", 0, 0, 0)
    assert found.of(1, "mass", "room").sentence == "room has no influence on mass"
    assert found.of(1, "mass", "room", "limit").sentence == "the limit room has no influence on mass"


def lightest_bar(load, reach, flexibility):
    """Return the least mass by another solver: width and length in mm, one plate of 2 mm, an eye."""

    def area(x):
        return 2.0 * x[0]

    limits = [
        {"type": "ineq", "fun": lambda x: 1 - 1.5 * load / area(x) / 160},
        {"type": "ineq", "fun": lambda x: x[1] / (120 * reach) - 1},
        {"type": "ineq", "fun": lambda x: 1 - 1e9 * x[1] / (210e9 * area(x)) / flexibility},
    ]
    answer = minimize(
        lambda x: 7850e-9 * area(x) * x[1] * 1.1,
        [140, 130],
        method="SLSQP",
        bounds=[(5, 150), (100, 300)],
        constraints=limits,
        options={"ftol": 1e-11, "maxiter": 500},
    )
    assert answer.success
    return answer.fun


def test_prices_of_a_bar_are_those_of_another_solver():
    front = bar(points=3)
    inner = next(d for d in front.designs if d.utilisation["stress"] < 0.95 and d.utilisation["room"] < 0.95)
    found = synth.prices(front, inner.rank)
    level = inner.values["flexibility"]

    def price(load=1.0, reach=1.0):
        factor = max((load, reach), key=lambda f: abs(f - 1))
        change = lightest_bar(20e3 * load, reach, level) / lightest_bar(20e3, 1.0, level)
        return math.log(change) / math.log(factor)

    reach = found.of(inner.rank, "mass", "reach", "limit")
    assert reach.up == pytest.approx(price(reach=1.01), rel=1e-4)
    assert reach.down == pytest.approx(price(reach=0.99), rel=1e-4)
    assert reach.up == pytest.approx(2.0, rel=1e-5)
    assert price(load=1.01) == pytest.approx(0.0, abs=1e-6)
    assert found.of(inner.rank, "mass", "load").status == "no influence"


def test_makeable_sizes_are_taken_as_continuous():
    makeable, plain = bar(objectives=["mass"], grid=True), bar(objectives=["mass"])
    assert makeable.designs[0].values["mass"] > 1.001 * plain.designs[0].values["mass"]
    found = synth.prices(makeable)
    assert found.makeable
    for row, other in zip(found.rows, synth.prices(plain).rows, strict=True):
        assert row.up == pytest.approx(other.up, rel=1e-6)
        assert row.status == other.status


# -- rods of several materials: the part changes -------------------------------------------------------

METALS = pd.DataFrame(
    {
        "designation": ["weak", "strong", "short", "heavy"],
        "stress_allow [N/mm2]": [100.0, 200.0, 300.0, 150.0],
        "head [kg]": [1.0, 2.0, 1.2, 2.5],
        "load_allow [kN]": [900.0, 900.0, 60.0, 900.0],
        "source": ["invented"] * 4,
    }
)
SPECIFIC = 7850 * 1.5  # kg/m2


class Rod(synth.DesignProblem):
    """A rod with a head: light heads on weak rods, heavy ones on strong rods."""

    name, title, sources = "rod", "Rod", ("statics",)

    def declare(self, d):
        load = d.requirement("load", "kN", lower=1, upper=1000)
        slack = d.requirement("slack", "-", 0.0, lower=-1, upper=1)
        span = d.requirement("span", "m", 1.5, lower=0.1, upper=1.5)
        area = d.variable("area", "mm2", 1, 50000, grid=20)
        metal = d.part("metal", "metals")
        mass = metal.head + 7850 * span * area
        d.derive("mass", "kg", mass)
        d.derive("thrift", "1/kg", 1 / mass)
        d.derive("spare", "kg", mass - mass)
        d.at_least("strength", area * metal.stress_allow, load + slack * 1e3, "kN")
        d.at_most("approved", load, metal.load_allow, "kN")
        d.objective("mass")
        d.objective("thrift", "max", default=False)
        d.objective("spare", default=False)
        d.refuse("wrong_end", (metal.head < 1.1) * (load < 13.9e3), "a weak rod only from 13.9 kN")


def masses(load):
    """Return the least mass of each metal: plain arithmetic."""
    return {
        name: head + SPECIFIC * load / (stress * 1e6) if load <= allow * 1e3 * (1 + 1e-9) else math.inf
        for name, stress, head, allow in METALS.iloc[:, :4].itertuples(index=False)
    }


def rod(load, metals=("weak", "strong"), **more):
    return synth.synthesize(
        Rod,
        {"load": load},
        catalogs={"metals": METALS},
        parts={"metal": list(metals)},
        gap=1e-5,
        **{"grid": False, **more},
    )


def brute(load, factor, metals):
    before, after = (min(masses(x)[m] for m in metals) for x in (load, load * factor))
    return (after / before - 1) / (factor - 1)


EVEN = 1 / (SPECIFIC / 1e8 - SPECIFIC / 2e8)  # N; both metals weigh the same


@pytest.mark.parametrize("share", [0.997, 1.003])
def test_where_the_part_changes_the_price_is_one_sided(share):
    load = share * EVEN
    found = synth.prices(rod(load / 1e3))
    price = found.of(1, "mass", "load")
    assert price.status == "parts change"
    metals = ("weak", "strong")
    assert price.up == pytest.approx(brute(load, 1.01, metals), rel=0.01 if share > 1 else 1e-6)
    assert price.down == pytest.approx(brute(load, 0.99, metals), rel=1e-6 if share > 1 else 0.01)
    assert price.up < price.down - 0.02
    assert ("weak -> strong" if share < 1 else "strong -> weak") in price.sentence
    assert ("upwards" if share < 1 else "downwards") in price.reason
    assert price.compared == "over all 2 combinations tried"


def test_far_from_the_change_nothing_changes():
    load = 0.9 * EVEN
    price = synth.prices(rod(load / 1e3)).of(1, "mass", "load")
    own = masses(load)["weak"]
    assert price.status == "confirmed"
    assert price.up == price.down == pytest.approx((own - 1) / own, rel=1e-6)


def test_a_part_that_may_bear_no_more_is_replaced_or_the_price_is_withheld():
    metals = ("short", "strong")
    price = synth.prices(rod(59.9, metals)).of(1, "mass", "load")
    assert price.status == "parts change"
    assert price.up == pytest.approx(brute(59.9e3, 1.01, metals), rel=1e-5)
    assert price.up > 20  # another head: a jump, no slope
    assert price.down == pytest.approx(brute(59.9e3, 0.99, metals), rel=0.02)
    assert "short -> strong" in price.sentence
    alone = synth.prices(rod(59.9, ["short"])).of(1, "mass", "load")
    assert (alone.status, alone.sentence[:25]) == ("confirmed", "0.1 % more load costs 0.0")
    assert "1 % more breaks approved, which no size of these parts can restore" in alone.reason
    edge = synth.prices(rod(60.0, ["short"])).of(1, "mass", "load")
    assert (edge.status, edge.up) == ("withheld up", None)
    assert edge.down == pytest.approx(price.down, rel=1e-2)
    assert "1 % more load: withheld" in edge.sentence
    lower = synth.prices(rod(60.0, ["short"])).of(1, "mass", "approved", "limit")
    assert (lower.status, lower.up) == ("withheld down", 0)


def test_a_part_that_is_refused_after_the_step_is_not_used():
    price = synth.prices(rod(14.0)).of(1, "mass", "load")
    assert price.status == "parts change"
    assert price.down == pytest.approx((masses(13.86e3)["strong"] / masses(14e3)["weak"] - 1) / -0.01, rel=1e-5)
    assert price.up == pytest.approx(brute(14e3, 1.01, ("weak", "strong")), rel=0.01)
    assert "metal weak -> strong" in price.reason


def test_parts_that_win_by_makeable_sizes_alone_are_told():
    # Just above the change, a makeable area of the weak rod may waste less than one of the strong rod.
    load = next(
        x
        for x in np.arange(1.001, 1.3, 0.001) * EVEN
        if math.ceil(x / 1e8 / 2e-5) * 2e-5 * SPECIFIC + 1 < math.ceil(x / 2e8 / 2e-5) * 2e-5 * SPECIFIC + 2
    )
    front = rod(load / 1e3, grid=True)
    assert str(front.designs[0].parts["metal"]) == "weak"
    price = synth.prices(front).of(1, "mass", "load")
    assert price.status == "parts fixed"
    own = masses(load)["weak"]
    assert price.up == pytest.approx((own - 1) / own, rel=1e-6)
    assert "need not be makeable, metal weak -> strong is" in price.compared


def test_an_objective_to_be_large_and_one_that_is_zero():
    load = 0.9 * EVEN
    front = rod(load / 1e3, objectives=["thrift"])
    own = masses(load)["weak"]
    price = synth.prices(front).of(1, "thrift", "load")
    assert price.up == price.down == pytest.approx(-(own - 1) / own, rel=1e-5)
    assert price.status == "confirmed"
    assert price.sentence.startswith("1 % more load costs 0.")
    nothing = synth.prices(rod(load / 1e3, objectives=["spare"])).of(1, "spare", "load")
    assert (nothing.status, nothing.up, nothing.down) == ("withheld", None, None)
    assert nothing.reason == "spare is 0 here: there is no per cent of it"


def test_what_cannot_be_moved_is_withheld():
    found, own = synth.prices(rod(30.0)), masses(30e3)["strong"]
    slack = found.of(1, "mass", "slack")
    assert (slack.status, slack.reason) == ("withheld", "slack is 0: there is no per cent of it")
    span = found.of(1, "mass", "span")
    assert (span.status, span.up) == ("withheld up", None)
    assert "span" in span.reason
    assert "expected 0.1 m to 1.5 m" in span.reason
    assert span.down == pytest.approx(1 - 2 / own, rel=1e-5)


def test_an_equality_has_a_price():
    # The cube: surface goes with volume to 2/3. Neither side of the limit enters by logarithm.
    found = synth.prices(synth.synthesize(Hung, {"volume": "1 dm3"}, gap=1e-5))
    for kind in ("requirement", "limit"):
        price = found.of(1, "surface", "volume", kind)
        assert (price.status, price.up) == ("confirmed", price.down)
        assert price.up == pytest.approx(2 / 3, rel=1e-3)
    # The flattest box is the widest, so that -width goes with the root of the volume: down, by half a per cent.
    below = synth.prices(synth.synthesize(Hung, {"volume": "1 dm3"}, objectives=["below"], gap=1e-5))
    price = below.of(1, "below", "volume")
    assert price.up == price.down == pytest.approx(-0.5, rel=1e-4)
    assert price.sentence == "1 % more volume saves 0.5 % below"


def test_limits_of_the_question_have_a_price():
    # Flexibility goes with length/width: the width is held by the limit on it, the length by the reach or a limit.
    limits = {"width": ["<= 100 mm", ">= 10 mm"], "length": ">= 150 mm", "area": "<= 300 mm2", "mass": "<= 1 kg"}
    for grid in (True, False):
        found = synth.prices(bar(objectives=["flexibility"], limits=limits, grid=grid))
        for name, expected in (("width <= 100 mm", -1), ("length >= 150 mm", 1), ("width >= 10 mm", 0)):
            price = found.of(1, "flexibility", name, "limit")
            assert price.up == price.down == pytest.approx(expected, rel=1e-6)
            assert price.status == ("confirmed" if expected else "no influence")
        assert found.of(1, "flexibility", "reach", "limit").status == "no influence"
        assert found.of(1, "flexibility", "area <= 300 mm2", "limit").status == "no influence"
    tight = synth.prices(bar(objectives=["flexibility"], limits={"area": "<= 200 mm2", "length": "== 160 mm"}))
    assert tight.of(1, "flexibility", "area <= 200 mm2", "limit").up == pytest.approx(-1, rel=1e-6)
    exact = tight.of(1, "flexibility", "length == 160 mm", "limit")
    assert exact.up == exact.down == pytest.approx(1, rel=1e-6)
    assert exact.sentence == "raising the limit length == 160 mm by 1 % costs 1 % flexibility"


@pytest.mark.parametrize(("stated", "expected"), [({}, 1.0), ({"peak": 20.0}, -0.6), ({"jolt": 40.0}, 0.2)])
def test_what_a_default_makes_of_a_requirement_moves_along(stated, expected):
    price = synth.prices(synth.synthesize(Followed, {"load": 10.0, **stated}, gap=1e-5)).of(1, "mass", "load")
    assert price.status == "confirmed"
    assert price.up == pytest.approx(expected, rel=1e-4)


class Warm(synth.DesignProblem):
    """A block that must hold heat above the ambient temperature."""

    name = "warm"

    def declare(self, d):
        ambient = d.requirement("ambient", "degC", 26.85, lower=-50, upper=200)
        size = d.variable("size", "mm", 1, 5000)
        d.derive("mass", "kg", 1e2 * size)
        d.at_least("warmth", size * 300, ambient, "K")
        d.objective("mass")


def test_temperatures_count_from_absolute_zero():
    price = synth.prices(synth.synthesize(Warm, {}, gap=1e-5)).of(1, "mass", "ambient")
    assert price.up == pytest.approx(1.0, rel=1e-6)
    assert price.sentence == "1 % more ambient (in kelvin) costs 1 % mass"


class Vertex(synth.DesignProblem):
    """A width that two limits hold at the same place: the multipliers do not tell which."""

    name = "vertex"

    def declare(self, d):
        load = d.requirement("load", "kN", lower=1, upper=100)
        grip = d.requirement("grip", "kN", lower=1, upper=100)
        width = d.variable("width", "mm", 1, 500)
        d.derive("mass", "kg", 1e3 * width)
        d.at_least("strength", width * 1e6, load, "kN")
        d.at_least("friction", width * 1e6, grip, "kN")
        d.objective("mass")


def test_a_price_that_solving_again_does_not_confirm_is_withheld_with_the_reason():
    front = synth.synthesize(Vertex, {"load": 10, "grip": 10}, gap=1e-5)
    price = synth.prices(front).of(1, "mass", "load")
    assert 0.1 < price.elasticity < 0.9  # both ends of the truth are excluded
    assert (price.up, price.down, price.status) == (None, None, "withheld")
    assert price.reason.startswith(f"upwards the multipliers say {price.elasticity:.3g}, but solving again with 1 %")
    assert "gives 1 (friction no longer binds)" in price.reason
    assert "1 % less gives" in price.reason
    assert price.sentence == "what 1 % more load costs in mass is withheld"


def test_a_price_that_bends_within_the_step_holds_for_less():
    front = synth.synthesize(Vertex, {"load": 10, "grip": 10.05}, gap=1e-5)
    price = synth.prices(front).of(1, "mass", "load")
    assert (price.status, price.up) == ("no influence", 0)
    assert "upwards holds for 0.1 %; solving again with 1 % more gives 0.49" in price.reason
    assert "strength begins to bind" in price.reason
    grip = synth.prices(front).of(1, "mass", "grip")
    assert grip.up == grip.down == pytest.approx(1.0, rel=1e-6)
    assert grip.sentence == "1 % more grip costs 1 % mass; 0.1 % less saves 0.1 % mass"


class Choice(synth.DesignProblem):
    """Only counts: no size can follow."""

    name = "choice"

    def declare(self, d):
        load = d.requirement("load", "kN", lower=1, upper=100)
        plates = d.count("plates", 1, 9)
        d.derive("mass", "kg", plates * 2.0)
        d.at_least("strength", plates * 1e4, load, "kN")
        d.objective("mass")


def test_a_question_without_sizes():
    price = synth.prices(synth.synthesize(Choice, {"load": 30})).of(1, "mass", "load")
    assert price.up == pytest.approx(100 / 3)
    assert price.down == 0
    assert "plates 3 -> 4" in price.sentence


# -- many combinations, interruptions, files -----------------------------------------------------------


def test_of_many_combinations_some_are_tried_and_it_is_said():
    front = rod(0.997 * EVEN / 1e3, ("weak", "strong", "heavy"))
    few = PriceLimits(all=1, parents=1)
    found = pricing._Pricing(front.question, front, 0.01, SearchSettings(), None, few).run(
        front.designs[:1], PriceStore.of(None, "")
    )
    price = found.of(1, "mass", "load")
    assert price.compared == "over the 3 combinations tried, of 3"
    assert "weak -> strong" in price.sentence


@pytest.fixture(scope="module")
def front():
    return bar(points=3)


def test_what_was_finished_is_kept_and_a_second_run_goes_on(front, tmp_path):
    def stop(state):
        if state["done"] >= 1 / 3:
            raise KeyboardInterrupt

    first = synth.prices(front, progress=stop, folder=tmp_path)
    assert (first.interrupted, first.finished, first.asked) == ("interrupted", (1,), (1, 2, 3))
    first.save(tmp_path)
    second = synth.prices(front, folder=tmp_path)
    assert (second.finished, second.statistics["kept"]) == ((1, 2, 3), 1)
    assert second.rows == synth.prices(front).rows
    second.save(tmp_path)
    assert synth.prices(front, 2, folder=tmp_path).statistics["kept"] == 1
    assert synth.prices(front, 2, "0.5 %", folder=tmp_path).statistics["kept"] == 0
    assert synth.prices(front, time_limit=1e-9).interrupted == "time limit"
    (tmp_path / "prices.json").write_text('{"format": 1, "fingerprint": 3}')
    assert synth.prices(front, 1, folder=tmp_path).statistics["kept"] == 0


def test_a_loaded_front_has_the_same_prices_and_the_files_hold_them(front, tmp_path):
    loaded = synth.load_front(front.save(tmp_path / "front"))
    found = synth.prices(loaded, [2], problem=Strut(), catalogs={"rods": RODS})
    assert found.rows == synth.prices(front, 2).rows
    folder = found.save(tmp_path / "prices")
    with (folder / "prices.csv").open() as file:
        rows = list(csv.DictReader(file))
    assert [row["sentence"] for row in rows] == [row.sentence for row in found.rows]
    assert list(rows[0]) == list(found.to_frame().columns)
    record = json.loads((folder / "prices.json").read_text())
    assert list(record["designs"]) == ["2"]


@pytest.mark.parametrize(
    ("more", "words"),
    [
        ({"design": 99}, ["design", "99", "rank from 1 to 3"]),
        ({"design": True}, ["design", "rank"]),
        ({"design": []}, ["design", "at least one"]),
        ({"step": "0 %"}, ["step", "0.01 % to 10 %"]),
        ({"step": "20 %"}, ["step", "0.01 % to 10 %"]),
        ({"step": "2 mm"}, ["step", "2 mm"]),
    ],
)
def test_careless_input_is_refused(front, more, words):
    with pytest.raises(synth.InputError) as error:
        synth.prices(front, **more)
    assert all(word in str(error.value) for word in words)


def test_a_front_without_designs_is_refused():
    front = synth.synthesize(Vertex, {"load": 10, "grip": 10}, limits={"mass": "<= 1 kg"})
    with pytest.raises(synth.InputError, match="a front with designs"):
        synth.prices(front)
