"""Discs and pressure plates in a section, their hubs and cover, and a detail of a lining.

The discs are drawn released, as their room is computed: a gap at each of their faces.
"""

from __future__ import annotations

from dataclasses import dataclass

from synth.drawing import Balloon, Detail, Dimension, Drawable, Edge, Hatch, Item, Line, LineKind, Weight, diameter

from ...drawing_parts import Sizes, envelope, ring
from ..drawn import DrawnComponent
from ..lining.drawing import DrawnLining, drawn_lining
from ..ring.drawing import drawn_ring
from ..shaft.drawing import drawn_shaft

CORE, LINING, PLATE, HUB = 1, 2, 3, 4


@dataclass(frozen=True)
class DrawnDiscs(DrawnComponent):
    """Discs, each with its pressure plate behind it, and places of them that others need [mm].

    Attributes
    ----------
    start, end : float
        Ends of discs and pressure plates.
    cores : tuple of float
        Left face of the first core, and right face of the last one.
    hub_radius : float
        Inner edge of the cores.
    inside : float
        Inner radius of the friction ring.
    below : Edge
        Where part numbers stand.
    """

    start: float = 0.0
    end: float = 0.0
    cores: tuple[float, float] = (0.0, 0.0)
    hub_radius: float = 0.0
    inside: float = 0.0
    below: Edge = "left"

    def hub_diameter(self, x: float | None = None) -> Dimension:
        """Diameter of the inner edge of the cores, by default measured at the first one."""
        return diameter(self.cores[0] if x is None else x, self.hub_radius, "disc_hub_radius", side="left", factor=2.0)

    def cover(self, across: float, end: float | None = None) -> DrawnComponent:
        """Outside of the cover of a radius, to the end of the discs, or closed at a further place along the axis."""
        lines = [((self.start, self.hub_radius), (self.start, across))]
        lines.append(((self.start, across), (self.end if end is None else end, across)))
        if end is not None:
            lines.append(((end, across), (end, self.inside)))
        return DrawnComponent(tuple(Line(p, q, LineKind.PHANTOM) for p, q in lines))


def drawn_discs(size: Sizes, start: float, *, side: Edge = "right", top: float | None = None) -> DrawnDiscs:
    """Released discs, each with its pressure plate behind it.

    Parameters
    ----------
    size : Sizes
    start : float
        Where they begin along the axis [mm].
    side : {"right", "left"}
        Where their diameters are measured; part numbers stand at the left, or below where that side is taken.
    top : float, optional
        Radius at which dimensions along the axis begin, by default that of the ring [mm].
    """
    listed = size.part("facing_set")
    lining = drawn_lining(size, "facing_set.facing_thickness" if listed else "")
    across, hub = drawn_ring(size), size("disc_hub_radius")
    gap, core, plate = size("plate_gap"), size("core_thickness"), size("pressure_plate_thickness")
    count, shapes = size.count("discs"), list[Drawable]()
    cores, plates = [], []
    x = start
    for _ in range(count):
        x += gap
        shapes.append(across.facing(x, x + lining.thickness, LINING))
        x += lining.thickness
        shapes.append(ring(x, x + core, hub, across.outside, CORE))
        cores.append((x, x + core))
        x += core
        shapes.append(across.facing(x, x + lining.thickness, LINING))
        x += lining.thickness + gap
        shapes.append(across.facing(x, x + plate, PLATE))
        plates.append((x, x + plate))
        x += plate
    first, last = cores[0], plates[-1]
    below: Edge = "left" if side == "right" else "bottom"
    y = across.outside if top is None else top
    return DrawnDiscs(
        tuple(shapes),
        (
            Item(CORE, "Disc, core", count, "steel", hatch=Hatch.RIGHT),
            Item(LINING, "Lining", 2 * count, listed or lining.material, "on both sides of every disc", Hatch.CROSS),
            Item(PLATE, "Pressure plate", count, hatch=Hatch.LEFT),
        ),
        (
            Balloon((first[0] - lining.thickness / 2, across.below(0.7)), LINING, below),
            Balloon(((first[0] + first[1]) / 2, -(hub + across.inside) / 2), CORE, below),
            Balloon(((last[0] + last[1]) / 2, across.below(0.5)), PLATE, below),
        ),
        (
            Dimension((last[0], y), (last[1], y), "pressure_plate_thickness", "top"),
            *across.diameters(last[1] if side == "right" else start, side),
        ),
        (_detail(start, first, plates[0], lining, gap=gap, outside=across.outside),),
        (
            Weight((CORE,), ("core_mass",), "steel_density"),
            lining.weight(LINING, "lining_mass"),
            Weight((PLATE,), ("pressure_plate_mass",), "pressure_plate_density", times=1 / count),
        ),
        start=start,
        end=x,
        cores=(first[0], cores[-1][1]),
        hub_radius=hub,
        inside=across.inside,
        below=below,
    )


def _detail(
    start: float,
    core: tuple[float, float],
    plate: tuple[float, float],
    lining: DrawnLining,
    *,
    gap: float,
    outside: float,
) -> Detail:
    """Detail of the first disc at its rim."""
    pitch = plate[0] - start
    y, face = outside - 0.4 * pitch, core[0] - lining.thickness
    right = plate[0] + min(0.5 * pitch, plate[1] - plate[0])
    return Detail(
        "X",
        (start - 0.15 * pitch, outside - 0.8 * pitch, right, outside + 0.25 * pitch),
        (
            Dimension((start, y), (face, y), "plate_gap", "bottom"),
            Dimension((face, y), (core[0], y), lining.name, "bottom"),
            Dimension((core[0], y), (core[1], y), "core_thickness", "bottom"),
        ),
        least=min(lining.thickness, 3 * gap, core[1] - core[0]),
    )


def hubs_are_known(size: Sizes) -> bool:
    """Whether a design has hubs, and a length of its discs beside that of the clutch."""
    return "pack_length" in size.design.values


def drawn_hubs(size: Sizes, discs: DrawnDiscs, across: float) -> DrawnComponent:
    """Hubs of discs whose shaft goes out at the right, as far as they are known; lengths begin at a radius [mm]."""
    if not hubs_are_known(size):
        return DrawnComponent(dimensions=(discs.hub_diameter(),))
    left, right, hubs = _hubs(size, discs)
    shaft = drawn_shaft(size)
    measured = (
        Dimension((discs.start, across), (discs.end, across), "pack_length", "top"),
        shaft.as_long(left, -discs.hub_radius),
        discs.hub_diameter(left),
    )
    return shaft.drawn((left, right)) + hubs + DrawnComponent(dimensions=measured)


def cover_thickness(size: Sizes) -> float:
    """Thickness of the cover [mm]."""
    return size("cover_thickness")


def hubs_behind_cover(size: Sizes, discs: DrawnDiscs, across: float, top: float) -> DrawnComponent:
    """Hubs of discs whose shaft goes out at the left through the face of the cover, and the room of that.

    Parameters
    ----------
    size : Sizes
    discs : DrawnDiscs
        Which begin behind the face.
    across : float
        Radius of the cover [mm].
    top : float
        Radius at which dimensions along the axis begin [mm].
    """
    left, right, hubs = _hubs(size, discs)
    face = DrawnComponent(
        envelope(0.0, discs.start, discs.hub_radius, across),
        dimensions=(Dimension((0.0, top), (discs.start, top), "cover_thickness", "top"),),
    )
    return drawn_shaft(size).drawn((right, min(left, 0.0))) + face + hubs


def _hubs(size: Sizes, discs: DrawnDiscs) -> tuple[float, float, DrawnComponent]:
    """Hubs side by side in the middle of their discs, and where they begin and end."""
    shaft, hub, count = drawn_shaft(size).radius, discs.hub_radius, size.count("discs")
    long = 2 * shaft
    left = (discs.cores[0] + discs.cores[1] - count * long) / 2
    hubs = DrawnComponent(
        tuple(ring(left + k * long, left + (k + 1) * long, shaft, hub, HUB) for k in range(count)),
        (Item(HUB, "Hub of a disc", count, "steel", "place along the shaft assumed", Hatch.LEFT),),
        (Balloon((left + long / 2, -(shaft + hub) / 2), HUB, discs.below),),
        weights=(Weight((HUB,), ("hub_mass",), "steel_density"),),
    )
    return left, left + count * long, hubs
