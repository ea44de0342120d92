"""Drawing of a cone clutch: section through both shells and the lining, engaged, and a detail of the friction face.

Walls are measured across the friction face, and the outer cone is turned to the outside diameter that is computed.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

from synth import Design
from synth.drawing import XY, Angle, Area, Balloon, Detail, Dimension, Drawing, Hatch, Item, Slant, Vertex, diameter

from ..components.drawn import DrawnComponent, section
from ..components.lining.drawing import DrawnLining, drawn_lining
from ..components.shaft.drawing import drawn_shaft
from ..drawing_parts import Sizes, envelope

INNER, LINING, OUTER = 1, 2, 3


class _Face:
    """The friction face from its narrow end at x = 0, and surfaces beside it [mm]."""

    def __init__(self, size: Sizes) -> None:
        self.angle = size.number("cone_half_angle")
        self.long = size("generator_length")
        self.wide = self.long * math.cos(self.angle)
        self.narrow_radius = size("narrow_end_diameter") / 2

    def at(self, x: float, apart: float = 0.0) -> XY:
        """Return the point above x of the surface that is ``apart`` from the face, positive outwards."""
        return x, self.narrow_radius + x * math.tan(self.angle) + apart / math.cos(self.angle)

    def across(self, x: float, apart: float) -> XY:
        """Return the point that is ``apart`` from that of the face above x, across the face."""
        x0, y0 = self.at(x)
        return x0 - apart * math.sin(self.angle), y0 + apart * math.cos(self.angle)

    def layer(self, low: float, high: float) -> tuple[Vertex, ...]:
        """Area between two such surfaces, cut off square at both ends."""
        return self.at(0.0, low), self.at(self.wide, low), self.at(self.wide, high), self.at(0.0, high)


def cone_drawing(spec: Mapping[str, Any], design: Design) -> Drawing:
    """Return the drawing of a cone clutch.

    Parameters
    ----------
    spec : mapping
        What the hook is told.
    design : Design
        The design; where its length is that of the whole clutch, the shaft is drawn.
    """
    size = Sizes(spec, design)
    face, lining = _Face(size), drawn_lining(size)
    wall, across = size("shell_thickness"), size("outer_diameter") / 2
    start = (face.wide - size("length")) / 2
    end, middle = start + size("length"), face.wide / 2
    around, omitted = DrawnComponent(envelope(start, end, 0.0, across)), ["spring, release gear and bearings"]
    if "pack_length" in design.values:
        around += drawn_shaft(size).drawn((start, end))
        omitted.insert(0, "webs and bosses that carry the cones: the model knows their masses and the room they take")
    else:
        omitted.insert(0, "webs, hubs and shaft: mass is that of the shells and the lining")
    if str(design.parts["cone_layout"]["force_closed"]) not in ("0", "0.0"):
        omitted.append("the second cone, which closes the force inside: the model counts it as a factor of the mass")
    cones = DrawnComponent(
        (
            Area(face.layer(-wall, 0.0), INNER),
            Area(face.layer(0.0, lining.thickness), LINING),
            Area(_turned_outside(face, lining.thickness, wall, across), OUTER),
        ),
        (
            Item(INNER, "Inner cone, shell", 1, "steel", hatch=Hatch.RIGHT),
            lining.item(LINING, 1, "drawn on the outer cone"),
            Item(OUTER, "Outer cone, shell", 1, "steel", hatch=Hatch.LEFT),
        ),
        (
            Balloon(_mirrored(face.at(middle, -wall / 2)), INNER, "bottom"),
            Balloon(_mirrored(face.at(face.wide * 0.2, lining.thickness / 2)), LINING, "bottom"),
            Balloon(_mirrored(face.at(face.wide * 0.75, lining.thickness + wall * 0.45)), OUTER, "bottom"),
        ),
        (
            diameter(face.wide, face.at(face.wide)[1], "wide_end_diameter"),
            diameter(middle, face.at(middle)[1], "mean_diameter", side="left"),
            diameter(0.0, face.narrow_radius, "narrow_end_diameter", side="left"),
        ),
        (_detail(face, wall, lining, across),),
    )
    return section(
        "cones, engaged",
        cones,
        around,
        overall=(Dimension((start, across), (end, across), "length", "top"), diameter(end, across, "outer_diameter")),
        omitted=omitted,
        remarks=(
            "Double-dot-dash lines are neighbours and envelopes: the length that the layout takes, which is a typical "
            "value; where the cones stand in it is assumed.",
            "Masses are computed with the friction face for the area of both shells, not from these sections.",
        ),
    )


def _turned_outside(face: _Face, lining: float, wall: float, across: float) -> tuple[Vertex, ...]:
    """Return the section of the outer cone, turned to the outside diameter where its wall would reach beyond."""
    bottom = face.at(0.0, lining), face.at(face.wide, lining)
    outside = lining + wall
    top = face.at(0.0, outside)
    corner = (across - top[1]) / math.tan(face.angle)
    if corner <= 0:
        return (*bottom, (face.wide, across), (0.0, across))
    if corner >= face.wide:
        return face.layer(lining, outside)
    return (*bottom, (face.wide, across), (corner, across), top)


def _detail(face: _Face, wall: float, lining: DrawnLining, across: float) -> Detail:
    """Return the detail of the friction face, with what is measured along and across it."""
    low = face.at(0.0, -wall)
    edge = 0.06 * face.long
    window = (-edge, low[1] - edge, face.wide + edge, across + edge)
    first, last = low, face.at(face.wide, -wall)
    return Detail(
        "X",
        window,
        (
            Slant(first, last, "generator_length", apart=-24.0),
            Angle(first, (face.wide, first[1]), last, "cone_half_angle", radius=28.0),
            Slant(face.at(face.wide), face.across(face.wide, -wall), "shell_thickness", apart=12.0),
            Slant(face.at(0.0), face.across(0.0, lining.thickness), lining.name, apart=10.0),
        ),
        least=min(lining.thickness, face.long / 28),
    )


def _mirrored(point: XY) -> XY:
    return point[0], -point[1]
