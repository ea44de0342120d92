"""The family roller_coupling: numbers against section by section sums, limits, refusals, remarks, motion, curves."""

import math

import numpy as np
import pandas as pd
import pytest

import synth
from synth.question.catalogs import as_catalogs
from synth.tables.catalogs import Catalogs
from tests.asking import instance_of
from tests.problems.of_a_family import requirements_in_si

BASE = {"required_torque": "300 N*m", "driver_speed": "960 rpm", "offset": "5 mm"}
OPTIONAL = {"outer_diameter_limit": "300 mm", "mass_limit": "10 kg", "vibration_limit": "500 N"}
POINT = {
    "arm_radius": "50 mm",
    "guide_half_length": "60 mm",
    "contact_length": "9 mm",
    "rim": "6 mm",
    "offset_capacity": "6 mm",
    "balance": "no",
}
PARTS = {"roller": "6204", "float_material": "100Cr6"}
CROWNED = {"roller": "NUTR 20"}
ANGLED = {"shaft_angle": "2 deg", "float_distance": "80 mm", "guide_angle": "75 deg"}
ALWAYS = {
    "offset",
    "roller_gap",
    "run_in",
    "run_out",
    "contact_length",
    "hertz",
    "outer_ring_bending",
    "pin_shear",
    "pin_stress",
    "bearing_static",
    "ligament",
    "rim",
    "contact_retention",
}


def family(**options):
    return synth.load("roller_coupling", practice="off", **options)


def design(options=None, requirements=None, values=None, parts=None, **more):
    return synth.evaluate(
        family(**(options or {})),
        BASE | (requirements or {}),
        values=POINT | (values or {}),
        parts=PARTS | (parts or {}),
        **more,
    )


def spec_of(options=None, requirements=None):
    return requirements_in_si(family(**(options or {})), BASE | (requirements or {}))


def by_hand(roller, material, torque, speed, e, alpha, h, chi, balance, crowned):
    """Section 6 of the reference in plain floats; sizes are those of POINT."""
    r, half, length, rim, cap = 0.05, 0.06, 0.009, 0.006, 0.006
    bore, diameter, width = roller["bore"], roller["outer_diameter"], roller["width"]
    eff = math.sqrt(e**2 + (h * math.tan(alpha)) ** 2)
    along = eff / math.sin(chi)
    slide = math.tan(alpha) * math.sqrt(e**2 + (h * math.sin(alpha)) ** 2) / math.sin(chi)
    b = length + slide + 2 * 0.0005
    outside = math.sqrt(half**2 + diameter**2 / 4) + rim
    section = math.pi * outside**2 - (4 * half * diameter - diameter**2 / math.sin(chi))
    m = material["density"] * b * section
    m_c = roller["mass"] + 7850 * math.pi / 4 * bore**2 * (width + 0.002)
    tangential = torque / 2 / r
    q = m * along * speed**2 / math.sin(chi)
    normal = tangential + q
    pin = math.sqrt(normal**2 + (m_c * r * speed**2) ** 2)
    modulus = 1 / ((1 - 0.09) / 206e9 + (1 - material["nu"] ** 2) / material["E"])
    limits = {
        "offset": (cap, eff),
        "roller_gap": (2 * r * math.sin(chi / 2) - cap - diameter, 0.002),
        "run_in": (r - cap / math.sin(chi) - diameter / 2 / math.tan(chi / 2), 0.003),
        "run_out": (half - r - cap / math.sin(chi), 0.003),
        "contact_length": (length, roller["contact_width"]),
        "pin_shear": (1.4 * torque / (r * math.pi * bore**2 / 4), 40e6),
        "bearing_static": (pin, 2 * roller["C0_static_min"]),
        "ligament": (2.5 * normal / (rim * b), material["strength_allow"]),
        "rim": (rim, 0.003),
        "contact_retention": (tangential, 1.5 * q),
    }
    if crowned:
        ratio = 0.5 / (diameter / 2)
        k, e2 = 1.0339 * ratio**0.6360, 1.0003 + 0.5968 / ratio
        reduced = 1 / (2 / diameter + 1 / 0.5)
        long_axis = (3 * k**2 * e2 * normal * reduced / (math.pi * modulus)) ** (1 / 3)
        pressure = 3 * normal / (2 * math.pi * long_axis * long_axis / k)
        limits["contact_ellipse"] = (2 * long_axis, length)
        limits["outer_ring_bending"] = (normal, roller["outer_ring_load_limit"])
    else:
        pressure = math.sqrt(normal * modulus / (math.pi * length * diameter / 2))
    limits["hertz"] = (pressure, material["hertz_allow"])
    bending = 32 * pin * (width / 2 + 0.002) / (math.pi * bore**3)
    shear = 4 * pin / (math.pi * bore**2)
    stress = math.sqrt(bending**2 + 3 * shear**2)
    limits["pin_stress"] = (stress, 160e6)
    arms = 2 * 7850 * (2 * r + 2 * bore) * 2 * bore * 1.2 * bore
    values = {
        "effective_offset": eff,
        "axial_slide": slide,
        "float_width": b,
        "float_mass": m,
        "tangential_force": tangential,
        "centrifugal_force": q,
        "pin_force": pin,
        "hertz_pressure": pressure,
        "pin_stress": stress,
        "steady_force": q * (2 if balance else 1),
        "vibration_force": 0 if balance else q,
        "speed_fluctuation": 1 / math.cos(alpha) - 1,
        "efficiency": 1 - 4 * 0.002 * eff / (math.pi * r),
        "outer_diameter": 2 * (outside + along),
        "mass": m * (2 if balance else 1) + 4 * m_c + arms,
    }
    return values, limits


@pytest.mark.parametrize("crowned", [False, True])
@pytest.mark.parametrize("balance", [False, True])
@pytest.mark.parametrize("angled", [False, True])
@pytest.mark.parametrize("material", ["100Cr6", "EN AW-7075-T6", "PA6-G (cast)"])
def test_numbers_against_an_independent_calculation(crowned, balance, angled, material):
    found = design(
        {"roller_contact": "crowned"} if crowned else {},
        ANGLED if angled else {},
        {"balance": "yes" if balance else "no"},
        (CROWNED if crowned else {}) | {"float_material": material},
    )
    angles = (math.radians(2), 0.08, math.radians(75)) if angled else (0.0, 0.0, math.pi / 2)
    rows = found.parts["roller"], found.parts["float_material"]
    values, limits = by_hand(*rows, 300.0, 960 * math.pi / 30, 0.005, *angles, balance, crowned)
    assert set(values) <= set(found.values)
    for name, value in values.items():
        assert found.values[name] == pytest.approx(value, rel=1e-9, abs=1e-15), name
    for name, sides in limits.items():
        assert found.limits[name] == pytest.approx(sides, rel=1e-9, abs=1e-15), name


def test_the_coupling_of_the_source():
    """Szoke's example: 15 mkp at 2880/min, r = 50, D = 54, K = 73 mm, offset 14.5 mm, with a row of its own."""
    row = {
        "designation": "source",
        "kind": "deep_groove_ball_bearing",
        "bore [mm]": 20,
        "outer_diameter [mm]": 54,
        "width [mm]": 14,
        "contact_width [mm]": 12,
        "C0_static_min [N]": 7800,
        "mass [kg]": 0.4 - 7850 * math.pi / 4 * 0.02**2 * 0.016,
    }
    found = synth.evaluate(
        family(),
        {"required_torque": "15 mkp", "driver_speed": "2880 rpm", "offset": 0},
        values={**POINT, "guide_half_length": "73 mm", "offset_capacity": "14.5 mm"},
        parts={"roller": "source", "float_material": "100Cr6"},
        catalogs={"guide_rolling_bearings": pd.DataFrame([row])},
    )
    assert found.values["tangential_force"] / 9.80665 == pytest.approx(150.0)
    assert found.values["pin_force"] / 9.80665 == pytest.approx(
        238.561, abs=5e-4
    )  # without offset the float is at rest
    gap, run_in, run_out = (found.limits[name][0] for name in ("roller_gap", "run_in", "run_out"))
    assert 1000 * gap == pytest.approx(10 * (1.47107 - 1.45) + 2, abs=1e-4)
    assert 1000 * run_in == pytest.approx(8.5)
    assert 1000 * run_out == pytest.approx(8.5)
    assert found.not_checked == ("not checked: outer_ring_bending, no roller.outer_ring_load_limit",)


def test_limits_are_built_when_they_are_asked_for():
    assert set(design().limits) == ALWAYS
    assert set(design({"sideways_removable": "yes"}).limits) == ALWAYS | {"sideways"}
    assert set(design({"roller_contact": "crowned"}, parts=CROWNED).limits) == ALWAYS | {"contact_ellipse"}
    assert set(design(requirements=OPTIONAL).limits) == ALWAYS | {"outer_diameter", "mass", "vibration"}
    removal = design({"sideways_removable": "yes"}).limits["sideways"]
    assert removal == pytest.approx((0.05 - 0.047, 0.002))


def test_ball_bearings_are_not_checked_for_the_outer_ring():
    assert any("outer_ring_bending" in remark for remark in design().not_checked)
    assert design({"roller_contact": "crowned"}, parts=CROWNED).not_checked == ()


def test_slots_offer_what_fits_the_contact():
    table = Catalogs().table("guide_rolling_bearings")
    kinds = dict(zip(table.designations, table.text("kind"), strict=True))
    for options, wanted in (({}, {"deep_groove_ball_bearing"}), ({"roller_contact": "crowned"}, None)):
        rows = instance_of(family(**options), BASE, as_catalogs(None)).selection.slots[0]
        offered = {kinds[rows.table.designations[k]] for k in rows.rows}
        assert offered == wanted if wanted else all("track_roller" in kind for kind in offered)


# -- refusals and remarks -------------------------------------------------------------------------------


def refused(code, requirements=None, options=None, **more):
    with pytest.raises(synth.InputError) as caught:
        synth.synthesize(family(**(options or {})), BASE | (requirements or {}), **more)
    assert str(caught.value).startswith(code), caught.value
    return str(caught.value)


@pytest.mark.parametrize(
    ("code", "requirements", "options", "more"),
    [
        ("requirement required_torque", {"required_torque": 0}, {}, {}),
        ("requirement driver_speed", {"driver_speed": -1}, {}, {}),
        ("requirement roller_gap_min", {"roller_gap_min": 0}, {}, {}),
        ("requirement shaft_angle", {"shaft_angle": "12 deg"}, {}, {}),
        ("requirement guide_angle", {"guide_angle": "50 deg"}, {}, {}),
        ("no_oscillation", {"offset": 0, "oscillation_factor": 2}, {}, {}),
        ("no_oscillation", {"offset": 0, "float_distance": "50 mm", "oscillation_factor": 2}, {}, {}),
        ("oblique_removal", {"guide_angle": "80 deg"}, {"sideways_removable": "yes"}, {}),
        ("guide_not_sized", {}, {"guide": "piston"}, {}),
        ("guide_not_sized", {}, {"guide": "linkage"}, {}),
        ("envelope_too_small", {"outer_diameter_limit": "50 mm"}, {}, {}),
        ("no_roller_clears", {"offset": "190 mm"}, {}, {"parts": {"roller": ["6312"]}}),
        ("crown_too_round", {"crown_radius": "7 mm"}, {"roller_contact": "crowned"}, {}),
        ("vibration_contradictory", {"vibration_limit": "0.1 N"}, {}, {"fix": {"balance": "no"}}),
        ("fix: balance", {}, {}, {"fix": {"balance": "floating_masses"}}),
        ("limits: hertz_pressure", {}, {}, {"limits": {"hertz_pressure": "<= 4200 N/mm2"}}),
    ],
)
def test_what_cannot_be_is_refused(code, requirements, options, more):
    refused(code, requirements, options, **more)


def test_refusals_tell_the_reason():
    assert "refuted" in refused("fix: balance", fix={"balance": "floating_masses"})
    with pytest.raises(synth.InputError, match="refuted"):
        design(values={"balance": "floating_masses"})
    assert "4000 N/mm2" in refused("limits", limits={"hertz_pressure": "<= 4200 N/mm2"})
    assert "no roller in the catalogue clears" in refused(
        "no_roller_clears", {"offset": "190 mm"}, parts={"roller": ["6312"]}
    )
    assert "contradictory" in refused("vibration_contradictory", {"vibration_limit": "0.1 N"}, fix={"balance": "no"})


def test_sideways_removal_can_be_what_the_envelope_forbids():
    """A roller of 110 mm fits 87.5 mm of arm and is pulled out from 112 mm on."""
    asked = {**BASE, "outer_diameter_limit": "280 mm"}
    rows = {"roller": ["6212"]}
    assert instance_of(family(), asked, as_catalogs(None), parts=rows).combinations.count == 50
    with pytest.raises(synth.InputError, match=r"not_removable.*pulled apart sideways"):
        instance_of(family(sideways_removable="yes"), asked, as_catalogs(None), parts=rows)
    wide = {**BASE, "outer_diameter_limit": "320 mm"}
    assert instance_of(family(sideways_removable="yes"), wide, as_catalogs(None), parts=rows).combinations.count == 50


def test_rows_that_make_no_sense_are_left_out():
    frame = pd.DataFrame(
        {
            "designation": ["good", "bore", "wide"],
            "bore [mm]": [20, 50, 20],
            "outer_diameter [mm]": [47, 47, 47],
            "width [mm]": [14, 14, 14],
            "contact_width [mm]": [12, 12, 16],
            "C0_static_min [N]": [6550, 6550, 6550],
            "mass [kg]": [0.11, 0.11, 0.11],
        }
    )
    instance = instance_of(family(), BASE, as_catalogs({"guide_rolling_bearings": frame}))
    assert instance.selection.slots[0].table.designations[instance.selection.slots[0].rows[0]] == "good"
    assert len(instance.selection.slots[0].rows) == 1
    assert {e["designation"] for e in instance.selection.left_out} == {"bore", "wide"}


def test_hertz_allow_above_the_static_limit_is_capped_and_noted():
    table = Catalogs().table("float_materials")
    frame = table.select([table.row_index("100Cr6")]).to_frame()
    frame.loc[:, [c for c in frame.columns if c.startswith("hertz_allow")]] = 4500
    found = design(catalogs={"float_materials": frame})
    assert found.limits["hertz"][1] == pytest.approx(4000e6)
    assert any("capped at 4000" in text for text in found.advice)


def texts(found):
    return " ".join(found.advice)


def test_remarks():
    assert "plastic" in texts(design(parts={"float_material": "POM-C"}))
    assert "plastic" not in texts(design())
    assert "same balls" in texts(design(requirements={"offset": 0}))
    assert "no optimum arm" in texts(design(requirements={"driver_speed": 0}))
    assert "float distance does nothing" in texts(design(requirements={"float_distance": "20 mm"}))
    assert "must follow the tilt" in texts(design(requirements=ANGLED))
    assert "doubles the steady push" in texts(design(values={"balance": "yes"}))
    assert "doubles the steady push" not in texts(design())
    assert "rating life" in texts(design(requirements={"offset": "13 mm"}))
    assert design().advice == ()


def test_without_offset_the_static_rating_is_not_raised():
    assert design(requirements={"offset": 0}).limits["bearing_static"][1] == pytest.approx(6550.0)
    assert design().limits["bearing_static"][1] == pytest.approx(2 * 6550.0)
    angled = design(requirements={"offset": 0, "shaft_angle": "1 deg", "float_distance": "50 mm"})
    assert angled.limits["bearing_static"][1] == pytest.approx(2 * 6550.0)
    assert design(requirements={"oscillation_factor": 3}).limits["bearing_static"][1] == pytest.approx(3 * 6550.0)


def test_predecessors_are_described_as_the_source_states_them():
    for guide, words in (
        ("piston", ("lubrication", "sliding friction", "10 um", "Not stated", "Assumed")),
        ("linkage", ("10 mm set offset", "angle", "Not stated", "Assumed", "lubrication")),
    ):
        table = synth.describe(family(guide=guide))
        advice = table[table["kind"] == "advice"].set_index("name")["text"]
        for word in words:
            assert word in advice[f"{guide}_guide"], word
        assert "guide_not_sized" in set(table["name"])


# -- search ----------------------------------------------------------------------------------------------


def test_rim_of_the_lightest_coupling_is_the_root_of_the_ligament_quadratic():
    """All other limits given, the rim is the smaller root of a quadratic, because the rim's own mass pulls too."""
    fix = {"arm_radius": "90 mm", "contact_length": "12 mm", "balance": "no"}
    requirements = {**BASE, "driver_speed": "1000 rpm", "offset": "8 mm", "ligament_factor": 5}
    parts = {"roller": ["6206"], "float_material": ["S235"]}
    front = synth.synthesize(family(), requirements, objectives=["mass"], fix=fix, parts=parts, grid=False, gap=1e-5)
    (best,) = front.designs
    roller, material = best.parts["roller"], best.parts["float_material"]
    diameter, half, b, e = roller["outer_diameter"], 0.09 + 0.008 + 0.003, 0.013, 0.008
    assert best.values["guide_half_length"] == pytest.approx(half, rel=1e-5)
    k, speed = 5.0, 1000 * math.pi / 30
    c = material["density"] * b * e * speed**2
    corner = math.sqrt(half**2 + diameter**2 / 4)
    quadratic = k * math.pi * c
    linear = 2 * k * math.pi * c * corner - material["strength_allow"] * b
    constant = k * (300 / 0.18 + c * (math.pi * corner**2 - 4 * half * diameter + diameter**2))
    rim = 2 * constant / (-linear + math.sqrt(linear**2 - 4 * quadratic * constant))
    assert rim > 0.003
    assert best.values["rim"] == pytest.approx(rim, rel=1e-4)


@pytest.mark.slow
def test_a_front_of_a_whole_catalogue_is_proven():
    front = synth.synthesize(family(), BASE, objectives=["pin_force", "mass"], points=30)
    assert len(front.designs) == 30
    assert front.certificate.kind == "global"
    assert front.certificate.combinations == 39 * 25 * 2


# -- motion and curves -----------------------------------------------------------------------------------


def lowest(frame, *words):
    return min(frame[c].min() for c in frame.columns if all(w in c for w in words))


def greatest(frame, *words):
    return max(frame[c].max() for c in frame.columns if all(w in c for w in words))


@pytest.mark.parametrize("requirements", [{}, {"guide_angle": "70 deg"}, {"offset": "6 mm"}])
@pytest.mark.parametrize("balance", ["no", "yes"])
def test_motion_agrees_with_the_closed_forms_of_the_limits(requirements, balance):
    found = design(requirements=requirements, values={"balance": balance})
    frame = family().simulate(spec_of(requirements=requirements), found)["motion"]
    values, limits = found.values, found.limits
    assert len(frame) == 721
    assert not frame.isna().any().any()
    for column, limit in (("roller gap", "roller_gap"), ("run-in", "run_in"), ("run-out", "run_out")):
        at_capacity = lowest(frame, column, "at offset capacity") / 1000
        assert at_capacity == pytest.approx(limits[limit][0], abs=2e-6)
    tangential, centrifugal = values["tangential_force"], values["centrifugal_force"]
    assert greatest(frame, "contact force") == pytest.approx(tangential + centrifugal, rel=1e-4)
    assert lowest(frame, "contact force") == pytest.approx(tangential - centrifugal, rel=1e-4)
    assert greatest(frame, "pin force") == pytest.approx(values["pin_force"], rel=1e-4)
    shaft = frame[["force on shaft 1, x [N]", "force on shaft 1, y [N]"]].to_numpy()
    steady = shaft[:-1].mean(axis=0)
    assert math.hypot(*steady) == pytest.approx(values["steady_force"], rel=1e-9)
    assert np.hypot(*(shaft - steady).T).max() == pytest.approx(values["vibration_force"], abs=1e-7)
    assert frame["driven torque [N*m]"].to_numpy() == pytest.approx(300.0)
    for name, simulated in frame.attrs["quantities"].items():
        assert simulated == pytest.approx(values[name], rel=1e-4, abs=1e-7), name
    wide = (
        frame[["float centre x [mm]", "float centre y [mm]"]].max()
        - frame[["float centre x [mm]", "float centre y [mm]"]].min()
    )
    across = values["effective_offset"] / math.sin(spec_of(requirements=requirements)["guide_angle"])
    assert wide.to_numpy() == pytest.approx([1000 * across] * 2, rel=1e-4)


def test_motion_of_angled_shafts_agrees_to_the_order_of_alpha_squared():
    found = design(requirements=ANGLED)
    frame = family().simulate(spec_of(requirements=ANGLED), found)["motion"]
    slide = frame["slide along shaft 2 [mm]"]
    assert (slide.max() - slide.min()) / 1000 == pytest.approx(found.values["axial_slide"], rel=1e-3)
    assert frame["speed ratio [-]"].max() - 1 == pytest.approx(found.values["speed_fluctuation"], rel=0.1)
    normal = found.values["tangential_force"] + found.values["centrifugal_force"]
    assert greatest(frame, "contact force") == pytest.approx(normal, rel=2e-3)


def test_frames_are_headed_and_can_be_drawn():
    found = design(requirements=ANGLED)
    spec = spec_of(requirements=ANGLED)
    frames = family().simulate(spec, found) | family().curves(spec, found)
    assert set(frames) == {"motion", "pin_force", "angled_shafts"}
    for frame in frames.values():
        assert all(column.endswith("]") and " [" in column for column in frame.columns)
        assert frame.attrs["title"]
        for panel in frame.attrs["panels"]:
            assert set(panel["columns"]) <= set(frame.columns)
        for line in frame.attrs.get("lines", []):
            assert 0 <= line["panel"] < len(frame.attrs["panels"])
            assert math.isfinite(line["y"])


def test_curves_show_the_least_pin_force():
    found, spec = design(), spec_of()
    frame = family().curves(spec, found)["pin_force"]
    marks = {mark["label"]: mark["x"] for mark in frame.attrs["marks"]}
    assert marks["design"] == pytest.approx(50)
    lowest_row = frame["resultant [N]"].idxmin()
    assert frame["arm radius [mm]"][lowest_row] == pytest.approx(marks.get("least pin force", 150), rel=0.01)
    alone = family().curves(spec)["torque_force"]
    assert alone["from the torque [N]"].to_numpy() == pytest.approx(
        spec["required_torque"] / (2 * alone["arm radius [mm]"].to_numpy() / 1000)
    )
    assert set(family().curves(spec_of(requirements=ANGLED))) == {"torque_force", "angled_shafts"}
