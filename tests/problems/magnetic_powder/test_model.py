"""The family magnetic_powder_clutch: numbers against an independent calculation, limits, refusals, remarks, curves."""

import math
import pickle

import numpy as np
import pytest

import synth
from synth.errors import NotCoveredError
from synth.tables.catalogs import Catalogs
from tests.problems.of_a_family import requirements_in_si

FAMILY = synth.load("magnetic_powder_clutch", practice="off")
BASE = {"required_torque": "30 N*m"}
POINT = {
    "gap_radius": "80 mm",
    "pole_length": "24 mm",
    "powder_gap": "1.25 mm",
    "coil_length": "50 mm",
    "coil_height": "20 mm",
    "yoke_thickness": "12 mm",
    "flux_density": "0.6 T",
    "coil": "stationary",
}
PARTS = {"powder": "carbonyl_graphite", "winding_wire": "Cu 0.8 class 155"}
ALWAYS = {
    "torque_capacity",
    "powder_flux_density",
    "iron_saturation",
    "yoke_flux_density",
    "rotor_flux_density",
    "rotor_bore",
    "thermal_stability",
    "coil_temperature",
    "coil_power",
    "coil_voltage",
    "current_density",
    "turns",
    "powder_mass",
}


def design(requirements=None, values=None, parts=None):
    without = {k: v for k, v in (POINT | (values or {})).items() if v is not None}
    return synth.evaluate(FAMILY, BASE | (requirements or {}), values=without, parts=PARTS | (parts or {}))


def by_hand(v, powder, wire, coil, torque=30.0, omega=2 * math.pi * 1432.39 / 60, slip=2 * math.pi * 9.549 / 60):
    """Section by section, in radii and areas, with the temperature by steps."""
    r, lp, g, lm, hc, t, b = (
        v[n]
        for n in (
            "gap_radius",
            "pole_length",
            "powder_gap",
            "coil_length",
            "coil_height",
            "yoke_thickness",
            "flux_density",
        )
    )
    still = coil == "stationary"
    mu0 = 4e-7 * math.pi
    face = 2 * math.pi * r * lp
    drum = r + g + (0.006 if still else 0.0)
    bore = drum + (0.0004 if still else 0.0)
    outer, length = bore + hc + t, 2 * lp + lm + 2 * t
    flux = b * face
    out = 1.15 * flux / (math.pi * (outer**2 - (bore + hc) ** 2))
    rim = flux / (math.pi * (r**2 - (r - t) ** 2))
    field = 160 * max(out, rim) / (1 - max(out, rim) / 2)
    turned = 2 * b * g / (mu0 * powder["relative_permeability"]) + field * 2 * (hc + t + lm + lp)
    if still:
        turned += 2 * flux / (2 * math.pi * (drum + 0.0002) * lp) / mu0 * 0.0004
    n = 0.85 * lm * hc / wire["overall_diameter"] ** 2
    current = turned / n
    coil_radius = bore + hc / 2
    cold = 1.72e-8 * 2 * math.pi * coil_radius * n / wire["copper_area"]
    drop = 0.0 if still else 2.0
    h = 12 if still else 12 + 3 * (omega * outer) ** 0.8
    surface = 2 * math.pi * outer * length + 2 * math.pi * outer**2
    slip_heat = torque * slip
    rise = 0.0
    for _ in range(3000):
        hot = cold * (1 + 0.00393 * (313.15 + rise - 293.15))
        rise = (current**2 * hot + drop * current + slip_heat) / (h * surface)
    span = 2 * lp + lm
    m_powder = powder["bulk_density"] * 0.6 * math.pi * ((r + g) ** 2 - r**2) * span
    rotor = 7850 * (math.pi * (r**2 - (r - t) ** 2) * span + math.pi * (r - t) ** 2 * 0.008)
    body = 7850 * (math.pi * (outer**2 - bore**2) * length - 2 * math.pi * coil_radius * lm * hc)
    copper = 8960 * 2 * math.pi * coil_radius * n * wire["copper_area"]
    shell = 7850 * math.pi * (drum**2 - (r + g) ** 2) * span if still else 0.0
    inertia = (
        shell * (drum**2 + (r + g) ** 2) / 2 if still else body * (outer**2 + bore**2) / 2 + copper * coil_radius**2
    )
    tau = powder["tau_sat"] * b**2 / (b**2 + powder["half_flux_density"] ** 2)
    values = {
        "torque": tau * 2 * face * r,
        "slip_heat": slip_heat,
        "ampere_turns": turned,
        "turns": math.floor(n),
        "current": turned / math.floor(n),
        "current_density": current / wire["copper_area"],
        "coil_voltage": current * hot + drop,
        "coil_temperature_rise": rise,
        "coil_power": current**2 * hot + drop * current,
        "powder_mass": m_powder,
        "input_inertia": inertia,
        "outer_diameter": 2 * outer,
        "length": length,
        "mass": rotor + body + copper + shell + m_powder,
    }
    return values, {"out": out, "rim": rim, "runaway": 0.00393 * current**2 * cold / (h * surface)}


@pytest.mark.parametrize("coil", ["stationary", "rotating"])
@pytest.mark.parametrize("wire", ["Cu 0.5 class 155", "Cu 1.25 class 180"])
@pytest.mark.parametrize("powder", ["carbonyl_graphite", "stainless_atomised"])
@pytest.mark.parametrize("values", [{}, {"flux_density": "0.25 T", "yoke_thickness": "20 mm", "coil_height": "33 mm"}])
def test_numbers_against_an_independent_calculation(coil, wire, powder, values):
    found = design(values={**values, "coil": coil}, parts={"winding_wire": wire, "powder": powder})
    expected, sections = by_hand(found.values, found.parts["powder"], found.parts["winding_wire"], coil)
    assert set(expected) < set(found.values)
    for name, value in expected.items():
        assert found.values[name] == pytest.approx(value, rel=1e-9), name
    t_max = min(found.parts["powder"]["temp_max"], found.parts["winding_wire"]["insulation_temperature"])
    sides = {
        "torque_capacity": (expected["torque"], 36.0),
        "powder_flux_density": (found.values["flux_density"], 1.0),
        "iron_saturation": (max(sections["out"], sections["rim"]), 2.0),
        "yoke_flux_density": (sections["out"], 1.5),
        "rotor_flux_density": (sections["rim"], 1.5),
        "rotor_bore": (0.08, found.values["yoke_thickness"] + 0.012),
        "thermal_stability": (sections["runaway"], 0.9),
        "coil_temperature": (expected["coil_temperature_rise"], t_max - 313.15),
        "coil_power": (expected["coil_power"], 60),
        "coil_voltage": (expected["coil_voltage"], 24),
        "current_density": (expected["current_density"], 5e6),
        "turns": (found.steps["window_turns"], 1),
        "powder_mass": (expected["powder_mass"], 0.4),
    }
    assert set(found.limits) == set(sides) == ALWAYS
    for name, pair in sides.items():
        assert found.limits[name] == pytest.approx(pair, rel=1e-9), name


def test_room_is_limited_when_asked_for():
    found = design({"outer_diameter_limit": "240 mm", "length_limit": "130 mm"})
    assert found.limits["outer_diameter"] == (found.values["outer_diameter"], pytest.approx(0.24))
    assert found.limits["length"] == (found.values["length"], pytest.approx(0.13))
    assert set(found.limits) == ALWAYS | {"outer_diameter", "length"}


def test_ampere_turns_are_accepted_in_place_of_the_flux_density():
    for coil in ("stationary", "rotating"):
        for density in (0.05, 0.4, 0.75):
            known = design(values={"flux_density": f"{density} T", "coil": coil})
            turned = known.values["ampere_turns"]
            for name in ("ampere_turns", "NI"):
                again = design(values={"flux_density": None, name: turned, "coil": coil})
                assert again.values["flux_density"] == pytest.approx(density, rel=1e-10)
    # No field is strong enough to saturate: the flux density found stays below.
    found = design(values={"flux_density": None, "NI": "20 kA", "yoke_thickness": "10 mm"})
    assert found.values["flux_density"] < 1.0
    assert "iron_saturation" not in found.violated
    assert "rotor_flux_density" in found.violated


def test_beyond_saturation_there_is_no_coil():
    found = design(values={"flux_density": "1.4 T", "yoke_thickness": "8 mm"})
    assert "iron_saturation" in found.violated
    for name in ("ampere_turns", "current", "coil_power", "coil_temperature_rise"):
        assert found.values[name] is None or math.isnan(found.values[name]), name
    assert found.values["torque"] > 0


def test_thermal_runaway_is_named():
    hot = {"coil_length": "6 mm", "coil_height": "5 mm", "flux_density": "0.75 T"}
    found = design(values=hot)
    assert "thermal_stability" in found.violated
    assert found.values["coil_temperature_rise"] is None or math.isnan(found.values["coil_temperature_rise"])
    assert found.values["current"] > 0
    assert "thermal_stability" not in design(values=hot | {"flux_density": "0.1 T"}).violated


def test_a_wire_too_thick_for_the_window():
    import pandas as pd

    busbar = pd.DataFrame(
        {
            "designation": ["bar"],
            "copper_diameter [mm]": [5.5],
            "copper_area [mm2]": [23.8],
            "overall_diameter [mm]": [6.0],
            "insulation_temperature [degC]": [155.0],
            "insulation": ["enamel"],
        }
    )
    found = synth.evaluate(
        FAMILY,
        BASE,
        values=POINT | {"coil_length": "5 mm", "coil_height": "5 mm"},
        parts=PARTS | {"winding_wire": "bar"},
        catalogs={"winding_wire": busbar},
    )
    assert found.steps["window_turns"] == pytest.approx(0.85 * 25 / 36)
    assert found.values["turns"] == 1
    assert "turns" in found.violated


@pytest.mark.parametrize(
    ("requirements", "field"),
    [
        ({"iron_flux_limit": "1.7 T", "iron_saturation": "1.6 T"}, "iron_saturates"),
        ({"iron_flux_limit": "2 T"}, "iron_flux_limit"),
        ({"required_torque": 0}, "required_torque"),
        ({"fill_factor": 1.2}, "fill_factor"),
        ({"slip_speed": "-1 1/min"}, "slip_speed"),
    ],
)
def test_impossible_input_is_refused_by_name(requirements, field):
    with pytest.raises(synth.InputError) as refusal:
        design(requirements)
    assert field in refusal.value.field
    assert refusal.value.expected


def test_a_coil_that_is_none_is_refused():
    with pytest.raises(synth.InputError):
        design(values={"coil": "floating"})


@pytest.mark.parametrize("gap", ["0.5 mm", "2 mm"])
def test_a_gap_outside_the_range_that_is_searched_is_computed_and_told(gap):
    assert list(design(values={"powder_gap": gap}).outside) == ["powder_gap"]


def test_powder_of_another_unit_is_refused():
    """A bulk density of 4.1 that was meant in g/cm3, and one of solid iron."""
    import pandas as pd

    for density in (4.1, 7870.0):
        table = pd.DataFrame(
            {
                "designation": ["mine"],
                "powder": ["carbonyl iron"],
                "tau_sat [kPa]": [50.0],
                "half_flux_density [T]": [0.7],
                "relative_permeability [-]": [4.2],
                "bulk_density [kg/m3]": [density],
                "temp_max [degC]": [200.0],
                "gap_min [mm]": [1.0],
                "gap_max [mm]": [1.5],
            }
        )
        with pytest.raises(synth.InputError, match="bulk_density"):
            synth.evaluate(FAMILY, BASE, values=POINT, parts=PARTS | {"powder": "mine"}, catalogs={"powders": table})


@pytest.mark.parametrize(
    ("requirements", "values", "code"),
    [
        ({}, {}, "powder_calibration"),
        ({}, {"coil": "rotating"}, "slip_rings"),
        ({"driver_speed": "300 1/min"}, {}, "powder_not_spread"),
        ({"ambient_temperature": "70 degC"}, {}, "hot_surface"),
    ],
)
def test_remark(requirements, values, code):
    found = design(requirements, values)
    assert any(remark.startswith(f"{code}:") for remark in found.advice)


def test_remarks_that_do_not_concern_a_design_are_silent():
    cool = {"slip_speed": 0, "ambient_temperature": "20 degC"}
    found = design(cool, {"flux_density": "0.3 T"})
    assert [remark.split(":")[0] for remark in found.advice] == ["powder_calibration"]


def test_a_gap_that_the_powder_is_not_made_for():
    import pandas as pd

    table = pd.DataFrame(
        {
            "designation": ["fine"],
            "powder": ["carbonyl iron"],
            "tau_sat [kPa]": [50.0],
            "half_flux_density [T]": [0.7],
            "relative_permeability [-]": [4.2],
            "bulk_density [kg/m3]": [4100.0],
            "temp_max [degC]": [200.0],
            "gap_min [mm]": [0.5],
            "gap_max [mm]": [1.0],
        }
    )
    found = synth.evaluate(FAMILY, BASE, values=POINT, parts=PARTS | {"powder": "fine"}, catalogs={"powders": table})
    assert any(remark.startswith("unusual_powder_gap:") for remark in found.advice)
    assert not any(remark.startswith("unusual_powder_gap:") for remark in design().advice)


@pytest.mark.parametrize(
    ("torque", "power", "mass", "values"),
    [
        (7.5, 14, 5, {"gap_radius": "46 mm", "pole_length": "10 mm", "coil_length": "30 mm"}),
        (75.9, 35, 17, {"gap_radius": "92 mm", "pole_length": "26 mm", "coil_length": "34 mm"}),
    ],
)
def test_orders_of_magnitude_of_a_catalogue(torque, power, mass, values):
    """Warner/Maxcess GCA and GCD: torque, coil power and mass belong together as here, within a factor of two."""
    found = design(values=values | {"flux_density": "0.65 T"})
    assert found.values["torque"] == pytest.approx(torque, rel=0.1)
    assert 0.5 < found.values["coil_power"] / power < 2
    assert 0.5 < found.values["mass"] / mass < 2


def spec_of(requirements=None):
    return FAMILY, requirements_in_si(FAMILY, BASE | (requirements or {}))


@pytest.mark.parametrize("coil", ["stationary", "rotating"])
def test_curves_of_a_design_meet_it(coil):
    problem, spec = spec_of()
    found = design(values={"coil": coil})
    v = found.values
    curves = problem.curves(spec, found)
    assert set(curves) == {"stress_over_radius", "torque_over_current", "torque_over_temperature", "heat_balance"}

    over_current = curves["torque_over_current"].set_index("current [A]")
    at = over_current.iloc[np.argmin(abs(over_current.index - v["current"]))]
    assert at["torque [N*m]"] == pytest.approx(v["torque"], rel=1e-9)
    assert at["powder [T]"] == pytest.approx(v["flux_density"], rel=1e-9)
    assert at["temperature rise [K]"] == pytest.approx(v["coil_temperature_rise"], rel=1e-9)
    limits = found.limits
    assert (at["yoke [T]"], at["rotor [T]"]) == pytest.approx(
        (limits["yoke_flux_density"][0], limits["rotor_flux_density"][0]), rel=1e-9
    )
    assert over_current.iloc[0]["torque [N*m]"] == pytest.approx(0, abs=1e-9)
    assert (np.diff(over_current["torque [N*m]"]) > 0).all()
    lines = {line["label"]: line["y"] for line in curves["torque_over_current"].attrs["lines"]}
    assert lines["with torque_reserve"] == pytest.approx(36)
    assert (lines["powder_flux_limit"], lines["iron_flux_limit"]) == (1.0, 1.5)
    assert lines["insulation and powder"] == pytest.approx(155 - 40)

    over_temperature = curves["torque_over_temperature"]
    axis = over_temperature["coil temperature [degC]"].to_numpy()
    steady = 40 + v["coil_temperature_rise"]
    assert np.interp(steady, axis, over_temperature["constant voltage [N*m]"]) == pytest.approx(v["torque"], rel=1e-4)
    assert np.interp(steady, axis, over_temperature["constant voltage [A]"]) == pytest.approx(v["current"], rel=1e-4)
    assert (np.diff(over_temperature["constant voltage [N*m]"]) < 0).all()

    balance = curves["heat_balance"]
    axis = balance["temperature [degC]"].to_numpy()
    made, given = (np.interp(steady, axis, balance[f"heat {word} [W]"]) for word in ("made", "given off"))
    assert made == pytest.approx(given, rel=1e-9)
    assert made == pytest.approx(v["coil_power"] + v["slip_heat"], rel=1e-9)


def test_curve_of_a_requirement():
    problem, spec = spec_of()
    (frame,) = problem.curves(spec).values()
    row = frame.iloc[40]
    radius = row["gap radius [mm]"] / 1e3
    for length in (10, 20, 40):
        stress = row[f"poles of {length} mm [kPa]"] * 1e3
        assert stress * 4 * math.pi * length / 1e3 * radius**2 == pytest.approx(36, rel=1e-9)


# ---- what it is asked to do -----------------------------------------------------------------------------------------

DRIVE = {"load_torque": "100 N*m", "driver_speed": "1450 1/min", "driven_inertia": "0.4 kg*m2"}


@pytest.mark.parametrize("practice", ["on", "off"])
def test_heat_of_a_start_takes_the_place_of_that_of_slip(practice):
    """The torque is there after 0.2 s; work by small steps of time."""
    family = synth.load("magnetic_powder_clutch", practice=practice)
    found = synth.evaluate(family, DRIVE | {"load_torque": "20 N*m"}, values=POINT, parts=PARTS).values
    full, load, inertia, speed = found["torque"], 20.0, 0.4, 1450 * math.pi / 30
    step, time, driven, work = 1e-5, 0.0, 0.0, 0.0
    assert full > load
    while driven < speed:
        torque = full * min((time + step / 2) / 0.2, 1.0)
        work += torque * (speed - driven) * step
        driven += max(torque - load, 0.0) / inertia * step
        time += step
    assert found["friction_work"] == pytest.approx(work, rel=1e-4)
    assert found["slip_time"] == pytest.approx(time, rel=1e-4)
    assert found["slip_heat"] == pytest.approx(found["friction_work"] * 50 / 3600, rel=1e-12)


def test_worked_start():
    def values(pole):
        return synth.evaluate(FAMILY, DRIVE, values=POINT | {"pole_length": f"{pole!r} mm"}, parts=PARTS).values

    found = values(24 * 180 / values(24)["torque"])  # the torque is proportional to the length of the poles
    assert found["torque"] == pytest.approx(180, rel=1e-9)
    assert found["friction_work"] == pytest.approx(11887.2737, rel=1e-8)
    assert found["slip_heat"] == pytest.approx(165.101024, rel=1e-8)


def test_what_is_asked_follows_from_the_words_that_are_stated():
    def kind(*words):
        return FAMILY.model(frozenset(words), Catalogs()).declaration.options["duty"].chosen

    assert kind("required_torque") == "continuous_slip"
    assert kind("driven_inertia", "load_torque") == "start"
    assert kind("driven_inertia", "slip_speed") == "continuous_slip"


def test_a_coupling_has_no_heat_of_slip():
    coupling = synth.load("magnetic_powder_clutch", practice="off", duty="coupling")
    found = synth.evaluate(coupling, BASE, values=POINT, parts=PARTS)
    assert "slip_heat" not in found.values
    assert found.values["coil_temperature_rise"] < design().values["coil_temperature_rise"]
    with pytest.raises(synth.InputError, match="slip_speed"):
        synth.evaluate(coupling, BASE | {"slip_speed": "10 1/min"}, values=POINT, parts=PARTS)


def test_what_drives_both_ways_does_not_overrun():
    overrun = synth.load("magnetic_powder_clutch", duty="overrun")
    with pytest.raises(NotCoveredError, match="another family: this one drives both ways: use wrap_spring") as told:
        synth.synthesize(overrun, BASE)
    assert str(pickle.loads(pickle.dumps(told.value))) == str(told.value)
