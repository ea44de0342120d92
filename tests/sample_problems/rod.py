"""A problem that is solved in milliseconds: a tension rod of a material from a catalogue."""

from __future__ import annotations

from typing import Any

from synth import DesignProblem


class Rod(DesignProblem):
    """Tension rod, solid or as a bundle."""

    name, title = "rod", "Tension rod"
    sources = ("statics",)

    def declare(self, d: Any) -> None:
        kind = d.option("section", ("round", "square"), default="round", text="Section")
        force = d.requirement("force", "N", lower=1, upper=1e6, symbol="F", text="Pull")
        safety = d.requirement("safety_factor", "-", default=1.5, lower=1, upper=10, symbol="n", text="Safety")
        largest = d.requirement("diameter_limit", "mm", optional=True, lower=1, upper=1000, symbol="D_max", text="Room")
        diameter = d.variable("diameter", "mm", 1, 100, grid=1, symbol="d", text="Diameter")
        length = d.variable("length", "mm", 10, 1000, symbol="L", text="Length")
        rods = d.count("rods", 1, 3, symbol="z", text="Rods of the bundle")
        steel = d.part("steel", "metals", text="Material")
        area = d.derive("area", "mm2", (0.785398 if kind == "round" else 1.0) * diameter**2, text="Section of one rod")
        d.derive("mass", "kg", 7850 * rods * area * length, symbol="m", text="Mass")
        d.at_most("stress", safety * force / (rods * area), steel.yield_Re, "N/mm2", source="statics")
        if largest is not None:
            d.at_most("diameter", diameter, largest, "mm")
        d.objective("mass", "min")
        d.objective("diameter", "min", default=False)
