"""Drawing of a disc clutch: section through discs and pressure plates, and a detail of a lining."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from synth import Design
from synth.drawing import Dimension, Drawing, diameter

from ..components.discs.drawing import drawn_discs, drawn_hubs, hubs_are_known
from ..components.drawn import section
from ..drawing_parts import NEIGHBOURS, Sizes

PARTS = (
    "discs and pressure plates, released",
    "each pressure plate stands behind its disc",
    ("cover, springs, hub and shaft: mass and length are those of discs and pressure plates",),
)
CLUTCH = (
    "longitudinal section, released",
    "places of the hubs along the shaft are assumed",
    ("cover and diaphragm spring: the model knows their masses and the room they take", "splines"),
)


def disc_drawing(spec: Mapping[str, Any], design: Design) -> Drawing:
    """Drawing of a disc clutch.

    Parameters
    ----------
    spec : mapping
        What the hook is told.
    design : Design
        The design; hubs and shaft are drawn where it has them.
    """
    size = Sizes(spec, design)
    discs = drawn_discs(size, 0.0)
    title, assumed, omitted = CLUTCH if hubs_are_known(size) else PARTS
    across, end = size("outer_diameter") / 2, size("length")
    return section(
        title,
        discs.cover(across, end),
        discs,
        around=(drawn_hubs(size, discs, across),),
        overall=(Dimension((0.0, across), (end, across), "length", "top"), diameter(end, across, "outer_diameter")),
        omitted=("flywheel but for its face", "rivets and cushion springs of the linings, torsion damper", *omitted),
        remarks=(
            f"The discs are drawn released; {assumed}. Pressure plates are drawn as wide as the friction ring, as "
            "their mass is computed.",
            NEIGHBOURS,
        ),
    )
