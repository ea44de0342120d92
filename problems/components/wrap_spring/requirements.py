"""Options of a wrap spring, and what the drive asks of it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any

from synth.declaration import Block, Declaration, Option, Requirement
from synth.text.numbers import typed_number

from ...duty import WORDS, Drive, of_drive, refuse_contradictions
from ...sources import ARCHARD, DRIVE, NOT_IN_S2, S2, SHAFT, TYPICAL
from .models import MODELS

SOURCES = (
    "S2: M. Kozma, G. Molnar, K. Varadi, R. Oroszvary, Preloaded force-locking clutch with a helical spring "
    "(wrap spring clutch, in Hungarian)",
    "A. M. Wahl, Mechanical Springs",
    "Goodman, fatigue under a mean stress",
    "ISO 3, preferred numbers",
    ARCHARD,
    *SHAFT,
)

# What a sheet for several families may state.
COMMON = (
    *WORDS,
    "slip_safety",
    "peak_torque",
    "spring_speed",
    "bore_diameter",
    "outer_diameter_limit",
    "length_limit",
    "gap_coils",
    "coil_gap",
    "spring_index_min",
    "hub_density",
    "belt_exponent_limit",
)

WIRE_CHOICES = ("catalogue", "custom")
HUB_LADDERS = ("hub_diameters", "R20", "R40")
# Range of the hub diameter and of the coils offered to the search; refusals reason with their upper ends.
HUB_DIAMETER_RANGE = (6.0, 200.0)
COILS_RANGE = (2, 12)


class Options(Block):
    """Options that both fits have."""

    group = "model"

    model = Option(
        tuple(MODELS),
        "refined",
        symbol="mdl",
        text="refined: hub and mean coil radius apart, exact curvature, centrifugal force; seed: as in the source, "
        "which counts all torques at rest",
        source=f"{S2}; refined: derived",
    )
    wire_choice = Option(
        WIRE_CHOICES,
        "catalogue",
        symbol="wc",
        text="catalogue: wire of table spring_wire_flat; custom: thickness and width are variables, the material "
        "is given by wire modulus, wire density and so on",
        source="supply of the wire",
    )
    hub_ladder = Option(
        HUB_LADDERS,
        "hub_diameters",
        symbol="lad",
        text="Makeable hub diameters: of table hub_diameters, or a series of preferred numbers",
        source="table hub_diameters; ISO 3",
    )


class Duty(Drive):
    """What the drive asks of the clutch, all in SI; None where an optional requirement is not given."""

    group = "duty"

    driver_speed = replace(
        Drive.driver_speed, optional=lambda duty: not duty.specifies("power") or duty.specifies("power_speed")
    )
    safety_factor = replace(Drive.safety_factor, symbol="n_L")
    required_torque = replace(Drive.required_torque, symbol="T_req", text="Torque to hold without slip")
    slip_safety = Requirement(
        "-",
        1.3,
        lower=1,
        upper=4,
        symbol="S_T",
        text="Safety of the least closing torque over required torque",
        source=f"{TYPICAL} of the reference model",
    )
    peak_torque = Requirement(
        "N*m",
        lambda duty: 2.5 * duty.required_torque,
        lower=0.01,
        upper=1e12,
        symbol="T_peak",
        text="Highest torque that the drive can apply; by default 2.5 required torque",
        source=DRIVE,
    )
    spring_speed = Requirement(
        "1/min",
        lambda duty: duty.driver_speed if duty.specifies("driver_speed") else 0,
        lower=0,
        upper=60000,
        symbol="omega_s",
        text="Speed of the spring when driving; by default driver speed, else at rest",
        source=DRIVE,
    )
    interference_tolerance = Requirement(
        "mm",
        0.03,
        lower=0.001,
        upper=1,
        symbol="tol",
        text="Tolerance of the fit, +- of wire, bore and hub together",
        source=f"{TYPICAL} of the reference model",
        group="model",
    )
    bore_diameter = Requirement(
        "mm", lower=1, upper=500, symbol="d_bore", text="Shaft bore of the hubs", source=DRIVE, group="envelope"
    )
    outer_diameter_limit = of_drive("mm", 3, 1000, "D_max", "Largest outside diameter", group="envelope")
    length_limit = of_drive("mm", 2, 2000, "L_max", "Largest length of the spring", group="envelope")
    gap_coils = Requirement(
        "-",
        0.5,
        lower=0,
        upper=4,
        symbol="n_gap",
        text="Coils over the gap between the hubs",
        source=f"{TYPICAL} of the reference model",
        group="model",
    )
    coil_gap = Requirement(
        "mm",
        0.2,
        lower=0,
        upper=5,
        symbol="g_c",
        text="Axial gap between coils",
        source=f"{TYPICAL} of the reference model",
        group="model",
    )
    spring_index_min = Requirement(
        "-",
        6,
        lower=2,
        upper=30,
        symbol="index_min",
        text="Least mean coil diameter over wire thickness",
        source="coiling practice",
        group="practice",
    )
    hub_density = Requirement(
        "kg/m3",
        7850,
        lower=0,
        upper=20000,
        symbol="rho_hub",
        text="Density of the hubs; 0 counts the spring only",
        source="material constant",
        group="material",
    )
    belt_exponent_limit = Requirement(
        "-",
        lower=1,
        upper=50,
        optional=True,
        symbol="beta_max",
        text="Largest belt exponent at the highest friction; beyond about 6 any peak is locked and the preload "
        "means little",
        source=NOT_IN_S2,
        group="model",
    )


class PracticeDuty(Duty):
    """A duty of clutches that can slip, by the rules of practice."""

    belt_exponent_limit = replace(
        Duty.belt_exponent_limit,
        default=6,
        optional=False,
        text="Largest belt exponent at the highest friction; beyond about 6 any peak is locked and the preload means "
        "little: a freewheel may have more",
    )


def declare_duty(d: Declaration, *, kind: type[Duty], bore: Callable[[Duty], Any] | None = None) -> Duty:
    """Declare the requirements that both fits have, and the refusals that concern them alone.

    Parameters
    ----------
    d : Declaration
        Takes the declarations.
    kind : subclass of Duty
        Block of the family, which says what interference_tolerance means in it.
    bore : callable, optional
        Default of bore_diameter [m], from the block; without it the bore must be given.

    Returns
    -------
    Duty
        Symbols of the block.
    """
    duty = d.block(kind, bore_diameter=bore)
    refuse_contradictions(d, duty)
    d.refuse(
        "peak_below_required",
        duty.peak_torque < duty.required_torque,
        "a peak_torque of at least required_torque; the drive must be able to apply what the clutch has to hold",
    )
    largest_hub = HUB_DIAMETER_RANGE[1]
    d.refuse(
        "hub_thinner_than_bore",
        duty.bore_diameter >= largest_hub / 1000,
        f"a bore_diameter below {typed_number(largest_hub)} mm, the largest hub there is; "
        "a hub is not thinner than its bore",
    )
    if duty.outer_diameter_limit is not None:
        d.refuse(
            "no_room_for_hub",
            duty.outer_diameter_limit <= duty.bore_diameter,
            "an outer_diameter_limit above bore_diameter; hub and wire go between them",
        )
    return duty
