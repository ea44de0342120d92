"""Lining of a centrifugal clutch: shape, heat of an engagement, wear and air when released."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from ..mechanics import centrifugal, heat, ring

if TYPE_CHECKING:
    from synth.declaration import Declaration, Part

    from ..components.lining.allowed import Makers
    from .duty import Duty

SUITED = ("'disc facing' in surfaces or 'plate pack' in surfaces", "long_slip == 1")
# Remarks only.
RELEASE_GAP_MIN = 0.3e-3  # clearance that a released friction surface wants [m]


@dataclass(frozen=True)
class Lining:
    """Friction surfaces of the clutch."""

    inner_radius: Any
    outer_radius: Any
    ratio: Any
    surfaces: Any
    pair: Part
    linings: Makers

    @property
    def area(self) -> Any:
        """Area of all linings [m2]."""
        return centrifugal.lining_area(self.surfaces, self.inner_radius, self.outer_radius)

    @property
    def friction_radius(self) -> Any:
        """Friction radius of the worn-in lining [m]."""
        return centrifugal.lining_radius(self.inner_radius, self.outer_radius)

    def torque(self, force: Any) -> Any:
        """Return the torque of an axial force [N m]."""
        return ring.friction_torque(self.pair.mu_dynamic, force, self.friction_radius, self.surfaces)

    def force(self, torque: Any) -> Any:
        """Return the axial force that a torque needs [N]."""
        return centrifugal.force_for_torque(torque, self.pair.mu_dynamic, self.surfaces, self.friction_radius)


def declare_lining(d: Declaration, *, duty: Duty, linings: Makers) -> Lining:
    """Declare lining and slot friction_pair, with the limits of its shape and of the heat of an engagement.

    Parameters
    ----------
    d : Declaration
        Takes the declarations.
    duty : Duty
        Requirements.
    linings : Makers
        What linings stand, with further conditions on their rows.

    Returns
    -------
    Lining
        Symbols of the block.
    """
    inner = d.variable(
        "lining_inner_radius",
        "mm",
        20,
        250,
        grid=0.5,
        symbol="r_i",
        text="Inner radius of the lining",
        source="geometry",
    )
    outer = d.variable(
        "lining_outer_radius",
        "mm",
        30,
        300,
        grid=0.5,
        symbol="r_o",
        text="Outer radius of the lining",
        source="geometry",
    )
    surfaces = d.count(
        "friction_surfaces",
        2,
        8,
        step=2,
        symbol="z_f",
        text="Friction surfaces, two per friction disc",
        source="geometry",
    )
    pair = d.part(
        "friction_pair",
        "friction_materials",
        where=(*SUITED, *linings.conditions(d)),
        symbol="pair",
        text="Lining and the plate it rubs on",
        source="table friction_materials",
    )
    ratio = inner / outer
    d.at_least(
        "ring_ratio_min",
        ratio,
        duty.ring_ratio_min,
        "-",
        text="The lining is not too wide: it wears evenly",
        source="practice",
    )
    d.at_most("ring_ratio_max", ratio, duty.ring_ratio_max, "-", text="The lining is not too narrow", source="practice")
    lining = Lining(inner, outer, ratio, surfaces, pair, linings)
    for name, unit, value, symbol, text in (
        ("lining_area", "cm2", lining.area, "A_l", "All linings"),
        ("friction_radius", "mm", lining.friction_radius, "r_f", "Friction radius of the worn-in lining"),
        ("engagement_energy", "J", duty.engagement_energy, "Q_e", "Heat of one engagement"),
    ):
        d.step(name, unit, value, symbol=symbol, text=text, source="geometry" if unit != "J" else "energy balance")
    allowed = duty.engagement_heat_limit
    d.at_most(
        "engagement_heat",
        heat.single_heat(duty.engagement_energy, lining.area),
        pair.optional("q_single_allow") if allowed is None else allowed,
        "J/mm2",
        text="The lining stands the heat of bringing driven inertia up to full torque speed, without a load torque",
        source="energy balance",
    )
    d.advise(
        "bad_ring",
        inner >= outer,
        "lining inner radius is not below lining outer radius: this is no lining, and its other figures mean nothing",
        source="geometry",
    )
    return lining


def declare_wear(d: Declaration) -> Any:
    """Declare the wear of the linings that the types with capped clamp force must stand, and return it [m]."""
    return d.requirement(
        "lining_wear",
        "mm",
        0.6,
        lower=0,
        upper=10,
        symbol="wear",
        text="Wear of all linings together, by which the pressure plate travels further",
        source="practice",
        group="material",
    )


def advise_release_gap(d: Declaration, *, gap: Any, lining: Lining) -> None:
    """Remark where the gap of the plate leaves each friction surface too little air.

    Parameters
    ----------
    d : Declaration
        Takes the declarations.
    gap : symbol
        Travel of the plate to contact [m].
    lining : Lining
        Lining.
    """
    text = "Clearance that a released friction surface wants"
    least = 1000 * RELEASE_GAP_MIN
    d.constant("surface_gap_least", "mm", least, symbol="gap_1", text=text, source="practice, 0.3 to 0.5 mm")
    d.advise(
        "drags_when_released",
        gap < RELEASE_GAP_MIN * lining.surfaces,
        "the travel to contact leaves less than 0.3 mm for each friction surface: the released clutch drags",
        source="practice, 0.3 to 0.5 mm and the run-out",
    )
