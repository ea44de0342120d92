"""The family centrifugal_ball_ramp: numbers against sums by hand, limits, refusals, remarks, curves."""

import math

import numpy as np
import pytest
from scipy.optimize import brentq

import synth
from synth.analysis.drawing import drawings_of
from synth.question.catalogs import as_catalogs
from synth.tables.catalogs import Catalogs
from tests.asking import instance_of
from tests.problems.of_a_family import remarks

FAMILY = synth.load("centrifugal_ball_ramp", practice="off")
BASE = {
    "required_torque": "90 N*m",
    "idle_speed": "80 rad/s",
    "contact_speed_min": "95 rad/s",
    "contact_speed_max": "135 rad/s",
    "full_torque_speed": "200 rad/s",
    "top_speed": "500 rad/s",
}
POINT = {
    "rest_radius": "50 mm",
    "plate_gap": "2 mm",
    "spring_preload_deflection": "4 mm",
    "ramp_ratio": 1.2,
    "lining_inner_radius": "50 mm",
    "lining_outer_radius": "65 mm",
    "balls": 10,
    "return_springs": 4,
    "friction_surfaces": 8,
}
PARTS = {"ball": "ball 20", "return_spring": "CS-1.25x6.3x5.5", "friction_pair": "metal_ceramic_bronze_dry"}
ALWAYS = {
    "idle_release",
    "contact_not_too_late",
    "contact_not_too_early",
    "lining_pressure",
    "engagement_heat",
    "ring_ratio_min",
    "ring_ratio_max",
    "clamp_cap",
    "ball_hertz",
    "pitch_circle_room",
    "hub_clearance",
    "ramp_returns",
    "torque_at_full_speed",
    "no_snap",
    "spring_force",
}


def design(requirements=None, values=None, parts=None, **more):
    return synth.evaluate(
        FAMILY, BASE | (requirements or {}), values=POINT | (values or {}), parts=PARTS | (parts or {}), **more
    )


def balance_speed(mass, i, mu, rest, rate, deflection, travel, direction):
    """Speed of balance by bisection, ball friction from the power that slips: no closed form of the project."""
    alpha = math.atan(i)
    spring = rate * (deflection + travel)

    def excess(speed):
        radial = mass * (rest + i * travel) * speed**2
        # Work per metre along the ramp: the balls give, plate and friction at the plate take (or give back).
        return radial * math.sin(alpha) - spring * math.cos(alpha) - direction * mu * spring * (1 + math.sin(alpha))

    return brentq(excess, 1.0, 5000.0, xtol=1e-10)


def by_hand(parts, **own):
    """Return quantities and both sides of the limits in plain floats; sizes are those of POINT."""
    mu_b, torque, k_m = own.get("mu_b", 0.03), own.get("torque", 90.0), 1.2
    ball, spring, pair = parts["ball"], parts["return_spring"], parts["friction_pair"]
    r0, h, delta, i, r_i, r_o, n_b, n_s, z = 0.050, 0.002, 0.004, 1.2, 0.050, 0.065, 10, 4, 8
    volume = 4 / 3 * math.pi * (ball["diameter"] / 2) ** 3
    mass = n_b * ball["density"] * volume
    rate = n_s * spring["rate_R"]
    contact = balance_speed(mass, i, mu_b, r0, rate, delta, h, 1)
    release = balance_speed(mass, i, mu_b, r0, rate, delta, h, -1)
    r1 = r0 + i * h
    c_b = mu_b * (i + math.hypot(1, i))

    def clamp(speed):
        return mass * r1 * speed**2 * i / (1 + c_b) - rate * (delta + h)

    def carried(speed):
        return pair["mu_dynamic"] * z * clamp(speed) * (r_i + r_o) / 2

    sized = brentq(lambda w: carried(w) - k_m * torque, contact, 5000.0)
    pressure = clamp(500.0) / (2 * math.pi * r_i * (r_o - r_i))
    normal = ball["density"] * volume * r1 * 500.0**2 / math.cos(math.atan(i))
    modulus = ball["E"] / (2 * (1 - ball["nu"] ** 2))
    contact_radius = (3 * normal * ball["diameter"] / 2 / (4 * modulus)) ** (1 / 3)
    hertz = 3 * normal / (2 * math.pi * contact_radius**2)
    outside = 2 * max(r_o + 0.003, r1 + ball["diameter"] / 2 + 0.005)
    plates = 7850 * math.pi * (outside**2 / 4 - 0.02**2) * 0.025
    area = z * math.pi * (r_o**2 - r_i**2)
    values = {
        "ramp_angle": math.atan(i),
        "flyweight_mass": mass,
        "contact_speed": contact,
        "release_speed": release,
        "idle_margin": release / 80,
        "engagement_band": sized / contact,
        "full_speed_torque": carried(200.0),
        "clamp_force": clamp(500.0),
        "stop_force": clamp(500.0),
        "lining_pressure": pressure,
        "hertz_pressure": hertz,
        "outer_diameter": outside,
        "mass": plates + mass + n_s * spring["mass"],
        "inertia": plates * (outside**2 / 4 + 0.02**2) / 2 + mass * r1**2 + n_s * spring["mass"] * r0**2,
    }
    room = n_b * (ball["diameter"] + 0.004)
    room += n_s * (spring["mean_diameter_D"] + spring["wire_diameter_d"] + 0.004)
    limits = {
        "idle_release": 1.15 * 80 / release,
        "contact_not_too_late": contact / 135,
        "contact_not_too_early": 95 / contact,
        "lining_pressure": pressure / pair["p_allow"],
        "engagement_heat": 0.5 * 0.5 * 200.0**2 / area / pair["q_single_allow"],
        "ring_ratio_min": 0.55 / (r_i / r_o),
        "ring_ratio_max": (r_i / r_o) / 0.80,
        "clamp_cap": clamp(500.0) / 4500,
        "ball_hertz": hertz / 3.5e9,
        "pitch_circle_room": room / (2 * math.pi * r0),
        "hub_clearance": (0.02 + ball["diameter"] / 2) / r0,
        "ramp_returns": 0.2 / (1 - c_b),
        "torque_at_full_speed": k_m * torque / carried(200.0),
        "no_snap": delta * i / r0,
        "spring_force": spring["rate_R"] * (delta + h) / spring["max_force_Fn"],
    }
    return values, limits


@pytest.mark.parametrize("ball", ["ball 18", "ball 20", "ball 28"])
@pytest.mark.parametrize("pair", ["metal_ceramic_bronze_dry", "aramid_dry"])
@pytest.mark.parametrize("mu_b", [0.0, 0.03, 0.1])
def test_numbers_against_an_independent_calculation(ball, pair, mu_b):
    parts = {"ball": ball, "friction_pair": pair}
    found = design({"ball_friction": mu_b}, parts=parts)
    values, limits = by_hand(found.parts, mu_b=mu_b)
    for name, value in values.items():
        assert found.values[name] == pytest.approx(value, rel=1e-8), name
    assert set(found.utilisation) == ALWAYS == set(limits)
    for name, used in limits.items():
        if found.utilisation[name] is None:
            assert found.parts["friction_pair"]["q_single_allow"] is None
        else:
            assert found.utilisation[name] == pytest.approx(max(used, 0), rel=1e-8), name
    broken = {name for name, used in limits.items() if used > 1 + 1e-6 and found.utilisation[name] is not None}
    assert set(found.violated) == broken


def test_clamp_force_is_that_of_a_plate_in_balance():
    # Torque over speed of the drawn curve meets the closed forms at full and top speed.
    found = design()
    frame = synth.curves(FAMILY, BASE, values=POINT, parts=PARTS)["engaging_over_speed"]
    speed = frame["speed [1/min]"].to_numpy() * math.pi / 30
    at_full = np.interp(200.0, speed, frame["torque [N*m]"])
    assert at_full == pytest.approx(found.values["full_speed_torque"], rel=3e-3)
    assert frame["clamp force [N]"].iloc[-1] == pytest.approx(found.values["clamp_force"], rel=1e-9)


def test_given_heat_replaces_that_of_the_pair():
    found = design({"engagement_heat_limit": "0.5 J/mm2"}, parts={"friction_pair": "aramid_dry"})
    area = 8 * math.pi * (0.065**2 - 0.05**2)
    assert found.utilisation["engagement_heat"] == pytest.approx(10e3 / area / 0.5e6)
    limited = design({"outer_diameter_limit": "120 mm"})
    assert limited.violated.count("outer_diameter") == 1


@pytest.mark.parametrize(
    ("changed", "words"),
    [
        ({"idle_speed": "120 rad/s"}, "empty_idle_window"),
        ({"full_torque_speed": "130 rad/s"}, "empty_engagement_window"),
        ({"top_speed": "199 rad/s"}, "top_speed_too_low"),
        ({"contact_speed_min": "136 rad/s"}, "contact_window_reversed"),
        ({"ring_ratio_min": 0.85}, "bad_ratio"),
        ({"outer_diameter_limit": "45 mm"}, "no_room_for_lining"),
        ({"required_torque": "-1 N*m"}, "required_torque"),
        ({"ball_friction": 0.2}, "ball_friction"),
    ],
)
def test_contradictions_are_refused(changed, words):
    with pytest.raises(synth.InputError, match=words):
        design(changed)


def test_what_the_window_allows_is_the_closed_form():
    # The best margin: contact as late as allowed, the flattest ramp, friction of the balls between the two speeds.
    loss = 0.03 * (0.4 + math.hypot(1, 0.4))
    most = 135 / 80 * math.sqrt((1 - loss) / (1 + loss))
    assert most == pytest.approx(1.61431, abs=1e-5)
    spec = {name: instance_of(FAMILY, BASE, as_catalogs(None)).values.requirements.get(name) for name in BASE}
    assert spec["contact_speed_max"] == pytest.approx(135)
    frame = synth.curves(FAMILY, BASE)["idle_margin_over_ramp"]
    assert frame["ball_friction [-]"].iloc[0] == pytest.approx(most, rel=1e-12)
    assert (frame.diff().dropna()["ball_friction [-]"] < 0).all()
    assert frame["no friction [-]"].to_numpy() == pytest.approx(135 / 80)


def test_remarks():
    plain = remarks(design())
    assert "rests_on_guesses" in plain
    assert "hysteresis" in plain
    assert "hysteresis" not in remarks(design({"ball_friction": 0.0}))
    assert "drags_when_released" in plain  # 2 mm for eight surfaces
    assert "drags_when_released" not in remarks(design(values={"friction_surfaces": 4}))
    light = design(values={"spring_preload_deflection": "1 mm", "return_springs": 2, "balls": 12})
    start = 2 * light.parts["return_spring"]["rate_R"] * 0.001 / (light.values["flyweight_mass"] * 1.2)
    assert ("gravity_at_start" in remarks(light)) == (start / (1 / (1 + 0.03 * (1.2 + math.hypot(1, 1.2)))) < 98.0665)
    assert "bad_ring" in remarks(design(values={"lining_inner_radius": "70 mm"}))
    assert "fast_rim" in remarks(design({"top_speed": "1800 rad/s"}))
    tired = design(values={"plate_gap": "6 mm", "spring_preload_deflection": "1 mm"})
    spring = tired.parts["return_spring"]
    swing = spring["tau_k_n_corrected"] * spring["rate_R"] * 0.003 / spring["max_force_Fn"]
    assert ("return_spring_tires" in remarks(tired)) == (swing > 241e6)
    assert "return_spring_tires" in remarks(
        design(values={"plate_gap": "6 mm"}, parts={"return_spring": "CS-0.5x2.5x3.5"})
    )
    assert "return_spring_bows" in remarks(
        design({"top_speed": "1500 rad/s"}, {"spring_preload_deflection": "1 mm"}, {"return_spring": "CS-2x16x12.5"})
    )


def test_a_snapping_clutch_is_named_and_its_curve_runs_back():
    values = {"spring_preload_deflection": "20 mm", "rest_radius": "30 mm", "ramp_ratio": 2}
    found = design(values=values)
    assert "no_snap" in found.violated
    frames = synth.curves(FAMILY, BASE, values=POINT | values, parts=PARTS)
    for name in ("engaging_over_speed", "releasing_over_speed"):
        speed = frames[name]["speed [1/min]"].to_numpy()
        gap = frames[name]["gap [mm]"].to_numpy()
        moving = (gap > 1e-9) & (gap < 2 - 1e-9)
        assert np.all(np.diff(speed[moving]) < 0)
        assert "jump" in frames[name].attrs["title"]
    gradual = synth.curves(FAMILY, BASE, values=POINT, parts=PARTS)["engaging_over_speed"]
    assert np.all(np.diff(gradual["speed [1/min]"]) >= -1e-9)
    assert "jump" not in gradual.attrs["title"]


def test_curves_pass_through_the_borders_of_the_regimes():
    found = design()
    frames = synth.curves(FAMILY, BASE, values=POINT, parts=PARTS)
    assert set(frames) == {
        "idle_margin_over_ramp",
        "clamp_force_over_lining",
        "engaging_over_speed",
        "releasing_over_speed",
    }
    for name, quantity in (("engaging_over_speed", "contact_speed"), ("releasing_over_speed", "release_speed")):
        frame, speed = frames[name], found.values[quantity] * 30 / math.pi
        spans = {s["label"]: s for s in frame.attrs["spans"]}
        assert spans["travelling"]["to"] == pytest.approx(speed, rel=1e-9)
        assert spans["clamping"]["from"] == pytest.approx(speed, rel=1e-9)
        below, above = frame[frame["speed [1/min]"] < speed * 0.9999], frame[frame["speed [1/min]"] > speed * 1.0001]
        assert (below["clamp force [N]"] == 0).all()
        assert (above["clamp force [N]"] > 0).all()
        assert (above["gap [mm]"] == 0).all()
    force = frames["clamp_force_over_lining"]
    arm = 0.42 * 57.5
    needed = np.interp(arm, force.iloc[:, 0], force["8 surfaces [N]"])
    assert needed == pytest.approx(108 / (8 * arm * 1e-3), rel=1e-3)


@pytest.mark.parametrize("lacking", ["free_length_L0", "total_coils_nt"])
def test_springs_of_a_table_without_what_only_the_drawing_shows_are_designed_but_not_drawn(lacking):
    own = Catalogs().table("compression_springs").to_frame()
    own = own.drop(columns=[column for column in own.columns if column.split(" ")[0] == lacking])
    tables = {"compression_springs": own}
    found = design(catalogs=tables)
    assert found.values["mass"] == design().values["mass"]
    drawn, told = drawings_of(FAMILY, [found])
    assert not drawn
    assert "a number, which the drawing shows" in told[0]
    assert lacking in told[0] or "length" in told[0]
    with pytest.raises(synth.InputError, match="column mass"):
        design(catalogs={"compression_springs": own.drop(columns=["mass [kg]"])})
