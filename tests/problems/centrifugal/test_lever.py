"""The family centrifugal_lever: a whole design recomputed by hand, limits, refusals, remarks, curves."""

import math

import numpy as np
import pytest
from synth.problems.centrifugal.lever_curves import rod_lever

import synth

BASE = {
    "required_torque": "90 N*m",
    "idle_speed": "80 rad/s",
    "contact_speed_max": "135 rad/s",
    "full_torque_speed": "200 rad/s",
    "top_speed": "500 rad/s",
}
OPTIONAL = {"outer_diameter_limit": "240 mm", "engagement_heat_limit": "0.6 J/mm2"}
POINT = {
    "flyweight_mass": "0.65 kg",
    "flyweight_arm": "40 mm",
    "rest_radius": "61 mm",
    "spring_preload_deflection": "15 mm",
    "lever_stop_angle": "0.345 rad",
    "spring_arm": "27 mm",
    "rod_arm": "10.5 mm",
    "lining_inner_radius": "68 mm",
    "lining_outer_radius": "87 mm",
    "weights": 4,
    "clamp_springs": 5,
    "friction_surfaces": 2,
}
PARTS = {"clamp_spring": "CS-3.2x16x12.5", "friction_pair": "moulded_dry"}
ALWAYS = {
    "lever_angle",
    "ring_ratio_min",
    "ring_ratio_max",
    "engagement_heat",
    "stop_after_contact",
    "rod_inside_spring",
    "clamp_springs_loaded",
    "idle_release",
    "contact_not_too_late",
    "torque_worn",
    "full_clamp_speed",
    "lining_pressure",
    "no_snap_travel",
    "no_snap_clamp",
    "retraction_arm",
    "retraction_force",
    "spring_force",
    "weight_clear_of_hub",
}


def design(requirements=None, values=None, parts=None):
    return synth.evaluate(
        synth.load("centrifugal_lever", practice="off"),
        BASE | (requirements or {}),
        values=POINT | (values or {}),
        parts=PARTS | (parts or {}),
    )


def by_hand(spring, pair):
    """The reference in plain floats: sections 3.3 and 6 for the sizes of POINT."""
    m, l_c, r0, delta, phi, l_s, l_r = 0.65, 0.040, 0.061, 0.015, 0.345, 0.027, 0.0105
    r_i, r_o, n_w, n_s, z = 0.068, 0.087, 4, 5, 2
    k, mu = spring["rate_R"], pair["mu_dynamic"]
    s, lead, x0, wear = n_s * k, l_s - l_r, 0.003, 0.0006
    phi1 = x0 / l_r
    f0 = s * delta
    f1 = f0 + s * lead * phi1
    f2 = f0 + s * (l_s * phi - x0)
    r1, r2 = r0 + l_c * phi1, r0 + l_c * phi
    start = math.sqrt(f0 * lead / l_c / (m * r0))
    contact = math.sqrt(f1 * lead / l_c / (m * r1))
    free = math.sqrt(f1 * l_s / l_c / (m * r1))
    stop = math.sqrt(f2 * l_s / l_c / (m * r2))
    t_w = math.sqrt(m / (n_w * 7850 * 0.030))
    diameter = 2 * max(r_o + 0.003, r2 + t_w / 2 + 0.005)
    disc = 7850 * math.pi * (diameter**2 / 4 - 0.020**2) * 0.025
    worn = mu * z * (r_i + r_o) / 2 * (f2 - s * wear)
    pressure = f2 / (2 * math.pi * r_i * (r_o - r_i))
    values = {
        "weight_thickness": t_w,
        "clamp_force": f2,
        "contact_speed": contact,
        "release_speed": contact,
        "full_clamp_speed": stop,
        "idle_margin": contact / 80,
        "engagement_band": stop / contact,
        "worn_torque": worn,
        "lining_pressure": pressure,
        "stop_force": m * r2 * 500**2 - f2 * l_s / l_c,
        "outer_diameter": diameter,
        "mass": disc + m + n_s * spring["mass"],
        "inertia": disc * (diameter**2 / 4 + 0.020**2) / 2 + m * r2**2 + n_s * spring["mass"] * r0**2,
    }
    heat = 0.5 * 0.5 * 200**2 / (z * math.pi * (r_o**2 - r_i**2))
    limits = {
        "lever_angle": (phi, 0.35),
        "ring_ratio_min": (r_i / r_o, 0.55),
        "ring_ratio_max": (r_i / r_o, 0.80),
        "engagement_heat": (heat, pair["q_single_allow"]),
        "stop_after_contact": ((x0 + wear) / l_r, phi),
        "rod_inside_spring": (l_s, l_r),
        "clamp_springs_loaded": (delta + l_s * phi, x0),
        "idle_release": (contact, 1.15 * 80),
        "contact_not_too_late": (contact, 135),
        "torque_worn": (worn, 1.2 * 90),
        "full_clamp_speed": (stop, 200),
        "lining_pressure": (pressure, pair["p_allow"]),
        "no_snap_travel": (delta * l_c / lead, r0),
        "no_snap_clamp": ((delta - x0) * l_c / l_s, r0),
        "retraction_arm": (l_r, 0.8 * l_s),
        "retraction_force": (f0 * (1 - l_r / l_s), 150),
        "spring_force": (k * (delta + l_s * phi - x0), spring["max_force_Fn"]),
        "weight_clear_of_hub": (0.020 + t_w / 2 + l_s, r0),
    }
    return values, limits, (start, contact, free, stop)


def test_a_whole_design_against_an_independent_calculation():
    found = design()
    values, limits, speeds = by_hand(found.parts["clamp_spring"], found.parts["friction_pair"])
    for name, value in values.items():
        assert found.values[name] == pytest.approx(value, rel=1e-12), name
    assert set(found.limits) == ALWAYS == set(limits)
    for name, sides in limits.items():
        assert found.limits[name] == pytest.approx(sides, rel=1e-12), name
    assert found.status.value == "feasible"
    lever = rod_lever(specification(), found)
    assert lever.borders().speeds == pytest.approx(speeds, rel=1e-12)
    assert found.values["clamp_force"] == pytest.approx(lever.motion(300.0).clamp_force.max(), rel=1e-12)


def specification():
    """The requirements that the curves read, in SI."""
    return {
        "contact_travel": 0.003,
        "lining_wear": 0.0006,
        "idle_speed": 80.0,
        "contact_speed_max": 135.0,
        "full_torque_speed": 200.0,
        "torque_reserve": 1.2,
        "required_torque": 90.0,
    }


def test_limits_are_built_when_they_are_asked_for():
    asked = design(OPTIONAL)
    assert set(asked.limits) == ALWAYS | {"outer_diameter"}
    assert asked.limits["engagement_heat"][1] == pytest.approx(0.6e6)


@pytest.mark.parametrize(
    ("changed", "violated"),
    [
        ({"rod_arm": "27 mm"}, {"rod_inside_spring", "retraction_arm"}),
        ({"rod_arm": "24 mm"}, {"retraction_arm"}),
        ({"lever_stop_angle": "0.33 rad"}, {"stop_after_contact"}),
        ({"spring_preload_deflection": "1 mm"}, {"torque_worn", "retraction_force", "idle_release"}),
        ({"flyweight_arm": "200 mm"}, {"no_snap_travel"}),
        ({"rest_radius": "50 mm"}, {"weight_clear_of_hub"}),
        ({"flyweight_mass": "0.05 kg"}, {"contact_not_too_late", "full_clamp_speed"}),
        ({"lining_inner_radius": "78 mm"}, {"ring_ratio_max"}),
        ({"lining_inner_radius": "40 mm"}, {"ring_ratio_min"}),
    ],
)
def test_what_breaks_a_design_is_named(changed, violated):
    assert violated <= set(design(values=changed).violated)


def test_springs_that_cannot_follow_are_told():
    weak = design(values={"spring_preload_deflection": "20 mm"}, parts={"clamp_spring": "CS-3.2x16x8.5"})
    assert "spring_force" in weak.violated


def test_rod_and_spring_that_change_places_leave_no_speeds():
    """The question of the source: nothing draws the lever back, so it has no contact speed."""
    changed = design(values={"rod_arm": "27 mm", "spring_arm": "10.5 mm"})
    assert "rod_inside_spring" in changed.violated
    assert "retraction_force" in changed.violated
    assert math.isnan(changed.values["contact_speed"])
    assert math.isnan(changed.values["engagement_band"])


def test_a_snapping_lever_is_drawn_running_back():
    snapping = design(values={"flyweight_arm": "120 mm", "flyweight_mass": "0.2 kg"})
    assert "no_snap_travel" in snapping.violated
    frames = synth.curves(synth.load("centrifugal_lever", practice="off"), BASE, snapping)
    speed = frames["over_speed"]["speed [1/min]"].to_numpy()
    assert np.any(np.diff(speed) < -1)
    assert "jumps" in frames["over_speed"].attrs["title"]
    gradual = synth.curves(synth.load("centrifugal_lever", practice="off"), BASE, design())["over_speed"]
    assert np.all(np.diff(gradual["speed [1/min]"].to_numpy()) > -1e-9)
    assert "jumps" not in gradual.attrs["title"]


def test_curves_meet_the_figures_of_the_design():
    found = design()
    frames = synth.curves(synth.load("centrifugal_lever", practice="off"), BASE, found)
    new, worn = frames["over_speed"], frames["over_speed_worn"]
    assert new["clamp force [N]"].max() == pytest.approx(found.values["clamp_force"])
    assert worn["torque [N*m]"].max() == pytest.approx(found.values["worn_torque"])
    touching = new[new["gap [mm]"] <= 1e-9]["speed [1/min]"].min()
    assert touching * math.pi / 30 == pytest.approx(found.values["contact_speed"])
    spans = {span["label"]: span for span in new.attrs["spans"]}
    assert list(spans) == ["rest", "travel", "rod unloads", "spring clamps", "stop"]
    assert spans["stop"]["from"] * math.pi / 30 == pytest.approx(found.values["full_clamp_speed"])
    assert set(synth.curves(synth.load("centrifugal_lever", practice="off"), BASE)) == {"clamp_force_over_lining"}


# -- refusals and remarks --------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("code", "requirements"),
    [
        ("requirement required_torque", {"required_torque": 0}),
        ("requirement contact_travel", {"contact_travel": 0}),
        ("requirement lever_angle_limit", {"lever_angle_limit": 0.4}),
        ("requirement rod_ratio_max", {"rod_ratio_max": 1}),
        ("empty_idle_window", {"idle_speed": "130 rad/s"}),
        ("empty_engagement_window", {"full_torque_speed": "130 rad/s"}),
        ("top_speed_too_low", {"top_speed": "190 rad/s"}),
        ("bad_ratio", {"ring_ratio_min": 0.85}),
        ("stop_angle_out_of_range", {"lever_angle_limit": 0.03}),
        ("travel_unreachable", {"lever_angle_limit": 0.06, "contact_travel": "9 mm"}),
        ("no_room_for_lever", {"hub_radius": "240 mm"}),
        ("envelope_too_small", {"outer_diameter_limit": "70 mm"}),
        ("no_room_for_lining", {"outer_diameter_limit": "40 mm"}),
    ],
)
def test_what_cannot_be_is_refused(code, requirements):
    with pytest.raises(synth.InputError) as caught:
        synth.synthesize(synth.load("centrifugal_lever", practice="off"), BASE | requirements)
    assert str(caught.value).startswith(code), caught.value


def codes(found):
    return " ".join(found.advice)


def test_remarks():
    assert "reconstructed from words" in codes(design())
    assert "drags" not in codes(design())
    assert "drags" in codes(design(values={"friction_surfaces": 8}, requirements={"contact_travel": "2 mm"}))
    assert "ten times gravity" not in codes(design())
    slow = {"idle_speed": "10 rad/s", "contact_speed_max": "40 rad/s"}
    assert "ten times gravity" in codes(design(slow, {"flyweight_mass": "5 kg"}, {"clamp_spring": "CS-2x16x8.5"}))
    assert "stop force is larger" in codes(design())
    assert "stop force is larger" not in codes(design({"top_speed": "210 rad/s"}))
