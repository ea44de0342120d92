"""What a family returns for a design: views, parts list, notes, and what is not drawn."""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum
from functools import cached_property

from synth.drawing.marks import Balloon, Detail, Measured
from synth.drawing.shapes import (
    Area,
    Box2,
    Drawable,
    Line,
    LineKind,
    both_halves,
    box_of,
    edges_behind,
    mirrored,
    points_of,
)


class Hatch(StrEnum):
    """How cut areas of a part are filled; thin ones are filled whole."""

    RIGHT = "right"  # 45 degrees
    LEFT = "left"  # 135 degrees
    CROSS = "cross"  # linings, coils: both directions
    DOTS = "dots"  # powder
    NONE = "none"


@dataclass(frozen=True)
class Item:
    """A line of the parts list.

    Parameters
    ----------
    number : int
        Of its balloons.
    name : str
        What it is: ``Inner plate``.
    count : int
        How many.
    material : str
        Designation of the row that the design chose, or the kind of material as far as the model knows it; empty
        where it does not.
    note : str
        What a reader must know: ``place along the shaft assumed``.
    hatch : Hatch, optional
        By default 45 degrees one way or the other, by number.
    """

    number: int
    name: str
    count: int = 1
    material: str = ""
    note: str = ""
    hatch: Hatch | None = None

    @property
    def filling(self) -> Hatch:
        """How cut areas of it are filled."""
        return self.hatch or (Hatch.RIGHT if self.number % 2 else Hatch.LEFT)


@dataclass(frozen=True)
class View:
    """One view of the design.

    Parameters
    ----------
    name : str
        Written above it where there are several: ``A-A``, ``front view``.
    shapes : tuple
        In the order in which they are drawn: later ones lie over earlier ones.
    dimensions, balloons, details : tuple
    revolved : bool
        Whether the view is a section through the axis y = 0, of which shapes show the upper half: it is drawn on the
        other side as well, with its centre line. Areas that are ``half`` stand where they are written alone.
    own_scale : bool
        Whether it is a single part, say a spring, that is drawn as large as its room allows, with its scale in its
        name; others have the scale of the sheet.
    """

    name: str
    shapes: tuple[Drawable, ...]
    dimensions: tuple[Measured, ...] = ()
    balloons: tuple[Balloon, ...] = ()
    details: tuple[Detail, ...] = ()
    revolved: bool = False
    own_scale: bool = False

    @cached_property
    def drawn(self) -> tuple[Drawable, ...]:
        """All shapes; of a section through the axis those of the other half and the centre line as well."""
        if not self.revolved:
            return self.shapes
        shapes: list[Drawable] = []
        for shape in self.shapes:
            joined = both_halves(shape)
            single = joined is not shape or (isinstance(shape, Area) and shape.half)
            shapes += [joined] if single else [shape, mirrored(shape)]
        left, _, right, _ = box_of([p for shape in self.shapes for p in points_of(shape)])
        return (*shapes, Line((left, 0.0), (right, 0.0), LineKind.CENTRE))

    @cached_property
    def behind(self) -> tuple[tuple[float, float], ...]:
        """Where edges are seen behind a section through the axis: place along the axis and radius [mm]."""
        return tuple(edges_behind([area for area in self.areas if not area.half])) if self.revolved else ()

    @cached_property
    def box(self) -> Box2:
        """The box around all that is drawn [mm]."""
        return box_of([p for shape in self.drawn for p in points_of(shape)])

    @property
    def areas(self) -> tuple[Area, ...]:
        """The areas, of a section through the axis those of its upper half and halves of coils."""
        return tuple(shape for shape in self.shapes if isinstance(shape, Area))


@dataclass(frozen=True)
class Weight:
    """Masses of the design that the drawn areas of some parts must give: the drawing checks the model.

    Parameters
    ----------
    items : tuple of int
        Parts whose areas count, in all views.
    quantities : tuple of str
        Masses of the design whose sum they are.
    density : str
        Name of the density: a requirement, a step, or ``slot.column``.
    view : str
        The view whose areas count.
    times : float
        Bodies for each that is drawn.
    """

    items: tuple[int, ...]
    quantities: tuple[str, ...]
    density: str
    view: str = ""
    times: float = 1.0


@dataclass(frozen=True)
class Drawing:
    """The drawing of a design, neutral: how it is set on paper and written is no matter of a family.

    Parameters
    ----------
    title : str
        What is shown, after the title of the family: ``longitudinal section, released``.
    views : tuple of View
        The first is the main view.
    items : tuple of Item
        The parts list.
    omitted : tuple of str
        What the clutch has and the model has not, so that it is not drawn. Never empty: no model has all.
    remarks : tuple of str
        What a reader must know of what is drawn: assumptions, states.
    weights : tuple of Weight
    """

    title: str
    views: tuple[View, ...]
    items: tuple[Item, ...]
    omitted: tuple[str, ...]
    remarks: tuple[str, ...] = ()
    weights: tuple[Weight, ...] = ()

    @property
    def measured(self) -> tuple[Measured, ...]:
        """All dimensions, those of details included."""
        return tuple(
            dimension
            for view in self.views
            for dimension in (*view.dimensions, *(m for d in view.details for m in d.dimensions))
        )

    def volume(self, weight: Weight) -> float:
        """Return the volume of the bodies that a mass is compared with [mm3]."""
        seen = [v for v in self.views if weight.view in ("", v.name)]
        return weight.times * sum(a.volume for v in seen for a in v.areas if a.item in weight.items)
