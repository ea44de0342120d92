"""Flyweights: where they rest, what levers carry, and the room that they take."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from ..duty import declare_gravity
from ..mechanics import centrifugal
from ..sources import NOT_IN_S4, S4, TYPICAL

if TYPE_CHECKING:
    from synth.declaration import Declaration

    from .duty import Duty


@dataclass(frozen=True)
class Flyweights:
    """Flyweights as the envelope sees them.

    ``half_height`` is from their centre to their outside, ``width`` their size along the axis.
    """

    mass: Any
    end_radius: Any
    half_height: Any
    width: Any
    count: Any


def declare_rest_radius(d: Declaration) -> Any:
    """Declare the radius of the flyweights at rest and return it [m]."""
    return d.variable(
        "rest_radius",
        "mm",
        30,
        250,
        grid=1,
        symbol="r0",
        text="Radius of the flyweight centres at rest",
        source=f"{S4}, r0",
    )


@dataclass(frozen=True)
class Weights:
    """Square weights at the ends of levers."""

    mass: Any
    count: Any
    arm: Any
    width: Any
    thickness: Any
    angle_limit: Any


def declare_weights(d: Declaration, *, duty: Duty) -> Weights:
    """Declare the flyweights of the lever types: their mass, number, arm and room.

    Parameters
    ----------
    d : Declaration
        Takes the declarations.
    duty : Duty
        Requirements.

    Returns
    -------
    Weights
        Symbols of the block.
    """
    width = d.requirement(
        "weight_width",
        "mm",
        30,
        lower=2,
        upper=300,
        symbol="b_w",
        text=f"Axial width of a weight ({TYPICAL})",
        source=TYPICAL,
        group="model",
    )
    angle = d.requirement(
        "lever_angle_limit",
        "rad",
        0.35,
        lower=0.02,
        upper=0.35,
        symbol="phi_lim",
        text="Largest angle of the levers; the model takes sine and tangent for the angle",
        source=NOT_IN_S4,
        group="practice",
    )
    mass = d.variable(
        "flyweight_mass", "kg", 0.05, 5, symbol="m_f", text="Mass of all weights together", source=f"{S4}, m"
    )
    arm = d.variable(
        "flyweight_arm",
        "mm",
        10,
        200,
        grid=0.5,
        symbol="l_c",
        text="Arm of the weights on their levers",
        source=f"{S4}, l_c",
    )
    count = d.count(
        "weights",
        2,
        6,
        symbol="n_w",
        text="Number of weights, each on a lever",
        source=f"{S4}, levers around the shaft",
    )
    thickness = d.derive(
        "weight_thickness",
        "mm",
        centrifugal.weight_thickness(mass, count, duty.steel_density, width),
        symbol="t_w",
        text="Radial size of a weight of square section",
        source=f"geometry; {NOT_IN_S4}",
    )
    return Weights(mass, count, arm, width, thickness, angle)


def limit_weight_room(d: Declaration, *, duty: Duty, weights: Weights, rest_radius: Any, pivot_arm: Any = 0.0) -> None:
    """Declare the limit that weights (and the legs of their levers) clear the hub.

    Parameters
    ----------
    d : Declaration
        Takes the declarations.
    duty : Duty
        Requirements.
    weights : Weights
        Weights.
    rest_radius : symbol
        Radius of their centres at rest [m].
    pivot_arm : symbol, optional
        Length of the lever that lies below the weight [m].
    """
    d.at_most(
        "weight_clear_of_hub",
        duty.hub_radius + weights.thickness / 2 + pivot_arm,
        rest_radius,
        "mm",
        text="The weights at rest clear the hub",
        source=f"geometry; {NOT_IN_S4}",
    )


def advise_gravity(d: Declaration, *, rest_radius: Any, start_speed: Any) -> None:
    """Remark where the flyweights start at so low a speed that gravity moves them.

    Parameters
    ----------
    d : Declaration
        Takes the declarations.
    rest_radius : symbol
        Radius of their centres at rest [m].
    start_speed : symbol
        Speed at which they leave their rest [rad/s].
    """
    declare_gravity(d)
    d.advise(
        "gravity_at_start",
        centrifugal.gravity_ratio(rest_radius, start_speed) < 10,
        "the flyweights leave their rest below ten times gravity: on a horizontal shaft they move once per turn",
        source=NOT_IN_S4,
    )
