"""The table of what a problem declares."""

from __future__ import annotations

import math
from typing import Any

import pandas as pd
import pytest

import synth
from synth.analysis.describe import COLUMNS, describe
from synth.declaration import Block, Option, Requirement, RowRange
from synth.errors import InputError
from synth.question.catalogs import as_catalogs
from synth.question.ranges import declared_ranges
from tests.shipped import FAMILIES


class Sample(synth.DesignProblem):
    """One of everything."""

    name, title = "sample", "Sample"

    def declare(self, d: Any) -> None:
        shape = d.option("shape", ("round", "square"), "round", symbol="sh", text="Cross-section")
        force = d.requirement("force", "kN", lower=1, upper=100, symbol="F", text="Pull")
        factor = d.requirement("factor", "-", default=2, text="Safety")
        peak = d.requirement("peak_force", "kN", default=2.5 * force, symbol="F_pk")
        room = d.requirement("room", "mm", optional=True)
        cooling = d.row("cooling_options", "fan")
        d.requirement("transfer", "W/(m2*K)", default=cooling.heat_transfer)
        side = d.variable("side", "mm", 5, 100, grid=1, symbol="s")
        d.variable("free", "mm", 5, 100)
        rods = d.count("rods", 1, 4)
        end = d.choice("end", ("hook", "eye"))
        plate = d.part("plate", "core_plates", where="thickness >= 1")
        area = rods * side**2 * (0.785398 if shape == "round" else 1.0)
        d.derive("area", "mm2", area, symbol="A", source="geometry")
        d.derive("weight_index", "-", side * plate.thickness * end.select({"hook": 2.0, "eye": 1.0}))
        d.at_most("stress", factor * peak / area, 100e6, "N/mm2", source="statics")
        d.at_most("peak", peak + force, 500e3, "kN")
        if room is not None:
            d.at_most("room", side, room, "mm")
        d.objective("weight_index")
        d.objective("area", "max", default=False)
        d.refuse("too_much", force > 1e6, "less force")
        d.advise("thick", side > 0.05, "a thick rod", source="habit")
        ends = RowRange("parallel_keys", over="shaft_diameter_over", up_to="shaft_diameter_up_to")
        d.next_row("end_piece", side, "shaft_ends", "diameter", beside=ends, text="Machined end")


@pytest.fixture(scope="module")
def rows() -> dict[tuple[str, str], dict[str, Any]]:
    table = describe(Sample())
    assert tuple(table.columns) == COLUMNS
    return {(row["kind"], row["name"]): row for row in table.to_dict("records")}


def test_every_kind_is_there(rows: dict[tuple[str, str], dict[str, Any]]) -> None:
    kinds = {kind for kind, _ in rows}
    assert kinds == {
        "option",
        "requirement",
        "variable",
        "count",
        "choice",
        "slot",
        "column",
        "derived",
        "limit",
        "objective",
        "refusal",
        "advice",
        "next_row",
    }


def test_a_row_that_is_named_says_where_it_stands(rows: dict[tuple[str, str], dict[str, Any]]) -> None:
    row = rows["next_row", "end_piece"]
    assert (row["unit"], row["text"]) == ("mm", "Machined end")
    assert row["choices"] == "next diameter of shaft_ends, with its row of parallel_keys"


def test_numbers_are_in_the_unit_of_their_row(rows: dict[tuple[str, str], dict[str, Any]]) -> None:
    force = rows["requirement", "force"]
    assert (force["lower"], force["upper"], force["unit"], force["symbol"]) == (1, 100, "kN", "F")
    assert force["default"] is None
    assert not force["optional"]
    side = rows["variable", "side"]
    assert (side["lower"], side["upper"], side["choices"]) == (5, 100, "5, 6, 7 .. 100 (96 values)")
    assert rows["variable", "free"]["choices"] == ""
    assert rows["count", "rods"]["choices"] == "1, 2, 3, 4"
    assert rows["choice", "end"]["choices"] == "hook, eye"


def test_defaults_are_numbers_or_say_what_they_follow(rows: dict[tuple[str, str], dict[str, Any]]) -> None:
    assert rows["requirement", "factor"]["default"] == 2.0
    assert rows["requirement", "peak_force"]["default"] == "2.5*force"
    assert rows["requirement", "transfer"]["default"] == 50.0  # the row fan of cooling_options
    assert math.isnan(rows["requirement", "transfer"]["upper"])
    assert rows["option", "shape"]["default"] == "round"
    assert rows["option", "shape"]["choices"] == "round, square"


def test_optional_requirements_and_their_limits_are_listed(rows: dict[tuple[str, str], dict[str, Any]]) -> None:
    assert rows["requirement", "room"]["optional"]
    assert rows["limit", "room"]["sense"] == "at_most"
    assert rows["limit", "stress"]["source"] == "statics"


def test_parts_columns_objectives_and_remarks(rows: dict[tuple[str, str], dict[str, Any]]) -> None:
    assert rows["slot", "plate"]["choices"] == "rows of core_plates where thickness >= 1"
    column = rows["column", "plate.thickness"]
    assert (column["unit"], column["optional"]) == ("mm", False)
    assert column["text"]
    assert (column["lower"], column["upper"]) == (0.05, 20.0)
    assert (rows["objective", "weight_index"]["sense"], rows["objective", "weight_index"]["default"]) == ("min", "yes")
    assert (rows["objective", "area"]["sense"], rows["objective", "area"]["default"]) == ("max", "no")
    assert rows["objective", "area"]["unit"] == "mm2"
    assert rows["refusal", "too_much"]["text"] == "less force"
    assert rows["advice", "thick"]["source"] == "habit"


def test_derived_quantities_limits_and_objectives_are_classified(rows: dict[tuple[str, str], dict[str, Any]]) -> None:
    found = {key: row["classification"] for key, row in rows.items() if row["classification"]}
    assert found == {
        ("derived", "area"): "log-affine",
        ("derived", "weight_index"): "log-affine",
        ("limit", "stress"): "not surely positive",  # nothing says that the factor and the peak are
        ("limit", "peak"): "not surely positive",
        ("limit", "room"): "log-affine",  # a side fits in no room of 0
        ("objective", "weight_index"): "log-affine",
        ("objective", "area"): "log-affine",
    }


def test_what_an_optional_requirement_replaces_is_classified_without_it() -> None:
    class Either(synth.DesignProblem):
        name, title = "either", "Either"

        def declare(self, d: Any) -> None:
            side = d.variable("side", "mm", 5, 100)
            given = d.requirement("given", "mm", lower=1, optional=True)
            height = 1e-3 + side if given is None else given
            d.derive("area", "mm2", side * height)
            if given is not None:
                d.at_most("limit", height, 0.1, "mm")

    table = describe(Either()).set_index(["kind", "name"])["classification"]
    assert table["derived", "area"] == "log-convex"
    assert table["limit", "limit"] == "log-affine"


def test_ranges_are_those_declared_and_offered() -> None:
    catalogs = as_catalogs(None)
    model = Sample().model(frozenset(), catalogs)
    names = [v.name for v in model.variables] + [e.label for e in model.data_inputs]
    low, high = (dict(zip(names, ends, strict=True)) for ends in declared_ranges(model, catalogs))
    assert (low["side"], high["side"]) == pytest.approx((0.005, 0.1))
    assert (low["force"], high["force"]) == (1e3, 1e5)
    assert (low["factor"], high["factor"]) == (-math.inf, math.inf)
    assert (low["rods"], high["rods"]) == (1, 4)
    assert (low["end"], high["end"]) == (0, 1)
    thickness = catalogs.table("core_plates").number("thickness")
    assert (low["plate.thickness"], high["plate.thickness"]) == (1e-3, thickness.max())
    assert thickness.min() < 1e-3


def test_an_unknown_option_is_refused() -> None:
    with pytest.raises(synth.InputError, match="shape"):
        describe(Sample(shape="oval"))


@pytest.mark.slow
@pytest.mark.parametrize("family", FAMILIES)
def test_every_family_can_be_described(family: str) -> None:
    table = describe(family)
    assert not table.duplicated(["kind", "name"]).any()
    named = table[table["kind"].isin(["option", "requirement", "variable", "count", "choice", "slot", "derived"])]
    assert not named["symbol"].duplicated().any()
    assert (named["text"] != "").all()
    judged = table["kind"].isin(["derived", "limit", "objective"])
    assert ((table["classification"] != "") == judged).all()
    assert table["classification"].str.len().max() <= 100


class Common(Block):
    group = "duty"

    torque = Requirement("N*m", 10)
    room = Requirement("mm", 100, group="envelope")
    speed = Requirement("1/min", 100)


class Own(Common):
    group = "model"

    torque = Requirement("N*m", 20)
    kind = Option(("a", "b"), "a")


class Grouped(synth.DesignProblem):
    """Groups of a block, of a field, of a base class, of a verb, and none."""

    name = "grouped"

    def declare(self, d: Any) -> None:
        d.block(Own)
        d.requirement("loose", "-", 1)
        d.option("said", ("yes", "no"), "no", group="duty")
        d.variable("x", "-", 1, 2)
        d.objective("x")


def test_a_requirement_stands_in_its_group_or_in_that_of_the_class_that_declares_it() -> None:
    groups = describe(Grouped()).set_index(["kind", "name"])["group"]
    assert dict(groups[groups != ""]) == {
        ("requirement", "torque"): "model",
        ("requirement", "room"): "envelope",
        ("requirement", "speed"): "duty",
        ("option", "kind"): "model",
        ("option", "said"): "duty",
    }
    assert ("requirement", "loose") in groups


def test_what_is_plausible_of_a_column_is_what_is_taken(rows: dict[tuple[str, str], dict[str, Any]]) -> None:
    """Of a table of one's own in other units as well, and without a range where no table says one."""

    def plate(thickness: float) -> Any:
        return {"core_plates": pd.DataFrame({"designation": ["own"], "thickness [m]": [thickness]})}

    own = describe(Sample(), plate(0.0199)).query("name == 'plate.thickness'").iloc[0]
    assert (own["unit"], own["lower"], own["upper"]) == ("mm", 0.05, 20.0)
    with pytest.raises(InputError, match=r"0\.05 \.\. 20 mm"):
        describe(Sample(), plate(0.0201))
    cost = describe("multi_plate_clutch").query("name == 'friction_pair.unit_cost'").iloc[0]
    assert math.isnan(cost["lower"])
    assert math.isnan(cost["upper"])
