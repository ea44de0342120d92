"""Centrifugal clutch with levers and headed rods: flyweights swing levers that clamp through springs."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from synth.declaration import Block, Declaration, Requirement, Variable

from ..components.springs.model import declare_springs
from ..mechanics import centrifugal_levers as formulas
from ..sources import NOT_IN_S4, S4
from .lever_clutch import Engagement, Legs, LeverClutch
from .lever_curves import ROD
from .levers import LOADED, RECONSTRUCTED, Lever, name_contact

# Ranges of the arms [mm]; refusals reason with them.
SPRING_ARM, ROD_ARM = (10.0, 200.0), (3.0, 150.0)
PLACES = f"{S4}, what if rod and spring change places; {NOT_IN_S4}"
# Guards: the rod inside the spring, and springs under load at the stop.
GUARDS = ("rod_inside_spring", LOADED)


class Rods(Block):
    """Arms of rod and spring, and what is asked of them, all in SI."""

    group = "practice"

    rod_ratio_max = Requirement(
        "-",
        0.8,
        lower=0.1,
        upper=0.99,
        symbol="rho_rod",
        text="Largest arm of the rod over arm of the spring; at 1 nothing draws the lever back",
        source=PLACES,
    )
    retraction_force_min = Requirement(
        "N",
        150,
        lower=0,
        upper=1e5,
        symbol="F_retract_min",
        text="Least force at the spring's arm that draws the lever back at standstill",
        source=NOT_IN_S4,
        group="actuator",
    )
    spring_arm = Variable(
        "mm", *SPRING_ARM, grid=0.5, symbol="l_s", text="Arm of the clamp springs on the lever", source=RECONSTRUCTED
    )
    rod_arm = Variable(
        "mm", *ROD_ARM, grid=0.5, symbol="l_r", text="Arm of the headed rod on the lever", source=RECONSTRUCTED
    )


@dataclass(frozen=True)
class RodLegs(Legs):
    """Legs of a lever with a headed rod, and the least force that draws it back [N]."""

    retraction_force_min: Any

    @property
    def lead(self) -> Any:
        """Arm at which spring and taut rod together resist the flyweights [m]."""
        return self.long - self.short

    def guard(self, d: Declaration, lever: Lever) -> None:
        """Declare the guards that the springs draw the lever back, and are under load at the stop."""
        d.at_least(
            GUARDS[0],
            self.long,
            self.short,
            "mm",
            guard=True,
            text="The rod sits nearer to the pivot than the spring; otherwise the lever cannot retract and the clutch "
            "stays engaged",
            source=PLACES,
        )
        super().guard(d, lever)

    def engage(self, d: Declaration, lever: Lever, push: Any) -> Engagement:
        """Name what the speeds are made of; speeds and forces."""
        arm, contact_angle = lever.weights.arm, formulas.contact_angle(lever.contact_travel, self.short)
        after = lever.stop_angle - contact_angle
        band_squared = formulas.band_squared(
            formulas.growth(lever.deflection + self.lead * contact_angle, self.long, after),
            formulas.growth(lever.radius(contact_angle), arm, after),
            self.short / self.long,
        )
        contact, stop, band = lever.speeds(formulas.clamp_flyweight_force(push, self.long, arm), band_squared)
        self._name_engagement(d, lever=lever, contact_angle=contact_angle, squared=band_squared)
        at_rest = self.clamping.force(lever.deflection)
        return Engagement(
            contact=contact,
            stop=stop,
            band=band,
            clamp=push,
            worn=push - self.clamping.rate * lever.wear,
            start_pull=formulas.travel_flyweight_force(at_rest, self.long, self.short, arm),
            jump_radius=formulas.gradual_radius(lever.deflection, arm, self.lead),
            contact_needs=GUARDS,
            band_needs=GUARDS,
        )

    def limit_return(self, d: Declaration, lever: Lever) -> None:
        """Declare that the springs draw the lever back."""
        text = "The spring draws the lever back with an arm to spare"
        d.at_most("retraction_arm", self.short, self.ratio_max * self.long, "mm", text=text, source=PLACES)
        force = formulas.retraction_force(self.clamping.force(lever.deflection), self.long, self.short)
        text = "At standstill the spring draws the lever back"
        d.at_least("retraction_force", force, self.retraction_force_min, "N", text=text, source=NOT_IN_S4)

    def _name_engagement(self, d: Declaration, *, lever: Lever, contact_angle: Any, squared: Any) -> None:
        """Name what the speeds are made of: deflection at contact, growth of force and radius up to the stop."""
        after = lever.stop_angle - contact_angle
        deflection = lever.deflection + self.lead * contact_angle
        name_contact(d, lever=lever, angle=contact_angle)
        for name, unit, value, symbol, text in (
            ("contact_deflection", "mm", deflection, "delta_c", "Deflection of the clamp springs at contact"),
            (
                "force_growth",
                "-",
                formulas.growth(deflection, self.long, after),
                "k_F",
                "Force of the clamp springs at the stop over that at contact",
            ),
            ("band_squared", "-", squared, "k_band", "Square of the stop speed over the contact speed"),
        ):
            d.step(name, unit, value, symbol=symbol, text=text, source=RECONSTRUCTED)


class CentrifugalLever(LeverClutch):
    """Centrifugal clutch with levers, clamp springs and headed rods.

    A flyweight swings its lever outwards. The rod carries the plate along until it touches; then the rod goes slack and
    the spring between lever and plate clamps, up to a stop that caps the force.
    """

    name = "centrifugal_lever"
    title = "Centrifugal clutch, levers with headed rods"
    kind = ROD

    stop_text = "beyond contact, so that the clamp force is capped"
    steps_text = "The lever clamps step by step: the rod is free at a lower speed than it stops at"
    pushed = "pressure plate"
    arms = (("rod_arm", "contact_travel"), ("spring_arm", ""))

    def declare_legs(self, d: Declaration, lever: Lever) -> Legs:
        """Declare rod and spring, and the clamp springs between lever and plate."""
        rods = d.block(Rods)
        springs = declare_springs(
            d, slot="clamp_spring", symbol="sp", count_symbol="N_s", text="between lever and pressure plate"
        )
        return RodLegs(
            short=rods.rod_arm,
            long=rods.spring_arm,
            short_name="rod_arm",
            long_name="spring_arm",
            longest=ROD_ARM[1],
            ratio_max=rods.rod_ratio_max,
            clamping=springs,
            back=None,
            retraction_force_min=rods.retraction_force_min,
        )
