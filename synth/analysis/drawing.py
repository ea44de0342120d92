"""Drawings of designs: a hook of families, checked like curves and simulations."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence

from synth.analysis.evaluate import evaluate
from synth.analysis.hooks import requirements_of
from synth.drawing import Angle, Drawing, Measured
from synth.drawing.shapes import Drawable, moments, points_of
from synth.errors import InputError
from synth.model.problem import DesignProblem
from synth.model.registry import load
from synth.order.margins import MARGINS
from synth.question.arguments import DesignSource, DesignValues, Family, Requirements, UserTables
from synth.question.catalogs import catalogs_for
from synth.results import Design


def draw(
    p: Family,
    requirements: Requirements,
    design: DesignSource | None = None,
    *,
    values: DesignValues | None = None,
    parts: Mapping[str, str] | None = None,
    catalogs: UserTables = None,
) -> Drawing:
    """Return the drawing of one design: shapes in millimetres, dimensions, parts list.

    Parameters
    ----------
    p : family name, DesignProblem subclass or instance
    requirements : mapping
        As for ``synthesize``.
    design, values, parts, catalogs : optional
        The design, as for ``evaluate``.

    Returns
    -------
    Drawing
        Neutral; reports make SVG and DXF of it.

    Raises
    ------
    InputError
        When the family has no drawing, or something is missing, unknown or not possible.
    """
    problem = load(p)
    tables = catalogs_for(problem, catalogs)
    return drawing_of(problem, evaluate(problem, requirements, design, values=values, parts=parts, catalogs=tables))


def draws(problem: DesignProblem) -> bool:
    """Return whether a family has the hook."""
    return problem.declared_by.drawing is not DesignProblem.drawing


def drawing_of(problem: DesignProblem, design: Design) -> Drawing:
    """Return the drawing of a design that was evaluated or read; a measure is that of its quantity to 1e-9.

    Raises
    ------
    InputError
        When the family has no drawing, the design was saved before its family named what is drawn, or it has a part
        without a body, as designs may have that are not feasible.
    ValueError
        When the drawing is wrong: a fault of the author of the family.
    """
    drawing = problem.drawing(requirements_of(design), design)
    if drawing is None:
        raise InputError("family", problem.name, "a family that has a drawing")
    names = {item.number: item.name for item in drawing.items}
    for area in (area for view in drawing.views for area in view.areas):
        if moments(area.outline)[0] <= 0:
            what = names.get(area.item, f"item {area.item}")
            raise InputError("drawing", what, "a design whose parts have bodies: sizes of this one cross each other")
    faults = faults_of(drawing, design)
    if faults:
        raise ValueError(f"{type(problem).__name__}.drawing: " + "; ".join(faults))
    return drawing


def quantity_of(design: Design, name: str) -> float | None:
    """Return a quantity of a design in SI by its name; None where there is no such number.

    Parameters
    ----------
    design : Design
    name : str
        Of a variable, count, derived quantity, step or requirement, or ``slot.column``.
    """
    slot, _, column = name.partition(".")
    if column:
        cell = design.parts[slot].get(column) if slot in design.parts else None
        return float(cell) if isinstance(cell, (int, float)) else None
    for numbers in (design.values, design.steps, design.frame.requirement_values):
        if name in numbers:
            return float(numbers[name])
    return None


def shown_measure(dimension: Measured, design: Design) -> float | None:
    """Value that a dimension must measure by its quantity: mm, angles rad; None where there is no such quantity."""
    value = quantity_of(design, dimension.quantity)
    if value is None:
        return None
    return value * dimension.factor * (1.0 if isinstance(dimension, Angle) else 1e3)


def faults_of(drawing: Drawing, design: Design) -> list[str]:
    """Return in words what is wrong with a drawing; nothing where all is right."""
    faults: list[str] = []
    numbers = [item.number for item in drawing.items]
    if len(set(numbers)) != len(numbers):
        faults.append("a number stands twice in the parts list")
    if not drawing.omitted:
        faults.append("nothing is told of what is not part of the model")
    if not drawing.views:
        faults.append("there is no view")
    for view in drawing.views:
        faults += [f"{view.name}: {fault}" for fault in _faults_of_shapes(view.shapes)]
        named = {a.item for a in view.areas} | {b.item for b in view.balloons}
        named |= {b.item for detail in view.details for b in detail.balloons}
        faults += [f"{view.name}: there is no item {k}" for k in sorted(named - set(numbers))]
    for dimension in drawing.measured:
        expected = shown_measure(dimension, design)
        if expected is None:
            faults.append(f"there is no quantity {dimension.quantity}")
        elif not math.isclose(dimension.measure, expected, rel_tol=MARGINS.same, abs_tol=MARGINS.same):
            faults.append(f"{dimension.quantity}: measures {dimension.measure!r}, the design has {expected!r}")
    return faults


def _faults_of_shapes(shapes: Iterable[Drawable]) -> list[str]:
    for shape in shapes:
        points = points_of(shape)
        if not all(math.isfinite(c) for p in points for c in p):
            return [f"{type(shape).__name__} with a point that is none"]
        if len(points) < 2:
            return [f"{type(shape).__name__} without extent"]
    return []


def weighed(drawing: Drawing, design: Design) -> list[tuple[str, float, float]]:
    """Masses of the drawn areas, and those of the design, by the names of the masses [kg]."""
    rows = []
    for weight in drawing.weights:
        density = quantity_of(design, weight.density) or math.nan
        masses = [quantity_of(design, name) for name in weight.quantities]
        mass = sum(math.nan if value is None else value for value in masses)
        rows.append((" + ".join(weight.quantities), drawing.volume(weight) * 1e-9 * density, mass))
    return rows


def is_drawn(family: str) -> bool:
    """Return whether there is a drawing of a family that is installed."""
    try:
        return draws(load(family))
    except InputError:
        return False


def drawings_of(
    problem: DesignProblem, designs: Sequence[Design], *, requested: bool = False
) -> tuple[dict[int, Drawing], list[str]]:
    """Return the drawings of designs by rank, 0 for one without, and why there is none of some of them.

    ``requested``: whether drawings were named in the request, so that a family without one is noted.
    """
    drawings: dict[int, Drawing] = {}
    notes: list[str] = []
    if not draws(problem):
        return drawings, [f"no drawing: {problem.title or problem.name} has none"] if requested else []
    for design in designs:
        try:
            drawings[design.rank or 0] = drawing_of(problem, design)
        except InputError as error:
            which = f"design #{design.rank}" if design.rank else "the design"
            notes.append(f"no drawing of {which}: {error}")
    return drawings, notes
