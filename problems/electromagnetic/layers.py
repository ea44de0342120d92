"""What stands on the declared pack and its magnet: nothing, the complete clutch, rules of practice, or both."""

from __future__ import annotations

from typing import Any, ClassVar

from synth.declaration import Declaration

from .. import cost
from ..components.coil.model import Winding
from ..components.discs import layers as disc_layers
from ..components.magnet import model as magnet_blocks
from ..components.magnet.model import Magnet, MagnetSize, Pressed, Pull
from ..components.pack import layers as plate_layers
from ..components.shaft.model import ShaftRequirements
from ..duty import cooling
from ..practice import by_scope

MAGNET_PARTS = 3  # pot, armature and coil


class Sources:
    """Pack and magnet by the formulas of their sources."""

    plates: ClassVar[type[plate_layers.Sources]] = plate_layers.Sources
    discs: ClassVar[type[disc_layers.Sources]] = disc_layers.Sources
    mass_of: ClassVar[str] = "Pack and magnet with armature and coil"
    along: ClassVar[str] = "Released pack and engaged magnet"
    objectives: ClassVar[tuple[str, ...]] = ("coil_power", "mass")  # by default
    offered: ClassVar[tuple[str, ...]] = ()  # further objectives

    def __init__(self, d: Declaration, required: Any, shaft: ShaftRequirements | None) -> None:
        """Declare what rules for the magnet go by."""

    def declare_magnet(self, d: Declaration) -> Magnet:
        """Declare requirements, unknowns and force of the magnet."""
        return magnet_blocks.declare_magnet(d, sticking_gap=magnet_blocks.STICKING_GAP)

    def limit_pull_in(self, d: Declaration, magnet: Magnet, pull: Pull) -> None:
        """Declare that the magnet draws the armature in."""
        magnet_blocks.limit_pull_in(d, magnet, pull)

    def limit_magnet(self, d: Declaration, pressed: Pressed, magnet: Magnet, pull: Pull, winding: Winding) -> None:
        """Declare limits of coil and magnet by rules."""

    def declare_cost(self, d: Declaration, pressed: Pressed, magnet: Magnet, size: MagnetSize) -> None:
        """Declare the relative cost."""


class WithBody(Sources):
    """Pack and magnet in a complete clutch, whose mass and length are known beside theirs."""

    offered = ("length",)

    def declare_cost(self, d: Declaration, pressed: Pressed, magnet: Magnet, size: MagnetSize) -> None:
        """Declare the relative cost of the complete clutch."""
        wire = magnet.unknowns.winding_wire
        coil = cost.Special("copper", wire, amount=size.copper, mass=size.copper, pieces=1, factor=cost.COPPER)
        mass, parts = pressed.full_size.mass + size.mass, pressed.parts + MAGNET_PARTS
        cost.declare_cost(d, mass=mass, parts=parts, lining=(pressed.pair.part, pressed.area), special=[coil])


class Complete(WithBody):
    """Pack and magnet in a complete clutch, whose mass and length count."""

    plates, discs = plate_layers.Complete, disc_layers.Complete
    mass_of = along = "The whole clutch"


class Ruled(WithBody):
    """Pack and magnet by rules of practice; the supply limits the power, and size counts.

    Least power would ask for ever larger magnets.
    """

    plates, discs = plate_layers.Ruled, disc_layers.Ruled
    objectives = ("mass", "outer_diameter")

    def __init__(self, d: Declaration, required: Any, shaft: ShaftRequirements) -> None:
        self._rules = magnet_blocks.declare_magnet_rules(d)
        self._seat = magnet_blocks.Seat(required, shaft.shaft_diameter, shaft.hub_diameter)

    def declare_magnet(self, d: Declaration) -> Magnet:
        """Declare a magnet whose defaults grow with the clutch."""
        seat, still = self._seat, cooling.still_transfer(d)
        return magnet_blocks.declare_magnet(d, sticking_gap=seat.sticking_gap, still_transfer=still, **seat.defaults)

    def limit_pull_in(self, d: Declaration, magnet: Magnet, pull: Pull) -> None:
        """Declare that the magnet draws the armature in; a gap that is not set again counts with worn linings."""
        if self._rules.wear_adjust == "yes":
            super().limit_pull_in(d, magnet, pull)

    def limit_magnet(self, d: Declaration, pressed: Pressed, magnet: Magnet, pull: Pull, winding: Winding) -> None:
        """Declare limits of coil and magnet by the rules."""
        magnet_blocks.limit_magnet(d, pressed, magnet, pull, winding, self._rules)


class RuledComplete(Ruled, Complete):
    """Pack and magnet by rules of practice, in a complete clutch whose mass and length count."""

    plates, discs = plate_layers.RuledComplete, disc_layers.RuledComplete


LAYERS = by_scope(Sources, Complete, Ruled, RuledComplete)
