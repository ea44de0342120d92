"""Cases of this family for ``synth.testing.FamilyTests``."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from synth.testing import Case, FamilyCases, Instance, KnownDesign

from ..cases import COVER, SHAFTS, SOURCES, inertia_of, power_of

NAMES = Path(__file__).parent


def sound_discs(rng: np.random.Generator, instance: Instance, count: int) -> np.ndarray:
    """Variables with the narrow rings of disc clutches; facings of a list have theirs."""
    low, high = instance.ranges.lower, instance.ranges.upper
    x: np.ndarray = low * (high / low) ** rng.random((count, len(low)))
    names = [v.name for v in instance.model.variables]
    if "ring_outer_diameter" in names:
        outer = rng.uniform(0.15, 0.4, count)
        x[:, names.index("ring_outer_diameter")] = outer
        x[:, names.index("ring_inner_diameter")] = outer * rng.uniform(0.76, 0.81, count)
    x[:, names.index("actuation_force")] = rng.uniform(1e3, 1.5e4, count)
    x[:, names.index("ramp_time")] = rng.uniform(0.05, 1.5, count)
    return x


CAR = {"load_torque": "60 N*m", "driver_speed": "1500 rpm", "driven_inertia": "0.7 kg*m2"}
CAR_DISC = KnownDesign(
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

CASES = {
    "disc_clutch": FamilyCases(
        option_sets={
            "default": SOURCES,
            "active": {**SOURCES, "load_kind": "active", "cooling": "fan"},
            "worst_case": {**SOURCES, "friction_basis": "worst_case", "allow_obsolete": "yes"},
            "practice": {"practice": "on", "take_up": "any"},
            "practice_worst_case": {
                "practice": "on",
                "take_up": "any",
                "friction_basis": "worst_case",
                "mass_scope": "parts",
            },
            "practice_standard": {"plates": "standard", "practice": "on", "take_up": "any"},
        },
        requirements=CAR,
        needed={
            "practice=on": {
                "wear_life_min": "10000",
                "service_life": "100 h",
                "top_speed": "6000 1/min",
                "edge_pressure_ratio": "1",
            }
        },
        constants=SHAFTS | COVER,
        designs=dict.fromkeys(("practice", "practice_worst_case"), CAR_DISC)
        | {
            "practice_standard": KnownDesign(
                {"pressure_plate_thickness": "11 mm", "actuation_force": "6.1 kN", "ramp_time": "0.5 s"},
                {"discs": 1},
                {"friction_pair": "sinter_bronze_dry", "facing_set": "facing 215x150"},
            )
        },
        optional={
            **power_of(60),
            **inertia_of(60, 0.7),
            "startup_torque": "120 N*m",
            "overload_torque": "600 N*m",
            "actuation_force_limit": "8 kN",
            "starts_in_row": "10",
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
                tighten={"load_torque": "64 N*m", "outer_diameter_limit": "215 mm", "temperature_rise_limit": "60 K"},
            )
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
        names=NAMES / "names.csv",
        sound=sound_discs,
    )
}
