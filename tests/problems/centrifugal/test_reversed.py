"""The family centrifugal_reversed: a whole design recomputed by hand, limits, refusals, remarks, curves."""

import math

import numpy as np
import pytest

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
    "flyweight_mass": "1.12 kg",
    "flyweight_arm": "40 mm",
    "rest_radius": "50 mm",
    "spring_preload_deflection": "16 mm",
    "lever_stop_angle": "0.34 rad",
    "plate_arm": "12 mm",
    "return_preload_deflection": "6 mm",
    "lining_inner_radius": "60 mm",
    "lining_outer_radius": "76 mm",
    "weights": 4,
    "clamp_springs": 6,
    "return_springs": 6,
    "friction_surfaces": 2,
}
PARTS = {"clamp_spring": "CS-5x25x5.5", "return_spring": "CS-3.2x16x3.5", "friction_pair": "moulded_dry"}
ALWAYS = {
    "lever_angle",
    "ring_ratio_min",
    "ring_ratio_max",
    "engagement_heat",
    "stop_after_contact",
    "clamp_springs_loaded",
    "idle_release",
    "contact_not_too_late",
    "torque_worn",
    "full_clamp_speed",
    "lining_pressure",
    "no_snap_travel",
    "no_snap_clamp",
    "preload_order",
    "spring_force",
    "return_spring_force",
    "weight_clear_of_hub",
}


def design(requirements=None, values=None, parts=None):
    return synth.evaluate(
        synth.load("centrifugal_reversed", practice="off"),
        BASE | (requirements or {}),
        values=POINT | (values or {}),
        parts=PARTS | (parts or {}),
    )


def by_hand(main, back, pair):
    """The reference in plain floats: sections 3.4 and 6 for the sizes of POINT."""
    m, l_c, r0, delta, phi, l_p, delta_r = 1.12, 0.040, 0.050, 0.016, 0.34, 0.012, 0.006
    r_i, r_o, n_w, n_s, n_r, z = 0.060, 0.076, 4, 6, 6, 2
    x0, wear, mu = 0.003, 0.0006, pair["mu_dynamic"]
    s, s_ret = n_s * main["rate_R"], n_r * back["rate_R"]
    phi1 = x0 / l_p
    f_r0, f_ret0 = s * delta, s_ret * delta_r
    f_ret1 = f_ret0 + s_ret * x0
    p_max = f_r0 + s * (l_p * phi - x0)
    r1, r2 = r0 + l_c * phi1, r0 + l_c * phi
    speeds = [
        math.sqrt(force * l_p / (l_c * m * radius))
        for force, radius in ((f_ret0, r0), (f_ret1, r1), (f_r0, r1), (p_max, r2))
    ]
    _, contact, _, stop = speeds
    clamp = p_max - f_ret1
    t_w = math.sqrt(m / (n_w * 7850 * 0.030))
    diameter = 2 * max(r_o + 0.003, r2 + t_w / 2 + 0.005)
    disc = 7850 * math.pi * (diameter**2 / 4 - 0.020**2) * 0.025
    springs = n_s * main["mass"] + n_r * back["mass"]
    worn = mu * z * (r_i + r_o) / 2 * (clamp - (s + s_ret) * wear)
    pressure = clamp / (2 * math.pi * r_i * (r_o - r_i))
    values = {
        "weight_thickness": t_w,
        "clamp_force": clamp,
        "contact_speed": contact,
        "release_speed": contact,
        "full_clamp_speed": stop,
        "idle_margin": contact / 80,
        "engagement_band": stop / contact,
        "worn_torque": worn,
        "lining_pressure": pressure,
        "stop_force": m * r2 * 500**2 - p_max * l_p / l_c,
        "outer_diameter": diameter,
        "mass": disc + m + springs,
        "inertia": disc * (diameter**2 / 4 + 0.020**2) / 2 + m * r2**2 + springs * r0**2,
    }
    limits = {
        "lever_angle": (phi, 0.35),
        "ring_ratio_min": (r_i / r_o, 0.55),
        "ring_ratio_max": (r_i / r_o, 0.80),
        "engagement_heat": (0.25 * 200**2 / (z * math.pi * (r_o**2 - r_i**2)), pair["q_single_allow"]),
        "stop_after_contact": ((x0 + wear) / l_p, phi),
        "clamp_springs_loaded": (delta + l_p * phi, x0),
        "idle_release": (contact, 1.15 * 80),
        "contact_not_too_late": (contact, 135),
        "torque_worn": (worn, 1.2 * 90),
        "full_clamp_speed": (stop, 200),
        "lining_pressure": (pressure, pair["p_allow"]),
        "no_snap_travel": (delta_r * l_c / l_p, r0),
        "no_snap_clamp": ((delta - x0) * l_c / l_p, r0),
        "preload_order": (f_ret1, f_r0),
        "spring_force": (main["rate_R"] * (delta + l_p * phi - x0), main["max_force_Fn"]),
        "return_spring_force": (back["rate_R"] * (delta_r + x0), back["max_force_Fn"]),
        "weight_clear_of_hub": (0.020 + t_w / 2 + l_p, r0),
    }
    return values, limits, speeds


def test_a_whole_design_against_an_independent_calculation():
    found = design()
    rows = (found.parts[slot] for slot in ("clamp_spring", "return_spring", "friction_pair"))
    values, limits, speeds = by_hand(*rows)
    for name, value in values.items():
        assert found.values[name] == pytest.approx(value, rel=1e-12), name
    assert set(found.limits) == ALWAYS == set(limits)
    for name, sides in limits.items():
        assert found.limits[name] == pytest.approx(sides, rel=1e-12), name
    assert found.violated == ()
    spans = synth.curves(synth.load("centrifugal_reversed", practice="off"), BASE, found)["over_speed"].attrs["spans"]
    assert [span["to"] * math.pi / 30 for span in spans[:4]] == pytest.approx(speeds)


def test_limits_are_built_when_they_are_asked_for():
    assert set(design(OPTIONAL).limits) == ALWAYS | {"outer_diameter"}


@pytest.mark.parametrize(
    ("changed", "violated"),
    [
        ({"return_preload_deflection": "20 mm"}, {"no_snap_travel", "return_spring_force", "contact_not_too_late"}),
        ({"spring_preload_deflection": "2 mm"}, {"preload_order", "torque_worn"}),
        ({"lever_stop_angle": "0.29 rad"}, {"stop_after_contact"}),
        ({"return_preload_deflection": "0.5 mm"}, {"idle_release"}),
        ({"flyweight_arm": "60 mm"}, {"no_snap_clamp"}),
        ({"rest_radius": "45 mm"}, {"weight_clear_of_hub"}),
        ({"spring_preload_deflection": "20 mm"}, {"spring_force"}),
        ({"flyweight_mass": "0.8 kg"}, {"contact_not_too_late"}),
        ({"plate_arm": "150 mm"}, {"full_clamp_speed"}),
    ],
)
def test_what_breaks_a_design_is_named(changed, violated):
    assert violated <= set(design(values=changed).violated)


def test_without_a_clamp_force_there_are_no_speeds():
    changed = design(values={"spring_preload_deflection": "1 mm", "lever_stop_angle": "0.05 rad"})
    assert {"clamp_springs_loaded", "stop_after_contact"} <= set(changed.violated)
    assert math.isnan(changed.values["full_clamp_speed"])
    assert math.isnan(changed.values["engagement_band"])


def test_most_of_the_clamp_force_comes_at_one_angle():
    """The sharpest of all types: disc 1 lifts only for the rest of the force."""
    frame = synth.curves(synth.load("centrifugal_reversed", practice="off"), BASE, design())["over_speed"]
    still = frame[frame["lift of disc 1 [mm]"] <= 1e-9]["clamp force [N]"].max()
    assert still > 0.85 * frame["clamp force [N]"].max()
    assert np.all(np.diff(frame["speed [1/min]"].to_numpy()) > -1e-9)


def test_curves_meet_the_figures_of_the_design():
    found = design()
    frames = synth.curves(synth.load("centrifugal_reversed", practice="off"), BASE, found)
    new, worn = frames["over_speed"], frames["over_speed_worn"]
    assert new["clamp force [N]"].max() == pytest.approx(found.values["clamp_force"])
    assert worn["torque [N*m]"].max() == pytest.approx(found.values["worn_torque"])
    touching = new[new["gap [mm]"] <= 1e-9]["speed [1/min]"].min()
    assert touching * math.pi / 30 == pytest.approx(found.values["contact_speed"])
    assert new["lift of disc 1 [mm]"].max() == pytest.approx(12 * 0.34 - 3)
    top = new.iloc[-1]
    stop = found.values["stop_force"]
    pull = stop + new["centrifugal force [N]"].iloc[-1] - top["stop force [N]"]
    assert pull == pytest.approx(1.12 * (0.05 + 0.04 * 0.34) * 500**2)
    assert set(synth.curves(synth.load("centrifugal_reversed", practice="off"), BASE)) == {"clamp_force_over_lining"}


def test_a_snapping_lever_is_drawn_running_back():
    frames = synth.curves(
        synth.load("centrifugal_reversed", practice="off"), BASE, design(values={"flyweight_arm": "90 mm"})
    )
    assert "jumps" in frames["over_speed"].attrs["title"]


# -- refusals and remarks --------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("code", "requirements"),
    [
        ("requirement lining_wear", {"lining_wear": "-1 mm"}),
        ("empty_idle_window", {"idle_speed": "130 rad/s"}),
        ("stop_angle_out_of_range", {"lever_angle_limit": 0.03}),
        ("travel_unreachable", {"lever_angle_limit": 0.06, "contact_travel": "9 mm"}),
        ("no_room_for_lever", {"hub_radius": "240 mm"}),
        ("envelope_too_small", {"outer_diameter_limit": "66 mm"}),
    ],
)
def test_what_cannot_be_is_refused(code, requirements):
    with pytest.raises(synth.InputError) as caught:
        synth.synthesize(synth.load("centrifugal_reversed", practice="off"), BASE | requirements)
    assert str(caught.value).startswith(code), caught.value


def test_remarks():
    told = " ".join(design().advice)
    assert "reconstructed from words" in told
    assert "stop force is larger" in told
    assert "return springs tire" in " ".join(
        design(values={"return_preload_deflection": "4 mm"}, requirements={"contact_travel": "6 mm"}).advice
    )
