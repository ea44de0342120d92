"""What the dimensions of a DXF say: what they measure in the model, times the factor of their style."""

from __future__ import annotations

import math
from typing import Any

from synth.drawing import Angle, Measured


def measured_in(document: Any) -> list[float]:
    """Return what the dimensions of a document say, in order: millimetres and degrees."""
    return sorted(_measured(e) for e in document.modelspace().query("DIMENSION"))


def _measured(dimension: Any) -> float:
    found = float(dimension.get_measurement())
    if dimension.dimtype == 2:  # between two lines; ezdxf goes around from the first one as they stand in the file
        return min(found, 360.0 - found)
    return found * float(dimension.override().get("dimlfac"))


def drawn_measure(measured: Measured) -> float:
    """Return what a dimension of a drawing measures: millimetres or degrees."""
    return math.degrees(measured.measure) if isinstance(measured, Angle) else measured.measure
