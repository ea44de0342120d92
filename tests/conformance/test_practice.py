"""Rules of practice in every family: they only add, and what they add is never lighter or smaller."""

from __future__ import annotations

import pytest

import synth
from tests.conformance.cases import CASES, Design

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
    },
}


def asked(family: str, name: str, **changed: str) -> synth.Design:
    """Return the design that is known of an option set, with some of its options changed."""
    data = CASES[family]
    design: Design = data.designs[name]
    chosen = {**data.option_sets[name], **changed}
    needed = [
        more
        for word, more in data.needed.items()
        if word.split("=")[0] != "practice" and word.split("=")[1] == chosen.get(word.split("=")[0])
    ]
    plain = synth.load(family, practice=chosen["practice"])
    declared = set(synth.describe(plain).query("kind == 'option'")["name"])
    return synth.evaluate(
        synth.load(family, **{key: word for key, word in chosen.items() if key in declared}),
        {**data.requirements, **SAME.get(family, {}), **{key: own for more in needed for key, own in more.items()}},
        values={**design.sizes, **design.counts},
        parts=design.parts,
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
    on, off = asked(family, name), asked(family, name, practice="off")
    senses = synth.describe(synth.load(family, practice="off")).query("kind == 'objective'")
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
    before = set(synth.describe(synth.load(family, practice="off"))["name"])
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
