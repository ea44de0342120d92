"""Drawings of wrap spring clutches: section through hubs, spring and collar, coils closed, and a detail of them."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from synth import Design
from synth.drawing import Balloon, Drawing, Hatch, Item, View, diameter
from synth.text.numbers import number_text, typed_number

from ..components.drawn import DrawnComponent
from ..components.wrap_spring.drawing import DrawnSpring, drawn_hubs, weight_of
from ..drawing_parts import Sizes, ring

COLLAR = 4


def interference_drawing(spec: Mapping[str, Any], design: Design, *, scope: str, seed: bool) -> Drawing:
    """Drawing of a clutch with interference fit.

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
    spring = DrawnSpring(size, fixed=False, bosses=scope == "complete", seed=seed)
    hubs = drawn_hubs(size, spring)
    fit = (
        f"The spring is drawn fitted. Free, its inside diameter is {number_text(size('free_inside_diameter'))} mm: an "
        f"interference of {number_text(size('interference'))} mm on the radius."
    )
    return _section(
        "longitudinal section",
        spring.drawn(spring.detail()) + spring.diameters(spring.outside),
        hubs.drawn(),
        omitted=("tangs and other ends of the spring", hubs.omitted),
        remarks=(fit, f"{spring.coils}.", *spring.remarks),
    )


def clearance_drawing(spec: Mapping[str, Any], design: Design, *, scope: str, seed: bool) -> Drawing:
    """Drawing of a clutch with clearance fit, engaged; parameters as for the other one.

    A complete clutch has its control collar.
    """
    size = Sizes(spec, design)
    spring = DrawnSpring(size, fixed=True, bosses=scope == "complete", seed=seed)
    hubs, clearance = drawn_hubs(size, spring), size("clearance")
    fit = (
        f"The clutch is drawn engaged, its coils closed. Released, they stand {number_text(clearance, 3)} mm clear of "
        "the first hub on the radius."
    )
    coils = f"{spring.coils}, {typed_number(size.number('fixed_coils'))} anchored on the second hub."
    if spring.bosses:
        around, missing = _with_collar(size, spring, clearance), "what guides the collar and takes the tang in it"
    else:
        around, missing = spring.drawn(spring.detail()) + spring.diameters(spring.outside), "control collar"
    ends = "tang at the free end, anchor of the other end", "stop and actuator that hold the free end"
    return _section(
        "longitudinal section, engaged",
        around,
        hubs.drawn(),
        omitted=(*ends, missing, hubs.omitted),
        remarks=(fit, coils, *spring.remarks),
    )


def _with_collar(size: Sizes, spring: DrawnSpring, clearance: float) -> DrawnComponent:
    """The spring in its control collar."""
    bore, outside, end = size("collar_bore") / 2, spring.around, spring.length
    collar = DrawnComponent(
        (ring(0.0, end, bore, outside, COLLAR),),
        (Item(COLLAR, "Control collar", 1, "", "density as of the hubs", Hatch.RIGHT),),
        (Balloon((0.5 * end, -(bore + outside) / 2), COLLAR, "bottom"),),
        (diameter(end, spring.outside, "spring_diameter"), diameter(end, bore, "collar_bore")),
        weights=(weight_of((COLLAR,), "collar_mass"),),
    )
    drawn = spring.drawn(spring.detail(clearance=clearance, wall=outside - bore))
    return drawn + collar + spring.diameters(outside)


def _section(
    title: str, spring: DrawnComponent, hubs: DrawnComponent, *, omitted: tuple[str, ...], remarks: tuple[str, ...]
) -> Drawing:
    """Section of a spring with what is around it, over its hubs."""
    both, shapes, measures = spring + hubs, hubs.shapes + spring.shapes, spring.dimensions + hubs.dimensions
    view = View("Section", shapes, measures, both.balloons, both.details, revolved=True)
    items = tuple(sorted(both.items, key=lambda item: item.number))
    return Drawing(title, (view,), items, omitted, remarks, both.weights)
