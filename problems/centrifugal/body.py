"""The complete centrifugal clutch around its plates and flyweights, and the limits that rules of practice set it."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np

from .. import cost
from ..components.lining import wear
from ..components.shaft.model import name_boss
from ..mechanics import centrifugal
from ..practice import UNSOURCED
from ..sources import DRIVE

if TYPE_CHECKING:
    from collections.abc import Sequence

    from synth.declaration import Declaration, Part

    from ..components.springs.model import SpringSet
    from .duty import WholeDuty
    from .flyweights import Flyweights
    from .lining import Lining
    from .rules import Rules
    from .size import Parts

LEAST_WORK = 1e-3  # friction work with which a driven side without inertia counts [J]
THIN = 0.95  # of the hub that the shaft needs: one of a round size may lie a little below it
NARROW_RING = 0.75  # remarks only: inner over outer radius of a lining that spreads little heat
DISC_PLATES = 2  # flywheel and pressure plate


@dataclass(frozen=True)
class Built:
    """Parts of a clutch that are declared.

    Attributes
    ----------
    lining, rest_radius, flyweights, springs
        Lining, radius of the flyweights at rest, on which the springs stand too [m], flyweights at the end of their
        way, and all springs.
    wear : symbol
        Wear of all linings together [m].
    gap : symbol
        Travel of the plate to contact [m].
    travel : symbol
        Way along the axis for which there must be room [m].
    ball : Part or None
        The balls, where they are the flyweights.
    discs : int
        Plates beside flywheel and pressure plate.
    """

    lining: Lining
    rest_radius: Any
    flyweights: Flyweights
    springs: Sequence[SpringSet]
    wear: Any
    gap: Any
    travel: Any
    ball: Part | None = None
    discs: int = 0


def declare_bosses(d: Declaration, built: Built, duty: WholeDuty, parts: Parts) -> Parts:
    """Name further discs and a boss on either shaft; the parts with their mass."""
    lining = built.lining
    pair, rho = lining.pair, duty.steel_density
    discs = centrifugal.further_discs_mass(
        rho, lining.surfaces, lining.ratio, lining.outer_radius, duty.hub_radius, pair.density, pair.lining_thickness
    )
    bosses = 2 * duty.boss_mass(rho)
    for name, value, symbol, text in (
        ("further_plate", centrifugal.FURTHER_PLATE, "t_fp", "Plate between two friction discs"),
        ("further_core", centrifugal.FURTHER_CORE, "t_fc", "Core of a friction disc"),
        (
            "further_disc",
            centrifugal.FURTHER_PLATE + centrifugal.FURTHER_CORE,
            "t_fd",
            "Core of a friction disc with the plate beside it",
        ),
        ("cover_thickness", centrifugal.COVER, "t_cover", "Cover over the flyweights"),
    ):
        d.constant(name, "mm", 1000 * value, symbol=symbol, text=text, source=UNSOURCED)
    d.constant(
        "least_work", "J", LEAST_WORK, symbol="Q_min", text="Heat that wear is computed with at least", source=UNSOURCED
    )
    text = "Friction discs beyond the first, with a plate for each"
    d.step("further_discs_mass", "kg", discs, symbol="m_fd", text=text, source="geometry")
    d.step("boss_mass", "kg", bosses, symbol="m_boss", text="A boss on either shaft", source="geometry")
    name_boss(d, duty)
    return replace(parts, mass=parts.mass + discs + bosses)


def declare_body(d: Declaration, built: Built, duty: WholeDuty, complete: Parts) -> None:
    """Declare length, wear and cost of the whole clutch."""
    lining, flyweights = built.lining, built.flyweights
    pair = lining.pair
    length = d.derive(
        "length",
        "mm",
        centrifugal.overall_length(
            duty.equivalent_plate_thickness, lining.surfaces, pair.lining_thickness, built.travel, flyweights.width
        ),
        symbol="L",
        text="Plates, friction discs, their travel, flyweights and cover",
        source="geometry",
    )
    if duty.length_limit is not None:
        d.at_most(
            "length", length, duty.length_limit, "mm", text="The clutch fits the room along the shaft", source=DRIVE
        )
    d.advise(
        "thin_hub",
        2 * duty.hub_radius < THIN * duty.hub_diameter,
        "hub radius is below the hub that shaft diameter needs: check the hub and its key",
        source=UNSOURCED,
    )
    wear.declare_wear_life(
        d,
        pair,
        area=lining.area,
        depth=wear.depth(pair, built.wear / lining.surfaces),
        work=np.maximum(duty.engagement_energy, LEAST_WORK),
        text="Engagements, each of the heat of engagement heat, until the linings are worn by lining wear together or "
        "by wearable depth each",
    )
    _declare_cost(d, built, complete)


def _declare_cost(d: Declaration, built: Built, complete: Parts) -> None:
    lining, flyweights, springs = built.lining, built.flyweights, built.springs
    special = [
        cost.Special(
            one.part.slot + "s", one.part, amount=one.count, mass=one.mass, pieces=one.count, factor=cost.SPRING_WIRE
        )
        for one in springs
    ]
    if built.ball is not None:
        special.append(
            cost.Special("balls", built.ball, amount=flyweights.count, mass=flyweights.mass, pieces=flyweights.count)
        )
    pieces: Any = sum(one.count for one in springs)
    cost.declare_cost(
        d,
        mass=complete.mass,
        parts=lining.surfaces + DISC_PLATES + built.discs + flyweights.count + pieces,
        lining=(lining.pair, lining.area),
        special=special,
    )


def limit_discs(d: Declaration, *, rules: Rules, lining: Lining, travel: Any) -> None:
    """Declare the limits that an engineer adds to friction discs, and the remark on narrow ones.

    Parameters
    ----------
    d : Declaration
        Takes the declarations.
    rules : Rules
        What the limits go by.
    lining : Lining
        Lining.
    travel : symbol
        Travel of the plate to contact [m].
    """
    d.at_most(
        "surfaces_practice",
        lining.surfaces,
        rules.friction_surfaces_max,
        "-",
        text="So many friction surfaces are built",
        source=UNSOURCED,
    )
    d.at_least(
        "gap_per_surface",
        travel / lining.surfaces,
        rules.gap_per_surface_min,
        "mm",
        text="Each friction surface has air when released",
        source="practice, 0.3 to 0.5 mm and the run-out",
    )
    wear.limit_wear_life(d, lining.pair, rules.wear_life_min, text="The linings last long enough")
    d.advise(
        "narrow_ring",
        lining.inner_radius > NARROW_RING * lining.outer_radius,
        "lining inner radius is above 0.75 lining outer radius: a wider ring has more area for heat and wear",
        source=UNSOURCED,
    )
    if rules.allow_obsolete == "yes":
        d.advise(
            "obsolete_material",
            lining.pair.optional("new_design_allowed") < 0.5,
            "this friction pair is not allowed in new designs; use it only to re-compute an old machine",
            source="table friction_materials",
        )
