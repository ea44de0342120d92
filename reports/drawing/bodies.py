"""The round parts of a drawing as bodies, for CAD (STEP) and to be turned about on a screen (glTF).

A part is what its areas sweep in a section through the axis; x is the axis, lengths are millimetres.
"""

from __future__ import annotations

import math
import re
import tempfile
import unicodedata
from itertools import count
from pathlib import Path
from typing import Any

from synth.drawing import Area, Drawing, Item, Vertex
from synth.drawing.shapes import arc_of, sides
from synth.results.drawings import EXTRAS
from synth.results.report_request import About

from ..extras import needed

NO_DATE = "1970-01-01T00:00:00"  # the same drawing gives the same file; dates come from --about
SAG = 0.1  # mm between a surface and its triangles in glTF
TURN = 0.2  # rad between neighbouring triangles
# Colours of parts in turn, in glTF: steel, and tones that differ from it.
COLOURS = (
    (0.62, 0.66, 0.70),
    (0.45, 0.55, 0.68),
    (0.78, 0.55, 0.30),
    (0.50, 0.62, 0.48),
    (0.70, 0.45, 0.42),
    (0.55, 0.50, 0.66),
)
USED = re.compile(rb"NEXT_ASSEMBLY_USAGE_OCCURRENCE\('\d+'([^;]*);")  # numbers of it go on from file to file


def round_areas(drawing: Drawing) -> dict[int, list[Area]]:
    """Return the areas that are revolved about the axis, by the number of their part.

    What a section shows uncut beside the axis (balls, rollers, screws) is round about axes of its own.
    """
    areas: dict[int, list[Area]] = {}
    for view in drawing.views:
        for area in view.areas if view.revolved else ():
            on_axis = any(vertex[1] == 0 for vertex in area.outline)
            if area.depth is None and (area.cut or on_axis):
                areas.setdefault(area.item, []).append(area)
    return areas


def not_bodies(drawing: Drawing) -> list[Item]:
    """Return the parts of a drawing that are no bodies of it."""
    there = round_areas(drawing)
    return [item for item in drawing.items if item.number not in there]


def step_of(drawing: Drawing, title: str, program: str, about: About | None = None) -> bytes:
    """Return the round parts of a drawing as a STEP file, each by its name.

    Parameters
    ----------
    drawing : Drawing
    title : str
        Of the family.
    program : str
        What computed the design, with its version.
    about : About, optional
        Whose date the file has.

    Raises
    ------
    InputError
        The extra is not installed.
    """
    cad = _cad()
    date = (about or About()).date
    stamp = f"{date}T00:00:00" if re.fullmatch(r"\d{4}-\d\d-\d\d", date) else NO_DATE
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "drawing.step"
        cad.export_step(assembly(drawing, title), file, timestamp=stamp)
        text = file.read_bytes()
    numbers = count(1)

    def numbered(match: re.Match[bytes]) -> bytes:
        return b"NEXT_ASSEMBLY_USAGE_OCCURRENCE('%d'%s;" % (next(numbers), re.sub(rb"\s*\n\s*", b"", match[1]))

    return USED.sub(numbered, text)


def glb_of(drawing: Drawing, title: str, program: str, about: About | None = None) -> bytes:
    """Return the round parts of a drawing as binary glTF; parameters and errors as for :func:`step_of`."""
    cad = _cad()
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "drawing.glb"
        solid = assembly(drawing, title, coloured=True)
        cad.export_gltf(solid, file, binary=True, linear_deflection=SAG, angular_deflection=TURN)
        return file.read_bytes()


def assembly(drawing: Drawing, title: str, *, coloured: bool = False) -> Any:
    """Return the round parts of a drawing as a compound of build123d: a child for each part, bodies below it.

    STEP has no colours: they come in another order each time.
    """
    cad = _cad()
    there = round_areas(drawing)
    parts = []
    for k, item in enumerate(item for item in drawing.items if item.number in there):
        bodies = [_body(cad, area) for area in there[item.number]]
        name = plain(item.name)
        for number, body in enumerate(bodies, 1):
            body.label = name if len(bodies) == 1 else f"{name} {number}"
            body.color = cad.Color(*COLOURS[k % len(COLOURS)]) if coloured else None
        parts.append(bodies[0] if len(bodies) == 1 else cad.Compound(label=name, children=bodies))
    return cad.Compound(label=plain(title), children=parts)


def plain(name: str) -> str:
    """Return a name in ASCII, as the kernel writes no other letters right.

    >>> plain("Tengely, külső")
    'Tengely, kulso'
    """
    return unicodedata.normalize("NFKD", name).encode("ascii", "ignore").decode().strip() or "part"


def _cad() -> Any:
    return needed(*EXTRAS["step"])


def _body(cad: Any, area: Area) -> Any:
    face = cad.Face(_wire(cad, area.outline), [_wire(cad, hole) for hole in area.holes])
    turned = 180.0 if area.half else 360.0
    body = cad.Solid.revolve(face, turned, cad.Axis.X)
    return body.rotate(cad.Axis.X, -90.0) if area.half else body


def _wire(cad: Any, outline: tuple[Vertex, ...]) -> Any:
    """Return a boundary; corners that lie upon each other are one."""
    edges = []
    for a, b, bulge in sides(outline):
        if a == b:
            continue
        if bulge:
            centre, radius, start, turned = arc_of(a, b, bulge)
            t = start + turned / 2
            middle = (centre[0] + radius * math.cos(t), centre[1] + radius * math.sin(t), 0)
            edges.append(cad.Edge.make_three_point_arc((*a, 0), middle, (*b, 0)))
        else:
            edges.append(cad.Edge.make_line((*a, 0), (*b, 0)))
    return cad.Wire(edges)
