"""The machine behind a gear: what it asks at its own shaft, reduced to the shaft of the clutch."""

from __future__ import annotations

from collections.abc import Mapping
from itertools import combinations
from typing import Any

import numpy as np

from synth.declaration import Block, Declaration, Requirement

from ..mechanics import centrifugal, reduction
from ..sources import DRIVE

RESISTING = ("machine_torque", "lifted_mass")
CARRIED = ("lifted_mass", "moved_mass")
MOVED = ("machine_inertia", "moved_mass", "clutch_side_inertia")  # of families that start an inertia
INERT = (*MOVED, "lifted_mass")
ROPE, GEAR = ("drum_diameter", "rope_parts"), ("machine_ratio", "gear_efficiency")
SAME = 0.01  # share by which two words for one quantity may differ


def of_drive(unit: str, lower: float, upper: float, symbol: str, text: str, group: str = "") -> Requirement:
    """Requirement of the drive, in force where it is stated."""
    return Requirement(unit, None, lower, upper, True, symbol, text, DRIVE, group)


class Machine(Block):
    """Load of a machine behind gear and rope, all in SI; None where nothing is stated."""

    group = "duty"

    machine_ratio = of_drive("-", 1e-3, 1e4, "i_m", "Speed of the clutch over that of the machine; 1 without a gear")
    gear_efficiency = of_drive("-", 0.05, 1, "eta_g", "Share of the power that the gear passes on, else 1")
    machine_torque = of_drive("N*m", 0, 1e9, "M_m", "Torque at the machine's shaft, in place of load torque")
    lifted_mass = of_drive("kg", 1e-3, 1e7, "m_lift", "Mass whose weight the drive lifts")
    drum_diameter = of_drive("mm", 1, 20000, "D_drum", "Diameter of the drum, or of the wheel of what travels")
    rope_parts = of_drive("-", 1, 100, "k_rope", "Parts of the rope that carry; 1 where not stated")

    @property
    def load_of_machine(self) -> Any:
        """Load torque of machine and lifted mass at the clutch [N m]; None where neither is stated."""
        torque, mass = (self._number(name, 0.0) for name in RESISTING)
        if self.specifies("lifted_mass") and not self.specifies("load_torque", "power"):
            declare_gravity(self.declaration)
        return reduction.load_at_clutch(torque, mass, *self._gearing()) if self.specifies(*RESISTING) else None

    def _gearing(self) -> tuple[Any, Any, Any, Any]:
        """Drum, rope and gear; without a mass the drum does not matter."""
        drum, rope, ratio, efficiency = (self._number(name, 1.0) for name in (*ROPE, *GEAR))
        return drum, rope, ratio, efficiency

    def _number(self, name: str, otherwise: float) -> Any:
        return getattr(self, name) if self.specifies(name) else otherwise


class MovedMachine(Machine):
    """Load and inertia of a machine behind gear and rope, all in SI; None where nothing is stated."""

    driven_inertia: Any
    machine_inertia = of_drive("kg*m2", 0, 1e9, "J_m", "Inertia at the machine's shaft")
    moved_mass = of_drive("kg", 1e-3, 1e7, "m_t", "Mass that travels or turns with drum or wheel, without its weight")
    clutch_side_inertia = of_drive("kg*m2", 0, 1e6, "J_cs", "Inertia between clutch and gear")

    @property
    def inertia_of_machine(self) -> Any:
        """Inertia of machine and masses at the clutch [kg m2]; None where none is stated."""
        machine, moved, between, lifted = (self._number(name, 0.0) for name in INERT)
        inertia = reduction.inertia_at_clutch(machine, moved, lifted, *self._gearing(), between)
        return inertia if self.specifies(*INERT) else None


def declare_gravity(d: Declaration) -> None:
    """Name the standard gravity, once."""
    if "gravity" not in d.constants:
        gravity = centrifugal.STANDARD_GRAVITY
        d.constant("gravity", "m/s2", gravity, symbol="g_std", text="Standard gravity", source="CGPM 1901")


def refuse_machine(d: Declaration, machine: Machine) -> None:
    """Refuse words of the machine that lack another one."""
    if isinstance(machine, MovedMachine) and machine.specifies("driven_inertia"):
        inertias = {"driven_inertia": machine.driven_inertia, "machine": machine.inertia_of_machine}
        refuse_differing(d, inertias, "at the clutch they are different inertias")
    named = [name for name in (*CARRIED, *GEAR, *ROPE) if getattr(machine, name, None) is not None]
    if set(CARRIED) & set(named) and not machine.specifies("drum_diameter"):
        right = f"a drum_diameter (or that of the wheel) with {named[0]}, over which its force is a torque"
        d.refuse("mass_without_drum", getattr(machine, named[0]) > 0, right)
    if named and not machine.specifies(*RESISTING, *INERT):
        right = "machine_torque, lifted_mass or an inertia of the machine, which alone are reduced to the clutch shaft"
        d.refuse("nothing_behind_gear", getattr(machine, named[0]) > 0, right)


def refuse_differing(d: Declaration, words: Mapping[str, Any], why: str) -> None:
    """Refuse words for one quantity that differ; a word that nothing states has the value None."""
    for (one, x), (other, y) in combinations([(n, x) for n, x in words.items() if x is not None], 2):
        d.refuse(f"{one}_and_{other}", abs(x - y) > SAME * np.maximum(x, y), f"one of {one} and {other}; {why}")
