"""Drawings as files: SVG and DXF of one layout."""

from __future__ import annotations

from synth.drawing import Drawing
from synth.results.report_request import About

from .dxf import drawing_dxf
from .page import paper_sheet
from .svg import drawing_svg


def svg_of(drawing: Drawing, title: str, program: str, about: About | None = None, prefix: str = "drawing") -> str:
    """Return a drawing as an SVG file.

    Parameters
    ----------
    drawing : Drawing
    title : str
        Of the family.
    program : str
        What computed the design, with its version.
    about : About, optional
        What the title block tells.
    prefix : str
        Of the names inside, which must differ where several drawings stand in one page.
    """
    return drawing_svg(paper_sheet(drawing, title, program, about), drawing, prefix)


def dxf_of(drawing: Drawing, title: str, program: str, about: About | None = None) -> str:
    """Return a drawing as a DXF file; parameters as for :func:`svg_of`.

    Raises
    ------
    InputError
        The extra is not installed.
    """
    return drawing_dxf(paper_sheet(drawing, title, program, about), drawing)
