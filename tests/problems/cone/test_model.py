"""The family cone_clutch: its numbers against an independent calculation, its limits, refusals, remarks and curves."""

import math

import numpy as np
import pytest

import synth
from synth.question.catalogs import as_catalogs
from tests.asking import instance_of
from tests.problems.of_a_family import requirements_in_si
from tests.problems.start_by_steps import start

BASE = {"load_torque": "200 N*m", "driver_speed": "700 rpm", "driven_inertia": "2 kg*m2"}
OPTIONAL = {
    "startup_torque": "340 N*m",
    "overload_torque": "1200 N*m",
    "actuation_force_limit": "20 kN",
    "outer_diameter_limit": "450 mm",
    "length_limit": "120 mm",
    "jerk_limit": "3000 rad/s3",
    "acceleration_limit": "150 rad/s2",
    "bearing_force_limit": "9 kN",
}
POINT = {
    "mean_diameter": "300 mm",
    "generator_length": "50 mm",
    "cone_half_angle": "23 deg",
    "shell_thickness": "6 mm",
    "actuation_force": "6000 N",
    "ramp_time": "0.3 s",
}
PARTS = {"friction_pair": "moulded_dry", "cone_layout": "outer_spring"}

ALWAYS = {
    "torque_capacity",
    "never_starts",
    "surface_pressure",
    "seated_pressure",
    "self_locking",
    "specific_heat",
    "engagement_heat",
    "specific_power",
    "shell_temperature_rise",
    "ring_ratio_min",
    "ring_ratio_max",
    "slip_time",
    "cycle_time",
    "sliding_speed",
}
ASKED = {
    "startup_torque_available": "startup_torque",
    "torque_limit": "overload_torque",
    "actuation_force": "actuation_force_limit",
    "outer_diameter": "outer_diameter_limit",
    "length": "length_limit",
    "jerk": "jerk_limit",
    "acceleration": "acceleration_limit",
    "bearing_axial": "bearing_force_limit",
}


def design(options=None, requirements=None, values=None, parts=None):
    problem = synth.load("cone_clutch", practice="off", **(options or {}))
    return synth.evaluate(
        problem, BASE | (requirements or {}), values=POINT | (values or {}), parts=PARTS | (parts or {})
    )


def by_hand(pair, mean, length, angle, shell, force, ramp, *, kind="reactive", worst=False, limited=None, closed=False):
    """From the equilibrium of the cone, slice by slice along the generator."""
    low, high = (pair["mu_min"], pair["mu_max"]) if worst else (pair["mu_dynamic"],) * 2
    slices = 4000
    place = (np.arange(slices) + 0.5) / slices * length - length / 2
    radius = mean / 2 + place * math.sin(angle)
    strips = 2 * math.pi * radius * length / slices
    area, moment = strips.sum(), (strips * radius).sum()

    def engaged(mu):
        return force / (math.sin(angle) + mu * math.cos(angle)) / area

    omega = 700 / 60 * 2 * math.pi
    built = {mu: mu * engaged(mu) * moment for mu in (low, high)}
    seated = force / math.sin(angle) / area
    widest = mean / 2 + length / 2 * math.sin(angle)
    factor, add = (1.35, 0.045) if closed else (1.0, 0.03)
    steel = 7850 * area * shell
    result = {
        "ring_ratio": length / mean,
        "friction_area": area,
        "torque": built[low],
        "surface_pressure": engaged(low),
        "seated_pressure": seated,
        "seated_torque": high * seated * moment,
        "release_force": engaged(high) * area * (math.sin(angle) - high * math.cos(angle)),
        "bearing_force": 0.0 if closed else force,
        "sliding_speed": omega * widest,
        "mass": factor * (2 * steel + pair["density"] * area * pair["lining_thickness"]),
        "outer_diameter": 2 * (widest + shell + pair["lining_thickness"]),
        "length": length * math.cos(angle) + add,
    }
    result["volume"] = math.pi / 4 * result["outer_diameter"] ** 2 * result["length"]
    ramps = {mu: limited or torque for mu, torque in built.items()}
    work, slip, _, _ = start(ramps[low], 200.0, 2.0, omega, ramp, kind)
    _, _, power, at_lock = start(ramps[high], 200.0, 2.0, omega, ramp, kind)
    result |= {"friction_work": work, "slip_time": slip, "peak_slip_power": power, "ramp_torque": ramps[low]}
    result["jerk"] = ramps[high] / ramp / 2.0
    result["acceleration"] = (at_lock - 200) / 2.0
    result["hourly_heat"] = work * 50 / 3600 / area
    result["single_heat"] = work / area
    result["power_density"] = power / area
    result["temperature_rise"] = 0.5 * work / (steel * 480)
    return result


STEPPED = {
    "friction_work",
    "slip_time",
    "peak_slip_power",
    "acceleration",
    "hourly_heat",
    "single_heat",
    "power_density",
    "temperature_rise",
}


@pytest.mark.parametrize(
    ("options", "values", "parts", "how"),
    [
        ({}, {}, {}, {}),
        ({}, {"cone_half_angle": "12 deg"}, {"friction_pair": "leather_greased"}, {}),
        ({}, {}, {"cone_layout": "inner_cone"}, {"closed": True}),
        ({"load_kind": "active"}, {}, {}, {"kind": "active"}),
        ({"friction_basis": "worst_case"}, {"actuation_force": "9000 N"}, {}, {"worst": True}),
        ({}, {"ramp_time": "3 s"}, {}, {}),
    ],
)
@pytest.mark.parametrize("limited", [None, 340.0])
def test_numbers_against_an_independent_calculation(options, values, parts, how, limited):
    found = design(options, {"startup_torque": "340 N*m"} if limited else None, values, parts)
    si = found.values
    expected = by_hand(
        found.parts["friction_pair"],
        si["mean_diameter"],
        si["generator_length"],
        si["cone_half_angle"],
        si["shell_thickness"],
        si["actuation_force"],
        si["ramp_time"],
        limited=limited,
        **how,
    )
    for name, value in expected.items():
        assert found.values[name] == pytest.approx(value, rel=3e-5 if name in STEPPED else 1e-8), name


@pytest.mark.slow
def test_limits_are_built_when_they_are_asked_for():
    assert set(design().limits) == ALWAYS
    for limit, requirement in ASKED.items():
        assert set(design(requirements={requirement: OPTIONAL[requirement]}).limits) == ALWAYS | {limit}
    assert set(design(requirements=OPTIONAL).limits) == ALWAYS | set(ASKED)


@pytest.mark.parametrize("worst", [False, True])
def test_sides_of_the_limits(worst):
    found = design({"friction_basis": "worst_case"} if worst else {}, OPTIONAL)
    v, pair = found.values, found.parts["friction_pair"]
    static = max(pair["mu_static"], pair["mu_max"]) if worst else pair["mu_static"]
    assert not worst or pair["mu_max"] > pair["mu_static"]
    expected = {
        "torque_capacity": (v["torque"], 300 / 0.85),
        "startup_torque_available": (v["torque"], 340),
        "never_starts": (340, 200),
        "torque_limit": (v["seated_torque"], 1200),
        "surface_pressure": (v["surface_pressure"], pair["p_allow"]),
        "seated_pressure": (v["seated_pressure"], 2.5 * pair["p_allow"]),
        "self_locking": (math.tan(math.radians(23)), 1.05 * static),
        "specific_heat": (v["hourly_heat"], pair["q_hourly_allow"]),
        "engagement_heat": (v["single_heat"], pair["q_single_allow"]),
        "specific_power": (v["power_density"], pair["power_density_allow"]),
        "shell_temperature_rise": (v["temperature_rise"], 100),
        "ring_ratio_min": (50 / 300, 0.15),
        "ring_ratio_max": (50 / 300, 0.20),
        "slip_time": (v["slip_time"], 4),
        "cycle_time": (v["slip_time"], 72),
        "sliding_speed": (v["sliding_speed"], pair["v_allow"]),
        "actuation_force": (6000, 20000),
        "bearing_axial": (6000, 9000),
        "outer_diameter": (v["outer_diameter"], 0.45),
        "length": (v["length"], 0.12),
        "jerk": (v["jerk"], 3000),
        "acceleration": (v["acceleration"], 150),
    }
    assert set(found.limits) == set(expected)
    for name, sides in expected.items():
        assert found.limits[name] == pytest.approx(sides, rel=1e-9), name


def test_hourly_heat_of_forced_oil_counts_where_it_is_given():
    wet = {"friction_pair": "ci_steel_wet"}
    found = design({"cooling": "through_oil"}, parts=wet)
    pair = found.parts["friction_pair"]
    assert found.limits["specific_heat"][1] == pytest.approx(pair["q_hourly_allow_forced_oil"])
    assert design(parts=wet).limits["specific_heat"][1] == pytest.approx(pair["q_hourly_allow"])
    dry = design({"cooling": "through_oil"})
    assert dry.limits["specific_heat"][1] == pytest.approx(dry.parts["friction_pair"]["q_hourly_allow"])


def test_an_inner_cone_spares_the_bearings():
    outer, inner = (design(parts={"cone_layout": layout}) for layout in ("outer_spring", "inner_cone"))
    limit = {"bearing_force_limit": "1 N"}
    assert "bearing_axial" in design(requirements=limit).violated
    assert "bearing_axial" not in design(requirements=limit, parts={"cone_layout": "inner_cone"}).violated
    assert inner.values["mass"] == pytest.approx(1.35 * outer.values["mass"])
    assert inner.values["torque"] == outer.values["torque"]


@pytest.mark.parametrize(
    ("requirements", "code"),
    [
        ({"startup_torque": "200 N*m"}, "never_starts"),
        ({"overload_torque": "352 N*m"}, "capacity_window_empty"),
        ({"ring_ratio_min": 0.25}, "bad_ratio"),
        ({"driver_speed": 0}, "driver_speed"),
        ({"locking_margin": 0.4}, "locking_margin"),
    ],
)
def test_impossible_input_is_refused_by_name(requirements, code):
    with pytest.raises(synth.InputError) as refusal:
        design(requirements=requirements)
    assert code in refusal.value.field
    assert refusal.value.expected


@pytest.mark.parametrize("angle", ["0 deg", "-5 deg"])
def test_what_is_no_cone_is_refused(angle):
    with pytest.raises(synth.InputError, match="cone_half_angle"):
        design(values={"cone_half_angle": angle})


def test_a_flat_cone_is_computed_and_told_to_be_outside_the_range_that_is_searched():
    assert list(design(values={"cone_half_angle": "90 deg"}).outside) == ["cone_half_angle"]


@pytest.mark.parametrize(
    ("options", "requirements", "values", "parts", "code"),
    [
        ({}, {"locking_margin": 0.9}, {}, {}, "locking_allowed"),
        ({}, {}, {"cone_half_angle": "12 deg"}, {}, "pulled_apart"),
        ({}, {}, {"cone_half_angle": "7 deg"}, {}, "slender_cone"),
        ({}, {}, {}, {}, "blunt_cone"),
        ({}, {}, {"cone_half_angle": "15 deg"}, {}, "seating"),
        ({}, {}, {}, {}, "bearing_thrust"),
        ({"cooling": "fan"}, {}, {}, {}, "cooling_not_counted"),
        ({"load_kind": "active"}, {}, {}, {}, "runs_backwards"),
        ({}, {}, {"ramp_time": "0.02 s"}, {}, "hard_start"),
        ({}, {}, {"ramp_time": "3 s"}, {}, "locks_in_ramp"),
        (
            {},
            {"driven_inertia": "8 kg*m2"},
            {"shell_thickness": "3 mm"},
            {"friction_pair": "leather_dry"},
            "cooling_pause",
        ),
        (
            {},
            {"driven_inertia": "20 kg*m2", "ambient_temperature": "60 degC"},
            {"shell_thickness": "3 mm"},
            {"friction_pair": "leather_dry"},
            "lining_temperature",
        ),
    ],
)
def test_remark(options, requirements, values, parts, code):
    found = design(options, requirements, values, parts)
    assert any(remark.startswith(f"{code}:") for remark in found.advice)


def test_remarks_that_do_not_concern_a_design_are_silent():
    greased = {"friction_pair": "leather_greased", "cone_layout": "inner_cone"}
    found = design(values={"cone_half_angle": "15 deg", "shell_thickness": "20 mm"}, parts=greased)
    assert [remark.split(":")[0] for remark in found.advice] == []


def test_dry_greased_and_oiled_pairs_of_the_family():
    instance = instance_of(synth.load("cone_clutch", practice="off"), BASE, as_catalogs(None))
    slot = next(s for s in instance.selection.slots if s.slot == "friction_pair")
    names = {slot.table.designations[k] for k in slot.rows}
    assert {"woven_dry", "leather_greased", "ci_steel_wet"} <= names
    assert "paper_wet" not in names


def spec_of(options=None, requirements=None):
    problem = synth.load("cone_clutch", practice="off", **(options or {}))
    return problem, requirements_in_si(problem, BASE | (requirements or {}))


def test_curves_without_a_design_cross_zero_where_the_cones_lock():
    problem, spec = spec_of()
    curves = problem.curves(spec)
    assert set(curves) == {"force_ratio_over_angle", "startup_over_torque"}
    frame = curves["force_ratio_over_angle"]
    angle = frame["half angle [deg]"]
    for mark, mu in zip(frame.attrs["marks"], (0.1, 0.2, 0.3, 0.4, 0.5), strict=True):
        releasing = frame[f"releasing force dm/(2M) friction {mu:g} [-]"]
        assert np.interp(mark["x"], angle, releasing) == pytest.approx(0, abs=1e-3)
        engaging = frame[f"engaging force dm/(2M) friction {mu:g} [-]"]
        half_sum = (engaging + releasing) / 2
        assert half_sum.to_numpy() == pytest.approx(np.sin(np.radians(angle)).to_numpy() / mu)
    shown = [name for panel in frame.attrs["panels"] for name in panel["columns"]]
    assert shown == list(frame.columns[1:])


@pytest.mark.parametrize("options", [{}, {"friction_basis": "worst_case"}, {"basis": "worst_case"}])
def test_curves_of_a_design_meet_it(options):
    problem, spec = spec_of(options, OPTIONAL)
    found = design(options, OPTIONAL)
    frame = problem.curves(spec, found)["force_over_angle"]
    at = frame[np.isclose(frame["half angle [deg]"], 23)].iloc[0]
    v = found.values
    assert at["engaging: the spring [N]"] == pytest.approx(v["actuation_force"])
    assert at["releasing [N]"] == pytest.approx(v["release_force"])
    assert at["engaged [N*m]"] == pytest.approx(v["torque"])
    assert at["seated by vibration [N*m]"] == pytest.approx(v["seated_torque"])
    assert at["engaged [N/mm2]"] * 1e6 == pytest.approx(v["surface_pressure"])
    assert at["seated by vibration [N/mm2]"] * 1e6 == pytest.approx(v["seated_pressure"])
    assert np.all(frame["releasing [N]"] < frame["in service [N]"])
    assert np.all(frame["in service [N]"] < frame["engaging: the spring [N]"])
    locking, margin = frame.attrs["spans"]
    static = found.limits["self_locking"][1] / 1.05
    assert math.tan(math.radians(locking["to"])) == pytest.approx(static)
    assert math.tan(math.radians(margin["to"])) == pytest.approx(1.05 * static)
    assert {line["label"] for line in frame.attrs["lines"]} >= {"p_allow", "overload_torque"}
