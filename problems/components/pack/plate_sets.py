"""Plates of a list: each row is an inner and an outer plate that fit together."""

from __future__ import annotations

from typing import Any

from synth.declaration import Declaration, Part

from ..bought import declare_bought, limit_bought
from ..lining.model import Pair
from ..ring.model import Ring
from .model import Pack, Plates
from .requirements import PackRequirements

TABLE = "plate_sets"


def declare_plate_set(d: Declaration) -> Part | None:
    """Declare the option plates, and the slot plate_set where plates are those of a list.

    Parameters
    ----------
    d : Declaration
        Takes the declarations.

    Returns
    -------
    Part or None
        The row of the list; None where plates are made to size.
    """
    text = "Inner and outer plate that fit together"
    return declare_bought(d, slot="plate_set", table=TABLE, made="ring, cores and splines", text=text)


def standard_plates(row: Part, *, wants: PackRequirements, ring: Ring) -> Plates:
    """Return the plates of a row.

    Parameters
    ----------
    row : Part
        Row of plate_sets.
    wants : PackRequirements
        Requirements of the pack, which know how many of all teeth carry.
    ring : Ring
        Block ring, with the diameters of the row.

    Returns
    -------
    Plates
        Cores, splines, teeth and lining of the row.
    """
    a, b = row.inner_spline_diameter / 2, row.outer_spline_diameter / 2
    return Plates(
        inner_thickness=row.inner_core_thickness,
        outer_thickness=row.outer_core_thickness,
        inner_spline_radius=a,
        outer_spline_radius=b,
        inner_mean_diameter=ring.outer_radius + a,
        inner_width=ring.outer_radius - a,
        outer_mean_diameter=b + ring.inner_radius,
        outer_width=b - ring.inner_radius,
        spline_mean_diameter=b + a,
        spline_width=b - a,
        inner_lug_count=wants.carrying(row.inner_teeth),
        inner_lug_height=row.tooth_height,
        outer_lug_count=wants.carrying(row.outer_teeth),
        outer_lug_height=row.tooth_height,
        lining_thickness=row.lining_thickness,
    )


def declare_set_limits(d: Declaration, row: Part, *, pair: Pair, pack: Pack, pressure: Any) -> None:
    """Declare what a list says of its plates: which lining they carry, how many surfaces, how much pressure.

    Parameters
    ----------
    d : Declaration
        Takes the declarations.
    row : Part
        Row of plate_sets.
    pair : Pair
        Slot friction_pair.
    pack : Pack
        The pack.
    pressure : symbol
        Largest pressure on the linings [Pa].
    """
    d.at_most(
        "set_surfaces",
        pack.surfaces,
        row.optional("surfaces_max"),
        "-",
        text="No more surfaces than the list of the plates allows",
        source=f"table {TABLE}",
    )
    limit_bought(d, row, table=TABLE, what="plates", lined="plates with the lining", pair=pair, pressure=pressure)
