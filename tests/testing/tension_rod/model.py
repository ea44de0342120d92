"""Tension rod: a family as small as one can be."""

from __future__ import annotations

from synth import DesignProblem
from synth.declaration import Declaration

QUARTER_PI = 0.7853981633974483


class TensionRod(DesignProblem):
    """Round bar under a pull."""

    name, title = "tension_rod", "Tension rod"
    sources = ("statics; Hooke's law",)

    def declare(self, d: Declaration) -> None:
        """Declare pull, diameter and steel."""
        force = d.requirement(
            "force", "N", group="duty", lower=1, upper=1e6, symbol="F_rod", text="Pull on the rod", source="statics"
        )
        length = d.requirement(
            "length",
            "mm",
            1000,
            group="duty",
            lower=1,
            upper=1e5,
            symbol="l_rod",
            text="Length of the rod",
            source="statics",
        )
        diameter = d.variable(
            "diameter", "mm", 1, 100, grid=1, symbol="d_rod", text="Diameter of the rod", source="statics"
        )
        steel = d.part("steel", "metals", symbol="steel", text="Material of the rod", source="table metals")
        area = d.derive(
            "area", "mm2", QUARTER_PI * diameter**2, symbol="A_rod", text="Cross-section", source="geometry"
        )
        d.derive("mass", "kg", steel.density * area * length, symbol="m_rod", text="Mass of the rod", source="geometry")
        d.derive(
            "elongation", "mm", force * length / (steel.E * area), symbol="dl", text="Elongation", source="Hooke's law"
        )
        d.at_most(
            "stress", force / area, steel.yield_Re, "N/mm2", text="The stress stays below yield", source="statics"
        )
        d.objective("mass")
        d.objective("elongation")
