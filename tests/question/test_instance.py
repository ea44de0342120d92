"""One question: requirement values, limits, fix and parts, and the rows that are left out."""

import numpy as np
import pandas as pd
import pytest

import synth
from synth.question.catalogs import as_catalogs
from synth.tables.catalogs import Catalogs
from tests.asking import instance_of
from tests.sample_problems.strut import NEEDED, RODS, Strut

PLATES = (
    "core 1",
    "core 1.2",
    "core 1.5",
    "core 1.6",
    "core 1.8",
    "core 2",
    "core 2.5",
    "core 3",
    "core 3.5",
    "core 4",
)


def instance(requirements=NEEDED, rods=RODS, catalogs=None, **more):
    return instance_of(Strut(), requirements, Catalogs(catalogs or {"rods": rods}), **more)


def designations(question, slot):
    rows = next(s for s in question.selection.slots if s.slot == slot)
    return tuple(rows.table.designations[k] for k in rows.rows)


# -- requirements ------------------------------------------------------------------------------------


def test_requirements_by_name_or_symbol_with_units_or_bare():
    for given in ({"load": "20 kN"}, {"F": 20}, {"load": "20000 N"}, {"F": "20"}, {"load": 20.0}):
        question = instance(given)
        assert question.values.requirements == {"load": 20000.0, "safety": 1.5}
        assert question.values.given == {"load"}
        assert question.values.not_asked == ("room",)


def test_none_means_not_given():
    assert instance({"load": 20, "room": None}).values.not_asked == ("room",)
    assert instance({"load": 20, "room": "50 mm"}).values.not_asked == ()


@pytest.mark.parametrize(
    ("given", "words"),
    [
        ({}, r"requirement load: is missing; expected a value in kN, for example '10 kN'"),
        ({"load": None}, "requirement load: is missing"),
        ({"load": "0.5 kN"}, "requirement load: got '0.5 kN'; expected 1 kN to 100 kN"),
        ({"load": 101}, "expected 1 kN to 100 kN"),
        ({"load": "20 N*m"}, "requirement load.*torque"),
        ({"load": "20,5 kN"}, "requirement load"),
        ({"load": float("nan")}, "requirement load"),
        ({"load": True}, "requirement load"),
        ({"load": 20, "F": 20}, "each requirement once"),
        ({"laod": 20}, r"requirements: got 'laod'.*did you mean load"),
        ({"width": 20}, "width is a variable"),
        ({"load": "95 kN"}, r"heavy_hook: got 'load = 95 kN'; expected at most 90 kN"),
        (["load"], "requirements: got"),
    ],
)
def test_requirements_that_cannot_be(given, words):
    with pytest.raises(synth.InputError, match=words):
        instance(given)


def test_the_ends_of_a_range_are_inside():
    assert instance({"load": "1 kN"}).values.requirements["load"] == 1000.0
    assert instance({"load": 20, "safety": 10}).values.requirements["safety"] == 10.0


class Switched(synth.DesignProblem):
    """Requirements that only some values of its options have."""

    name, title = "switched", "Switched"

    def declare(self, d):
        habits = d.option("habits", ("on", "off"), "on", symbol="hab")
        shape = d.option("shape", ("round", "square", "oval"), "round")
        d.requirement("force", "N")
        length = d.variable("length", "mm", 1, 50)
        d.at_most("least", 1e-3, length, "mm")
        if habits == "on":
            d.requirement("slack", "mm", 1, symbol="sl", group="habits")
        if habits == "on" or shape == "oval":
            d.requirement("axis", "mm", 1)
        if shape != "round":
            d.requirement("corner", "mm", optional=True)
        d.objective("length")


@pytest.mark.parametrize(
    ("options", "word", "told"),
    [
        (
            {"habits": "off"},
            "slack",
            "requirement slack: got 2; expected no value with habits: off: it is a rule of habits and counts only with "
            "habits: on",
        ),
        ({"hab": "off"}, "sl", "requirement sl: got 2; expected no value with habits: off: it is a rule of habits"),
        (
            {"habits": "off"},
            "axis",
            "requirement axis: got 2; expected no value with habits: off and shape: round: it counts only with "
            "habits: on, or with shape: oval",
        ),
        ({}, "corner", "no value with shape: round: it counts only with shape: square or oval"),
        ({}, "slak", "requirements: got 'slak'; expected a requirement of switched (did you mean slack"),
    ],
)
def test_a_requirement_of_another_option_says_of_which(options, word, told):
    with pytest.raises(synth.InputError) as caught:
        instance_of(Switched(**options), {"force": 1, word: 2}, Catalogs({}))
    assert told in str(caught.value)


# -- limits ------------------------------------------------------------------------------------------


def test_limits_of_a_variable_narrow_its_range():
    assert instance(limits={"width": "<= 60 mm"}).ranges.upper[0] == 0.06
    assert instance(limits={"b": ">= 6 cm"}).ranges.lower[0] == 0.06
    both = instance(limits={"width": "20 mm .. 60 mm"})
    assert (both.ranges.lower[0], both.ranges.upper[0]) == (0.02, 0.06)
    listed = instance(limits={"width": [">= 20 mm", "<= 0.06 m", "< 70"]})
    assert (listed.ranges.lower[0], listed.ranges.upper[0]) == (0.02, 0.06)
    pinned = instance(limits={"length": "== 150 mm"})
    assert (pinned.ranges.lower[1], pinned.ranges.upper[1]) == (0.15, 0.15)
    wide = instance(limits={"width": "<= 900 mm"})
    assert wide.ranges.upper[0] == 0.2  # a limit never widens


def test_limits_of_a_count_leave_values_out():
    assert instance(limits={"plates": "2 .. 3"}).selection.counts["plates"].tolist() == [2, 3]
    assert instance(limits={"n": [">= 3"]}).selection.counts["plates"].tolist() == [3, 4]
    assert instance(limits={"plates": "== 2"}).selection.counts["plates"].tolist() == [2]


def test_limits_of_a_derived_quantity_are_limits_of_the_question():
    question = instance(limits={"mass": ["<= 2 kg", ">= 100 g"], "A": "= 300 mm2"})
    assert [(x.quantity, x.sense, x.bound, x.name) for x in question.limits.judging] == [
        ("mass", "at_most", 2.0, "mass <= 2 kg"),
        ("mass", "at_least", 0.1, "mass >= 0.1 kg"),
        ("area", "equal", pytest.approx(3e-4), "area == 300 mm2"),
    ]


@pytest.mark.parametrize(
    ("limits", "words"),
    [
        ({"width": "60 mm"}, "a comparison, for example '<= 260 mm' or '200 mm .. 260 mm'"),
        ({"width": 60}, "a comparison"),
        ({"width": None}, "a comparison"),
        ({"width": "<= 60 kg"}, "limits: width"),
        ({"width": "<= "}, "comparison|number"),
        ({"width": "60 mm .. 20 mm"}, "the smaller value first"),
        ({"width": "<= 2 mm"}, "limits that leave something of 5 mm to 200 mm"),
        ({"width": [">= 60 mm", "<= 50 mm"]}, "limits that leave something"),
        ({"plates": ">= 5"}, "plates: .*a value from 1 to 4 in steps of 1"),
        ({"load": "<= 5 kN"}, "load is a requirement"),
        ({"end": "== eye"}, "end is a choice"),
        ({"wdth": "<= 5 mm"}, "did you mean width"),
        (["width"], "limits: got"),
    ],
)
def test_limits_that_cannot_be(limits, words):
    with pytest.raises(synth.InputError, match=words):
        instance(limits=limits)


def test_limits_that_hold_no_makeable_value():
    question = instance(limits={"width": "60.2 mm .. 60.8 mm"})
    with pytest.raises(synth.InputError, match=r"a range that holds a makeable value \(or grid: false\)"):
        question.ranges.grids()
    assert not len(instance(limits={"width": "60.2 mm .. 60.8 mm"}, grid=False).ranges.grids()[0])


# -- fix ---------------------------------------------------------------------------------------------


def test_fix_pins_every_kind_of_unknown():
    question = instance(fix={"width": "50.5 mm", "n": 2, "end": "eye", "plate": "core 2", "mass": "1 kg"})
    assert (question.ranges.lower[0], question.ranges.upper[0]) == (0.0505, 0.0505)
    assert question.ranges.pinned.tolist() == [True, False]
    assert not len(question.ranges.grids()[0])  # a pinned value need not be on the grid
    assert question.selection.counts["plates"].tolist() == [2]
    assert question.selection.choices["end"].tolist() == [1]
    assert designations(question, "plate") == ("core 2",)
    assert [(x.quantity, x.sense, x.bound) for x in question.limits.judging] == [("mass", "equal", 1.0)]
    assert question.combinations.count == 3


@pytest.mark.parametrize(
    ("fix", "words"),
    [
        ({"width": "3 mm"}, "fix: width: got '3 mm'; expected 5 mm to 200 mm"),
        ({"plates": 5}, "a value from 1 to 4 in steps of 1"),
        ({"plates": 1.5}, "a value from 1 to 4 in steps of 1"),
        ({"end": "ring"}, "fix: end: got 'ring'; expected one of hook, eye"),
        ({"plate": "core 77"}, "table core_plates: got 'core 77'"),
        ({"plate": "core 0.8"}, "thickness >= 1"),
        ({"load": "20 kN"}, "load is a requirement"),
        ({"width": [1, 2]}, "fix: width"),
        ("width", "fix: got 'width'"),
    ],
)
def test_fix_that_cannot_be(fix, words):
    with pytest.raises(synth.InputError, match=words):
        instance(fix=fix)


# -- parts -------------------------------------------------------------------------------------------


def test_conditions_of_the_slot_choose_the_rows():
    assert designations(instance(), "plate") == PLATES


@pytest.mark.parametrize(
    ("rule", "expected"),
    [
        (["core 2", "core 3"], ("core 2", "core 3")),
        (("core 3", "core 2"), ("core 2", "core 3")),
        ("core 4", ("core 4",)),
        ("thickness > 3", ("core 3.5", "core 4")),
        ("thickness > '0.3 cm'", ("core 3.5", "core 4")),
        ("thickness in (1, 2) or designation == 'core 4'", ("core 1", "core 2", "core 4")),
        (["core 0.8", "core 4"], ("core 4",)),
    ],
)
def test_parts_narrow_a_slot(rule, expected):
    assert designations(instance(parts={"plate": rule}), "plate") == expected
    assert designations(instance(parts={"pl": rule}), "plate") == expected


@pytest.mark.parametrize(
    ("parts", "words"),
    [
        ({"plate": ["core 9"]}, "core 9"),
        (
            {"plate": "thickness > 100"},
            "slot plate: got 'no row'; expected rules for this slot that leave at least one row of table core_plates",
        ),
        ({"plate": []}, "at least one row"),
        (
            {"plate": ["core 0.8"]},
            "slot plate: got 'core 0.8'; expected a row of table core_plates with thickness >= 1",
        ),
        ({"plate": "thicknes > 1"}, "perhaps thickness"),
        ({"plate": "thickness >"}, "condition"),
        ({"material": "sofft"}, "table rods: got 'sofft'; expected a designation of this table, perhaps soft"),
        ({"plate": 5}, "a list of designations, or a condition on columns"),
        ({"plate": None}, "a list of designations, or a condition on columns"),
        ({"width": "core 2"}, "width is a variable"),
        (["plate"], "parts: got"),
    ],
)
def test_parts_that_cannot_be(parts, words):
    with pytest.raises(synth.InputError, match=words):
        instance(parts=parts)


# -- tables of the user ------------------------------------------------------------------------------


def test_a_row_without_a_value_that_is_used_is_left_out_and_named():
    rods = RODS.assign(**{"density [kg/m3]": [7850.0, None, 7900.0]})
    question = instance(rods=rods)
    assert designations(question, "material") == ("soft", "odd")
    assert question.selection.left_out == [
        {"slot": "material", "designation": "hard", "reason": "no value in column density"}
    ]
    assert question.selection.offered == {"plate": 14, "material": 3}
    front = synth.synthesize(Strut(), NEEDED, objectives=["mass"], catalogs={"rods": rods})
    assert front.statistics["rows_left_out"] == question.selection.left_out
    assert front.statistics["rows_used"] == {"plate": 10, "material": 2}


def test_an_emptied_slot_names_the_column():
    rods = RODS.assign(**{"density [kg/m3]": [None, None, None]})
    with pytest.raises(
        synth.InputError, match=r"slot material: got 'soft, hard, odd'.*complete \(no value in column density\)"
    ):
        instance(rods=rods)
    with pytest.raises(synth.InputError, match="density"):
        instance(rods=RODS.drop(columns="density [kg/m3]"))


def test_a_missing_optional_column_is_no_fault():
    bare = instance(rods=RODS.drop(columns="stress_allow [N/mm2]"))
    assert bare.combinations.count == instance().combinations.count


class Wet(synth.DesignProblem):
    """A slot with the conditions that the shipped friction materials are sorted by."""

    name = "wet"

    def declare(self, d):
        pair = d.part("pair", "friction_materials", where=("'plate pack' in surfaces", "lubrication == 'oil'"))
        x = d.variable("x", "mm", 1, 2)
        d.derive("y", "-", x * pair.mu_dynamic)
        d.objective("y")


def pairs(table):
    question = instance_of(Wet(), {}, as_catalogs({"friction_materials": table}))
    return designations(question, "pair")


def test_conditions_on_columns_that_a_users_table_lacks_are_not_applied():
    bare = pd.DataFrame({"designation": ["a", "b"], "mu_dynamic [-]": [0.1, 0.2]})
    assert pairs(bare) == ("a", "b")
    assert pairs(bare.assign(lubrication=["oil", "dry"])) == ("a",)


def test_a_users_row_is_offered_by_the_condition_of_the_slot():
    table = pd.DataFrame(
        {
            "designation": ["a", "b", "c", "d"],
            "mu_dynamic [-]": [0.1, 0.2, 0.1, 0.1],
            "lubrication": ["oil", "dry", "oil", "oil"],
            "surfaces": ["", "plate pack", "disc facing", "disc facing;plate pack"],
        }
    )
    question = instance_of(Wet(), {}, as_catalogs({"friction_materials": table}))
    assert designations(question, "pair") == ("d",)
    (left_out,) = question.selection.left_out
    assert left_out["designation"] == "a"
    assert left_out["reason"] == "no value in column surfaces, which the condition 'plate pack' in surfaces asks for"


def test_rows_added_to_a_shipped_table_join_it():
    shipped = designations(instance_of(Wet(), {}, as_catalogs(None)), "pair")
    more = pd.DataFrame({"designation": ["mine"], "mu_dynamic [-]": [0.1], "lubrication": ["oil"]})
    more["surfaces"] = "plate pack"
    assert pairs(["+", more]) == (*shipped, "mine")
    assert "felt_dry" not in shipped


# -- combinations ------------------------------------------------------------------------------------


def test_combinations_are_numbered_through():
    question = instance(parts={"plate": ["core 2", "core 3"]})
    assert question.combinations.radix == [2, 3, 4, 2]
    assert question.combinations.count == 48
    seen = set()
    for number in range(48):
        parts, counts, choices = question.combinations.describe(number)
        table, row = parts["plate"]
        seen.add((table.designations[row], parts["material"][1], counts["plates"], choices["end"]))
    assert len(seen) == 48
    data = question.data(np.arange(48))
    labels = [e.label for e in question.model.data_inputs]
    thickness, plates = data[labels.index("plate.thickness")], data[labels.index("plates")]
    for number in (0, 7, 30, 47):
        parts, counts, _ = question.combinations.describe(number)
        table, row = parts["plate"]
        assert thickness[number] == table.number("thickness")[row]
        assert plates[number] == counts["plates"]
    assert data[labels.index("load")] == 20000.0


def test_neighbours_differ_in_one_part_count_or_choice():
    question = instance(parts={"plate": ["core 2", "core 3"]})
    digits = np.array(question.combinations.digits(np.arange(48)))
    for number in (0, 13, 47):
        wanted = np.flatnonzero((digits != digits[:, [number]]).sum(axis=0) == 1)
        assert sorted(question.combinations.neighbours(number)) == list(wanted)
