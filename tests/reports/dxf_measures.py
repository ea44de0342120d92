"""What the dimensions of a DXF say: what they measure in the model, times the factor of their style."""

from __future__ import annotations

import math
from typing import Any

from synth.drawing import Angle, Measured


def measured_in(document: Any) -> list[float]:
    """Return what the dimensions of a document say, in order: millimetres and degrees."""
    found = document.modelspace().query("DIMENSION")
    return sorted(e.get_measurement() * (1.0 if e.dimtype in (2, 5) else e.override().get("dimlfac")) for e in found)


def drawn_measure(measured: Measured) -> float:
    """Return what a dimension of a drawing measures: millimetres or degrees."""
    return math.degrees(measured.measure) if isinstance(measured, Angle) else measured.measure
