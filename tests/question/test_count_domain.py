"""Sets of allowed counts: read without doubt, kept to by every answer, and kept in files."""

import json

import numpy as np
import pandas as pd
import pytest

import synth
from synth.question.catalogs import catalogs_for
from synth.question.count_domain import compares, entries
from synth.question.spec import spec_from_mapping
from tests.asking import instance_of
from tests.sample_problems.strut import NEEDED, RODS, Strut

CATALOGS = {"rods": RODS}
SMALL = {"catalogs": CATALOGS, "parts": {"plate": ["core 1", "core 2"]}, "points": 6, "gap": 0.01}


def counts(**more):
    instance = instance_of(Strut(), NEEDED, catalogs_for(Strut(), CATALOGS), **more)
    return instance.selection.counts["plates"].tolist()


@pytest.mark.parametrize(
    "asked", [[1, 3, 4], (4, 1, 3), {3, 4, 1}, np.array([1, 3, 4]), ["1", "3", "4"], "[1, 3, 4]", [1.0, "[3,4]"]]
)
def test_entries_without_a_sign_are_the_values_allowed(asked):
    assert counts(limits={"plates": asked}) == [1, 3, 4]
    assert counts(fix={"n": asked}) == [1, 3, 4]


def test_comparisons_of_a_list_all_hold_and_a_set_holds_besides():
    assert counts(limits={"plates": [">= 2", "<= 3"]}) == [2, 3]
    assert counts(limits={"plates": [1, 2, 4, ">= 2"]}) == [2, 4]
    assert counts(limits={"plates": [1, 2, 4]}, fix={"plates": [2, 3]}) == [2]
    assert counts(limits={"plates": range(1, 5, 2)}) == [1, 3]
    assert [compares(entry) for entry in entries([1, "2 .. 3", "[4, 5]", ">= 2"])] == [False, True, False, False, True]


@pytest.mark.parametrize(
    ("more", "message"),
    [
        ({"limits": {"plates": [1, 5]}}, "limits: plates: got 5; expected values from 1 to 4 in steps of 1"),
        ({"limits": {"plates": [1.5]}}, r"limits: plates: got 1\.5; expected values from 1 to 4 in steps of 1"),
        ({"limits": {"plates": []}}, r"limits: plates: got \[\]; expected at least one value"),
        ({"limits": {"plates": [1, ">= 2"]}}, r"plates: got '>= 2 and in \[1\]'; expected conditions that leave"),
        ({"limits": {"width": [1, 2]}}, "limits: width: .*a set of values is for counts"),
        ({"limits": {"mass": ["1 kg", "<= 2 kg"]}}, "limits: mass: .*a set of values is for counts"),
        ({"limits": {"plates": 2}}, "limits: plates: got 2; expected a comparison"),
        ({"limits": {"plates": [2, None]}}, "limits: plates: is missing; expected a number"),
        ({"fix": {"plates": [0]}}, "fix: plates: got 0; expected values from 1 to 4"),
        (
            {"fix": {"plate": ["core 1", "core 2"]}},
            r"fix: plate: .*one value; .*\(parts takes a list of designations\)",
        ),
        ({"fix": {"width": [20, 30]}}, "fix: width: .*one value; a set of values is for counts"),
    ],
)
def test_what_cannot_be_meant_is_one_sentence(more, message):
    with pytest.raises(synth.InputError, match=message) as refusal:
        counts(**more)
    (key,) = more
    (name,) = more[key]
    assert refusal.value.path[:2] in ((key, name), ())


def test_the_search_keeps_to_a_set_and_its_front_is_proven_saved_and_read(tmp_path):
    front = synth.synthesize(Strut(), NEEDED, limits={"plates": [1, 4]}, **SMALL)
    assert front.certificate.kind == "global"
    assert front.certificate.combinations == 2 * 3 * 2 * 2  # plates, rods, counts, ends
    assert {d.values["plates"] for d in front.designs} <= {1.0, 4.0}
    single = [synth.synthesize(Strut(), NEEDED, fix={"plates": n}, objectives=["mass"], **SMALL) for n in (1, 4)]
    least = min(f.designs[0].values["mass"] for f in single)
    assert min(d.values["mass"] for d in front.designs) == pytest.approx(least, rel=1e-9)
    front.save(tmp_path)
    assert json.loads((tmp_path / "front.json").read_text())["settings"]["limits"] == {"plates": [1, 4]}
    again = synth.load_front(tmp_path)
    checked = again.verify(Strut(), CATALOGS)
    assert checked.holds, checked.findings
    spec = again.designs[0].to_spec()
    assert spec["limits"] == {"plates": [1, 4]}
    same = synth.evaluate(Strut(), NEEDED, spec, catalogs=CATALOGS, limits=spec["limits"])
    assert same.status == "feasible"
    assert "plates in [1, 4]" in same.utilisation


def test_a_front_with_another_count_does_not_hold(tmp_path):
    front = synth.synthesize(Strut(), NEEDED, fix={"plates": [2, 3]}, **SMALL)
    front.settings["fix"]["plates"] = [1, 4]
    front.save(tmp_path)
    checked = synth.load_front(tmp_path).verify(Strut(), CATALOGS)
    assert not checked.holds
    assert any("is not a value that this question may use" in finding for finding in checked.findings)


def test_a_given_design_may_miss_a_set():
    values = {"width": "50 mm", "length": "200 mm", "plates": 2, "end": "eye"}
    design = synth.evaluate(
        Strut(),
        NEEDED,
        values=values,
        parts={"plate": "core 2", "material": "soft"},
        catalogs=CATALOGS,
        limits={"plates": [1, 4]},
    )
    assert "plates in [1, 4]" in design.violated
    assert design.limits["plates in [1, 4]"] == (2, 1)  # the nearest of the set


@pytest.mark.slow
def test_studies_and_explanations_keep_to_a_set():
    study = synth.whatif(
        Strut(),
        NEEDED,
        {"load": "18 kN, 20 kN"},
        objectives=["mass"],
        limits={"plates": [1, 4]},
        catalogs=CATALOGS,
        parts=SMALL["parts"],
    )
    assert {d.values["plates"] for f in study.fronts for d in f.designs} <= {1.0, 4.0}
    study = synth.whatif(
        Strut(),
        NEEDED,
        {"plates <=": "2, 3, 4"},
        objectives=["flexibility"],
        limits={"plates": [1, 3, 4]},
        catalogs=CATALOGS,
        parts=SMALL["parts"],
    )
    assert [f.designs[0].values["plates"] for f in study.fronts] == [1, 3, 4]
    asked = {"limits": {"plates": [2, 3], "mass": "<= 1 g"}, "parts": SMALL["parts"], "catalogs": CATALOGS}
    explained = synth.explain(Strut(), NEEDED, **asked)
    assert explained.ways
    assert {way.design.values["plates"] for way in explained.ways} <= {2.0, 3.0}


@pytest.mark.slow
@pytest.mark.parametrize("restriction", ["limits", "fix"])
def test_a_batch_takes_sets_for_all_rows_in_cells_and_in_columns(restriction, tmp_path):
    rows, duty = tmp_path / "rows.csv", "600,254,30,300,230,2"
    pinned = "ring_outer_diameter [mm],ring_inner_diameter [mm],ramp_time [s]"  # the force is all that is left to find
    header = f"load_torque [N*m],driver_speed [1/min],driven_inertia [kg*m2],{pinned},{restriction},z"
    lines = [f'{duty},"friction_surfaces: [8, 12]",', f"{duty},,"]
    if restriction == "limits":  # a column pins: what is fixed elsewhere as well would be told
        lines.append(f'{duty},"friction_surfaces: [4, 10, 16]","[16, 10, 12]"')
    rows.write_text("\n".join([header, *lines]) + "\n")
    parts = {"friction_pair": ["seed_multiplate_ref"], "inner_plate": ["core 4"], "outer_plate": ["core 2"]}
    done = synth.batch(
        synth.load("multi_plate_clutch", practice="off"),
        rows,
        tmp_path / "out",
        parts=parts,
        points=1,
        objectives=["mass"],
        **{restriction: {"friction_surfaces": range(20, 25, 4)}},
    )
    assert done.counts == {"optimal": len(lines)}
    counts = pd.read_csv(tmp_path / "out" / "designs.csv").set_index("row")["friction_surfaces [-]"]
    asked = pd.read_csv(tmp_path / "out" / "rows.csv").sort_values("line")["row"]
    for row, right in zip(asked, [(8, 12), (20, 24), (10, 16)], strict=False):
        assert counts[row] in right


def test_a_spec_may_hold_sets(tmp_path):
    content = {"family": "multi_plate_clutch", "limits": {"z": [8, "12"], "mass": ["<= 5 kg"]}, "fix": {"z": [8, 12]}}
    spec = spec_from_mapping(content, "spec.yaml", tmp_path)
    assert (spec.limits["z"], spec.fix["z"]) == ([8, "12"], [8, 12])
    for key, wrong in (("limits", {"z": [True]}), ("limits", {"z": 8}), ("fix", {"z": [None]}), ("fix", {"z": [[8]]})):
        with pytest.raises(synth.InputError, match=f"spec.yaml: {key}: z"):
            spec_from_mapping({"family": "multi_plate_clutch", key: wrong}, "spec.yaml", tmp_path)
