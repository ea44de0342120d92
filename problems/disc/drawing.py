"""Drawing of a disc clutch: section through discs and pressure plates, and a detail of a lining.

The discs are drawn released, as their room is computed: a gap at each of their faces.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from synth import Design
from synth.drawing import (
    Balloon,
    Detail,
    Dimension,
    Drawable,
    Drawing,
    Hatch,
    Item,
    Line,
    LineKind,
    View,
    Weight,
    diameter,
)

from ..drawing_parts import NEIGHBOURS, SHAFT_OUT, Sizes, ring, shaft_end

CORE, LINING, PLATE, HUB = 1, 2, 3, 4


@dataclass(frozen=True)
class DrawnDiscs:
    """Discs and pressure plates from a place along the axis [mm]: shapes, ends, and places of cores and plates."""

    shapes: tuple[Drawable, ...]
    lining_name: str
    start: float
    end: float
    cores: tuple[tuple[float, float], ...]
    plates: tuple[tuple[float, float], ...]


def drawn_discs(size: Sizes, start: float) -> DrawnDiscs:
    """Return released discs, each with its pressure plate behind it, from a place along the axis [mm]."""
    listed = "facing_set" in size.design.parts
    name = "facing_set.facing_thickness" if listed else "friction_pair.lining_thickness"
    inside, outside = size("ring_inner_diameter") / 2, size("ring_outer_diameter") / 2
    gap, lining, hub = size("plate_gap"), size(name), size("disc_hub_radius")
    core, plate = size("core_thickness"), size("pressure_plate_thickness")
    shapes: list[Drawable] = []
    cores, plates = [], []
    x = start
    for _ in range(size.count("discs")):
        x += gap
        shapes.append(ring(x, x + lining, inside, outside, LINING))
        x += lining
        shapes.append(ring(x, x + core, hub, outside, CORE))
        cores.append((x, x + core))
        x += core
        shapes.append(ring(x, x + lining, inside, outside, LINING))
        x += lining + gap
        shapes.append(ring(x, x + plate, inside, outside, PLATE))
        plates.append((x, x + plate))
        x += plate
    return DrawnDiscs(tuple(shapes), name, start, x, tuple(cores), tuple(plates))


def disc_items(size: Sizes) -> list[Item]:
    """Return the lines of the parts list for discs and pressure plates."""
    discs = size.count("discs")
    lining = size.part("facing_set") or size.part("friction_pair")
    return [
        Item(CORE, "Disc, core", discs, "steel", hatch=Hatch.RIGHT),
        Item(LINING, "Lining", 2 * discs, lining, "on both sides of every disc", Hatch.CROSS),
        Item(PLATE, "Pressure plate", discs, hatch=Hatch.LEFT),
    ]


def disc_balloons(size: Sizes, discs: DrawnDiscs) -> list[Balloon]:
    """Return the part numbers of discs and pressure plates, to the left of the lower half."""
    inside, outside = size("ring_inner_diameter") / 2, size("ring_outer_diameter") / 2
    core, plate, lining = discs.cores[0], discs.plates[-1], size(discs.lining_name)
    return [
        Balloon((core[0] - lining / 2, -(inside + 0.7 * (outside - inside))), LINING),
        Balloon(((core[0] + core[1]) / 2, -(size("disc_hub_radius") + inside) / 2), CORE),
        Balloon(((plate[0] + plate[1]) / 2, -(inside + 0.5 * (outside - inside))), PLATE),
    ]


def disc_weights(size: Sizes) -> list[Weight]:
    """Return the masses that the areas of discs and pressure plates give."""
    return [
        Weight((CORE,), ("core_mass",), "steel_density"),
        Weight((LINING,), ("lining_mass",), "friction_pair.density"),
        Weight((PLATE,), ("pressure_plate_mass",), "pressure_plate_density", times=1 / size.count("discs")),
    ]


def disc_detail(size: Sizes, discs: DrawnDiscs, letter: str = "X") -> Detail:
    """Return the detail of the first disc at its rim."""
    core, plate = discs.cores[0], discs.plates[0]
    lining, gap = size(discs.lining_name), size("plate_gap")
    outside = size("ring_outer_diameter") / 2
    pitch = plate[0] - discs.start
    high = outside + 0.25 * pitch
    y = outside - 0.4 * pitch
    window = (discs.start - 0.15 * pitch, outside - 0.8 * pitch, plate[0] + min(0.5 * pitch, plate[1] - plate[0]), high)
    return Detail(
        letter,
        window,
        (
            Dimension((discs.start, y), (core[0] - lining, y), "plate_gap", "bottom"),
            Dimension((core[0] - lining, y), (core[0], y), discs.lining_name, "bottom"),
            Dimension((core[0], y), (core[1], y), "core_thickness", "bottom"),
        ),
        least=min(lining, 3 * gap, core[1] - core[0]),
    )


def disc_drawing(spec: Mapping[str, Any], design: Design) -> Drawing:
    """Return the drawing of a disc clutch.

    Parameters
    ----------
    spec : mapping
        What the hook is told.
    design : Design
        The design; where its length is that of the whole clutch, hubs and shaft are drawn.
    """
    size = Sizes(spec, design)
    discs = drawn_discs(size, 0.0)
    across, hub = size("outer_diameter") / 2, size("disc_hub_radius")
    end = size("length")
    outside = (
        Line((0.0, hub), (0.0, across), LineKind.PHANTOM),
        Line((0.0, across), (end, across), LineKind.PHANTOM),
        Line((end, across), (end, size("ring_inner_diameter") / 2), LineKind.PHANTOM),
    )
    items, balloons, weights = disc_items(size), disc_balloons(size, discs), disc_weights(size)
    inside, rim = size("ring_inner_diameter") / 2, size("ring_outer_diameter") / 2
    plate = discs.plates[-1]
    dimensions = [
        Dimension((0.0, across), (end, across), "length", "top"),
        Dimension((plate[0], rim), (plate[1], rim), "pressure_plate_thickness", "top"),
        diameter(end, across, "outer_diameter"),
        diameter(plate[1], rim, "ring_outer_diameter"),
        diameter(plate[1], inside, "ring_inner_diameter"),
    ]
    shapes: list[Drawable] = [*outside, *discs.shapes]
    omitted = [
        "flywheel but for its face",
        "rivets and cushion springs of the linings, torsion damper",
    ]
    if "pack_length" in design.values:
        shaft, long = size("shaft_diameter") / 2, size("shaft_diameter")
        count = size.count("discs")
        middle = (discs.cores[0][0] + discs.cores[-1][1]) / 2
        left = middle - count * long / 2
        hubs = [ring(left + k * long, left + (k + 1) * long, shaft, hub, HUB) for k in range(count)]
        ends = shaft_end(left, left + count * long, shaft, broken=2 * shaft * SHAFT_OUT)
        shapes = [*ends, *hubs, *shapes]
        items.append(Item(HUB, "Hub of a disc", count, "steel", "place along the shaft assumed", Hatch.LEFT))
        balloons.append(Balloon((left + long / 2, -(shaft + hub) / 2), HUB))
        weights.append(Weight((HUB,), ("hub_mass",), "steel_density"))
        dimensions += [
            Dimension((0.0, across), (discs.end, across), "pack_length", "top"),
            Dimension((left, -hub), (left + long, -hub), "shaft_diameter", "bottom"),
            diameter(left, shaft, "shaft_diameter", side="left"),
            diameter(left, hub, "disc_hub_radius", side="left", factor=2.0),
        ]
        omitted += ["cover and diaphragm spring: the model knows their masses and the room they take", "splines"]
        title, where = "longitudinal section, released", "places of the hubs along the shaft are assumed"
    else:
        dimensions.append(diameter(discs.cores[0][0], hub, "disc_hub_radius", side="left", factor=2.0))
        omitted += ["cover, springs, hub and shaft: mass and length are those of discs and pressure plates"]
        title, where = "discs and pressure plates, released", "each pressure plate stands behind its disc"
    view = View(
        "Section", tuple(shapes), tuple(dimensions), tuple(balloons), (disc_detail(size, discs),), revolved=True
    )
    return Drawing(
        title,
        (view,),
        tuple(items),
        omitted=tuple(omitted),
        remarks=(
            f"The discs are drawn released; {where}. Pressure plates are drawn as wide as the friction ring, as their "
            "mass is computed.",
            NEIGHBOURS,
        ),
        weights=tuple(weights),
    )
