"""Drawing of an electromagnetic clutch: section through pack, armature and pot, details of a lining and of the gap.

Pack, armature and pot stand in line, as the length counts them: the pack released, the magnet engaged.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

from synth.drawing import (
    Area,
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

from ..disc import drawing as discs_drawn
from ..drawing_parts import NEIGHBOURS, SHAFT_OUT, Sizes, envelope, ring, shaft_end
from ..multi_plate.drawing import (
    BORES,
    DRUM,
    END,
    HUB,
    INNER,
    LINING,
    OUTER,
    TEETH,
    DrawnPack,
    drawn_pack,
    omitted_aid,
    pack_balloons,
    pack_detail,
    pack_diameters,
    pack_items,
    pack_names,
)

BOSS = 7
UNKNOWN = (
    "return springs, and how the armature presses the pack: the model knows its force",
    "bobbin, insulation and leads of the coil, bearing and holder of the pot",
)
IN_LINE = (
    "Pack, armature and pot stand in line as the length counts them: the pack released, the magnet engaged. The model "
    "knows no other place of the armature."
)


@dataclass(frozen=True)
class _Magnet:
    """The engaged magnet from the face of its armature on: what is drawn of it, and what is written at it."""

    shapes: tuple[Drawable, ...]
    items: tuple[Item, ...]
    balloons: tuple[Balloon, ...]
    dimensions: tuple[Dimension, ...]
    weights: tuple[Weight, ...]
    detail: Detail
    end: float


@dataclass(frozen=True)
class _Around:
    """What stands around pack and magnet: what is drawn of it, what is written at it, and what is left out."""

    shapes: tuple[Drawable, ...]
    omitted: tuple[str, ...]
    items: tuple[Item, ...] = ()
    balloons: tuple[Balloon, ...] = ()
    dimensions: tuple[Dimension, ...] = ()
    weights: tuple[Weight, ...] = ()


def _magnet(size: Sizes, start: float, top: float, first: int) -> _Magnet:
    """Return the magnet from a place along the axis [mm].

    Dimensions along it begin at the radius ``top`` [mm], numbers of its parts at ``first``.
    """
    armature, pot, winding = range(first, first + 3)
    bore, inner = size("magnet_bore_radius"), size("inner_pole_radius")
    coil, outside = size("coil_outer_radius"), size("magnet_radius")
    thick, gap, long = size("yoke_thickness"), size("residual_gap"), size("coil_length")
    faces = start + thick + gap
    bottom = faces + long
    end = bottom + thick
    shell = Area(
        (
            (faces, bore), (end, bore), (end, outside), (faces, outside), (faces, coil), (bottom, coil),
            (bottom, inner), (faces, inner),
        ),
        pot,
    )  # fmt: skip
    shapes = (ring(start, start + thick, bore, outside, armature), shell, ring(faces, bottom, inner, coil, winding))
    turns = f"{size.count('turns')} turns"
    dimensions = (
        Dimension((start, top), (end, top), "magnet_length", "top"),
        Dimension((start, top), (start + thick, top), "yoke_thickness", "top", times=2),
        Dimension((faces, top), (bottom, top), "coil_length", "top"),
        diameter(end, bore, "magnet_bore_radius", factor=2.0),
        diameter(bottom, inner, "inner_pole_radius", factor=2.0),
        diameter(bottom, coil, "coil_outer_radius", factor=2.0),
        diameter(end, outside, "magnet_diameter"),
    )
    reach = 2.5 * gap
    window = (start + thick - reach, coil - reach, faces + reach, min(coil + 2 * reach, outside + reach))
    y = coil + reach
    detail = Detail(
        "Y",
        window,
        (Dimension((start + thick, y), (faces, y), "residual_gap", "bottom"),),
        least=gap,
        side="right",
    )
    return _Magnet(
        shapes,
        (
            Item(armature, "Armature", 1, "steel", hatch=Hatch.RIGHT),
            Item(pot, "Pot with both poles", 1, "steel", hatch=Hatch.LEFT),
            Item(winding, "Coil", 1, size.part("winding_wire"), turns, Hatch.CROSS),
        ),
        (
            Balloon((start + thick / 2, -(coil + 0.3 * (outside - coil))), armature, "bottom"),
            Balloon((faces + 0.4 * long, -(inner + coil) / 2), winding, "bottom"),
            Balloon((bottom + thick / 2, -(inner + coil) / 2), pot, "bottom"),
        ),
        dimensions,
        (
            Weight((armature, pot), ("magnet_iron_mass",), "steel_density"),
            Weight((winding,), ("copper_mass",), "coil_density"),
        ),
        detail,
        end,
    )


def _across(size: Sizes) -> float:
    """Outside of the drum of a multi-plate pack [mm]."""
    return size("outer_spline_radius") + size("drum_wall")


def _top(size: Sizes, across: float) -> float:
    """Outside of pack or magnet [mm]."""
    return max(across, size("magnet_radius"))


def plate_magnet_drawing(size: Sizes) -> Drawing:
    """Drawing of a magnet with the multi-plate pack that it presses."""
    inner, across = pack_names(size).inner, _across(size)
    pack = drawn_pack(size, 0.0, first=inner, last=inner)
    around = _Around(
        (*pack.shapes, *envelope(pack.start, pack.end, size("outer_spline_radius"), across)),
        ("drum but for its wall, hub and shaft: mass and length are those of pack and magnet",),
    )
    plates = Weight((INNER,), ("inner_plate_mass",), "steel_density")
    return _plates_in_line(size, pack, _magnet(size, pack.end, _top(size, across), END), around, plates)


def plate_clutch_drawing(size: Sizes) -> Drawing:
    """Drawing of a complete clutch with a multi-plate pack, whose drum and hub are known."""
    pack = drawn_pack(size, 0.0, first="end_plate_thickness", last=pack_names(size).inner)
    a, b, wall, across = size("inner_spline_radius"), size("outer_spline_radius"), size("drum_wall"), _across(size)
    top = _top(size, across)
    magnet = _magnet(size, pack.end, top, BOSS + 1)
    shaft, boss, out = size("shaft_diameter") / 2, size("boss_diameter") / 2, size("boss_length")
    end, rim = size("end_plate_thickness"), size("rim_radius")
    hub = Area(
        (
            (-out, shaft), (end, shaft), (end, rim), (pack.end, rim), (pack.end, a), (0.0, a), (0.0, boss),
            (-out, boss),
        ),
        HUB,
    )  # fmt: skip
    broken = 2 * shaft * SHAFT_OUT
    masses = ("drum_shell_mass", "hub_rim_mass", "hub_web_mass", "boss_mass")
    around = _Around(
        (
            *shaft_end(end, -out, shaft, broken=broken),
            *shaft_end(magnet.end, magnet.end + out, shaft, broken=broken),
            ring(0.0, pack.end, b, across, DRUM),
            hub,
            ring(magnet.end, magnet.end + out, shaft, boss, BOSS),
            *pack.shapes,
        ),
        (
            "what carries the drum: the model knows its shell and its boss",
            BORES,
            "bearings, seals and end stops",
        ),
        (
            Item(DRUM, "Drum, shell", 1, "steel", hatch=Hatch.LEFT),
            Item(HUB, "Hub: rim, web and boss", 1, "steel", "places of web and boss assumed", Hatch.RIGHT),
            Item(BOSS, "Boss on the side of the drum", 1, "steel", "place assumed", Hatch.RIGHT),
        ),
        (
            Balloon((end * 0.3, -(a + 0.2 * (size("ring_inner_diameter") / 2 - a))), END, "bottom"),
            Balloon((0.85 * pack.end, -(b + wall / 2)), DRUM, "bottom"),
            Balloon((-out / 2, -(shaft + boss) / 2), HUB, "bottom"),
            Balloon((magnet.end + out / 2, -(shaft + boss) / 2), BOSS, "bottom"),
        ),
        (
            Dimension((0.0, top), (end, top), "end_plate_thickness", "top"),
            Dimension((-out, boss), (0.0, boss), "boss_length", "top", times=2),
            diameter(-out, shaft, "shaft_diameter", side="left"),
            diameter(-out, boss, "boss_diameter", side="left"),
        ),
        (Weight((DRUM, HUB, BOSS), masses, "steel_density"),),
    )
    plates = Weight((INNER, END), ("inner_plate_mass", "end_plate_mass"), "steel_density")
    return _plates_in_line(size, pack, magnet, around, plates, end_plates=1)


def _plates_in_line(
    size: Sizes, pack: DrawnPack, magnet: _Magnet, around: _Around, plates: Weight, end_plates: int = 0
) -> Drawing:
    """Drawing of pack and magnet with what is around them; ``plates`` are the inner ones."""
    across = _across(size)
    top = _top(size, across)
    view = View(
        "Section",
        (*around.shapes, *magnet.shapes),
        (
            Dimension((0.0, top), (magnet.end, top), "length", "top"),
            Dimension((0.0, top), (pack.end, top), "pack_room", "top"),
            *pack_diameters(size, 0.0, "left"),
            diameter(0.0, across, "pack_diameter", side="left"),
            *magnet.dimensions,
            *around.dimensions,
        ),
        (*pack_balloons(size, pack, end_plates), *magnet.balloons, *around.balloons),
        (pack_detail(size, pack, wall=size("drum_wall")), magnet.detail),
        revolved=True,
    )
    return Drawing(
        "longitudinal section",
        (view,),
        (*pack_items(size, pack, end_plates), *around.items, *magnet.items),
        omitted=(*around.omitted, *UNKNOWN, TEETH, *omitted_aid(size)),
        remarks=(IN_LINE, NEIGHBOURS),
        weights=(
            plates,
            Weight((OUTER,), ("outer_plate_mass",), "steel_density"),
            Weight((LINING,), ("lining_mass",), "friction_pair.density"),
            *magnet.weights,
            *around.weights,
        ),
    )


def disc_magnet_drawing(size: Sizes) -> Drawing:
    """Drawing of a magnet with the dry discs that it presses."""
    discs = discs_drawn.drawn_discs(size, 0.0)
    magnet = _magnet(size, discs.end, _top(size, size("pack_diameter") / 2), discs_drawn.HUB)
    omitted = "cover, hub and shaft: mass and length are those of discs, pressure plates and magnet"
    return _discs_in_line(size, discs, magnet, _Around((), (omitted,)), cover=0.0)


def disc_clutch_drawing(size: Sizes) -> Drawing:
    """Drawing of a complete clutch with dry discs, whose hubs and room of the cover are known."""
    across, hub, cover = size("pack_diameter") / 2, size("disc_hub_radius"), size("cover_thickness")
    top, drawn = _top(size, across), discs_drawn.HUB
    discs = discs_drawn.drawn_discs(size, cover)
    shaft, long, count = size("shaft_diameter") / 2, size("shaft_diameter"), size.count("discs")
    left = (discs.cores[0][0] + discs.cores[-1][1] - count * long) / 2
    hubs = [ring(left + k * long, left + (k + 1) * long, shaft, hub, drawn) for k in range(count)]
    ends = shaft_end(left + count * long, min(left, 0.0), shaft, broken=2 * shaft * SHAFT_OUT)
    around = _Around(
        (*ends, *envelope(0.0, cover, hub, across), *hubs),
        ("cover: the model knows its mass and the room it takes; splines of the hubs",),
        (Item(drawn, "Hub of a disc", count, "steel", "place along the shaft assumed", Hatch.LEFT),),
        (Balloon((left + 0.5 * long, -(shaft + hub) / 2), drawn, "bottom"),),
        (
            Dimension((0.0, top), (cover, top), "cover_thickness", "top"),
            diameter(min(left, 0.0), shaft, "shaft_diameter", side="left"),
        ),
        (Weight((drawn,), ("hub_mass",), "steel_density"),),
    )
    return _discs_in_line(size, discs, _magnet(size, discs.end, top, drawn + 1), around, cover=cover)


def _discs_in_line(
    size: Sizes, discs: discs_drawn.DrawnDiscs, magnet: _Magnet, around: _Around, *, cover: float
) -> Drawing:
    """Drawing of discs and magnet with what is around them, behind a cover of a thickness [mm]."""
    across, hub = size("pack_diameter") / 2, size("disc_hub_radius")
    inside, rim, top = size("ring_inner_diameter") / 2, size("ring_outer_diameter") / 2, _top(size, across)
    plate = discs.plates[-1]
    view = View(
        "Section",
        (
            *around.shapes,
            Line((cover, hub), (cover, across), LineKind.PHANTOM),
            Line((cover, across), (discs.end, across), LineKind.PHANTOM),
            *discs.shapes,
            *magnet.shapes,
        ),
        (
            Dimension((0.0, top), (magnet.end, top), "length", "top"),
            Dimension((0.0, top), (discs.end, top), "pack_room", "top"),
            Dimension((plate[0], top), (plate[1], top), "pressure_plate_thickness", "top"),
            diameter(0.0, across, "pack_diameter", side="left"),
            diameter(discs.start, rim, "ring_outer_diameter", side="left"),
            diameter(discs.start, inside, "ring_inner_diameter", side="left"),
            diameter(discs.cores[0][0], hub, "disc_hub_radius", side="left", factor=2.0),
            *magnet.dimensions,
            *around.dimensions,
        ),
        (
            *(replace(b, side="bottom") for b in discs_drawn.disc_balloons(size, discs)),
            *magnet.balloons,
            *around.balloons,
        ),
        (discs_drawn.disc_detail(size, discs), magnet.detail),
        revolved=True,
    )
    return Drawing(
        "longitudinal section",
        (view,),
        (*discs_drawn.disc_items(size), *around.items, *magnet.items),
        omitted=(
            *around.omitted,
            *UNKNOWN,
            "what stands against the first disc, but for its face",
            "rivets and cushion springs of the linings",
        ),
        remarks=(
            f"{IN_LINE} Pressure plates are drawn as wide as the friction ring, as their mass is computed.",
            NEIGHBOURS,
        ),
        weights=(*discs_drawn.disc_weights(size), *magnet.weights, *around.weights),
    )


# By the options pack and mass_scope.
DRAWINGS: dict[tuple[str, str], Callable[[Sizes], Drawing]] = {
    ("multi_plate", "parts"): plate_magnet_drawing,
    ("multi_plate", "complete"): plate_clutch_drawing,
    ("disc", "parts"): disc_magnet_drawing,
    ("disc", "complete"): disc_clutch_drawing,
}
