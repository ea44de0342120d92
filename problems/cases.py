"""What the cases of several families share."""

from __future__ import annotations

import math

SOURCES = {"practice": "off"}  # the formulas of the sources alone

# Numbers with a unit inside formulas, as "module:name": exponents of kg, m, s, K and A.
SHAFTS = {
    "synth.problems.components.shaft.model:SHAFT_STEEL": (1, -1, -2, 0, 0),
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


def power_of(load_torque: float) -> dict[str, str]:
    """Power at its speed that means a load torque [N m]."""
    return {"power": f"{load_torque * 1000 * math.pi / 30} W", "power_speed": "1000 1/min"}


def load_of(required_torque: float) -> dict[str, str]:
    """Load, by torque and by power, that a clutch of a required torque [N m] carries."""
    load = required_torque / 1.5
    return {"load_torque": f"{load} N*m", "safety_factor": "1.5", **power_of(load)}
