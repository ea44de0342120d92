"""The family centrifugal_two_spring: numbers against sums by hand, limits, refusals, curves; balls and levers."""

import math

import numpy as np
import pytest
from scipy.optimize import brentq

import synth
from tests.problems.of_a_family import remarks

FAMILY = "centrifugal_two_spring"
BASE = {
    "required_torque": "90 N*m",
    "idle_speed": "80 rad/s",
    "contact_speed_min": "95 rad/s",
    "contact_speed_max": "135 rad/s",
    "full_torque_speed": "200 rad/s",
    "top_speed": "500 rad/s",
}
COMMON_POINT = {
    "rest_radius": "40 mm",
    "plate_travel": "1.5 mm",
    "stop_travel": "9 mm",
    "return_preload_deflection": "4 mm",
    "clamp_preload_deflection": "1.3 mm",
    "lining_inner_radius": "48 mm",
    "lining_outer_radius": "62 mm",
    "return_springs": 2,
    "clamp_springs": 3,
    "friction_surfaces": 8,
}
POINTS = {
    "ball_ramp": COMMON_POINT | {"ramp_ratio": 1.2, "balls": 5},
    "lever": COMMON_POINT | {"flyweight_mass": "0.4 kg", "flyweight_arm": "36 mm", "axial_arm": "30 mm", "weights": 3},
}
SPRINGS = {
    "return_spring": "CS-1.25x6.3x5.5",
    "clamp_spring": "CS-2.5x12.5x5.5",
    "friction_pair": "metal_ceramic_bronze_dry",
}
PARTS = {"ball_ramp": SPRINGS | {"ball": "ball 25"}, "lever": SPRINGS}
ALWAYS = {
    "idle_release",
    "contact_not_too_late",
    "contact_not_too_early",
    "lining_pressure",
    "engagement_heat",
    "ring_ratio_min",
    "ring_ratio_max",
    "clamp_cap",
    "pitch_circle_room",
    "torque_worn",
    "full_clamp_speed",
    "preload_order",
    "stop_after_contact",
    "no_snap_tension",
    "no_snap_plate",
    "no_snap_clamp",
    "spring1_force",
    "spring2_force",
}
OWN = {"ball_ramp": {"ball_hertz", "hub_clearance", "ramp_returns"}, "lever": {"weight_clear_of_hub", "lever_angle"}}
MECHANISMS = ("ball_ramp", "lever")


def design(mechanism="ball_ramp", requirements=None, values=None, parts=None):
    return synth.evaluate(
        synth.load(FAMILY, practice="off", mechanism=mechanism),
        BASE | (requirements or {}),
        values=POINTS[mechanism] | (values or {}),
        parts=PARTS[mechanism] | (parts or {}),
    )


def by_hand(mechanism, parts, loss=0.03):
    """Return quantities and utilisations in plain floats; ``loss`` is the friction of the balls or of the levers."""
    r0, a, b, delta1, delta2, r_i, r_o, n1, n2, z = 0.040, 1.5e-3, 9e-3, 4e-3, 1.3e-3, 0.048, 0.062, 2, 3, 8
    first, second, pair = parts["return_spring"], parts["clamp_spring"], parts["friction_pair"]
    s1, s2 = n1 * first["rate_R"], n2 * second["rate_R"]
    i = 1.2
    alpha = math.atan(i)
    if mechanism == "ball_ramp":
        ball = parts["ball"]
        one = ball["density"] * 4 / 3 * math.pi * (ball["diameter"] / 2) ** 3
        mass, half = 5 * one, ball["diameter"] / 2
    else:
        mass, half = 0.4, math.sqrt(0.4 / (3 * 7850 * 0.03)) / 2

    def speed(force, travel, direction=1):
        """Bisection of a power balance per metre of the balls' way, or of the levers' work."""

        def excess(w):
            pull = mass * (r0 + i * travel) * w**2
            if mechanism == "ball_ramp":
                lost = direction * loss * force * (1 + math.sin(alpha))
                return pull * math.sin(alpha) - force * math.cos(alpha) - lost
            return pull * i * (1 - loss) ** direction - force

        return brentq(excess, 1.0, 5000.0, xtol=1e-11)

    f10, f20 = s1 * delta1, s2 * delta2
    fa, fb = s1 * (delta1 + a), s2 * (delta2 + b - a)
    x_p, x_c = (f10 - f20) / s2, a + (fa - f20) / s2
    contact, release, full = speed(fa, x_c), speed(fa, x_c, -1), speed(fb, b)
    worn = fb - s2 * 0.6e-3 - (fa + s1 * 0.6e-3)
    worn_contact = a + 0.6e-3 + (fa + s1 * 0.6e-3 - f20) / s2
    clamp = fb - fa
    end = r0 + i * b
    share = 1 / (1 + loss * (i + math.hypot(1, i))) if mechanism == "ball_ramp" else 1 - loss
    stop = max(mass * end * 500.0**2 * i * share - fb, 0.0)
    outside = 2 * max(r_o + 0.003, end + half + 0.005)
    plates = 7850 * math.pi * (outside**2 / 4 - 0.02**2) * 0.025
    springs = n1 * first["mass"] + n2 * second["mass"]
    torque = pair["mu_dynamic"] * z * worn * (r_i + r_o) / 2
    values = {
        "flyweight_mass": mass,
        "contact_speed": contact,
        "release_speed": release,
        "idle_margin": release / 80,
        "engagement_band": full / contact,
        "full_clamp_speed": full,
        "worn_torque": torque,
        "clamp_force": clamp,
        "lining_pressure": clamp / (2 * math.pi * r_i * (r_o - r_i)),
        "stop_force": stop,
        "outer_diameter": outside,
        "mass": plates + mass + springs,
        "inertia": plates * (outside**2 / 4 + 0.02**2) / 2 + mass * end**2 + springs * r0**2,
    }
    room = n1 * (first["mean_diameter_D"] + first["wire_diameter_d"] + 0.004)
    room += n2 * (second["mean_diameter_D"] + second["wire_diameter_d"] + 0.004)
    used = {
        "idle_release": 92 / release,
        "contact_not_too_late": contact / 135,
        "contact_not_too_early": 95 / contact,
        "lining_pressure": values["lining_pressure"] / pair["p_allow"],
        "engagement_heat": 10e3 / (z * math.pi * (r_o**2 - r_i**2)) / pair["q_single_allow"],
        "ring_ratio_min": 0.55 * r_o / r_i,
        "ring_ratio_max": r_i / r_o / 0.8,
        "clamp_cap": clamp / 4500,
        "torque_worn": 108 / torque,
        "full_clamp_speed": full / 200,
        "preload_order": f20 / f10,
        "stop_after_contact": worn_contact / b,
        "no_snap_tension": speed(f20, 0.0) / speed(f10, x_p),
        "no_snap_plate": speed(f10, x_p) / contact,
        "no_snap_clamp": contact / full,
        "spring1_force": first["rate_R"] * (delta1 + a) / first["max_force_Fn"],
        "spring2_force": second["rate_R"] * (delta2 + b - a) / second["max_force_Fn"],
    }
    if mechanism == "ball_ramp":
        room += 5 * (ball["diameter"] + 0.004)
        normal = one * end * 500.0**2 / math.cos(alpha)
        modulus = ball["E"] / (2 * (1 - ball["nu"] ** 2))
        area = math.pi * (3 * normal * ball["diameter"] / (8 * modulus)) ** (2 / 3)
        values |= {"hertz_pressure": 1.5 * normal / area, "ramp_angle": alpha}
        used |= {
            "ball_hertz": values["hertz_pressure"] / 3.5e9,
            "hub_clearance": (0.02 + half) / r0,
            "ramp_returns": 0.2 / (1 - loss * (i + math.hypot(1, i))),
        }
    else:
        values |= {"lever_ratio": i, "weight_thickness": 2 * half}
        used |= {"weight_clear_of_hub": (0.02 + half) / r0, "lever_angle": b / 0.03 / 0.35}
    used["pitch_circle_room"] = room / (2 * math.pi * r0)
    return values, used


@pytest.mark.parametrize("pair", ["metal_ceramic_bronze_dry", "sinter_iron_dry"])
@pytest.mark.parametrize(
    ("mechanism", "losses", "loss"),
    [
        ("ball_ramp", {}, 0.03),
        ("ball_ramp", {"ball_friction": 0.0}, 0.0),
        ("ball_ramp", {"ball_friction": 0.1}, 0.1),
        ("lever", {}, 0.05),
        ("lever", {"mechanism_efficiency": 0.8}, 0.2),
    ],
)
def test_numbers_against_an_independent_calculation(mechanism, losses, loss, pair):
    found = design(mechanism, losses, parts={"friction_pair": pair})
    values, used = by_hand(mechanism, found.parts, loss)
    for name, value in values.items():
        assert found.values[name] == pytest.approx(value, rel=1e-8), name
    assert set(found.utilisation) == ALWAYS | OWN[mechanism] == set(used)
    checked = {name for name, share in found.utilisation.items() if share is not None}
    for name in checked:
        assert found.utilisation[name] == pytest.approx(used[name], rel=1e-8), name
    assert set(found.violated) == {name for name in checked if used[name] > 1 + 1e-6}


@pytest.mark.parametrize("mechanism", MECHANISMS)
def test_the_clamp_force_is_capped(mechanism):
    found = design(mechanism)
    problem = synth.load(FAMILY, practice="off", mechanism=mechanism)
    frames = synth.curves(problem, BASE, values=POINTS[mechanism], parts=PARTS[mechanism])
    kept = {"clamp_force_over_lining", "engaging_over_speed", "releasing_over_speed"}
    assert set(frames) == kept | ({"idle_margin_over_ramp"} if mechanism == "ball_ramp" else set())
    for name, touch in (("engaging_over_speed", "contact_speed"), ("releasing_over_speed", "release_speed")):
        frame = frames[name]
        speed, clamp = frame["speed [1/min]"].to_numpy() * math.pi / 30, frame["clamp force [N]"].to_numpy()
        assert np.all(np.diff(speed) >= -1e-9)
        assert np.all(np.diff(clamp) >= -1e-9)
        assert clamp[-1] == pytest.approx(found.values["clamp_force"], rel=1e-9)
        assert np.all(clamp[speed < found.values[touch] * 0.9999] == 0)
        assert np.all(clamp[speed > found.values[touch] * 1.0001] > 0)
        assert np.all(frame["plate gap [mm]"][speed > found.values[touch] * 1.0001] == 0)
        spans = {s["label"]: s for s in frame.attrs["spans"]}
        assert list(spans) == ["at rest", "tension disc", "both", "clamping", "at the stop"]
        assert spans["clamping"]["from"] * math.pi / 30 == pytest.approx(found.values[touch], rel=1e-9)
    engaging = frames["engaging_over_speed"]
    assert engaging["stop force [N]"].iloc[-1] == pytest.approx(found.values["stop_force"], rel=1e-9)
    at_stop = next(s for s in engaging.attrs["spans"] if s["label"] == "at the stop")
    assert at_stop["from"] * math.pi / 30 == pytest.approx(found.values["full_clamp_speed"], rel=1e-9)
    # Plate and disc through one force until contact: both springs feel the same in the regime "both".
    both = next(s for s in engaging.attrs["spans"] if s["label"] == "both")
    inside = engaging[(engaging["speed [1/min]"] > both["from"]) & (engaging["speed [1/min]"] < both["to"])]
    assert inside["return spring force [N]"].to_numpy() == pytest.approx(inside["clamp spring force [N]"].to_numpy())


def test_limits_that_keep_the_order_of_the_regimes():
    assert "preload_order" in design(values={"clamp_preload_deflection": "6 mm"}).violated
    assert "stop_after_contact" in design(values={"stop_travel": "2.5 mm"}).violated
    # A stop before contact: no clamp force is left, and the torque is below zero.
    early = design(values={"stop_travel": "1.6 mm"})
    assert early.values["clamp_force"] < 0
    assert {"torque_worn", "no_snap_clamp", "stop_after_contact"} <= set(early.violated)
    snap = design(values={"rest_radius": "30 mm", "ramp_ratio": 2, "return_preload_deflection": "20 mm"})
    assert "no_snap_plate" in snap.violated
    frames = synth.curves(
        synth.load(FAMILY, practice="off"),
        BASE,
        parts=PARTS["ball_ramp"],
        values=POINTS["ball_ramp"] | {"rest_radius": "30 mm", "ramp_ratio": 2, "return_preload_deflection": "20 mm"},
    )
    assert "jump" in frames["engaging_over_speed"].attrs["title"]


@pytest.mark.parametrize("mechanism", MECHANISMS)
@pytest.mark.parametrize(
    ("changed", "words"),
    [
        ({"idle_speed": "120 rad/s"}, "empty_idle_window"),
        ({"full_torque_speed": "130 rad/s"}, "empty_engagement_window"),
        ({"top_speed": "199 rad/s"}, "top_speed_too_low"),
        ({"contact_speed_min": "136 rad/s"}, "contact_window_reversed"),
        ({"lining_wear": "-1 mm"}, "lining_wear"),
    ],
)
def test_contradictions_are_refused(mechanism, changed, words):
    with pytest.raises(synth.InputError, match=words):
        design(mechanism, changed)


def test_each_mechanism_has_requirements_of_its_own():
    with pytest.raises(synth.InputError, match="ball_friction"):
        design("lever", {"ball_friction": 0.05})
    with pytest.raises(synth.InputError, match="mechanism_efficiency"):
        design("ball_ramp", {"mechanism_efficiency": 0.9})
    with pytest.raises(synth.InputError, match="mechanism"):
        synth.describe(synth.load(FAMILY, practice="off", mechanism="rods"))


def test_remarks():
    balls, levers = remarks(design()), remarks(design("lever"))
    assert {"rests_on_guesses", "hysteresis", "stop_bears_more_than_lining", "drags_when_released"} <= balls
    assert "levers_reconstructed" in levers
    assert "rests_on_guesses" not in levers
    assert "drags_when_released" not in remarks(design(values={"plate_travel": "2.5 mm"}))
    slow = {"top_speed": "200.1 rad/s"}
    assert "stop_bears_more_than_lining" not in remarks(design("lever", slow))
    assert "gravity_at_start" in remarks(design(values={"clamp_preload_deflection": "0.5 mm", "balls": 12}))
    assert "clamp_spring_bows" in remarks(
        design("lever", {"top_speed": "2500 rad/s"}, parts={"clamp_spring": "CS-2x16x12.5"})
    )


def test_practice_2_through_the_family():
    # Levers of one link at 45 degrees (i = 1), F10 = 200 N, s1 = 20 N/mm, s2 = 80 N/mm, gaps 10 and 20 mm.
    found = design(
        "lever",
        {"mechanism_efficiency": 1, "lining_wear": "0 mm"},
        {
            "plate_travel": "10 mm",
            "stop_travel": "20 mm",
            "flyweight_arm": "60 mm",
            "axial_arm": "60 mm",
            "return_preload_deflection": "10 mm",
            "clamp_preload_deflection": "0.5 mm",
        },
    )
    rate1 = 2 * found.parts["return_spring"]["rate_R"]
    rate2 = 3 * found.parts["clamp_spring"]["rate_R"]
    fa, fb = rate1 * 0.020, rate2 * 0.0105
    assert found.values["clamp_force"] == pytest.approx(fb - fa)
    end = 0.04 + 0.02
    assert found.values["full_clamp_speed"] == pytest.approx(math.sqrt(fb / (0.4 * end)))
    assert found.values["stop_force"] == pytest.approx(0.4 * end * 500**2 - fb)
