"""Shaft of a clutch, its strength, and the bosses on it."""

from __future__ import annotations

from typing import Any

from synth.declaration import Block, Declaration, Requirement, RowRange

from ...mechanics import shaft as shaft_formulas
from ...mechanics.plates import shaft_shear_stress
from ...practice import UNSOURCED

SHAFT_STRENGTH = f"DIN 743-2, from memory; notch and pulsating share: {UNSOURCED}"
THIN = 0.95  # of the diameter that shaft_shear_allow needs: a shaft of a series may lie a little below it
MEGA = 1e6
SHAFT_STEEL = 315e6  # Pa: fatigue strength of C45 in reversed bending, table metals
SHAFT_SIZES = ("shaft_diameter", "shaft_radius", "bore_diameter")  # requirements by which a shaft is typed


class ShaftStress(Block):
    """Stresses that a shaft is sized and checked by, all in SI."""

    group = "practice"

    shaft_shear_allow = Requirement(
        "N/mm2",
        20,
        lower=1,
        upper=400,
        symbol="tau_s",
        text=f"Shear stress from which the default of shaft diameter follows ({UNSOURCED}; twelve shafts of real units "
        "run at 6 to 25)",
        source=UNSOURCED,
    )
    shaft_safety = Requirement(
        "-",
        1.5,
        lower=0.5,
        upper=5,
        symbol="S_D",
        text=f"Safety of the shaft against fatigue ({UNSOURCED}); it is of C45, has a keyway and is started over and "
        "over, without bending",
        source=UNSOURCED,
    )


class ShaftSize(ShaftStress):
    """The shaft of a clutch, all in SI."""

    shaft_diameter = Requirement(
        "mm",
        lower=1,
        upper=1000,
        symbol="d_s",
        text="Shaft; by default as shaft shear allow needs it",
        source="torsion of a solid shaft",
        group="envelope",
    )


class ShaftRequirements(ShaftSize):
    """The shaft of a clutch and the hub on it, all in SI."""

    group = "practice"

    hub_factor = Requirement(
        "-",
        1.5,
        lower=1.05,
        upper=5,
        symbol="k_b",
        text=f"Outside of a keyed steel hub over its bore ({UNSOURCED})",
        source=UNSOURCED,
    )

    @property
    def hub_diameter(self) -> Any:
        """Outside of the hub on the shaft [m]."""
        return self.hub_factor * self.shaft_diameter

    def boss_mass(self, density: Any) -> Any:
        """Mass of one boss [kg] of a density [kg/m3]."""
        return shaft_formulas.boss_mass(density, self.shaft_diameter, self.hub_factor)


def name_boss(d: Declaration, wants: ShaftRequirements) -> None:
    """Name the sizes of the bosses on a shaft, whose mass :meth:`ShaftRequirements.boss_mass` tells."""
    length = shaft_formulas.BOSS_LENGTH * wants.shaft_diameter
    for name, value, symbol, text in (
        ("boss_diameter", wants.hub_diameter, "d_boss", "Outside of a boss on the shaft"),
        ("boss_length", length, "L_boss", "Length of a boss on the shaft"),
    ):
        d.step(name, "mm", value, symbol=symbol, text=text, source=UNSOURCED)


def shaft_for(torque: Any) -> Any:
    """Return the default of shaft_diameter [m] for a torque [N m], as a function of the block."""
    return lambda block: shaft_formulas.shaft_diameter(torque, block.shaft_shear_allow)


def declare_shaft(d: Declaration, stress: ShaftStress, *, diameter: Any, torque: Any) -> None:
    """Limit the stress of a shaft, remark a thin one, and name the shaft end and key of the tables next to it.

    Parameters
    ----------
    d : Declaration
        Takes the declarations.
    stress : ShaftStress
        Stresses that the shaft goes by.
    diameter : symbol
        Of the shaft, typed or as the torque needs it [m].
    torque : symbol
        That the shaft is sized for [N m].
    """
    text, strength = "Fatigue strength of the shaft in bending, C45", SHAFT_STEEL / MEGA
    d.constant("shaft_fatigue_strength", "N/mm2", strength, symbol="sigma_bW", text=text, source="table metals, C45")
    bar, text = 1000 * shaft_formulas.TEST_BAR, "Diameter of a test bar"
    d.constant("test_bar", "mm", bar, symbol="d_B", text=text, source=SHAFT_STRENGTH)
    shear = d.step(
        "shaft_shear",
        "N/mm2",
        shaft_shear_stress(torque, diameter),
        symbol="tau_d",
        text="Shear stress of the shaft under the torque that it is sized for",
        source="torsion of a solid shaft",
    )
    size = d.step(
        "shaft_size_factor",
        "-",
        shaft_formulas.size_factor(diameter),
        symbol="K_d",
        text="Strength of the shaft over that of a test bar",
        source=SHAFT_STRENGTH,
    )
    d.at_most(
        "shaft_strength",
        shear,
        shaft_formulas.fatigue_shear(SHAFT_STEEL, size, stress.shaft_safety),
        "N/mm2",
        text="The shaft stands its torque in fatigue, with a keyway",
        source=SHAFT_STRENGTH,
    )
    d.advise(
        "thin_shaft",
        diameter < THIN * shaft_formulas.shaft_diameter(torque, stress.shaft_shear_allow),
        "the shaft runs above shaft shear allow, from which its diameter follows where none is typed: check its key, "
        "and its bending",
        source=UNSOURCED,
    )
    d.next_row(
        "shaft_end",
        diameter,
        "shaft_ends",
        "diameter",
        beside=RowRange("parallel_keys", over="shaft_diameter_over", up_to="shaft_diameter_up_to"),
        typed=any(r.given for name, r in d.requirements.items() if name in SHAFT_SIZES),
        text="Shaft end to make, and the parallel key that goes with it",
        source="DIN 748-1, DIN 6885-1",
    )
