"""Drawing of an electromagnetic clutch: section through pack, armature and pot, details of a lining and of the gap.

Pack, armature and pot stand in line, as the length counts them: the pack released, the magnet engaged.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

from synth.drawing import (
    Area,
    Balloon,
    Detail,
    Dimension,
    Drawing,
    Hatch,
    Item,
    Weight,
    diameter,
)

from ..components.discs import drawing as discs_drawn
from ..components.discs.drawing import DrawnDiscs, drawn_discs
from ..components.drawn import DrawnComponent, section
from ..components.pack import drawing as plates_drawn
from ..components.pack.drawing import DrawnPack, drawn_pack
from ..drawing_parts import NEIGHBOURS, Sizes, ring

UNKNOWN = (
    "return springs, and how the armature presses the pack: the model knows its force",
    "bobbin, insulation and leads of the coil, bearing and holder of the pot",
)
IN_LINE = (
    "Pack, armature and pot stand in line as the length counts them: the pack released, the magnet engaged. The model "
    "knows no other place of the armature."
)


@dataclass(frozen=True)
class _Magnet(DrawnComponent):
    """The engaged magnet from the face of its armature on, and where it ends [mm]."""

    end: float = 0.0


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
        (detail,),
        (
            Weight((armature, pot), ("magnet_iron_mass",), "steel_density"),
            Weight((winding,), ("copper_mass",), "coil_density"),
        ),
        end,
    )


def _top(size: Sizes, across: float) -> float:
    """Outside of pack or magnet [mm]."""
    return max(across, size("magnet_radius"))


def _overall(size: Sizes, across: float, pack_end: float, end: float) -> tuple[Dimension, ...]:
    """Length to an end, and the room of a pack of a radius that ends at a place along the axis [mm]."""
    top = _top(size, across)
    return (
        Dimension((0.0, top), (end, top), "length", "top"),
        Dimension((0.0, top), (pack_end, top), "pack_room", "top"),
        diameter(0.0, across, "pack_diameter", side="left"),
    )


def plate_magnet_drawing(size: Sizes) -> Drawing:
    """Drawing of a magnet with the multi-plate pack that it presses."""
    pack = drawn_pack(size, 0.0, side="left")
    magnet = _magnet(size, pack.end, _top(size, pack.across), plates_drawn.END)
    omitted = "drum but for its wall, hub and shaft: mass and length are those of pack and magnet"
    return _plates_in_line(size, pack, magnet, (), (omitted,))


def plate_clutch_drawing(size: Sizes) -> Drawing:
    """Drawing of a complete clutch with a multi-plate pack, whose drum and hub are known."""
    pack = drawn_pack(size, 0.0, side="left", end_plates=(True, False))
    top = _top(size, pack.across)
    magnet = _magnet(size, pack.end, top, plates_drawn.BOSS + 1)
    drum = plates_drawn.drum_over_pack(size, pack, boss_at=magnet.end, top=top)
    omitted = (
        "what carries the drum: the model knows its shell and its boss",
        plates_drawn.BORES,
        "bearings, seals and end stops",
    )
    return _plates_in_line(size, pack, magnet, (drum,), omitted)


def _plates_in_line(
    size: Sizes, pack: DrawnPack, magnet: _Magnet, around: Sequence[DrawnComponent], omitted: Sequence[str]
) -> Drawing:
    """Drawing of pack and magnet with what is around them."""
    return section(
        "longitudinal section",
        pack,
        magnet,
        around=around,
        overall=_overall(size, pack.across, pack.end, magnet.end),
        omitted=(*omitted, *UNKNOWN, plates_drawn.TEETH, *plates_drawn.omitted_aid(size)),
        remarks=(IN_LINE, NEIGHBOURS),
    )


def disc_magnet_drawing(size: Sizes) -> Drawing:
    """Drawing of a magnet with the dry discs that it presses."""
    across = size("pack_diameter") / 2
    discs = drawn_discs(size, 0.0, side="left", top=_top(size, across))
    magnet = _magnet(size, discs.end, _top(size, across), discs_drawn.HUB)
    omitted = "cover, hub and shaft: mass and length are those of discs, pressure plates and magnet"
    return _discs_in_line(size, discs, magnet, (), omitted)


def disc_clutch_drawing(size: Sizes) -> Drawing:
    """Drawing of a complete clutch with dry discs, whose hubs and room of the cover are known."""
    across = size("pack_diameter") / 2
    top = _top(size, across)
    discs = drawn_discs(size, discs_drawn.cover_thickness(size), side="left", top=top)
    magnet = _magnet(size, discs.end, top, discs_drawn.HUB + 1)
    hubs = discs_drawn.hubs_behind_cover(size, discs, across, top)
    omitted = "cover: the model knows its mass and the room it takes; splines of the hubs"
    return _discs_in_line(size, discs, magnet, (hubs,), omitted)


def _discs_in_line(
    size: Sizes, discs: DrawnDiscs, magnet: _Magnet, around: Sequence[DrawnComponent], omitted: str
) -> Drawing:
    """Drawing of discs and magnet with what is around them."""
    across = size("pack_diameter") / 2
    return section(
        "longitudinal section",
        discs.cover(across),
        discs,
        magnet,
        around=around,
        overall=(*_overall(size, across, discs.end, magnet.end), discs.hub_diameter()),
        omitted=(
            omitted,
            *UNKNOWN,
            "what stands against the first disc, but for its face",
            "rivets and cushion springs of the linings",
        ),
        remarks=(
            f"{IN_LINE} Pressure plates are drawn as wide as the friction ring, as their mass is computed.",
            NEIGHBOURS,
        ),
    )


# By the options pack and mass_scope.
DRAWINGS: dict[tuple[str, str], Callable[[Sizes], Drawing]] = {
    ("multi_plate", "parts"): plate_magnet_drawing,
    ("multi_plate", "complete"): plate_clutch_drawing,
    ("disc", "parts"): disc_magnet_drawing,
    ("disc", "complete"): disc_clutch_drawing,
}
