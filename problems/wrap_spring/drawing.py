"""Drawings of wrap spring clutches: section through hubs, spring and collar, coils closed, and a detail of the coils.

The spring is a helix as long as the model counts it, cut off square at both ends: on the lower side of the section its
coils stand half a pitch further on. It weighs what the model weighs.
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
    View,
    Weight,
    diameter,
    rectangle,
)
from synth.text.numbers import number_text, typed_number

from ..components.shaft.drawing import shaft_end
from ..drawing_parts import Sizes, ring

FIRST, SECOND, SPRING, COLLAR = 1, 2, 3, 4
ENDS = (
    "The spring is drawn as long as the model counts it, and its ends are cut off square there: their shape and the "
    "hand of winding are not known."
)
SHOWN_COILS = 2.8  # in the detail
SHAFTS = "Double-dot-dash lines are neighbours: shafts, whose ends inside of the hubs are assumed."


@dataclass(frozen=True)
class _Wire:
    """Names of the sizes of the wire."""

    thickness: str
    width: str
    density: str


class _Spring:
    """The spring from its first end at x = 0 [mm]."""

    def __init__(self, size: Sizes, *, fixed: bool) -> None:
        self.size = size
        own = "wire" in size.design.parts
        self.names = (
            _Wire("wire.radial_thickness_a", "wire.axial_width_b", "wire.density")
            if own
            else _Wire("wire_thickness", "wire_width", "wire_density")
        )
        self.thickness, self.width = size(self.names.thickness), size(self.names.width)
        self.pitch, self.gap = size("coil_pitch"), size("coil_gap")
        self._first_below = (self.gap - self.pitch) / 2  # begin of the first coil of the lower side
        self.inside = size("hub_diameter") / 2
        self.outside = self.inside + self.thickness
        self.length = size("spring_length" if "spring_length" in size.design.values else "length")
        self.grip_end = size("grip_length")
        self.second = "fixed_length" if fixed else "grip_length"
        self.second_start = self.length - size(self.second)
        self.meeting = (self.grip_end + self.second_start) / 2  # of the hubs

    def coils(self) -> list[Area]:
        """Return the sections of the wire on both sides."""
        return [*self._coils(self.gap / 2, 1), *self._coils(self._first_below, -1)]

    def _coils(self, first: float, side: int) -> list[Area]:
        """Return the sections of the wire on one side, the first at a place along the axis."""
        found = []
        low, high = sorted((side * self.inside, side * self.outside))
        x = first
        while x < self.length - 1e-6 * self.pitch:
            start, end = max(x, 0.0), min(x + self.width, self.length)
            if end - start > 1e-6 * self.width:
                found.append(Area(rectangle(start, end, low, high), SPRING, half=True))
            x += self.pitch
        return found

    def weight(self) -> Weight:
        """Return the weight of the coils; halves of coils are right on both sides together, other pieces are not."""
        drawn = sum(a.outline[1][0] - a.outline[0][0] for a in self.coils()) / 2
        times = self.size.number("total_coils") * self.width / drawn
        return Weight((SPRING,), ("spring_mass",), self.names.density, times=times)

    def middle(self, share: float) -> float:
        """Return the middle of a coil of the lower side, near a share of the length."""
        lower = [a.outline for a in self._coils(self._first_below, -1)]
        return min(((o[0][0] + o[1][0]) / 2 for o in lower), key=lambda x: abs(x - share * self.length))

    def lengths(self) -> list[Dimension]:
        """Extent of the coils on the hubs and over the gap."""
        y = self.outside
        found = [
            Dimension((0.0, y), (self.grip_end, y), "grip_length", "top"),
            Dimension((self.second_start, y), (self.length, y), self.second, "top"),
        ]
        if self.size("gap_length") > 0:
            found.append(Dimension((self.grip_end, y), (self.second_start, y), "gap_length", "top"))
        return found

    def detail(self, *, clearance: float = 0.0, wall: float = 0.0) -> Detail:
        """Return the detail of coils where the hubs meet, below; with a collar its clearance and wall [mm]."""
        half = SHOWN_COILS / 2 * self.pitch
        middle = min(self.meeting, self.length + 0.3 * self.pitch - half)
        start = self._first_below + round((middle - self._first_below) / self.pitch - 0.5) * self.pitch
        depth = min(0.9 * self.thickness, 0.9 * (self.inside - self.size("bore_diameter") / 2))
        out = self.outside + (2 * clearance + 0.6 * wall if clearance else 0.25 * self.thickness)
        window = (middle - half, -out, middle + half, depth - self.inside)
        low, high, end = -self.outside, -self.inside, start + self.width
        x = min(window[2], self.length)
        dimensions = [
            Dimension((start, low), (end, low), self.names.width, "bottom"),
            Dimension((start, low), (start + self.pitch, low), "coil_pitch", "bottom"),
            Dimension((x, low), (x, high), self.names.thickness, "right"),
        ]
        if self.gap > 0:
            dimensions.append(Dimension((end, low), (start + self.pitch, low), "coil_gap", "bottom"))
        if clearance:
            dimensions.append(Dimension((x, low - 2 * clearance), (x, low), "clearance", "right", factor=2.0))
        return Detail("X", window, tuple(dimensions), side="bottom")


@dataclass(frozen=True)
class _Outside:
    """The collar around the spring [mm], if there is one."""

    clearance: float = 0.0
    bore: float = 0.0
    radius: float = 0.0


class _Alone:
    """Hubs that end where the spring ends [mm]."""

    masses: tuple[str, ...] = ("hub_mass",)
    omitted = "bosses of the hubs, shafts and their keys: mass and length are those of the spring"
    collar = "control collar"  # omitted of a clearance fit
    remarks: tuple[str, ...] = ()

    def __init__(self, size: Sizes, spring: _Spring) -> None:
        self.size, self.spring = size, spring
        self.bore, self.boss = size("bore_diameter") / 2, spring.inside

    def hubs(self) -> list[Drawable]:
        """Sections of both hubs, and what they sit on."""
        hub, meeting, end = self.spring.inside, self.spring.meeting, self.spring.length
        return [ring(0.0, meeting, self.bore, hub, FIRST), ring(meeting, end, self.bore, hub, SECOND)]

    def places(self) -> tuple[float, float]:
        """Places along the axis where balloons point at the hubs."""
        return self.spring.meeting / 2, (self.spring.meeting + self.spring.length) / 2

    def dimensions(self) -> list[Dimension]:
        """Extent along the axis, and bore."""
        over = self.spring.outside
        return [
            Dimension((0.0, over), (self.spring.length, over), "length", "top"),
            diameter(0.0, self.bore, "bore_diameter", side="left"),
        ]

    def outside(self) -> _Outside:
        """What is around the spring of a clearance fit."""
        return _Outside()


class _Complete(_Alone):
    """Hubs that go on as bosses on their shafts [mm]."""

    masses = ("hub_mass", "boss_mass")
    omitted = "keys and keyways, bearing of the hubs against each other, housing"
    collar = "what guides the collar and takes the tang in it"
    remarks = (SHAFTS,)

    def __init__(self, size: Sizes, spring: _Spring) -> None:
        super().__init__(size, spring)
        self.out, self.boss = size("boss_length"), size("boss_diameter") / 2

    def hubs(self) -> list[Drawable]:
        """Sections of both hubs with their bosses, and ends of the shafts."""
        bore, boss, out, hub = self.bore, self.boss, self.out, self.spring.inside
        meeting, end = self.spring.meeting, self.spring.length
        first = ((-out, bore), (meeting, bore), (meeting, hub), (0.0, hub), (0.0, boss), (-out, boss))
        second = ((meeting, bore), (end + out, bore), (end + out, boss), (end, boss), (end, hub), (meeting, hub))
        left, right = (shaft_end(meeting, x, bore) for x in (-out, end + out))
        return [*left, *right, Area(first, FIRST), Area(second, SECOND)]

    def places(self) -> tuple[float, float]:
        """Places along the axis where balloons point at the bosses."""
        return -self.out / 2, self.spring.length + self.out / 2

    def dimensions(self) -> list[Dimension]:
        """Extent along the axis, bosses and bore."""
        out, boss, over, end = self.out, self.boss, self.spring.outside, self.spring.length
        return [
            Dimension((-out, boss), (end + out, boss), "length", "top"),
            Dimension((-out, boss), (0.0, boss), "boss_length", "top"),
            Dimension((end, boss), (end + out, boss), "boss_length", "top"),
            Dimension((0.0, over), (end, over), "spring_length", "top"),
            diameter(-out, self.bore, "bore_diameter", side="left"),
            diameter(-out, boss, "boss_diameter", side="left"),
        ]

    def outside(self) -> _Outside:
        """The control collar."""
        size = self.size
        return _Outside(size("clearance"), size("collar_bore") / 2, size("outer_diameter") / 2)


# By what mass and length are those of.
_AROUND: dict[str, type[_Alone]] = {"parts": _Alone, "complete": _Complete}


def interference_drawing(spec: Mapping[str, Any], design: Design, *, scope: str, seed: bool) -> Drawing:
    """Return the drawing of a clutch with interference fit.

    Parameters
    ----------
    spec : mapping
        What the hook is told.
    design : Design
        The design.
    scope : {"parts", "complete"}
        What mass and length are those of; the hubs of a complete clutch go on as bosses.
    seed : bool
        Whether the model is that of the source, in which mean radius of the coils and radius of the hub are one.
    """
    size = Sizes(spec, design)
    spring = _Spring(size, fixed=False)
    per_hub, gap = size.number("coils_per_hub"), size.number("gap_coils")
    coils = f"Coils: {typed_number(per_hub)} on each hub, {typed_number(gap)} over the gap between the hubs."
    fit = (
        f"The spring is drawn fitted. Free, its inside diameter is {number_text(size('free_inside_diameter'))} mm: an "
        f"interference of {number_text(size('interference'))} mm on the radius."
    )
    return _drawn(
        _AROUND[scope](size, spring), _Outside(), title="longitudinal section", seed=seed, told=(fit, coils),
        omitted=("tangs and other ends of the spring",),
    )  # fmt: skip


def clearance_drawing(spec: Mapping[str, Any], design: Design, *, scope: str, seed: bool) -> Drawing:
    """Return the drawing of a clutch with clearance fit, engaged; parameters as for the other one.

    A complete clutch has its control collar.
    """
    size = Sizes(spec, design)
    spring = _Spring(size, fixed=True)
    per_hub, gap, fixed = (size.number(name) for name in ("coils_per_hub", "gap_coils", "fixed_coils"))
    coils = (
        f"Coils: {typed_number(per_hub)} on the first hub, {typed_number(gap)} over the gap, "
        f"{typed_number(fixed)} anchored on the second hub."
    )
    fit = (
        f"The clutch is drawn engaged, its coils closed. Released, they stand "
        f"{number_text(size('clearance'), 3)} mm clear of the first hub on the radius."
    )
    around = _AROUND[scope](size, spring)
    ends = ("tang at the free end, anchor of the other end", "stop and actuator that hold the free end")
    return _drawn(
        around, around.outside(), title="longitudinal section, engaged", seed=seed, told=(fit, coils),
        omitted=(*ends, around.collar),
    )  # fmt: skip


def _drawn(
    around: _Alone, outside: _Outside, *, title: str, seed: bool, told: tuple[str, ...], omitted: tuple[str, ...]
) -> Drawing:
    size, spring = around.size, around.spring
    bore, hub, end = around.bore, spring.inside, spring.length
    shapes = [*around.hubs(), *spring.coils()]
    over = spring.outside
    dimensions = spring.lengths()
    balloons = [Balloon((spring.middle(0.3), -(hub + over) / 2), SPRING, "bottom")]
    weights = [Weight((FIRST, SECOND), around.masses, "hub_density")]
    surface, note = size.part("friction_pair"), "surface under the spring"
    items = [
        Item(FIRST, "First hub", 1, surface, note, Hatch.RIGHT),
        Item(SECOND, "Second hub", 1, surface, note, Hatch.LEFT),
        Item(SPRING, "Spring", 1, size.part("wire"), f"{typed_number(size.number('total_coils'))} coils", Hatch.CROSS),
    ]
    if outside.radius:
        shapes.append(ring(0.0, end, outside.bore, outside.radius, COLLAR))
        items.append(Item(COLLAR, "Control collar", 1, "", "density as of the hubs", Hatch.RIGHT))
        weights.append(Weight((COLLAR,), ("collar_mass",), "hub_density"))
        balloons.append(Balloon((0.5 * end, -(outside.bore + outside.radius) / 2), COLLAR, "bottom"))
        dimensions += [diameter(end, over, "spring_diameter"), diameter(end, outside.bore, "collar_bore")]
    across = outside.radius or over
    dimensions += [diameter(end, hub, "hub_diameter"), diameter(end, across, "outer_diameter")]
    dimensions += around.dimensions()
    low, places = -(bore + min(hub, around.boss)) / 2, around.places()
    balloons += [Balloon((places[0], low), FIRST, "bottom"), Balloon((places[1], low), SECOND, "bottom")]
    remarks = [
        *told,
        "The hubs are drawn meeting under the middle of the coils over the gap, as their mass is counted: how wide "
        "the gap is there is not known.",
        ENDS,
        *around.remarks,
    ]
    if seed:
        remarks.append("Model seed counts the radius of the hub as mean radius of the coils: its spring is lighter.")
    else:
        weights.append(spring.weight())
    detail = spring.detail(clearance=outside.clearance, wall=outside.radius - outside.bore)
    view = View("Section", tuple(shapes), tuple(dimensions), tuple(balloons), (detail,), revolved=True)
    return Drawing(title, (view,), tuple(items), (*omitted, around.omitted), tuple(remarks), tuple(weights))
