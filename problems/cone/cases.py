"""Cases of this family for ``synth.testing.FamilyTests``."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from synth.testing import Case, FamilyCases, Instance, KnownDesign

from ..cases import SHAFTS, SOURCES, inertia_of, power_of

NAMES = Path(__file__).parent


def sound_cones(rng: np.random.Generator, instance: Instance, count: int) -> np.ndarray:
    """Variables with cones of a sensible ratio and forces of a sensible size."""
    low, high = instance.ranges.lower, instance.ranges.upper
    x: np.ndarray = low * (high / low) ** rng.random((count, len(low)))
    names = [v.name for v in instance.model.variables]
    mean = rng.uniform(0.15, 0.45, count)
    x[:, names.index("mean_diameter")] = mean
    x[:, names.index("generator_length")] = mean * rng.uniform(0.14, 0.21, count)
    x[:, names.index("actuation_force")] = rng.uniform(2e3, 2e4, count)
    x[:, names.index("ramp_time")] = rng.uniform(0.05, 1.5, count)
    return x


CONE = {"load_torque": "200 N*m", "driver_speed": "700 rpm", "driven_inertia": "2 kg*m2"}

CASES = {
    "cone_clutch": FamilyCases(
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
        constants=SHAFTS,
        requirements=CONE,
        needed={"practice=on": {"wear_life_min": "10000", "service_life": "100 h", "edge_pressure_ratio": "1"}},
        designs={
            "practice": KnownDesign(
                {
                    "mean_diameter": "262 mm",
                    "generator_length": "47 mm",
                    "cone_half_angle": "12.5 deg",
                    "shell_thickness": "9 mm",
                    "actuation_force": "4.8 kN",
                    "ramp_time": "0.1 s",
                },
                {},
                {"friction_pair": "moulded_dry", "cone_layout": "outer_spring"},
            ),
            "practice_self": KnownDesign(
                {
                    "mean_diameter": "373 mm",
                    "generator_length": "63.5 mm",
                    "cone_half_angle": "12 deg",
                    "shell_thickness": "12.5 mm",
                    "actuation_force": "4.475 kN",
                    "ramp_time": "0.057 s",
                },
                {},
                {"friction_pair": "ci_ci_dry", "cone_layout": "outer_spring"},
            ),
        },
        optional={
            **power_of(200),
            **inertia_of(200, 2),
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
            )
        },
        infeasible=Case(
            options=SOURCES,
            requirements={**CONE, "outer_diameter_limit": "200 mm", "actuation_force_limit": "4 kN"},
            settings={"parts": {"friction_pair": ["millboard_dry", "moulded_dry"]}},
        ),
        culprits=frozenset({"torque_capacity", "outer_diameter", "actuation_force"}),
        names=NAMES / "names.csv",
        sound=sound_cones,
    )
}
