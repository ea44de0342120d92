"""Rules of practice in every family: they only add, and what they add is never lighter or smaller."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import cache
from importlib import import_module
from typing import Any

import pandas as pd
import pytest
from synth.problems.components.shaft.model import SHAFT_STEEL
from synth.problems.mechanics.shaft import fatigue_shear, size_factor

import synth
from synth.tables.catalogs import Catalogs
from synth.testing import KnownDesign
from tests.asking import instance_of
from tests.conformance.cases import CASES
from tests.shipped import FAMILIES

KNOWN = [
    pytest.param(family, name, id=f"{family}-{name}")
    for family, data in CASES.items()
    for name in data.designs
    if data.option_sets[name].get("practice") == "on"
]

# What follows from the shaft with rules of practice, and is a figure of the source without them.
SAME = {
    "disc_clutch": {"disc_hub_radius": "20 mm"},
    "electromagnetic_clutch": {
        "magnet_bore_radius": "20 mm",
        "return_spring_force": "100 N",
        "release_drag_force": "20 N",
        "residual_gap": "0.4 mm",
        "still_heat_transfer": "12 W/(m2*K)",
    },
}
SAME_OPTIONS = {"magnetic_powder_clutch": {"cooling": "finned"}}


@cache
def problem_of(family: str, **options: str) -> synth.DesignProblem:
    """Problem of a family with options, traced once for all questions to it."""
    return synth.load(family, **options)


@cache
def declared(family: str, practice: str) -> frozenset[str]:
    """Names of the options of a family, with rules of practice or without."""
    return frozenset(synth.describe(problem_of(family, practice=practice)).query("kind == 'option'")["name"])


@cache
def asked(
    family: str, name: str, lacking: tuple[str, ...] = (), typed: tuple[tuple[str, str], ...] = (), **changed: str
) -> synth.Design:
    """Design known of an option set, with some of its requirements and options changed, or columns of linings lacking.

    It is evaluated once for all tests, which only read it.
    """
    data = CASES[family]
    design: KnownDesign = data.designs[name]
    chosen = {**data.option_sets[name], **changed}
    needed = [
        more
        for word, more in data.needed.items()
        if word.split("=")[0] != "practice" and word.split("=")[1] == chosen.get(word.split("=")[0])
    ]
    options = {key: word for key, word in sorted(chosen.items()) if key in declared(family, chosen["practice"])}
    return synth.evaluate(
        problem_of(family, **options),
        {
            **data.requirements,
            **SAME.get(family, {}),
            **{key: own for more in needed for key, own in more.items()},
            **dict(typed),
        },
        values={**design.sizes, **design.counts},
        parts=design.parts,
        catalogs=linings(lacking) if lacking else None,
    )


@pytest.mark.slow
@pytest.mark.parametrize(("family", "name"), KNOWN)
def test_the_complete_clutch_is_never_lighter_or_shorter_than_its_parts(family: str, name: str) -> None:
    whole, parts = (asked(family, name, mass_scope=word).values for word in ("complete", "parts"))
    for quantity in ("mass", "length", "outer_diameter"):
        assert whole[quantity] >= parts[quantity] * (1 - 1e-12), quantity
    assert whole["mass"] > parts["mass"]


@pytest.mark.slow
@pytest.mark.parametrize(("family", "name"), KNOWN)
def test_no_objective_improves_by_the_rules(family: str, name: str) -> None:
    same = SAME_OPTIONS.get(family, {})
    on, off = asked(family, name, **same), asked(family, name, practice="off", **same)
    senses = synth.describe(problem_of(family, practice="off")).query("kind == 'objective'")
    for quantity, sense in zip(senses["name"], senses["sense"], strict=True):
        if quantity not in off.values:  # of another pack
            continue
        better = (
            on.values[quantity] - off.values[quantity] if sense == "max" else off.values[quantity] - on.values[quantity]
        )
        assert better <= 1e-9 * abs(off.values[quantity]), quantity


@pytest.mark.slow
@pytest.mark.parametrize("family", sorted({p.values[0] for p in KNOWN}))
def test_every_rule_is_told_where_it_comes_from_and_stands_in_its_group(family: str) -> None:
    rows = synth.describe(family)
    before = set(synth.describe(problem_of(family, practice="off"))["name"])
    added = rows[(rows["kind"] == "requirement") & ~rows["name"].isin(before)]
    assert len(added) > 3
    assert (added["source"] != "").all()
    assert set(added["group"]) <= {"practice", "duty", "envelope", "actuator", "material"}
    assert (added["group"] == "practice").sum() > 3


@pytest.mark.slow
@pytest.mark.parametrize(("family", "name"), KNOWN)
def test_the_next_shaft_end_and_its_key_are_named(family: str, name: str) -> None:
    found = asked(family, name).next_rows["shaft_end"]
    assert (found.table, found.beside_table) == ("shaft_ends", "parallel_keys")
    assert found.value is not None
    assert found.needed <= found.value * (1 + 1e-9)
    assert found.beside is not None
    assert not asked(family, name, practice="off", mass_scope="parts").next_rows


TYPED = {
    "wrap_spring": "bore_diameter",
    "wrap_spring_actuated": "bore_diameter",
    "magnetic_powder_clutch": "shaft_radius",
}


@pytest.mark.slow
@pytest.mark.parametrize(("family", "name"), KNOWN)
def test_a_typed_shaft_must_stand_its_torque(family: str, name: str) -> None:
    size = TYPED.get(family, "shaft_diameter")
    share = 2 if size == "shaft_radius" else 1
    before = asked(family, name)
    thick, shear = before.next_rows["shaft_end"].needed, before.limits["shaft_strength"][0]
    for diameter in (thick, 8e-3):
        found = asked(family, name, typed=((size, f"{diameter / share!r} m"),))
        stands, limit = found.limits["shaft_strength"]
        assert stands == pytest.approx(shear * (thick / diameter) ** 3)  # 16 M/(pi d**3)
        assert limit == pytest.approx(fatigue_shear(SHAFT_STEEL, size_factor(diameter), 1.5))
        assert ("shaft_strength" in found.violated) == (stands > limit)
        assert found.steps["shaft_shear"] == pytest.approx(stands)
        end = found.next_rows["shaft_end"]
        assert end.typed
        assert "typed" in str(end)
        assert "needed" not in str(end)
    assert "shaft_strength" not in before.violated


RULED = {
    "multi_plate_clutch": "friction_surfaces_max",
    "disc_clutch": "plate_stiffness_ratio",
    "cone_clutch": "hub_factor",
    "electromagnetic_clutch": "over_excitation",
    "magnetic_powder_clutch": "shaft_shear_allow",
    "roller_coupling": "rim_ratio",
    "wrap_spring": "coils_per_hub_max",
    "wrap_spring_actuated": "spring_index_max",
    "centrifugal_lever": "shaft_shear_allow",
}


@pytest.mark.slow
@pytest.mark.parametrize("family", RULED)
def test_a_rule_without_practice_is_refused_by_its_reason(family: str) -> None:
    requirements = {**CASES[family].requirements, RULED[family]: 5}
    with pytest.raises(synth.InputError, match="is a rule of practice and counts only with practice: on"):
        synth.synthesize(synth.load(family, practice="off"), requirements)


def layered(family: str) -> list[Any]:
    """Modules of a family, or of a class that it derives from, which choose a layer by the rules of practice."""
    modules = [import_module(kind.__module__) for kind in type(synth.load(family)).__mro__]
    return [module for module in modules if hasattr(module, "LAYERS")]


LAYERED = [family for family in CASES if layered(family)]

OTHER_STRUCTURES = [("electromagnetic_clutch", {"pack": "disc"}), ("centrifugal_two_spring", {"mechanism": "lever"})]


@pytest.mark.slow
@pytest.mark.parametrize(("family", "options"), [*((family, {}) for family in LAYERED), *OTHER_STRUCTURES])
def test_practice_is_asked_by_the_layer_alone(
    family: str, options: Mapping[str, str], monkeypatch: pytest.MonkeyPatch
) -> None:
    def traced(practice: str) -> list[Any]:
        problem = type(synth.load(family))(practice=practice, **options)
        program = instance_of(problem, CASES[family].requirements, Catalogs()).model.program
        return [(node.op, tuple(node.args), node.constant) for node in program.nodes]

    before = traced("on")
    module = layered(family)[0]
    monkeypatch.setattr(module, "LAYERS", dict.fromkeys(module.LAYERS, module.LAYERS[False, False]))
    assert traced("on") == traced("off") != before


def test_families_with_a_layer_get_no_fewer() -> None:
    assert {*LAYERED} == {*FAMILIES}


# -- tables of linings of one's own ------------------------------------------------------------------

LIVES = {"wear_life", "overrun_life"}
LINED = [case for case in KNOWN if case.values[0] not in ("magnetic_powder_clutch", "roller_coupling")]


def linings(without: Sequence[str] = (), **cells: Any) -> dict[str, pd.DataFrame]:
    """Return the shipped linings as a table of one's own, without some columns, with others all alike."""
    table = Catalogs().table("friction_materials").to_frame()
    heads = [head for head in table if str(head).split(" [")[0] in without]
    assert len(heads) == len(without)
    return {"friction_materials": table.drop(columns=heads).assign(**cells)}


@pytest.mark.slow
@pytest.mark.parametrize(("family", "name"), LINED)
@pytest.mark.parametrize("lacking", [("wear_rate",), ("wearable_depth", "wear_rate")], ids=["rate", "both"])
def test_linings_whose_wear_is_not_known_can_be_used(family: str, name: str, lacking: tuple[str, ...]) -> None:
    full, found = asked(family, name), asked(family, name, lacking)
    assert set(found.values) == set(full.values) - LIVES
    lives = LIVES & set(full.limits)
    assert set(found.limits) == set(full.limits)
    assert {name for name in found.limits if found.utilisation[name] is None} >= lives
    assert not lives & set(found.violated)
    assert {remark.split(",")[0] for remark in found.not_checked} >= {f"not checked: {life}" for life in lives}
    told = [remark for remark in found.advice if remark.startswith("wear_not_known")]
    assert bool(told) == bool(LIVES & set(full.values))
    for remark in told:
        assert "table friction_materials has no wear" in remark


@pytest.mark.slow
def test_a_lining_that_does_not_say_its_status_is_current() -> None:
    duty = {"load_torque": "5 N*m", "driver_speed": "1500 1/min", "driven_inertia": "0.02 kg*m2"}
    for status, left in (("", True), ("current", True), ("historical", False)):
        tables = linings(status=status)
        if left:
            assert synth.synthesize("disc_clutch", duty, catalogs=tables, points=2).designs
        else:
            with pytest.raises(synth.InputError, match="status in"):
                synth.synthesize("disc_clutch", duty, catalogs=tables, points=2)


def test_no_objective_is_offered_of_a_wear_that_is_not_known() -> None:
    tables = linings(["wear_rate"])
    offered = synth.describe("disc_clutch", tables).query("kind == 'objective'")["name"].tolist()
    assert "wear_life" not in offered
    assert "wear_life" in synth.describe("disc_clutch").query("kind == 'objective'")["name"].tolist()
