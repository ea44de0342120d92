"""Conditions that compare slots: every answer keeps to them, and what they exclude is counted and named."""

import itertools
import json

import numpy as np
import pandas as pd
import pytest

import synth
from synth.question.catalogs import catalogs_for
from synth.search.formulation import Formulation
from synth.search.refused_cells import RefusedCells, not_refused
from synth.tables.conditions import parse_condition
from tests.asking import instance_of

rng = np.random.default_rng(7)
COUNT = 24
PLATES = pd.DataFrame(
    {
        "designation": [f"plate {k}" for k in range(COUNT)],
        "thickness [mm]": np.round(rng.choice([1.0, 1.5, 2.0, 2.5, 3.0, 4.0], COUNT), 3),
        "steel": rng.choice(["C45", "C60", "X5"], COUNT),
        "price [-]": np.round(rng.uniform(1, 9, COUNT), 2),
        "tax [-]": np.round(rng.uniform(1, 9, COUNT), 2),
        "mass [kg]": np.round(rng.uniform(0.1, 2, COUNT), 3),
    }
)
PLATES.loc[3, "thickness [mm]"] = None
CATALOGS = {"plates": PLATES}


class Stack(synth.DesignProblem):
    """Two plates and a bolt between; the family itself reads prices and masses alone."""

    name, title = "stack", "Stack"

    def declare(self, d):
        least = d.requirement("least", "-", 1.0, lower=0, upper=100)
        size = d.variable("size", "mm", 1, 10)
        d.count("layers", 1, 3)
        one = d.part("one", "plates", symbol="A")
        two = d.part("two", "plates", symbol="B")
        d.derive("cost", "-", one.price + two.price + 100 * size)
        d.derive("weight", "kg", one.mass + two.mass + 5 / (1 + 1e3 * size))
        d.at_least("worth", one.price * two.price, least, "-")
        d.objective("cost")
        d.objective("weight")


def synthesized(rule, slot="one", **more):
    settings = {"points": 30, "gap": 1e-3, "catalogs": CATALOGS, **more}
    parts = {**settings.pop("parts", {}), slot: rule}
    return synth.synthesize(Stack(), settings.pop("requirements", {}), parts=parts, **settings)


def pairs(holds, complete=True):
    """Return the pairs of rows for which a condition holds, by plain Python."""
    rows = PLATES.to_dict("records")
    known = [r for r in rows if not complete or not np.isnan(r["thickness [mm]"])]
    return [(a["designation"], b["designation"]) for a, b in itertools.product(known, known) if holds(a, b)]


def thickness(row):
    return row["thickness [mm]"]


CONDITIONS = {
    "thickness == two.thickness": lambda a, b: thickness(a) == thickness(b),
    "one.thickness == two.thickness": lambda a, b: thickness(a) == thickness(b),
    "two.thickness < thickness and steel != 'X5'": lambda a, b: thickness(b) < thickness(a) and a["steel"] != "X5",
    "steel == B.steel and thickness >= B.thickness": lambda a, b: (
        a["steel"] == b["steel"] and thickness(a) >= thickness(b)
    ),
    "not (thickness <= two.thickness or steel in ('C45', 'C60'))": lambda a, b: (
        not (thickness(a) <= thickness(b) or a["steel"] in ("C45", "C60"))
    ),
    "steel != two.steel and thickness != two.thickness": lambda a, b: (
        a["steel"] != b["steel"] and thickness(a) != thickness(b)
    ),
    "thickness > '1.5 mm' or thickness == two.thickness": lambda a, b: (
        thickness(a) > 1.5 or thickness(a) == thickness(b)
    ),
}


def offered(instance):
    """Return the pairs of rows that combinations offer and no refusal forbids."""
    form = Formulation(instance, {"cost": "min", "weight": "min"}, 2)
    every = np.arange(instance.combinations.count)
    found = set()
    for k in every[not_refused(form.instance, every)]:
        parts, _, _ = instance.combinations.describe(int(k))
        found.add(tuple(table.designations[row] for table, row in parts.values()))
    return found


@pytest.mark.parametrize("text", CONDITIONS)
def test_the_combinations_left_are_those_of_a_plain_loop(text):
    instance = instance_of(Stack(), {}, catalogs_for(Stack(), CATALOGS), parts={"one": text})
    allowed = pairs(CONDITIONS[text])
    assert offered(instance) == set(allowed)
    (told,) = instance.selection.combinations_left_out
    assert told == f"one: {text}: {instance.combinations.count - 3 * len(allowed)} of {instance.combinations.count}"
    for slot, rows in zip(instance.selection.slots, zip(*allowed, strict=True), strict=True):
        assert {slot.table.designations[k] for k in slot.rows} == set(rows)  # none without a partner


@pytest.mark.slow
@pytest.mark.parametrize("text", CONDITIONS)
def test_the_front_is_that_of_all_allowed_pairs_proven_and_verified(text, tmp_path):
    front = synthesized(text, points=100)
    assert front.certificate.kind == "global"
    allowed = set(pairs(CONDITIONS[text]))
    assert {(str(d.parts["one"]), str(d.parts["two"])) for d in front.designs} <= allowed
    # No allowed pair, at any of many sizes, is better in both by more than the gap.
    by_name = PLATES.set_index("designation")
    price, mass = by_name["price [-]"], by_name["mass [kg]"]
    sizes = np.geomspace(1e-3, 1e-2, 300)
    cost = np.array([price[a] + price[b] + 100 * sizes for a, b in allowed])
    weight = np.array([mass[a] + mass[b] + 5 / (1 + 1e3 * sizes) for a, b in allowed])
    for design in front.designs:
        within = 1 - 1.01e-3
        better = (cost < design.values["cost"] * within) & (weight < design.values["weight"] * within)
        assert not better.any()
    least = min(price[a] + price[b] for a, b in allowed) + 0.1
    assert min(d.values["cost"] for d in front.designs) == pytest.approx(least, rel=1e-6)
    front.save(tmp_path)
    assert json.loads((tmp_path / "front.json").read_text())["settings"]["parts"] == {"one": text}
    again = synth.load_front(tmp_path)
    checked = again.verify(Stack(), CATALOGS)
    assert checked.holds, checked.findings


def test_a_front_that_broke_the_comparison_does_not_hold(tmp_path):
    front = synthesized("thickness > two.thickness")
    front.settings["parts"]["one"] = "thickness < two.thickness"
    front.save(tmp_path)
    checked = synth.load_front(tmp_path).verify(Stack(), CATALOGS)
    assert not checked.holds
    assert any("refused, parts: one" in f or "is not a row" in f for f in checked.findings), checked.findings


def test_boxes_of_clusters_are_given_up_before_single_rows():
    """Of 24 x 24 pairs with a rule that few meet, clusters without any are left out as a whole, and no other."""
    text = "designation == two.designation"
    instance = instance_of(Stack(), {}, catalogs_for(Stack(), CATALOGS), parts={"one": text})
    form = Formulation(instance, {"cost": "min", "weight": "min"}, 2)
    trees = form.boxes.cells.trees
    cells = np.array(list(itertools.product(range(len(trees[0])), range(len(trees[1])), [0])), dtype=np.int32)
    may = form.boxes.refused_cells.may_be_allowed(cells)
    slots = zip(instance.selection.slots, trees[:2], strict=True)
    rows = [[set(slot.rows[tree.rows(k)].tolist()) for k in range(len(tree))] for slot, tree in slots]
    holds = np.array([bool(rows[0][a] & rows[1][b]) for a, b, _ in cells])
    np.testing.assert_array_equal(may, holds)  # small enough for a table of all pairs
    may = RefusedCells(instance, form.boxes.cells, 0).may_be_allowed(cells)
    assert np.all(may | ~holds)  # nothing that may hold is lost
    assert (~may).sum() > 0.4 * (~holds).sum()
    singles = form.boxes.cells.single(np.column_stack([cells[:, :2], np.full(len(cells), trees[2].leaf_of_row[0])]))
    assert np.array_equal(may[singles], holds[singles])


def test_rows_without_a_value_that_is_compared_are_left_out_and_named():
    front = synthesized("thickness == two.thickness")
    told = {(e["slot"], e["designation"]): e["reason"] for e in front.statistics["rows_left_out"]}
    assert told["one", "plate 3"] == told["two", "plate 3"] == "no value in column thickness"
    assert front.statistics["combinations_left_out"][0].startswith("one: thickness == two.thickness: ")
    assert "combinations_left_out" not in synthesized(["plate 1"]).statistics


def test_one_slot_may_compare_its_own_columns_and_several_rules_all_hold():
    front = synthesized("price > one.tax", parts={"two": "two.thickness == A.thickness"})
    assert {e["designation"] for e in front.statistics["rows_left_out"]} >= set(
        PLATES.loc[PLATES["price [-]"] <= PLATES["tax [-]"], "designation"]
    )
    assert all(d.parts["one"]["thickness"] == d.parts["two"]["thickness"] for d in front.designs)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("thickness == three.thickness", "at 'three.thickness' .*a slot before the point, one of one, two"),
        ("thickness == layers.thickness", "at 'layers.thickness' .*a slot before the point, one of one, two"),
        ("thickness == two.thick", "at 'two.thick' .*a column of this table, perhaps thickness"),
        ("thickness == two.mass", r"at 'two.mass' .*what thickness \[mm\] does; two.mass is in kg"),
        ("thickness == two.steel", "at 'two.steel' .*a column of numbers, as thickness is"),
        ("steel == two.mass", "at 'two.mass' .*a column of text, as steel is"),
        ("steel < two.steel", "== or != or in for steel, which is a column of text"),
        ("thickness == two.thickness or 'C45' in steel", "comparisons beside that with another slot"),
        ("thickness == two.thickness or mass > '2 mm'", "at '2 mm' .*a mass"),
        ("steel == two.steel or steel == 3", "a text in quotes, '3', since steel is a column of text"),
        ("thickness > two.thickness and thickness < two.thickness", "a condition that some rows of one and two meet"),
        ("thickness > 3 and thickness == two.thickness and two.thickness < 2", "some rows of one and two meet"),
    ],
)
def test_what_cannot_be_compared_is_one_sentence(text, message):
    with pytest.raises(synth.InputError, match=message) as refusal:
        synthesized(text)
    assert refusal.value.path[:2] == ("parts", "one")


def test_a_table_alone_cannot_answer_a_comparison_of_slots():
    class Wrong(Stack):
        def declare(self, d):
            d.part("other", "plates", where="thickness == one.thickness")
            super().declare(d)

    with pytest.raises(synth.InputError, match="other slots are for the conditions under parts"):
        synth.synthesize(Wrong(), {}, catalogs=CATALOGS)
    condition = parse_condition("thickness == two.thickness and price > 3")
    assert condition.compares_slots
    assert not condition.local().compares_slots
    assert condition.columns == {"thickness", "price"}


@pytest.mark.slow
def test_studies_explanations_and_near_equals_keep_to_it():
    rule = {"one": "steel == two.steel and thickness != two.thickness"}
    study = synth.whatif(Stack(), {}, {"least": "1, 20"}, objectives=["cost"], parts=rule, catalogs=CATALOGS)
    front = synth.synthesize(Stack(), {}, parts=rule, catalogs=CATALOGS, objectives=["cost"])
    near = synth.near_equals(front, 1, within="30 %")
    explained = synth.explain(Stack(), {"least": 30}, parts=rule, limits={"cost": "<= 2"}, catalogs=CATALOGS)
    designs = [d for f in study.fronts for d in f.designs] + list(near.designs)
    designs += [way.design for way in explained.ways]
    assert len(designs) > 4
    for design in designs:
        one, two = design.parts["one"], design.parts["two"]
        assert one["steel"] == two["steel"]
        assert one["thickness"] != two["thickness"]


@pytest.mark.slow
def test_a_batch_takes_comparisons_row_by_row_and_variants_keep_to_them(tmp_path):
    rows = tmp_path / "rows.csv"
    duty = "600,254,30"
    rows.write_text(
        "load_torque [N*m],driver_speed [1/min],driven_inertia [kg*m2],parts\n"
        f'{duty},"friction_pair = seed_multiplate_ref; inner_plate: thickness == outer_plate.thickness"\n'
        f'{duty},"friction_pair = seed_multiplate_ref; inner_plate: thickness > outer_plate.thickness"\n'
    )
    done = synth.batch(
        synth.load("multi_plate_clutch", practice="off"),
        rows,
        tmp_path / "out",
        points=1,
        objectives=["mass"],
        limits={"z": [8]},
    )
    assert done.counts == {"optimal": 2}
    designs = pd.read_csv(tmp_path / "out" / "designs.csv").set_index("row")
    asked = pd.read_csv(tmp_path / "out" / "rows.csv").sort_values("line")["row"].tolist()
    plates = designs[["inner_plate", "outer_plate"]].map(lambda name: float(name.removeprefix("core ")))
    inner, outer = (plates.loc[asked, slot].tolist() for slot in ("inner_plate", "outer_plate"))
    assert inner[0] == outer[0]
    assert inner[1] > outer[1]
    assert len(synth.size_range(done).variants) == 2  # neither may serve the other's row
