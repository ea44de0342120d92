"""What the cases of several families share."""

from __future__ import annotations

import math

from .mechanics.centrifugal import STANDARD_GRAVITY

SOURCES = {"practice": "off"}  # the formulas of the sources alone

# Numbers with a unit inside formulas, as "module:name": exponents of kg, m, s, K and A.
SHAFTS = {
    "synth.problems.components.shaft.model:SHAFT_STEEL": (1, -1, -2, 0, 0),
    "synth.problems.mechanics.centrifugal:STANDARD_GRAVITY": (0, 1, -2, 0, 0),
    "synth.problems.mechanics.shaft:TEST_BAR": (0, 1, 0, 0, 0),
}
COVER = {"synth.problems.mechanics.disc:COVER_LEAST": (0, 1, 0, 0, 0)}
MAGNETICS = "synth.problems.mechanics.magnetics:"
MAGNETS = {
    MAGNETICS + "MU_0": (1, 1, -2, 0, -2),
    MAGNETICS + "COPPER_RESISTIVITY": (1, 3, -3, 0, -2),
    MAGNETICS + "COPPER_COEFFICIENT": (0, 0, 0, -1, 0),
    MAGNETICS + "COPPER_DENSITY": (1, -3, 0, 0, 0),
    MAGNETICS + "COPPER_REFERENCE": (0, 0, 0, 1, 0),
    MAGNETICS + "UNIT_HEAT_TRANSFER": (1, 0, -3, -1, 0),
    MAGNETICS + "UNIT_SPEED": (0, 1, -1, 0, 0),
}

LEVER = 0.05 / STANDARD_GRAVITY  # m, of masses behind the gear of a machine: both carry half of the load


def power_of(load_torque: float) -> dict[str, str]:
    """Power at its speed, and a machine with a lifted mass behind a gear, that mean a load torque [N m]."""
    gear = {"machine_ratio": "2", "gear_efficiency": "0.9", "machine_torque": f"{0.9 * load_torque} N*m"}
    rope = {"lifted_mass": f"{9 * load_torque} kg", "drum_diameter": f"{8 * LEVER} m", "rope_parts": "2"}
    return {"power": f"{load_torque * 1000 * math.pi / 30} W", "power_speed": "1000 1/min", **gear, **rope}


def load_of(required_torque: float) -> dict[str, str]:
    """Load, by torque, by power and by machine, that a clutch of a required torque [N m] carries."""
    load = required_torque / 1.5
    return {"load_torque": f"{load} N*m", "safety_factor": "1.5", **power_of(load)}


def inertia_of(load_torque: float, driven_inertia: float) -> dict[str, str]:
    """Inertias and a mass that with those of the same load torque [N m] mean a driven inertia [kg m2]."""
    behind = 0.9 * driven_inertia - 20 * load_torque * LEVER**2
    moved = {"machine_inertia": f"{behind * 0.9 * 4} kg*m2", "moved_mass": f"{9 * load_torque} kg"}
    return {**moved, "clutch_side_inertia": f"{driven_inertia * 0.1} kg*m2"}
