"""Cases of this family for ``synth.testing.FamilyTests``."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from synth.testing import Case, FamilyCases, Instance, KnownDesign

from ..cases import SHAFTS, SOURCES, inertia_of, power_of

NAMES = Path(__file__).parent


def sound_rings(rng: np.random.Generator, instance: Instance, count: int) -> np.ndarray:
    """Variables with rings of a sensible ratio and forces of a sensible size; plates of a list have theirs."""
    low, high = instance.ranges.lower, instance.ranges.upper
    x: np.ndarray = low * (high / low) ** rng.random((count, len(low)))
    names = [v.name for v in instance.model.variables]
    if "ring_outer_diameter" in names:
        outer = rng.uniform(0.14, 0.5, count)
        x[:, names.index("ring_outer_diameter")] = outer
        x[:, names.index("ring_inner_diameter")] = outer * rng.uniform(0.6, 0.8, count)
    x[:, names.index("actuation_force")] = rng.uniform(5e3, 5e4, count)
    x[:, names.index("ramp_time")] = rng.uniform(0.05, 4, count)
    return x


HOIST = {"load_torque": "600 N*m", "driver_speed": "26.6 rad/s", "driven_inertia": "30 kg*m2"}

CASES = {
    "multi_plate_clutch": FamilyCases(
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
        constants=SHAFTS,
        requirements=HOIST,
        optional={
            **power_of(600),
            **inertia_of(600, 30),
            "surface_factor": "1",
            "startup_torque": "1080 N*m",
            "overload_torque": "4000 N*m",
            "actuation_force_limit": "60 kN",
            "starts_in_row": "10",
            "outer_diameter_limit": "400 mm",
            "length_limit": "200 mm",
            "jerk_limit": "60 rad/s3",
            "acceleration_limit": "40 rad/s2",
            "hub_bore_diameter": "60 mm",
            "drag_torque_limit": "20 N*m",
        },
        needed={
            "practice=on": {
                "wear_life_min": "20000",
                "service_life": "100 h",
                "plate_gap": "0.4 mm",
                "edge_pressure_ratio": "1",
            }
        },
        designs={
            "practice": KnownDesign(
                {
                    "ring_outer_diameter": "183 mm",
                    "ring_inner_diameter": "119 mm",
                    "actuation_force": "12.41 kN",
                    "ramp_time": "0.7 s",
                },
                {"friction_surfaces": 12},
                {"friction_pair": "paper_wet", "inner_plate": "core 2", "outer_plate": "core 2"},
            ),
            "practice_dry": KnownDesign(
                {
                    "ring_outer_diameter": "258 mm",
                    "ring_inner_diameter": "190 mm",
                    "actuation_force": "12.91 kN",
                    "ramp_time": "0.7 s",
                },
                {"friction_surfaces": 2},
                {"friction_pair": "metal_ceramic_bronze_dry", "inner_plate": "core 3", "outer_plate": "core 3"},
            ),
            "standard": KnownDesign(
                {"actuation_force": "20 kN", "ramp_time": "0.7 s"},
                {"friction_surfaces": 10},
                {"friction_pair": "graphitic_wet", "plate_set": "set 160x236 core 2.5 lining 0.5"},
            ),
            "practice_standard": KnownDesign(
                {"actuation_force": "20 kN", "ramp_time": "0.7 s"},
                {"friction_surfaces": 10},
                {"friction_pair": "graphitic_wet", "plate_set": "set 160x236 core 2.5 lining 0.5"},
            ),
            "practice_catalogue": KnownDesign(
                {
                    "ring_outer_diameter": "178 mm",
                    "ring_inner_diameter": "123 mm",
                    "actuation_force": "15.92 kN",
                    "ramp_time": "0.7 s",
                },
                {"friction_surfaces": 10},
                {
                    "friction_pair": "graphitic_wet",
                    "inner_plate": "core 1.8",
                    "outer_plate": "core 2",
                    "inner_spline": "DIN5480 120x3x38",
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
                tighten={"load_torque": "125 N*m", "actuation_force_limit": "5 kN", "hub_bore_diameter": "70 mm"},
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
        names=NAMES / "names.csv",
        sound=sound_rings,
    )
}
