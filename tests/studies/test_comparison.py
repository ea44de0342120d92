"""Several families asked the same: who serves, who loses and why, and one front against plain enumeration of all."""

import dataclasses
import io
import json

import casadi as ca
import numpy as np
import pandas as pd
import pytest
from rich.console import Console

import synth
import synth.robust.robust_front
import synth.studies.families.compare
import synth.studies.families.competitor
from synth import DesignProblem
from synth.errors import NotCoveredError
from synth.order.feasibility import Status
from synth.question.settings import SearchSettings
from synth.search.settings import TUNING
from synth.search.stages.challenge import Challenge
from synth.studies.families.compare import compare
from synth.studies.families.requirement_sheet import applicants, common_objectives, sheet_of
from synth.studies.settings import COMPARING
from synth.tables.catalogs import Catalogs
from synth.terminal.choice_console import how_long, print_comparison
from synth.units import typed_quantity
from tests.sample_problems.shaft_brake import CATALOGS, NEEDED, ShaftBrake
from tests.shipped import FAMILIES
from tests.tuned import tuned

METALS = pd.DataFrame(
    {
        "designation": ["plain", "strong"],
        "yield_Re [N/mm2]": [200.0, 500.0],
        "density [kg/m3]": [7850.0, 7900.0],
        "source": ["invented"] * 2,
    }
)
OWN = {"own_metals": METALS}
SIZES = np.arange(10, 81) * 1e-3
LOAD, SPAN = 2000.0, 0.5


class Solid(DesignProblem):
    """A solid square bar."""

    name, title, sources = "solid", "Solid bar", ("statics",)
    understands = ("load", "span", "room")
    factor = 1.0

    def declare(self, d):
        finish = d.option("finish", ("raw", "coated"), "raw")
        load = d.requirement("load", "N", lower=1, upper=1e5)
        span = d.requirement("span", "mm", 500, lower=10, upper=5000)
        room = d.requirement("room", "mm", lower=1, upper=500, optional=True)
        d.requirement("shade", "-", 1.0, text="means something of its own here")
        size = d.variable("size", "mm", 10, 80, grid=1, text="Side of the bar")
        metal = d.part("metal", "own_metals")
        d.derive(
            "mass",
            "kg",
            self.factor * metal.density * size**2 * span * (1.1 if finish == "coated" else 1.0),
            text="Of the bar",
        )
        d.derive("sag", "mm", load * span**3 / (48 * 2.1e11 * size**4 / 12))
        d.at_most("stress", load * span / 4 / (size**3 / 6), metal.yield_Re, "N/mm2")
        if room is not None:
            d.at_most("room", size, room, "mm")
        d.objective("mass")
        d.objective("sag")


class Padded(Solid):
    """The same with half as much again for nothing: beaten everywhere."""

    name, title, factor = "padded", "Padded bar", 1.5


class Tube(DesignProblem):
    """A thin square tube."""

    name, title, sources = "tube", "Tube", ("statics",)
    understands = ("load", "span")

    def declare(self, d):
        load = d.requirement("load", "N", lower=1, upper=1e5)
        span = d.requirement("span", "mm", 500, lower=10, upper=5000)
        side = d.variable("side", "mm", 10, 80, grid=1)
        wall = d.variable("wall", "mm", 1, 4, grid=0.5)
        metal = d.part("metal", "own_metals")
        d.derive("mass", "kg", metal.density * 4 * side * wall * span + 1.0, text="With end caps")
        d.derive("sag", "mm", load * span**3 / (48 * 2.1e11 * 2 / 3 * side**3 * wall))
        d.at_most("stress", load * span / 4 / (4 / 3 * side**2 * wall), metal.yield_Re, "N/mm2")
        d.at_least("no_buckling", wall, side / 30, "mm")
        d.objective("mass")
        d.objective("sag", default=False)


class Weak(Solid):
    """Never feasible."""

    name, title = "weak", "Weak bar"

    def declare(self, d):
        super().declare(d)
        d.at_most("hopeless", d.variables["size"].sx, 0.005, "mm")


class Stranger(DesignProblem):
    """Something else altogether."""

    name, title, sources = "stranger", "Stranger", ("none",)
    understands = ("load",)

    def declare(self, d):
        load = d.requirement("load", "N", lower=1, upper=1e5)
        d.requirement("colour", "-")
        size = d.variable("size", "mm", 10, 80)
        d.derive("mass", "kg", size * load)
        d.at_least("big", size, 0.02, "mm")
        d.objective("mass")


ALL = [Solid, Padded, Tube, Weak, Stranger]


def enumerated(bars=1.0, tubes=1.0):
    """Return mass and sag of every makeable bar and tube that holds so many times the load: plain arithmetic."""
    found = []
    for re, density in METALS[["yield_Re [N/mm2]", "density [kg/m3]"]].itertuples(index=False):
        a = SIZES[bars * LOAD * SPAN / 4 / (SIZES**3 / 6) <= re * 1e6]
        found.append(np.stack([density * a**2 * SPAN, LOAD * SPAN**3 / (48 * 2.1e11 * a**4 / 12)], axis=1))
        s, t = (x.ravel() for x in np.meshgrid(SIZES, np.arange(2, 9) * 0.5e-3))
        ok = (tubes * LOAD * SPAN / 4 / (4 / 3 * s**2 * t) <= re * 1e6) & (t >= s / 30 * (1 - 1e-9))
        s, t = s[ok], t[ok]
        found.append(
            np.stack([density * 4 * s * t * SPAN + 1.0, LOAD * SPAN**3 / (48 * 2.1e11 * 2 / 3 * s**3 * t)], axis=1)
        )
    return np.concatenate(found)


@pytest.fixture(scope="module")
def found():
    return compare(ALL, {"load": LOAD}, catalogs=OWN, points=15)


def outcome(found, family):
    return next(x for x in found.outcomes if x.family == family)


def test_the_common_front_is_that_of_all_makeable_designs(found):
    assert found.certificate.kind == "global"
    assert found.status is Status.OPTIMAL
    every = enumerated()
    own = np.array([list(d.objectives.values()) for d in found.designs])
    for row in own:
        assert not np.any(np.all(every < row * (1 - 1e-3) * (1 - 1e-9), axis=1))
        assert np.any(np.all(np.isclose(every, row, rtol=1e-9), axis=1))
    assert own.min(axis=0) == pytest.approx(every.min(axis=0), rel=1.001e-3)
    assert set(found.families) == {"solid", "tube"}
    assert [d.rank for d in found.designs] == list(range(1, len(own) + 1))
    assert sorted(d.score for d in found.designs) == [d.score for d in found.designs]
    assert {d.frame.family for d in found.designs} == {"solid", "tube"}


def test_every_family_that_lost_is_told_why(found):
    assert [x.family for x in found.outcomes] == ["solid", "padded", "tube", "weak", "stranger"]
    assert outcome(found, "solid").outcome == outcome(found, "tube").outcome == "listed"
    assert outcome(found, "solid").listed + outcome(found, "tube").listed == len(found.designs)
    padded = outcome(found, "padded")
    assert padded.outcome == "beaten"
    winner = padded.beaten_by
    assert f"by #{winner.rank} ({winner.frame.family})" in padded.sentence
    least = {n: min(d.objectives[n] for d in padded.front.designs) for n in ("mass", "sag")}
    mass, sag = (
        f"least {n} {typed_quantity(least[n], unit, 4)} against {typed_quantity(winner.objectives[n], unit, 4)}"
        for n, unit in (("mass", "kg"), ("sag", "mm"))
    )
    assert padded.sentence.endswith(f": {mass}, {sag}")
    assert winner.objectives["mass"] > min(d.objectives["mass"] for d in found.designs)  # not the best of all
    for design in padded.front.designs:
        assert any(all(d.objectives[n] <= design.objectives[n] for n in found.objectives) for d in found.designs)
    weak = outcome(found, "weak")
    assert weak.outcome == "infeasible"
    assert "hopeless" in weak.sentence
    stranger = outcome(found, "stranger")
    assert (stranger.outcome, stranger.sentence) == ("refused", "it needs colour")
    assert stranger.front is None


def test_objectives_in_common_are_chosen_with_the_defaults_first():
    tables = Catalogs(OWN)
    sheet = sheet_of(requirements={"load": LOAD})
    assert common_objectives(applicants([Solid, Tube], sheet, tables), None) == {"mass": "min", "sag": "min"}
    both = applicants([Solid, {"family": Stranger, "requirements": {"colour": 1}}], sheet, tables)
    assert common_objectives(both, None) == {"mass": "min"}
    assert common_objectives(both, {"sag": "max"}) == {"sag": "max"}
    assert both[1].misfits == ["has no quantity sag to be compared by"]
    for asked, words in (
        (["masss"], ["masss", "did you mean mass"]),
        (["size"], ["size", "a sense"]),
        ({"mass": "small"}, ["mass", "min or max"]),
        ([], ["at least one"]),
    ):
        with pytest.raises(synth.InputError) as error:
            common_objectives(applicants([Solid, Tube], sheet, tables), asked)
        assert all(word in str(error.value) for word in words)


def test_objectives_of_some_families_alone_are_told_not_to_count():
    families = [Solid, Tube, {"family": Stranger, "requirements": {"colour": 1}}]
    mixed = compare(families, {"load": LOAD}, catalogs=OWN, points=4)
    assert list(mixed.objectives) == ["mass"]
    assert mixed.not_compared == ["not compared by sag, an objective of solid alone: stranger has no such objective"]
    assert compare(families, {"load": LOAD}, catalogs=OWN, points=4, objectives=["mass"]).not_compared == []
    (told,) = compare([*families, families[-1]], {"load": LOAD}, catalogs=OWN, points=4).not_compared
    assert told.endswith("stranger, stranger_2 have no such objective")
    alike = compare([Solid, Tube], {"load": LOAD}, catalogs=OWN, points=4)
    assert alike.not_compared == []


def test_a_screen_shows_what_all_families_have_and_what_each_means(found):
    stream = io.StringIO()
    print_comparison(found, Console(file=stream, width=80, markup=False, highlight=False), every=True)
    output = stream.getvalue()
    assert max(map(len, output.splitlines())) <= 80
    words = " ".join(output.split())
    assert f"{len(found.designs)} designs of 2 families; #1 comes nearest to the best mass and sag" in words
    # Also of families that were searched and have no design there.
    assert "mass means: Of the bar (solid, padded, weak); With end caps (tube)" in words


def test_what_a_family_does_not_understand_makes_it_step_back():
    found = compare([Solid, Tube], {"load": LOAD, "room": "60 mm"}, catalogs=OWN, points=4)
    assert outcome(found, "tube").sentence == "it does not understand room"
    assert set(found.families) == {"solid"}
    assert all(d.values["size"] <= 0.06 + 1e-9 for d in found.designs)
    found = compare([Solid, Tube], {"load": LOAD}, catalogs=OWN, points=4, limits={"size": "<= 60 mm"})
    assert outcome(found, "tube").sentence == "it has no quantity size"
    found = compare([Solid, Tube], {"load": LOAD}, catalogs=OWN, points=4, options={"finish": "coated"})
    assert "option" in outcome(found, "tube").sentence
    found = compare([Solid, Tube], {"load": LOAD}, catalogs=OWN, points=4, fix={"wall": "2 mm"})
    assert outcome(found, "solid").sentence == "it has nothing to fix as wall"
    assert all(d.values["wall"] == pytest.approx(0.002) for d in found.designs)


def test_what_concerns_one_family_is_stated_under_it():
    entries = [
        {"family": Solid, "requirements": {"shade": 2}, "limits": {"size": "<= 50 mm"}},
        {"family": Solid, "options": {"finish": "coated"}},
        {"family": Stranger, "requirements": {"colour": 3}},
    ]
    found = compare(entries, {"load": LOAD}, objectives=["mass"], catalogs=OWN, points=4)
    assert [x.family for x in found.outcomes] == ["solid", "solid_2", "stranger"]
    assert found.outcomes[0].front.frame.requirements["shade"] == "2"
    assert all(d.values["size"] <= 0.05 + 1e-9 for d in found.outcomes[0].front.designs)
    assert found.outcomes[1].front.frame.options == {"finish": "coated"}
    assert len(found.designs) == 1


@pytest.mark.parametrize(
    ("families", "requirements", "more", "words"),
    [
        ([Solid, Tube], {"load": LOAD, "laod": 3}, {}, ["requirements", "laod", "did you mean load"]),
        ([Solid, Tube], {"load": LOAD, "shade": 3}, {}, ["shade", "in common", "under that family"]),
        ([Solid, Tube], {}, {}, ["a sheet that one of the families can serve", "needs load"]),
        ([Solid, Tube], {"load": "2 kg"}, {}, ["requirement load", "2 kg"]),
        ([Solid, Tube], {"load": LOAD}, {"limits": {"masss": "<= 2 kg"}}, ["limits", "masss", "did you mean mass"]),
        ([Solid, Tube], {"load": LOAD}, {"parts": {"wheel": ["x"]}}, ["parts", "wheel"]),
        ([Solid, Tube], {"load": LOAD}, {"options": {"finsh": "raw"}}, ["finsh"]),
        ([Solid], {"load": LOAD}, {"catalogs": {**OWN, "unused": METALS}}, ["catalogs", "unused"]),
        ([], {"load": LOAD}, {}, ["family", "list of families"]),
        ("solid", {"load": LOAD}, {}, ["family", "'any', or a list"]),
        ([{"family": Solid, "points": 3}], {"load": LOAD}, {}, ["family", "points"]),
        (["no_such_family"], {"load": LOAD}, {}, ["family", "no_such_family"]),
        ([{"family": Solid, "limits": {"masss": "<= 2 kg"}}], {"load": LOAD}, {}, ["solid: limits", "mean mass"]),
        ([{"family": Solid, "requirements": {"lod": 3}}], {}, {}, ["solid: requirements", "lod", "mean load"]),
        ([{"family": Solid, "parts": {"wheel": "x"}}], {"load": LOAD}, {}, ["solid: parts", "wheel"]),
        ([{"family": Solid, "fix": {"wall": 1}}, Tube], {"load": LOAD}, {}, ["solid: fix", "wall"]),
        ([{"family": Solid, "robust": {"laod": "+-5 %"}}], {"load": LOAD}, {}, ["solid: robust", "laod", "mean load"]),
        ([{"family": Solid, "robust": {"load": 5}}], {"load": LOAD}, {}, ["solid: robust: load", "a range"]),
        ([{"family": Solid, "robust": {"mode": "Rate"}}, Tube], {"load": LOAD}, {}, ["solid: robust", "at least one"]),
        ([{"family": Solid, "robust": {"load": "+-5 %", "mode": "Rate"}}], {"load": LOAD}, {}, ["solid: robust: mode"]),
        ([Solid], {"load": LOAD}, {"points": 0}, ["points"]),
    ],
)
def test_what_is_wrong_for_every_family_is_refused(families, requirements, more, words):
    with pytest.raises(synth.InputError) as error:
        compare(families, requirements, **{"catalogs": OWN, **more})
    assert all(word in str(error.value) for word in words), str(error.value)


def test_a_value_that_one_family_refuses_leaves_the_others():
    class Careful(Tube):
        name = "careful"

        def declare(self, d):
            super().declare(d)
            d.refuse("too_heavy", d.requirements["load"].sx > 1500, "at most 1500 N")

    found = compare([Solid, Careful], {"load": LOAD}, catalogs=OWN, points=4)
    assert outcome(found, "careful").outcome == "refused"
    assert "too_heavy" in outcome(found, "careful").sentence
    assert set(found.families) == {"solid"}


@pytest.mark.slow
def test_one_family_finds_what_beats_the_others_when_it_is_asked_again(monkeypatch):
    """A front of few points says little between them: the challenge must find what lies there."""
    found = compare([Solid, Tube, Padded], {"load": LOAD}, catalogs=OWN, points=2)
    assert found.certificate.kind == "global"
    every = enumerated()
    for design in found.designs:
        own = np.array(list(design.objectives.values()))
        assert not np.any(np.all(every < own * (1 - 1e-3) * (1 - 1e-9), axis=1))
    # Without the challenge nothing is proven over all families.
    nothing = Challenge(closed=False, better=[], amounts=np.zeros(2))
    monkeypatch.setattr(synth.studies.families.compare, "challenge", lambda state, listed, deadline: nothing)
    assert compare([Solid, Tube], {"load": LOAD}, catalogs=OWN, points=2).certificate.kind == "heuristic"


def test_few_points_still_show_every_family_that_has_one(found):
    few = compare([Solid, Tube], {"load": LOAD}, catalogs=OWN, points=2)
    assert len(few.designs) == 2
    assert set(few.families) == {"solid", "tube"}


def test_an_interruption_keeps_the_families_that_are_finished(tmp_path):
    kept = {}

    def stop(state):
        if state["stage"].startswith("padded"):
            raise KeyboardInterrupt

    found = compare(
        [Solid, Padded, Tube], {"load": LOAD}, catalogs=OWN, points=4, progress=stop, finished=kept.__setitem__
    )
    assert found.interrupted == "interrupted"
    assert found.certificate.kind == "heuristic"
    assert list(kept) == ["solid", "padded"]
    assert len(kept["solid"].designs) == 4
    assert outcome(found, "tube").outcome == "stopped"
    assert found.designs
    assert all(d.status is Status.FEASIBLE and d.gap is None for d in found.designs)
    late = compare([Solid, Tube], {"load": LOAD}, catalogs=OWN, points=4, time_limit=1e-9)
    assert late.interrupted == "time limit"
    assert late.status is Status.NOT_SOLVED


def test_files(found, tmp_path):
    folder = found.save(tmp_path / "out")
    table = pd.read_csv(folder / "designs.csv")
    assert table["rank"].tolist() == [d.rank for d in found.designs]
    assert table["family"].tolist() == found.families
    assert table.loc[table["family"] == "tube", "size [mm]"].isna().all()
    assert table.loc[table["family"] == "solid", "size [mm]"].notna().all()
    lines = pd.read_csv(folder / "families.csv").set_index("family")
    assert lines.loc["tube", "meaning of mass"] == "With end caps"
    assert lines["outcome"].tolist() == ["listed", "beaten", "listed", "infeasible", "refused"]
    content = json.loads((folder / "comparison.json").read_text())
    assert content["certificate"]["kind"] == "global"
    assert {x["family"] for x in content["families"] if x["folder"]} == {"solid", "padded", "tube", "weak"}
    assert all((folder / name / "front.json").exists() for name in ("solid", "padded", "tube", "weak"))
    assert len(list(folder.glob("design_*.yaml"))) == len(found.designs)


# ---- what scatters --------------------------------------------------------------------------------------------------

SCATTER = {"load": "+-40 %"}


def check_enumerated(found, every):
    """Check that no enumerated design beats a listed one, and that each is one of them."""
    assert found.certificate.kind == "global"
    for design in found.designs:
        row = np.array(list(design.objectives.values()))
        assert not np.any(np.all(every < row * (1 - 1e-3) * (1 - 1e-9), axis=1))
        assert np.any(np.all(np.isclose(every, row, rtol=1e-9), axis=1))


@pytest.fixture(scope="module")
def sure():
    return compare(ALL, {"load": LOAD}, catalogs=OWN, points=15, robust=SCATTER)


def test_designs_of_all_families_stand_what_scatters(sure, found):
    assert {x.family: x.outcome for x in sure.outcomes} == {x.family: x.outcome for x in found.outcomes}
    check_enumerated(sure, enumerated(1.4, 1.4))
    assert all(d.robust["holds"] and d.robust["proof"] == "proven" for d in sure.designs)
    least = min(d.objectives["mass"] for d in sure.designs)
    assert least == pytest.approx(enumerated(1.4, 1.4)[:, 0].min(), rel=1e-9)
    assert least > 1.1 * min(d.objectives["mass"] for d in found.designs)


def test_what_scatters_is_stated_for_a_family_alone():
    entries = [Solid, {"family": Tube, "robust": {"load": "none"}}]
    found = compare(entries, {"load": LOAD}, catalogs=OWN, points=15, robust=SCATTER)
    check_enumerated(found, enumerated(1.4, 1.0))
    rated = {name: bool(d.robust) for d, name in zip(found.designs, found.families, strict=True)}
    assert rated == {"solid": True, "tube": False}
    # The same the other way round; a name that one family alone has may stand under it by its symbol.
    entries = [{"family": Solid, "robust": SCATTER}, Tube]
    again = compare(entries, {"load": LOAD}, catalogs=OWN, points=15)
    assert [d.objectives for d in again.designs] == [d.objectives for d in found.designs]


def test_designs_of_all_families_may_be_rated_alone(found):
    rated = compare(ALL, {"load": LOAD}, catalogs=OWN, points=15, robust={**SCATTER, "mode": "rate"})
    assert [d.objectives for d in rated.designs] == [d.objectives for d in found.designs]
    assert {d.robust["holds"] for d in rated.designs} == {True, False}
    assert rated.certificate.kind == "global"


def test_a_family_without_what_scatters_steps_back():
    found = compare([Solid, Tube], {"load": LOAD}, catalogs=OWN, points=4, robust={"wall": "+-0.1 mm"})
    assert outcome(found, "solid").sentence == "it has nothing that scatters as wall"
    assert set(found.families) == {"tube"}
    found = compare([Solid, Tube], {"load": LOAD}, catalogs=OWN, points=4, robust={"tolerance": {"wall": "+-0.1 mm"}})
    assert "robust: tolerance: wall" in outcome(found, "solid").sentence
    assert set(found.families) == {"tube"}


@pytest.mark.parametrize(
    ("robust", "words"),
    [
        ({"laod": "+-5 %"}, ["robust", "laod", "did you mean load"]),
        ({"shade": "+-5 %"}, ["robust", "shade", "in common", "under that family"]),
        ({"load": "+-150 %"}, ["robust: load", "+-150 %"]),
        ({"load": 5}, ["robust: load", "a range"]),
        ({"friction": "+-5 %"}, ["robust: friction", "uses the friction of a table"]),
        ("load", ["robust", "{'friction': '+-10 %'}"]),
        ({"load": "+-5 %", "samples": 5}, ["robust: samples"]),
    ],
)
def test_ranges_that_no_family_can_stand_are_refused(robust, words):
    with pytest.raises(synth.InputError) as error:
        compare([Solid, Tube], {"load": LOAD}, catalogs=OWN, robust=robust)
    assert all(word in str(error.value) for word in words), str(error.value)


def test_files_tell_how_designs_stand_the_range(sure, tmp_path):
    folder = sure.save(tmp_path / "out")
    table = pd.read_csv(folder / "designs.csv")
    assert list(table.columns)[-8:] == [
        "robust",
        "proof",
        "yield",
        "yield low",
        "yield high",
        "worst limit",
        "worst utilisation",
        "worst at",
    ]
    assert set(table["robust"]) == {"yes"}
    limits = pd.read_csv(folder / "robust.csv")
    assert set(limits["rank"]) == set(table["rank"])
    content = json.loads((folder / "comparison.json").read_text())
    assert content["settings"]["sheet"]["robust"] == SCATTER
    assert all(x["robust"]["holds"] for x in content["designs"])


class Brake(ShaftBrake):
    """Hums in the middle of a range of speeds."""

    name, understands = "brake", ("torque", "speed")


class OtherBrake(Brake):
    """The same by another name."""

    name = "other_brake"


WIDE = {"speed": "+-30 %", "samples": 512}


def brakes(limits=None, tuning=TUNING):
    limits = {"size": ">= 200 mm"} if limits is None else limits
    sheet = sheet_of(requirements=NEEDED, limits=limits, fix={"force": "3 kN"}, robust=WIDE)
    tables = Catalogs(CATALOGS)
    found = applicants([Brake, OtherBrake], sheet, tables)
    ranked = {"objectives": common_objectives(found, {"size": "min", "worth": "min"}), "weights": None, "grid": True}
    settings = SearchSettings(points=3)
    return synth.studies.families.compare._Comparing(found, sheet, ranked, tables, settings, None, False, tuning).run(
        None
    )


@pytest.mark.slow
def test_limits_that_fail_between_corners_are_posed_for_every_family():
    found = brakes()
    assert found.certificate.kind == "global"
    assert all(x.front.statistics["robust"]["searches"] > 1 for x in found.outcomes)
    assert all(d.robust["holds"] for d in found.designs)
    assert min(d.values["size"] for d in found.designs) == pytest.approx(2 * 0.11 / 0.7, rel=1e-6)


@pytest.mark.slow
def test_nothing_is_proven_of_all_where_designs_were_taken_off():
    one_search = tuned(robust={"searches": 1, "searches_for_first": 1})
    found = brakes(tuning=one_search)
    assert all(x.front.statistics["robust"]["searches"] == 1 for x in found.outcomes)
    assert any(x.front.statistics["robust"]["taken_off"] for x in found.outcomes)
    assert found.certificate.kind == "heuristic"
    none = brakes({"size": "200 mm .. 250 mm"}, one_search)
    assert none.designs == []
    assert none.certificate.kind == "heuristic"
    assert {x.sentence for x in none.outcomes} == {"no design was found that keeps its limits over the whole range"}


def test_what_beats_others_must_stand_the_range_as_well(monkeypatch):
    # Of a front of few points it is told only afterwards what lies between; what is found then is rated as well: the
    # nearest to the ideal of both, and what beats a design of the other.
    rated, own = [], synth.studies.families.competitor.Competitor.standing

    def standing(self, designs, deadline):
        rated.extend(own(self, designs, deadline))
        return rated[len(rated) - len(designs) :]

    monkeypatch.setattr(synth.studies.families.competitor.Competitor, "standing", standing)
    found = compare([Solid, Tube], {"load": LOAD}, catalogs=OWN, points=6, robust=SCATTER)
    assert found.certificate.kind == "global"
    assert [d.robust["holds"] for d in rated] == [True, True]
    # Where it fails nothing says that what is left cannot be beaten.
    monkeypatch.setattr(synth.studies.families.competitor.Competitor, "standing", lambda self, designs, deadline: [])
    found = compare([Solid, Tube], {"load": LOAD}, catalogs=OWN, points=6, robust=SCATTER)
    assert found.certificate.kind == "heuristic"


# ---- the families that there are ------------------------------------------------------------------------------------


@pytest.mark.slow
@pytest.mark.parametrize("family", FAMILIES)
def test_a_family_understands_only_what_it_uses(family):
    problem = synth.load(family)
    tables = Catalogs()
    declared = problem.model(frozenset(), tables).declaration.requirements
    # Others follow from some of these words where they are stated alone, and none where all are; one asks for a start,
    # and gear and rope matter where a machine hangs on them.
    for name in problem.understands:
        hoist = {"lifted_mass", "drum_diameter", name}
        words = ({name}, {name, "power"}, {*declared, name}, {"driven_inertia", name}, hoist)
        models = [problem.model(frozenset(stated), tables) for stated in words]
        assert any(name in m.declaration.requirements and reads(m, name) for m in models), name


def reads(model, name):
    """Whether what is found, a limit or the default of another requirement depends on one."""
    symbols = model.requirement_symbols
    records = model.declaration.requirements.values()
    defaults = ca.vertcat(*(r.default for r in records if isinstance(r.default, ca.SX) and not r.given))
    if symbols[name] in map(str, ca.symvar(ca.SX(defaults))):
        return True
    used = [node for x in model.constraints for node in x.nodes] + list(model.quantity_node.values())
    k = next(i for i, e in enumerate(model.data_inputs) if (e.kind, e.name) == ("requirement", name))
    marked = model.program.dependence([len(model.variables) + k])
    return any(marked[node] for node in used)


PLAIN = {"load_torque": "100 N*m", "driver_speed": "1450 1/min", "driven_inertia": "0.4 kg*m2"}


def test_who_serves_a_plain_duty_and_what_the_others_say():
    found = {one.label: one for one in applicants("any", sheet_of(requirements=PLAIN), Catalogs())}
    serving = {label for label, one in found.items() if not one.misfits}
    assert serving == {f for f in FAMILIES if "centrifugal" in f} | {
        "cone_clutch",
        "disc_clutch",
        "electromagnetic_clutch",
        "magnetic_powder_clutch",
        "multi_plate_clutch",
    }
    assert "use a friction clutch, and this beside it" in found["roller_coupling"].misfits[0]
    for label in ("wrap_spring", "wrap_spring_actuated"):
        assert "use a friction clutch" in found[label].misfits[0]
        assert found[label].declined
        assert "needs" not in " ".join(found[label].misfits)
    sheet = sheet_of(requirements=PLAIN, options={"duty": "overrun"})
    (powder,) = applicants(["magnetic_powder_clutch"], sheet, Catalogs())
    assert (powder.misfits, powder.declined) == (["drives both ways: use wrap_spring"], True)
    own = {"family": "magnetic_powder_clutch", "options": {"duty": "overrun"}}
    (powder,) = applicants([own], sheet_of(requirements=PLAIN), Catalogs())
    assert (powder.misfits, powder.declined) == (["drives both ways: use wrap_spring"], True)


def test_lasting_slip_and_overrunning_name_who_serves_them():
    slip = {"required_torque": "50 N*m", "driver_speed": "1000 1/min", "slip_speed": "100 1/min"}
    found = {one.label: one for one in applicants("any", sheet_of(requirements=slip), Catalogs())}
    assert {label for label, one in found.items() if not one.misfits} == {"magnetic_powder_clutch"}
    assert all(one.declined for one in found.values() if one.misfits)
    over = {"required_torque": "50 N*m", "driver_speed": "1000 1/min", "overrun_speed": "100 1/min"}
    found = {one.label: one for one in applicants("any", sheet_of(requirements=over), Catalogs())}
    assert [label for label, one in found.items() if not one.misfits] == ["wrap_spring"]
    assert all("use wrap_spring" in one.misfits[0] for one in found.values() if one.misfits)


def test_a_family_alone_says_what_serves_what_it_cannot_do():
    with pytest.raises(NotCoveredError, match="another family: this one takes the load without slip"):
        synth.synthesize("wrap_spring", PLAIN)
    with pytest.raises(NotCoveredError, match="no dry lining stands lasting slip: use magnetic_powder_clutch"):
        synth.synthesize("disc_clutch", PLAIN | {"slip_speed": "10 1/min"})


def test_what_cannot_matter_to_a_family_is_left_out_and_said():
    wants = {"required_torque": "30 N*m", "driver_speed": "960 1/min", "engagements_per_hour": "60 1/h"}
    found = compare(["wrap_spring"], wants, points=2)
    assert "engagements_per_hour" not in found.designs[0].frame.requirement_values
    assert found.outcomes[0].sentence.endswith("; not used: engagements_per_hour")
    assert found.outcomes[0].not_used == "engagements_per_hour"
    wants = {"power": "15 kW", "driver_speed": "1450 1/min", "contact_speed_max": "1000 1/min"}
    with pytest.raises(synth.InputError, match="is engaged from outside at any speed: use a centrifugal clutch"):
        compare(["disc_clutch"], wants | {"driven_inertia": "0.4 kg*m2"})


def test_a_requirement_of_others_may_be_a_limit_and_that_is_told():
    room = {**PLAIN, "mass_limit": "1.3 kg"}  # a requirement of the roller coupling
    found = compare(["disc_clutch", "wrap_spring", "roller_coupling"], room, points=2, limits={"mass": ">= 1.1 kg"})
    assert outcome(found, "disc_clutch").sentence.endswith("; as limits: mass <= 1.3 kg")
    assert all(1.1 <= d.values["mass"] <= 1.3 for d in found.designs)
    table = found.families_frame().set_index("family")
    assert table.loc["wrap_spring", "instead"] == "a friction clutch, or state peak_torque alone"
    assert table.loc["roller_coupling", "instead"] == "a friction clutch, and this beside it"
    one = applicants(["centrifugal_lever"], sheet_of(requirements={**PLAIN, "contact_speed_min": 800}), Catalogs())[0]
    assert one.as_limits == {"contact_speed": ">= 800"}


# Words of a drive; ambient temperature, top speed, wear life and shaft are requirements of some layers alone.
WALKED = """load_torque power power_speed required_torque driver_speed safety_factor peak_torque overload_torque
idle_speed contact_speed_min contact_speed_max full_torque_speed slip_speed overrun_speed driven_inertia
engagements_per_hour switching_factor speed_factor outer_diameter_limit length_limit mass_limit slip_time_limit
jerk_limit acceleration_limit startup_torque""".split()


@pytest.mark.parametrize("family", FAMILIES)
def test_every_family_has_an_answer_to_each_word_of_a_drive(family):
    """Used, a limit, of no matter, or not covered: nothing that others understand is passed over."""
    problem = synth.load(family)
    answers = {*problem.understands, *problem.declines, *problem.disregards, *problem.as_limits}
    assert set(WALKED) - answers == set()
    quantities = {name for name, _, _ in problem.model(frozenset(), Catalogs()).declaration.quantities()}
    assert set(problem.as_limits.values()) <= quantities


@pytest.mark.parametrize("family", FAMILIES)
def test_a_family_has_one_answer_to_each_requirement(family):
    problem = synth.load(family)
    declared = problem.model(frozenset(), Catalogs()).declaration.requirements
    assert not set(declared) & {*problem.declines, *problem.disregards}
    assert not set(problem.declines) & set(problem.disregards)


@pytest.mark.slow
def test_families_that_understand_the_same_measure_it_alike():
    units = {}
    for family in FAMILIES:
        problem = synth.load(family)
        for words in ((), ("driven_inertia",)):
            declared = problem.model(frozenset(words), Catalogs()).declaration.requirements
            for name in set(problem.understands) & set(declared):
                units.setdefault(name, set()).add(declared[name].unit)
    assert {name: kinds for name, kinds in units.items() if len(kinds) > 1} == {}
    assert "outer_diameter_limit" in units


# ---- time that is shared --------------------------------------------------------------------------------------------


def looked(families, budget, **more):
    """Compare families that have so many seconds where no time limit is stated."""
    sheet, tables = sheet_of(requirements={"load": LOAD}), Catalogs(OWN)
    found = applicants(families, sheet, tables)
    ranked = {"objectives": common_objectives(found, None), "weights": None, "grid": True}
    settings, limits = SearchSettings(points=4), dataclasses.replace(COMPARING, budget=budget)
    comparing = synth.studies.families.compare._Comparing(
        found, sheet, ranked, tables, settings, more.pop("progress", None), False, limits=limits
    )
    return comparing.run(**{"finished": None, **more})


def test_best_found_is_told_where_the_budget_ends_a_search():
    kept = []
    late = looked([Solid, Tube], 1e-9, finished=lambda label, front: kept.append((label, front.interrupted)))
    assert kept == [("solid", "time limit")]
    assert (late.interrupted, late.status) == ("time limit", Status.NOT_SOLVED)  # nothing was found
    assert late.certificate.kind == "heuristic"
    early = looked([Solid, Tube], 1e3)
    assert (early.certificate.kind, early.certificate.budget) == ("global", None)


def test_a_budget_that_is_over_is_no_interruption(monkeypatch):
    """Some designs and no proof: it is a result, and says that more time may do more."""
    search = synth.studies.families.compare._Comparing._searched

    def ended(self, one, *more):
        member = search(self, one, *more)
        front = dataclasses.replace(member.front, interrupted="time limit" if one.label == "tube" else "")
        return dataclasses.replace(member, front=front)

    monkeypatch.setattr(synth.studies.families.compare._Comparing, "_searched", ended)
    told = []
    found = looked([Solid, Tube], 1e3, so_far=told.append)
    assert [x.interrupted for x in told] == ["under way"] * 3  # the tube is searched once more
    assert [len(x.designs) > 0 for x in told] == [True] * 3
    assert outcome(told[0], "tube").sentence == "not searched (under way)"
    assert (found.interrupted, found.status) == ("", Status.FEASIBLE)
    assert (found.certificate.kind, found.certificate.budget) == ("heuristic", 1e3)
    assert found.sentence().startswith("not proven: best found in the budget of 1000 s;")
    assert outcome(found, "tube").sentence.endswith("; best found, its search was not finished")
    assert "best found" not in outcome(found, "solid").sentence
    assert all(d.status is Status.FEASIBLE and d.gap is None for d in found.designs)


def test_families_with_the_fewest_combinations_come_first():
    class Bundle(Solid):
        name, title = "bundle", "Bundle of bars"

        def declare(self, d):
            super().declare(d)
            d.count("pieces", 1, 50)

    searched, told = [], []

    def note(state):
        label = state["stage"].split(":")[0]
        searched.extend([] if searched[-1:] == [label] else [label])
        if label == "tube":
            raise KeyboardInterrupt

    late = looked([Bundle, Solid, Tube], 1e3, progress=note, announce=told.extend)
    assert told == ["solid", "tube", "bundle"]
    assert searched == told[:2]
    assert late.interrupted == "interrupted"
    assert {x.family: x.front is not None for x in late.outcomes} == {"bundle": False, "solid": True, "tube": True}


def test_who_is_stopped_keeps_what_the_first_look_brought(found):
    member = synth.studies.families.competitor.Competitor
    full = next(x.front for x in found.outcomes if x.family == "solid")
    stopped = dataclasses.replace(full, interrupted="time limit")
    empty = dataclasses.replace(full, designs=[], interrupted="time limit")
    first, second, done = (member(None, None, f, list(f.designs), np.zeros(2)) for f in (stopped, empty, full))
    assert second.with_what_it_had(first).front is stopped
    assert len(second.with_what_it_had(first).designs) == len(full.designs)
    assert done.with_what_it_had(first) is done
    assert second.with_what_it_had(None) is second


@pytest.mark.parametrize(
    ("families", "time_limit", "words"),
    [
        (
            3,
            None,
            "3 families serve this sheet: a, b, c. They share 50 s, those with the fewest combinations first. Ct",
        ),
        (3, None, "Ctrl-C keeps what is found; --time-limit gives more time."),
        (3, 20.0, "They share 20 s, those with the fewest combinations first. Ctrl-C keeps what is found."),
        (1, None, "1 family serves this sheet: a. It has 50 s. Ctrl-C"),
    ],
)
def test_the_screen_says_how_long_it_may_take(families, time_limit, words):
    assert words in how_long("abc"[:families], time_limit)


# ---- the first by rank ----------------------------------------------------------------------------------------------


@pytest.mark.parametrize("robust", [None, SCATTER])
def test_the_first_of_all_families_does_not_depend_on_how_many_are_listed(robust):
    every = np.log(enumerated(1.4, 1.4) if robust else enumerated())
    nearest = np.sqrt(((every - every.min(axis=0)) ** 2).mean(axis=1)).min()
    for points in (3, 6, 20, 100):
        first = compare([Solid, Tube, Padded], {"load": LOAD}, catalogs=OWN, points=points, robust=robust).designs[0]
        assert first.score == pytest.approx(nearest, rel=1e-6)


def test_the_first_by_the_ideal_of_all_is_searched_for():
    """Each family's own first lies elsewhere: by its own ideal, which others beat."""
    own = compare([Solid], {"load": LOAD}, catalogs=OWN, points=3)
    both = compare([Solid, Tube], {"load": LOAD}, catalogs=OWN, points=3)
    assert own.designs[0].objectives != both.designs[0].objectives


def test_what_stands_on_the_common_front_stands_on_that_of_its_family(tmp_path):
    found = compare([Solid, Tube, Padded], {"load": LOAD}, catalogs=OWN, points=4)
    fronts = {x.family: x.front for x in found.outcomes}
    for design, family in zip(found.designs, found.families, strict=True):
        assert any(d.objectives == design.objectives for d in fronts[family].designs)
    assert max(len(fronts[name].designs) for name in ("solid", "tube")) > 4
    for name, family in (("solid", Solid), ("tube", Tube)):
        assert fronts[name].verify(family, OWN).holds
