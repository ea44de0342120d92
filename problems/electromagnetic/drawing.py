"""Drawing of an electromagnetic clutch: section through pack, armature and pot, details of a lining and of the gap.

Pack, armature and pot stand in line, as the length counts them: the pack released, the magnet engaged.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any

from synth import Design
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


def plate_magnet_drawing(spec: Mapping[str, Any], design: Design, *, complete: bool) -> Drawing:
    """Return the drawing of a magnet that presses a multi-plate pack.

    Parameters
    ----------
    spec : mapping
        What the hook is told.
    design : Design
        The design.
    complete : bool
        Whether mass and length are those of the whole clutch, so that drum and hub are known.
    """
    size = Sizes(spec, design)
    names = pack_names(size)
    pack = drawn_pack(size, 0.0, first="end_plate_thickness" if complete else names.inner, last=names.inner)
    a, b, wall = size("inner_spline_radius"), size("outer_spline_radius"), size("drum_wall")
    across = b + wall
    top = max(across, size("magnet_radius"))
    magnet = _magnet(size, pack.end, top, BOSS + 1 if complete else END)
    ends = 1 if complete else 0
    items = [*pack_items(size, pack, ends)]
    balloons = [*pack_balloons(size, pack, ends), *magnet.balloons]
    dimensions = [
        Dimension((0.0, top), (magnet.end, top), "length", "top"),
        Dimension((0.0, top), (pack.end, top), "pack_room", "top"),
        *pack_diameters(size, 0.0, "left"),
        diameter(0.0, across, "pack_diameter", side="left"),
        *magnet.dimensions,
    ]
    weights = [
        Weight((INNER, END) if complete else (INNER,), ("inner_plate_mass",), "steel_density"),
        Weight((OUTER,), ("outer_plate_mass",), "steel_density"),
        Weight((LINING,), ("lining_mass",), "friction_pair.density"),
        *magnet.weights,
    ]
    shapes: tuple[Drawable, ...]
    if complete:
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
        shapes = (
            *shaft_end(end, -out, shaft, broken=broken),
            *shaft_end(magnet.end, magnet.end + out, shaft, broken=broken),
            ring(0.0, pack.end, b, across, DRUM),
            hub,
            ring(magnet.end, magnet.end + out, shaft, boss, BOSS),
            *pack.shapes,
        )
        items += [
            Item(DRUM, "Drum, shell", 1, "steel", hatch=Hatch.LEFT),
            Item(HUB, "Hub: rim, web and boss", 1, "steel", "places of web and boss assumed", Hatch.RIGHT),
            Item(BOSS, "Boss on the side of the drum", 1, "steel", "place assumed", Hatch.RIGHT),
        ]
        balloons += [
            Balloon((end * 0.3, -(a + 0.2 * (size("ring_inner_diameter") / 2 - a))), END, "bottom"),
            Balloon((0.85 * pack.end, -(b + wall / 2)), DRUM, "bottom"),
            Balloon((-out / 2, -(shaft + boss) / 2), HUB, "bottom"),
            Balloon((magnet.end + out / 2, -(shaft + boss) / 2), BOSS, "bottom"),
        ]
        dimensions += [
            Dimension((0.0, top), (end, top), "end_plate_thickness", "top"),
            Dimension((-out, boss), (0.0, boss), "boss_length", "top", times=2),
            diameter(-out, shaft, "shaft_diameter", side="left"),
            diameter(-out, boss, "boss_diameter", side="left"),
        ]
        masses = ("drum_shell_mass", "hub_rim_mass", "hub_web_mass", "boss_mass")
        weights[0] = Weight((INNER, END), ("inner_plate_mass", "end_plate_mass"), "steel_density")
        weights.append(Weight((DRUM, HUB, BOSS), masses, "steel_density"))
        omitted = [
            "what carries the drum: the model knows its shell and its boss",
            BORES,
            "bearings, seals and end stops",
        ]
    else:
        shapes = (*pack.shapes, *envelope(pack.start, pack.end, b, across))
        omitted = ["drum but for its wall, hub and shaft: mass and length are those of pack and magnet"]
    view = View(
        "Section",
        (*shapes, *magnet.shapes),
        tuple(dimensions),
        tuple(balloons),
        (pack_detail(size, pack, wall=wall), magnet.detail),
        revolved=True,
    )
    return Drawing(
        "longitudinal section",
        (view,),
        (*items, *magnet.items),
        omitted=(*omitted, *UNKNOWN, TEETH, *omitted_aid(size)),
        remarks=(IN_LINE, NEIGHBOURS),
        weights=tuple(weights),
    )


def disc_magnet_drawing(spec: Mapping[str, Any], design: Design, *, complete: bool) -> Drawing:
    """Return the drawing of a magnet that presses dry discs.

    Parameters
    ----------
    spec : mapping
        What the hook is told.
    design : Design
        The design.
    complete : bool
        Whether mass and length are those of the whole clutch, so that hubs and the room of the cover are known.
    """
    size = Sizes(spec, design)
    across, hub = size("pack_diameter") / 2, size("disc_hub_radius")
    inside, rim = size("ring_inner_diameter") / 2, size("ring_outer_diameter") / 2
    cover = size("cover_thickness") if complete else 0.0
    discs = discs_drawn.drawn_discs(size, cover)
    top = max(across, size("magnet_radius"))
    magnet = _magnet(size, discs.end, top, discs_drawn.HUB + 1 if complete else discs_drawn.HUB)
    plate = discs.plates[-1]
    items, balloons = (
        discs_drawn.disc_items(size),
        [
            *(replace(b, side="bottom") for b in discs_drawn.disc_balloons(size, discs)),
            *magnet.balloons,
        ],
    )
    weights = [*discs_drawn.disc_weights(size), *magnet.weights]
    dimensions = [
        Dimension((0.0, top), (magnet.end, top), "length", "top"),
        Dimension((0.0, top), (discs.end, top), "pack_room", "top"),
        Dimension((plate[0], top), (plate[1], top), "pressure_plate_thickness", "top"),
        diameter(0.0, across, "pack_diameter", side="left"),
        diameter(discs.start, rim, "ring_outer_diameter", side="left"),
        diameter(discs.start, inside, "ring_inner_diameter", side="left"),
        diameter(discs.cores[0][0], hub, "disc_hub_radius", side="left", factor=2.0),
        *magnet.dimensions,
    ]
    shapes: list[Drawable] = [
        Line((cover, hub), (cover, across), LineKind.PHANTOM),
        Line((cover, across), (discs.end, across), LineKind.PHANTOM),
        *discs.shapes,
        *magnet.shapes,
    ]
    if complete:
        shaft, long, count = size("shaft_diameter") / 2, size("shaft_diameter"), size.count("discs")
        left = (discs.cores[0][0] + discs.cores[-1][1] - count * long) / 2
        hubs = [ring(left + k * long, left + (k + 1) * long, shaft, hub, discs_drawn.HUB) for k in range(count)]
        ends = shaft_end(left + count * long, min(left, 0.0), shaft, broken=2 * shaft * SHAFT_OUT)
        shapes = [*ends, *envelope(0.0, cover, hub, across), *hubs, *shapes]
        items.append(
            Item(discs_drawn.HUB, "Hub of a disc", count, "steel", "place along the shaft assumed", Hatch.LEFT)
        )
        balloons.append(Balloon((left + 0.5 * long, -(shaft + hub) / 2), discs_drawn.HUB, "bottom"))
        weights.append(Weight((discs_drawn.HUB,), ("hub_mass",), "steel_density"))
        dimensions += [
            Dimension((0.0, top), (cover, top), "cover_thickness", "top"),
            diameter(min(left, 0.0), shaft, "shaft_diameter", side="left"),
        ]
        omitted = ["cover: the model knows its mass and the room it takes; splines of the hubs"]
    else:
        omitted = ["cover, hub and shaft: mass and length are those of discs, pressure plates and magnet"]
    view = View(
        "Section",
        tuple(shapes),
        tuple(dimensions),
        tuple(balloons),
        (discs_drawn.disc_detail(size, discs), magnet.detail),
        revolved=True,
    )
    return Drawing(
        "longitudinal section",
        (view,),
        (*items, *magnet.items),
        omitted=(
            *omitted,
            *UNKNOWN,
            "what stands against the first disc, but for its face",
            "rivets and cushion springs of the linings",
        ),
        remarks=(
            f"{IN_LINE} Pressure plates are drawn as wide as the friction ring, as their mass is computed.",
            NEIGHBOURS,
        ),
        weights=tuple(weights),
    )
