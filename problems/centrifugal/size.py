"""Outside diameter, mass and inertia of a centrifugal clutch, and its objectives."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from .. import wear
from ..mechanics import centrifugal
from ..sources import DRIVE
from .body import Surroundings, declare_body
from .duty import WholeDuty

if TYPE_CHECKING:
    from collections.abc import Sequence

    from synth.declaration import Declaration

    from ..practice import Scope
    from .duty import Duty
    from .flyweights import Flyweights
    from .lining import Lining
    from .springs import SpringSet

# Remarks only.
RIM_STRESS_MAX = 100e6  # hoop stress from which on the bursting of a rim is worth a calculation [Pa]


def declare_size(
    d: Declaration,
    *,
    duty: Duty,
    lining: Lining,
    rest_radius: Any,
    flyweights: Flyweights,
    springs: Sequence[SpringSet],
    around: Surroundings,
) -> None:
    """Declare outside diameter, mass and inertia, the limit of the room there is, and what a whole clutch has beside.

    Parameters
    ----------
    d : Declaration
        Takes the declarations.
    duty : Duty
        Requirements.
    lining : Lining
        Lining.
    rest_radius : symbol
        Radius of the flyweights at rest, on which the springs stand too [m].
    flyweights : Flyweights
        Flyweights at the end of their way.
    springs : sequence of SpringSet
        All springs.
    around : Surroundings
        What the whole clutch adds to plates, flyweights and springs.
    """
    diameter = d.derive(
        "outer_diameter",
        "mm",
        centrifugal.outside_diameter(
            lining.outer_radius + duty.rim_width,
            flyweights.end_radius + flyweights.half_height + duty.wall_thickness,
        ),
        symbol="D",
        text="Outside diameter over lining and flyweights, whichever reaches further",
        source="geometry",
    )
    spring_mass: Any = sum(spring_set.mass for spring_set in springs)
    plates = centrifugal.plates_mass(duty.steel_density, diameter, duty.hub_radius, duty.equivalent_plate_thickness)
    mass = plates + flyweights.mass + spring_mass
    end_text = "Radius of the flyweights at the end of their way"
    d.step("end_radius", "mm", flyweights.end_radius, symbol="r_end", text=end_text, source="geometry")
    d.step("plates_mass", "kg", plates, symbol="m_d", text="All plates as one steel ring", source="geometry")
    d.step("spring_mass", "kg", spring_mass, symbol="m_s", text="All springs", source="geometry")
    counted = "Plates (as a steel ring of equivalent plate thickness), flyweights and springs"
    if isinstance(duty, WholeDuty):
        declare_body(
            d,
            duty=duty,
            lining=lining,
            flyweights=flyweights,
            springs=springs,
            around=around,
            part_mass=mass,
            counted=counted,
        )
    else:
        d.derive("mass", "kg", mass, symbol="m", text=counted, source="geometry")
    d.derive(
        "inertia",
        "kg*m2",
        centrifugal.clutch_inertia(
            plates, diameter, duty.hub_radius, flyweights.mass, flyweights.end_radius, spring_mass, rest_radius
        ),
        symbol="J",
        text="Inertia of plates, flyweights at the end of their way, and springs",
        source="geometry",
    )
    if duty.outer_diameter_limit is not None:
        d.at_most(
            "outer_diameter",
            diameter,
            duty.outer_diameter_limit,
            "mm",
            text="The clutch fits the room across",
            source=DRIVE,
        )
    text = "Hoop stress of the rim above which its bursting is worth a calculation"
    d.constant(
        "rim_stress_max",
        "N/mm2",
        RIM_STRESS_MAX / 1e6,
        symbol="sigma_rim",
        text=text,
        source="hoop stress of a thin ring",
    )
    d.advise(
        "fast_rim",
        centrifugal.rim_stress(duty.steel_density, diameter / 2, duty.top_speed) > RIM_STRESS_MAX,
        "at top speed the hoop stress of the rim is above 100 N/mm2: calculate the speed at which it bursts",
        source="hoop stress of a thin ring",
    )


def declare_objectives(d: Declaration, *, scope: Scope) -> None:
    """Declare the objectives of all centrifugal clutches, and those of what is around them where the scope asks."""
    d.headline(
        "outer_diameter",
        "mass",
        "length",
        "friction_surfaces",
        "contact_speed",
        "engagement_band",
        "clamp_force",
        "lining_pressure",
        sized_by="torque_worn" if "torque_worn" in d.limits else "torque_at_full_speed",
    )
    d.objective("outer_diameter")
    d.objective("mass")
    if scope.whole:
        d.objective("length", default=False)
        wear.offer_wear_life(d)
    d.objective("engagement_band", default=False)
    d.objective("idle_margin", "max", default=False)
