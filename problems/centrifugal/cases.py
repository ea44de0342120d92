"""Cases of the families of this package for ``synth.testing.FamilyTests``."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from synth.testing import Case, FamilyCases, Instance, KnownDesign

from ..cases import SHAFTS, SOURCES, inertia_of, load_of

NAMES = Path(__file__).parent


def sound_flyweights(rng: np.random.Generator, instance: Instance, count: int) -> np.ndarray:
    """Variables of centrifugal clutches that touch and clamp between idle and full speed."""
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
    """Variables of levers that close the gap, with linings of a sensible ratio."""
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
DRIVE = {**load_of(60), **inertia_of(40, 0.5)}  # in other words
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
BUILT = SHAFTS | {
    "synth.problems.mechanics.centrifugal:FURTHER_PLATE": (0, 1, 0, 0, 0),
    "synth.problems.mechanics.centrifugal:FURTHER_CORE": (0, 1, 0, 0, 0),
    "synth.problems.mechanics.centrifugal:COVER": (0, 1, 0, 0, 0),
    "synth.problems.centrifugal.body:LEAST_WORK": (1, 2, -2, 0, 0),
}
BUILT_RAMPS = KnownDesign(
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
BUILT_LEVERS = KnownDesign(
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
BUILT_REVERSED = KnownDesign(
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
BUILT_TWO_SPRINGS = KnownDesign(
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
BUILT_TWO_SPRINGS_LEVER = KnownDesign(
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
    {"return_spring": "CS-2x10x12.5", "clamp_spring": "CS-2.5x12.5x5.5", "friction_pair": "metal_ceramic_bronze_dry"},
)

CASES = {
    "centrifugal_ball_ramp": FamilyCases(
        option_sets={"default": SOURCES, "practice": {"practice": "on"}},
        needed={"practice=on": {"wear_life_min": "1000", "length_limit": "200 mm", "edge_pressure_ratio": "1"}},
        constants=BUILT,
        requirements=RAMPS,
        optional={
            **load_of(60),
            **inertia_of(40, 0.5),
            "engagement_heat_limit": "0.6 J/mm2",
            "outer_diameter_limit": "200 mm",
        },
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
            )
        },
        infeasible=Case(
            options=SOURCES,
            requirements={**RAMPS, "outer_diameter_limit": "90 mm"},
            settings={
                "parts": {
                    "ball": ["ball 18", "ball 20"],
                    "return_spring": ["CS-1x5x3.5"],
                    "friction_pair": ["metal_ceramic_bronze_dry"],
                }
            },
        ),
        culprits=frozenset({"outer_diameter", "torque_at_full_speed", "pitch_circle_room", "clamp_cap"}),
        names=NAMES / "names_centrifugal_ball_ramp.csv",
        sound=sound_flyweights,
        designs={
            "practice": BUILT_RAMPS,
            "default": KnownDesign(
                {
                    "rest_radius": "54 mm",
                    "plate_gap": "2 mm",
                    "spring_preload_deflection": "2 mm",
                    "ramp_ratio": "1",
                    "lining_inner_radius": "60 mm",
                    "lining_outer_radius": "80 mm",
                },
                {"return_springs": 3, "balls": 8, "friction_surfaces": 8},
                {"ball": "ball 20", "return_spring": "CS-1.25x6.3x5.5", "friction_pair": "metal_ceramic_bronze_dry"},
            ),
        },
    ),
    "centrifugal_two_spring": FamilyCases(
        option_sets={
            "default": SOURCES,
            "lever": {**SOURCES, "mechanism": "lever"},
            "practice": {"practice": "on"},
            "practice_lever": {"practice": "on", "mechanism": "lever"},
        },
        needed={"practice=on": {"wear_life_min": "1000", "length_limit": "200 mm", "edge_pressure_ratio": "1"}},
        constants=BUILT,
        requirements=RAMPS,
        optional={
            **load_of(60),
            **inertia_of(40, 0.5),
            "engagement_heat_limit": "0.6 J/mm2",
            "outer_diameter_limit": "200 mm",
        },
        feasible={
            "balls": Case(
                options=SOURCES,
                requirements={**CAPPED, "outer_diameter_limit": "150 mm"},
                settings={
                    "parts": {"ball": ["ball 25", "ball 30"], **STIFF},
                    "limits": {"balls": "4 .. 5", "return_springs": "2 .. 3", "clamp_springs": "3 .. 4"},
                    "fix": {**TWO_SPRINGS, "clamp_preload_deflection": "1 mm"},
                    "objectives": ["outer_diameter", "engagement_band"],
                },
                tighten={"required_torque": "94 N*m", "lining_wear": "0.6 mm"},
            )
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
        names=NAMES / "names_centrifugal_two_spring.csv",
        sound=sound_flyweights,
        designs={
            "practice": BUILT_TWO_SPRINGS,
            "practice_lever": BUILT_TWO_SPRINGS_LEVER,
            "default": KnownDesign(
                {**FITTING, "rest_radius": "48 mm", "ramp_ratio": "1.2"},
                {**FITTING_COUNTS, "balls": 4},
                {**FITTING_SPRINGS, "ball": "ball 30"},
            ),
            "lever": KnownDesign(
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
    "centrifugal_lever": FamilyCases(
        option_sets={"default": SOURCES, "practice": {"practice": "on"}},
        needed={"practice=on": {"wear_life_min": "1000", "length_limit": "200 mm", "edge_pressure_ratio": "1"}},
        constants=BUILT,
        requirements=ENGINE,
        optional={
            **load_of(60),
            **inertia_of(40, 0.5),
            "engagement_heat_limit": "0.6 J/mm2",
            "outer_diameter_limit": "260 mm",
        },
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
            )
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
        names=NAMES / "names_centrifugal_lever.csv",
        sound=sound_levers,
        designs={"practice": BUILT_LEVERS},
    ),
    "centrifugal_reversed": FamilyCases(
        option_sets={"default": SOURCES, "practice": {"practice": "on"}},
        needed={"practice=on": {"wear_life_min": "1000", "length_limit": "200 mm", "edge_pressure_ratio": "1"}},
        constants=BUILT,
        requirements=ENGINE,
        optional={
            **load_of(60),
            **inertia_of(40, 0.5),
            "engagement_heat_limit": "0.6 J/mm2",
            "outer_diameter_limit": "260 mm",
        },
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
            )
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
        names=NAMES / "names_centrifugal_reversed.csv",
        sound=sound_levers,
        designs={"practice": BUILT_REVERSED},
    ),
}
