"""The friction ring of disc and multi-plate clutches."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from synth.declaration import Block, Declaration, Part, Requirement, Variable

from ...mechanics import ring as ring_formulas
from ...sources import S0, S1

# Largest friction ring offered to the search [mm]; the refusal torque_above_guide_limit reasons with it.
RING_OUTER_DIAMETER_MAX = 800.0


class RingRange(Block):
    """Range of the ratio, whose defaults are those of the family."""

    group = "practice"

    ring_ratio_min = Requirement(
        "-",
        lower=0.02,
        upper=0.9,
        symbol="c_min",
        text="Least ring width over mean diameter",
        source=f"{S1}, empirical range of c",
    )
    ring_ratio_max = Requirement(
        "-",
        lower=0.02,
        upper=0.9,
        symbol="c_max",
        text="Largest ring width over mean diameter",
        source=f"{S1}, empirical range of c",
    )


class RingSizes(RingRange):
    """Range of the ratio and the two diameters, which the search finds."""

    ring_outer_diameter = Variable(
        "mm",
        40,
        RING_OUTER_DIAMETER_MAX,
        grid=1,
        symbol="d_out",
        text="Outer diameter of the friction ring",
        source=f"{S1}, d1",
    )
    ring_inner_diameter = Variable(
        "mm", 20, 700, grid=1, symbol="d_in", text="Inner diameter of the friction ring", source=f"{S1}, d2"
    )


@dataclass(frozen=True)
class Ring:
    """A friction ring."""

    ratio_min: Any
    ratio_max: Any
    mean_diameter: Any
    ratio: Any
    friction_radius: Any
    width: Any
    inner_radius: Any
    outer_radius: Any
    area: Any


def declare_ring(d: Declaration, *, ratio_min: float, ratio_max: float, listed: Part | None = None) -> Ring:
    """Declare the block ring with the empirical range of its ratio.

    Parameters
    ----------
    d : Declaration
        Takes the declarations.
    ratio_min, ratio_max : float
        Defaults of the range of ring width over mean diameter [-].
    listed : Part, optional
        Row of a list of rings; without one the search finds both diameters.

    Returns
    -------
    Ring
        Symbols of the block.
    """
    range_of_ratio: RingRange
    if listed is None:
        sizes = d.block(RingSizes, ring_ratio_min=ratio_min, ring_ratio_max=ratio_max)
        outer, inner, range_of_ratio = sizes.ring_outer_diameter, sizes.ring_inner_diameter, sizes
    else:
        outer, inner = _named(d, listed)
        range_of_ratio = d.block(RingRange, ring_ratio_min=ratio_min, ring_ratio_max=ratio_max)
    least, most = range_of_ratio.ring_ratio_min, range_of_ratio.ring_ratio_max
    d.refuse("bad_ratio", least > most, "a ring_ratio_min of at most ring_ratio_max; otherwise no ring satisfies both")
    mean = d.derive(
        "mean_diameter",
        "mm",
        ring_formulas.mean_diameter(outer, inner),
        symbol="dm",
        text="Mean diameter of the friction ring",
        source=f"{S1}, dm",
    )
    ratio = d.derive(
        "ring_ratio",
        "-",
        ring_formulas.ring_ratio(outer, inner),
        symbol="c",
        text="Ring width over mean diameter",
        source=f"{S1}, c = b/dm",
    )
    radius = d.derive(
        "friction_radius",
        "mm",
        ring_formulas.friction_radius(mean, ratio),
        symbol="r",
        text="Friction radius at uniform pressure",
        source=f"{S0}, friction radius",
    )
    d.advise(
        "bad_ring",
        inner >= outer,
        "ring inner diameter is not below ring outer diameter: this is no ring, and its other figures mean nothing",
        source=S0,
    )
    d.at_least(
        "ring_ratio_min", ratio, least, "-", text="The ring is not too narrow", source=f"{S1}, empirical range of c"
    )
    d.at_most("ring_ratio_max", ratio, most, "-", text="The ring is not too wide", source=f"{S1}, empirical range of c")
    return Ring(
        ratio_min=least,
        ratio_max=most,
        mean_diameter=mean,
        ratio=ratio,
        friction_radius=radius,
        # From the ratio, whose range is known, so that it is surely positive wherever the ratio is.
        width=mean * ratio,
        # Straight from the variables: a radius formed from mean diameter and ratio would use each of them twice.
        inner_radius=inner / 2,
        outer_radius=outer / 2,
        area=ring_formulas.ring_area(mean, ratio),
    )


def _named(d: Declaration, listed: Part) -> tuple[Any, Any]:
    """Report the diameters of a ring of a list under the names that they have where they are searched."""
    text, outer, inner = "diameter of the friction ring", listed.ring_outer_diameter, listed.ring_inner_diameter
    return (
        d.derive("ring_outer_diameter", "mm", outer, symbol="d_out", text=f"Outer {text}", source=f"{S1}, d1"),
        d.derive("ring_inner_diameter", "mm", inner, symbol="d_in", text=f"Inner {text}", source=f"{S1}, d2"),
    )
