"""Cases of the families of this package for ``synth.testing.FamilyTests``."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from synth.testing import Case, FamilyCases, Instance, KnownDesign

from ..cases import SHAFTS, SOURCES, load_of

NAMES = Path(__file__).parent


def sound_springs(rng: np.random.Generator, instance: Instance, count: int) -> np.ndarray:
    """Variables with hubs above the bore, wires to suit, and fits that survive the tolerance."""
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


INDEXER = {"required_torque": "20 N*m", "bore_diameter": "12 mm"}
WIRE = {
    "wire_modulus": "206 GPa",
    "wire_density": "7850 kg/m3",
    "wire_bending_allow": "1000 N/mm2",
    "wire_tensile_strength": "1430 N/mm2",
    "wire_endurance_amplitude": "430 N/mm2",
}
HARDENED = ["hardened_steel_oil", "hardened_steel_greased", "hardened_steel_dry"]

CASES = {
    "wrap_spring": FamilyCases(
        option_sets={
            "default": SOURCES,
            "seed": {**SOURCES, "model": "seed"},
            "torque_limited": {**SOURCES, "overload": "torque_limited", "hub_ladder": "R40"},
            "custom": {**SOURCES, "wire_choice": "custom", "hub_ladder": "R20"},
            "practice": {"practice": "on"},
            "practice_custom": {"practice": "on", "wire_choice": "custom", "mass_scope": "parts"},
        },
        constants=SHAFTS,
        requirements=INDEXER,
        optional={
            **WIRE,
            **load_of(20),
            "driver_speed": "960 1/min",
            "drag_torque_limit": "8 N*m",
            "outer_diameter_limit": "90 mm",
            "length_limit": "300 mm",
            "belt_exponent_limit": "20",
        },
        needed={"wire_choice=custom": WIRE, "practice=on": {"overrun_speed": "3 1/min", "service_life": "500 h"}},
        designs={
            "practice": KnownDesign(
                {"interference": "0.7 mm", "hub_diameter": "40 mm"},
                {"coils_per_hub": 6},
                {"wire": "rect 4x2.5", "friction_pair": "hardened_steel_greased"},
            ),
            "practice_custom": KnownDesign(
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
            )
        },
        infeasible=Case(
            options=SOURCES,
            requirements={"required_torque": "200 N*m", "bore_diameter": "20 mm", "outer_diameter_limit": "32 mm"},
            settings={"parts": {"wire": ["rect 4x3", "square 4x4"], "friction_pair": ["hardened_steel_greased"]}},
        ),
        culprits=frozenset({"wire_stress", "contact_pressure", "fatigue", "hub_shear", "outer_diameter"}),
        names=NAMES / "names_wrap_spring.csv",
        sound=sound_springs,
    ),
    "wrap_spring_actuated": FamilyCases(
        option_sets={
            "default": SOURCES,
            "seed": {**SOURCES, "model": "seed", "hub_ladder": "R40"},
            "custom": {**SOURCES, "wire_choice": "custom", "hub_ladder": "R20"},
            "practice": {"practice": "on"},
            "practice_custom": {"practice": "on", "wire_choice": "custom", "mass_scope": "parts"},
        },
        constants=SHAFTS,
        requirements={**INDEXER, "relative_speed": "500 1/min"},
        optional={
            **WIRE,
            **load_of(20),
            "driver_speed": "960 1/min",
            "actuator_torque_limit": "30 N*m",
            "wrap_angle_limit": "3 rad",
            "outer_diameter_limit": "90 mm",
            "length_limit": "300 mm",
            "belt_exponent_limit": "20",
        },
        needed={"wire_choice=custom": WIRE},
        designs={
            "practice": KnownDesign(
                {"clearance": "0.085 mm", "actuator_torque": "1.95 N*m", "hub_diameter": "28 mm"},
                {"coils_per_hub": 7.5},
                {"wire": "rect 2.5x1.5", "friction_pair": "hardened_steel_oil"},
            ),
            "practice_custom": KnownDesign(
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
            )
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
        names=NAMES / "names_wrap_spring_actuated.csv",
        sound=sound_springs,
    ),
}
