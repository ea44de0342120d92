"""Example data of the clutches with a coil, for the conformance suite."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from synth.instance import Instance

WINDER = {"required_torque": "30 N*m"}
MAGNETICS = "problems.mechanics.magnetics:"
CONSTANTS = {
    MAGNETICS + "MU_0": (1, 1, -2, 0, -2),
    MAGNETICS + "COPPER_RESISTIVITY": (1, 3, -3, 0, -2),
    MAGNETICS + "COPPER_COEFFICIENT": (0, 0, 0, -1, 0),
    MAGNETICS + "COPPER_DENSITY": (1, -3, 0, 0, 0),
    MAGNETICS + "COPPER_REFERENCE": (0, 0, 0, 1, 0),
    MAGNETICS + "UNIT_HEAT_TRANSFER": (1, 0, -3, -1, 0),
    MAGNETICS + "UNIT_SPEED": (0, 1, -1, 0, 0),
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


def magnetic(family: Callable[..., Any], case: Callable[..., Any]) -> dict[str, Any]:
    """Return the entries of these families, made with the classes of the suite."""
    return {
        "magnetic_powder_clutch": family(
            option_sets={"default": {}},
            requirements=WINDER,
            optional={"outer_diameter_limit": "280 mm", "length_limit": "160 mm"},
            feasible={
                "winder": case(
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
                requirements={"required_torque": "120 N*m", "outer_diameter_limit": "160 mm"},
                settings={
                    "parts": {"powder": ["carbonyl_graphite"], "winding_wire": ["Cu 0.8 class 155"]},
                    "fix": {"powder_gap": "1.25 mm"},
                },
            ),
            culprits=frozenset({"torque_capacity", "outer_diameter", "rotor_bore", "powder_flux_density"}),
            sound=sound_powder_clutches,
            constants=CONSTANTS,
        ),
    }
