"""Near-equals: which combinations come near a chosen design, against plain enumeration of everything makeable."""

from itertools import product

import numpy as np
import pandas as pd
import pytest

import synth
from synth.question.settings import SearchSettings
from synth.studies import near_optimal as near
from synth.studies.near_optimal import near_equals
from synth.studies.settings import NearLimits

METALS = pd.DataFrame(
    {
        "designation": ["St 37", "C 45", "twin of C 45", "42CrMo4", "cast", "forged"],
        "stress_allow [N/mm2]": [120.0, 170.0, 170.0, 300.0, 95.0, 140.0],
        "density [kg/m3]": [7850.0, 7830.0, 7830.0, 7900.0, 7200.0, 7600.0],
        "source": ["invented"] * 6,
    }
)
HEIGHTS, WIDTHS = np.arange(20, 61) * 1e-3, np.arange(8, 31, 2) * 1e-3
RIBS, ENDS = np.array([1.0, 2.0, 3.0]), {"round": 1.0, "flat": 1.15}
LOAD = 900.0


class Bracket(synth.DesignProblem):
    """A cantilever of ribs: mass against deflection, all of it makeable in steps."""

    name, title, sources = "bracket", "Bracket", ("statics",)

    def declare(self, d):
        load = d.requirement("load", "N", lower=1, upper=1e5)
        height = d.variable("height", "mm", 20, 60, grid=1)
        width = d.variable("width", "mm", 8, 30, grid=2)
        ribs = d.count("ribs", 1, 3)
        end = d.choice("end", tuple(ENDS))
        metal = d.part("metal", "metals")
        section = ribs * width * height**2 / 6
        d.derive("mass", "kg", metal.density * ribs * width * height * 0.4 * end.select(ENDS))
        d.derive("deflection", "mm", load * 0.4**3 / (ribs * width * height**3 * 17e9 * end.select(ENDS)))
        d.derive("stiffness", "N/mm", load / (load * 0.4**3 / (ribs * width * height**3 * 17e9 * end.select(ENDS))))
        d.at_most("stress", load * 0.4 / section, metal.stress_allow, "N/mm2")
        d.at_most("slenderness", height, 5 * width, "mm")
        d.objective("mass")
        d.objective("deflection")
        d.objective("stiffness", "max", default=False)


def everything():
    """Return, per combination, mass and deflection of all that is feasible: plain arithmetic."""
    found = {}
    h, w = np.meshgrid(HEIGHTS, WIDTHS, indexing="ij")
    for row, (ribs, (end, factor)) in product(METALS.itertuples(index=False), product(RIBS, ENDS.items())):
        keep = (LOAD * 0.4 / (ribs * w * h**2 / 6) <= row[1] * 1e6) & (h <= 5 * w * (1 + 1e-9))
        mass = row[2] * ribs * w * h * 0.4 * factor
        deflection = LOAD * 0.4**3 / (ribs * w * h**3 * 17e9 * factor)
        found[row[0], ribs, end] = np.stack([mass[keep], deflection[keep]], axis=1)
    return found


def of(design):
    return str(design.parts["metal"]), design.values["ribs"], design.choices["end"]


@pytest.fixture(scope="module")
def front():
    return synth.synthesize(Bracket, {"load": LOAD}, catalogs={"metals": METALS}, points=12)


@pytest.mark.parametrize(("rank", "within"), [(1, "2 %"), (1, "10 %"), (4, 0.05), (8, "30 %")])
def test_all_combinations_that_come_near_are_counted(front, rank, within):
    chosen = front.designs[rank - 1]
    share = {"2 %": 0.02, "10 %": 0.1, 0.05: 0.05, "30 %": 0.3}[within]
    caps = np.array(list(chosen.objectives.values())) * (1 + share) * (1 + 1e-9)
    members = {key for key, values in everything().items() if np.any(np.all(values <= caps, axis=1))}
    assert of(chosen) in members
    found = near_equals(front, rank, within, count=1000)
    assert found.complete
    assert found.found == len(members) - 1
    assert {of(d) for d in found.designs} == members - {of(chosen)}
    for design, change in zip(found.designs, found.changes, strict=True):
        assert not design.violated
        assert not design.off_grid
        assert max(change.values()) <= share + 1e-9
        own = np.array(list(design.objectives.values()))
        others = everything()[of(design)]
        assert not np.any(np.all(others < own * (1 - 1e-3), axis=1))  # as good as its parts allow
        worst = np.max(own / list(chosen.objectives.values()))
        least = np.min(np.max(others / list(chosen.objectives.values()), axis=1))
        assert worst <= least * (1 + 2e-3)


def test_a_few_of_many_are_as_different_as_possible(front):
    every = near_equals(front, 4, "30 %", count=1000)
    few = near_equals(front, 4, "30 %", count=3)
    assert few.found == every.found > 10

    def apart(a, b):
        return sum(x != y for x, y in zip(of(a), of(b), strict=True))

    taken = [few.reference]
    for design in few.designs:
        least = min(apart(design, other) for other in taken)
        assert least == max(min(apart(d, other) for other in taken) for d in every.designs)
        taken.append(design)
    assert few.differences[0] == tuple(
        f"{name} {x:g}" if name == "ribs" else f"{name} {x}"
        for name, x, y in zip(("metal", "ribs", "end"), of(few.designs[0]), of(few.reference), strict=True)
        if x != y
    )


def test_rows_that_differ_in_their_name_alone_are_other_designs():
    fix = {"metal": "C 45", "ribs": 1, "end": "round"}
    catalogs = {"metals": METALS[METALS["designation"].str.contains("C 45")]}
    front = synth.synthesize(Bracket, {"load": LOAD}, catalogs=catalogs, points=3, fix={"ribs": 1, "end": "round"})
    found = near_equals(front, 1, "0.001 %")
    assert found.found == 1
    assert found.complete
    assert {of(front.designs[0])[0], of(found.designs[0])[0]} == {"C 45", "twin of C 45"}
    assert list(found.changes[0].values()) == pytest.approx([0.0, 0.0], abs=1e-9)
    assert synth.synthesize(Bracket, {"load": LOAD}, catalogs=catalogs, points=3, fix=fix).status == front.status


def test_one_objective_and_one_to_be_large(front):
    catalogs = {"metals": METALS}
    lightest = synth.synthesize(Bracket, {"load": LOAD}, ["mass"], catalogs=catalogs)
    least = lightest.designs[0].values["mass"]
    found = near_equals(lightest, 1, "20 %", count=1000)
    members = {k for k, v in everything().items() if len(v) and v[:, 0].min() <= 1.2 * least * (1 + 1e-9)}
    assert found.found == len(members) - 1
    stiff = synth.synthesize(Bracket, {"load": LOAD}, ["mass", "stiffness"], catalogs=catalogs, points=5)
    found = near_equals(stiff, 2, "5 %", count=100)
    chosen = stiff.designs[1].values
    caps = np.array([chosen["mass"] * 1.05, LOAD / (chosen["stiffness"] * 0.95)]) * (1 + 1e-9)
    members = {k for k, v in everything().items() if np.any(np.all(v <= caps, axis=1))}
    assert found.found == len(members) - 1


@pytest.mark.slow
def test_a_multi_plate_clutch_against_all_rings_of_all_packs():
    duty = {"load_torque": "600 N*m", "driver_speed": "254 rpm", "driven_inertia": "30 kg*m2"}
    parts = {
        "friction_pair": ["paper_wet", "cork_wet"],
        "inner_plate": ["core 1.5", "core 2"],
        "outer_plate": ["core 2"],
    }
    limits = {"friction_surfaces": "16 .. 22", "ring_outer_diameter": "290 mm .. 360 mm"}
    front = synth.synthesize(
        synth.load("multi_plate_clutch", practice="off"),
        duty,
        parts=parts,
        limits=limits,
        fix={"ramp_time": "2 s"},
        points=5,
    )
    chosen = front.designs[2]
    found = near_equals(front, 3, "20 %", count=100)
    assert found.complete
    instance = front.question
    rings = np.array([(o, i) for o in range(290, 361) for i in range(150, o) if 0.0999 <= (o - i) / (o + i) <= 0.2501])
    members = set()
    for combination in range(instance.combinations.count):
        data = instance.data(np.array([combination]))
        points = np.column_stack([rings / 1e3, np.full(len(rings), 1e3), np.full(len(rings), 2.0)])
        # Torque grows with the force in proportion, so the least force is known; time and heat may ask for more.
        points[:, 2] *= (
            instance.values.requirements["required_torque"] / instance.model.evaluate(points, data).values["torque"]
        )
        for more in np.linspace(1.0, 1.4, 41):
            result = instance.model.evaluate(points * [1, 1, more, 1], data)
            near_by = np.all([result.values[n] <= chosen.values[n] * 1.2 for n in chosen.objectives], axis=0)
            if np.any(result.feasible & near_by):
                members.add(combination)
                break
    assert 3 < len(members) < instance.combinations.count
    assert found.found == len(members) - 1


def test_an_enumeration_that_is_cut_short_says_at_least(front):
    chosen = next(d for d in front.designs if d.rank == 8)
    few = NearLimits(most=3, batch=4)
    found = near._Enumeration(front.question, chosen, front, 0.3, SearchSettings(), None, few).run(2)
    assert not found.complete
    assert found.found < near_equals(front, 8, "30 %", count=2).found
    assert found.undecided is None
    assert "at least" in found.sentence()


def test_an_interruption_keeps_what_was_found(front):
    def stop(state):
        if state["incumbents"] > 2:
            raise KeyboardInterrupt

    found = near_equals(front, 8, "30 %", count=2, progress=stop)
    assert found.interrupted == "interrupted"
    assert not found.complete
    assert len(found.designs) == 2
    assert not any(d.violated for d in found.designs)
    assert near_equals(front, 8, "30 %", count=2, time_limit=1e-9).interrupted == "time limit"


def test_what_is_saved_is_read_back_and_checks(front, tmp_path):
    found = near_equals(front, 1, "10 %", count=3)
    folder = found.save(tmp_path / "near")
    table = pd.read_csv(folder / "near_equals.csv")
    assert table["number"].tolist() == list(range(len(found.designs) + 1))
    assert table["mass [kg]"][1] == pytest.approx(found.designs[0].values["mass"])
    assert table["change: mass [%]"][1] == pytest.approx(100 * found.changes[0]["mass"])
    assert len(list(folder.glob("design_*.yaml"))) == len(found.designs) + 1
    assert list(found.to_frame().columns) == list(table.columns)


def test_a_saved_front_answers_as_the_one_in_memory(tmp_path):
    spec = {"load_torque": "600 N*m", "driver_speed": "254 rpm", "driven_inertia": "30 kg*m2"}
    fix = {"ramp_time": "2 s", "friction_pair": "cork_wet", "d_out": "361 mm", "d_in": "295 mm"}
    parts = {"inner_plate": ["core 1.5", "core 2"], "outer_plate": ["core 2"]}
    front = synth.synthesize(synth.load("multi_plate_clutch", practice="off"), spec, parts=parts, fix=fix, points=3)
    loaded = synth.load_front(front.save(tmp_path / "front"))
    first, second = near_equals(front, 2, "20 %", count=3), near_equals(loaded, 2, "20 %", count=3)
    assert first.found > 1
    assert (first.found, first.complete) == (second.found, second.complete)
    assert [d.values for d in first.designs] == [d.values for d in second.designs]


@pytest.mark.parametrize(
    ("more", "words"),
    [
        ({"design": 99}, ["design", "99", "rank from 1 to"]),
        ({"design": True}, ["design", "rank"]),
        ({"within": "0 %"}, ["within", "more than 0"]),
        ({"within": "200 %"}, ["within", "at most 50 %"]),
        ({"within": "2 mm"}, ["within", "2 mm"]),
        ({"count": 0}, ["count", "1 or more"]),
        ({"count": 10**9}, ["count", "at most 10000"]),
    ],
)
def test_careless_input_is_refused(front, more, words):
    with pytest.raises(synth.InputError) as error:
        near_equals(front, **{"design": 1, **more})
    assert all(word in str(error.value) for word in words)


def test_a_design_of_another_question_is_refused(front):
    parts = {"metal": ["St 37", "twin of C 45"]}
    narrow = synth.synthesize(Bracket, {"load": LOAD}, catalogs={"metals": METALS}, parts=parts, points=3)
    other = next(d for d in front.designs if str(d.parts["metal"]) not in parts["metal"])
    with pytest.raises(synth.InputError, match="design: metal"):
        near_equals(narrow, other)
