"""The verbs of a declaration: what each leaves behind, and what it refuses."""

import math

import casadi as ca
import numpy as np
import pandas as pd
import pytest
from synth.problems.mechanics.guide_friction import sum_geometric

import synth
from synth.declaration import (
    Block,
    Declaration,
    DeclarationError,
    Option,
    Requirement,
    RowRange,
    Slot,
    Variable,
    grid_values,
)
from synth.model.numbers import number
from synth.order.feasibility import SMALLEST
from synth.special import recorded
from synth.tables.catalogs import Catalogs
from tests.asking import instance_of

RODS = pd.DataFrame(
    {
        "designation": ["thin", "thick", "odd"],
        "diameter [mm]": [10.0, 20.0, 15.0],
        "stress_allow [N/mm2]": [100.0, 80.0, None],
        "strength [N/mm2]": [400.0, None, 500.0],
        "strength_forged [N/mm2]": [None, 600.0, 700.0],
        "note": ["a", "b", "c"],
        "source": ["made up", "made up", "made up"],
    }
)
CATALOGS = Catalogs({"rods": RODS})


def declaration(given=(), **options):
    return Declaration("sample", options, frozenset(given), CATALOGS)


def problem(declare, title="sample"):
    """Return a problem whose declare is the function."""
    return type("Sample", (synth.DesignProblem,), {"name": title, "declare": lambda self, d: declare(d)})


# -- requirements ----------------------------------------------------------------------------------


def test_a_requirement_takes_numbers_in_its_unit_and_keeps_si():
    d = declaration()
    sx = d.requirement("force", "kN", 2, lower=1, upper=10, symbol="F", text="pull", source="book")
    r = d.requirements["force"]
    assert sx is r.sx
    assert (r.default, r.lower, r.upper) == (2000.0, 1000.0, 10000.0)
    assert (r.symbol, r.text, r.source, r.unit, r.optional) == ("F", "pull", "book", "kN", False)
    assert d.names() == {"force": "force", "F": "force"}


def test_temperatures_and_speeds_are_converted_too():
    d = declaration()
    d.requirement("ambient", "degC", 40, lower=-60, upper=150)
    d.requirement("speed", "1/min", 60)
    assert d.requirements["ambient"].default == 313.15
    assert d.requirements["ambient"].lower == pytest.approx(213.15, abs=1e-12)
    assert d.requirements["speed"].default == pytest.approx(2 * math.pi, rel=1e-15)


def test_an_open_bound_is_infinite():
    d = declaration()
    d.requirement("force", "N")
    assert (d.requirements["force"].lower, d.requirements["force"].upper) == (-np.inf, np.inf)
    assert d.requirements["force"].default is None


def test_an_optional_requirement_is_none_until_it_is_given():
    d = declaration()
    assert d.requirement("room", "mm", optional=True) is None
    assert d.requirements["room"].sx is None
    assert not d.requirements["room"].given
    d = declaration(given={"room"})
    assert isinstance(d.requirement("room", "mm", optional=True), ca.SX)
    assert d.requirements["room"].given


def test_a_default_may_follow_an_earlier_requirement():
    def declare(d):
        force = d.requirement("force", "kN")
        peak = d.requirement("peak", "kN", default=2.5 * force)
        d.requirement("most", "kN", default=np.maximum(peak, 1e4))
        d.objective("x")
        d.variable("x", "mm", 1, 2)

    instance = instance_of(problem(declare)(), {"force": "2 kN"}, CATALOGS)
    assert instance.values.requirements == {"force": 2000.0, "peak": 5000.0, "most": 10000.0}
    instance = instance_of(problem(declare)(), {"force": 2, "peak": "20000 N"}, CATALOGS)
    assert instance.values.requirements == {"force": 2000.0, "peak": 20000.0, "most": 20000.0}


# -- options ---------------------------------------------------------------------------------------


def test_an_option_returns_the_chosen_string():
    d = declaration(shape="square")
    assert d.option("shape", ("round", "square"), "round", symbol="sh") == "square"
    assert d.option("size", ("small", "large"), "small") == "small"
    assert (d.options["shape"].default, d.options["shape"].chosen) == ("round", "square")


def test_an_option_may_be_set_by_its_symbol():
    assert declaration(sh="square").option("shape", ("round", "square"), "round", symbol="sh") == "square"


@pytest.mark.parametrize(("written", "meant"), [(True, "yes"), (False, "no"), ("yes", "yes")])
def test_yaml_truth_values_mean_yes_and_no(written, meant):
    assert declaration(obsolete=written).option("obsolete", ("no", "yes"), "no") == meant


def test_an_unknown_choice_names_those_there_are():
    with pytest.raises(synth.InputError, match=r"option shape: got 'oval'; expected one of round, square"):
        declaration(shape="oval").option("shape", ("round", "square"), "round")
    with pytest.raises(synth.InputError, match="option shape: got 'yes'"):
        declaration(shape=True).option("shape", ("round", "square"), "round")


@pytest.mark.parametrize(("written", "meant"), [("ROUND", "round"), ("sq", "square"), ("Roundish", "roundish")])
def test_a_choice_may_be_shortened_in_any_case(written, meant):
    assert declaration(shape=written).option("shape", ("round", "square", "roundish"), "square") == meant


def test_a_beginning_of_several_choices_names_those_that_begin_so():
    with pytest.raises(synth.InputError, match=r"got 'l'; expected one of lift, lorry$"):
        declaration(shape="l").option("shape", ("lift", "crane", "lorry"), "lift")
    with pytest.raises(synth.InputError, match=r"got ''; expected one of lift, crane$"):
        declaration(shape="").option("shape", ("lift", "crane"), "lift")


def test_an_unknown_option_is_refused_at_the_end():
    d = declaration(colour="red")
    d.option("shape", ("round", "square"), "round", symbol="sh")
    with pytest.raises(synth.InputError, match=r"options: got 'colour'; expected an option of sample: shape"):
        d.finish()


def test_a_default_must_be_a_choice():
    with pytest.raises(DeclarationError, match="is not one of"):
        declaration().option("shape", ("round", "square"), "oval")


def test_the_rows_of_a_table_can_be_choices():
    d = declaration()
    assert d.designations("rods") == ("thin", "thick", "odd")
    assert d.option("rod", d.designations("rods"), "thick") == "thick"


# -- unknowns --------------------------------------------------------------------------------------


def test_a_variable_has_bounds_and_grid_in_si():
    d = declaration()
    d.variable("side", "mm", 5, 8, grid=1, symbol="s")
    v = d.variables["side"]
    assert (v.lower, v.upper) == (0.005, 0.008)
    assert v.grid.tolist() == [0.005, 0.006, 0.007, 0.008]
    d.variable("free", "mm", 5, 8)
    assert not len(d.variables["free"].grid)


@pytest.mark.parametrize(("lower", "upper"), [(6, 5), (-1, -2)])
def test_the_ends_of_a_variable_are_in_order(lower, upper):
    with pytest.raises(DeclarationError, match="needs lower <= upper"):
        declaration().variable("side", "mm", lower, upper)


def test_a_grid_without_a_value_between_the_bounds_is_refused():
    # An empty grid would read as a continuous variable.
    with pytest.raises(DeclarationError, match="grid of variable side has no value"):
        declaration().variable("side", "mm", 5.2, 5.8, grid=1)


@pytest.mark.parametrize(
    ("grid", "lower", "upper", "expected"),
    [
        (None, 1, 2, []),
        (1, 4.5, 8, [5, 6, 7, 8]),
        (1, -2, 2, [-2, -1, 0, 1, 2]),
        (5, 12, 31, [15, 20, 25, 30]),
        (2.5, 5, 10, [5, 7.5, 10]),
        (0.5, 1, 2.4, [1, 1.5, 2]),
        (0.1, 0.2, 0.7, [0.2, 0.3, 0.4, 0.5, 0.6, 0.7]),
        (0.3, 0.3, 1.3, [0.3, 0.6, 0.9, 1.2]),
        (0.4, 0, 1.2, [0, 0.4, 0.8, 1.2]),
        ([3, 1, 2, 9], 1, 3, [1, 2, 3]),
        ((0.5,), 0.5, 1, [0.5]),
        ("R5", 1, 100, [1, 1.6, 2.5, 4, 6.3, 10, 16, 25, 40, 63, 100]),
        ("R10", 10, 32, [10, 12.5, 16, 20, 25, 31.5]),
        ("R20", 12, 20, [12.5, 14, 16, 18, 20]),
        ("R40", 0.95, 1.12, [0.95, 1, 1.06, 1.12]),
        ("R10", 0.8, 1.3, [0.8, 1, 1.25]),
        ("R10", 11, 11.2, []),
    ],
)
def test_grids(grid, lower, upper, expected):
    assert grid_values(grid, lower, upper).tolist() == pytest.approx(expected, rel=1e-12, abs=1e-12)


def test_a_tenth_millimetre_ladder_is_free_of_noise():
    assert grid_values(0.1, 0.1, 0.7).tolist() == [0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7]


def test_the_preferred_numbers_have_forty_steps_per_decade():
    for series, steps in (("R5", 5), ("R10", 10), ("R20", 20), ("R40", 40)):
        values = grid_values(series, 1, 999)
        assert len(values) == 3 * steps
        exact = 10 ** (np.arange(3 * steps) / steps)
        assert np.max(np.abs(values / exact - 1)) < 0.013  # ISO 3: at most 1.26 % from the exact power


@pytest.mark.parametrize(
    ("grid", "lower", "upper", "words"),
    [("R7", 1, 2, "unknown preferred number series"), ("R10", 0, 2, "above 0"), (0, 1, 2, "above 0"), (-1, 1, 2, "0")],
)
def test_grids_that_cannot_be(grid, lower, upper, words):
    with pytest.raises(DeclarationError, match=words):
        grid_values(grid, lower, upper)


def test_counts_go_in_steps():
    d = declaration()
    d.count("surfaces", 2, 9, step=2, symbol="z")
    d.count("coils", 2, 4, step=0.5)
    assert d.counts["surfaces"].values.tolist() == [2, 4, 6, 8]
    assert d.counts["coils"].values.tolist() == [2, 2.5, 3, 3.5, 4]


@pytest.mark.parametrize(("lower", "upper", "step"), [(3, 2, 1), (1, 4, 0), (1, 4, -1)])
def test_a_count_needs_values(lower, upper, step):
    with pytest.raises(DeclarationError, match="lower <= upper and a step above 0"):
        declaration().count("rods", lower, upper, step)


def test_a_choice_selects_by_label():
    d = declaration()
    end = d.choice("end", ("hook", "eye", "pin"), symbol="e")
    x = ca.SX.sym("x")
    value = end.select({"pin": 3 * x, "hook": x, "eye": 7.0})
    f = ca.Function("f", [end.sx, x], [value])
    assert [float(f(k, 2.0)) for k in range(3)] == [2.0, 7.0, 6.0]


def test_a_choice_needs_every_label_once():
    d = declaration()
    end = d.choice("end", ("hook", "eye"))
    for values in ({"hook": 1}, {"hook": 1, "eye": 2, "pin": 3}, {"hook": 1, "pin": 2}):
        with pytest.raises(DeclarationError, match="must name exactly the labels"):
            end.select(values)
    for labels in ((), ("a", "a")):
        with pytest.raises(DeclarationError, match="labels, each once"):
            d.choice(f"bad{len(labels)}", labels)


def choosing(d):
    x = d.variable("x", "mm", 1, 2)
    end = d.choice("end", ("hook", "eye"), refused={"glue": "glue does not hold"})
    d.refuse("hook_bends", end.select({"hook": d.requirement("load", "kN", 1) > 2e3, "eye": 0.0}), "an eye")
    d.derive("stress", "N/mm2", 1e9 * x, ceiling=4)
    d.objective("stress")


def test_a_label_that_cannot_be_offered_is_refused_with_its_reason():
    asked = problem(choosing)
    with pytest.raises(synth.InputError, match="fix: end: got 'glue'; expected one of hook, eye; glue does not hold"):
        synth.synthesize(asked, {}, fix={"end": "glue"})
    with pytest.raises(synth.InputError, match="values: end: got 'glue'; expected one of hook, eye; glue does"):
        synth.evaluate(asked, {}, values={"x": 1, "end": "glue"})
    with pytest.raises(synth.InputError, match=r"fix: end: got 'rope'; expected one of hook, eye$"):
        synth.synthesize(asked, {}, fix={"end": "rope"})


def test_a_refusal_over_a_choice_names_its_labels():
    asked = problem(choosing)
    left = instance_of(asked(), {"load": 3}, CATALOGS).selection.left_out
    assert left == [{"slot": "end", "designation": "hook", "reason": "hook_bends: an eye"}]
    with pytest.raises(synth.InputError, match="hook_bends: got 'end = hook'; expected an eye"):
        instance_of(asked(), {"load": 3}, CATALOGS, fix={"end": "hook"})


def test_no_limit_above_its_ceiling_may_be_typed_for_a_quantity():
    asked = problem(choosing)()
    for text in ("<= 4 N/mm2", ">= 5 N/mm2", "1 N/mm2 .. 3 N/mm2"):
        instance_of(asked, {}, CATALOGS, limits={"stress": text})
    for text in ("<= 4.1 N/mm2", "== 5 N/mm2", "1 N/mm2 .. 5 N/mm2"):
        with pytest.raises(synth.InputError, match=r"limits: stress: got .*; expected at most 4 N/mm2"):
            instance_of(asked, {}, CATALOGS, limits={"stress": text})


# -- parts -----------------------------------------------------------------------------------------


def test_columns_of_a_part_are_symbols_made_once():
    d = declaration()
    rod = d.part("rod", "rods", where="diameter > 5", symbol="r", text="a rod", source="table")
    assert rod.diameter is rod.diameter
    assert str(rod.diameter) == "rod.diameter"
    assert d.slots["rod"].where == ("diameter > 5",)
    assert set(rod.columns) == {"diameter"}


def test_conditions_may_be_several_and_empty_ones_are_none():
    d = declaration()
    assert d.part("rod", "rods", where=("diameter > 5", "", "diameter < 15")).where == ("diameter > 5", "diameter < 15")
    assert d.part("other", "rods", where="").where == ()


def test_a_column_that_the_table_lacks_or_that_is_text_is_refused():
    for column in ("mass", "note"):
        d = declaration()
        d.derive("told", "kg", 2 * getattr(d.part("rod", "rods"), column))
        right = f"table rods, column {column}: is missing; expected a number column, which slot rod uses"
        with pytest.raises(synth.InputError, match=right):
            d.settle_columns([])


@pytest.mark.parametrize(
    "read",
    [
        pytest.param(lambda d, x: d.derive("told", "kg", 2 * x), id="quantity"),
        pytest.param(lambda d, x: d.at_most("told", x, 3, "kg"), id="limit"),
        pytest.param(lambda d, x: d.at_least("told", 3, x, "kg"), id="bound"),
        pytest.param(lambda d, x: d.requirement("told", "kg", default=2 * x), id="default"),
        pytest.param(lambda d, x: d.refuse("told", x > 3, "heavy"), id="refusal"),
        pytest.param(lambda d, x: d.advise("told", x > 3, "heavy"), id="remark"),
    ],
)
def test_a_column_that_results_read_is_asked_of_the_table(read):
    d = declaration()
    read(d, d.part("rod", "rods").mass)
    with pytest.raises(synth.InputError, match="column mass"):
        d.settle_columns([])


def test_a_column_that_hooks_alone_read_is_not_asked_of_the_table():
    d = declaration()
    rod = d.part("rod", "rods")
    d.derive("told", "mm", rod.diameter)
    d.step("length", "mm", rod.free_length - rod.diameter)
    d.settle_columns([])
    assert {name for name, column in rod.columns.items() if column.required} == {"diameter"}


def test_a_column_that_a_special_function_reads_is_asked_of_the_table():
    with recorded() as calls:
        d = declaration()
        rod = d.part("rod", "rods")
        d.derive("told", "-", sum_geometric(rod.diameter, sum_geometric(rod.mass, 3)))
    with pytest.raises(synth.InputError, match="column mass"):
        d.settle_columns(calls)


def test_a_table_that_is_not_there_is_refused():
    with pytest.raises(synth.InputError, match="got 'rodz'"):
        declaration().part("rod", "rodz")


def test_optional_columns_void_the_limits_that_use_them():
    def declare(d):
        rod = d.part("rod", "rods")
        d.variable("length", "m", 1, 2)
        d.derive("stress", "N/mm2", 90e6 * rod.diameter / rod.diameter, text="", source="")
        d.at_most("stress", 90e6 + 0 * rod.diameter, rod.optional("stress_allow"), "N/mm2")
        d.at_most("fatigue", rod.diameter, rod.optional("nowhere"), "mm")
        d.objective("length")

    def check(name):
        return synth.evaluate(
            problem(declare), {}, values={"length": "1 m"}, parts={"rod": name}, catalogs={"rods": RODS}
        )

    assert check("thin").utilisation == {"stress": pytest.approx(0.9), "fatigue": None}
    assert check("thin").not_checked == ("not checked: fatigue, no rod.nowhere",)
    assert check("thin").status.value == "feasible"
    assert check("thick").violated == ("stress",)
    odd = check("odd")
    assert odd.utilisation == {"stress": None, "fatigue": None}
    assert odd.not_checked[0] == "not checked: stress, no rod.stress_allow"
    assert odd.violated == ()


def test_first_of_takes_the_first_column_that_has_a_value():
    def declare(d):
        rod = d.part("rod", "rods")
        d.variable("length", "m", 1, 2)
        d.derive("strength_used", "N/mm2", rod.first_of("strength_forged", "strength"))
        d.objective("length")

    def strength(name):
        design = synth.evaluate(
            problem(declare), {}, values={"length": "1 m"}, parts={"rod": name}, catalogs={"rods": RODS}
        )
        return design.values["strength_used"]

    assert [strength(n) for n in ("thin", "thick", "odd")] == [400e6, 600e6, 700e6]


def test_one_use_that_needs_a_column_makes_it_required():
    def declare(d):
        rod = d.part("rod", "rods")
        d.variable("length", "m", 1, 2)
        d.at_most("a", 1e6, rod.optional("stress_allow"), "N/mm2")
        d.at_most("b", 2e6, rod.stress_allow, "N/mm2")
        d.objective("length")

    instance = instance_of(problem(declare)(), {}, CATALOGS)
    assert instance.combinations.count == 2
    assert instance.selection.left_out == [
        {"slot": "rod", "designation": "odd", "reason": "no value in column stress_allow"}
    ]


def test_a_fixed_row_gives_its_columns():
    def declare(d):
        fan = d.row("cooling_options", "fan")
        d.requirement("transfer", "W/(m2*K)", default=fan.heat_transfer)
        d.requirement("bonus", "-", default=ca.if_else(fan.optional("nowhere") > 0, 2.0, 1.0))
        d.variable("length", "m", 1, 2)
        d.objective("length")

    instance = instance_of(problem(declare)(), {}, Catalogs())
    assert instance.values.requirements == {"transfer": 50.0, "bonus": 1.0}
    with pytest.raises(synth.InputError, match="storm"):
        declaration().row("cooling_options", "storm")


# -- derived quantities, limits, objectives ----------------------------------------------------------


def test_names_and_symbols_are_unique():
    d = declaration()
    d.requirement("force", "N", symbol="F")
    for make in (
        lambda: d.requirement("force", "N"),
        lambda: d.variable("F", "N", 1, 2),
        lambda: d.derive("flow", "N", 1.0, symbol="F"),
        lambda: d.option("force", ("a",), "a"),
        lambda: d.count("F", 1, 2),
        lambda: d.choice("force", ("a", "b")),
        lambda: d.part("force", "rods"),
    ):
        with pytest.raises(DeclarationError, match="is already the name or symbol of force"):
            make()


def test_a_limit_may_share_its_name_with_a_quantity_but_not_with_a_limit():
    d = declaration()
    x = d.variable("width", "mm", 1, 2)
    d.at_most("width", x, 0.0015, "mm", text="fits", source="room")
    limit = d.limits["width"]
    assert (limit.sense, limit.unit, limit.text, limit.source, limit.guard) == ("at_most", "mm", "fits", "room", False)
    with pytest.raises(DeclarationError, match="limit width is declared twice"):
        d.at_least("width", x, 0.001, "mm")


def test_limits_have_three_senses():
    d = declaration()
    x = d.variable("width", "mm", 1, 2)
    d.at_most("a", x, 1, "mm")
    d.at_least("b", x, 1, "mm", guard=True)
    d.equal("c", x, 1, "mm", scale=0.5)
    assert [limit.sense for limit in d.limits.values()] == ["at_most", "at_least", "equal"]
    assert [limit.guard for limit in d.limits.values()] == [False, True, False]
    assert d.limits["c"].scale == 0.0005
    assert d.limits["a"].scale == SMALLEST
    with pytest.raises(DeclarationError, match="guard"):
        d.equal("e", x, 1, "mm", guard=True)


def test_a_unit_that_does_not_exist_is_told():
    d = declaration()
    for make in (
        lambda: d.requirement("a", "furlong"),
        lambda: d.variable("b", "furlong", 1, 2),
        lambda: d.derive("c", "furlong", 1.0),
        lambda: d.at_most("d", 1.0, 2.0, "furlong"),
    ):
        with pytest.raises(DeclarationError, match="furlong"):
            make()


def test_objectives_name_a_quantity_and_a_sense():
    d = declaration()
    d.variable("width", "mm", 1, 2)
    d.objective("width", "max", default=False)
    assert (d.objectives["width"].sense, d.objectives["width"].default) == ("max", False)
    with pytest.raises(DeclarationError, match="write 'min' or 'max'"):
        d.objective("width", "least")
    d.objective("mass")
    with pytest.raises(DeclarationError, match="objective mass is no variable, count or derived quantity"):
        d.finish()


def test_what_is_split_last_is_an_unknown():
    d = declaration()
    d.variable("width", "mm", 1, 2)
    d.count("pieces", 1, 3)
    d.split_last("width", "pieces")
    assert d.late == {"width": (), "pieces": ()}
    d.finish()
    d.split_last("pieces", unless=("width",))
    with pytest.raises(DeclarationError, match="width decides what is split last, but is no objective"):
        d.finish()
    d.objective("width")
    d.finish()
    d.split_last("mass")
    with pytest.raises(DeclarationError, match="mass is split last, but is no variable, count or part"):
        d.finish()


def test_a_quantity_can_only_need_a_guard():
    for guard in (True, False):
        d = declaration()
        x = d.variable("width", "mm", 1, 2)
        d.at_least("positive", x, 0.0015, "mm", guard=guard)
        d.derive("root", "-", np.sqrt(x - 0.0015), needs="positive")
        if guard:
            d.finish()
        else:
            with pytest.raises(DeclarationError, match="root needs 'positive', which is no guard"):
                d.finish()


class Guarded(synth.DesignProblem):
    """A root that exists above 2 mm only, and what follows from it."""

    name = "guarded"

    def declare(self, d):
        x = d.variable("width", "mm", 1, 4)
        d.at_least("wide_enough", x, 0.002, "mm", guard=True)
        d.derive("margin", "mm", x - 0.002)
        root = d.derive("root", "-", np.sqrt(x - 0.002), needs="wide_enough")
        d.derive("twice", "-", 2 * root)
        d.at_most("root", 2 * root, 0.05, "-")
        d.objective("width")


def test_behind_a_guard_that_fails_quantities_are_null_and_the_guard_alone_is_named():
    bad = synth.evaluate(Guarded, {}, values={"width": "1.5 mm"})
    assert bad.violated == ("wide_enough",)
    assert math.isnan(bad.values["root"])
    assert math.isnan(bad.values["twice"])
    assert bad.values["margin"] == pytest.approx(-0.0005)
    assert bad.utilisation["root"] is None
    good = synth.evaluate(Guarded, {}, values={"width": "2.4 mm"})
    assert good.violated == ()
    assert good.values["twice"] == pytest.approx(0.04)
    assert good.utilisation["root"] == pytest.approx(0.8)


def test_a_guard_has_no_tolerance():
    # The border itself is on the wrong side of a guard, where another limit would hold.
    assert synth.evaluate(Guarded, {}, values={"width": "2 mm"}).violated == ("wide_enough",)


# -- refusals and advice -----------------------------------------------------------------------------


def test_a_refusal_of_a_continuous_variable_is_no_refusal():
    def direct(d):
        d.refuse("narrow", d.variable("width", "mm", 1, 2) < 0.0015, "more")

    def through_a_quantity(d):
        x = d.variable("width", "mm", 1, 2)
        d.refuse("narrow", d.derive("area", "mm2", x * x) < 1e-6, "more")

    for declare in (direct, through_a_quantity):
        with pytest.raises(DeclarationError, match="refusal narrow speaks of a continuous variable; that is a limit"):
            instance_of(problem(declare)(), {}, CATALOGS)


def test_a_refusal_over_requirements_stops_the_call_and_shows_their_values():
    def declare(d):
        low, high = d.requirement("low", "kN", 1), d.requirement("high", "kN", 2)
        d.refuse("crossed", low > high, "low below high")
        d.variable("x", "mm", 1, 2)
        d.objective("x")

    instance_of(problem(declare)(), {}, CATALOGS)
    with pytest.raises(synth.InputError, match=r"crossed: got 'low = 3 kN, high = 2 kN'; expected low below high"):
        instance_of(problem(declare)(), {"low": "3 kN"}, CATALOGS)


def test_a_refusal_of_an_option_shows_it():
    def declare(d):
        finish = d.option("finish", ("plain", "gold"), "plain")
        d.refuse("too_dear", finish == "gold", "finish = plain")
        d.variable("x", "mm", 1, 2)
        d.objective("x")

    instance_of(problem(declare)(), {}, CATALOGS)
    with pytest.raises(synth.InputError, match="too_dear: got 'finish = gold'; expected finish = plain"):
        instance_of(problem(declare)(finish="gold"), {}, CATALOGS)


def test_a_refusal_over_a_part_or_count_leaves_rows_out():
    def declare(d):
        thin = d.requirement("least", "mm", 12)
        rod, n = d.part("rod", "rods"), d.count("n", 1, 4)
        d.refuse("too_thin", rod.diameter < thin, "a thicker rod")
        d.refuse("odd_number", (n == 1) + (n == 3) > 0, "an even number")
        d.variable("x", "mm", 1, 2)
        d.objective("x")

    instance = instance_of(problem(declare)(), {}, CATALOGS)
    assert instance.selection.counts["n"].tolist() == [2, 4]
    assert [instance.selection.slots[0].table.designations[k] for k in instance.selection.slots[0].rows] == [
        "thick",
        "odd",
    ]
    assert instance.selection.left_out == [
        {"slot": "rod", "designation": "thin", "reason": "too_thin: a thicker rod"},
        {"slot": "n", "designation": "1", "reason": "odd_number: an even number"},
        {"slot": "n", "designation": "3", "reason": "odd_number: an even number"},
    ]
    with pytest.raises(synth.InputError, match="too_thin: got 'thin, thick, odd'; expected a thicker rod"):
        instance_of(problem(declare)(), {"least": "30 mm"}, CATALOGS)
    with pytest.raises(synth.InputError, match="too_thin"):
        synth.evaluate(problem(declare), {}, values={"x": 1, "n": 2}, parts={"rod": "thin"}, catalogs={"rods": RODS})


def test_a_refusal_over_two_unknowns_leaves_their_combinations_out():
    def declare(d):
        rod, n = d.part("rod", "rods"), d.count("n", 1, 2)
        d.refuse("crowded", n * rod.diameter > 0.025, "fewer or thinner rods")
        x = d.variable("x", "mm", 1, 2)
        d.derive("total", "mm", x - n * rod.diameter)
        d.objective("total")

    front = synth.synthesize(problem(declare), {}, catalogs={"rods": RODS})
    best = front.designs[0]
    # Two thick rods (40 mm) and two odd ones (30 mm) are too many; two thin ones are as good as one thick.
    assert (str(best.parts["rod"]), best.values["n"]) in {("thick", 1), ("thin", 2)}
    assert best.values["total"] == pytest.approx(-0.019, rel=1e-6)


def test_advice_is_printed_where_it_applies():
    def declare(d):
        x = d.variable("width", "mm", 1, 4)
        d.advise("wide", x > 0.002, "is it not too wide?", source="habit")
        d.advise("always", True, "remember this")
        d.advise("never", False, "never seen")
        d.objective("width")

    assert synth.evaluate(problem(declare), {}, values={"width": 1}).advice == ("always: remember this",)
    assert synth.evaluate(problem(declare), {}, values={"width": 3}).advice == (
        "wide: is it not too wide? [habit]",
        "always: remember this",
    )


# -- the class ---------------------------------------------------------------------------------------


def test_a_problem_needs_a_name_and_a_declare():
    with pytest.raises(DeclarationError, match="needs a class attribute 'name'"):
        type("Nameless", (synth.DesignProblem,), {})()
    with pytest.raises(DeclarationError, match="does not define declare"):
        instance_of(type("Empty", (synth.DesignProblem,), {"name": "empty"})(), {}, CATALOGS)


def test_a_symbol_from_elsewhere_is_found():
    stranger = ca.SX.sym("stranger")

    def declare(d):
        x = d.variable("width", "mm", 1, 4)
        d.at_most("sum", x + stranger, 1, "mm")

    with pytest.raises(DeclarationError, match=r"limit sum uses \['stranger'\], which the declaration does not make"):
        instance_of(problem(declare)(), {}, CATALOGS)


def test_loading_takes_options_with_a_name_or_a_class_only():
    instance = synth.load("multi_plate_clutch", lubrication="dry")
    assert instance.options == {"lubrication": "dry"}
    assert synth.load(instance) is instance
    with pytest.raises(synth.InputError, match="no options here"):
        synth.load(instance, lubrication="oil")
    with pytest.raises(synth.InputError, match="did you mean multi_plate_clutch"):
        synth.load("multi_plate_cluch")
    with pytest.raises(synth.InputError, match="the name of a family"):
        synth.load(7)


def test_number_evaluates_an_expression():
    x, y = ca.SX.sym("x"), ca.SX.sym("y")
    assert number(x / y, {"x": 3.0, "y": 4.0, "z": 1.0}) == 0.75
    assert number(2.5, {}) == 2.5


# -- blocks ----------------------------------------------------------------------------------------


class Load(Block):
    """What a sample is asked to carry."""

    material = Option(table="rods", default="thin", text="Which rod")
    force = Requirement("kN", lower=1, upper=100, symbol="F", text="Pull", source="statics")
    peak = Requirement("N", lambda load: 2 * load.force, symbol="F_peak")
    room = Requirement("mm", optional=True)

    @property
    def mean(self):
        return (self.force + self.peak) / 2


class LoadedRod(Load):
    """A block that has fields of its own, and a field of its base with another text."""

    length = Variable("mm", 10, 20, grid=5, symbol="l")
    force = Requirement("kN", 5, lower=1, upper=100, symbol="F", text="Pull on the rod")
    rod = Slot("rods", where="strength > 0")


def test_a_block_declares_what_the_verbs_declare():
    d, same = declaration(), declaration()
    load = d.block(Load)
    assert same.option("material", same.designations("rods"), "thin", text="Which rod") == load.material == "thin"
    force = same.requirement("force", "kN", lower=1, upper=100, symbol="F", text="Pull", source="statics")
    same.requirement("peak", "N", 2 * force, symbol="F_peak")
    same.requirement("room", "mm", optional=True)
    assert load.room is None
    assert list(d.requirements) == list(same.requirements) == ["force", "peak", "room"]
    assert [str(r) for r in d.requirements.values()] == [str(r) for r in same.requirements.values()]
    assert d.options == same.options
    assert d.names() == same.names()
    assert str(load.mean) == str((d.requirements["force"].sx + d.requirements["peak"].sx) / 2)


def test_a_block_takes_defaults_where_it_is_used():
    d = declaration()
    load = d.block(Load, material="thick", force=3, peak=lambda own: 4 * own.force)
    assert load.material == "thick"
    assert d.requirements["force"].default == 3000
    assert str(d.requirements["peak"].default) == str(4 * load.force)


def test_a_derived_block_keeps_the_order_of_its_base():
    d = declaration()
    loaded = d.block(LoadedRod)
    assert list(LoadedRod.fields()) == ["material", "force", "peak", "room", "length", "rod"]
    assert d.requirements["force"].text == "Pull on the rod"
    assert d.variables["length"].grid.tolist() == pytest.approx([0.010, 0.015, 0.020])
    assert d.slots["rod"] is loaded.rod
    assert str(loaded.rod.diameter) == "rod.diameter"


def test_faults_of_a_block_are_named():
    with pytest.raises(DeclarationError, match="block Load has no field 'weight'"):
        declaration().block(Load, weight=3)
    with pytest.raises(DeclarationError, match="variable length has no default"):
        declaration().block(LoadedRod, length=3)
    with pytest.raises(DeclarationError, match="slot rod has no default"):
        declaration().block(LoadedRod, rod="thin")
    with pytest.raises(AttributeError, match="cannot be set"):
        declaration().block(Load).force = 3
    round_about = {"first": Requirement("N", lambda own: own.second), "second": Requirement("N", lambda own: own.first)}
    with pytest.raises(DeclarationError, match="default of first is made of itself"):
        declaration().block(type("RoundAbout", (Block,), round_about))
    assert Load.force.text == "Pull"


class Speeds(Block):
    """Two words for one thing: each follows from the other."""

    shaft = Requirement("1/min", lambda own: own.motor / 2 if own.specifies("motor") else None)
    motor = Requirement("1/min", lambda own: None if own.specifies("motor") else 2 * own.shaft)


@pytest.mark.parametrize(
    ("stated", "shaft", "motor"),
    [((), None, "(2.*shaft)"), (("shaft",), None, "(2.*shaft)"), (("motor",), "(motor/2)", None)],
)
def test_words_that_follow_from_each_other(stated, shaft, motor):
    d = declaration(stated)
    d.block(Speeds)
    defaults = {name: r.default if r.default is None else str(r.default) for name, r in d.requirements.items()}
    assert defaults == {"shaft": shaft, "motor": motor}
    assert list(d.requirements) == (["motor", "shaft"] if "motor" in stated else ["shaft", "motor"])


def test_texts_and_numbers_of_a_table_without_a_slot():
    d = declaration()
    assert d.cell("rods", "thick", "note") == "b"
    assert d.cell("rods", "thick", "colour") == ""
    assert d.numbers("rods", "diameter").tolist() == pytest.approx([0.010, 0.020, 0.015])
    assert not d.rows


# -- steps -----------------------------------------------------------------------------------------


def stepped(d):
    force = d.requirement("force", "N", symbol="F")
    diameter = d.variable("diameter", "mm", 1, 50, symbol="d")
    area = d.step("area", "mm2", 0.785 * diameter**2, symbol="A", text="Section", source="geometry")
    d.at_most("stress", d.derive("stress", "N/mm2", force / area), 100e6, "N/mm2")
    d.objective("diameter")


def test_a_step_is_read_by_hooks_and_is_no_result():
    told = {}

    def curves(self, spec, design=None):
        told.update(design.steps)
        frame = pd.DataFrame({"area [mm2]": [1e6 * design.steps["area"]]})
        frame.attrs["title"] = "area"
        return {"area": frame}

    kind = problem(stepped)
    kind.curves = curves
    found = synth.evaluate(kind, {"force": "1 kN"}, values={"diameter": "10 mm"})
    assert found.steps == {"area": pytest.approx(0.785e-4, rel=1e-15)}
    assert set(found.values) == {"diameter", "stress"}
    assert "area" not in synth.describe(kind)["name"].tolist()
    synth.curves(kind, {"force": "1 kN"}, found)
    assert told == found.steps
    (best,) = synth.synthesize(kind, {"force": "1 kN"}).designs
    assert best.steps == {"area": pytest.approx(0.785 * best.values["diameter"] ** 2, rel=1e-15)}
    with pytest.raises(synth.InputError, match="area"):
        synth.evaluate(kind, {"force": "1 kN"}, values={"diameter": "10 mm"}, limits={"area": "<= 1 mm2"})


def test_steps_behind_a_guard_do_not_exist_where_it_fails():
    def declare(d):
        force = d.requirement("force", "N", symbol="F")
        diameter = d.variable("diameter", "mm", 1, 50, symbol="d")
        d.at_least("room", diameter, 5e-3, "mm", guard=True)
        left = d.derive("left", "mm", diameter - 5e-3, needs=["room"])
        d.step("pressure", "N/mm2", force / left**2)
        d.step("section", "mm2", 0.785 * diameter**2)
        d.at_most("stress", d.derive("stress", "N/mm2", force / diameter**2), 100e6, "N/mm2")
        d.objective("diameter")

    def steps(diameter):
        return synth.evaluate(problem(declare), {"force": "1 kN"}, values={"diameter": diameter}).steps

    assert steps("10 mm")["pressure"] == pytest.approx(1e3 / 5e-3**2)
    assert np.isnan(steps("4 mm")["pressure"])
    assert steps("4 mm")["section"] == pytest.approx(0.785 * 16e-6)


def test_the_search_does_not_see_steps():
    def bare(d):
        force = d.requirement("force", "N", symbol="F")
        diameter = d.variable("diameter", "mm", 1, 50, symbol="d")
        d.at_most("stress", d.derive("stress", "N/mm2", force / (0.785 * diameter**2)), 100e6, "N/mm2")
        d.objective("diameter")

    def program(declare):
        return problem(declare)().model(frozenset(), CATALOGS).program

    assert program(stepped).nodes == program(bare).nodes


def test_a_step_has_a_name_of_its_own():
    d = declaration()
    d.step("area", "mm2", 1.0, symbol="A")
    assert "area" not in d.names()
    with pytest.raises(DeclarationError, match="'A' of area_2"):
        d.derive("area_2", "mm2", 1.0, symbol="A")


# -- rows next to a quantity -----------------------------------------------------------------------

PINS = pd.DataFrame(
    {
        "designation": ["C", "A", "blank", "B"],  # in no order
        "diameter [mm]": [24.0, 8.0, None, 12.0],
        "source": ["made up"] * 4,
    }
)
CLIPS = pd.DataFrame(
    {"designation": ["small", "large"], "over [mm]": [8.0, 12.0], "up_to [mm]": [12.0, 20.0], "source": ["made up"] * 2}
)
BOUGHT = Catalogs({"pins": PINS, "clips": CLIPS})


def pinned(d):
    force = d.requirement("force", "N", symbol="F")
    need = d.requirement("need", "mm", (force / 100e6) ** 0.5, upper=1000)
    length = d.variable("length", "mm", 1, 50)
    clips = RowRange("clips", over="over", up_to="up_to")
    d.next_row("pin", need, "pins", "diameter", beside=clips, text="Pin to buy")
    d.next_row("rod", length, "pins", "diameter")
    d.at_least("stress", d.derive("grip", "mm", length), need, "mm")
    d.objective("length")


def beside(need, length="20 mm"):
    kind = problem(pinned)
    return synth.evaluate(kind, {"force": "1 kN", "need": need}, values={"length": length}, catalogs=BOUGHT).next_rows


@pytest.mark.parametrize(
    ("need", "pin", "clip"),
    [("3 mm", "A", None), ("8.1 mm", "B", "small"), ("12 mm", "B", "small"), ("12.001 mm", "C", None)],
)
def test_the_next_row_is_the_smallest_that_is_not_below(need, pin, clip):
    found = beside(need)
    assert (found["pin"].designation, found["pin"].beside) == (pin, clip)
    assert (found["rod"].designation, found["rod"].beside_table) == ("C", None)
    lack = "" if clip else ", for which clips has no row"
    assert str(found["pin"]).endswith(f"{need} needed)" + (f" with {clip}" if clip else lack))


def test_beyond_the_last_row_there_is_none_and_it_is_said():
    found = beside("24.1 mm")["pin"]
    assert (found.designation, found.value, found.beside) == (None, None, None)
    assert str(found) == "none, 24.1 mm needed and table pins ends at 24 mm"


def test_the_next_row_of_a_size_that_is_typed_in_another_unit():
    assert beside("0.012 m")["pin"].designation == beside("1.2 cm")["pin"].designation == "B"


def test_next_rows_stand_in_front_json_alone(tmp_path):
    def bare(d):
        force = d.requirement("force", "N", symbol="F")
        need = d.requirement("need", "mm", (force / 100e6) ** 0.5, upper=1000)
        length = d.variable("length", "mm", 1, 50)
        d.at_least("stress", d.derive("grip", "mm", length), need, "mm")
        d.objective("length")

    folders = [
        synth.synthesize(problem(declare), {"force": "20 kN"}, catalogs=BOUGHT).save(tmp_path / name)
        for name, declare in (("with", pinned), ("without", bare))
    ]
    tables = [(folder / "designs.csv").read_bytes() for folder in folders]
    assert tables[0] == tables[1]
    told, plain = (synth.load_front(folder).designs[0] for folder in folders)
    assert str(told.next_rows["pin"]) == "C (24 mm, 14.142 mm needed), for which clips has no row"
    assert not plain.next_rows
    assert "next_rows" not in (folders[1] / "front.json").read_text(encoding="utf-8")


def test_where_a_quantity_does_not_exist_no_row_is_next_to_it():
    def declare(d):
        diameter = d.variable("diameter", "mm", 1, 50, symbol="d")
        d.at_least("room", diameter, 5e-3, "mm", guard=True)
        d.next_row("pin", d.derive("left", "mm", diameter - 5e-3, needs=["room"]), "pins", "diameter")
        d.objective("diameter")

    def found(diameter):
        return synth.evaluate(problem(declare), {}, values={"diameter": diameter}, catalogs=BOUGHT).next_rows

    assert found("10 mm")["pin"].designation == "A"
    assert not found("4 mm")


def test_a_next_row_has_a_name_of_its_own_and_a_column_of_numbers():
    d = Declaration("sample", {}, frozenset(), BOUGHT)
    d.next_row("pin", 1e-3, "pins", "diameter")
    assert "pin" not in d.names()
    with pytest.raises(DeclarationError, match="pin"):
        d.next_row("pin", 1e-3, "pins", "diameter")
    with pytest.raises(synth.InputError, match="diametre"):
        d.next_row("other", 1e-3, "pins", "diametre")
    with pytest.raises(synth.InputError, match="text"):
        d.next_row("third", 1e-3, "pins", "diameter", beside=RowRange("clips", over="source", up_to="up_to"))
