"""Blocks of declarations that the centrifugal clutches with levers share: gap, lever, room, remarks."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from synth.text.numbers import typed_number

from .. import centrifugal as blocks
from ..components.springs.model import SpringSet
from ..mechanics import centrifugal
from ..mechanics import centrifugal_levers as formulas
from ..sources import NOT_IN_S4, S4, TYPICAL

if TYPE_CHECKING:
    from collections.abc import Sequence

    from synth.declaration import Declaration

RECONSTRUCTED = f"{S4}, in words; arrangement reconstructed, relations derived"
# Range of the stop angle [rad] and of the rest radius [mm]; refusals reason with them.
STOP_ANGLE_MIN, STOP_ANGLE_MAX = 0.05, 0.35
REST_RADIUS_MAX = 250.0
LOADED = "clamp_springs_loaded"  # a guard


@dataclass(frozen=True)
class Lever:
    """Lever, flyweights and gap that both families have, all in SI."""

    rest_radius: Any
    weights: blocks.Weights
    contact_travel: Any
    wear: Any
    deflection: Any
    stop_angle: Any

    @property
    def worn_travel(self) -> Any:
        """Travel to contact with worn linings [m]."""
        return self.contact_travel + self.wear

    @property
    def end_radius(self) -> Any:
        """Radius of the flyweights at the stop [m]."""
        return self.radius(self.stop_angle)

    def radius(self, angle: Any) -> Any:
        """Return the radius of the flyweights at an angle [m]."""
        return centrifugal.orbit_radius(self.rest_radius, self.weights.arm, angle)

    def speed(self, force: Any, angle: Any) -> Any:
        """Return the speed at which the flyweights pull with a force at an angle [rad/s]."""
        return centrifugal.speed_for_force(force, self.weights.mass, self.radius(angle))

    def speeds(self, stop_pull: Any, band_squared: Any) -> tuple[Any, Any, Any]:
        """Return contact speed, stop speed and engagement band, from the pull at the stop [N] and the band.

        Where the same springs resist at contact and at the stop, mass, arm and springs stand in the contact speed once
        this way, and the torque that the springs must hold says at once how heavy the weights are.
        """
        square = formulas.speed_squared(stop_pull, self.weights.mass, self.end_radius)
        return np.sqrt(square / band_squared), np.sqrt(square), np.sqrt(band_squared)


def declare_lever(d: Declaration, *, duty: blocks.Duty, stop_text: str) -> Lever:
    """Declare gap, wear, flyweights, preload and stop angle, with the limits of angle and contact.

    Parameters
    ----------
    d : Declaration
        Takes the declarations.
    duty : Duty
        Requirements.
    stop_text : str
        What the stop is.

    Returns
    -------
    Lever
        Symbols of the block.
    """
    travel = d.requirement(
        "contact_travel",
        "mm",
        3,
        lower=0.2,
        upper=30,
        symbol="x0",
        text=f"Gap between pressure plate and friction disc at rest ({TYPICAL})",
        source=f"{S4}, x0; {TYPICAL}",
        group="duty",
    )
    wear = blocks.declare_wear(d)
    weights = blocks.declare_weights(d, duty=duty)
    lever = Lever(
        rest_radius=blocks.declare_rest_radius(d),
        weights=weights,
        contact_travel=travel,
        wear=wear,
        deflection=d.variable(
            "spring_preload_deflection",
            "mm",
            1,
            20,
            grid=0.1,
            symbol="delta",
            text="Deflection of the clamp springs at rest",
            source=f"{S4}, F_R0/s",
        ),
        stop_angle=d.variable(
            "lever_stop_angle",
            "rad",
            STOP_ANGLE_MIN,
            STOP_ANGLE_MAX,
            symbol="phi_max",
            text=f"Angle at which the lever meets its stop: {stop_text}",
            source=RECONSTRUCTED,
        ),
    )
    d.refuse(
        "stop_angle_out_of_range",
        weights.angle_limit < STOP_ANGLE_MIN,
        f"a lever_angle_limit of at least {typed_number(STOP_ANGLE_MIN)} rad, the least angle of the stop",
    )
    d.at_most(
        "lever_angle",
        lever.stop_angle,
        weights.angle_limit,
        "rad",
        text="The lever swings so little that sine and tangent are the angle",
        source=NOT_IN_S4,
    )
    return lever


def limit_contact(d: Declaration, *, lever: Lever, plate_arm: Any, longest: float, name: str) -> None:
    """Declare that the lever meets its stop after contact, and refuse gaps that no lever closes.

    Parameters
    ----------
    d : Declaration
        Takes the declarations.
    lever : Lever
        Lever.
    plate_arm : symbol
        Arm that moves the plate [m].
    longest : float
        Its upper bound [mm].
    name : str
        Name of the arm.
    """
    d.refuse(
        "travel_unreachable",
        lever.worn_travel > lever.weights.angle_limit * longest / 1000,
        f"a contact_travel with lining_wear of at most lever_angle_limit times {typed_number(longest)} mm, the "
        f"longest {name}; no lever closes more",
    )
    d.at_most(
        "stop_after_contact",
        lever.worn_travel / plate_arm,
        lever.stop_angle,
        "rad",
        text="With worn linings too the plate is on the disc before the lever meets its stop",
        source=NOT_IN_S4,
    )


def name_contact(d: Declaration, *, lever: Lever, angle: Any) -> None:
    """Name angle and radius at contact, and by how much the radius grows up to the stop.

    Parameters
    ----------
    d : Declaration
        Takes the declarations.
    lever : Lever
        Lever.
    angle : symbol
        Of the lever at contact [rad].
    """
    radius = lever.radius(angle)
    growth = formulas.growth(radius, lever.weights.arm, lever.stop_angle - angle)
    for name, unit, value, symbol, text in (
        ("contact_angle", "rad", angle, "phi_c", "Angle of the lever at contact"),
        ("remaining_angle", "rad", lever.stop_angle - angle, "phi_r", "Angle of the lever from contact to its stop"),
        ("contact_radius", "mm", radius, "r_c", "Radius of the flyweights at contact"),
        ("radius_growth", "-", growth, "k_radius", "Radius of the flyweights at the stop over that at contact"),
    ):
        d.step(name, unit, value, symbol=symbol, text=text, source=RECONSTRUCTED)


def require_loaded_springs(d: Declaration, *, lever: Lever, squeeze: Any) -> None:
    """Declare the guard that the clamp springs are under load at the stop.

    Parameters
    ----------
    d : Declaration
        Takes the declarations.
    lever : Lever
        Lever.
    squeeze : symbol
        Travel of the springs' end from rest to the stop, that of the plate included [m].
    """
    d.at_least(
        LOADED,
        lever.deflection + squeeze,
        lever.contact_travel,
        "mm",
        guard=True,
        text="At the stop the clamp springs are under load; otherwise there is no clamp force",
        source=NOT_IN_S4,
    )


def refuse_room(d: Declaration, *, duty: blocks.Duty, least_leg: Any, name: str) -> None:
    """Refuse hubs and outside diameters that leave no room for the shortest lever.

    Parameters
    ----------
    d : Declaration
        Takes the declarations.
    duty : Duty
        Requirements.
    least_leg : symbol
        Least length of the lever below the flyweights [m].
    name : str
        Name of that arm.
    """
    d.refuse(
        "no_room_for_lever",
        duty.hub_radius + least_leg >= REST_RADIUS_MAX / 1000,
        f"a hub_radius that leaves room for the lever: with the least {name} that closes the gap it must stay below "
        f"{typed_number(REST_RADIUS_MAX)} mm, the largest rest_radius",
    )
    if duty.outer_diameter_limit is not None:
        d.refuse(
            "envelope_too_small",
            duty.outer_diameter_limit <= 2 * (duty.hub_radius + least_leg + duty.wall_thickness),
            f"an outer_diameter_limit above twice hub_radius, the least {name} that closes the gap and wall_thickness",
        )


def built(lining: blocks.Lining, lever: Lever, springs: Sequence[SpringSet], discs: int = 0) -> blocks.Built:
    """Parts of a clutch with levers, and a number of plates beside flywheel and pressure plate."""
    weights = lever.weights
    return blocks.Built(
        lining,
        lever.rest_radius,
        blocks.Flyweights(weights.mass, lever.end_radius, weights.thickness / 2, weights.width, weights.count),
        springs,
        wear=lever.wear,
        gap=lever.contact_travel,
        travel=lever.contact_travel,
        discs=discs,
    )


def advise_lever(
    d: Declaration, *, duty: blocks.Duty, lining: blocks.Lining, lever: Lever, start_pull: Any, stop_pull: Any
) -> Any:
    """Declare the force on the stop [N], and remark what rests on assumptions and what must be watched for.

    Parameters
    ----------
    d : Declaration
        Takes the declarations.
    duty : Duty
        Requirements.
    lining : Lining
        Lining.
    lever : Lever
        Lever.
    start_pull, stop_pull : symbol
        Centrifugal force of all flyweights where the lever leaves its rest, and where it meets its stop [N].
    """
    pull = centrifugal.centrifugal_force(lever.weights.mass, lever.end_radius, duty.top_speed)
    stop_force = blocks.declare_stop_force(
        d,
        force=pull - stop_pull,
        text="Force of all levers on their stops at top speed, at flyweight arm",
        source=RECONSTRUCTED,
    )
    d.advise(
        "assumed_values",
        True,
        "the figure of this lever is lost: speeds, forces and stop force rest on an arrangement of its arms that is "
        "reconstructed from words; outer diameter, mass and inertia rest on hub radius, wall thickness, weight width "
        "and equivalent plate thickness, engagement heat rests on driven inertia, all travels on contact travel: "
        "their defaults are typical values, not those of your drive",
        source=RECONSTRUCTED,
    )
    blocks.advise_release_gap(d, gap=lever.contact_travel, lining=lining)
    blocks.advise_gravity(d, rest_radius=lever.rest_radius, start_speed=lever.speed(start_pull, 0.0))
    return stop_force
