"""The pack of a dry disc clutch: one or two lined discs between pressure plates."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from synth.declaration import Block, Declaration, Requirement

from ...duty import cooling
from ...friction.duty import DutyInRows, Size
from ...friction.engagement import (
    Startup,
    advise_frequent_switching,
    declare_heated_body,
    declare_startup,
    declare_torque,
    mean_rise,
)
from ...mechanics import disc, heat, plates
from ...mechanics import ring as ring_formulas
from ...sources import S0, S1, TYPICAL
from ..lining.model import Pair, declare_surface_loads
from ..ring.model import Ring


class DiscRequirements(Block):
    """Requirements of a disc pack, all in SI."""

    group = "material"

    core_thickness = Requirement(
        "mm",
        2,
        lower=0.3,
        upper=30,
        symbol="t_core",
        text=f"Steel core of a disc ({TYPICAL})",
        source=TYPICAL,
        group="model",
    )
    disc_hub_radius = Requirement(
        "mm",
        20,
        lower=1,
        upper=500,
        symbol="r_hub",
        text=f"Inner edge of the core: room for the hub ({TYPICAL})",
        source=TYPICAL,
        group="envelope",
    )
    cover_gap = Requirement(
        "mm",
        8,
        lower=0,
        upper=100,
        symbol="s_cover",
        text=f"From the edge of the friction ring to the outside ({TYPICAL})",
        source=TYPICAL,
        group="model",
    )
    pressure_plate_density = Requirement(
        "kg/m3",
        7200,
        lower=1000,
        upper=20000,
        symbol="rho_plate",
        text="Density of the pressure plates, by default cast iron",
        source="material constant",
    )
    pressure_plate_specific_heat = Requirement(
        "J/(kg*K)",
        500,
        lower=100,
        upper=2000,
        symbol="cp_plate",
        text="Specific heat of the pressure plates, by default cast iron",
        source="material constant",
    )
    temperature_rise_limit = Requirement(
        "K",
        100,
        lower=1,
        upper=1000,
        symbol="dT_allow",
        text=f"Largest temperature rise of a pressure plate in one engagement ({TYPICAL})",
        source=TYPICAL,
    )


@dataclass(frozen=True)
class Facing:
    """Facing of a list: its thickness on one side, and how deep it may wear [m]."""

    thickness: Any
    wearable_depth: Any


@dataclass(frozen=True)
class DiscSize(Size):
    """Mass and room of a disc pack; one pressure plate, and all linings and cores."""

    plate_mass: Any
    lining_mass: Any
    core_mass: Any


@dataclass(frozen=True)
class DiscPack:
    """The discs and pressure plates; ``facing`` is None where the lining is as its own row has it."""

    wants: DiscRequirements
    discs: Any
    surfaces: Any
    plate_thickness: Any
    facing: Facing | None = None

    def lining_thickness(self, pair: Pair) -> Any:
        """Thickness of the lining on one side [m]."""
        return pair.part.lining_thickness if self.facing is None else self.facing.thickness


@dataclass(frozen=True)
class LinedDiscs:
    """Discs and their lining, with what they are declared for."""

    duty: DutyInRows
    ring: Ring
    pair: Pair
    pack: DiscPack

    @property
    def area(self) -> Any:
        """All friction surfaces together [m2]."""
        return self.pack.surfaces * self.ring.area


@dataclass(frozen=True)
class Discs(LinedDiscs):
    """Discs whose torque and start are declared."""

    start: Startup
    size: DiscSize


def declare_disc_pack(
    d: Declaration, *, duty: DutyInRows, ring: Ring, wants: DiscRequirements, facing: Facing | None = None
) -> DiscPack:
    """Declare requirements and unknowns of a disc pack, and the limit of its bore.

    Parameters
    ----------
    d : Declaration
        Takes the declarations.
    duty : Duty
        Block duty.
    ring : Ring
        Block ring.
    wants : DiscRequirements
        Requirements of the discs.
    facing : Facing, optional
        Facing of a list; without one it is as thick as the row of its lining says.

    Returns
    -------
    DiscPack
        Symbols of the block.
    """
    discs = d.count(
        "discs",
        1,
        2,
        symbol="n_d",
        text="Lined discs, each with a pressure plate of its own; two friction surfaces per disc",
        source=f"{S1}, disc clutch: few large friction surfaces",
    )
    plate_thickness = d.variable(
        "pressure_plate_thickness",
        "mm",
        3,
        40,
        grid=0.5,
        symbol="t_p",
        text="Thickness of a pressure plate, which stores the heat",
        source=f"{S1}, pressure plate",
    )
    d.at_least(
        "hub_bore",
        ring.inner_radius,
        wants.disc_hub_radius,
        "mm",
        text="The hub fits inside the friction ring",
        source="geometry",
    )
    if duty.outer_diameter_limit is not None:
        least_outer = 2 * wants.disc_hub_radius * (1 + ring.ratio_min) / (1 - ring.ratio_min)
        d.refuse(
            "no_room_for_ring",
            least_outer + 2 * wants.cover_gap > duty.outer_diameter_limit,
            "room for a friction ring of at least ring_ratio_min between disc_hub_radius and outer_diameter_limit, "
            "besides cover_gap",
        )
    d.advise(
        "twin_disc_release",
        discs > 1,
        "the intermediate plate of a twin disc needs a release of its own (lift springs, a stop): discs that do not "
        "part drag after release, on a vertical shaft most of all",
        source=f"{S0}, release must separate the plates",
    )
    return DiscPack(wants, discs, disc.surface_count(discs), plate_thickness, facing)


def declare_disc_start(
    d: Declaration, lined: LinedDiscs, *, force: Any, ramp_time: Any, needs: tuple[str, ...] = ()
) -> Startup:
    """Declare what discs carry under an axial force, a start with them, and what it does to the linings.

    Parameters
    ----------
    d : Declaration
        Takes the declarations.
    lined : LinedDiscs
        What is asked, and what it is made of.
    force : symbol
        Axial force F0 [N].
    ramp_time : symbol
        Variable ramp_time [s].
    needs : tuple of str
        Guards without which the torque does not exist.
    """
    duty, ring, pair, pack = lined.duty, lined.ring, lined.pair, lined.pack

    def torque(mu: Any) -> Any:
        return ring_formulas.friction_torque(mu, force, ring.friction_radius, pack.surfaces)

    torques = declare_torque(
        d,
        duty=duty,
        pair=pair,
        torque_low=torque(pair.mu_low),
        torque_high=torque(pair.mu_high),
        source=f"{S1}, sizing",
        needs=needs,
    )
    _declare_worn_torque(d, lined, force=force)
    start = declare_startup(d, duty=duty, torques=torques, ramp_time=ramp_time)
    declare_surface_loads(
        d,
        duty=duty,
        pair=pair,
        start=start,
        area=lined.area,
        rubbing_area=lined.area,
        pressure=force / ring.area,
        pressure_source=f"{S1}, p",
        rubbing_radius=ring.outer_radius,
        narrowing=ring.ratio,
    )
    return start


def _declare_worn_torque(d: Declaration, lined: LinedDiscs, *, force: Any) -> None:
    """Declare the capacity with worn-in lining under an axial force [N], and its limit."""
    ring, pair, pack = lined.ring, lined.pair, lined.pack
    worn = d.derive(
        "worn_torque",
        "N*m",
        ring_formulas.worn_torque(pack.surfaces, pair.mu_low, force, ring.mean_diameter),
        symbol="M_worn",
        text="Capacity with worn-in lining, pressure times radius constant (worst case: least friction)",
        source="Shigley, Mechanical Engineering Design, uniform wear",
    )
    d.step(
        "worn_friction_radius",
        "mm",
        ring.mean_diameter / 2,
        symbol="r_worn",
        text="Friction radius of the worn-in lining",
        source="Shigley, Mechanical Engineering Design, uniform wear",
    )
    d.at_least(
        "worn_torque_capacity",
        worn,
        lined.duty.required_torque,
        "N*m",
        text="The worn-in clutch carries the sizing torque",
        source="Shigley, Mechanical Engineering Design",
    )


def disc_size(lined: LinedDiscs) -> DiscSize:
    """Mass and room of discs and pressure plates."""
    duty, ring, pair, pack = lined.duty, lined.ring, lined.pair, lined.pack
    wants, lining = pack.wants, pack.lining_thickness(pair)
    core = plates.annulus_mass(
        duty.steel_density,
        pack.discs,
        wants.core_thickness,
        ring.outer_radius + wants.disc_hub_radius,
        ring.outer_radius - wants.disc_hub_radius,
    )
    plate = disc.pressure_plate_mass(wants.pressure_plate_density, pack.plate_thickness, ring.area)
    linings = plates.lining_mass(pair.part.density, lining, lined.area)
    return DiscSize(
        mass=pack.discs * plate + linings + core,
        plate_mass=plate,
        lining_mass=linings,
        core_mass=core,
        diameter=2 * (ring.outer_radius + wants.cover_gap),
        length=disc.clutch_length(pack.discs, lining, wants.core_thickness, pack.plate_thickness, duty.plate_gap),
    )


def declare_disc_inertia(d: Declaration, discs: Discs) -> None:
    """Declare the inertia of the discs, which the gearbox has to synchronise."""
    ring, pair, pack = discs.ring, discs.pair, discs.pack
    wants, density = pack.wants, discs.duty.steel_density
    lining = disc.lining_inertia(pair.part.density, pack.lining_thickness(pair), ring.mean_diameter, ring.ratio)
    core = disc.core_inertia(density, wants.core_thickness, ring.outer_radius, wants.disc_hub_radius)
    text = "Both linings of a disc"
    d.step("lining_inertia", "kg*m2", lining, symbol="J_lin", text=text, source="geometry")
    d.step("core_inertia", "kg*m2", core, symbol="J_core", text="Core of a disc", source="geometry")
    d.derive(
        "disc_inertia",
        "kg*m2",
        disc.disc_inertia(pack.discs, lining, core),
        symbol="J_disc",
        text="Inertia of the discs, cores with linings",
        source="geometry",
    )


def declare_disc_temperature(d: Declaration, discs: Discs) -> None:
    """Declare the temperatures of a disc pack, whose outside gives off the heat, and their limits."""
    duty, pair, start, pack, size = discs.duty, discs.pair, discs.start, discs.pack, discs.size
    wants = pack.wants
    plate_mass = disc.pressure_plate_mass(wants.pressure_plate_density, pack.plate_thickness, discs.ring.area)
    specific_heat = wants.pressure_plate_specific_heat
    for name, value, symbol, text in (
        ("pressure_plate_mass", size.plate_mass, "m_p", "A pressure plate"),
        ("lining_mass", size.lining_mass, "m_lin", "All linings"),
        ("core_mass", size.core_mass, "m_core", "Cores of all discs"),
    ):
        d.step(name, "kg", value, symbol=symbol, text=text, source="geometry")
    rise = d.derive(
        "temperature_rise",
        "K",
        heat.adiabatic_rise(start.friction_work, plate_mass, specific_heat, disc.HOTTEST_PLATE_SHARE),
        symbol="dT",
        text="Hottest pressure plate after one engagement, which takes half of the friction work",
        source="heat balance; half of the work for the hottest plate of a single or twin disc",
    )
    cooled_area = cooling.effective(d, plates.cylinder_surface(size.diameter, size.length))
    capacity = pack.discs * plate_mass * wants.pressure_plate_specific_heat
    mean = d.derive(
        "mean_temperature_rise",
        "K",
        mean_rise(duty, start.friction_work, duty.engagements_per_hour, capacity=capacity, cooled_area=cooled_area),
        symbol="dT_m",
        text="Clutch over ambient, mean of repeated switching",
        source=f"lumped heat balance; {S1}, repeated switching",
    )
    d.at_most(
        "plate_temperature_rise",
        rise,
        wants.temperature_rise_limit,
        "K",
        text="The pressure plate is thick enough for the heat of one engagement",
        source="heat balance",
    )
    d.at_most(
        "mean_temperature",
        mean,
        pair.linings.mean_temperature(pair.part, pair.part.temp_continuous) - duty.ambient_temperature,
        "K",
        text="The lining stands the mean temperature",
        source="Neale, Tribology Handbook, Table 7.4",
    )
    declare_heated_body(d, heat_capacity=capacity, cooled_area=cooled_area, body="The pressure plates")
    advise_frequent_switching(d, duty=duty, heat_capacity=capacity, cooled_area=cooled_area)
    d.advise(
        "lining_temperature",
        mean + rise
        > pair.linings.peak_temperature(pair.part, pair.part.optional("temp_max")) - duty.ambient_temperature,
        "just after an engagement in steady repetition the pressure plate is hotter than the lining stands: a thicker "
        "pressure plate or a stronger cooling helps",
        source="Neale, Tribology Handbook, Table 7.4",
    )
