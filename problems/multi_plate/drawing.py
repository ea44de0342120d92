"""Drawing of a multi-plate clutch: section through pack, drum and hub, and a detail of the plates.

The pack is drawn released, as its length is computed. Plates reach to the mean radii of their splines, as the mass
formulas have them.
"""

from __future__ import annotations

from dataclasses import dataclass

from synth.drawing import (
    Area,
    Balloon,
    Detail,
    Dimension,
    Drawable,
    Drawing,
    Edge,
    Hatch,
    Item,
    View,
    Weight,
    diameter,
)

from ..drawing_parts import NEIGHBOURS, SHAFT_OUT, Sizes, envelope, ring, shaft_end

INNER, OUTER, LINING, END, DRUM, HUB, PISTON = 1, 2, 3, 4, 5, 6, 7
TEETH = "teeth of the splines: plates are drawn to the mean radius of their spline, as the masses are computed"
BORES = "shafts, keys and what holds the hubs along the shaft"


@dataclass(frozen=True)
class PackNames:
    """What the quantities of a pack are called in a design."""

    inner: str
    outer: str
    lining: str


@dataclass(frozen=True)
class DrawnPack:
    """The plates of a pack from a place along the axis [mm]: shapes, where it ends, and places of some of its parts."""

    shapes: tuple[Drawable, ...]
    names: PackNames
    start: float
    end: float
    inner_plate: tuple[float, float]  # between two gaps
    outer_plate: tuple[float, float]
    last_outer: tuple[float, float]
    gap: float


def pack_names(size: Sizes) -> PackNames:
    """Names of the sizes of the plates: of parts chosen one by one, or of a list."""
    if "plate_set" in size.design.parts:
        return PackNames(
            "plate_set.inner_core_thickness", "plate_set.outer_core_thickness", "plate_set.lining_thickness"
        )
    return PackNames("inner_plate.thickness", "outer_plate.thickness", "friction_pair.lining_thickness")


def drawn_pack(size: Sizes, start: float, *, first: str, last: str) -> DrawnPack:
    """Return the plates of a released pack.

    Parameters
    ----------
    size : Sizes
    start : float
        Where it begins along the axis [mm].
    first, last : str
        Names of the thickness of the first and the last inner plate: end plates may be thicker.
    """
    names = pack_names(size)
    a, b = size("inner_spline_radius"), size("outer_spline_radius")
    inside, outside = size("ring_inner_diameter") / 2, size("ring_outer_diameter") / 2
    gap, lining = size("release_gap"), size(names.lining)
    outer_plates = size.count("outer_plates")
    shapes: list[Drawable] = []
    inner_at, outer_at = [], []
    x = start
    for k in range(outer_plates + 1):
        name = first if k == 0 else last if k == outer_plates else names.inner
        thick = size(name)
        shapes.append(ring(x, x + thick, a, outside, END if name == "end_plate_thickness" else INNER))
        inner_at.append((x, x + thick))
        x += thick
        if k == outer_plates:
            break
        x += gap
        shapes.append(ring(x, x + lining, inside, outside, LINING))
        x += lining
        core = size(names.outer)
        shapes.append(ring(x, x + core, inside, b, OUTER))
        outer_at.append((x, x + core))
        x += core
        shapes.append(ring(x, x + lining, inside, outside, LINING))
        x += lining + gap
    return DrawnPack(tuple(shapes), names, start, x, inner_at[len(inner_at) // 2], outer_at[0], outer_at[-1], gap)


def pack_items(size: Sizes, pack: DrawnPack, end_plates: int = 0) -> list[Item]:
    """Return the lines of the parts list for the plates of a pack."""
    listed = size.part("plate_set")
    cores = size.count("inner_plates") - end_plates
    plates = size.count("outer_plates")
    found = [Item(INNER, "Inner plate", cores, listed or size.part("inner_plate"), hatch=Hatch.LEFT)] if cores else []
    found.append(Item(OUTER, "Outer plate, core", plates, listed or size.part("outer_plate"), hatch=Hatch.RIGHT))
    pair = size.part("friction_pair")
    found.append(Item(LINING, "Lining", 2 * plates, pair, "on both sides of every outer plate", Hatch.CROSS))
    if end_plates:
        found.append(Item(END, "End plate", end_plates, "steel"))
    return found


def pack_detail(size: Sizes, pack: DrawnPack, *, wall: float, letter: str = "X") -> Detail:
    """Return the detail of the first plates at the drum.

    Parameters
    ----------
    size : Sizes
    pack : DrawnPack
    wall : float
        Drum outside of the mean spline radius [mm].
    letter : str
    """
    lining, b = size(pack.names.lining), size("outer_spline_radius")
    core = pack.outer_plate
    outside = size("ring_outer_diameter") / 2
    inner = size(pack.names.inner)
    pitch = core[1] - core[0] + 2 * (lining + pack.gap) + inner
    low = core[0] - lining - pack.gap
    high = min(pack.end, core[1] + lining + pack.gap + pitch * 0.35)
    window_low = low - pitch * 0.42
    y0 = outside - 0.7 * pitch
    window = (window_low, y0, high, b + wall)
    y = outside - 0.35 * pitch
    names = pack.names
    dimensions = (
        Dimension((low, y), (low + pack.gap, y), "release_gap", "bottom"),
        Dimension((low + pack.gap, y), (core[0], y), names.lining, "bottom"),
        Dimension((core[0], y), (core[1], y), names.outer, "bottom"),
        Dimension((high, b), (high, b + wall), "drum_wall", "right"),
    )
    return Detail(letter, window, dimensions, least=min(lining, core[1] - core[0]))


def pack_drawing(size: Sizes) -> Drawing:
    """Drawing of a pack, with the room of its drum."""
    names = pack_names(size)
    pack = drawn_pack(size, 0.0, first=names.inner, last=names.inner)
    b, wall = size("outer_spline_radius"), size("drum_wall")
    view = View(
        "Section",
        (*pack.shapes, *envelope(pack.start, pack.end, b, b + wall)),
        (
            Dimension((pack.start, b + wall), (pack.end, b + wall), "length", "top"),
            *pack_diameters(size, pack.end),
            diameter(pack.end, b + wall, "outer_diameter"),
        ),
        pack_balloons(size, pack),
        (pack_detail(size, pack, wall=wall),),
        revolved=True,
    )
    return Drawing(
        "plate pack, released",
        (view,),
        tuple(pack_items(size, pack)),
        omitted=(
            TEETH,
            "drum but for its wall, hub, shaft, end stops and actuator: mass and length are those of the plates",
            *omitted_aid(size),
        ),
        remarks=(NEIGHBOURS,),
        weights=(
            Weight((INNER,), ("inner_plate_mass",), "steel_density"),
            Weight((OUTER,), ("outer_plate_mass",), "steel_density"),
            Weight((LINING,), ("lining_mass",), "friction_pair.density"),
        ),
    )


def clutch_drawing(size: Sizes, *, piston: bool) -> Drawing:
    """Drawing of a complete clutch, with drum, hub and actuator; a ring piston presses, or something outside."""
    bottom = size("end_plate_thickness")
    room = size("actuator_length") if piston else 0.0
    pack = drawn_pack(size, bottom + room, first="end_plate_thickness", last="end_plate_thickness")
    a, b, wall = size("inner_spline_radius"), size("outer_spline_radius"), size("drum_wall")
    shaft, boss = size("shaft_diameter") / 2, size("boss_diameter") / 2
    out, long, rim = size("boss_length"), pack.end, size("rim_radius")
    drum = Area(
        (
            (-out, shaft), (bottom, shaft), (bottom, b), (long, b), (long, b + wall), (0.0, b + wall), (0.0, boss),
            (-out, boss),
        ),
        DRUM,
    )  # fmt: skip
    web = long - bottom
    hub = Area(
        (
            (pack.start, rim), (web, rim), (web, shaft), (long + out, shaft), (long + out, boss), (long, boss),
            (long, a), (pack.start, a),
        ),
        HUB,
    )  # fmt: skip
    actuator = envelope(bottom, bottom + room, a, b) if piston else ()
    broken = 2 * shaft * SHAFT_OUT
    shapes = (
        *shaft_end(bottom, -out, shaft, broken=broken),
        *shaft_end(web, long + out, shaft, broken=broken),
        drum, hub, *pack.shapes, *actuator,
    )  # fmt: skip
    lengths = [
        Dimension((0.0, b + wall), (long, b + wall), "length", "top"),
        Dimension((pack.start, b + wall), (long, b + wall), "hub_length", "top"),
        Dimension((0.0, b + wall), (bottom, b + wall), "end_plate_thickness", "top"),
        Dimension((-out, boss), (0.0, boss), "boss_length", "top"),
        Dimension((long, boss), (long + out, boss), "boss_length", "top"),
    ]
    if piston:
        lengths.append(Dimension((bottom, b + wall), (bottom + room, b + wall), "actuator_length", "top"))
    items = pack_items(size, pack, 2)
    items += [
        Item(DRUM, "Drum with bottom and boss", 1, "steel", "place of the boss assumed", Hatch.LEFT),
        Item(HUB, "Hub: rim, web and boss", 1, "steel", "places of web and boss assumed", Hatch.RIGHT),
    ]
    balloons = [
        *pack_balloons(size, pack, 2),
        Balloon(((pack.end + pack.last_outer[1]) / 2 + 0.2 * bottom, -(rim + 0.8 * (a - rim) + (b - a) * 0.3)), END),
        Balloon((bottom / 2, -(boss + b) / 2), DRUM, "left"),
        Balloon((web + bottom / 2, -(boss + rim) / 2 if rim > boss else -(boss - 0.2 * (boss - shaft))), HUB, "right"),
    ]  # fmt: skip
    view = View(
        "Section",
        shapes,
        (
            *lengths,
            *pack_diameters(size, pack.end),
            diameter(long, b + wall, "outer_diameter"),
            diameter(-out, shaft, "shaft_diameter", side="left"),
            diameter(-out, boss, "boss_diameter", side="left"),
        ),
        tuple(balloons),
        (pack_detail(size, pack, wall=wall),),
        revolved=True,
    )
    omitted = [TEETH, BORES, "bearings, seals and end stops", *omitted_aid(size)]
    masses = ["drum_shell_mass", "drum_bottom_mass", "hub_rim_mass", "hub_web_mass", "boss_mass"]
    remarks = [
        "The pack is drawn released. Bosses are drawn outside of the length; the model knows their size, not their "
        "place, nor that of the web.",
        NEIGHBOURS,
    ]
    if piston:
        omitted.insert(0, "ring piston, its seals and its return: the model knows its area and the room it needs along")
    else:
        omitted.insert(0, "what presses: it is outside of the clutch")
    return Drawing(
        "longitudinal section, released",
        (view,),
        tuple(items),
        omitted=tuple(omitted),
        remarks=tuple(remarks),
        weights=(
            Weight((INNER, END), ("inner_plate_mass", "end_plate_mass"), "steel_density"),
            Weight((OUTER,), ("outer_plate_mass",), "steel_density"),
            Weight((LINING,), ("lining_mass",), "friction_pair.density"),
            Weight((DRUM, HUB), tuple(masses), "steel_density"),
        ),
    )


def omitted_aid(size: Sizes) -> tuple[str, ...]:
    """Parts of a release aid that are not drawn."""
    aid = size.design.frame.options.get("release_aid", "none")
    return () if aid == "none" else (f"release aid ({aid.replace('_', ' ')})",)


def pack_diameters(size: Sizes, at: float, side: Edge = "right") -> tuple[Dimension, ...]:
    """Return the diameters of the rings and of the mean spline radii, measured at a place along the axis [mm]."""
    splines, rings = ("inner_spline_radius", "outer_spline_radius"), ("ring_inner_diameter", "ring_outer_diameter")
    return (
        *(diameter(at, size(name), name, side=side, factor=2.0) for name in splines),
        *(diameter(at, size(name) / 2, name, side=side) for name in rings),
    )


def pack_balloons(size: Sizes, pack: DrawnPack, end_plates: int = 0) -> tuple[Balloon, ...]:
    """Return the part numbers of the plates, below the section."""
    inside, outside = size("ring_inner_diameter") / 2, size("ring_outer_diameter") / 2
    lining = size(pack.names.lining)
    core, inner = pack.outer_plate, pack.inner_plate
    found = [
        Balloon((core[0] - lining / 2, -(inside + 0.25 * (outside - inside))), LINING, "bottom"),
        Balloon(((core[0] + core[1]) / 2, -(outside + size("outer_spline_radius")) / 2), OUTER, "bottom"),
    ]
    if size.count("inner_plates") > end_plates:
        found.append(Balloon(((inner[0] + inner[1]) / 2, -(inside + 0.6 * (outside - inside))), INNER, "bottom"))
    return tuple(found)
