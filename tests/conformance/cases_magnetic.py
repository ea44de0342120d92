"""Example data of the clutches with a coil, for the conformance suite."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from synth.question.instance import Instance

WINDER = {"required_torque": "30 N*m"}
SPINDLE = {"load_torque": "8 N*m", "driver_speed": "960 1/min", "driven_inertia": "0.05 kg*m2"}
DRUM = {**SPINDLE, "load_torque": "30 N*m"}
MAGNETICS = "synth.problems.mechanics.magnetics:"
CONSTANTS = {
    MAGNETICS + "MU_0": (1, 1, -2, 0, -2),
    MAGNETICS + "COPPER_RESISTIVITY": (1, 3, -3, 0, -2),
    MAGNETICS + "COPPER_COEFFICIENT": (0, 0, 0, -1, 0),
    MAGNETICS + "COPPER_DENSITY": (1, -3, 0, 0, 0),
    MAGNETICS + "COPPER_REFERENCE": (0, 0, 0, 1, 0),
    MAGNETICS + "UNIT_HEAT_TRANSFER": (1, 0, -3, -1, 0),
    MAGNETICS + "UNIT_SPEED": (0, 1, -1, 0, 0),
}

POWDER = "synth.problems.magnetic_powder.formulas:"
POWDER_CONSTANTS = {
    POWDER + "SHIELD_DENSITY": (1, -3, 0, 0, 0),
    POWDER + "SHIELD_THICKNESS": (0, 1, 0, 0, 0),
    POWDER + "SHAFT_ENDS": (0, 1, 0, 0, 0),
    "synth.problems.magnetic_powder.model:GRAVITY": (0, 1, -2, 0, 0),
}


def sound_powder_clutches(rng: np.random.Generator, instance: Instance, count: int) -> np.ndarray:
    """Return variables with iron below saturation and windows that carry the current."""
    ranges = {
        "gap_radius": (0.05, 0.12),
        "pole_length": (0.01, 0.03),
        "powder_gap": (0.001, 0.0015),
        "coil_length": (0.03, 0.07),
        "coil_height": (0.02, 0.05),
        "yoke_thickness": (0.012, 0.03),
        "flux_density": (0.2, 0.7),
    }
    low, high = np.array([ranges[v.name] for v in instance.model.variables]).T
    x: np.ndarray = low * (high / low) ** rng.random((count, len(low)))
    return x


def sound_electromagnetic_clutches(rng: np.random.Generator, instance: Instance, count: int) -> np.ndarray:
    """Return variables with rings of a sensible ratio and magnets that are stronger than their springs."""
    disc = any(v.name == "pressure_plate_thickness" for v in instance.model.variables)
    ranges = {
        "inner_pole_width": (0.013, 0.016),
        "coil_length": (0.02, 0.06),
        "coil_height": (0.02, 0.05),
        "yoke_thickness": (0.012, 0.03),
        "flux_density": (1.0, 1.25),
        "ramp_time": (0.05, 0.5),
        "ring_outer_diameter": (0.15, 0.21),
        "ring_inner_diameter": (0.76, 0.81) if disc else (0.6, 0.8),
        "pressure_plate_thickness": (0.004, 0.02),
    }
    names = [v.name for v in instance.model.variables]
    low, high = np.array([ranges[name] for name in names]).T
    x: np.ndarray = low * (high / low) ** rng.random((count, len(low)))
    x[:, names.index("ring_inner_diameter")] *= x[:, names.index("ring_outer_diameter")]
    return x


SOURCES = {"practice": "off"}  # the formulas of the sources alone


def magnetic(family: Callable[..., Any], case: Callable[..., Any], design: Callable[..., Any]) -> dict[str, Any]:
    """Return the entries of these families, made with the classes of the suite."""
    return {
        "magnetic_powder_clutch": family(
            option_sets={
                "default": SOURCES,
                "practice": {"practice": "on"},
                "practice_parts": {"practice": "on", "mass_scope": "parts"},
            },
            requirements=WINDER,
            optional={"outer_diameter_limit": "280 mm", "length_limit": "160 mm"},
            feasible={
                "winder": case(
                    options=SOURCES,
                    requirements={**WINDER, "outer_diameter_limit": "280 mm"},
                    settings={
                        "parts": {
                            "powder": ["carbonyl_graphite"],
                            "winding_wire": ["Cu 0.5 class 155", "Cu 1.25 class 155"],
                        },
                        "fix": {
                            "powder_gap": "1.25 mm",
                            "coil_height": "24 mm",
                            "coil_length": "50 mm",
                            "pole_length": "25 mm",
                            "yoke_thickness": "14 mm",
                        },
                        "limits": {"gap_radius": "60 mm .. 90 mm"},
                    },
                    tighten={
                        "required_torque": "32 N*m",
                        "outer_diameter_limit": "250 mm",
                        "iron_flux_limit": "1.2 T",
                    },
                ),
            },
            infeasible=case(
                options=SOURCES,
                requirements={"required_torque": "120 N*m", "outer_diameter_limit": "160 mm"},
                settings={
                    "parts": {"powder": ["carbonyl_graphite"], "winding_wire": ["Cu 0.8 class 155"]},
                    "fix": {"powder_gap": "1.25 mm"},
                },
            ),
            culprits=frozenset({"torque_capacity", "outer_diameter", "rotor_bore", "powder_flux_density"}),
            sound=sound_powder_clutches,
            constants=CONSTANTS | POWDER_CONSTANTS,
            designs={
                "practice": design(
                    {
                        "gap_radius": "95 mm",
                        "pole_length": "8 mm",
                        "powder_gap": "1.05 mm",
                        "coil_length": "22 mm",
                        "coil_height": "8 mm",
                        "yoke_thickness": "5.5 mm",
                        "flux_density": "0.9999999981967138 T",
                        "coil": "rotating",
                    },
                    {},
                    {"winding_wire": "Cu 0.63 class 155", "powder": "carbonyl_graphite"},
                ),
                "practice_parts": design(
                    {
                        "gap_radius": "104 mm",
                        "pole_length": "8 mm",
                        "powder_gap": "1 mm",
                        "coil_length": "18 mm",
                        "coil_height": "7 mm",
                        "yoke_thickness": "4.5 mm",
                        "flux_density": "0.786488973092101 T",
                        "coil": "rotating",
                    },
                    {},
                    {"winding_wire": "Cu 0.56 class 155", "powder": "carbonyl_graphite"},
                ),
            },
        ),
        "electromagnetic_clutch": family(
            option_sets={
                "default": SOURCES,
                "worst_case": {**SOURCES, "load_kind": "active", "friction_basis": "worst_case"},
                "catalogue": {**SOURCES, "spline_choice": "catalogue"},
                "disc": {**SOURCES, "pack": "disc"},
                "disc_obsolete": {**SOURCES, "pack": "disc", "friction_basis": "worst_case", "allow_obsolete": "yes"},
                "practice": {"practice": "on"},
                "practice_dry": {
                    "practice": "on",
                    "lubrication": "dry",
                    "wear_adjust": "yes",
                    "friction_basis": "worst_case",
                    "mass_scope": "parts",
                },
                "practice_disc": {"practice": "on", "pack": "disc"},
            },
            requirements=DRUM,
            optional={
                "startup_torque": "36 N*m",
                "overload_torque": "200 N*m",
                "actuation_force_limit": "5 kN",
                "outer_diameter_limit": "250 mm",
                "length_limit": "200 mm",
                "jerk_limit": "2e5 rad/s3",
                "acceleration_limit": "4000 rad/s2",
                "hub_bore_diameter": "40 mm",
                "drag_torque_limit": "5 N*m",
            },
            needed={
                "practice=on": {
                    "wear_life_min": "10000",
                    "over_excitation": "2.2",  # the coil of the known designs is 2 % too slow for 2
                    "voltage_use_min": "0.75",
                    "return_spring_force": "100 N",  # what the known designs were made for
                    "release_drag_force": "20 N",
                    "residual_gap": "0.4 mm",
                }
            },
            unknown={"pack=disc": frozenset({"hub_bore_diameter", "drag_torque_limit"})},
            feasible={
                "spindle": case(
                    requirements=SPINDLE,
                    options={**SOURCES, "pack": "disc"},
                    settings={
                        "parts": {
                            "friction_pair": ["sinter_bronze_dry"],
                            "winding_wire": ["Cu 0.5 class 155", "Cu 0.56 class 155"],
                        },
                        "fix": {
                            "ramp_time": "0.1 s",
                            "ring_outer_diameter": "112 mm",
                            "ring_inner_diameter": "88 mm",
                            "pressure_plate_thickness": "6 mm",
                            "coil_length": "30 mm",
                            "coil_height": "20 mm",
                            "yoke_thickness": "12 mm",
                        },
                        "limits": {"inner_pole_width": "12 mm .. 16 mm"},
                    },
                    tighten={
                        "load_torque": "9 N*m",
                        "pull_in_margin": "1.4",
                    },
                ),
            },
            infeasible=case(
                options=SOURCES,
                requirements={**SPINDLE, "outer_diameter_limit": "92 mm"},
                settings={
                    "parts": {
                        "friction_pair": ["steel_steel_wet"],
                        "inner_plate": ["core 1.5"],
                        "outer_plate": ["core 1.5"],
                        "winding_wire": ["Cu 0.5 class 155"],
                    },
                    "fix": {"ramp_time": "0.1 s", "coil_height": "20 mm", "yoke_thickness": "12 mm"},
                    "limits": {"friction_surfaces": "2 .. 4"},
                },
            ),
            culprits=frozenset({"torque_capacity", "outer_diameter", "pull_in", "pole_flux_density"}),
            sound=sound_electromagnetic_clutches,
            constants=CONSTANTS | {"synth.problems.mechanics.disc:COVER_LEAST": (0, 1, 0, 0, 0)},
            designs={
                "practice": design(
                    {
                        "ring_outer_diameter": "107 mm",
                        "ring_inner_diameter": "79 mm",
                        "inner_pole_width": "13 mm",
                        "coil_length": "28 mm",
                        "coil_height": "15 mm",
                        "yoke_thickness": "10.5 mm",
                        "flux_density": "1.2843021573852704 T",
                        "ramp_time": "0.08963995371559914 s",
                    },
                    {"friction_surfaces": 4},
                    {
                        "winding_wire": "Cu 0.56 class 155",
                        "friction_pair": "graphitic_wet",
                        "inner_plate": "core 1.2",
                        "outer_plate": "core 1.2",
                    },
                ),
                "practice_dry": design(
                    {
                        "ring_outer_diameter": "140 mm",
                        "ring_inner_diameter": "103 mm",
                        "inner_pole_width": "8.5 mm",
                        "coil_length": "20 mm",
                        "coil_height": "20 mm",
                        "yoke_thickness": "7 mm",
                        "flux_density": "1.26016687177699 T",
                        "ramp_time": "0.047046524339456726 s",
                    },
                    {"friction_surfaces": 2},
                    {
                        "winding_wire": "Cu 0.56 class 180",
                        "friction_pair": "metal_ceramic_bronze_dry",
                        "inner_plate": "core 1.5",
                        "outer_plate": "core 1.5",
                    },
                ),
                "practice_disc": design(
                    {
                        "ring_outer_diameter": "85 mm",
                        "ring_inner_diameter": "60 mm",
                        "pressure_plate_thickness": "4.5 mm",
                        "inner_pole_width": "14.5 mm",
                        "coil_length": "24 mm",
                        "coil_height": "14 mm",
                        "yoke_thickness": "11.5 mm",
                        "flux_density": "1.3043478231061534 T",
                        "ramp_time": "0.18106073665506733 s",
                    },
                    {"discs": 1},
                    {"winding_wire": "Cu 0.63 class 180", "friction_pair": "sinter_bronze_dry"},
                ),
            },
        ),
    }
