"""Outside diameter, mass and inertia of a centrifugal clutch."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from ..mechanics import centrifugal
from ..sources import DRIVE

if TYPE_CHECKING:
    from synth.declaration import Declaration

    from .body import Built
    from .duty import Duty

# Remarks only.
RIM_STRESS_MAX = 100e6  # hoop stress from which on the bursting of a rim is worth a calculation [Pa]


@dataclass(frozen=True)
class Parts:
    """Outside diameter [m], and masses of all plates, of all springs and of all parts [kg]."""

    diameter: Any
    plates: Any
    springs: Any
    mass: Any


def declare_parts(d: Declaration, *, duty: Duty, built: Built) -> Parts:
    """Declare the outside diameter, and name the masses of the parts."""
    lining, flyweights = built.lining, built.flyweights
    diameter = d.derive(
        "outer_diameter",
        "mm",
        centrifugal.outside_diameter(
            lining.outer_radius + duty.rim_width, flyweights.end_radius + flyweights.half_height + duty.wall_thickness
        ),
        symbol="D",
        text="Outside diameter over lining and flyweights, whichever reaches further",
        source="geometry",
    )
    spring_mass: Any = sum(spring_set.mass for spring_set in built.springs)
    plates = centrifugal.plates_mass(duty.steel_density, diameter, duty.hub_radius, duty.equivalent_plate_thickness)
    end_text = "Radius of the flyweights at the end of their way"
    d.step("end_radius", "mm", flyweights.end_radius, symbol="r_end", text=end_text, source="geometry")
    d.step("plates_mass", "kg", plates, symbol="m_d", text="All plates as one steel ring", source="geometry")
    d.step("spring_mass", "kg", spring_mass, symbol="m_s", text="All springs", source="geometry")
    return Parts(diameter, plates, spring_mass, plates + flyweights.mass + spring_mass)


def declare_inertia(d: Declaration, *, duty: Duty, built: Built, parts: Parts) -> None:
    """Declare the inertia, the limit of the room there is, and the remark on a fast rim."""
    flyweights, diameter = built.flyweights, parts.diameter
    d.derive(
        "inertia",
        "kg*m2",
        centrifugal.clutch_inertia(
            parts.plates,
            diameter,
            duty.hub_radius,
            flyweights.mass,
            flyweights.end_radius,
            parts.springs,
            built.rest_radius,
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
