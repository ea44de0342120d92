"""Drawings of designs: what the hook ``drawing`` of a family returns, neutral and in millimetres of the part.

A family writes ``drawing(self, spec, design) -> Drawing`` beside ``curves`` and ``simulate``, in a file ``drawing.py``
of its package. It computes nothing again: sizes are read from ``design.values``, ``design.steps``, ``design.parts``
and ``spec``; what is missing there becomes a ``d.step`` of the declaration. Only what the design has is drawn; the
rest is a line of ``omitted``.

- In a section through the axis x runs along it and y is the radius. Write the upper half, ``View(revolved=True)``
  draws the other one and the centre line. In a front view the centre is (0, 0).
- :class:`Area` is a cut or seen surface of a part, with its number in the parts list; :class:`Line`, :class:`Circle`
  and :class:`Arc` have a kind (outline, thin, hidden, centre, phantom: neighbours and envelopes).
- :class:`Dimension`, :func:`diameter`, :class:`Slant`, :class:`Angle` and :class:`Radius` measure between points and
  name the quantity: a measure that is not that of the design to 1e-9 is refused.
- :class:`Detail` draws a piece again, larger, where parts are thinner than 1.2 mm on paper.
- ``View(own_scale=True)`` is a single part, say a spring, at a scale of its own.
- :class:`Weight` says which masses of the design the areas must give.

Sheet, scale, places of dimensions and numbers, title block and parts list are matters of the layout.

>>> part = Area(rectangle(0, 20, 15, 40), item=1)
>>> view = View("section", (part,), (diameter(20, 40, "outer_diameter"),), (Balloon((10, 30), 1),), revolved=True)
>>> drawing = Drawing("section", (view,), (Item(1, "Ring"),), omitted=("shaft",))
>>> drawing.measured[0].measure
80
"""

from synth.drawing.marks import Angle, Balloon, Detail, Dimension, Edge, Measured, Radius, Slant, diameter
from synth.drawing.record import Drawing, Hatch, Item, View, Weight
from synth.drawing.shapes import XY, Arc, Area, Box2, Circle, Drawable, Line, LineKind, Vertex, disc, rectangle

__all__ = [
    "XY",
    "Angle",
    "Arc",
    "Area",
    "Balloon",
    "Box2",
    "Circle",
    "Detail",
    "Dimension",
    "Drawable",
    "Drawing",
    "Edge",
    "Hatch",
    "Item",
    "Line",
    "LineKind",
    "Measured",
    "Radius",
    "Slant",
    "Vertex",
    "View",
    "Weight",
    "diameter",
    "disc",
    "rectangle",
]
