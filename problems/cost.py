"""Relative cost: what ranks designs of one family by what they take to make. It is no price.

The unit 1 is a kilogram of machined plain steel. Who gives every part a cost of its own (column ``unit_cost``) and
weights in the same money makes it one.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from synth.declaration import Block, Declaration, Part, Requirement

from .practice import UNSOURCED

UNIT_COST = "unit_cost"
SQUARE_DECIMETRE = 1e-2  # m2, for which unit_cost of a lining is given
NONE = 0.0  # stands where a row says no cost; costs are above it
SPRING_WIRE = 3.0  # a kilogram of a spring over one of plain steel
COPPER = 10.0  # a kilogram of winding wire over one of plain steel
POWDER = 20.0  # a kilogram of magnetic powder over one of plain steel
ROLLER = 2.0  # a track roller or bearing over a part that is turned


class CostWeights(Block):
    """What mass, parts and linings count in the relative cost."""

    group = "practice"

    cost_per_mass = Requirement(
        "1/kg",
        1,
        lower=0,
        upper=1e6,
        symbol="c_mass",
        text=f"Cost of a kilogram of machined plain steel ({UNSOURCED})",
        source=UNSOURCED,
    )
    cost_per_part = Requirement(
        "-", 0.3, lower=0, upper=1e6, symbol="c_part", text=f"Cost of one part more ({UNSOURCED})", source=UNSOURCED
    )


class LiningCostWeights(CostWeights):
    """What linings count beside."""

    cost_per_lining = Requirement(
        "1/dm2",
        0.2,
        lower=0,
        upper=1e6,
        symbol="c_lin",
        text=f"Cost of an area of lining whose relative cost is 1 ({UNSOURCED})",
        source=UNSOURCED,
    )


@dataclass(frozen=True)
class Special:
    """A part that costs other than plain steel of its mass.

    Attributes
    ----------
    name : str
        What it is, one word.
    part : Part or None
        Row whose table may give ``unit_cost``; None for what is of no table.
    amount : symbol
        How much of it, in what ``unit_cost`` is given for: pieces, or kilograms.
    mass : symbol
        Its share of the mass [kg].
    pieces : symbol
        Its share of the number of parts.
    factor : symbol
        Cost of its kilogram over one of plain steel.
    piece_factor : float
        Cost of one of its pieces over a part that is turned.
    """

    name: str
    part: Part | None
    amount: Any
    mass: Any = 0.0
    pieces: Any = 0.0
    factor: Any = 1.0
    piece_factor: float = 1.0


def declare_cost(
    d: Declaration, *, mass: Any, parts: Any, lining: tuple[Part, Any] | None = None, special: Sequence[Special] = ()
) -> None:
    """Declare the relative cost of a design and the objective that asks for it.

    Parameters
    ----------
    d : Declaration
        Takes the declarations.
    mass : symbol
        Mass of the complete clutch or coupling [kg].
    parts : symbol
        How many parts are made or bought [-].
    lining : tuple of Part and symbol, optional
        Row of the lining, with its relative_cost, and lined area [m2].
    special : sequence of Special
        Parts that cost other than plain steel, all of them counted in mass and parts as well.
    """
    weights = d.block(CostWeights) if lining is None else d.block(LiningCostWeights)
    cost = weights.cost_per_mass * mass + weights.cost_per_part * parts
    if lining is not None and isinstance(weights, LiningCostWeights):
        part, area = lining
        square = d.constant(
            "lining_unit_area",
            "m2",
            SQUARE_DECIMETRE,
            symbol="A_1",
            text="Square decimetre, for which unit cost of a lining is given",
            source="definition",
        )
        class_of = part.filled("relative_cost", NONE)
        known = np.where(class_of > NONE, class_of, 1.0)
        own = part.filled(UNIT_COST, NONE)
        own_cost = np.where(own > NONE, own * area / square, weights.cost_per_lining * known * area)
        d.step("lining_cost", "-", own_cost, symbol="C_lin", text="Relative cost of the linings", source=UNSOURCED)
        cost = cost + own_cost
        d.advise(
            "cost_class_unknown",
            np.logical_and(class_of <= NONE, own <= NONE),
            f"cost counts the lining like a moulded one: table {part.table} says neither relative cost nor unit cost",
            source=UNSOURCED,
        )
    for one in special:
        plain = weights.cost_per_mass * one.mass + weights.cost_per_part * one.pieces
        # What its class adds, not all of it less what was counted: bounds of a difference would be wide.
        added = weights.cost_per_mass * (one.factor - 1) * one.mass
        added = added + weights.cost_per_part * (one.piece_factor - 1) * one.pieces
        if one.part is not None:
            own = one.part.filled(UNIT_COST, NONE)
            added = np.where(own > NONE, own * one.amount - plain, added)
        d.step(
            f"{one.name}_cost",
            "-",
            added,
            symbol=f"C_{one.name}",
            text=f"What is added for {one.name.replace('_', ' ')}, which cost other than plain steel",
            source=UNSOURCED,
        )
        cost = cost + added
    d.derive(
        "cost",
        "-",
        cost,
        symbol="C",
        text="Relative cost: 1 is a kilogram of machined plain steel; it ranks designs of one family and is no price",
        source=UNSOURCED,
    )
    d.objective("cost", default=False)
