"""What the drive asks of a centrifugal clutch."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

from synth.declaration import Declaration, Requirement

from ..components.shaft.model import ShaftRequirements, declare_shaft
from ..duty import INERT, MOVED, WORDS, Drive, MovedMachine, of_drive, refuse_contradictions
from ..mechanics import centrifugal
from ..mechanics.shaft import shaft_diameter
from ..practice import UNSOURCED
from ..sources import ARCHARD, DRIVE, ISO_76, JOHNSON, SHAFT, SPRINGS, STANDARD_GRAVITY, TYPICAL, UNIFORM_WEAR

SOURCES = (
    "S4: notes on centrifugal and magnetic-powder clutches (in Hungarian), analyses 1 and 2, practices 1 to 3",
    UNIFORM_WEAR,
    JOHNSON,
    ISO_76,
    *SPRINGS,
    ARCHARD,
    STANDARD_GRAVITY,
    *SHAFT,
)

# What a sheet for several families may state.
COMMON = (
    *WORDS,
    "torque_reserve",
    "idle_speed",
    "full_torque_speed",
    "top_speed",
    "idle_margin_min",
    "contact_speed_max",
    "driven_inertia",
    *MOVED,
    "engagement_heat_limit",
    "hub_radius",
    "outer_diameter_limit",
    "steel_density",
)


class Load(Drive):
    """Speed and torque that are asked for, in SI."""

    group = "duty"

    driver_speed = replace(
        Drive.driver_speed,
        default=lambda duty: duty.full_torque_speed if duty.specifies("full_torque_speed") else None,
        lower=10,
        text="Working speed of the driver; idle and other speeds follow from it where they are not given",
        follows=True,
    )
    full_torque_speed = Requirement(
        "1/min",
        lambda duty: None if duty.specifies("full_torque_speed") else duty.driver_speed,
        lower=10,
        upper=60000,
        symbol="omega_full",
        text="From this speed of the driver on the clutch carries its full torque",
        source=DRIVE,
        follows=True,
    )
    torque_reserve = Requirement(
        "-",
        1.2,
        lower=1,
        upper=5,
        symbol="k_M",
        text="Torque of the clutch over required torque",
        source="practice, 1.1 to 2.5",
    )

    @property
    def torque_to_carry(self) -> Any:
        """Torque that the clutch is sized for [N m]."""
        return self.torque_reserve * self.required_torque


class Duty(Load, MovedMachine):
    """What the drive asks of the clutch, all in SI; None where an optional requirement is not given."""

    group = "duty"

    idle_speed = Requirement(
        "1/min",
        lambda duty: 0.5 * duty.driver_speed,
        lower=10,
        upper=60000,
        symbol="omega_idle",
        text=f"Idle speed of the driver; the clutch is released; by default half of driver speed ({UNSOURCED})",
        source=DRIVE,
    )
    top_speed = Requirement(
        "1/min",
        lambda duty: 1.1 * duty.driver_speed,
        lower=10,
        upper=60000,
        symbol="omega_max",
        text=f"Highest speed of the driver; by default a tenth above driver speed ({UNSOURCED})",
        source=DRIVE,
    )
    idle_margin_min = Requirement(
        "-",
        1.15,
        lower=1,
        upper=3,
        symbol="S_idle",
        text="Least release speed (lever types: contact speed) over idle speed",
        source="practice, 1.05 to 1.5",
    )
    contact_speed_max = Requirement(
        "1/min",
        lambda duty: 0.75 * duty.driver_speed,
        lower=10,
        upper=60000,
        symbol="omega_contact_max",
        text="The plates touch at this speed at the latest; by default at three quarters of driver speed "
        f"({UNSOURCED})",
        source=DRIVE,
    )
    driven_inertia = Requirement(
        "kg*m2",
        lambda duty: duty.inertia_of_machine if duty.specifies(*INERT) else 0.5,
        lower=0,
        upper=1e4,
        symbol="J_load",
        text=f"Inertia on the driven side that an engagement brings up to speed; that of the machine, or 0.5 "
        f"({TYPICAL})",
        source=TYPICAL,
        follows=True,
    )
    engagement_heat_limit = Requirement(
        "J/mm2",
        lower=0.001,
        upper=20,
        optional=True,
        symbol="q_A_allow",
        text="Largest work per engagement and friction area, usually 0.5 to 0.7; takes the place of that of the lining",
        source="practice",
        group="material",
    )
    hub_radius = Requirement(
        "mm",
        20,
        lower=1,
        upper=500,
        symbol="r_hub",
        text=f"Radius of shaft and hub ({TYPICAL})",
        source=TYPICAL,
        group="envelope",
    )
    rim_width = Requirement(
        "mm", 3, lower=0, upper=50, symbol="c_o", text="Rim outside the lining", source="practice", group="model"
    )
    wall_thickness = Requirement(
        "mm",
        5,
        lower=0,
        upper=50,
        symbol="c_w",
        text=f"Wall outside the flyweights ({TYPICAL})",
        source=TYPICAL,
        group="model",
    )
    equivalent_plate_thickness = Requirement(
        "mm",
        25,
        lower=1,
        upper=200,
        symbol="t_plates",
        text=f"Steel thickness that all plates together amount to, for mass and inertia ({TYPICAL})",
        source=TYPICAL,
        group="model",
    )
    outer_diameter_limit = of_drive("mm", 20, 3000, "D_max", "Largest outside diameter", group="envelope")
    ring_ratio_min = Requirement(
        "-",
        0.55,
        lower=0.1,
        upper=0.95,
        symbol="c_min",
        text="Least inner over outer radius of the lining",
        source="practice",
        group="practice",
    )
    ring_ratio_max = Requirement(
        "-",
        0.80,
        lower=0.1,
        upper=0.99,
        symbol="c_max",
        text="Largest inner over outer radius of the lining",
        source="practice",
        group="practice",
    )
    steel_density = Requirement(
        "kg/m3",
        7850,
        lower=1000,
        upper=20000,
        symbol="rho_steel",
        text="Density of plates and weights",
        source="material constant",
        group="material",
    )

    @property
    def engagement_energy(self) -> Any:
        """Heat of bringing driven_inertia up to full_torque_speed, without a load torque [J]."""
        return centrifugal.engagement_energy(self.driven_inertia, self.full_torque_speed)


class Shaft(ShaftRequirements, Load):
    """Shaft for the torque that the clutch is sized for, all in SI."""

    shaft_diameter = replace(
        ShaftRequirements.shaft_diameter,
        default=lambda block: shaft_diameter(block.torque_to_carry, block.shaft_shear_allow),
    )


class WholeDuty(Duty, Shaft):
    """Duty of a clutch that is looked at as a whole, on a shaft from which its hub follows; all in SI."""

    group = "envelope"

    hub_radius = replace(Duty.hub_radius, default=lambda block: block.hub_diameter / 2, source=UNSOURCED)
    length_limit = of_drive("mm", 2, 5000, "L_max", "Largest length")


def declare_duty(d: Declaration) -> Duty:
    """Declare the requirements that all centrifugal clutches have, and the refusals that concern them alone."""
    duty = d.block(Duty)
    _refuse_contradictions(d, duty=duty)
    return duty


def declare_whole_duty(d: Declaration) -> WholeDuty:
    """Declare the requirements of a whole clutch, shaft and hub included, and the refusals that concern them alone."""
    duty = d.block(WholeDuty)
    declare_shaft(d, duty, diameter=duty.shaft_diameter, torque=duty.torque_to_carry)
    _refuse_contradictions(d, duty=duty)
    return duty


def _refuse_contradictions(d: Declaration, *, duty: Duty) -> None:
    refuse_contradictions(d, duty)
    d.refuse(
        "empty_idle_window",
        duty.idle_margin_min * duty.idle_speed > duty.contact_speed_max,
        "a contact_speed_max of at least idle_margin_min times idle_speed; the window in which the clutch may engage "
        "is empty otherwise",
    )
    d.refuse(
        "empty_engagement_window",
        duty.contact_speed_max > duty.full_torque_speed,
        "a full_torque_speed of at least contact_speed_max; the clutch must touch before it can carry torque",
    )
    d.refuse(
        "top_speed_too_low",
        duty.full_torque_speed > duty.top_speed,
        "a top_speed of at least full_torque_speed; the highest speed is the last at which the clutch turns",
    )
    d.refuse(
        "bad_ratio",
        duty.ring_ratio_min > duty.ring_ratio_max,
        "a ring_ratio_min of at most ring_ratio_max; otherwise no lining satisfies both",
    )
    if duty.outer_diameter_limit is not None:
        d.refuse(
            "no_room_for_lining",
            duty.outer_diameter_limit <= 2 * (duty.hub_radius + duty.rim_width),
            "an outer_diameter_limit above twice hub_radius and rim_width; lining and flyweights go between them",
        )
