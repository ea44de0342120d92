"""Friction pair of a clutch, and what its surfaces stand."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from ...mechanics import heat, plates
from ...sources import PRACTICE, S1
from .allowed import Makers

if TYPE_CHECKING:
    from synth.declaration import Declaration, Part

    from ...friction.duty import Duty
    from ...friction.engagement import Startup


@dataclass(frozen=True)
class Pair:
    """Slot friction_pair with the friction to reckon with."""

    part: Part
    linings: Makers
    mu_low: Any
    mu_high: Any
    hourly_allow: Any


def declare_friction_pair(
    d: Declaration,
    *,
    suited: Sequence[str],
    duty: Duty,
    lubrication: str | None,
    linings: type[Makers],
    take_up: str = "any",
) -> Pair:
    """Declare the slot friction_pair of a family and its remarks.

    Parameters
    ----------
    d : Declaration
        Takes the declarations.
    suited : sequence of str
        Conditions on the rows that suit the family.
    duty : Duty
        Block duty.
    lubrication : str or None
        dry or oil; None accepts both.
    linings : subclass of Makers
        What linings stand, with further conditions on their rows.
    take_up : str
        Default of the option of this name.

    Returns
    -------
    Pair
        The part, the friction that is counted on (mu_low) and the friction that is feared (mu_high).
    """
    conditions = [*suited, f"lubrication == '{lubrication}'" if lubrication else "lubrication in ('dry', 'oil')"]
    stand = linings(d, duty.allow_obsolete, take_up)
    conditions += stand.conditions(d)
    part = d.part(
        "friction_pair",
        "friction_materials",
        where=tuple(conditions),
        symbol="pair",
        text="Lining and the surface it rubs on",
        source="table friction_materials",
    )
    worst_case = duty.friction_basis == "worst_case"
    pair = Pair(
        part=part,
        linings=stand,
        mu_low=part.mu_min if worst_case else part.mu_dynamic,
        mu_high=part.mu_max if worst_case else part.mu_dynamic,
        hourly_allow=part.first_of("q_hourly_allow_forced_oil", "q_hourly_allow")
        if duty.cooling == "through_oil"
        else part.q_hourly_allow,
    )
    d.step("least_friction", "-", pair.mu_low, symbol="mu_low", text="Friction that is counted on", source=PRACTICE)
    d.step("greatest_friction", "-", pair.mu_high, symbol="mu_high", text="Friction that is feared", source=PRACTICE)
    # A remark must not make a row unusable, so that columns of remarks only are optional.
    d.advise(
        "stick_slip",
        part.optional("mu_static") < part.mu_dynamic,
        "static friction is below sliding friction: unusual, check the figures and the behaviour at lock-up",
        source=PRACTICE,
    )
    if duty.allow_obsolete == "yes":
        d.advise(
            "obsolete_material",
            part.optional("new_design_allowed") < 0.5,
            "this friction pair is not allowed in new designs; use it only to re-compute an old machine",
            source="table friction_materials",
        )
    return pair


def declare_surface_loads(
    d: Declaration,
    *,
    duty: Duty,
    pair: Pair,
    start: Startup,
    area: Any,
    rubbing_area: Any,
    pressure: Any,
    pressure_source: str,
    rubbing_radius: Any,
    narrowing: Any,
) -> None:
    """Declare pressure, heat, power and sliding speed of the friction surfaces with their limits.

    Parameters
    ----------
    d : Declaration
        Takes the declarations.
    duty : Duty
        Block duty.
    pair : Pair
        Slot friction_pair, whose limits apply.
    start : Startup
        What one engagement costs.
    area, rubbing_area : symbol
        All friction surfaces, whole and as far as they rub [m2].
    pressure : symbol
        Largest pressure [Pa].
    pressure_source : str
        Of its formula, which is that of the family.
    rubbing_radius : symbol
        Outermost radius that rubs [m].
    narrowing : symbol
        Half the difference of outer and inner edge over the mean radius [-].
    """
    part, stand, work = pair.part, pair.linings, start.friction_work
    d.derive("friction_area", "cm2", area, symbol="A", text="All friction surfaces together", source=f"{S1}, A")
    hourly = heat.specific_hourly_heat(work, duty.engagements_per_hour, rubbing_area)
    single, single_source = heat.single_heat(work, rubbing_area), "makers' limit for a single engagement"
    density, density_source = (
        heat.power_density(start.peak_slip_power, rubbing_area),
        "Neale, Tribology Handbook, Table 7.4",
    )
    speed, edge = plates.sliding_speed(duty.driver_speed, rubbing_radius), "at the outer edge when slip begins"
    loads = {}
    for name, unit, value, symbol, text, source in (
        ("hourly_heat", "J/(mm2*h)", hourly, "w", "Friction work per hour and area", f"{S1}, w"),
        ("single_heat", "J/mm2", single, "Q_A", "Friction work per engagement and area", single_source),
        ("power_density", "W/mm2", density, "q_peak", "Greatest friction power per area", density_source),
        ("sliding_speed", "m/s", speed, "v_s", f"Sliding speed {edge}", "kinematics"),
        ("surface_pressure", "N/mm2", pressure, "p_s", "Largest pressure on a friction surface", pressure_source),
    ):
        loads[name] = d.derive(name, unit, value, symbol=symbol, text=text, source=source), unit

    def limit(name: str, load: str, allowed: Any, text: str, source: str) -> None:
        value, unit = loads[load]
        d.at_most(name, value, allowed, unit, text=f"The lining stands the {text}", source=source)

    limit("surface_pressure", "surface_pressure", stand.pressure(part), "pressure", f"{S1}, sizing")
    stand.limit_heat(d, part, duty=duty, single=single, hourly=hourly, hourly_allow=pair.hourly_allow)
    limit("specific_power", "power_density", part.power_density_allow, "peak power", density_source)
    limit("sliding_speed", "sliding_speed", stand.speed(part), "sliding speed", "makers' limit of the lining")
    stand.limit_edge(d, part, pressure=loads["surface_pressure"][0], narrowing=narrowing)
