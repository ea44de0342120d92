"""Cases of this family for ``synth.testing.FamilyTests``."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from synth.testing import Case, FamilyCases, Instance, KnownDesign

from ..cases import MAGNETS, SHAFTS, SOURCES, load_of

NAMES = Path(__file__).parent


def sound_powder_clutches(rng: np.random.Generator, instance: Instance, count: int) -> np.ndarray:
    """Variables with iron below saturation and windows that carry the current."""
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


WINDER = {"required_torque": "30 N*m"}
POWDER = "synth.problems.magnetic_powder.formulas:"
POWDER_CONSTANTS = {
    POWDER + "SHIELD_DENSITY": (1, -3, 0, 0, 0),
    POWDER + "SHIELD_THICKNESS": (0, 1, 0, 0, 0),
    POWDER + "SHAFT_ENDS": (0, 1, 0, 0, 0),
}

BUILT = KnownDesign(
    {
        "gap_radius": "77 mm",
        "pole_length": "15 mm",
        "powder_gap": "1 mm",
        "coil_length": "19 mm",
        "coil_height": "7 mm",
        "yoke_thickness": "8 mm",
        "flux_density": "0.7558659864679936 T",
        "coil": "rotating",
    },
    {},
    {"winding_wire": "Cu 0.5 class 155", "powder": "carbonyl_graphite"},
)

CASES = {
    "magnetic_powder_clutch": FamilyCases(
        option_sets={
            "default": SOURCES,
            "practice": {"practice": "on"},
            "practice_parts": {"practice": "on", "mass_scope": "parts"},
            "start": {"practice": "on", "duty": "start"},
            "coupling": {"practice": "on", "duty": "coupling"},
        },
        requirements=WINDER,
        needed={
            "duty=start": {
                "driven_inertia": "0.4 kg*m2",
                "clutch_side_inertia": "0.398 kg*m2",  # nearly all; with the optional requirements a mass is lifted
                "jerk_limit": "9000 rad/s3",
                "acceleration_limit": "90 rad/s2",
            }
        },
        optional={**load_of(30), "outer_diameter_limit": "280 mm", "length_limit": "160 mm"},
        feasible={
            "winder": Case(
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
                    "objectives": ["mass", "input_inertia"],
                },
                tighten={"required_torque": "32 N*m", "outer_diameter_limit": "250 mm", "iron_flux_limit": "1.2 T"},
            )
        },
        infeasible=Case(
            options=SOURCES,
            requirements={"required_torque": "120 N*m", "outer_diameter_limit": "160 mm"},
            settings={
                "parts": {"powder": ["carbonyl_graphite"], "winding_wire": ["Cu 0.8 class 155"]},
                "fix": {"powder_gap": "1.25 mm"},
            },
        ),
        culprits=frozenset({"torque_capacity", "outer_diameter", "rotor_bore", "powder_flux_density"}),
        names=NAMES / "names.csv",
        for_si=frozenset({"moving_heat_transfer"}),  # h_still + h_rot v**0.8, with v in m/s
        sound=sound_powder_clutches,
        constants=SHAFTS | MAGNETS | POWDER_CONSTANTS,
        designs={
            **dict.fromkeys(("practice", "start"), BUILT),
            "coupling": KnownDesign(
                {
                    "gap_radius": "75 mm",
                    "pole_length": "15 mm",
                    "powder_gap": "1 mm",
                    "coil_length": "20 mm",
                    "coil_height": "7 mm",
                    "yoke_thickness": "8.5 mm",
                    "flux_density": "0.7992066061006738 T",
                    "coil": "rotating",
                },
                {},
                {"winding_wire": "Cu 0.5 class 155", "powder": "carbonyl_graphite"},
            ),
            "practice_parts": KnownDesign(
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
    )
}
