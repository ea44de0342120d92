"""The family disc_clutch: its numbers against an independent calculation, its limits, refusals, remarks and curves."""

import math

import numpy as np
import pytest

import synth
from synth.question.catalogs import as_catalogs
from tests.asking import instance_of
from tests.problems.of_a_family import requirements_in_si
from tests.problems.start_by_steps import start

BASE = {"load_torque": "100 N*m", "driver_speed": "1500 rpm", "driven_inertia": "0.7 kg*m2"}
OPTIONAL = {
    "startup_torque": "150 N*m",
    "overload_torque": "900 N*m",
    "actuation_force_limit": "8 kN",
    "outer_diameter_limit": "300 mm",
    "length_limit": "60 mm",
    "jerk_limit": "2000 rad/s3",
    "acceleration_limit": "400 rad/s2",
}
POINT = {
    "ring_outer_diameter": "230 mm",
    "ring_inner_diameter": "180 mm",
    "pressure_plate_thickness": "8 mm",
    "actuation_force": "3500 N",
    "ramp_time": "0.4 s",
    "discs": 1,
}
PARTS = {"friction_pair": "moulded_dry"}

ALWAYS = {
    "torque_capacity",
    "worn_torque_capacity",
    "never_starts",
    "surface_pressure",
    "specific_heat",
    "engagement_heat",
    "specific_power",
    "plate_temperature_rise",
    "mean_temperature",
    "ring_ratio_min",
    "ring_ratio_max",
    "hub_bore",
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
}


def design(options=None, requirements=None, values=None, parts=None):
    problem = synth.load("disc_clutch", practice="off", **(options or {}))
    return synth.evaluate(
        problem, BASE | (requirements or {}), values=POINT | (values or {}), parts=PARTS | (parts or {})
    )


def by_hand(pair, d_out, d_in, t_p, force, ramp, discs, *, kind="reactive", worst=False, limited=None, cooled=20.0):
    """Section by section from the sources, with radii and sums over surfaces."""
    low, high = (pair["mu_min"], pair["mu_max"]) if worst else (pair["mu_dynamic"],) * 2
    r1, r2, surfaces = d_in / 2, d_out / 2, 2 * discs
    one = math.pi * (r2**2 - r1**2)
    radius = 2 / 3 * (r2**3 - r1**3) / (r2**2 - r1**2)
    omega = 1500 / 60 * 2 * math.pi
    built = {mu: surfaces * mu * force * radius for mu in (low, high)}
    result = {
        "friction_radius": radius,
        "friction_area": surfaces * one,
        "torque": built[low],
        "worn_torque": surfaces * low * force * (r1 + r2) / 2,
        "surface_pressure": force / one,
        "sliding_speed": omega * r2,
    }
    ramps = {mu: limited or torque for mu, torque in built.items()}
    work, slip, _, _ = start(ramps[low], 100.0, 0.7, omega, ramp, kind)
    _, _, power, at_lock = start(ramps[high], 100.0, 0.7, omega, ramp, kind)
    result |= {"friction_work": work, "slip_time": slip, "peak_slip_power": power, "ramp_torque": ramps[low]}
    result["jerk"] = ramps[high] / ramp / 0.7
    result["acceleration"] = (at_lock - 100) / 0.7
    result["hourly_heat"] = work * 50 / 3600 / (surfaces * one)
    result["single_heat"] = work / (surfaces * one)
    result["power_density"] = power / (surfaces * one)
    plate, lining = 7200 * t_p * one, pair["density"] * pair["lining_thickness"] * one
    core = 7850 * 0.002 * math.pi * (r2**2 - 0.02**2)
    result["mass"] = discs * (plate + 2 * lining + core)
    spin = core * (r2**2 + 0.02**2) / 2 + 2 * lining * (r2**2 + r1**2) / 2
    result["disc_inertia"] = discs * spin
    result["outer_diameter"] = diameter = 2 * (r2 + 0.008)
    result["length"] = discs * (2 * pair["lining_thickness"] + 0.002 + t_p + 2 * 0.0003)
    result["volume"] = math.pi * diameter**2 / 4 * result["length"]
    result["temperature_rise"] = 0.5 * work / (plate * 500)
    surface = math.pi * diameter * result["length"] + math.pi * diameter**2 / 2
    result["mean_temperature_rise"] = work * 50 / 3600 / (cooled * surface)
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
    "mean_temperature_rise",
}


@pytest.mark.parametrize(
    ("options", "values", "how"),
    [
        ({}, {}, {}),
        ({}, {"discs": 2, "actuation_force": "2500 N"}, {}),
        ({"load_kind": "active", "cooling": "fan"}, {}, {"kind": "active", "cooled": 50.0}),
        ({"friction_basis": "worst_case"}, {}, {"worst": True}),
        ({}, {"ramp_time": "3 s"}, {}),
        ({}, {"ramp_time": "0.02 s"}, {}),
    ],
)
@pytest.mark.parametrize("limited", [None, 150.0])
def test_numbers_against_an_independent_calculation(options, values, how, limited):
    found = design(options, {"startup_torque": "150 N*m"} if limited else None, values)
    si = found.values
    expected = by_hand(
        found.parts["friction_pair"],
        si["ring_outer_diameter"],
        si["ring_inner_diameter"],
        si["pressure_plate_thickness"],
        si["actuation_force"],
        si["ramp_time"],
        round(si["discs"]),
        limited=limited,
        **how,
    )
    for name, value in expected.items():
        assert found.values[name] == pytest.approx(value, rel=3e-5 if name in STEPPED else 1e-9), name


def test_limits_are_built_when_they_are_asked_for():
    assert set(design().limits) == ALWAYS
    for limit, requirement in ASKED.items():
        assert set(design(requirements={requirement: OPTIONAL[requirement]}).limits) == ALWAYS | {limit}
    assert set(design(requirements=OPTIONAL).limits) == ALWAYS | set(ASKED)


def test_sides_of_the_limits():
    found = design({"friction_basis": "worst_case"}, OPTIONAL)
    v, pair = found.values, found.parts["friction_pair"]
    high = v["torque"] * pair["mu_max"] / pair["mu_min"]
    expected = {
        "torque_capacity": (v["torque"], 150 / 0.85),
        "worn_torque_capacity": (v["worn_torque"], 150 / 0.85),
        "startup_torque_available": (v["torque"], 150),
        "never_starts": (150, 100),
        "torque_limit": (high, 900),
        "surface_pressure": (v["surface_pressure"], pair["p_allow"]),
        "specific_heat": (v["hourly_heat"], pair["q_hourly_allow"]),
        "engagement_heat": (v["single_heat"], pair["q_single_allow"]),
        "specific_power": (v["power_density"], pair["power_density_allow"]),
        "plate_temperature_rise": (v["temperature_rise"], 100),
        "mean_temperature": (v["mean_temperature_rise"], pair["temp_continuous"] - 313.15),
        "ring_ratio_min": (v["ring_ratio"], 0.11),
        "ring_ratio_max": (v["ring_ratio"], 0.13),
        "hub_bore": (0.09, 0.02),
        "slip_time": (v["slip_time"], 4),
        "cycle_time": (v["slip_time"], 72),
        "sliding_speed": (v["sliding_speed"], pair["v_allow"]),
        "actuation_force": (3500, 8000),
        "outer_diameter": (v["outer_diameter"], 0.3),
        "length": (v["length"], 0.06),
        "jerk": (v["jerk"], 2000),
        "acceleration": (v["acceleration"], 400),
    }
    assert set(found.limits) == set(expected)
    for name, sides in expected.items():
        assert found.limits[name] == pytest.approx(sides, rel=1e-9), name


def test_the_worn_in_clutch_decides():
    """Exactly enough when new is not enough when worn in: the capacity falls by 1/(1 + c**2/3)."""
    exact = design()
    share = exact.frame.requirement_values["required_torque"] / exact.values["torque"]
    found = design(values={"actuation_force": f"{3500 * share} N"})
    assert found.values["torque"] == pytest.approx(found.frame.requirement_values["required_torque"], rel=1e-12)
    assert "worn_torque_capacity" in found.violated
    assert "torque_capacity" not in found.violated
    ratio = found.values["ring_ratio"]
    assert found.values["torque"] / found.values["worn_torque"] == pytest.approx(1 + ratio**2 / 3, rel=1e-12)


@pytest.mark.parametrize(
    ("options", "requirements", "code"),
    [
        ({"cooling": "oil_bath"}, {}, "lubrication_mismatch"),
        ({}, {"startup_torque": "100 N*m"}, "never_starts"),
        ({}, {"overload_torque": "176 N*m"}, "capacity_window_empty"),
        ({}, {"ring_ratio_min": 0.14}, "bad_ratio"),
        ({}, {"disc_hub_radius": "100 mm", "outer_diameter_limit": "260 mm"}, "no_room_for_ring"),
        ({}, {"driver_speed": 0}, "driver_speed"),
        ({}, {"speed_factor": 1.6}, "speed_factor"),
    ],
)
def test_impossible_input_is_refused_by_name(options, requirements, code):
    with pytest.raises(synth.InputError) as refusal:
        design(options, requirements)
    assert code in refusal.value.field
    assert refusal.value.expected


@pytest.mark.parametrize(
    "requirements",
    [
        {"startup_torque": "101 N*m"},
        {"overload_torque": "177 N*m"},
        {"disc_hub_radius": "100 mm", "outer_diameter_limit": "266 mm"},
    ],
)
def test_possible_input_is_not_refused(requirements):
    assert design(requirements=requirements).values["mass"] > 0


@pytest.mark.parametrize(
    ("options", "requirements", "values", "code"),
    [
        ({}, {}, {"discs": 2}, "twin_disc_release"),
        ({"cooling": "fan"}, {}, {}, "fan_cooling"),
        ({"load_kind": "active"}, {}, {}, "runs_backwards"),
        ({}, {"engagements_per_hour": 200}, {}, "frequent_switching"),
        ({}, {"engagements_per_hour": 200}, {"pressure_plate_thickness": "3 mm"}, "lining_temperature"),
        ({}, {}, {"ramp_time": "0.02 s"}, "hard_start"),
        ({}, {}, {"ramp_time": "3 s"}, "locks_in_ramp"),
        ({}, {}, {"ring_inner_diameter": "240 mm"}, "bad_ring"),
        ({}, {}, {"actuation_force": "1300 N"}, "static_hold"),
    ],
)
def test_remark(options, requirements, values, code):
    found = design(options, requirements, values)
    assert any(remark.startswith(f"{code}:") for remark in found.advice)


def test_remarks_that_do_not_concern_a_design_are_silent():
    found = design(requirements={"engagements_per_hour": 5}, values={"actuation_force": "4000 N"})
    assert found.advice == ()
    soft = {"jerk_limit": "1e6 rad/s3", "engagements_per_hour": 5}
    assert design(requirements=soft, values={"actuation_force": "4000 N", "ramp_time": "0.02 s"}).advice == ()


def test_only_dry_pairs_of_the_family():
    instance = instance_of(synth.load("disc_clutch", practice="off"), BASE, as_catalogs(None))
    slot = next(s for s in instance.selection.slots if s.slot == "friction_pair")
    table = slot.table
    names = {table.designations[k] for k in slot.rows}
    surfaces = dict(zip(table.designations, table.text("surfaces"), strict=True))
    lubricated = dict(zip(table.designations, table.text("lubrication"), strict=True))
    assert "ci_steel_wet" not in names
    assert len(names) > 5
    assert all("disc facing" in surfaces[n].split(";") and lubricated[n] == "dry" for n in names)


def spec_of(options=None, requirements=None):
    problem = synth.load("disc_clutch", practice="off", **(options or {}))
    return problem, requirements_in_si(problem, BASE | (requirements or {}))


def test_curves_of_a_requirement_are_the_sizing():
    problem, spec = spec_of(requirements={"outer_diameter_limit": "300 mm"})
    curves = problem.curves(spec)
    assert set(curves) == {"diameter_over_lining", "startup_over_torque"}
    frame = curves["diameter_over_lining"]
    row = frame.iloc[40]
    grip = row["friction times allowed pressure [N/mm2]"] * 1e6
    for words, z in (("one disc", 2), ("two discs", 4)):
        for short, c in (("narrow", 0.11), ("wide", 0.13)):
            mean = row[f"{words}, {short} ring [mm]"] / 1e3 / (1 + c)
            torque = z * grip * math.pi * mean**3 * (3 * c + c**3) / 6
            assert torque == pytest.approx(150 / 0.85, rel=1e-9)
    assert frame.attrs["lines"][0]["y"] == pytest.approx(300 - 16)
    assert frame.attrs["panels"][0]["columns"] == list(frame.columns[1:])
    assert spec_of()[0].curves(spec_of()[1])["diameter_over_lining"].attrs["lines"] == []


def test_curves_of_a_design_meet_it():
    problem, spec = spec_of(requirements=OPTIONAL)
    found = design(requirements=OPTIONAL)
    curves = problem.curves(spec, found)
    assert set(curves) == {"diameter_over_lining", "startup_over_torque", "pressure_over_radius", "torque_over_force"}
    pressure = curves["pressure_over_radius"]
    radius, worn = pressure["radius [mm]"] / 1e3, pressure["worn-in lining [N/mm2]"] * 1e6
    carried = np.trapezoid(worn * 2 * np.pi * radius, radius)
    assert carried == pytest.approx(3500, rel=1e-6)
    assert (worn * radius).std() == pytest.approx(0, abs=1e-6)
    torque = curves["torque_over_force"]
    at = torque[np.isclose(torque["axial force [N]"], 3500)].iloc[0]
    assert at["new lining [N*m]"] == pytest.approx(found.values["torque"])
    assert at["worn-in lining [N*m]"] == pytest.approx(found.values["worn_torque"])
    marked = {line["label"]: line["y"] for line in torque.attrs["lines"]}
    assert marked["sizing torque"] == pytest.approx(150 / 0.85)
    assert (marked["startup_torque"], marked["overload_torque"]) == pytest.approx((150, 900))
