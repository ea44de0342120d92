"""What is returned and saved: fronts, designs, certificates."""

from synth.results.certificate import Certificate
from synth.results.design import Design, Frame, PartRow, design_columns, design_row, shown_value
from synth.results.front import ParetoFront

__all__ = [
    "Certificate",
    "Design",
    "Frame",
    "ParetoFront",
    "PartRow",
    "design_columns",
    "design_row",
    "shown_value",
]
