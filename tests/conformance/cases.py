"""Example data of every family for the conformance suite: a new family adds an entry and is tested in full."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cache
from typing import Any

import numpy as np

import synth
from synth.model.problem import DesignProblem
from synth.question.catalogs import as_catalogs
from synth.question.instance import Instance
from tests.asking import instance_of
from tests.conformance.cases_magnetic import SOURCES, magnetic
from tests.repetitions import repetitions

OF_SHAFTS = {
    "synth.problems.practice:SHAFT_STEEL": (1, -1, -2, 0, 0),
    "synth.problems.mechanics.shaft:TEST_BAR": (0, 1, 0, 0, 0),
}


@dataclass(frozen=True)
class Case:
    """One question: what is asked, and the restrictions that keep it small.

    ``tighten`` holds requirements moved the hard way.
    """

    requirements: Mapping[str, Any]
    options: Mapping[str, str] = field(default_factory=dict)
    settings: Mapping[str, Any] = field(default_factory=dict)
    tighten: Mapping[str, str] = field(default_factory=dict)


@dataclass(frozen=True)
class Design:
    """Sizes, counts and parts of one design."""

    sizes: Mapping[str, str]
    counts: Mapping[str, float]
    parts: Mapping[str, str]


@dataclass(frozen=True)
class Family:
    """What the suite needs to know of a family.

    ``option_sets`` are the structures to trace, ``optional`` values for all optional requirements of the first of them.
    ``constants`` are the numbers with a unit that its formulas hold, as "module:name": exponents of kg, m, s, K, A.
    """

    option_sets: Mapping[str, Mapping[str, str]]
    requirements: Mapping[str, Any]
    optional: Mapping[str, Any]
    feasible: Mapping[str, Case]
    infeasible: Case
    culprits: frozenset[str]
    sound: Any
    needed: Mapping[str, Mapping[str, Any]] = field(default_factory=dict)  # by "option=value": what it must be told
    unknown: Mapping[str, frozenset[str]] = field(default_factory=dict)  # by "option=value": what it does not have
    constants: Mapping[str, tuple[int, ...]] = field(default_factory=dict)
    # By name of the option set: a feasible design where random parts of the catalogue hardly ever fit each other.
    designs: Mapping[str, Design] = field(default_factory=dict)


def sound_rings(rng: np.random.Generator, instance: Instance, count: int) -> np.ndarray:
    """Return variables with rings of a sensible ratio and forces of a sensible size; plates of a list have theirs."""
    low, high = instance.ranges.lower, instance.ranges.upper
    x = low * (high / low) ** rng.random((count, len(low)))
    names = [v.name for v in instance.model.variables]
    if "ring_outer_diameter" in names:
        outer = rng.uniform(0.14, 0.5, count)
        x[:, names.index("ring_outer_diameter")] = outer
        x[:, names.index("ring_inner_diameter")] = outer * rng.uniform(0.6, 0.8, count)
    x[:, names.index("actuation_force")] = rng.uniform(5e3, 5e4, count)
    x[:, names.index("ramp_time")] = rng.uniform(0.05, 4, count)
    return x


def sound_discs(rng: np.random.Generator, instance: Instance, count: int) -> np.ndarray:
    """Return variables with the narrow rings of disc clutches; facings of a list have theirs."""
    low, high = instance.ranges.lower, instance.ranges.upper
    x = low * (high / low) ** rng.random((count, len(low)))
    names = [v.name for v in instance.model.variables]
    if "ring_outer_diameter" in names:
        outer = rng.uniform(0.15, 0.4, count)
        x[:, names.index("ring_outer_diameter")] = outer
        x[:, names.index("ring_inner_diameter")] = outer * rng.uniform(0.76, 0.81, count)
    x[:, names.index("actuation_force")] = rng.uniform(1e3, 1.5e4, count)
    x[:, names.index("ramp_time")] = rng.uniform(0.05, 1.5, count)
    return x


def sound_cones(rng: np.random.Generator, instance: Instance, count: int) -> np.ndarray:
    """Return variables with cones of a sensible ratio and forces of a sensible size."""
    low, high = instance.ranges.lower, instance.ranges.upper
    x = low * (high / low) ** rng.random((count, len(low)))
    names = [v.name for v in instance.model.variables]
    mean = rng.uniform(0.15, 0.45, count)
    x[:, names.index("mean_diameter")] = mean
    x[:, names.index("generator_length")] = mean * rng.uniform(0.14, 0.21, count)
    x[:, names.index("actuation_force")] = rng.uniform(2e3, 2e4, count)
    x[:, names.index("ramp_time")] = rng.uniform(0.05, 1.5, count)
    return x


def sound_couplings(rng: np.random.Generator, instance: Instance, count: int) -> np.ndarray:
    """Return variables with clearances and rims of a sensible size, for rollers of any diameter."""
    names = [v.name for v in instance.model.variables]
    arm, capacity = rng.uniform(0.04, 0.16, count), rng.uniform(0.005, 0.012, count)
    found = {
        "arm_radius": arm,
        "offset_capacity": capacity,
        "guide_half_length": arm + capacity * rng.uniform(1.1, 1.4, count) + rng.uniform(0.003, 0.02, count),
        "contact_length": rng.uniform(0.004, 0.014, count),
        "rim": rng.uniform(0.003, 0.02, count),
    }
    return np.stack([found[name] for name in names], axis=1)


def sound_springs(rng: np.random.Generator, instance: Instance, count: int) -> np.ndarray:
    """Return variables with hubs above the bore, wires to suit, and fits that survive the tolerance."""
    ranges = {
        "interference": (0.05e-3, 0.8e-3),
        "clearance": (0.06e-3, 0.3e-3),
        "actuator_torque": (0.5, 20.0),
        "hub_diameter": (0.02, 0.05),
        "wire_thickness": (1.5e-3, 3.5e-3),
        "wire_width": (2.5e-3, 8e-3),
    }
    low, high = np.array([ranges[v.name] for v in instance.model.variables]).T
    x: np.ndarray = low * (high / low) ** rng.random((count, len(low)))
    return x


def sound_flyweights(rng: np.random.Generator, instance: Instance, count: int) -> np.ndarray:
    """Return variables of centrifugal clutches that touch and clamp between idle and full speed."""
    ranges = {
        "rest_radius": (0.06, 0.11),
        "plate_gap": (1.5e-3, 5e-3),
        "spring_preload_deflection": (1e-3, 8e-3),
        "plate_travel": (1.5e-3, 5e-3),
        "stop_travel": (12e-3, 30e-3),
        "return_preload_deflection": (2e-3, 15e-3),
        "clamp_preload_deflection": (0.5e-3, 1.4e-3),
        "flyweight_mass": (0.1, 1.0),
        "flyweight_arm": (0.03, 0.1),
        "axial_arm": (0.03, 0.1),
        "ramp_ratio": (0.5, 1.8),
        "lining_inner_radius": (0.05, 0.06),
        "lining_outer_radius": (0.07, 0.09),
    }
    low, high = np.array([ranges[v.name] for v in instance.model.variables]).T
    x: np.ndarray = low * (high / low) ** rng.random((count, len(low)))
    return x


def sound_levers(rng: np.random.Generator, instance: Instance, count: int) -> np.ndarray:
    """Return variables of levers that close the gap, with linings of a sensible ratio."""
    spring_arm, outer = rng.uniform(0.02, 0.06, count), rng.uniform(0.06, 0.12, count)
    found = {
        "flyweight_mass": rng.uniform(0.1, 2, count),
        "flyweight_arm": rng.uniform(0.02, 0.1, count),
        "rest_radius": rng.uniform(0.04, 0.12, count),
        "spring_preload_deflection": rng.uniform(0.004, 0.02, count),
        "return_preload_deflection": rng.uniform(0.002, 0.01, count),
        "lever_stop_angle": rng.uniform(0.2, 0.35, count),
        "spring_arm": spring_arm,
        "rod_arm": spring_arm * rng.uniform(0.3, 0.8, count),
        "plate_arm": rng.uniform(0.012, 0.04, count),
        "lining_outer_radius": outer,
        "lining_inner_radius": outer * rng.uniform(0.55, 0.8, count),
    }
    return np.stack([found[v.name] for v in instance.model.variables], axis=1)


HOIST = {"load_torque": "600 N*m", "driver_speed": "26.6 rad/s", "driven_inertia": "30 kg*m2"}

CAR = {"load_torque": "60 N*m", "driver_speed": "1500 rpm", "driven_inertia": "0.7 kg*m2"}
CAR_DISC = Design(
    {
        "ring_outer_diameter": "215 mm",
        "ring_inner_diameter": "145 mm",
        "pressure_plate_thickness": "11 mm",
        "actuation_force": "6.1 kN",
        "ramp_time": "0.5 s",
    },
    {"discs": 1},
    {"friction_pair": "sinter_bronze_dry"},
)
CONE = {"load_torque": "200 N*m", "driver_speed": "700 rpm", "driven_inertia": "2 kg*m2"}
MILL = {"required_torque": "300 N*m", "driver_speed": "960 rpm", "offset": "5 mm"}
MILL_COUPLING = {
    "arm_radius": "62 mm",
    "guide_half_length": "72 mm",
    "offset_capacity": "5.5 mm",
    "balance": "no",
}
INDEXER = {"required_torque": "20 N*m", "bore_diameter": "12 mm"}
WIRE = {
    "wire_modulus": "206 GPa",
    "wire_density": "7850 kg/m3",
    "wire_bending_allow": "1000 N/mm2",
    "wire_tensile_strength": "1430 N/mm2",
    "wire_endurance_amplitude": "430 N/mm2",
}
ENGINE = {
    "required_torque": "90 N*m",
    "idle_speed": "80 rad/s",
    "contact_speed_max": "135 rad/s",
    "full_torque_speed": "200 rad/s",
    "top_speed": "500 rad/s",
}
LEVERS = {
    "friction_surfaces": 2,
    "weights": 4,
    "flyweight_mass": "0.7 kg",
    "flyweight_arm": "35 mm",
    "lever_stop_angle": "0.34 rad",
    "spring_preload_deflection": "10 mm",
    "lining_inner_radius": "60 mm",
    "lining_outer_radius": "76.5 mm",
}
HARDENED = ["hardened_steel_oil", "hardened_steel_greased", "hardened_steel_dry"]

RAMPS = {**ENGINE, "required_torque": "60 N*m", "contact_speed_min": "95 rad/s"}

CAPPED = {**RAMPS, "required_torque": "90 N*m", "lining_wear": "0.4 mm", "driven_inertia": "0.1 kg*m2"}
STIFF = {
    "return_spring": ["CS-1.25x6.3x5.5"],
    "clamp_spring": ["CS-2.5x12.5x5.5", "CS-2x10x3.5"],
    "friction_pair": ["metal_ceramic_bronze_dry"],
}
TWO_SPRINGS = {
    "friction_surfaces": 8,
    "lining_inner_radius": "44 mm",
    "lining_outer_radius": "56 mm",
    "plate_travel": "1 mm",
    "return_preload_deflection": "4 mm",
}

FITTING = {
    "stop_travel": "5.4 mm",
    "lining_inner_radius": "56 mm",
    "lining_outer_radius": "74 mm",
    "plate_travel": "1 mm",
    "return_preload_deflection": "4 mm",
    "clamp_preload_deflection": "1 mm",
}
FITTING_SPRINGS = {
    "return_spring": "CS-1.25x6.3x5.5",
    "clamp_spring": "CS-2x10x3.5",
    "friction_pair": "metal_ceramic_bronze_dry",
}
FITTING_COUNTS = {"return_springs": 3, "clamp_springs": 3, "friction_surfaces": 8}

BUILT = {
    "synth.problems.mechanics.centrifugal:FURTHER_PLATE": (0, 1, 0, 0, 0),
    "synth.problems.mechanics.centrifugal:FURTHER_CORE": (0, 1, 0, 0, 0),
    "synth.problems.mechanics.centrifugal:COVER": (0, 1, 0, 0, 0),
    "synth.problems.centrifugal.body:LEAST_WORK": (1, 2, -2, 0, 0),
}

BUILT_RAMPS = Design(
    {
        "rest_radius": "51 mm",
        "plate_gap": "3.52 mm",
        "spring_preload_deflection": "5.5 mm",
        "ramp_ratio": "0.41275",
        "lining_inner_radius": "72 mm",
        "lining_outer_radius": "90 mm",
    },
    {"balls": 4, "return_springs": 7, "friction_surfaces": 4},
    {"ball": "ball 38", "return_spring": "CS-1.6x12.5x12.5", "friction_pair": "metal_ceramic_bronze_dry"},
)

BUILT_LEVERS = Design(
    {
        "flyweight_mass": "0.33897 kg",
        "flyweight_arm": "25.5 mm",
        "rest_radius": "45 mm",
        "spring_preload_deflection": "6.1 mm",
        "lever_stop_angle": "0.3429 rad",
        "spring_arm": "14 mm",
        "rod_arm": "10.5 mm",
        "lining_inner_radius": "50.5 mm",
        "lining_outer_radius": "63.5 mm",
    },
    {"weights": 6, "clamp_springs": 7, "friction_surfaces": 4},
    {"clamp_spring": "CS-2.5x12.5x8.5", "friction_pair": "metal_ceramic_bronze_dry"},
)

BUILT_REVERSED = Design(
    {
        "flyweight_mass": "0.36403 kg",
        "flyweight_arm": "24.5 mm",
        "rest_radius": "42 mm",
        "spring_preload_deflection": "18 mm",
        "lever_stop_angle": "0.3452 rad",
        "plate_arm": "10.5 mm",
        "return_preload_deflection": "17.1 mm",
        "lining_inner_radius": "47.5 mm",
        "lining_outer_radius": "60 mm",
    },
    {"weights": 6, "clamp_springs": 3, "return_springs": 3, "friction_surfaces": 4},
    {"clamp_spring": "CS-3.2x16x8.5", "return_spring": "CS-2.5x20x8.5", "friction_pair": "metal_ceramic_bronze_dry"},
)

BUILT_SPRINGS = {"return_springs": 3, "friction_surfaces": 4}

BUILT_TWO_SPRINGS = Design(
    {
        "rest_radius": "36 mm",
        "plate_travel": "1.2 mm",
        "stop_travel": "9.2 mm",
        "return_preload_deflection": "11.5 mm",
        "clamp_preload_deflection": "2 mm",
        "ramp_ratio": "1.413",
        "lining_inner_radius": "52.5 mm",
        "lining_outer_radius": "66 mm",
    },
    {**BUILT_SPRINGS, "clamp_springs": 3, "balls": 4},
    {
        "ball": "ball 30",
        "return_spring": "CS-1x5x12.5",
        "clamp_spring": "CS-2.5x12.5x5.5",
        "friction_pair": "metal_ceramic_bronze_dry",
    },
)

BUILT_TWO_SPRINGS_LEVER = Design(
    {
        "rest_radius": "32 mm",
        "plate_travel": "1.2 mm",
        "stop_travel": "5.4 mm",
        "return_preload_deflection": "15.2 mm",
        "clamp_preload_deflection": "2 mm",
        "flyweight_mass": "0.756 kg",
        "flyweight_arm": "73.5 mm",
        "axial_arm": "46.5 mm",
        "lining_inner_radius": "39.5 mm",
        "lining_outer_radius": "54 mm",
    },
    {**BUILT_SPRINGS, "clamp_springs": 8, "weights": 6},
    {
        "return_spring": "CS-2x10x12.5",
        "clamp_spring": "CS-2.5x12.5x5.5",
        "friction_pair": "metal_ceramic_bronze_dry",
    },
)

CASES: dict[str, Family] = {
    "centrifugal_ball_ramp": Family(
        option_sets={"default": SOURCES, "practice": {"practice": "on"}},
        needed={"practice=on": {"wear_life_min": "1000", "length_limit": "200 mm"}},
        constants=BUILT,
        requirements=RAMPS,
        optional={"engagement_heat_limit": "0.6 J/mm2", "outer_diameter_limit": "200 mm"},
        feasible={
            "engine": Case(
                options=SOURCES,
                requirements={
                    **RAMPS,
                    "clamp_force_limit": "20 kN",
                    "driven_inertia": "0.1 kg*m2",
                    "outer_diameter_limit": "125 mm",
                },
                settings={
                    "parts": {
                        "ball": ["ball 18", "ball 20"],
                        "return_spring": ["CS-1x5x3.5", "CS-1.25x6.3x5.5"],
                        "friction_pair": ["metal_ceramic_bronze_dry"],
                    },
                    "limits": {"balls": "9 .. 11", "return_springs": "2 .. 3"},
                    "fix": {
                        "lining_inner_radius": "36 mm",
                        "lining_outer_radius": "46 mm",
                        "friction_surfaces": 8,
                        "plate_gap": "2 mm",
                    },
                    "objectives": ["outer_diameter", "engagement_band"],
                },
                tighten={"required_torque": "65 N*m", "idle_margin_min": "1.2"},
            ),
        },
        infeasible=Case(
            options=SOURCES,
            requirements={**RAMPS, "outer_diameter_limit": "90 mm"},
            settings={
                "parts": {
                    "ball": ["ball 18", "ball 20"],
                    "return_spring": ["CS-1x5x3.5"],
                    "friction_pair": ["metal_ceramic_bronze_dry"],
                },
            },
        ),
        culprits=frozenset({"outer_diameter", "torque_at_full_speed", "pitch_circle_room", "clamp_cap"}),
        sound=sound_flyweights,
        designs={
            "practice": BUILT_RAMPS,
            "default": Design(
                {
                    "rest_radius": "54 mm",
                    "plate_gap": "2 mm",
                    "spring_preload_deflection": "2 mm",
                    "ramp_ratio": "1",
                    "lining_inner_radius": "60 mm",
                    "lining_outer_radius": "80 mm",
                },
                {"return_springs": 3, "balls": 8, "friction_surfaces": 8},
                {
                    "ball": "ball 20",
                    "return_spring": "CS-1.25x6.3x5.5",
                    "friction_pair": "metal_ceramic_bronze_dry",
                },
            ),
        },
    ),
    "disc_clutch": Family(
        option_sets={
            "default": SOURCES,
            "active": {**SOURCES, "load_kind": "active", "cooling": "fan"},
            "worst_case": {**SOURCES, "friction_basis": "worst_case", "allow_obsolete": "yes"},
            "practice": {"practice": "on"},
            "practice_worst_case": {"practice": "on", "friction_basis": "worst_case", "mass_scope": "parts"},
            "practice_standard": {"plates": "standard", "practice": "on"},
        },
        requirements=CAR,
        needed={"practice=on": {"wear_life_min": "10000", "top_speed": "6000 1/min"}},
        constants={"synth.problems.mechanics.disc:COVER_LEAST": (0, 1, 0, 0, 0)},
        designs=dict.fromkeys(("practice", "practice_worst_case"), CAR_DISC)
        | {
            "practice_standard": Design(
                {"pressure_plate_thickness": "11 mm", "actuation_force": "6.1 kN", "ramp_time": "0.5 s"},
                {"discs": 1},
                {"friction_pair": "sinter_bronze_dry", "facing_set": "facing 215x150"},
            )
        },
        optional={
            "startup_torque": "120 N*m",
            "overload_torque": "600 N*m",
            "actuation_force_limit": "8 kN",
            "outer_diameter_limit": "400 mm",
            "length_limit": "80 mm",
            "jerk_limit": "2000 rad/s3",
            "acceleration_limit": "400 rad/s2",
        },
        feasible={
            "car": Case(
                options=SOURCES,
                requirements={
                    **CAR,
                    "safety_factor": 2.5,
                    "engagements_per_hour": 20,
                    "startup_torque": "120 N*m",
                    "jerk_limit": "300 rad/s3",
                    "outer_diameter_limit": "240 mm",
                },
                settings={"parts": {"friction_pair": ["wound_yarn_dry", "moulded_dry"]}},
                tighten={
                    "load_torque": "64 N*m",
                    "outer_diameter_limit": "215 mm",
                    "temperature_rise_limit": "60 K",
                },
            ),
        },
        infeasible=Case(
            options=SOURCES,
            requirements={
                **CAR,
                "safety_factor": 2.5,
                "outer_diameter_limit": "150 mm",
                "actuation_force_limit": "1500 N",
            },
            settings={"parts": {"friction_pair": ["woven_dry", "moulded_dry"]}},
        ),
        culprits=frozenset({"torque_capacity", "worn_torque_capacity", "outer_diameter", "actuation_force"}),
        sound=sound_discs,
    ),
    "centrifugal_two_spring": Family(
        option_sets={
            "default": SOURCES,
            "lever": {**SOURCES, "mechanism": "lever"},
            "practice": {"practice": "on"},
            "practice_lever": {"practice": "on", "mechanism": "lever"},
        },
        needed={"practice=on": {"wear_life_min": "1000", "length_limit": "200 mm"}},
        constants=BUILT,
        requirements=RAMPS,
        optional={"engagement_heat_limit": "0.6 J/mm2", "outer_diameter_limit": "200 mm"},
        feasible={
            "balls": Case(
                options=SOURCES,
                requirements={
                    **CAPPED,
                    "outer_diameter_limit": "150 mm",
                },
                settings={
                    "parts": {"ball": ["ball 25", "ball 30"], **STIFF},
                    "limits": {"balls": "4 .. 5", "return_springs": "2 .. 3", "clamp_springs": "3 .. 4"},
                    "fix": {**TWO_SPRINGS, "clamp_preload_deflection": "1 mm"},
                    "objectives": ["outer_diameter", "engagement_band"],
                },
                tighten={"required_torque": "94 N*m", "lining_wear": "0.6 mm"},
            ),
        },
        infeasible=Case(
            options=SOURCES,
            requirements={**CAPPED, "outer_diameter_limit": "90 mm"},
            settings={
                "parts": {"ball": ["ball 25", "ball 30"], **STIFF},
                "limits": {"balls": "4 .. 5", "return_springs": "2 .. 3", "clamp_springs": "3 .. 4"},
                "fix": {**TWO_SPRINGS, "lining_inner_radius": "30 mm", "lining_outer_radius": "40 mm"},
            },
        ),
        culprits=frozenset({"outer_diameter", "torque_worn", "pitch_circle_room", "full_clamp_speed"}),
        sound=sound_flyweights,
        designs={
            "practice": BUILT_TWO_SPRINGS,
            "practice_lever": BUILT_TWO_SPRINGS_LEVER,
            "default": Design(
                {**FITTING, "rest_radius": "48 mm", "ramp_ratio": "1.2"},
                {**FITTING_COUNTS, "balls": 4},
                {**FITTING_SPRINGS, "ball": "ball 30"},
            ),
            "lever": Design(
                {
                    **FITTING,
                    "rest_radius": "36 mm",
                    "flyweight_mass": "0.18 kg",
                    "flyweight_arm": "80 mm",
                    "axial_arm": "30 mm",
                },
                {**FITTING_COUNTS, "weights": 3},
                FITTING_SPRINGS,
            ),
        },
    ),
    "cone_clutch": Family(
        option_sets={
            "default": SOURCES,
            "active": {**SOURCES, "load_kind": "active"},
            "worst_case": {
                **SOURCES,
                "friction_basis": "worst_case",
                "cooling": "through_oil",
                "allow_obsolete": "yes",
            },
            "practice": {"practice": "on"},
            "practice_self": {
                "practice": "on",
                "cone_release": "self",
                "friction_basis": "worst_case",
                "mass_scope": "parts",
            },
        },
        requirements=CONE,
        needed={"practice=on": {"wear_life_min": "10000"}},
        designs={
            "practice": Design(
                {
                    "mean_diameter": "262 mm",
                    "generator_length": "47 mm",
                    "cone_half_angle": "12.5 deg",
                    "shell_thickness": "9 mm",
                    "actuation_force": "4.8 kN",
                    "ramp_time": "0.06 s",
                },
                {},
                {"friction_pair": "moulded_dry", "cone_layout": "outer_spring"},
            ),
            "practice_self": Design(
                {
                    "mean_diameter": "386 mm",
                    "generator_length": "60 mm",
                    "cone_half_angle": "12 deg",
                    "shell_thickness": "13 mm",
                    "actuation_force": "4.4 kN",
                    "ramp_time": "0.06 s",
                },
                {},
                {"friction_pair": "ci_ci_dry", "cone_layout": "outer_spring"},
            ),
        },
        optional={
            "startup_torque": "340 N*m",
            "overload_torque": "2000 N*m",
            "actuation_force_limit": "30 kN",
            "outer_diameter_limit": "500 mm",
            "length_limit": "150 mm",
            "jerk_limit": "3000 rad/s3",
            "acceleration_limit": "150 rad/s2",
            "bearing_force_limit": "20 kN",
        },
        feasible={
            "inner": Case(
                requirements={
                    **CONE,
                    "engagements_per_hour": 20,
                    "overload_torque": "1200 N*m",
                    "bearing_force_limit": "1 kN",
                    "length_limit": "92 mm",
                },
                options={**SOURCES, "friction_basis": "worst_case"},
                settings={
                    "parts": {"friction_pair": ["millboard_dry", "woven_dry"]},
                    "limits": {"outer_diameter": "<= 420 mm"},
                    "fix": {"ramp_time": "0.5 s"},
                },
                tighten={"overload_torque": "1100 N*m", "length_limit": "88 mm"},
            ),
        },
        infeasible=Case(
            options=SOURCES,
            requirements={**CONE, "outer_diameter_limit": "200 mm", "actuation_force_limit": "4 kN"},
            settings={"parts": {"friction_pair": ["millboard_dry", "moulded_dry"]}},
        ),
        culprits=frozenset({"torque_capacity", "outer_diameter", "actuation_force"}),
        sound=sound_cones,
    ),
    "centrifugal_lever": Family(
        option_sets={"default": SOURCES, "practice": {"practice": "on"}},
        needed={"practice=on": {"wear_life_min": "1000", "length_limit": "200 mm"}},
        constants=BUILT,
        requirements=ENGINE,
        optional={"engagement_heat_limit": "0.6 J/mm2", "outer_diameter_limit": "260 mm"},
        feasible={
            "engine": Case(
                options=SOURCES,
                requirements=ENGINE,
                settings={
                    "parts": {"clamp_spring": ["CS-3.2x16x12.5", "CS-4x20x12.5"], "friction_pair": ["moulded_dry"]},
                    "limits": {"clamp_springs": "7 .. 8", "outer_diameter": "<= 200 mm"},
                    "fix": {**LEVERS, "rod_arm": "11 mm"},
                    "objectives": ["outer_diameter", "engagement_band"],
                    "points": 2,
                },
                tighten={"hub_radius": "21 mm"},
            ),
        },
        infeasible=Case(
            options=SOURCES,
            requirements={**ENGINE, "outer_diameter_limit": "140 mm"},
            settings={
                "parts": {"clamp_spring": ["CS-4x20x12.5"], "friction_pair": ["moulded_dry"]},
                "fix": {**LEVERS, "rod_arm": "11 mm", "clamp_springs": 8},
            },
        ),
        culprits=frozenset({"outer_diameter"}),
        sound=sound_levers,
        designs={"practice": BUILT_LEVERS},
    ),
    "centrifugal_reversed": Family(
        option_sets={"default": SOURCES, "practice": {"practice": "on"}},
        needed={"practice=on": {"wear_life_min": "1000", "length_limit": "200 mm"}},
        constants=BUILT,
        requirements=ENGINE,
        optional={"engagement_heat_limit": "0.6 J/mm2", "outer_diameter_limit": "260 mm"},
        feasible={
            "engine": Case(
                options=SOURCES,
                requirements=ENGINE,
                settings={
                    "parts": {
                        "clamp_spring": ["CS-5x25x5.5"],
                        "return_spring": ["CS-3.2x16x3.5", "CS-2.5x12.5x3.5"],
                        "friction_pair": ["moulded_dry"],
                    },
                    "limits": {"return_springs": "5 .. 7", "outer_diameter": "<= 260 mm"},
                    "fix": {
                        **LEVERS,
                        "flyweight_mass": "1.1 kg",
                        "flyweight_arm": "40 mm",
                        "spring_preload_deflection": "16 mm",
                        "plate_arm": "12 mm",
                        "return_preload_deflection": "6 mm",
                        "clamp_springs": 6,
                    },
                    "objectives": ["outer_diameter", "engagement_band"],
                    "points": 2,
                },
                tighten={"hub_radius": "21 mm"},
            ),
        },
        infeasible=Case(
            options=SOURCES,
            requirements={**ENGINE, "outer_diameter_limit": "140 mm"},
            settings={
                "parts": {
                    "clamp_spring": ["CS-4x20x8.5"],
                    "return_spring": ["CS-3.2x16x3.5"],
                    "friction_pair": ["moulded_dry"],
                },
                "fix": {**LEVERS, "plate_arm": "12 mm", "clamp_springs": 6, "return_springs": 6},
            },
        ),
        culprits=frozenset({"outer_diameter"}),
        sound=sound_levers,
        designs={"practice": BUILT_REVERSED},
    ),
    "multi_plate_clutch": Family(
        option_sets={
            "default": SOURCES,
            "exponential_form": {**SOURCES, "guide_series": "exponential_form"},
            "lipka": {**SOURCES, "guide_series": "lipka"},
            "exponential_K": {**SOURCES, "guide_series": "exponential_K"},
            "exact": {**SOURCES, "guide_series": "exact"},
            "cz": {**SOURCES, "guide_model": "cz"},
            "active": {**SOURCES, "load_kind": "active"},
            "worst_case": {**SOURCES, "friction_basis": "worst_case"},
            "catalogue": {**SOURCES, "spline_choice": "catalogue"},
            "dry": {**SOURCES, "lubrication": "dry", "cooling": "fan"},
            "forced_oil": {
                **SOURCES,
                "cooling": "through_oil",
                "release_aid": "wavy_rings",
                "shaft_position": "vertical",
            },
            "obsolete": {**SOURCES, "allow_obsolete": "yes", "release_aid": "sine_plates"},
            "practice": {"practice": "on"},
            "practice_dry": {"practice": "on", "lubrication": "dry", "mass_scope": "parts"},
            "practice_catalogue": {
                "practice": "on",
                "spline_choice": "catalogue",
                "actuator": "external",
                "friction_basis": "worst_case",
            },
            "standard": {**SOURCES, "plates": "standard"},
            "practice_standard": {"plates": "standard", "practice": "on"},
        },
        requirements=HOIST,
        optional={
            "startup_torque": "1080 N*m",
            "overload_torque": "4000 N*m",
            "actuation_force_limit": "60 kN",
            "outer_diameter_limit": "400 mm",
            "length_limit": "200 mm",
            "jerk_limit": "60 rad/s3",
            "acceleration_limit": "40 rad/s2",
            "hub_bore_diameter": "60 mm",
            "drag_torque_limit": "20 N*m",
        },
        needed={"practice=on": {"wear_life_min": "20000", "plate_gap": "0.4 mm"}},
        designs={
            "practice": Design(
                {
                    "ring_outer_diameter": "160 mm",
                    "ring_inner_diameter": "118 mm",
                    "actuation_force": "13.55 kN",
                    "ramp_time": "0.7 s",
                },
                {"friction_surfaces": 12},
                {"friction_pair": "paper_wet", "inner_plate": "core 2", "outer_plate": "core 1.6"},
            ),
            "practice_dry": Design(
                {
                    "ring_outer_diameter": "256 mm",
                    "ring_inner_diameter": "188 mm",
                    "actuation_force": "13.035 kN",
                    "ramp_time": "0.7 s",
                },
                {"friction_surfaces": 2},
                {"friction_pair": "metal_ceramic_bronze_dry", "inner_plate": "core 3", "outer_plate": "core 3"},
            ),
            "standard": Design(
                {"actuation_force": "20 kN", "ramp_time": "0.7 s"},
                {"friction_surfaces": 10},
                {"friction_pair": "graphitic_wet", "plate_set": "set 160x236 core 2.5 lining 0.5"},
            ),
            "practice_standard": Design(
                {"actuation_force": "20 kN", "ramp_time": "0.7 s"},
                {"friction_surfaces": 10},
                {"friction_pair": "graphitic_wet", "plate_set": "set 160x236 core 2.5 lining 0.5"},
            ),
            "practice_catalogue": Design(
                {
                    "ring_outer_diameter": "170 mm",
                    "ring_inner_diameter": "125 mm",
                    "actuation_force": "26.6 kN",
                    "ramp_time": "0.7 s",
                },
                {"friction_surfaces": 6},
                {
                    "friction_pair": "graphitic_wet",
                    "inner_plate": "core 2.5",
                    "outer_plate": "core 3.5",
                    "inner_spline": "DIN5464 20x112x125",
                },
            ),
        },
        feasible={
            "hoist": Case(
                options=SOURCES,
                requirements={**HOIST, "outer_diameter_limit": "330 mm", "jerk_limit": "18 rad/s3"},
                settings={
                    "parts": {
                        "friction_pair": ["paper_wet", "sinter_bronze_wet"],
                        "inner_plate": ["core 2"],
                        "outer_plate": ["core 1.5", "core 2"],
                    },
                    "limits": {"friction_surfaces": "12 .. 16"},
                    "fix": {"ramp_time": "2 s"},
                },
                tighten={
                    "load_torque": "620 N*m",
                    "outer_diameter_limit": "215 mm",
                    "safety_factor": "1.6",
                    "lug_pressure_limit": "12 N/mm2",
                },
            ),
            "dry_drive": Case(
                requirements={
                    "load_torque": "120 N*m",
                    "driver_speed": "960 rpm",
                    "driven_inertia": "0.8 kg*m2",
                    "actuation_force_limit": "6 kN",
                    "hub_bore_diameter": "50 mm",
                },
                options={**SOURCES, "lubrication": "dry", "friction_basis": "worst_case"},
                settings={
                    "parts": {
                        "friction_pair": ["sinter_bronze_dry", "sinter_iron_dry"],
                        "inner_plate": ["core 2"],
                        "outer_plate": ["core 2", "core 3"],
                    },
                    "limits": {"friction_surfaces": "6 .. 8", "outer_diameter": "<= 400 mm"},
                    "fix": {"ramp_time": "0.3 s"},
                },
                tighten={
                    "load_torque": "125 N*m",
                    "actuation_force_limit": "5 kN",
                    "hub_bore_diameter": "70 mm",
                },
            ),
        },
        infeasible=Case(
            options=SOURCES,
            requirements={**HOIST, "outer_diameter_limit": "150 mm", "actuation_force_limit": "9 kN"},
            settings={
                "parts": {"friction_pair": ["paper_wet"], "inner_plate": ["core 2"], "outer_plate": ["core 2"]},
                "limits": {"friction_surfaces": "2 .. 8"},
            },
        ),
        culprits=frozenset({"torque_capacity", "outer_diameter", "actuation_force", "lug_pressure_outer"}),
        sound=sound_rings,
    ),
    "roller_coupling": Family(
        option_sets={
            "default": SOURCES,
            "sideways": {**SOURCES, "sideways_removable": "yes"},
            "crowned": {**SOURCES, "roller_contact": "crowned"},
            "practice": {"practice": "on"},
            "practice_ball_bearings": {
                "practice": "on",
                "roller_kind": "any",
                "roller_contact": "line",
                "mass_scope": "parts",
            },
            "practice_any": {"practice": "on", "roller_kind": "any"},
        },
        requirements=MILL,
        designs={
            "practice": Design(
                {**MILL_COUPLING, "rim": "8 mm", "contact_length": "10 mm"},
                {},
                {"roller": "NATR 15", "float_material": "100Cr6"},
            ),
            "practice_any": Design(
                {**MILL_COUPLING, "rim": "9 mm", "contact_length": "9 mm"},
                {},
                {"roller": "6203", "float_material": "100Cr6"},
            ),
            "practice_ball_bearings": Design(
                {**MILL_COUPLING, "rim": "9 mm", "contact_length": "9 mm"},
                {},
                {"roller": "6203", "float_material": "100Cr6"},
            ),
        },
        optional={"outer_diameter_limit": "400 mm", "mass_limit": "40 kg", "vibration_limit": "2 kN"},
        feasible={
            "mill": Case(
                options=SOURCES,
                requirements={**MILL, "outer_diameter_limit": "260 mm"},
                settings={
                    "parts": {
                        "roller": ["6203", "6204", "6303"],
                        "float_material": ["100Cr6", "EN AW-7075-T6"],
                    },
                },
                tighten={
                    "required_torque": "320 N*m",
                    "offset": "7 mm",
                    "pin_shear_limit": "36 N/mm2",
                },
            ),
            "angled_fan": Case(
                requirements={
                    "required_torque": "120 N*m",
                    "driver_speed": "2880 rpm",
                    "offset": "2 mm",
                    "shaft_angle": "1.5 deg",
                    "float_distance": "100 mm",
                    "guide_angle": "75 deg",
                    "vibration_limit": "60 N",
                },
                options={**SOURCES, "roller_contact": "crowned"},
                settings={
                    "parts": {
                        "roller": ["NATV 12", "NATR 12", "NATV 15"],
                        "float_material": ["100Cr6", "Ti-6Al-4V"],
                    },
                    "objectives": ["outer_diameter", "pin_force"],
                },
                tighten={
                    "required_torque": "130 N*m",
                    "vibration_limit": "20 N",
                },
            ),
        },
        infeasible=Case(
            options=SOURCES,
            requirements={**MILL, "outer_diameter_limit": "115 mm"},
            settings={"parts": {"roller": ["6203", "6204"], "float_material": ["100Cr6", "PA6-G (cast)"]}},
        ),
        culprits=frozenset({"outer_diameter", "pin_shear", "hertz", "roller_gap", "run_in"}),
        sound=sound_couplings,
    ),
    "wrap_spring": Family(
        option_sets={
            "default": SOURCES,
            "seed": {**SOURCES, "model": "seed"},
            "torque_limited": {**SOURCES, "overload": "torque_limited", "hub_ladder": "R40"},
            "custom": {**SOURCES, "wire_choice": "custom", "hub_ladder": "R20"},
            "practice": {"practice": "on"},
            "practice_custom": {"practice": "on", "wire_choice": "custom", "mass_scope": "parts"},
        },
        requirements=INDEXER,
        optional={
            **WIRE,
            "drag_torque_limit": "8 N*m",
            "outer_diameter_limit": "90 mm",
            "length_limit": "300 mm",
            "belt_exponent_limit": "20",
        },
        needed={"wire_choice=custom": WIRE, "practice=on": {"overrun_speed": "3 1/min"}},
        designs={
            "practice": Design(
                {"interference": "0.7 mm", "hub_diameter": "40 mm"},
                {"coils_per_hub": 6},
                {"wire": "rect 4x2.5", "friction_pair": "hardened_steel_greased"},
            ),
            "practice_custom": Design(
                {"interference": "0.7 mm", "hub_diameter": "40 mm", "wire_thickness": "2.5 mm", "wire_width": "4 mm"},
                {"coils_per_hub": 6},
                {"friction_pair": "hardened_steel_greased"},
            ),
        },
        feasible={
            "indexer": Case(
                options=SOURCES,
                requirements={"required_torque": "50 N*m", "bore_diameter": "20 mm", "belt_exponent_limit": "6"},
                settings={
                    "parts": {"wire": ["rect 4x3", "rect 5x3", "square 4x4"], "friction_pair": HARDENED},
                    "limits": {"coils_per_hub": "3 .. 8"},
                },
                tighten={
                    "required_torque": "55 N*m",
                    "hub_shear_limit": "60 N/mm2",
                    "interference_tolerance": "0.06 mm",
                },
            ),
        },
        infeasible=Case(
            options=SOURCES,
            requirements={"required_torque": "200 N*m", "bore_diameter": "20 mm", "outer_diameter_limit": "32 mm"},
            settings={"parts": {"wire": ["rect 4x3", "square 4x4"], "friction_pair": ["hardened_steel_greased"]}},
        ),
        culprits=frozenset({"wire_stress", "contact_pressure", "fatigue", "hub_shear", "outer_diameter"}),
        sound=sound_springs,
    ),
    "wrap_spring_actuated": Family(
        option_sets={
            "default": SOURCES,
            "seed": {**SOURCES, "model": "seed", "hub_ladder": "R40"},
            "custom": {**SOURCES, "wire_choice": "custom", "hub_ladder": "R20"},
            "practice": {"practice": "on"},
            "practice_custom": {"practice": "on", "wire_choice": "custom", "mass_scope": "parts"},
        },
        requirements={**INDEXER, "relative_speed": "500 1/min"},
        optional={
            **WIRE,
            "actuator_torque_limit": "30 N*m",
            "wrap_angle_limit": "3 rad",
            "outer_diameter_limit": "90 mm",
            "length_limit": "300 mm",
            "belt_exponent_limit": "20",
        },
        needed={"wire_choice=custom": WIRE},
        designs={
            "practice": Design(
                {"clearance": "0.085 mm", "actuator_torque": "1.95 N*m", "hub_diameter": "28 mm"},
                {"coils_per_hub": 7.5},
                {"wire": "rect 2.5x1.5", "friction_pair": "hardened_steel_oil"},
            ),
            "practice_custom": Design(
                {
                    "clearance": "0.085 mm",
                    "actuator_torque": "1.95 N*m",
                    "hub_diameter": "28 mm",
                    "wire_thickness": "1.5 mm",
                    "wire_width": "2.5 mm",
                },
                {"coils_per_hub": 7.5},
                {"friction_pair": "hardened_steel_oil"},
            ),
        },
        feasible={
            "indexer": Case(
                options=SOURCES,
                requirements={
                    "required_torque": "50 N*m",
                    "bore_diameter": "20 mm",
                    "relative_speed": "500 1/min",
                    "spring_speed": "3000 1/min",
                    "actuator_torque_limit": "15 N*m",
                },
                settings={
                    "parts": {"wire": ["rect 4x3", "rect 5x3", "rect 4x2"], "friction_pair": HARDENED},
                    "limits": {"coils_per_hub": "3 .. 8"},
                },
                tighten={
                    "required_torque": "55 N*m",
                    "clearance_min": "0.15 mm",
                    "hub_wall_min": "5 mm",
                    "actuator_torque_limit": "5 N*m",
                },
            ),
        },
        infeasible=Case(
            options=SOURCES,
            requirements={
                "required_torque": "200 N*m",
                "bore_diameter": "20 mm",
                "relative_speed": "500 1/min",
                "outer_diameter_limit": "34 mm",
            },
            settings={"parts": {"wire": ["rect 4x3", "square 4x4"], "friction_pair": ["hardened_steel_greased"]}},
        ),
        culprits=frozenset({"wire_stress", "contact_pressure", "hub_bore", "outer_diameter"}),
        sound=sound_springs,
    ),
}
CASES |= magnetic(Family, Case, Design)


# Family, option set, and whether optional requirements are given; of most sets the models with all of them say it all.
STRUCTURES = [
    (family, name, optional)
    for family, data in CASES.items()
    for number, name in enumerate(data.option_sets)
    for optional in (False, True)
    if optional or number < repetitions(1, len(data.option_sets))
]


def question(family: str, options: Mapping[str, str], optional: bool, **settings: Any) -> Instance:
    """Return a question to the whole catalogue, with or without the optional requirements; it is asked once."""
    if settings:
        return question_to(synth.load(family, **options), options, optional, **settings)
    return _asked_once(family, tuple(options.items()), optional)


@cache
def _asked_once(family: str, options: tuple[tuple[str, str], ...], optional: bool) -> Instance:
    return question_to(synth.load(family, **dict(options)), dict(options), optional)


def question_to(problem: DesignProblem, options: Mapping[str, str], optional: bool, **settings: Any) -> Instance:
    """Return a question to a problem that is given."""
    data = CASES[problem.name]
    requirements = {**data.requirements, **(data.optional if optional else {})}
    for option, value in options.items():
        requirements |= data.needed.get(f"{option}={value}", {})
        absent = data.unknown.get(f"{option}={value}", frozenset())
        requirements = {name: given for name, given in requirements.items() if name not in absent}
    return instance_of(problem, requirements, as_catalogs(None), **settings)


def known_design(family: str, name: str, optional: bool) -> tuple[np.ndarray, list[np.ndarray]] | None:
    """Return variables and data of the design that is known of an option set, twice, or None."""
    design = CASES[family].designs.get(name)
    if design is None:
        return None
    instance = question(
        family,
        CASES[family].option_sets[name],
        optional,
        fix={**design.sizes, **design.counts},
        parts={slot: [row] for slot, row in design.parts.items()},
    )
    data = [np.broadcast_to(np.asarray(x, dtype=float), (2,)) for x in instance.data(np.zeros(2, dtype=int))]
    return np.tile(instance.ranges.lower, (2, 1)), data


def answer(family: str, case: Case, **more: Any) -> synth.ParetoFront:
    """Return the front of a case; a guard on the time shows a search that does not end."""
    requirements = {**case.requirements, **more.pop("requirements", {})}
    settings = {"points": 4, "time_limit": 60, **case.settings, **more}
    return synth.synthesize(synth.load(family, **case.options), requirements, **settings)


@cache
def front_of(family: str, name: str) -> synth.ParetoFront:
    """Return the front of a feasible case: one for all tests, which only read it."""
    return answer(family, CASES[family].feasible[name])
