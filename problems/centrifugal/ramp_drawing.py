"""Drawings of centrifugal clutches with balls in ramps: front view, and a ball between its ramp and what it pushes."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any

from synth import Design
from synth.drawing import Angle, Area, Circle, Dimension, Drawable, Drawing, Line, LineKind, View, disc

from ..components.springs.drawing import Spring, told_of_springs
from ..drawing_parts import Sizes
from .drawing import Flyweight, clutch_drawing
from .places import FLYWEIGHT

OVER = 0.5  # of a ball: how far ramp and face are drawn beyond it


def ramp_drawing(
    spec: Mapping[str, Any], design: Design, *, travel: str, pushed: str, springs: Sequence[Spring]
) -> Drawing:
    """Return the drawing of a clutch with balls.

    Parameters
    ----------
    spec : mapping
        What the hook is told.
    design : Design
        The design.
    travel : str
        What the way of the pushed part along the axis is called.
    pushed : str
        What the balls push.
    springs : list of Spring
    """
    size = Sizes(spec, design)
    balls = Flyweight(
        "Ball",
        size.part("ball"),
        "balls",
        "ball.diameter",
        # A ball is as heavy as a disc of two thirds of its diameter.
        depth=size("ball.diameter") * 2 / 3,
        round=True,
        density="ball.density",
    )
    return clutch_drawing(
        size,
        balls,
        springs,
        _ramp_view(size, travel),
        omitted=(f"length of the ramps, ramp plate and stops; of the {pushed} all but its face at the balls",),
        remarks=(
            f"Ramp: a ball between its ramp and the face of the {pushed}, in a plane through the axis; the ramp is "
            "drawn a little longer than the ball travels. The axis lies below.",
            told_of_springs(springs),
        ),
        springs_behind=False,
    )


def _ramp_view(size: Sizes, travel: str) -> View:
    """Return a ball at rest, and where it is at the end of its way; its centre at rest is the origin."""
    ball, way, angle = size("ball.diameter"), size(travel), size.number("ramp_angle")
    out = size("end_radius") - size("rest_radius")
    c, s = math.cos(angle), math.sin(angle)
    first = (-s * ball / 2, c * ball / 2)  # where it touches the ramp
    last = (way + first[0], out + first[1])
    begin = (first[0] - OVER * ball * c, first[1] - OVER * ball * s)
    end = (last[0] + OVER * ball * c, last[1] + OVER * ball * s)
    face, low, high = ball / 2, -(0.5 + OVER / 2) * ball, out + (0.5 + OVER / 2) * ball
    aside = (end[0] - 0.8 * ball, end[1])
    shapes: tuple[Drawable, ...] = (
        Area(disc((0.0, 0.0), ball / 2), FLYWEIGHT, cut=False),
        Circle((way, out), ball / 2, LineKind.PHANTOM),
        Line(begin, end),
        Line((face, low), (face, high)),
        Line((face + way, low), (face + way, high), LineKind.PHANTOM),
        Line((0.0, 0.0), (way, out), LineKind.CENTRE),
        Line(aside, end, LineKind.THIN),
    )
    return View(
        "Ramp",
        shapes,
        (
            Dimension((-ball / 2, 0.0), (ball / 2, low), "ball.diameter", "bottom", diameter=True),
            Dimension((face, low), (face + way, low), travel, "bottom"),
            Angle(end, aside, begin, "ramp_angle", radius=18.0),
        ),
        own_scale=True,
    )
