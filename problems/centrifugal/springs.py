"""Sets of compression springs: their force, what they stand, and what is worth a remark."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from ..mechanics import centrifugal
from ..sources import NOT_IN_S4, S4

if TYPE_CHECKING:
    from synth.declaration import Declaration, Part

    from .duty import Duty

# Remarks only.
ZIMMERLI_AMPLITUDE = 241e6  # shear stress amplitude that unpeened spring wire lasts at [Pa]


@dataclass(frozen=True)
class SpringSet:
    """Equal springs side by side."""

    part: Part
    count: Any

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

    def share_of_circle(self, gap: Any) -> Any:
        """Return the length that the set takes of its circle, with a gap beside each spring [m]."""
        return self.count * (self.part.mean_diameter_D + self.part.wire_diameter_d + gap)


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


def name_spring_lengths(d: Declaration, *, springs: SpringSet, rest: Any, most: Any, symbol: str, when: str) -> None:
    """Name the lengths of the springs of a set, at rest and at their largest deflection.

    Parameters
    ----------
    d : Declaration
        Takes the declarations.
    springs : SpringSet
        The set; the names of the lengths begin with its slot.
    rest, most : symbol
        Deflections from the free length [m].
    symbol : str
        What the symbols begin with.
    when : str
        When the deflection is the largest.
    """
    free, what = springs.part.free_length_L0, springs.part.slot.replace("_", " ")
    for name, value, ending, text in (
        ("rest_length", free - rest, "0", "at rest"),
        ("least_length", free - most, "1", when),
    ):
        d.step(
            f"{springs.part.slot}_{name}",
            "mm",
            value,
            symbol=f"{symbol}{ending}",
            text=f"Length of a {what} {text}",
            source="geometry",
        )


def limit_spring_force(d: Declaration, *, name: str, springs: SpringSet, deflection: Any, text: str) -> None:
    """Declare the limit of the force on one spring at its largest deflection.

    Parameters
    ----------
    d : Declaration
        Takes the declarations.
    name : str
        Name of the limit.
    springs : SpringSet
        The set.
    deflection : symbol
        Largest deflection from the free length [m].
    text : str
        What the limit says.
    """
    force = centrifugal.spring_force(springs.part.rate_R, deflection)
    d.at_most(name, force, springs.part.max_force_Fn, "N", text=text, source="EN 13906-1")


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


def advise_springs(
    d: Declaration, *, duty: Duty, springs: SpringSet, radius: Any, preload: Any, travel: Any, what: str
) -> None:
    """Remark springs that bow outwards at top speed, or that tire from engaging again and again.

    Parameters
    ----------
    d : Declaration
        Takes the declarations.
    duty : Duty
        Requirements.
    springs : SpringSet
        The set; the codes of the remarks begin with its slot.
    radius : symbol
        Radius on which they stand [m].
    preload, travel : symbol
        Deflection at rest, and what is added to it in an engagement [m].
    what : str
        Which springs they are.
    """
    part = springs.part
    load = centrifugal.spring_bow_load(
        duty.steel_density, part.wire_diameter_d, part.mean_diameter_D, part.active_coils_n, radius, duty.top_speed
    )
    d.advise(
        f"{part.slot}_bows",
        load > centrifugal.spring_force(part.rate_R, preload + travel),
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
    amplitude = part.optional("tau_k_n_corrected") * part.rate_R * travel / (2 * part.max_force_Fn)
    d.advise(
        f"{part.slot}_tires",
        amplitude > ZIMMERLI_AMPLITUDE,
        f"engaged again and again {what} tire: their shear stress swings by more than the 241 N/mm2 to either side "
        "that unpeened wire lasts at",
        source="Zimmerli; Shigley, Mechanical Engineering Design, fatigue of helical springs",
    )
