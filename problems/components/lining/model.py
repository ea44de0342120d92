"""Friction pair of a clutch, and what its surfaces stand."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from ...mechanics import heat, plates
from ...practice import allowed_linings
from ...sources import PRACTICE, S1

if TYPE_CHECKING:
    from synth.declaration import Declaration, Part

    from ...friction.duty import Duty
    from ...friction.engagement import Startup


PLENTY = 1e12  # J/m2: where a row does not tell what a single engagement may bring, only that of an hour counts


class MakersHeat:
    """Heat that linings stand by their makers: that of one engagement, and that of an hour."""

    @staticmethod
    def limit(d: Declaration, *, duty: Duty, pair: Pair, single: Any, hourly: Any) -> None:
        """Declare the limits of heat over area, of an engagement [J/m2] and of an hour [W/m2]."""
        text = "The lining stands the hourly heat"
        d.at_most("specific_heat", hourly, pair.hourly_allow, "J/(mm2*h)", text=text, source=f"{S1}, w")
        text, source = "The lining stands the heat of one engagement", "makers' limit for a single engagement"
        once = pair.part.optional("q_single_allow")
        d.at_most("engagement_heat", single, once, "J/mm2", text=text, source=source)


class RateHeat(MakersHeat):
    """Heat that linings stand in practice: by one law from a single engagement to the hourly heat."""

    @staticmethod
    def limit(d: Declaration, *, duty: Duty, pair: Pair, single: Any, hourly: Any) -> None:
        """Declare the limit of heat over area, of an engagement [J/m2] at its rate."""
        once = pair.part.filled("q_single_allow", PLENTY)
        allowed = heat.allowed_work_at_rate(once, pair.hourly_allow / once, duty.engagements_per_hour)
        text = "The lining stands the heat of an engagement at this rate"
        d.at_most("rate_heat", single, allowed, "J/mm2", text=text, source="VDI 2241, from memory; makers' limits")


@dataclass(frozen=True)
class Pair:
    """Slot friction_pair with the friction to reckon with."""

    part: Part
    heat: type[MakersHeat]
    mu_low: Any
    mu_high: Any
    hourly_allow: Any


def declare_friction_pair(
    d: Declaration,
    *,
    heat: type[MakersHeat],
    suited: Sequence[str],
    duty: Duty,
    lubrication: str | None,
    linings: Callable[[Declaration, str], list[str]] = allowed_linings,
) -> Pair:
    """Declare the slot friction_pair of a family and its remarks.

    Parameters
    ----------
    d : Declaration
        Takes the declarations.
    heat : type
        What heat the lining stands.
    suited : sequence of str
        Conditions on the rows that suit the family.
    duty : Duty
        Block duty.
    lubrication : str or None
        dry or oil; None accepts both.
    linings : callable
        Further conditions, from the declaration and the word chosen for allow_obsolete.

    Returns
    -------
    Pair
        The part, the friction that is counted on (mu_low) and the friction that is feared (mu_high).
    """
    conditions = [*suited, f"lubrication == '{lubrication}'" if lubrication else "lubrication in ('dry', 'oil')"]
    conditions += linings(d, duty.allow_obsolete)
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
        heat=heat,
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
    """
    part = pair.part
    d.derive("friction_area", "cm2", area, symbol="A", text="All friction surfaces together", source=f"{S1}, A")
    hourly = d.derive(
        "hourly_heat",
        "J/(mm2*h)",
        heat.specific_hourly_heat(start.friction_work, duty.engagements_per_hour, rubbing_area),
        symbol="w",
        text="Friction work per hour and area",
        source=f"{S1}, w",
    )
    single = d.derive(
        "single_heat",
        "J/mm2",
        heat.single_heat(start.friction_work, rubbing_area),
        symbol="Q_A",
        text="Friction work per engagement and area",
        source="makers' limit for a single engagement",
    )
    density = d.derive(
        "power_density",
        "W/mm2",
        heat.power_density(start.peak_slip_power, rubbing_area),
        symbol="q_peak",
        text="Greatest friction power per area",
        source="Neale, Tribology Handbook, Table 7.4",
    )
    speed = d.derive(
        "sliding_speed",
        "m/s",
        plates.sliding_speed(duty.driver_speed, rubbing_radius),
        symbol="v_s",
        text="Sliding speed at the outer edge when slip begins",
        source="kinematics",
    )
    pressure = d.derive(
        "surface_pressure",
        "N/mm2",
        pressure,
        symbol="p_s",
        text="Largest pressure on a friction surface",
        source=pressure_source,
    )
    d.at_most(
        "surface_pressure",
        pressure,
        part.p_allow,
        "N/mm2",
        text="The lining stands the pressure",
        source=f"{S1}, sizing",
    )
    pair.heat.limit(d, duty=duty, pair=pair, single=single, hourly=hourly)
    d.at_most(
        "specific_power",
        density,
        part.power_density_allow,
        "W/mm2",
        text="The lining stands the peak power",
        source="Neale, Tribology Handbook, Table 7.4",
    )
    d.at_most(
        "sliding_speed",
        speed,
        part.v_allow,
        "m/s",
        text="The lining stands the sliding speed",
        source="makers' limit of the lining",
    )
