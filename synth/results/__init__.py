"""What is returned and saved: fronts, designs, certificates. What is asked for is imported on first use."""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from synth.results.certificate import Certificate
    from synth.results.design import Design, Frame, PartRow, cell_value, design_columns, design_row
    from synth.results.front import ParetoFront, foremost, named_designs

__all__ = [
    "Certificate",
    "Design",
    "Frame",
    "ParetoFront",
    "PartRow",
    "cell_value",
    "design_columns",
    "design_row",
    "foremost",
    "named_designs",
]

_HOME = {
    "Certificate": "synth.results.certificate",
    "Design": "synth.results.design",
    "Frame": "synth.results.design",
    "PartRow": "synth.results.design",
    "design_columns": "synth.results.design",
    "design_row": "synth.results.design",
    "cell_value": "synth.results.design",
    "ParetoFront": "synth.results.front",
    "foremost": "synth.results.front",
    "named_designs": "synth.results.front",
}


def __getattr__(name: str) -> Any:
    if name not in _HOME:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(import_module(_HOME[name]), name)
