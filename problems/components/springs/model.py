"""Sets of compression springs: their force, what they stand, and what is worth a remark."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from ...mechanics import centrifugal
from ...practice import UNSOURCED
from ...sources import NOT_IN_S4, S4

if TYPE_CHECKING:
    from synth.declaration import Declaration, Part

TOLERANCES = 10  # least preload over the tolerance to which it is set
# When springs of a slot are shortest, and what the symbols of their lengths begin with.
SHORTEST = {"return_spring": ("at contact", "L_rs"), "clamp_spring": ("at the stop", "L_cs")}
# Remarks only.
ZIMMERLI_AMPLITUDE = 241e6  # shear stress amplitude that unpeened spring wire lasts at [Pa]


@dataclass(frozen=True)
class SpringSet:
    """Equal springs side by side."""

    part: Part
    count: Any

    @property
    def name(self) -> str:
        """What people call them."""
        return f"{self.part.slot}s".replace("_", " ")

    @property
    def rate(self) -> Any:
        """Rate of the set [N/m]."""
        return centrifugal.set_rate(self.count, self.part.rate_R)

    @property
    def mass(self) -> Any:
        """Mass of the set [kg]."""
        return self.count * self.part.mass

    def force(self, deflection: Any) -> Any:
        """Return the force of the set at a deflection from the free length [N]."""
        # Through the force of one spring, which a limit bounds: then that limit bounds the force of the set too.
        return self.count * centrifugal.spring_force(self.part.rate_R, deflection)

    @property
    def outside(self) -> Any:
        """Outside diameter of a spring [m]."""
        return self.part.mean_diameter_D + self.part.wire_diameter_d

    def share_of_circle(self, gap: Any) -> Any:
        """Return the length that the set takes of its circle, with a gap beside each spring [m]."""
        return self.count * (self.outside + gap)


def declare_springs(d: Declaration, *, slot: str, symbol: str, count_symbol: str, text: str) -> SpringSet:
    """Declare a slot of compression springs and the number of springs in it.

    Parameters
    ----------
    d : Declaration
        Takes the declarations.
    slot : {"return_spring", "clamp_spring"}
        Name of the slot; the count is its plural.
    symbol, count_symbol : str
        Symbols of slot and count.
    text : str
        What the springs do.

    Returns
    -------
    SpringSet
        Symbols of the block.
    """
    count = d.count(
        f"{slot}s",
        2,
        12,
        symbol=count_symbol,
        text=f"Number of springs: {text}",
        source=f"{S4}, springs around the shaft",
    )
    part = d.part(
        slot,
        "compression_springs",
        symbol=symbol,
        text=f"One spring of the set: {text}",
        source="table compression_springs",
    )
    return SpringSet(part, count)


@dataclass(frozen=True)
class Fitted:
    """A set at its place: its deflection at rest, and what is added to it until it is shortest [m]."""

    springs: SpringSet
    preload: Any
    travel: Any

    @property
    def most(self) -> Any:
        """Largest deflection from the free length [m]."""
        return self.preload + self.travel


@dataclass(frozen=True)
class SpringRules:
    """What rules of practice ask of a set: least springs, tolerance of their preload and least wire [m]."""

    count: Any
    tolerance: Any
    wire: Any


def name_spring_lengths(d: Declaration, fitted: Fitted) -> None:
    """Name the lengths of the springs of a set, at rest and at their largest deflection."""
    part = fitted.springs.part
    when, symbol = SHORTEST[part.slot]
    for name, deflection, ending, text in (
        ("rest_length", fitted.preload, "0", "at rest"),
        ("least_length", fitted.most, "1", when),
    ):
        text = f"Length of a {part.slot.replace('_', ' ')} {text}"
        length = part.free_length_L0 - deflection
        d.step(f"{part.slot}_{name}", "mm", length, symbol=f"{symbol}{ending}", text=text, source="geometry")


def limit_spring_force(d: Declaration, fitted: Fitted, *, name: str, text: str) -> None:
    """Declare the limit of a name, of the force on one spring at its largest deflection."""
    part = fitted.springs.part
    force = centrifugal.spring_force(part.rate_R, fitted.most)
    d.at_most(name, force, part.max_force_Fn, "N", text=text, source="EN 13906-1")


def limit_set(d: Declaration, fitted: Fitted, *, rules: SpringRules, prefix: str = "") -> None:
    """Declare the limits that an engineer adds to a set; names begin with a prefix where there is another set."""
    springs = fitted.springs
    for name, value, least, unit, text in (
        ("springs_per_set", springs.count, rules.count, "-", "So many {} do not tilt what they push"),
        (
            "preload_min",
            fitted.preload,
            TOLERANCES * rules.tolerance,
            "mm",
            "The deflection of {} at rest is more than what it can be set to",
        ),
        ("wire_min", springs.part.wire_diameter_d, rules.wire, "mm", "The {} stand turning with the clutch"),
    ):
        d.at_least(f"{prefix}{name}", value, least, unit, text=text.format(springs.name), source=UNSOURCED)


def limit_share_of_force(d: Declaration, *, name: str, springs: SpringSet, force: Any, text: str) -> None:
    """Declare the limit of the force on one spring, from the largest force of the set.

    Parameters
    ----------
    d : Declaration
        Takes the declarations.
    name : str
        Name of the limit.
    springs : SpringSet
        The set.
    force : symbol
        Largest force of the set [N].
    text : str
        What the limit says.
    """
    d.at_most(name, force / springs.count, springs.part.max_force_Fn, "N", text=text, source="EN 13906-1")


def advise_springs(d: Declaration, fitted: Fitted, *, radius: Any, density: Any, top_speed: Any) -> None:
    """Remark springs that bow outwards at top speed, or that tire from engaging again and again.

    Parameters
    ----------
    d : Declaration
        Takes the declarations.
    fitted : Fitted
        The set; the codes of the remarks begin with its slot.
    radius : symbol
        Radius on which they stand [m].
    density : symbol
        Of their wire [kg/m3].
    top_speed : symbol
        Of the clutch [rad/s].
    """
    part, what = fitted.springs.part, f"the {fitted.springs.name}"
    load = centrifugal.spring_bow_load(
        density, part.wire_diameter_d, part.mean_diameter_D, part.active_coils_n, radius, top_speed
    )
    d.advise(
        f"{part.slot}_bows",
        load > centrifugal.spring_force(part.rate_R, fitted.most),
        f"at top speed the centrifugal force of the coils of {what} is larger than their spring force: they bow "
        "outwards and rub unless they sit in pockets or on guides",
        source=NOT_IN_S4,
    )
    if "spring_amplitude" not in d.constants:  # one for all sets
        d.constant(
            "spring_amplitude",
            "N/mm2",
            ZIMMERLI_AMPLITUDE / 1e6,
            symbol="tau_Z",
            text="Amplitude of the shear stress that unpeened spring wire lasts at",
            source="Zimmerli",
        )
    amplitude = part.optional("tau_k_n_corrected") * part.rate_R * fitted.travel / (2 * part.max_force_Fn)
    d.advise(
        f"{part.slot}_tires",
        amplitude > ZIMMERLI_AMPLITUDE,
        f"engaged again and again {what} tire: their shear stress swings by more than the 241 N/mm2 to either side "
        "that unpeened wire lasts at",
        source="Zimmerli; Shigley, Mechanical Engineering Design, fatigue of helical springs",
    )
