"""Cases of this family for ``synth.testing.FamilyTests``."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from synth.testing import Case, FamilyCases, Instance, KnownDesign

from ..cases import SHAFTS, SOURCES, load_of

NAMES = Path(__file__).parent


def sound_couplings(rng: np.random.Generator, instance: Instance, count: int) -> np.ndarray:
    """Variables with clearances and rims of a sensible size, for rollers of any diameter."""
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


MILL = {"required_torque": "300 N*m", "driver_speed": "960 rpm", "offset": "5 mm"}
MILL_COUPLING = {"arm_radius": "62 mm", "guide_half_length": "72 mm", "offset_capacity": "5.5 mm", "balance": "no"}

CASES = {
    "roller_coupling": FamilyCases(
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
        constants=SHAFTS,
        requirements=MILL,
        designs={
            "practice": KnownDesign(
                {**MILL_COUPLING, "rim": "8 mm", "contact_length": "10 mm"},
                {},
                {"roller": "NATR 15", "float_material": "100Cr6"},
            ),
            "practice_any": KnownDesign(
                {**MILL_COUPLING, "rim": "9 mm", "contact_length": "9 mm"},
                {},
                {"roller": "6203", "float_material": "100Cr6"},
            ),
            "practice_ball_bearings": KnownDesign(
                {**MILL_COUPLING, "rim": "9 mm", "contact_length": "9 mm"},
                {},
                {"roller": "6203", "float_material": "100Cr6"},
            ),
        },
        optional={**load_of(300), "outer_diameter_limit": "400 mm", "mass_limit": "40 kg", "vibration_limit": "2 kN"},
        feasible={
            "mill": Case(
                options=SOURCES,
                requirements={**MILL, "outer_diameter_limit": "260 mm"},
                settings={"parts": {"roller": ["6203", "6204", "6303"], "float_material": ["100Cr6", "EN AW-7075-T6"]}},
                tighten={"required_torque": "320 N*m", "offset": "7 mm", "pin_shear_limit": "36 N/mm2"},
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
                    "parts": {"roller": ["NATV 12", "NATR 12", "NATV 15"], "float_material": ["100Cr6", "Ti-6Al-4V"]},
                    "objectives": ["outer_diameter", "pin_force"],
                },
                tighten={"required_torque": "130 N*m", "vibration_limit": "20 N"},
            ),
        },
        infeasible=Case(
            options=SOURCES,
            requirements={**MILL, "outer_diameter_limit": "115 mm"},
            settings={"parts": {"roller": ["6203", "6204"], "float_material": ["100Cr6", "PA6-G (cast)"]}},
        ),
        culprits=frozenset({"outer_diameter", "pin_shear", "hertz", "roller_gap", "run_in"}),
        names=NAMES / "names.csv",
        sound=sound_couplings,
    )
}
