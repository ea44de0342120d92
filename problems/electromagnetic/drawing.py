"""Drawing of an electromagnetic clutch: section through pack, armature and pot, details of a lining and of the gap.

Pack, armature and pot stand in line, as the length counts them: the pack released, the magnet engaged.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence

from synth.drawing import Dimension, Drawing, diameter

from ..components.discs import drawing as discs_drawn
from ..components.discs.drawing import DrawnDiscs, drawn_discs
from ..components.drawn import DrawnComponent, section
from ..components.magnet.drawing import PlacedMagnet, drawn_magnet
from ..components.pack import drawing as plates_drawn
from ..components.pack.drawing import DrawnPack, drawn_pack
from ..drawing_parts import NEIGHBOURS, Sizes

UNKNOWN = (
    "return springs, and how the armature presses the pack: the model knows its force",
    "bobbin, insulation and leads of the coil, bearing and holder of the pot",
)
IN_LINE = (
    "Pack, armature and pot stand in line as the length counts them: the pack released, the magnet engaged. The model "
    "knows no other place of the armature."
)


def _overall(magnet: PlacedMagnet, across: float, pack_end: float) -> tuple[Dimension, ...]:
    """Length to the end of the magnet, and the room of a pack of a radius that ends at a place along the axis [mm]."""
    top = magnet.top
    return (
        Dimension((0.0, top), (magnet.end, top), "length", "top"),
        Dimension((0.0, top), (pack_end, top), "pack_room", "top"),
        diameter(0.0, across, "pack_diameter", side="left"),
    )


def plate_magnet_drawing(size: Sizes) -> Drawing:
    """Drawing of a magnet with the multi-plate pack that it presses."""
    pack = drawn_pack(size, 0.0, side="left")
    magnet = drawn_magnet(size).placed(pack.end, pack.across, plates_drawn.END)
    omitted = "drum but for its wall, hub and shaft: mass and length are those of pack and magnet"
    return _plates_in_line(size, pack, magnet, (), (omitted,))


def plate_clutch_drawing(size: Sizes) -> Drawing:
    """Drawing of a complete clutch with a multi-plate pack, whose drum and hub are known."""
    pack = drawn_pack(size, 0.0, side="left", end_plates=(True, False))
    magnet = drawn_magnet(size).placed(pack.end, pack.across, plates_drawn.BOSS + 1)
    drum = plates_drawn.drum_over_pack(size, pack, boss_at=magnet.end, top=magnet.top)
    omitted = (
        "what carries the drum: the model knows its shell and its boss",
        plates_drawn.BORES,
        "bearings, seals and end stops",
    )
    return _plates_in_line(size, pack, magnet, (drum,), omitted)


def _plates_in_line(
    size: Sizes, pack: DrawnPack, magnet: PlacedMagnet, around: Sequence[DrawnComponent], omitted: Sequence[str]
) -> Drawing:
    """Drawing of pack and magnet with what is around them."""
    return section(
        "longitudinal section",
        pack,
        magnet,
        around=around,
        overall=_overall(magnet, pack.across, pack.end),
        omitted=(*omitted, *UNKNOWN, plates_drawn.TEETH, *plates_drawn.omitted_aid(size)),
        remarks=(IN_LINE, NEIGHBOURS),
    )


def disc_magnet_drawing(size: Sizes) -> Drawing:
    """Drawing of a magnet with the dry discs that it presses."""
    across = size("pack_diameter") / 2
    magnet = drawn_magnet(size)
    discs = drawn_discs(size, 0.0, side="left", top=magnet.above(across))
    placed = magnet.placed(discs.end, across, discs_drawn.HUB)
    omitted = "cover, hub and shaft: mass and length are those of discs, pressure plates and magnet"
    return _discs_in_line(size, discs, placed, (), omitted)


def disc_clutch_drawing(size: Sizes) -> Drawing:
    """Drawing of a complete clutch with dry discs, whose hubs and room of the cover are known."""
    across = size("pack_diameter") / 2
    magnet = drawn_magnet(size)
    discs = drawn_discs(size, discs_drawn.cover_thickness(size), side="left", top=magnet.above(across))
    placed = magnet.placed(discs.end, across, discs_drawn.HUB + 1)
    hubs = discs_drawn.hubs_behind_cover(size, discs, across, placed.top)
    omitted = "cover: the model knows its mass and the room it takes; splines of the hubs"
    return _discs_in_line(size, discs, placed, (hubs,), omitted)


def _discs_in_line(
    size: Sizes, discs: DrawnDiscs, magnet: PlacedMagnet, around: Sequence[DrawnComponent], omitted: str
) -> Drawing:
    """Drawing of discs and magnet with what is around them."""
    across = size("pack_diameter") / 2
    return section(
        "longitudinal section",
        discs.cover(across),
        discs,
        magnet,
        around=around,
        overall=(*_overall(magnet, across, discs.end), discs.hub_diameter()),
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
