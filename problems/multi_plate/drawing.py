"""Drawing of a multi-plate clutch: section through pack, drum and hub, and a detail of the plates."""

from __future__ import annotations

from synth.drawing import Dimension, Drawing, diameter

from ..components.drawn import section
from ..components.pack.drawing import (
    BORES,
    TEETH,
    DrawnPack,
    drawn_pack,
    drawn_piston,
    drum_behind_pack,
    omitted_aid,
    piston_room,
)
from ..drawing_parts import NEIGHBOURS, Sizes


def pack_drawing(size: Sizes) -> Drawing:
    """Drawing of a pack, with the room of its drum."""
    pack = drawn_pack(size, 0.0)
    return section(
        "plate pack, released",
        pack,
        overall=_overall(pack),
        omitted=(
            TEETH,
            "drum but for its wall, hub, shaft, end stops and actuator: mass and length are those of the plates",
            *omitted_aid(size),
        ),
        remarks=(NEIGHBOURS,),
    )


def clutch_drawing(size: Sizes, *, piston: bool) -> Drawing:
    """Drawing of a complete clutch, with drum, hub and actuator; a ring piston presses, or something outside."""
    _, start = piston_room(size, piston=piston)
    pack = drawn_pack(size, start, end_plates=(True, True))
    presses = (
        "ring piston, its seals and its return: the model knows its area and the room it needs along"
        if piston
        else "what presses: it is outside of the clutch"
    )
    return section(
        "longitudinal section, released",
        pack,
        *([drawn_piston(size, pack)] if piston else []),
        around=(drum_behind_pack(size, pack),),
        overall=_overall(pack),
        omitted=(presses, TEETH, BORES, "bearings, seals and end stops", *omitted_aid(size)),
        remarks=(
            "The pack is drawn released. Bosses are drawn outside of the length; the model knows their size, not their "
            "place, nor that of the web.",
            NEIGHBOURS,
        ),
    )


def _overall(pack: DrawnPack) -> tuple[Dimension, ...]:
    """Length and outer diameter."""
    low, high = (0.0, pack.across), (pack.end, pack.across)
    return Dimension(low, high, "length", "top"), diameter(*high, "outer_diameter")
