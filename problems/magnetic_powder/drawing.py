"""Drawing of a magnetic-powder clutch: section through rotor, gaps, body and coil, and a detail of the gaps.

All sizes of the section are those of the circuit and of the masses.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
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
    Measured,
    Slant,
    View,
    Weight,
    diameter,
    rectangle,
)
from synth.text.numbers import number_text

from ..components.coil.drawing import drawn_coil
from ..components.shaft.drawing import SHAFT_OUT, shaft_end
from ..drawing_parts import Sizes, ring

ROTOR, POWDER, BODY, COIL, DRUM = 1, 2, 3, 4, 5


class _Places:
    """Places along the axis from the left face of the body, and radii [mm]."""

    def __init__(self, size: Sizes, length: str) -> None:
        self.length = size(length)
        self.rotor = ((self.length - size("face_length")) / 2, (self.length + size("face_length")) / 2)
        self.winding = drawn_coil(size)
        self.window = ((self.length - self.winding.length) / 2, (self.length + self.winding.length) / 2)
        half_web = size("rotor_web_thickness") / 2
        self.web = (self.length / 2 - half_web, self.length / 2 + half_web)
        self.shaft, self.rim = size("shaft_radius"), size("rim_radius")
        self.gap_inside = size("gap_radius")
        self.gap_outside = self.gap_inside + size("powder_gap")
        self.drum, self.bore, self.outside = size("drum_radius"), size("body_bore"), size("outer_radius")
        self.coil = self.bore + self.winding.height


@dataclass
class _Section:
    """What the section shows, and what it omits."""

    shapes: list[Drawable]
    items: list[Item]
    balloons: list[Balloon]
    dimensions: list[Measured]
    weights: list[Weight]
    omitted: list[str]


def powder_drawing(spec: Mapping[str, Any], design: Design, *, scope: str) -> Drawing:
    """Return the drawing of a magnetic-powder clutch.

    Parameters
    ----------
    spec : mapping
        What the hook is told.
    design : Design
        The design.
    scope : {"parts", "complete"}
        What mass and length are those of.
    """
    size = Sizes(spec, design)
    length, add_around = _AROUND[scope]
    at = _Places(size, length)
    still = size("built_drum") > 0
    shapes, items, balloons = _parts(size, at, still=still)
    x0, between = at.rotor[0], at.shaft + 0.6 * (at.rim - at.shaft)
    dimensions: list[Measured] = [
        Dimension((0.0, at.outside), (at.length, at.outside), length, "top"),
        at.winding.along(*at.window, at.outside),
        Dimension((x0, at.outside), (at.window[0], at.outside), "pole_length", "top", times=2),
        at.winding.across(at.window[1], at.bore, at.coil),
        at.winding.around((at.window[1], at.coil), (at.length, at.outside), "right"),
        Slant((at.web[0], between), (at.web[1], between), "rotor_web_thickness", apart=0.0),
        diameter(at.length, at.outside, "outer_radius", factor=2.0),
        diameter(at.length, at.bore, "body_bore", factor=2.0),
        diameter(x0, at.gap_inside, "gap_radius", side="left", factor=2.0),
        diameter(x0, at.rim, "rim_radius", side="left", factor=2.0),
    ]
    weights = [
        Weight((ROTOR,), ("rotor_mass",), "steel_density"),
        Weight((POWDER,), ("powder_mass",), "powder.bulk_density", times=size.number("fill_factor")),
        Weight((BODY,), ("body_mass",), "steel_density"),
        at.winding.weight(COIL),
    ]
    if still:
        weights.append(Weight((DRUM,), ("drum_mass",), "steel_density"))
    omitted = ["bearings, seals, hub and what fastens the rotor on its shaft", "insulation and leads of the coil"]
    omitted.append("what carries the drum and drives it" if still else "slip rings and brushes, drive of the body")
    section = _Section(shapes, items, balloons, dimensions, weights, omitted)
    add_around(section, size, at)
    view = View(
        "Section", tuple(shapes), tuple(dimensions), tuple(balloons), (_detail(size, at, still=still),), revolved=True
    )
    return Drawing(
        f"longitudinal section, {'stationary' if still else 'rotating'} coil",
        (view,),
        tuple(items),
        omitted=tuple(omitted),
        remarks=(
            "The rotor stands in the middle of the body, its web in the middle of the rotor: the model knows the "
            "thickness of the web, not its place, and counts it as a full disc.",
            f"Powder is drawn in the whole gap; it fills {number_text(size.number('fill_factor'), 3)} of it.",
        ),
        weights=tuple(weights),
    )


def _add_neighbours(section: _Section, size: Sizes, at: _Places) -> None:
    """Add the shaft as a neighbour."""
    broken = 2 * at.shaft * SHAFT_OUT
    section.shapes += shaft_end(at.web[0], 0.0, at.shaft)
    section.shapes += shaft_end(at.web[1], at.length, at.shaft)
    section.omitted.insert(0, "shields and shaft: mass and length are those of rotor, drum, body, coil and powder")
    section.dimensions.append(diameter(-broken, at.shaft, "shaft_radius", side="left", factor=2.0))


def _add_shields(section: _Section, size: Sizes, at: _Places) -> None:
    """Add shields and shaft."""
    shield = len(section.items) + 1
    shaft = shield + 1
    thick, out = size("shield_thickness"), (size("shaft_length") - at.length) / 2
    end = at.length + out
    section.shapes += [
        Area(rectangle(-thick, 0.0, 0.0, at.outside), shield),
        Area(rectangle(at.length, at.length + thick, 0.0, at.outside), shield),
        Area(rectangle(-out, end, 0.0, at.shaft), shaft, cut=False),
    ]
    section.items += [
        Item(shield, "Bearing shield", 2, "light metal", "a full disc, as its mass is computed", Hatch.LEFT),
        Item(shaft, "Shaft", 1, "steel", "ends of equal length assumed"),
    ]
    section.balloons += [
        Balloon((-thick / 2, -(at.shaft + 0.7 * (at.outside - at.shaft))), shield, "bottom"),
        Balloon((-(out + thick) / 2, -at.shaft / 2), shaft, "bottom"),
    ]
    section.weights += [
        Weight((shield,), ("shields_mass",), "shield_density"),
        Weight((shaft,), ("shaft_mass",), "steel_density"),
    ]
    section.dimensions += [
        Dimension((-thick, at.outside), (at.length + thick, at.outside), "length", "top"),
        Dimension((-thick, at.outside), (0.0, at.outside), "shield_thickness", "top"),
        Dimension((-out, -at.shaft), (end, -at.shaft), "shaft_length", "top"),
        diameter(-out, at.shaft, "shaft_radius", side="left", factor=2.0),
    ]


# Length of the body, and what adds the parts around it, by what mass and length are those of.
_AROUND = {"parts": ("length", _add_neighbours), "complete": ("pack_length", _add_shields)}


def _parts(size: Sizes, at: _Places, *, still: bool) -> tuple[list[Drawable], list[Item], list[Balloon]]:
    """Sized parts: rotor, powder, drum of a stationary coil, body and coil."""
    x0, x1 = at.rotor
    rotor = Area(
        (
            (at.web[0], 0.0), (at.web[1], 0.0), (at.web[1], at.rim), (x1, at.rim), (x1, at.gap_inside),
            (x0, at.gap_inside), (x0, at.rim), (at.web[0], at.rim),
        ),
        ROTOR,
    )  # fmt: skip
    body = Area(
        (
            (0.0, at.bore), (at.window[0], at.bore), (at.window[0], at.coil), (at.window[1], at.coil),
            (at.window[1], at.bore), (at.length, at.bore), (at.length, at.outside), (0.0, at.outside),
        ),
        BODY,
    )  # fmt: skip
    shapes: list[Drawable] = [
        rotor,
        ring(x0, x1, at.gap_inside, at.gap_outside, POWDER),
        body,
        ring(*at.window, at.bore, at.coil, COIL),
    ]
    items = [
        Item(ROTOR, "Rotor", 1, "steel", "place of the web assumed", Hatch.RIGHT),
        Item(POWDER, "Powder", 1, size.part("powder"), hatch=Hatch.DOTS),
        Item(BODY, "Body: yoke and poles", 1, "steel", hatch=Hatch.RIGHT),
        at.winding.item(COIL),
    ]
    mid = at.length / 2
    balloons = [
        Balloon((x0 + 0.4 * size("pole_length"), -(at.rim + 0.4 * (at.gap_inside - at.rim))), ROTOR, "bottom"),
        Balloon((at.window[0] + 0.2 * at.winding.length, -(at.bore + at.coil) / 2), COIL, "bottom"),
        Balloon((mid + 0.25 * at.winding.length, -(at.gap_inside + at.gap_outside) / 2), POWDER, "bottom"),
        Balloon((at.length - 0.3 * at.window[0], -(at.coil + at.outside) / 2), BODY, "bottom"),
    ]
    if still:
        shapes.append(ring(x0, x1, at.gap_outside, at.drum, DRUM))
        items.append(Item(DRUM, "Drum", 1, "steel", "drawn as long as the rotor", Hatch.LEFT))
        balloons.append(
            Balloon((at.window[1] + 0.3 * size("pole_length"), -(at.gap_outside + at.drum) / 2), DRUM, "bottom")
        )
    return shapes, items, balloons


def _detail(size: Sizes, at: _Places, *, still: bool) -> Detail:
    """Return the detail of the gaps at the corner of the coil window."""
    gap = size("powder_gap")
    around = max(0.4 * (at.bore - at.gap_inside), 3.5 * gap)
    low, top = at.gap_inside - around, at.bore + around
    wide = (top - low) * 0.6
    x = at.window[1] + 0.6 * wide
    window = (at.window[1] - 0.6 * wide, low, x, top)
    dimensions = [Dimension((x, at.gap_inside), (x, at.gap_outside), "powder_gap", "right")]
    least = gap
    if still:
        dimensions += [
            Dimension((x, at.gap_outside), (x, at.drum), "built_drum", "right"),
            Dimension((x, at.drum), (x, at.bore), "built_air_gap", "right"),
        ]
        least = min(gap, size("built_air_gap"))
    return Detail("X", window, tuple(dimensions), least=least)
