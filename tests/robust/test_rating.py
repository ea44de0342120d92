"""Ratings over a range: against closed forms, brute force over dense grids, and careless input."""

import json

import numpy as np
import pytest

import synth
from synth.question.catalogs import as_catalogs
from synth.question.uncertainty import Uncertainty, read_block
from synth.results.rating_tables import yield_text
from synth.robust.uncertainty import scattered
from tests.asking import rater_of
from tests.sample_problems.shaft_brake import CATALOGS, NEEDED, PAIRS, ShaftBrake


def design(pair="firm", radius="150 mm", force="2500 N", limits=None, requirements=NEEDED, **options):
    return synth.evaluate(
        ShaftBrake(**options),
        requirements,
        values={"radius": radius, "force": force},
        parts={"pair": pair},
        catalogs=CATALOGS,
        limits=limits,
    )


def rated(block, of=None, **options):
    of = design(**options) if of is None else of
    found = synth.rate(of, block, problem=ShaftBrake(**options), catalogs=CATALOGS)
    assert not found.interrupted
    return found.designs[0].robust


def test_the_worst_corner_is_exact_and_said_to_be_proven():
    told = rated({"friction": "catalogue range", "torque": "+-10 %", "tolerance": {"radius": "+-1 mm"}})
    grip = told["limits"]["grip"]
    assert grip["proof"] == "proven"
    assert grip["value"] == pytest.approx(0.24 * 2500 * (0.149 - 0.002))
    assert grip["limit"] == pytest.approx(110)
    assert grip["at"] == pytest.approx({"friction": 0.24, "torque": 110, "radius": 0.149})
    # Nothing that scatters concerns the pressure, so that no place of it is worst.
    assert told["limits"]["pressure"]["at"] == {}
    assert told["worst_limit"] == "grip"
    assert not told["holds"]


def test_a_friction_column_moves_in_proportion_to_the_sliding_one():
    asked = {**NEEDED, "torque_limit": "200 N*m"}
    told = rated({"friction": "catalogue range"}, design("soft", requirements=asked))
    assert told["limits"]["harshness"]["value"] == pytest.approx(0.44 * 0.60 / 0.40 * 2500 * 0.15)
    told = rated({"friction": "+-20 %"}, design("soft", requirements=asked))
    assert told["limits"]["harshness"]["value"] == pytest.approx(0.44 * 1.2 * 2500 * 0.15)
    told = rated({"friction": "0.3 .. 0.5"}, design("soft", requirements=asked))
    assert told["limits"]["harshness"]["value"] == pytest.approx(0.44 * 0.5 / 0.4 * 2500 * 0.15)


def test_the_interval_holds_the_exact_yield():
    # One thing: 0.24 .. 0.36, held where mu F (r - wear) >= T.
    told = rated({"friction": "catalogue range", "confidence": 0.99})
    exact = (0.36 - 100 / (2500 * 0.148)) / 0.12
    assert told["yield_low"] < exact < told["yield_high"]
    assert told["yield"] == pytest.approx(exact, abs=1e-3)
    # Two things, over the unit square: mu from a to b against c T, where T is uniform over t0 .. t1.
    told = rated({"friction": "catalogue range", "torque": "90 .. 120 N*m", "samples": 16384})
    needed = np.linspace(90, 120, 200001) / (2500 * 0.148)
    exact = np.clip((0.36 - needed) / 0.12, 0, 1).mean()
    assert told["yield_low"] < exact < told["yield_high"]
    assert told["yield"] == pytest.approx(exact, abs=1e-3)
    assert told["yield_high"] - told["yield_low"] < 0.02


def test_points_may_stand_beside_the_block():
    block, beside = {"friction": "catalogue range", "seed": 7}, {"samples": 128, "confidence": "99 %", "seed": 2}
    how = {"problem": ShaftBrake(), "catalogs": CATALOGS}
    found = synth.rate(design(), block, **beside, **how)
    assert found.asked == synth.rate(design(), {**block, **beside}, **how).asked
    assert {name: found.asked[name] for name in beside} == {**beside, "confidence": 0.99}
    again = synth.rate(design(), read_block(block), **beside, **how)
    assert again.asked == found.asked


@pytest.mark.slow
def test_intervals_of_independent_draws_cover_the_yield_as_often_as_they_say():
    # Each seed gives other points; scrambled ones fill the range evenly, so that hardly any interval misses.
    exact = (0.36 - 100 / (2500 * 0.148)) / 0.12
    missed = 0
    for seed in range(40):
        told = rated({"friction": "catalogue range", "samples": 256, "seed": seed, "confidence": 0.9})
        missed += not told["yield_low"] <= exact <= told["yield_high"]
    assert missed <= 4


@pytest.mark.parametrize("seed", range(6))
def test_proven_corners_are_the_worst_of_a_dense_grid(seed):
    rng = np.random.default_rng(seed)
    radius, force = f"{rng.uniform(60, 190):.6g} mm", f"{rng.uniform(500, 3000):.6g} N"
    of = design(
        pair=["firm", "soft"][seed % 2],
        radius=radius,
        force=force,
        limits={"braking_torque": "<= 150 N*m"},
        requirements={**NEEDED, "torque_limit": "180 N*m"},
    )
    block = {"friction": "catalogue range", "torque": "+-10 %", "speed": "1100 .. 1300 1/min", "wear": "new and worn"}
    told = rated(block, of)
    rater = rater_of(
        ShaftBrake(), of.frame.requirements, as_catalogs(CATALOGS), {"braking_torque": "<= 150 N*m"}, read_block(block)
    )
    axis = np.linspace(0, 1, 9)
    grid = np.stack(np.meshgrid(axis, axis, axis, axis), axis=-1).reshape(-1, 4)
    residuals = rater.residuals(of, grid)
    for limit, values in zip(rater.limits, residuals, strict=True):
        own = told["limits"][limit.name]
        if own["proof"] == "proven":
            assert values.max() <= own["residual"] + 1e-12, limit.name
        if own["proof"] == "bounded":
            assert values.max() <= 0
    assert {told["limits"][n]["proof"] for n in ("grip", "harshness", "braking_torque <= 150 N*m")} == {"proven"}


def test_what_is_not_monotone_is_sampled_or_bounded():
    # The resonance lies at 800 1/min for a radius of 150 mm: in the middle of this range, not at its corners.
    told = rated({"speed": "600 .. 1000 1/min"}, design(requirements={**NEEDED, "speed": "1000 1/min"}))
    hum = told["limits"]["hum"]
    assert hum["proof"] == "sampled"
    assert not hum["holds"]
    assert hum["at"]["speed"] == pytest.approx(800 * np.pi / 30, rel=1e-3)
    assert told["yield"] == pytest.approx(1 - 160 / 400, abs=2e-3)
    # On one side of it the limit is monotone; over both sides of a harmless one intervals show that it holds.
    told = rated({"speed": "1000 .. 1300 1/min"})
    assert told["limits"]["hum"]["proof"] == "proven"
    told = rated({"speed": "881 .. 1300 1/min", "tolerance": {"radius": "-0.1 .. 0 mm"}, "force": "+-100 N"})
    assert told["limits"]["hum"]["proof"] in ("proven", "bounded")
    assert told["limits"]["hum"]["holds"]


def test_a_jump_is_not_taken_for_a_slope():
    asked = {**NEEDED, "speed": "1200 1/min"}
    told = rated({"speed": "1200 .. 1300 1/min"}, design(requirements=asked, stop="step"), stop="step")
    assert told["limits"]["step"]["proof"] == "sampled"  # the step lies at 1241 1/min, inside
    assert not told["limits"]["step"]["holds"]
    told = rated({"speed": "1150 .. 1230 1/min"}, design(requirements=asked, stop="step"), stop="step")
    assert told["limits"]["step"]["proof"] == "proven"


def test_what_is_proven_to_hold_has_a_yield_of_one():
    told = rated({"friction": "catalogue range"}, design(radius="190 mm", requirements=NEEDED | {"torque": "50 N*m"}))
    assert told["holds"]
    assert told["proof"] == "proven"
    assert (told["yield"], told["yield_low"], told["yield_high"]) == (1.0, 1.0, 1.0)


def test_new_and_worn_cold_and_hot():
    told = rated({"wear": "new and worn", "ambient_temperature": "-20 .. 60 degC"})
    assert told["limits"]["grip"]["at"] == pytest.approx({"wear": 0.002})
    assert told["limits"]["warmth"]["value"] == pytest.approx(273.15 + 60 + 25)
    colon = rated({"wear": "new and worn", "ambient_temperature": "-20:60 degC"})
    assert colon["limits"] == told["limits"]
    told = rated({"wear": "0 .. 5 mm", "T": "+- 5 N*m", "ambient_temperature": "+-10 K"})
    assert told["limits"]["grip"]["at"] == pytest.approx({"wear": 0.005, "torque": 105})


@pytest.mark.parametrize(
    ("text", "low", "high"),
    [
        ("+10 %", 100, 110),
        ("-10 %", 90, 100),
        ("\u221210 %", 90, 100),
        (" + 10% ", 100, 110),
        ("+5 N*m", 100, 105),
        ("- 5 N*m", 95, 100),
        ("-5 .. +10 %", 95, 110),
        ("-5 : 10 %", 95, 110),
        ("+-10 %", 90, 110),
        ("+/- 5 N*m", 95, 105),
    ],
)
def test_deviations_to_one_side_and_to_both(text, low, high):
    (thing,) = scattered(
        read_block({"torque": text}), ShaftBrake().model(frozenset(NEEDED), as_catalogs(CATALOGS)).declaration
    )
    ends = [thing.moved(thing.members[0], lambda _: 100.0, end, None) for end in (0.0, 1.0)]
    assert ends == pytest.approx([low, high])
    assert rated({"torque": text})["limits"]["grip"]["at"] == pytest.approx({"torque": high})


def test_friction_may_rise_alone_and_must_stay_above_zero():
    assert rated({"friction": "+0.1"})["limits"]["grip"]["at"] == pytest.approx({"friction": 0.3})
    assert rated({"friction": "-5 .. +10 %"})["limits"]["grip"]["at"] == pytest.approx({"friction": 0.285})
    with pytest.raises(synth.InputError, match="above zero"):
        rated({"friction": "-0.5"})


def test_the_same_seed_gives_the_same_files_and_another_one_others():
    block = {"friction": "catalogue range", "torque": "+-10 %", "samples": 128}
    files = [
        synth.rate(design(), {**block, "seed": s}, problem=ShaftBrake(), catalogs=CATALOGS).files() for s in (3, 3, 4)
    ]
    assert files[0] == files[1]
    assert files[0]["rating.json"] != files[2]["rating.json"]
    assert json.loads(files[0]["rating.json"])["robust"]["seed"] == 3


def test_rating_ends_where_time_is_over_and_keeps_what_is_done():
    seen = []
    found = synth.rate(
        [design(), design("soft")], {"friction": "+-5 %"}, problem=ShaftBrake(), catalogs=CATALOGS, time_limit=1e-9
    )
    assert (found.interrupted, found.missing, found.designs) == ("time limit", 2, [])

    def interrupt(state):
        seen.append(state["done"])
        if state["done"] > 0:
            raise KeyboardInterrupt

    found = synth.rate(
        [design(), design("soft")], {"friction": "+-5 %"}, problem=ShaftBrake(), catalogs=CATALOGS, progress=interrupt
    )
    assert (found.interrupted, found.missing, len(found.designs)) == ("interrupted", 1, 1)
    assert seen == [0.0, 0.5]


@pytest.mark.slow
@pytest.mark.parametrize(
    ("block", "words"),
    [
        ({}, ["nothing that scatters"]),
        ("friction", ["names with ranges"]),
        ({"friction": 0.1}, ["friction", "0.1", "a range"]),
        ({"friction": "some"}, ["friction", "some", "catalogue range"]),
        ({"friction": "+-120 %"}, ["friction", "smaller to a larger"]),
        ({"friktion": "+-5 %"}, ["friktion", "did you mean friction"]),
        ({"torque": "+-5 mm"}, ["torque", "5 mm"]),
        ({"torque": "+5 mm"}, ["torque", "5 mm"]),
        ({"torque": "+0 %"}, ["torque", "smaller to a larger"]),
        ({"torque": "-100 %"}, ["torque", "smaller to a larger"]),
        ({"torque": "+ten %"}, ["torque", "a range"]),
        ({"torque": "5 .. 10 %"}, ["torque", "holds the nominal 100 N*m"]),
        ({"ambient_temperature": "+5 %"}, ["ambient_temperature", "in degrees"]),
        ({"torque": "110 .. 120 N*m"}, ["torque", "holds the nominal 100 N*m"]),
        ({"torque": "120 .. 90 N*m"}, ["torque", "smaller to a larger"]),
        ({"torque": "0.5 .. 120 N*m"}, ["torque", "within 1 N*m .. 1000 N*m"]),
        ({"torque": "+-99.5 %"}, ["torque", "allows", "0.5 N*m"]),
        ({"torque_limit": "+-5 %"}, ["torque_limit", "given as well"]),
        ({"ambient_temperature": "+-5 %"}, ["ambient_temperature", "in degrees"]),
        ({"T": "+-5 %", "torque": "+-5 %"}, ["torque", "once"]),
        ({"tolerance": {"radios": "+-1 mm"}}, ["radios", "radius"]),
        ({"tolerance": {"radius": "0.1 .. 0.2 mm"}}, ["radius", "both sides"]),
        ({"tolerance": "+-1 mm"}, ["tolerance", "variables with tolerances"]),
        ({"pair.mu": "+-5 %"}, ["pair.mu", "a column"]),
        ({"braking_torque": "+-5 %"}, ["braking_torque", "a requirement"]),
        ({"friction": "+-5 %", "mode": "best"}, ["mode", "limits"]),
        ({"friction": "+-5 %", "samples": 100}, ["samples", "power of 2"]),
        ({"friction": "+-5 %", "samples": True}, ["samples", "power of 2"]),
        ({"friction": "+-5 %", "seed": -1}, ["seed"]),
        ({"friction": "+-5 %", "confidence": 1}, ["confidence", "50 %"]),
        ({"friction": "+-5 %", "scenarios": {"grip": [[2.0]]}}, ["scenarios", "positions"]),
        ({"friction": "+-5 %", "scenarios": {"grip": [[0.5, 0.5]]}}, ["scenarios", "1 ranges"]),
    ],
)
def test_careless_blocks_are_refused_in_one_sentence(block, words):
    with pytest.raises(synth.InputError) as refused:
        synth.rate(design(), block, problem=ShaftBrake(), catalogs=CATALOGS)
    text = " ".join(str(refused.value).split())
    assert all(word in text for word in words), text


def test_ranges_are_read_as_name_plates_have_them():
    plain = rated({"torque": "90.5 .. 105.5 N*m", "force": "+-100 N", "tolerance": {"radius": "+-1 mm"}})
    typed = rated({"torque": "90.5 .. 105 1/2 N-m", "force": "+-100 N.", "tolerance": {"radius": "+-1/1 mm"}})
    assert typed["yield"] == plain["yield"]
    assert typed["worst_utilisation"] == plain["worst_utilisation"]


def test_a_column_scatters_by_its_name_and_a_block_reads_back():
    told = rated({"pair.pressure_allow": "+-10 %"})
    assert told["limits"]["pressure"]["limit"] == pytest.approx(0.9e6)
    block = {"friction": "+-5 %", "tolerance": {"radius": "+-1 mm"}, "mode": "rate", "seed": 2}
    asked = read_block(block)
    assert isinstance(asked, Uncertainty)
    assert read_block(asked.block()) == asked
    more = asked.with_scenarios({"grip": [(0.5, 1.0)]})
    assert read_block(more.block()) == more
    assert list(PAIRS["designation"]) == ["firm", "soft"]


def test_families_whose_limits_hold_over_the_catalogue_already_say_so():
    with pytest.raises(synth.InputError, match="hold from mu_min to mu_max of friction_pair already"):
        scattered(read_block({"friction": "+-5 %"}), declared("wrap_spring"))
    with pytest.raises(synth.InputError, match="roller_coupling does not"):
        scattered(read_block({"friction": "+-5 %"}), declared("roller_coupling"))
    with pytest.raises(synth.InputError, match="a requirement such as lining_wear"):
        scattered(read_block({"wear": "new and worn"}), declared("roller_coupling"))


def declared(family):
    return synth.load(family).model(frozenset(), as_catalogs(None)).declaration


def test_what_is_not_all_is_not_shown_as_all():
    assert (yield_text(0.99999), yield_text(1.0)) == ("99.99 %", "100 %")


class Cancelling(synth.DesignProblem):
    """Two limits of which one is a small difference of large terms, so that its residual is a share of these."""

    name, title, sources = "cancelling", "Cancelling", ("made up",)

    def __init__(self, gap, load):
        super().__init__()
        self.gap, self.load = gap, load

    def declare(self, d):
        swell = d.requirement("swell", "-", lower=0.5, upper=2)
        length = d.variable("length", "mm", 900, 1100)
        d.at_most("gap", length * swell - 1.0, self.gap, "mm")
        d.at_most("load", 100 * swell, self.load, "N")
        d.derive("inverse", "1/m", 1 / length)
        d.objective("inverse")


@pytest.mark.parametrize(
    ("gap", "load", "worst"),
    [
        (0.05, 105.0, "gap"),  # both fail: 0.1 m where 0.05 is allowed, a tenth of its terms; 110 N where 105 are
        (0.098, 109.0, "gap"),
        (0.0999, 100.0, "load"),
        (0.2, 200.0, "load"),  # both hold, 50 % and 55 % used
        (0.11, 200.0, "gap"),
        (0.099, 200.0, "gap"),  # the one that fails, whatever the other uses
        (1.0, 109.0, "load"),
    ],
)
def test_the_worst_limit_is_that_which_is_used_most(gap, load, worst):
    problem = Cancelling(gap, load)
    design = synth.evaluate(problem, {"swell": "1"}, values={"length": "1000 mm"})
    told = synth.rate(design, {"swell": "+-10 %"}, problem=problem).designs[0].robust
    assert told["worst_limit"] == worst
    own = told["limits"][worst]
    assert told["worst_utilisation"] == own["utilisation"]
    rivals = [x for x in told["limits"].values() if x["holds"] is own["holds"]]
    assert own["utilisation"] == max(x["utilisation"] for x in rivals)


class Counted(synth.DesignProblem):
    """A limit of a count that is used in full, and one that scatter just lets hold."""

    name, title, sources = "counted", "Counted", ("made up",)

    def declare(self, d):
        swell = d.requirement("swell", "-", lower=0.5, upper=2)
        discs = d.count("discs", 1, 4)
        length = d.variable("length", "mm", 1, 100)
        d.at_most("discs_practice", discs, 1, "-")
        d.at_most("room", length * swell, 0.055 * (1 + 1e-9), "mm")
        d.derive("inverse", "1/m", discs / length)
        d.objective("inverse")


def test_of_limits_used_alike_the_one_that_scatter_moves_is_the_worst():
    design = synth.evaluate(Counted(), {"swell": "1"}, values={"length": "50 mm", "discs": 1})
    told = synth.rate(design, {"swell": "+-10 %"}, problem=Counted()).designs[0].robust
    assert (told["holds"], told["worst_limit"]) == (True, "room")
    assert told["worst_at"] == pytest.approx({"swell": 1.1})
    told = synth.rate(design, {"swell": "+-5 %"}, problem=Counted()).designs[0].robust
    assert told["worst_limit"] == "discs_practice"
