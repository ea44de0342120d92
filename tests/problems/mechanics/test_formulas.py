"""Every formula of the friction clutches: units, and the same numbers on floats, arrays and symbols."""

import inspect
from functools import partial

import pytest
from synth.problems.cone import formulas as cone
from synth.problems.mechanics import disc, guide_friction, heat, motors, plates, ring, shaft, startup, wear

from tests.problems.formula_checks import assert_homogeneous, assert_same_on_symbols_and_arrays, name_of, positional

RANGES = {
    "ring_ratio": (0.05, 0.3),
    "inner_ratio": (0.01, 0.3),
    "outer_ratio": (0.01, 0.3),
    "guide_number": (0.01, 0.5),
    "surfaces": (2, 30),
    "surface": (1, 9),
    "waves": (3, 12),
    "pullout_torque_ratio": (1.5, 4),
    "half_angle": (0.1, 0.45),
}
# Above the load torque, and sizes that meet every regime of the start-up.
START_RANGES = {"torque": (2.2, 6.0), "load_torque": (0.5, 2.0), "ramp_time": (0.2, 6.0), "driven_inertia": (0.3, 3.0)}
BURIED_RING = {"inner_radius": (0.5, 0.9), "outer_radius": (1.0, 2.0), "inner_diameter": (0.5, 0.9)}
BURIED_RING |= {"outer_diameter": (1.0, 2.0)}

DM_C = {"mean_diameter": "m", "ring_ratio": "-"}
START = {"torque": "N m", "load_torque": "N m", "driven_inertia": "kg m2", "driver_speed": "1/s", "ramp_time": "s"}
KAPPAS = {"inner_ratio": "-", "outer_ratio": "-"}
SPLINES = {"friction_radius": "m", "inner_spline_radius": "m", "outer_spline_radius": "m"}
HEAT = {"friction_work": "J", "switching_rate": "1/s"}
WEDGE = {"half_angle": "-", "mu": "-"}
COOLING = {"heat_transfer": "W/(m2 K)", "cooled_area": "m2"}


DRIVEN = {"torque": "N m", "load_torque": "N m", "driven_inertia": "kg m2", "ramp_time": "s"}
CASES = [
    (ring.mean_diameter, {"outer_diameter": "m", "inner_diameter": "m"}, "m"),
    (ring.ring_ratio, {"outer_diameter": "m", "inner_diameter": "m"}, "-"),
    (ring.outer_diameter, DM_C, "m"),
    (ring.inner_diameter, DM_C, "m"),
    (ring.friction_radius, DM_C, "m"),
    (ring.ring_area, DM_C, "m2"),
    (ring.friction_torque, {"mu": "-", "force": "N", "friction_radius": "m", "sum_factor": "-"}, "N m"),
    (ring.pressure_torque, {"surfaces": "-", "mu": "-", "pressure": "Pa", **DM_C}, "N m"),
    (
        ring.sizing_mean_diameter,
        {"torque": "N m", "surfaces": "-", "mu": "-", "pressure": "Pa", "ring_ratio": "-"},
        "m",
    ),
    (ring.surfaces_needed, {"torque": "N m", **DM_C, "mu": "-", "pressure": "Pa"}, "-"),
    (ring.outer_plate_count, {"surfaces": "-"}, "-"),
    (ring.inner_plate_count, {"surfaces": "-"}, "-"),
    (
        ring.required_torque,
        {
            "load_torque": "N m",
            "safety_factor": "-",
            "switching_factor": "-",
            "speed_factor": "-",
            "surface_factor": "-",
        },
        "N m",
    ),
    (ring.worn_torque, {"surfaces": "-", "mu": "-", "force": "N", "mean_diameter": "m"}, "N m"),
    (ring.worn_peak_pressure, {"force": "N", **DM_C}, "Pa"),
    (guide_friction.guide_ratio, {"mu": "-", "mu_guide": "-", "friction_radius": "m", "spline_radius": "m"}, "-"),
    (guide_friction.guide_number, {"mu": "-", "mu_guide": "-", **SPLINES}, "-"),
    (guide_friction.damped_guide_number, {"guide_number": "-"}, "-"),
    (guide_friction.guarded_damping, {"guide_number": "-"}, "-"),
    (positional(guide_friction.sum_geometric), {"surfaces": "-", "guide_number": "-"}, "-"),
    (positional(guide_friction.sum_lipka), {"surfaces": "-", "guide_number": "-"}, "-"),
    (guide_friction.sum_exponential_k, {"surfaces": "-", "guide_number": "-"}, "-"),
    (positional(guide_friction.sum_exact), {"surfaces": "-", **KAPPAS}, "-"),
    *(
        (partial(guide_friction.torque_sum_factor, series), {"surfaces": "-", **KAPPAS}, "-")
        for series in guide_friction.GUIDE_SERIES
    ),
    *(
        (partial(guide_friction.contact_force, series), {"force": "N", "surface": "-", **KAPPAS}, "N")
        for series in guide_friction.GUIDE_SERIES
    ),
    (
        lambda mu, friction_radius, first, second: guide_friction.plate_torque(mu, friction_radius, first, second),
        {"mu": "-", "friction_radius": "m", "first": "N", "second": "N"},
        "N m",
    ),
    (
        guide_friction.torque_asymptote,
        {"force": "N", "mu_guide": "-", "inner_spline_radius": "m", "outer_spline_radius": "m"},
        "N m",
    ),
    (guide_friction.exponential_k_error, {"surfaces": "-", "guide_number": "-"}, "-"),
    (guide_friction.legacy_plate_limit, {"guide_number": "-"}, "-"),
    (
        lambda first, second, third, **rest: guide_friction.first_phase_push_force((first, second, third), **rest),
        {"first": "N", "second": "N", "third": "N", "mu": "-", "mu_guide": "-", **SPLINES},
        "N",
    ),
    (guide_friction.guide_jams, {"mu": "-", "mu_guide": "-", "friction_radius": "m", "spline_radius": "m"}, "-"),
    (startup.never_starts, {"torque": "N m", "load_torque": "N m"}, "-"),
    (
        startup.burn_out_time,
        {"torque": "N m", "driver_speed": "1/s", "heat_capacity": "J/K", "temperature_rise": "K"},
        "s",
    ),
    (startup.load_start_time, {"torque": "N m", "load_torque": "N m", "ramp_time": "s"}, "s"),
    (startup.excess_share, {"torque": "N m", "load_torque": "N m"}, "-"),
    (startup.kinetic_energy, {"driven_inertia": "kg m2", "driver_speed": "1/s"}, "J"),
    (startup.ramp_work, {"load_torque": "N m", "driver_speed": "1/s", "ramp_time": "s"}, "J"),
    (startup.run_up_work, {"torque": "N m", "load_torque": "N m", "energy": "J"}, "J"),
    (startup.ramp_relief, DRIVEN, "J"),
    (startup.driven_back_work, DRIVEN, "J"),
    (startup.catch_up_time, {"torque": "N m", "driven_inertia": "kg m2", "driver_speed": "1/s", "ramp_time": "s"}, "s"),
    (
        startup.active_lock_in_ramp,
        {"torque": "N m", "load_torque": "N m", "momentum": "kg m2/s", "ramp_time": "s"},
        "s",
    ),
    (startup.peak_power_root, {**DRIVEN, "slip_speed": "1/s"}, "N m"),
    (
        startup.lowest_driven_speed,
        {"torque": "N m", "load_torque": "N m", "driven_inertia": "kg m2", "ramp_time": "s"},
        "1/s",
    ),
    (startup.torque_rate_per_inertia, {"torque": "N m", "driven_inertia": "kg m2", "ramp_time": "s"}, "1/s3"),
    *(
        (partial(function, load_kind=kind), START, unit)
        for kind in startup.LOAD_KINDS
        for function, unit in (
            (startup.locks_after_ramp, "-"),
            (startup.slip_time, "s"),
            (startup.friction_work, "J"),
            (startup.peak_slip_power, "W"),
            (startup.lock_torque, "N m"),
        )
    ),
    (positional(startup.reactive_slip_time), START, "s"),
    (positional(startup.reactive_friction_work), START, "J"),
    (positional(startup.reactive_peak_slip_power), START, "W"),
    (
        lambda **values: startup.constant_torque_slip(**values)[1],
        {
            "slip_speed": "1/s",
            "torque": "N m",
            "driver_torque": "N m",
            "load_torque": "N m",
            "driver_inertia": "kg m2",
            "driven_inertia": "kg m2",
        },
        "J",
    ),
    (
        motors.kloss_torque,
        {"speed": "1/s", "synchronous_speed": "1/s", "breakdown_torque": "N m", "breakdown_slip": "-"},
        "N m",
    ),
    (motors.breakdown_slip, {"rated_slip": "-", "pullout_torque_ratio": "-"}, "-"),
    (heat.cycle_time, {"switching_rate": "1/s"}, "s"),
    (heat.hourly_heat, HEAT, "W"),
    (heat.specific_hourly_heat, {**HEAT, "area": "m2"}, "W/m2"),
    (heat.single_heat, {"friction_work": "J", "area": "m2"}, "J/m2"),
    (heat.power_density, {"slip_power": "W", "area": "m2"}, "W/m2"),
    (heat.mean_temperature_rise, {**HEAT, **COOLING}, "K"),
    (heat.thermal_time_constant, {"heat_capacity": "J/K", **COOLING}, "s"),
    (positional(heat.peak_rise_per_work), {"switching_rate": "1/s", "heat_capacity": "J/K", **COOLING}, "K/J"),
    (heat.peak_temperature_rise, {**HEAT, "heat_capacity": "J/K", **COOLING}, "K"),
    (positional(heat.row_share), {"n": "-", "rate": "1/s", "capacity": "J/K", "conductance": "W/K"}, "-"),
    (heat.rise_after, {"n": "-", "work": "J", "rate": "1/s", "capacity": "J/K", "conductance": "W/K"}, "K"),
    (partial(heat.conductance, moving=3.0, speed=0.0), {"still": "W/(m2 K)", "area": "m2", "area_factor": "-"}, "W/K"),
    (heat.oil_flow, {"heat": "W", "rise": "K", "volumetric_heat": "J/(m3 K)"}, "m3/s"),
    (heat.adiabatic_rise, {"friction_work": "J", "mass": "kg", "specific_heat": "J/(kg K)", "share": "-"}, "K"),
    (
        heat.flash_rise,
        {
            "heat_flux": "W/m2",
            "slip_time": "s",
            "conductivity": "W/(m K)",
            "density": "kg/m3",
            "specific_heat": "J/(kg K)",
        },
        "K",
    ),
    (heat.allowed_work_at_rate, {"single_work": "J", "transition_rate": "1/s", "switching_rate": "1/s"}, "J"),
    (
        plates.annulus_mass,
        {"density": "kg/m3", "count": "-", "thickness": "m", "mean_diameter": "m", "width": "m"},
        "kg",
    ),
    (plates.lining_mass, {"density": "kg/m3", "thickness": "m", "area": "m2"}, "kg"),
    (
        plates.pack_length,
        {"surfaces": "-", "inner_thickness": "m", "outer_thickness": "m", "lining_thickness": "m", "gap": "m"},
        "m",
    ),
    (plates.drum_diameter, {"outer_spline_radius": "m", "drum_wall": "m"}, "m"),
    (plates.cylinder_volume, {"diameter": "m", "length": "m"}, "m3"),
    (plates.cylinder_surface, {"diameter": "m", "length": "m"}, "m2"),
    (
        plates.lug_pressure,
        {"plate_torque": "N m", "spline_radius": "m", "lug_count": "-", "lug_height": "m", "thickness": "m"},
        "Pa",
    ),
    (plates.drag_torque, {"surfaces": "-", "viscosity": "Pa s", "speed_difference": "1/s", **DM_C, "gap": "m"}, "N m"),
    (plates.stroke, {"surfaces": "-", "gap": "m", "wear_depth": "m"}, "m"),
    (
        plates.pack_inner_inertia,
        {
            "density": "kg/m3",
            "plates_thickness": "m",
            "pack_length": "m",
            "web_thickness": "m",
            "outer_radius": "m",
            "spline_radius": "m",
            "rim_wall": "m",
            "shaft_radius": "m",
        },
        "kg m2",
    ),
    (disc.hub_mass, {"density": "kg/m3", "discs": "-", "hub_radius": "m", "shaft_diameter": "m"}, "kg"),
    (disc.diaphragm_spring_mass, {"density": "kg/m3", "outer_radius": "m"}, "kg"),
    (shaft.shaft_diameter, {"torque": "N m", "shear_stress": "Pa"}, "m"),
    (shaft.fatigue_shear, {"fatigue_strength": "Pa", "size_factor": "-", "safety": "-"}, "Pa"),
    (shaft.boss_mass, {"density": "kg/m3", "diameter": "m", "hub_factor": "-"}, "kg"),
    (wear.wear_life, {"area": "m2", "depth": "m", "wear_rate": "m3/J", "friction_work": "J"}, "-"),
    (
        plates.squeeze_time,
        {"viscosity": "Pa s", "force": "N", "inner_radius": "m", "outer_radius": "m", "start_gap": "m", "end_gap": "m"},
        "s",
    ),
    (
        plates.sine_plate_force,
        {
            "deflection": "m",
            "elastic_modulus": "Pa",
            "radial_width": "m",
            "thickness": "m",
            "waves": "-",
            "outer_diameter": "m",
            "inner_diameter": "m",
            "turns": "-",
        },
        "N",
    ),
    (plates.sliding_speed, {"speed_difference": "1/s", "radius": "m"}, "m/s"),
    (plates.static_hold, {"torque": "N m", "mu_static": "-", "mu_dynamic": "-", "load_torque": "N m"}, "-"),
    (plates.shaft_shear_stress, {"torque": "N m", "diameter": "m"}, "Pa"),
    (disc.surface_count, {"discs": "-"}, "-"),
    (disc.pressure_plate_mass, {"density": "kg/m3", "thickness": "m", "ring_area": "m2"}, "kg"),
    (disc.lining_inertia, {"density": "kg/m3", "thickness": "m", **DM_C}, "kg m2"),
    (disc.core_inertia, {"density": "kg/m3", "thickness": "m", "outer_radius": "m", "hub_radius": "m"}, "kg m2"),
    (disc.disc_inertia, {"discs": "-", "lining": "kg m2", "core": "kg m2"}, "kg m2"),
    (
        disc.clutch_length,
        {"discs": "-", "lining_thickness": "m", "core_thickness": "m", "plate_thickness": "m", "gap": "m"},
        "m",
    ),
    (disc.worn_pressure, {"force": "N", **DM_C, "radius": "m"}, "Pa"),
    (cone.wedge_factor, WEDGE, "-"),
    (positional(cone.grip_factor), WEDGE, "-"),
    (cone.normal_force, {"engaging_force": "N", **WEDGE}, "N"),
    (cone.mean_radius_factor, {"ring_ratio": "-", "half_angle": "-"}, "-"),
    (cone.friction_torque, {"peripheral_force": "N", **DM_C, "half_angle": "-"}, "N m"),
    (cone.worn_torque, {"peripheral_force": "N", "mean_diameter": "m"}, "N m"),
    (cone.service_force, {"normal_force": "N", "half_angle": "-"}, "N"),
    (cone.engaging_force, {"normal_force": "N", **WEDGE}, "N"),
    (cone.release_force, {"normal_force": "N", **WEDGE}, "N"),
    (cone.locking_angle, {"mu": "-"}, "-"),
    (cone.self_locking, WEDGE, "-"),
    (cone.face_area, {"mean_diameter": "m", "generator_length": "m"}, "m2"),
    (cone.pressure_torque, {"mu": "-", "pressure": "Pa", **DM_C, "half_angle": "-"}, "N m"),
    (
        cone.sizing_mean_diameter,
        {"torque": "N m", "mu": "-", "pressure": "Pa", "ring_ratio": "-", "half_angle": "-"},
        "m",
    ),
    (cone.seating_factor, WEDGE, "-"),
    (cone.seated_force, {"spring_force": "N", "half_angle": "-"}, "N"),
    (cone.bearing_force, {"spring_force": "N", "force_closed": "-"}, "N"),
    (cone.largest_diameter, {"mean_diameter": "m", "generator_length": "m", "half_angle": "-"}, "m"),
    (cone.overall_diameter, {"largest_diameter": "m", "shell_thickness": "m", "lining_thickness": "m"}, "m"),
    (cone.overall_length, {"generator_length": "m", "half_angle": "-", "length_add": "m"}, "m"),
    (cone.shell_mass, {"density": "kg/m3", "area": "m2", "shell_thickness": "m"}, "kg"),
    (
        cone.clutch_mass,
        {
            "mass_factor": "-",
            "area": "m2",
            "density": "kg/m3",
            "shell_thickness": "m",
            "lining_density": "kg/m3",
            "lining_thickness": "m",
        },
        "kg",
    ),
    (cone.pull_ratio, {"half_angle": "-", "static_mu": "-", "mu": "-"}, "-"),
    (cone.pull_angle, {"static_mu": "-", "mu": "-", "ratio": "-"}, "-"),
    (cone.hoop_stress, {"pressure": "Pa", "mean_diameter": "m", "shell_thickness": "m"}, "Pa"),
    (cone.axial_stroke, {"gap": "m", "wear": "m", "half_angle": "-"}, "m"),
    (cone.spring_mass, {"force": "N", "deflection": "m", "energy": "J/kg"}, "kg"),
]

# Not formulas of floats and symbols alike: inverse relations, and a table of many results (tested in test_startup).
OTHERWISE_TESTED = {
    "surface_limit_exponential",
    "surface_limit_lipka",
    "surface_limit_geometric",
    "guide_number_of_effectiveness",
    "solve_relation",
    "startup_phases",
    "cover_thickness",  # with a least one; tests/problems/disc/test_practice.py
    "cover_mass",
    "size_factor",  # with lengths of test bars; tests/problems/mechanics/test_shaft.py
}


def _ranges(units):
    if "driver_torque" in units:
        return {"torque": (3.0, 6.0), "driver_torque": (0.5, 2.0), "load_torque": (0.5, 2.0)}
    if set(START) <= set(units):
        return START_RANGES
    if {"start_gap", "waves", "inner_diameter"} & set(units):
        return RANGES | BURIED_RING | {"start_gap": (1.5, 2.0), "end_gap": (0.5, 1.0)}
    return RANGES


IDS = [f"{number}-{name_of(case[0])}" for number, case in enumerate(CASES)]


@pytest.mark.slow
@pytest.mark.parametrize(("function", "units", "result_unit"), CASES, ids=IDS)
def test_scales_as_its_unit(function, units, result_unit):
    assert_homogeneous(function, units, result_unit, _ranges(units))


@pytest.mark.parametrize(("function", "units", "result_unit"), CASES, ids=IDS)
def test_floats_arrays_and_symbols_agree(function, units, result_unit):
    assert_same_on_symbols_and_arrays(function, units, _ranges(units))


def test_no_formula_is_left_out():
    covered = {name_of(case[0]) for case in CASES} | OTHERWISE_TESTED
    # Lambdas stand for functions with several results or a free number of arguments.
    covered |= {"plate_torque", "first_phase_push_force", "constant_torque_slip"}
    for module in (ring, guide_friction, startup, heat, plates, motors, disc, cone, shaft, wear):
        public = {
            name
            for name, member in inspect.getmembers(module, inspect.isfunction)
            if member.__module__ == module.__name__ and not name.startswith("_")
        }
        assert public <= covered, public - covered
