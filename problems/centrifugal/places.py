"""Where flyweights and springs stand on the circle of a centrifugal clutch: the model asks for room on it alone."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

from synth.drawing import XY

from ..components.springs.drawing import Spring
from ..drawing_parts import Sizes

FLYWEIGHT, FIRST_SPRING = 3, 4  # numbers in the parts list
TOP = math.pi / 2  # where the first flyweight stands [rad]


@dataclass(frozen=True)
class Placed:
    """Something on the circle: its number in the parts list, angle [rad], half of its width and its wire [mm]."""

    item: int
    half: float
    wire: float = 0.0
    angle: float = 0.0


def at(radius: float, angle: float) -> XY:
    """Return the point at a radius and an angle."""
    return radius * math.cos(angle), radius * math.sin(angle)


def places(
    size: Sizes, flyweight: Placed, count: int, springs: Sequence[Spring], *, behind: bool
) -> tuple[list[Placed], list[Placed]]:
    """Return flyweights and springs at rest, beside each other where there is room.

    Parameters
    ----------
    size : Sizes
    flyweight : Placed
        One of them.
    count : int
        How many there are.
    springs : list of Spring
    behind : bool
        Whether springs stand behind flyweights where there is no room.
    """
    rest = size("rest_radius")
    weights = [replace(flyweight, angle=TOP + t) for t in even(count)]
    sets = _in_order(size, springs)
    beside = _on_one_circle(weights, sets, rest)
    if beside is not None:
        return weights, beside
    return (weights, _behind(weights, sets, rest)) if behind else _crowded_circle(weights, sets, rest)


def even(count: int) -> list[float]:
    """Return angles [rad] of things that stand evenly around a circle."""
    return [2 * math.pi * k / count for k in range(count)]


def _in_order(size: Sizes, springs: Sequence[Spring]) -> list[Placed]:
    """Return the springs of all sets, spread evenly among each other."""
    found = []
    for k, spring in enumerate(springs):
        one = Placed(FIRST_SPRING + k, spring.outside(size) / 2, spring.wire(size))
        count = spring.count(size)
        found += [((j + 0.5) / count, one.item, one) for j in range(count)]
    return [one for _, _, one in sorted(found, key=lambda x: x[:2])]


def _on_one_circle(weights: Sequence[Placed], springs: Sequence[Placed], radius: float) -> list[Placed] | None:
    """Return springs between evenly spread flyweights; None where they have no room there."""
    room = 2 * math.pi * radius / len(weights)
    placed: list[Placed] = []
    for k, weight in enumerate(weights):
        sector = [one for j, one in enumerate(springs) if j * len(weights) // len(springs) == k]
        gap = (room - 2 * weight.half - sum(2 * one.half for one in sector)) / (len(sector) + 1)
        if gap <= 0:
            return None
        along = weight.half + gap
        for one in sector:
            placed.append(replace(one, angle=weight.angle + (along + one.half) / radius))
            along += 2 * one.half + gap
    return placed


def _crowded_circle(
    weights: Sequence[Placed], springs: Sequence[Placed], radius: float
) -> tuple[list[Placed], list[Placed]]:
    """Return flyweights and springs with the same gap between all of them, as the model reckons."""
    order = sorted(
        [((k + 0.5) / len(group), one.item, one) for group in (weights, springs) for k, one in enumerate(group)],
        key=lambda x: x[:2],
    )
    gap = (2 * math.pi * radius - sum(2 * one.half for _, _, one in order)) / len(order)
    along = 0.0
    found: list[Placed] = []
    for _, _, one in order:
        found.append(replace(one, angle=TOP + (along + one.half) / radius))
        along += 2 * one.half + gap
    turn = TOP - next(one.angle for one in found if one.item == FLYWEIGHT)
    found = [replace(one, angle=one.angle + turn) for one in found]
    return [one for one in found if one.item == FLYWEIGHT], [one for one in found if one.item != FLYWEIGHT]


def _behind(weights: Sequence[Placed], springs: Sequence[Placed], radius: float) -> list[Placed]:
    """Return evenly spread springs, turned so that of each set one is seen as well as can be."""

    def turned(turn: float) -> list[Placed]:
        return [replace(one, angle=TOP + turn + t) for one, t in zip(springs, even(len(springs)), strict=True)]

    def seen(placed: Sequence[Placed]) -> float:
        best: dict[int, float] = {}
        for one in placed:
            apart = min(math.dist(at(radius, one.angle), at(radius, weight.angle)) for weight in weights)
            best[one.item] = max(best.get(one.item, 0.0), apart)
        return min(best.values())

    step = 2 * math.pi / len(springs)
    return max((turned(step * k / 12) for k in range(12)), key=lambda placed: round(seen(placed), 6))
