"""What linings stand: by their makers, or by practice, which asks less of them and counts the surface they rub on."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from synth.declaration import Block, Declaration, Option, Part, Requirement

from ...mechanics import heat
from ...practice import UNSOURCED
from ...sources import S1

if TYPE_CHECKING:
    from ...friction.duty import Duty

EDGE_SHARE = 1.4  # pressure at the edge of a worn lining over the mean pressure of practice, where a row has none
PLENTY = 1e12  # J/m2: where a row does not tell what a single engagement may bring, only that of an hour counts
UNLIMITED = 1e4  # K, above what any surface stands


class Makers:
    """What linings stand by their makers."""

    def __init__(self, d: Declaration, allow_obsolete: str, take_up: str = "any") -> None:
        """Declare what is asked of linings; take_up is the usual one of the family."""
        self.allow_obsolete = allow_obsolete

    def conditions(self, d: Declaration) -> list[str]:
        """Conditions on rows that leave out what new designs may not have."""
        return [] if self.allow_obsolete == "yes" else ["new_design_allowed == 1"]

    def pressure(self, part: Part) -> Any:
        """Mean pressure that a lining stands [Pa]."""
        return part.p_allow

    def edge_pressure(self, part: Part, otherwise: Any) -> Any:
        """Pressure that the edge of a worn lining stands; otherwise where no practice tells [Pa]."""
        return otherwise

    def speed(self, part: Part) -> Any:
        """Sliding speed that a lining stands [m/s]."""
        return part.v_allow

    def mean_temperature(self, part: Part, lining: Any) -> Any:
        """Mean temperature that a pair stands whose lining alone stands another [K]."""
        return lining

    def peak_temperature(self, part: Part, lining: Any) -> Any:
        """Peak temperature that a pair stands whose lining alone stands another [K]."""
        return lining

    def limit_heat(
        self, d: Declaration, part: Part, *, duty: Duty, single: Any, hourly: Any, hourly_allow: Any
    ) -> None:
        """Declare the limits of heat over area, of an engagement [J/m2] and of an hour [W/m2]."""
        text, source = "The lining stands the hourly heat", f"{S1}, w"
        d.at_most("specific_heat", hourly, hourly_allow, "J/(mm2*h)", text=text, source=source)
        text, source = "The lining stands the heat of one engagement", "makers' limit for a single engagement"
        d.at_most("engagement_heat", single, part.optional("q_single_allow"), "J/mm2", text=text, source=source)

    def limit_edge(self, d: Declaration, part: Part, *, pressure: Any, narrowing: Any) -> None:
        """Declare the pressure at the edge, from the mean pressure [Pa] and half the width over the mean radius [-]."""

    def limit_mean(self, d: Declaration, part: Part, pressure: Any) -> None:
        """Declare the mean pressure [Pa], in families that know that of the edge."""


class LiningRules(Block):
    """What practice asks of linings, all in SI."""

    group = "practice"

    take_up = Option(
        ("soft", "medium", "any"),
        symbol="take",
        text="How the torque may set in: soft: organic linings; medium: sintered metal too; any: also ceramic and bare "
        "metal, which grab",
        source=UNSOURCED,
    )
    edge_pressure_ratio = Requirement(
        "-",
        lower=0.1,
        upper=10,
        optional=True,
        symbol="k_edge",
        text="Largest pressure at the edge of a worn lining over the pressure allowed by its maker; by default that of "
        f"the lining in practice, 1.4 times its mean pressure where it has none ({UNSOURCED})",
        source="Shigley, Mechanical Engineering Design: 1; beyond it " + UNSOURCED,
    )


class Practice(Makers):
    """What linings stand in practice, as far as their table tells; by their makers where it does not."""

    def __init__(self, d: Declaration, allow_obsolete: str, take_up: str = "any") -> None:
        super().__init__(d, allow_obsolete)
        self._rules = d.block(LiningRules, take_up=take_up)

    def conditions(self, d: Declaration) -> list[str]:
        """Conditions on rows that leave out historical linings and those that grab too, where the table tells."""
        conditions = super().conditions(d)
        if self.allow_obsolete == "no" and d.has_column("friction_materials", "status"):
            conditions.append("status in ('current', '')")  # a row of one's own need not say that it is current
        harder = {"soft": "('medium', 'harsh')", "medium": "('harsh')"}.get(self._rules.take_up)
        if harder and d.has_column("friction_materials", "take_up"):
            conditions.append(f"take_up not in {harder}")
        return conditions

    def pressure(self, part: Part) -> Any:
        """Mean pressure that is used [Pa]."""
        return part.first_of("p_mean_allow", "p_allow")

    def edge_pressure(self, part: Part, otherwise: Any) -> Any:
        """Pressure at the edge of a worn lining that is used; otherwise where the row has none [Pa]."""
        if self._rules.edge_pressure_ratio is not None:
            return self._rules.edge_pressure_ratio * part.p_allow
        listed = part.filled("p_max_allow", 0.0)
        used = np.where(listed > 0, listed, EDGE_SHARE * part.filled("p_mean_allow", 0.0))
        return np.where(used > 0, used, otherwise)

    def speed(self, part: Part) -> Any:
        """Sliding speed that is used [m/s]."""
        return np.minimum(part.v_allow, part.first_of("v_practice", "v_allow"))

    def mean_temperature(self, part: Part, lining: Any) -> Any:
        """Mean temperature that lining and mating surface stand [K]."""
        return np.minimum(lining, part.filled("counter_mean_max", UNLIMITED))

    def peak_temperature(self, part: Part, lining: Any) -> Any:
        """Peak temperature that lining and mating surface stand [K]."""
        return np.minimum(lining, part.filled("counter_peak_max", UNLIMITED))

    def limit_heat(
        self, d: Declaration, part: Part, *, duty: Duty, single: Any, hourly: Any, hourly_allow: Any
    ) -> None:
        """Declare the limit of heat over area of an engagement [J/m2] at its rate."""
        once = part.filled("q_single_allow", PLENTY)
        allowed = heat.allowed_work_at_rate(once, hourly_allow / once, duty.engagements_per_hour)
        text = "The lining stands the heat of an engagement at this rate"
        d.at_most("rate_heat", single, allowed, "J/mm2", text=text, source="VDI 2241, from memory; makers' limits")

    def limit_edge(self, d: Declaration, part: Part, *, pressure: Any, narrowing: Any) -> None:
        """Declare the pressure at the edge of the worn lining, where pressure times radius is constant."""
        edge = d.derive(
            "edge_pressure",
            "N/mm2",
            pressure / (1 - narrowing),  # worn_peak_pressure over the mean pressure
            symbol="p_edge",
            text="Pressure at the inner edge of the worn-in lining",
            source="Shigley, Mechanical Engineering Design, uniform wear",
        )
        text = "The edge of the worn lining stands the pressure"
        most = self.edge_pressure(part, EDGE_SHARE * part.p_allow)
        d.at_most("edge_pressure", edge, most, "N/mm2", text=text, source=UNSOURCED)

    def limit_mean(self, d: Declaration, part: Part, pressure: Any) -> None:
        """Declare the mean pressure and its limit."""
        text = "Mean pressure on a friction surface"
        mean = d.derive("surface_pressure", "N/mm2", pressure, symbol="p_s", text=text, source="geometry")
        text = "The lining stands the mean pressure"
        d.at_most("surface_pressure", mean, self.pressure(part), "N/mm2", text=text, source=UNSOURCED)
