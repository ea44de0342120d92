"""A wrap spring in a section, its coils closed, with a detail of them, and the hubs under it.

The spring is a helix as long as the model counts it, cut off square at both ends: on the lower side of the section its
coils stand half a pitch further on. It weighs what the model weighs.
"""

from __future__ import annotations

from dataclasses import dataclass

from synth.drawing import Area, Balloon, Detail, Dimension, Drawable, Hatch, Item, Weight, diameter, rectangle
from synth.text.numbers import typed_number

from ...drawing_parts import Sizes, ring
from ..drawn import DrawnComponent
from ..shaft.drawing import shaft_end

FIRST, SECOND, SPRING = 1, 2, 3
SHOWN_COILS = 2.8  # in the detail
ENDS = (
    "The spring is drawn as long as the model counts it, and its ends are cut off square there: their shape and the "
    "hand of winding are not known."
)
MEETING = (
    "The hubs are drawn meeting under the middle of the coils over the gap, as their mass is counted: how wide the gap "
    "is there is not known."
)
SHAFTS = "Double-dot-dash lines are neighbours: shafts, whose ends inside of the hubs are assumed."
SEED = "Model seed counts the radius of the hub as mean radius of the coils: its spring is lighter."


@dataclass(frozen=True)
class _Wire:
    """Names of the sizes of the wire."""

    thickness: str
    width: str
    density: str


LISTED = _Wire("wire.radial_thickness_a", "wire.axial_width_b", "wire.density")
CUSTOM = _Wire("wire_thickness", "wire_width", "wire_density")


class DrawnSpring:
    """The spring from its first end at x = 0 [mm].

    Parameters
    ----------
    size : Sizes
    fixed : bool
        Whether the coils on the second hub are anchored there, and have a number of their own.
    bosses : bool
        Whether its hubs go on beyond it as bosses.
    seed : bool
        Whether the model is that of the source, in which mean radius of the coils and radius of the hub are one.
    """

    def __init__(self, size: Sizes, *, fixed: bool, bosses: bool, seed: bool) -> None:
        self.size, self.bosses, self.seed = size, bosses, seed
        self.names = LISTED if "wire" in size.design.parts else CUSTOM
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

    @property
    def around(self) -> float:
        """Outside of the clutch [mm], where there is more around the coils."""
        return self.size("outer_diameter") / 2

    @property
    def coils(self) -> str:
        """How many coils are where, but for those on the second hub."""
        per_hub, gap = (typed_number(self.size.number(name)) for name in ("coils_per_hub", "gap_coils"))
        if self.second == "grip_length":
            return f"Coils: {per_hub} on each hub, {gap} over the gap between the hubs"
        return f"Coils: {per_hub} on the first hub, {gap} over the gap"

    @property
    def remarks(self) -> tuple[str, ...]:
        """What is assumed of the spring and its hubs."""
        return MEETING, ENDS, *((SHAFTS,) if self.bosses else ()), *((SEED,) if self.seed else ())

    def diameters(self, radius: float) -> DrawnComponent:
        """Outsides of the hubs and of the clutch, whose radius is that of the coils or of what is around them [mm]."""
        measures = (
            diameter(self.length, r, name) for r, name in ((self.inside, "hub_diameter"), (radius, "outer_diameter"))
        )
        return DrawnComponent(dimensions=tuple(measures))

    def drawn(self, detail: Detail) -> DrawnComponent:
        """Both sides of the coils, with a detail of them."""
        number = f"{typed_number(self.size.number('total_coils'))} coils"
        return DrawnComponent(
            tuple(self._areas()),
            (Item(SPRING, "Spring", 1, self.size.part("wire"), number, Hatch.CROSS),),
            (Balloon((self._middle(0.3), -(self.inside + self.outside) / 2), SPRING, "bottom"),),
            tuple(self._lengths()),
            (detail,),
            () if self.seed else (self._weight(),),
        )

    def _lengths(self) -> list[Dimension]:
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
        """Coils where the hubs meet, below; with a collar its clearance and wall [mm]."""
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

    def _areas(self) -> list[Area]:
        """Sections of the wire on both sides."""
        return [*self._coils(self.gap / 2, 1), *self._coils(self._first_below, -1)]

    def _coils(self, first: float, side: int) -> list[Area]:
        """Sections of the wire on one side, the first at a place along the axis."""
        found = []
        low, high = sorted((side * self.inside, side * self.outside))
        x = first
        while x < self.length - 1e-6 * self.pitch:
            start, end = max(x, 0.0), min(x + self.width, self.length)
            if end - start > 1e-6 * self.width:
                found.append(Area(rectangle(start, end, low, high), SPRING, half=True))
            x += self.pitch
        return found

    def _weight(self) -> Weight:
        """Weight of the coils; halves of coils are right on both sides together, other pieces are not."""
        drawn = sum(a.outline[1][0] - a.outline[0][0] for a in self._areas()) / 2
        times = self.size.number("total_coils") * self.width / drawn
        return Weight((SPRING,), ("spring_mass",), self.names.density, times=times)

    def _middle(self, share: float) -> float:
        """Middle of a coil of the lower side, near a share of the length."""
        lower = [a.outline for a in self._coils(self._first_below, -1)]
        return min(((o[0][0] + o[1][0]) / 2 for o in lower), key=lambda x: abs(x - share * self.length))


def weight_of(items: tuple[int, ...], *masses: str) -> Weight:
    """What parts of the density of the hubs must weigh, by the names of their masses."""
    return Weight(items, masses, "hub_density")


class DrawnHubs:
    """Hubs that end where the spring ends [mm]."""

    masses: tuple[str, ...] = ("hub_mass",)
    omitted = "bosses of the hubs, shafts and their keys: mass and length are those of the spring"

    def __init__(self, size: Sizes, spring: DrawnSpring) -> None:
        self.size, self.spring = size, spring
        self.bore, self.boss = size("bore_diameter") / 2, spring.inside

    def drawn(self) -> DrawnComponent:
        """Both hubs, and what they sit on."""
        surface, note = self.size.part("friction_pair"), "surface under the spring"
        low, hubs = -(self.bore + min(self.spring.inside, self.boss)) / 2, (FIRST, SECOND)
        return DrawnComponent(
            tuple(self._areas()),
            (
                Item(FIRST, "First hub", 1, surface, note, Hatch.RIGHT),
                Item(SECOND, "Second hub", 1, surface, note, Hatch.LEFT),
            ),
            tuple(Balloon((x, low), hub, "bottom") for x, hub in zip(self._places(), hubs, strict=True)),
            tuple(self._dimensions()),
            weights=(weight_of(hubs, *self.masses),),
        )

    def _areas(self) -> list[Drawable]:
        """Sections of both hubs, and what they sit on."""
        hub, meeting, end = self.spring.inside, self.spring.meeting, self.spring.length
        return [ring(0.0, meeting, self.bore, hub, FIRST), ring(meeting, end, self.bore, hub, SECOND)]

    def _places(self) -> tuple[float, float]:
        """Places along the axis where balloons point at the hubs."""
        return self.spring.meeting / 2, (self.spring.meeting + self.spring.length) / 2

    def _dimensions(self) -> list[Dimension]:
        """Extent along the axis, and bore."""
        over = self.spring.outside
        return [
            Dimension((0.0, over), (self.spring.length, over), "length", "top"),
            diameter(0.0, self.bore, "bore_diameter", side="left"),
        ]


class DrawnBosses(DrawnHubs):
    """Hubs that go on as bosses on their shafts [mm]."""

    masses = ("hub_mass", "boss_mass")
    omitted = "keys and keyways, bearing of the hubs against each other, housing"

    def __init__(self, size: Sizes, spring: DrawnSpring) -> None:
        super().__init__(size, spring)
        self.out, self.boss = size("boss_length"), size("boss_diameter") / 2

    def _areas(self) -> list[Drawable]:
        """Sections of both hubs with their bosses, and ends of the shafts."""
        bore, boss, out, hub = self.bore, self.boss, self.out, self.spring.inside
        meeting, end = self.spring.meeting, self.spring.length
        first = ((-out, bore), (meeting, bore), (meeting, hub), (0.0, hub), (0.0, boss), (-out, boss))
        second = ((meeting, bore), (end + out, bore), (end + out, boss), (end, boss), (end, hub), (meeting, hub))
        left, right = (shaft_end(meeting, x, bore) for x in (-out, end + out))
        return [*left, *right, Area(first, FIRST), Area(second, SECOND)]

    def _places(self) -> tuple[float, float]:
        """Places along the axis where balloons point at the bosses."""
        return -self.out / 2, self.spring.length + self.out / 2

    def _dimensions(self) -> list[Dimension]:
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


def drawn_hubs(size: Sizes, spring: DrawnSpring) -> DrawnHubs:
    """The hubs under a spring, as far as they are known."""
    return DrawnBosses(size, spring) if spring.bosses else DrawnHubs(size, spring)
