"""Speed and torque of a drive: a torque is stated as that of the load, as a power, or as the rated one."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np

from synth.declaration import Block, Declaration, Option, Requirement

from ..sources import DRIVE, S1
from . import factors
from .machine import GEAR, RESISTING, ROPE, Machine, MovedMachine, of_drive, refuse_differing, refuse_machine

LOADS = ("load_torque", "power", *RESISTING)
WORDS = (*LOADS, "power_speed", "required_torque", "driver_speed", "safety_factor", *ROPE, *GEAR)  # of all families


def sized_by_load(block: Block) -> bool:
    """Whether the required torque follows from that of the load."""
    return block.specifies(*LOADS) and not block.specifies("required_torque")


def _source_of_shock(drive: Drive) -> str:
    """Where the shock factor is from."""
    classes = (drive.driver_class, drive.driven_class)
    return DRIVE if drive.specifies("safety_factor") else factors.source_of_shock(drive.declaration, *classes)


class Drive(Machine):
    """Speed and torque of a drive, all in SI; None where a word says nothing in the question."""

    group = "duty"
    leading = ("load_torque", "required_torque", "driver_speed")
    unloaded = "a required_torque where load_torque is 0: nothing resists, but something has to be brought up to speed"

    driver_class = Option(
        factors.drivers,
        "electric motor",
        text="What drives; gives the default of safety factor with the class of the driven machine",
        source=f"table {factors.TABLE}",
    )
    driven_class = Option(
        factors.machines,
        "medium",
        text="What is driven: a class of shock, or a machine of the table by name",
        source=f"table {factors.TABLE}",
    )
    driver_speed = Requirement(
        "1/min", lower=0.1, upper=60000, symbol="omega1", text="Speed of the driving side", source=DRIVE
    )
    safety_factor = Requirement(
        "-",
        lambda drive: factors.shock_factor(drive.declaration, drive.driver_class, drive.driven_class),
        lower=1,
        upper=5,
        optional=lambda drive: not sized_by_load(drive),
        symbol="n",
        text="Shock factor of the load: required torque over load torque; by default that of driver and driven machine",
        source=_source_of_shock,
    )
    power = of_drive("kW", 1e-6, 1e5, "P", "Power that the machine takes, in place of load torque")
    power_speed = Requirement(
        "1/min",
        lambda drive: drive.driver_speed,
        lower=0.1,
        upper=60000,
        optional=lambda drive: not drive.specifies("power"),
        symbol="omega_P",
        text="Speed at which the machine takes power; by default driver speed",
        source=DRIVE,
    )
    load_torque = Requirement(
        "N*m",
        lambda drive: drive.torque_of_machine,
        lower=0,
        upper=1e7,
        optional=lambda drive: not drive.specifies("power", *RESISTING),
        symbol="M_load",
        text="Torque of the load, by default that of power or machine; required torque is that with safety factor",
        source=DRIVE,
        follows=True,
    )
    required_torque = Requirement(
        "N*m",
        lambda drive: drive.required_for(drive.load_torque) if sized_by_load(drive) else None,
        lower=0.01,
        upper=1e7,
        symbol="M_req",
        text="Torque to carry, all application factors in it",
        source=DRIVE,
        follows=True,
        instead=LOADS,
    )

    def required_for(self, load_torque: Any) -> Any:
        """Torque to carry [N m] for a torque of the load [N m]."""
        return self.safety_factor * load_torque

    @property
    def torque_of_machine(self) -> Any:
        """Load torque that a power means, or the machine behind the gear [N m]; None where neither is given."""
        return self.load_of_machine if self.power is None else self.power / self.power_speed


class Start(Drive, MovedMachine):
    """Drive of a clutch that starts its load, whose torque counts as well, all in SI."""

    safety_factor = replace(Drive.safety_factor, optional=False, text="Shock factor of the load")
    load_torque = Requirement(
        "N*m",
        lambda drive: drive.load_of_rating if drive.sized_by_rating else drive.torque_of_machine,
        lower=0,
        upper=1e7,
        symbol="M_load",
        text="Torque of the load during start-up; by default that of power or machine or, without shock "
        "factor and the like, required torque",
        source=f"{S1}, M2",
        follows=True,
        instead=("required_torque", *LOADS[1:]),
    )
    required_torque = Requirement(
        "N*m",
        lambda drive: None if drive.sized_by_rating else drive.rating,
        lower=0.01,
        upper=1e7,
        symbol="M_req",
        text="Sizing torque, all factors in it",
        source=f"{S1}, sizing",
        follows=True,
    )

    @property
    def rating(self) -> Any:
        """Torque to carry [N m] that follows from the load."""
        return self.required_for(self.load_torque)

    @property
    def sized_by_rating(self) -> bool:
        """Whether the load follows from the torque that is required."""
        return self.specifies("required_torque") and not self.specifies(*LOADS)

    @property
    def rated_torque(self) -> Any:
        """Torque that drag is held against [N m]: that of the load, or the required one where nothing resists."""
        return np.where(self.load_torque > 0, self.load_torque, self.required_torque)

    @property
    def load_of_rating(self) -> Any:
        """Load torque [N m] whose sizing torque is the required one."""
        return self.required_torque / self.required_for(1.0)


def refuse_contradictions(d: Declaration, drive: Drive) -> None:
    """Refuse words for the torque that contradict each other."""
    _remark_unused_classes(d, drive)
    refuse_machine(d, drive)
    if drive.specifies("required_torque"):
        if drive.specifies("safety_factor") and not drive.specifies(*LOADS):
            text = "safety_factor is not used: it belongs to load_torque, and required_torque has all factors in it"
            d.advise("factor_unused", True, text)
        if drive.load_torque is not None:
            d.refuse(
                "required_below_load",
                drive.required_torque < drive.load_torque,
                "a required_torque of at least load_torque; the clutch carries what resists, with a reserve",
            )
    elif drive.specifies("load_torque", "machine_torque"):
        d.refuse("nothing_to_carry", drive.required_torque <= 0, drive.unloaded)
    loads = {
        "power": None if drive.power is None else drive.power / drive.power_speed,
        "load_torque": drive.load_torque if drive.specifies("load_torque") else None,
        "machine": drive.load_of_machine,
    }
    refuse_differing(d, loads, "at the clutch they are different torques (T = P/omega)")
    if drive.power is not None:
        d.refuse("power_at_standstill", drive.power_speed <= 0, "a power_speed at which the machine takes power")
    elif drive.specifies("power_speed"):
        d.refuse("speed_without_power", True, "a power that belongs to power_speed, or no power_speed")


def _remark_unused_classes(d: Declaration, drive: Drive) -> None:
    """Remark classes of driver or machine that no factor is read for."""
    classes = {"driver_class": drive.driver_class, "driven_class": drive.driven_class}
    unused = [name for name, chosen in classes.items() if chosen != getattr(type(drive), name).default]
    reason = "required_torque has all factors in it"
    if drive.specifies("safety_factor"):
        reason = "safety_factor is stated"
    elif drive.safety_factor is not None:
        ranged = len(factors.rows_of(d, drive.driver_class, drive.driven_class)) > 1
        unused = [name for name in unused if ranged and name == "driver_class"]
        reason = f"the factor of {drive.driven_class} holds whatever drives it"
    if unused:
        d.advise("class_unused", True, f"{' and '.join(unused)} not used: {reason}")
