"""Blocks of declarations for balls in ramps, which two centrifugal clutches share."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from synth.declaration import Block, Declaration, Part, Requirement

from ..components.springs.model import SpringSet
from ..mechanics import centrifugal
from ..mechanics.contact import contact_modulus
from ..sources import DRIVE, NOT_IN_S4, S4, TYPICAL
from . import Duty

# Least share of the axial force that friction must leave when the balls come back; at 0 the ramp locks.
RETURN_SHARE_MIN = 0.2
# Remarks only: friction that costs more than this share of the speed on the way back is worth a word.
HYSTERESIS_RATIO = 0.95


@dataclass(frozen=True)
class Balls:
    """Balls in ramps; ``push`` is the axial over the centrifugal force of balls that move out."""

    count: Any
    part: Part
    ratio: Any
    mass: Any
    pressure_limit: Any
    push: Any
    release_ratio: Any

    @property
    def radius(self) -> Any:
        """Radius of a ball [m]."""
        return self.part.diameter / 2


class ForceLimits(Block):
    """Requirements that the devices with ramps (and their lever sister) have beside the duty."""

    group = "duty"

    contact_speed_min = Requirement(
        "1/min",
        lower=1,
        upper=60000,
        symbol="omega_contact_min",
        text="The plates touch at this speed at the earliest; by default idle margin min times idle speed",
        source=DRIVE,
    )
    clamp_force_limit = Requirement(
        "N",
        4500,
        lower=1,
        upper=1e6,
        symbol="F_N_cap",
        text="Largest clamp force, for the release bearing",
        source="practice",
        group="actuator",
    )
    pocket_gap = Requirement(
        "mm",
        4,
        lower=0,
        upper=50,
        symbol="c_gap",
        text="Gap between balls and spring pockets around the circle",
        source="practice",
        group="model",
    )


def declare_force_limits(d: Declaration, *, duty: Duty) -> ForceLimits:
    """Declare earliest contact, largest clamp force and the gap between pockets.

    Parameters
    ----------
    d : Declaration
        Takes the declarations.
    duty : Duty
        Requirements.

    Returns
    -------
    ForceLimits
        Symbols of the block.
    """
    wants = d.block(ForceLimits, contact_speed_min=duty.idle_margin_min * duty.idle_speed)
    d.refuse(
        "contact_window_reversed",
        wants.contact_speed_min > duty.contact_speed_max,
        "a contact_speed_min of at most contact_speed_max; otherwise no contact speed satisfies both",
    )
    return wants


def declare_balls(d: Declaration, *, duty: Duty, rest_radius: Any) -> Balls:
    """Declare balls and ramp, with the limits that they come back and clear the hub.

    Parameters
    ----------
    d : Declaration
        Takes the declarations.
    duty : Duty
        Requirements.
    rest_radius : symbol
        Radius of the ball centres at rest [m].

    Returns
    -------
    Balls
        Symbols of the block.
    """
    friction = d.requirement(
        "ball_friction",
        "-",
        0.03,
        lower=0,
        upper=0.1,
        symbol="mu_b",
        text="Friction at the contacts of the balls, greased hardened track; a guess, 0 to 0.1",
        source=NOT_IN_S4,
        group="material",
    )
    pressure_limit = d.requirement(
        "hertz_pressure_limit",
        "GPa",
        3.5,
        lower=0.5,
        upper=4.2,
        symbol="p_hertz_allow",
        text=f"Largest pressure of a ball on a flat ramp ({TYPICAL}; 2.8 to 4, static limit of ball contacts 4.2)",
        source=f"{TYPICAL}; ISO 76",
        group="material",
    )
    count = d.count("balls", 3, 12, symbol="n_b", text="Number of balls, each in a ramp", source=f"{S4}, balls")
    part = d.part("ball", "balls", symbol="ball", text="One ball", source="table balls")
    ratio = d.variable(
        "ramp_ratio",
        "-",
        0.4,
        2,
        symbol="i",
        text="Transmission of the ramp dr/dx, the tangent of ramp angle",
        source=f"{S4}, tan(alpha)",
    )
    d.derive(
        "ramp_angle",
        "deg",
        centrifugal.ramp_angle(ratio),
        symbol="alpha",
        text="Angle of the ramp, measured from the shaft axis",
        source=f"{S4}, alpha",
    )
    mass = d.derive(
        "flyweight_mass",
        "kg",
        centrifugal.ball_set_mass(count, part.density, part.diameter),
        symbol="m_f",
        text="Mass of all balls together",
        source=f"{S4}, m",
    )
    loss = centrifugal.contact_loss(friction, ratio)
    d.at_least(
        "ramp_returns",
        1 - loss,
        RETURN_SHARE_MIN,
        "-",
        guard=True,
        text="The balls come back by themselves: the ramp does not lock",
        source=NOT_IN_S4,
    )
    d.at_least(
        "hub_clearance",
        rest_radius,
        duty.hub_radius + part.diameter / 2,
        "mm",
        text="The balls at rest clear the hub",
        source="geometry",
    )
    release_ratio = centrifugal.release_ratio(loss)
    push = centrifugal.ramp_gain(ratio, friction)
    text = "Share of the force that friction at the balls takes"
    d.step("contact_loss", "-", loss, symbol="c_b", text=text, source=NOT_IN_S4)
    text = "Axial over centrifugal force of balls that move out"
    d.step("ramp_gain", "-", push, symbol="k_out", text=text, source=NOT_IN_S4)
    d.advise(
        "hysteresis",
        release_ratio < HYSTERESIS_RATIO,
        "friction at the balls makes the clutch let go more than 5 % below the speed at which it takes hold; "
        "release speed counts it",
        source=NOT_IN_S4,
    )
    d.advise(
        "rests_on_guesses",
        True,
        "speeds and forces rest on ball friction, which is a guess, and hertz pressure on a flat ramp: vary the one, "
        "and measure, before a design is released",
        source=NOT_IN_S4,
    )
    return Balls(
        count=count,
        part=part,
        ratio=ratio,
        mass=mass,
        pressure_limit=pressure_limit,
        push=push,
        release_ratio=release_ratio,
    )


def declare_ball_pressure(d: Declaration, *, duty: Duty, balls: Balls, end_radius: Any) -> None:
    """Declare the pressure of the balls at top speed and its limit.

    Parameters
    ----------
    d : Declaration
        Takes the declarations.
    duty : Duty
        Requirements.
    balls : Balls
        Balls.
    end_radius : symbol
        Radius of the ball centres at the end of their way [m].
    """
    ball = balls.part
    one = centrifugal.ball_set_mass(1, ball.density, ball.diameter)
    pull = centrifugal.centrifugal_force(one, end_radius, duty.top_speed)
    normal = centrifugal.ramp_normal_force(pull, balls.ratio)
    modulus = contact_modulus(ball.E, ball.nu, ball.E, ball.nu)
    source = "K. L. Johnson, Contact Mechanics (1985), eq. (4.24)"
    d.step("ball_mass", "kg", one, symbol="m_b", text="One ball", source="geometry")
    d.step("ramp_force", "N", normal, symbol="Q_b", text="Force of a ball across its ramp at top speed", source=source)
    d.step("contact_modulus", "GPa", modulus, symbol="E_c", text="Modulus of the contact E*", source=source)
    pressure = d.derive(
        "hertz_pressure",
        "GPa",
        centrifugal.ball_pressure(normal, ball.diameter, modulus),
        symbol="p_h",
        text="Pressure of a ball on a flat ramp of the same steel, at top speed",
        source=source,
    )
    d.at_most(
        "ball_hertz",
        pressure,
        balls.pressure_limit,
        "GPa",
        text="The ramps keep their shape",
        source="ISO 76, static contact pressure",
    )


def limit_contact_and_clamp(
    d: Declaration, *, wants: ForceLimits, contact_speed: Any, clamp_force: Any, speed_text: str = ""
) -> None:
    """Declare the limits of earliest contact and largest clamp force.

    Parameters
    ----------
    d : Declaration
        Takes the declarations.
    wants : ForceLimits
        Requirements.
    contact_speed : symbol
        Speed at which the plates touch [rad/s].
    clamp_force : symbol
        Largest clamp force [N].
    speed_text : str
        At which speed it is the largest.
    """
    d.at_least(
        "contact_not_too_early",
        contact_speed,
        wants.contact_speed_min,
        "1/min",
        text="The plates touch at contact speed min at the earliest",
        source=DRIVE,
    )
    d.at_most(
        "clamp_cap",
        clamp_force,
        wants.clamp_force_limit,
        "N",
        text=f"The release bearing stands the clamp force{speed_text}",
        source="practice",
    )


def limit_circle_room(
    d: Declaration, *, wants: ForceLimits, rest_radius: Any, balls: Balls | None, springs: Sequence[SpringSet]
) -> None:
    """Declare the limit that balls and springs stand beside each other on one circle.

    Parameters
    ----------
    d : Declaration
        Takes the declarations.
    wants : ForceLimits
        Requirements.
    rest_radius : symbol
        Radius of the circle [m].
    balls : Balls or None
        Balls, where there are some.
    springs : sequence of SpringSet
        All springs.
    """
    taken: Any = sum(spring_set.share_of_circle(wants.pocket_gap) for spring_set in springs)
    if balls is not None:
        taken = taken + balls.count * (balls.part.diameter + wants.pocket_gap)
    d.at_most(
        "pitch_circle_room",
        taken,
        2 * np.pi * rest_radius,
        "mm",
        text="Balls and springs have room on the circle of the balls"
        if balls is not None
        else "The springs have room on the circle of the weights",
        source="geometry",
    )
