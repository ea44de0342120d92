"""Drawings of centrifugal clutches with weights on levers: front view, and the lever with its arms."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from synth import Design
from synth.drawing import (
    XY,
    Angle,
    Area,
    Circle,
    Dimension,
    Drawable,
    Drawing,
    Line,
    LineKind,
    Measured,
    View,
    rectangle,
)

from ..components.springs.drawing import Spring, told_of_springs
from ..drawing_parts import Sizes
from .drawing import Flyweight, clutch_drawing
from .places import FLYWEIGHT

JOINT = 0.025  # of the longest arm: circles at pivot and joints, which are no sizes


@dataclass(frozen=True)
class Leg:
    """An arm of the lever below its pivot: what it is called, and the way of its end along the axis that is known."""

    arm: str
    travel: str = ""


def lever_drawing(
    spec: Mapping[str, Any], design: Design, *, arms: Sequence[Leg], pushed: str, springs: Sequence[Spring]
) -> Drawing:
    """Return the drawing of a clutch with weights on levers.

    Parameters
    ----------
    spec : mapping
        What the hook is told.
    design : Design
        The design.
    arms : list of Leg
        Arms below the pivot.
    pushed : str
        What the levers push.
    springs : list of Spring
    """
    size = Sizes(spec, design)
    weights = Flyweight(
        "Weight",
        "steel",
        "weights",
        "weight_thickness",
        depth=size("weight_width"),
        round=False,
        density="steel_density",
        note="square section",
    )
    rods = ["rods and their heads"] if len(arms) > 1 else []
    return clutch_drawing(
        size,
        weights,
        springs,
        _lever_view(size, arms),
        omitted=(
            "sections and pivots of the levers, where they stand along the shaft, and stops",
            *rods,
            f"shape of the {pushed}",
        ),
        remarks=(
            "Lever: its arms as lines, in a plane through the axis, which lies below; at rest the arm of the weight is "
            "parallel to the axis. It is turned as it is; the model takes sine and tangent for the angle. The "
            "arrangement of the arms is a reconstruction.",
            "The model gives the springs room on the circle of the weights; they are drawn there, behind the weights "
            "where both have none beside each other.",
            told_of_springs(springs),
        ),
        springs_behind=True,
    )


def _lever_view(size: Sizes, arms: Sequence[Leg]) -> View:
    """Return the lever at rest and at its stop; its pivot is the origin, the weight at the right."""
    long, stop = size("flyweight_arm"), size.number("lever_stop_angle")
    high, wide = size("weight_thickness") / 2, size("weight_width") / 2
    legs = [size(leg.arm) for leg in arms]
    deep = max(legs)
    joint = JOINT * max(long, deep)
    c, s = math.cos(stop), math.sin(stop)

    def turned(point: XY) -> XY:
        return point[0] * c - point[1] * s, point[0] * s + point[1] * c

    weight = rectangle(long - wide, long + wide, -high, high)
    corners = [turned((v[0], v[1])) for v in weight]
    shapes: list[Drawable] = [
        Line((0.0, 0.0), (long, 0.0)),
        Line((0.0, 0.0), (0.0, -deep)),
        Area(weight, FLYWEIGHT, cut=False),
        *(Line(p, q, LineKind.PHANTOM) for p, q in zip(corners, [*corners[1:], corners[0]], strict=True)),
        Line((0.0, 0.0), turned((long, 0.0)), LineKind.PHANTOM),
        Line((0.0, 0.0), turned((0.0, -deep)), LineKind.PHANTOM),
        Circle((0.0, 0.0), 2 * joint),
        Circle((0.0, 0.0), joint),
        *(Circle((0.0, -leg), joint) for leg in legs),
        Circle((long, 0.0), joint),
    ]
    dimensions: list[Measured] = [
        Dimension((0.0, 0.0), (long, 0.0), "flyweight_arm", "top"),
        Dimension((long - wide, high), (long + wide, high), "weight_width", "top"),
        Dimension((long + wide, -high), (long + wide, high), "weight_thickness", "right"),
        # At the arm, prolonged beyond the pivot, where there is nothing else.
        Angle((0.0, 0.0), (-2 * joint, 0.0), turned((-2 * joint, 0.0)), "lever_stop_angle", radius=22.0),
        *(Dimension((0.0, -leg), (0.0, 0.0), one.arm, "right") for one, leg in zip(arms, legs, strict=True)),
    ]
    for one, leg in zip(arms, legs, strict=True):
        if one.travel:
            way = size(one.travel)
            shapes.append(Line((way, -leg - 3 * joint), (way, -leg + 3 * joint), LineKind.THIN))
            dimensions.append(Dimension((0.0, -leg), (way, -leg - 3 * joint), one.travel, "bottom"))
    return View("Lever", tuple(shapes), tuple(dimensions), own_scale=True)
