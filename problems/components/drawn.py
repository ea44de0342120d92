"""The part of a drawing that a component hands over, and sections joined from such parts."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, fields

from synth.drawing import Balloon, Detail, Dimension, Drawable, Drawing, Item, Measured, View, Weight


@dataclass(frozen=True)
class DrawnComponent:
    """What one view shows of a component, in millimetres, and its lines of the parts list; ``+`` joins two of them."""

    shapes: tuple[Drawable, ...] = ()
    items: tuple[Item, ...] = ()
    balloons: tuple[Balloon, ...] = ()
    dimensions: tuple[Measured, ...] = ()
    details: tuple[Detail, ...] = ()
    weights: tuple[Weight, ...] = ()

    def __add__(self, other: DrawnComponent) -> DrawnComponent:
        """Both together, the other one over this one."""
        return DrawnComponent(*(getattr(self, f.name) + getattr(other, f.name) for f in fields(DrawnComponent)))


def joined(components: Iterable[DrawnComponent]) -> DrawnComponent:
    """All components together, later ones over earlier ones."""
    return sum(components, DrawnComponent())


def section(
    title: str,
    *components: DrawnComponent,
    around: Sequence[DrawnComponent] = (),
    overall: Sequence[Dimension] = (),
    omitted: Sequence[str],
    remarks: Sequence[str],
) -> Drawing:
    """Drawing of one section through the axis.

    Parameters
    ----------
    title : str
        What is shown.
    *components : DrawnComponent
        In the order of the section.
    around : sequence of DrawnComponent
        What carries them: it lies under them, and its marks come after theirs.
    overall : sequence of Dimension
        Dimensions over several components.
    omitted, remarks : sequence of str
    """
    sized, carrying = joined(components), joined(around)
    both = sized + carrying
    measures = sorted((*overall, *carrying.dimensions, *sized.dimensions), key=_across)
    view = View("Section", carrying.shapes + sized.shapes, tuple(measures), both.balloons, both.details, revolved=True)
    items = tuple(sorted(both.items, key=lambda item: item.number))
    return Drawing(title, (view,), items, tuple(omitted), tuple(remarks), both.weights)


def _across(measure: Measured) -> bool:
    """Whether a dimension is none along the axis; those along it come first."""
    return not isinstance(measure, Dimension) or measure.along != "x"
