"""What the drive asks of a friction clutch, and the room it gives it."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any, TypeVar

import numpy as np

from synth.declaration import Declaration, Option, Requirement

from ..duty import COOLING, INERT, WORDS, Start, cooling, coverage, of_drive, refuse_contradictions
from ..duty.factors import BY_RATE, TABLE, switching_factor
from ..mechanics import plates, startup
from ..mechanics import ring as ring_formulas
from ..sources import S0, S1, TYPICAL

# What a sheet for several families may state, as far as a family uses it.
COMMON = (
    *WORDS,
    *coverage.STARTS,
    *coverage.LIFE,
    *coverage.SIZES,
    "overload_torque",
    "actuation_force_limit",
    "steel_density",
)


class Starting(Start):
    """What is asked of the start of a load, all in SI; None where an optional requirement is not given."""

    group = "duty"
    leading = ("load_torque", "driver_speed", "driven_inertia")
    unloaded = f"{Start.unloaded}; or the slip_time_limit within which driven_inertia is"

    load_kind = Option(
        startup.LOAD_KINDS,
        "reactive",
        symbol="load",
        text="reactive: the load only resists, still until the clutch moves it; active: it acts from the start",
        source=f"{S1}, hoisted weight",
    )
    driven_inertia = Requirement(
        "kg*m2",
        lambda duty: duty.inertia_of_machine,
        lower=1e-6,
        upper=1e5,
        symbol="J2",
        text="Driven inertia at the clutch shaft; by default that of the machine",
        source=f"{S1}, J2",
        follows=True,
        instead=INERT,
    )
    engagements_per_hour = Requirement(
        "1/h", 50, lower=0.001, upper=36000, symbol="nu_h", text="Switching rate", source=f"{S1}, m_k"
    )
    slip_time_limit = Requirement(
        "s",
        4,
        lower=0.01,
        upper=600,
        symbol="t_slip_max",
        text="Longest slip of one engagement",
        source=f"{TYPICAL} of the reference model",
    )
    jerk_limit = of_drive("rad/s3", 0.01, 1e6, "jerk_max", "Largest jerk of the driven side: softness of the start")
    acceleration_limit = of_drive(
        "rad/s2", 0.01, 1e6, "acc_max", "Largest acceleration, at the end of the ramp or of slip"
    )


class Duty(Starting):
    """What the drive asks of the clutch, all in SI; None where an optional requirement is not given."""

    group = "duty"

    friction_basis = Option(
        ("nominal", "worst_case"),
        "nominal",
        symbol="basis",
        text="nominal: dynamic friction everywhere; worst_case: the least where much friction is needed, the greatest "
        "where it harms",
        source="scatter band of the friction pair",
    )
    cooling = COOLING
    allow_obsolete = Option(
        ("no", "historical", "yes"),
        "no",
        symbol="obs",
        text="historical: also friction pairs that are built no more (cork, leather, wood, felt; without practice they "
        "are never left out); yes: also those not allowed in new designs (asbestos), to re-compute old machines",
        source="table friction_materials",
        group="practice",
    )
    switching_factor = Requirement(
        "-",
        1.0,
        lower=0.4,
        upper=1,
        symbol="c_m",
        text="Engagement-count factor; 1 up to about 50 engagements per hour",
        source=f"{S1}, c_m",
    )
    speed_factor = Requirement(
        "-", 0.85, lower=0.5, upper=1.5, symbol="c_v", text="Sliding-speed factor", source=f"{S1}, c_v"
    )
    startup_torque = Requirement(
        "N*m",
        lower=0.1,
        upper=1e6,
        optional=True,
        symbol="T_start",
        text="Torque to which the actuator is limited during start-up; above that of the load",
        source=f"{S1}, start-up with 1080 N m",
    )
    overload_torque = Requirement(
        "N*m",
        lower=0.1,
        upper=1e7,
        optional=True,
        symbol="M_max",
        text="The clutch must slip at this torque",
        source=f"{S1}, clutch as safety element",
    )
    actuation_force_limit = of_drive("N", 1, 1e6, "F_max", "Largest force of the actuator", group="actuator")
    outer_diameter_limit = of_drive("mm", 5, 5000, "D_max", "Largest outside diameter", group="envelope")
    length_limit = of_drive("mm", 2, 5000, "L_max", "Largest length, without actuator and end stops", group="envelope")
    ambient_temperature = Requirement(
        "degC",
        40,
        lower=-60,
        upper=150,
        symbol="T_amb",
        text="Temperature of the surroundings",
        source=f"{TYPICAL} of the reference model",
    )
    heat_transfer = Requirement(
        "W/(m2*K)",
        lower=1,
        upper=5000,
        symbol="h_conv",
        text=f"Surface coefficient; by default that of the cooling chosen ({TYPICAL})",
        source="table cooling_options",
        group="model",
    )
    steel_density = Requirement(
        "kg/m3",
        7850,
        lower=1000,
        upper=20000,
        symbol="rho_steel",
        text="Density of the steel plates",
        source="material constant",
        group="material",
    )
    steel_specific_heat = Requirement(
        "J/(kg*K)",
        480,
        lower=100,
        upper=2000,
        symbol="cp_steel",
        text="Specific heat of the steel plates",
        source="material constant",
        group="material",
    )
    plate_gap = Requirement(
        "mm",
        0.3,
        lower=0.05,
        upper=3,
        symbol="gap",
        text=f"Release gap per surface ({TYPICAL})",
        source=TYPICAL,
        group="model",
    )

    def required_for(self, load_torque: Any) -> Any:
        """Sizing torque [N m] for a torque of the load [N m]."""
        factors = (self.safety_factor, self.switching_factor, self.speed_factor)
        return ring_formulas.required_torque(load_torque, *factors)

    @property
    def rating(self) -> Any:
        """Sizing torque [N m] of the load, or where nothing resists that of the inertia within the slip time stated."""
        if not (self.specifies("slip_time_limit") and self.specifies("load_torque")):
            return super().rating
        unloaded = self.driven_inertia * self.driver_speed / self.slip_time_limit
        return np.where(self.load_torque > 0, super().rating, unloaded)


AnyDuty = TypeVar("AnyDuty", bound=Duty)


class DutyInRows(Duty):
    """A duty of a body whose heating and cooling is counted."""

    group = "duty"

    starts_in_row = of_drive("-", 1, 1e6, "n_row", "Starts of a row that begins cold")

    @property
    def repetition(self) -> str:
        """Which engagement temperatures are told after."""
        return "in steady repetition" if self.starts_in_row is None else "the last of its row"


class DutyOfPlates(DutyInRows):
    """A duty of plates in guides, which take a share of the torque."""

    group = "model"

    guide_model = Option(
        ("series", "cz"),
        "series",
        symbol="guide",
        text="series: friction in the plate guides is computed; cz: the lecture's factor surface factor instead",
        source=f"{S0}, eq. (2) to (5); {S1}, c_z",
    )
    surface_factor = Requirement(
        "-",
        0.75,
        lower=0.3,
        upper=1,
        optional=lambda duty: duty.guide_model != "cz",
        symbol="c_z",
        text="Surface-count factor, used with guide model cz only; 0.75 belongs to ten surfaces",
        source=f"{S1}, c_z",
    )

    def required_for(self, load_torque: Any) -> Any:
        """Sizing torque [N m] for a torque of the load [N m]; without surface_factor guides take their share."""
        required = super().required_for(load_torque)
        return required / self.surface_factor if self.guide_model == "cz" else required


class DutyByRate(Duty):
    """A duty whose factors follow from the switching rate."""

    group = "duty"

    switching_factor = replace(
        Duty.switching_factor,
        default=lambda duty: switching_factor(duty.declaration, duty.engagements_per_hour),
        text="Engagement-count factor; by default that of engagements per hour: 1 up to 100, 0.4 above 360",
        source=f"table {TABLE}, {BY_RATE}",
    )
    service_life = of_drive("h", 0.01, 1e6, "L_h", "Hours in service, with the switching rate the least wear life")


class DutyOfPack(DutyOfPlates, DutyByRate):
    """A duty whose release gap follows from the pack where it is not given."""

    group = "model"

    plate_gap = Requirement(
        "mm",
        lower=0.05,
        upper=3,
        optional=True,
        symbol="gap",
        text="Release gap per surface; by default it grows with the diameter",
        source=TYPICAL,
    )


class DutyOfDiscs(DutyInRows, DutyByRate):
    """A duty of discs by the rules of practice, which come free although they run out."""

    group = "model"

    plate_gap = Requirement(
        "mm", 0.5, lower=0.05, upper=3, symbol="gap", text=f"Release gap per surface ({TYPICAL})", source=TYPICAL
    )


def declare_duty(d: Declaration, *, cooling_default: str, lubrication: str | None, kind: type[AnyDuty]) -> AnyDuty:
    """Declare the block duty and the refusals that concern it alone.

    Parameters
    ----------
    d : Declaration
        Takes the declarations.
    cooling_default : str
        Row of cooling_options used when the user names none.
    lubrication : str or None
        dry or oil where the family is bound to one of them; the cooling must fit.
    kind : subclass of Duty
        The block to declare.

    Returns
    -------
    Duty
        Symbols of the block.

    Raises
    ------
    InputError
        When the cooling does not go with the lubrication, or with what turns.
    """
    duty = d.block(kind, cooling=cooling_default, heat_transfer=lambda duty: cooling.row(d).heat_transfer)
    cooling.refuse_unfit(d, lubrication, turning=True)
    refuse_contradictions(d, duty)
    if duty.startup_torque is not None:
        d.refuse(
            "never_starts",
            duty.startup_torque <= duty.load_torque,
            "a startup_torque above load_torque; otherwise the load never starts",
        )
    if duty.load_kind == "active":
        d.advise(
            "runs_backwards",
            True,
            "an active load turns the driven side backwards until the clutch carries it; "
            "a brake or backstop that is released then makes it a reactive load with less heat",
            source=f"{S1}, start-up; friction work of the two kinds of load",
        )
    if "fan" in duty.cooling:
        d.advise(
            "fan_cooling",
            True,
            "fan blades cost power and treat the symptom only; best is to avoid the heat",
            source=f"{S0}, cooling of the plates",
        )
    return duty


def declare_ramp_time(d: Declaration) -> Any:
    """Declare the variable ramp_time."""
    return d.variable(
        "ramp_time",
        "s",
        0.01,
        10,
        symbol="t_r",
        text="Ramp of the force: time until the clutch torque is built up; never 0",
        source=f"{S1}, t_max",
    )


def declare_envelope(d: Declaration, *, duty: Duty, force: Any, diameter: Any, length: Any) -> None:
    """Declare the limits of force, diameter and length that were asked for."""
    asked = "requirement of the drive"
    if duty.actuation_force_limit is not None:
        d.at_most(
            "actuation_force",
            force,
            duty.actuation_force_limit,
            "N",
            text="The actuator can press so hard",
            source=asked,
        )
    if duty.outer_diameter_limit is not None:
        d.at_most(
            "outer_diameter",
            diameter,
            duty.outer_diameter_limit,
            "mm",
            text="The clutch fits the room across",
            source=asked,
        )
    if duty.length_limit is not None:
        d.at_most("length", length, duty.length_limit, "mm", text="The clutch fits the room along", source=asked)


@dataclass(frozen=True)
class Size:
    """Mass and room of a clutch."""

    mass: Any
    diameter: Any
    length: Any


def declare_size(d: Declaration, *, size: Size, mass_of: str, outside: str, along: str) -> None:
    """Declare mass, outer diameter, length and volume.

    Parameters
    ----------
    d : Declaration
        Takes the declarations.
    size : Size
        What is declared.
    mass_of, outside, along : str
        What the mass is of, what is outermost, and what the length runs over; for the reader.
    """
    d.derive("outer_diameter", "mm", size.diameter, symbol="D", text=outside, source="geometry")
    d.derive("length", "mm", size.length, symbol="L", text=along, source="geometry")
    d.derive(
        "volume",
        "dm3",
        plates.cylinder_volume(size.diameter, size.length),
        symbol="V",
        text="Enveloping cylinder",
        source="geometry",
    )
    d.derive("mass", "kg", size.mass, symbol="m", text=mass_of, source="geometry")
