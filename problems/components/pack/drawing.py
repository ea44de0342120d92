"""A pack of plates in a section, the drum and hub around it, and a detail of its plates.

The pack is drawn released, as its length is computed. Plates reach to the mean radii of their splines, as the mass
formulas have them.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from synth.drawing import Area, Balloon, Detail, Dimension, Drawable, Edge, Hatch, Item, Weight, diameter

from ...drawing_parts import Sizes, envelope, ring
from ..drawn import DrawnComponent
from ..lining.drawing import drawn_lining
from ..ring.drawing import drawn_ring
from ..shaft.drawing import drawn_shaft

INNER, OUTER, LINING, END, DRUM, HUB, BOSS = 1, 2, 3, 4, 5, 6, 7
TEETH = "teeth of the splines: plates are drawn to the mean radius of their spline, as the masses are computed"
BORES = "shafts, keys and what holds the hubs along the shaft"
LISTED = ("plate_set.inner_core_thickness", "plate_set.outer_core_thickness")
MADE = ("inner_plate.thickness", "outer_plate.thickness")


@dataclass(frozen=True)
class DrawnPack(DrawnComponent):
    """The plates of a released pack, and places of it that others need [mm].

    Attributes
    ----------
    start, end : float
        Ends of the pack.
    outer_end : float
        Right face of the core of the last outer plate.
    splines : tuple of float
        Mean radii of the inner and the outer spline.
    across : float
        Outside of the drum.
    """

    start: float = 0.0
    end: float = 0.0
    outer_end: float = 0.0
    splines: tuple[float, float] = (0.0, 0.0)
    across: float = 0.0


class _Plates:
    """Sizes of the plates of a pack [mm]."""

    def __init__(self, size: Sizes, end_plates: tuple[bool, bool]) -> None:
        self.listed = size.part("plate_set")
        self.inner_name, self.outer_name = LISTED if self.listed else MADE
        self.lining = drawn_lining(size, "plate_set.lining_thickness" if self.listed else "")
        self.ring = drawn_ring(size)
        self.a, self.b, self.wall = size("inner_spline_radius"), size("outer_spline_radius"), size("drum_wall")
        self.inner, self.core, self.gap = size(self.inner_name), size(self.outer_name), size("release_gap")
        self.inner_row, self.outer_row = size.part("inner_plate"), size.part("outer_plate")
        self.count, self.end_plates, self.ends = size.count("outer_plates"), end_plates, sum(end_plates)
        self.thick = size("end_plate_thickness") if self.ends else self.inner
        self.inner_count = size.count("inner_plates") - self.ends

    def stack(self, x: float) -> tuple[list[Drawable], list[tuple[float, float]], list[tuple[float, float]]]:
        """Sections of all plates from a place along the axis on, and the places of inner plates and of cores."""
        shapes: list[Drawable] = []
        inner_at, outer_at = [], []
        lining = self.lining.thickness
        for k in range(self.count + 1):
            ending = (k == 0 and self.end_plates[0]) or (k == self.count and self.end_plates[1])
            thick = self.thick if ending else self.inner
            shapes.append(ring(x, x + thick, self.a, self.ring.outside, END if ending else INNER))
            inner_at.append((x, x + thick))
            x += thick
            if k == self.count:
                break
            x += self.gap
            shapes.append(self.ring.facing(x, x + lining, LINING))
            x += lining
            shapes.append(ring(x, x + self.core, self.ring.inside, self.b, OUTER))
            outer_at.append((x, x + self.core))
            x += self.core
            shapes.append(self.ring.facing(x, x + lining, LINING))
            x += lining + self.gap
        return shapes, inner_at, outer_at

    def items(self) -> Iterator[Item]:
        """Lines of the parts list."""
        if self.inner_count:
            yield Item(INNER, "Inner plate", self.inner_count, self.listed or self.inner_row, hatch=Hatch.LEFT)
        yield Item(OUTER, "Outer plate, core", self.count, self.listed or self.outer_row, hatch=Hatch.RIGHT)
        yield self.lining.item(LINING, 2 * self.count, "on both sides of every outer plate")
        if self.ends:
            yield Item(END, "End plate", self.ends, "steel")

    def balloons(self, inner: tuple[float, float], core: tuple[float, float]) -> Iterator[Balloon]:
        """Part numbers below the section, at an inner plate and at the core of an outer plate."""
        yield Balloon((core[0] - self.lining.thickness / 2, self.ring.below(0.25)), LINING, "bottom")
        yield Balloon(((core[0] + core[1]) / 2, -(self.ring.outside + self.b) / 2), OUTER, "bottom")
        if self.inner_count:
            yield Balloon(((inner[0] + inner[1]) / 2, self.ring.below(0.6)), INNER, "bottom")

    def weights(self) -> Iterator[Weight]:
        """Masses that the areas of the plates give."""
        if self.ends:
            yield Weight((INNER, END), ("inner_plate_mass", "end_plate_mass"), "steel_density")
        else:
            yield Weight((INNER,), ("inner_plate_mass",), "steel_density")
        yield Weight((OUTER,), ("outer_plate_mass",), "steel_density")
        yield self.lining.weight(LINING, "lining_mass")

    def diameters(self, x: float, side: Edge) -> tuple[Dimension, ...]:
        """Diameters of splines and rings, measured at a place along the axis."""
        return (
            diameter(x, self.a, "inner_spline_radius", side=side, factor=2.0),
            diameter(x, self.b, "outer_spline_radius", side=side, factor=2.0),
            *self.ring.diameters(x, side),
        )

    def detail(self, core: tuple[float, float], end: float) -> Detail:
        """Detail of the first plates at the drum, of a pack with an end."""
        lining, b, wall = self.lining.thickness, self.b, self.wall
        thick = core[1] - core[0]
        pitch = thick + 2 * (lining + self.gap) + self.inner
        low = core[0] - lining - self.gap
        high = min(end, core[1] + lining + self.gap + pitch * 0.35)
        y = self.ring.outside - 0.35 * pitch
        dimensions = (
            Dimension((low, y), (low + self.gap, y), "release_gap", "bottom"),
            Dimension((low + self.gap, y), (core[0], y), self.lining.name, "bottom"),
            Dimension((core[0], y), (core[1], y), self.outer_name, "bottom"),
            Dimension((high, b), (high, b + wall), "drum_wall", "right"),
        )
        window = (low - pitch * 0.42, self.ring.outside - 0.7 * pitch, high, b + wall)
        return Detail("X", window, dimensions, least=min(lining, thick))


def drawn_pack(
    size: Sizes, start: float, *, side: Edge = "right", end_plates: tuple[bool, bool] = (False, False)
) -> DrawnPack:
    """The plates of a released pack.

    Parameters
    ----------
    size : Sizes
    start : float
        Where it begins along the axis [mm].
    side : {"right", "left"}
        Where its diameters are measured.
    end_plates : tuple of bool
        Whether its first and its last plate are end plates, which are thicker; without any, the drum is but the room
        of its wall.
    """
    plates = _Plates(size, end_plates)
    shapes, inner_at, outer_at = plates.stack(start)
    core, end, across = outer_at[0], inner_at[-1][1], plates.b + plates.wall
    room = () if plates.ends else envelope(start, end, plates.b, across)
    return DrawnPack(
        (*shapes, *room),
        tuple(plates.items()),
        tuple(plates.balloons(inner_at[len(inner_at) // 2], core)),
        plates.diameters(end if side == "right" else start, side),
        (plates.detail(core, end),),
        tuple(plates.weights()),
        start=start,
        end=end,
        outer_end=outer_at[-1][1],
        splines=(plates.a, plates.b),
        across=across,
    )


def omitted_aid(size: Sizes) -> tuple[str, ...]:
    """Parts of a release aid that are not drawn."""
    aid = size.design.frame.options.get("release_aid", "none")
    return () if aid == "none" else (f"release aid ({aid.replace('_', ' ')})",)


def piston_room(size: Sizes, *, piston: bool) -> tuple[float, float]:
    """Ends of the room of a ring piston between the bottom of the drum and the pack [mm]; none without a piston."""
    bottom = size("end_plate_thickness")
    return bottom, bottom + (size("actuator_length") if piston else 0.0)


def drawn_piston(size: Sizes, pack: DrawnPack) -> DrawnComponent:
    """Room of the ring piston behind a pack."""
    low, high = piston_room(size, piston=True)
    return DrawnComponent(
        envelope(low, high, *pack.splines),
        dimensions=(Dimension((low, pack.across), (high, pack.across), "actuator_length", "top"),),
    )


def drum_behind_pack(size: Sizes, pack: DrawnPack) -> DrawnComponent:
    """Drum with its bottom at the left of a pack between two end plates, hub, and ends of both shafts."""
    shaft, (a, b), across = drawn_shaft(size), pack.splines, pack.across
    bore, boss, out = shaft.radius, shaft.boss_radius, shaft.boss_length
    bottom, long, rim = size("end_plate_thickness"), pack.end, size("rim_radius")
    drum = Area(
        (
            (-out, bore), (bottom, bore), (bottom, b), (long, b), (long, across), (0.0, across), (0.0, boss),
            (-out, boss),
        ),
        DRUM,
    )  # fmt: skip
    web = long - bottom
    hub = Area(
        (
            (pack.start, rim), (web, rim), (web, bore), (long + out, bore), (long + out, boss), (long, boss), (long, a),
            (pack.start, a),
        ),
        HUB,
    )  # fmt: skip
    masses = ("drum_shell_mass", "drum_bottom_mass", "hub_rim_mass", "hub_web_mass", "boss_mass")
    below = (boss + rim) / 2 if rim > boss else boss - 0.2 * (boss - bore)
    ends = shaft.drawn((bottom, -out), (web, long + out), bosses=((-out, 0.0), (long, long + out)))
    return DrawnComponent(
        (*ends.shapes, drum, hub),
        (
            Item(DRUM, "Drum with bottom and boss", 1, "steel", "place of the boss assumed", Hatch.LEFT),
            Item(HUB, "Hub: rim, web and boss", 1, "steel", "places of web and boss assumed", Hatch.RIGHT),
        ),
        (
            Balloon(((pack.end + pack.outer_end) / 2 + 0.2 * bottom, -(rim + 0.8 * (a - rim) + (b - a) * 0.3)), END),
            Balloon((bottom / 2, -(boss + b) / 2), DRUM, "left"),
            Balloon((web + bottom / 2, -below), HUB, "right"),
        ),
        (
            Dimension((pack.start, across), (long, across), "hub_length", "top"),
            Dimension((0.0, across), (bottom, across), "end_plate_thickness", "top"),
            *ends.dimensions,
        ),
        weights=(Weight((DRUM, HUB), masses, "steel_density"),),
    )


def drum_over_pack(size: Sizes, pack: DrawnPack, *, boss_at: float, top: float) -> DrawnComponent:
    """Shell of the drum over a pack with an end plate at the left, hub, and ends of both shafts.

    Parameters
    ----------
    size : Sizes
    pack : DrawnPack
    boss_at : float
        Left face of the boss on the side of the drum [mm].
    top : float
        Radius at which dimensions along the axis begin [mm].
    """
    shaft, (a, b), across = drawn_shaft(size), pack.splines, pack.across
    bore, boss, out = shaft.radius, shaft.boss_radius, shaft.boss_length
    web, rim, inside = size("end_plate_thickness"), size("rim_radius"), drawn_ring(size).inside
    hub = Area(
        (
            (-out, bore), (web, bore), (web, rim), (pack.end, rim), (pack.end, a), (0.0, a), (0.0, boss), (-out, boss),
        ),
        HUB,
    )  # fmt: skip
    masses = ("drum_shell_mass", "hub_rim_mass", "hub_web_mass", "boss_mass")
    return shaft.drawn((web, -out), (boss_at, boss_at + out), bosses=((-out, 0.0),), times=2) + DrawnComponent(
        (ring(0.0, pack.end, b, across, DRUM), hub, shaft.boss(boss_at, BOSS)),
        (
            Item(DRUM, "Drum, shell", 1, "steel", hatch=Hatch.LEFT),
            Item(HUB, "Hub: rim, web and boss", 1, "steel", "places of web and boss assumed", Hatch.RIGHT),
            Item(BOSS, "Boss on the side of the drum", 1, "steel", "place assumed", Hatch.RIGHT),
        ),
        (
            Balloon((web * 0.3, -(a + 0.2 * (inside - a))), END, "bottom"),
            Balloon((0.85 * pack.end, -(b + (across - b) / 2)), DRUM, "bottom"),
            Balloon((-out / 2, -(bore + boss) / 2), HUB, "bottom"),
            Balloon((boss_at + out / 2, -(bore + boss) / 2), BOSS, "bottom"),
        ),
        (Dimension((0.0, top), (web, top), "end_plate_thickness", "top"),),
        weights=(Weight((DRUM, HUB, BOSS), masses, "steel_density"),),
    )
