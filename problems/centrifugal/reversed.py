"""Reversed centrifugal clutch: flyweights lift a disc off its stop and put preloaded springs on the pressure plate."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from synth.declaration import Declaration

from ..components.springs.model import Fitted, declare_springs
from ..mechanics import centrifugal_levers as formulas
from ..sources import NOT_IN_S4
from .lever_clutch import Engagement, Legs, LeverClutch
from .lever_curves import REVERSED
from .levers import LOADED, RECONSTRUCTED, Lever, name_contact

# Range of the short leg [mm]; refusals reason with it.
PLATE_ARM = (3.0, 150.0)
DISC_1 = 1  # plates beside flywheel and pressure plate


@dataclass(frozen=True)
class ReversedLegs(Legs):
    """Leg of a reversed lever, which is short and long leg in one, and the springs that draw the plate back."""

    back: Fitted

    def engage(self, d: Declaration, lever: Lever, push: Any) -> Engagement:
        """Name what the speeds are made of; speeds and forces."""
        arm, contact_angle = lever.weights.arm, formulas.contact_angle(lever.contact_travel, self.long)
        returning = self.back.springs
        back = returning.force(self.back.most)
        band_squared = formulas.band_squared(
            push / back, formulas.growth(lever.radius(contact_angle), arm, lever.stop_angle - contact_angle)
        )
        name_contact(d, lever=lever, angle=contact_angle)
        for name, unit, value, symbol, text in (
            ("stop_spring_force", "N", push, "F_2", "Force of the clamp springs at the stop"),
            ("contact_force", "N", back, "F_1", "Force of the return springs at contact"),
            ("band_squared", "-", band_squared, "k_band", "Square of the stop speed over the contact speed"),
        ):
            d.step(name, unit, value, symbol=symbol, text=text, source=RECONSTRUCTED)
        at_rest = returning.force(self.back.preload)
        return Engagement(
            contact=lever.speed(formulas.clamp_flyweight_force(back, self.long, arm), contact_angle),
            stop=lever.speed(formulas.clamp_flyweight_force(push, self.long, arm), lever.stop_angle),
            band=np.sqrt(band_squared),
            clamp=push - back,
            worn=push - back - (self.clamping.rate + returning.rate) * lever.wear,
            start_pull=formulas.clamp_flyweight_force(at_rest, self.long, arm),
            jump_radius=formulas.gradual_radius(self.back.preload, arm, self.long),
            contact_needs=(),
            band_needs=(LOADED,),
        )

    def limit_return(self, d: Declaration, lever: Lever) -> None:
        """Declare that the plate is on the friction disc before disc 1 lifts."""
        contact, lifted = self.back.springs.force(self.back.most), self.clamping.force(lever.deflection)
        text = "The plate is on the friction disc before disc 1 lifts"
        d.at_most("preload_order", contact, lifted, "N", text=text, source=NOT_IN_S4)


class CentrifugalReversed(LeverClutch):
    """Reversed centrifugal clutch: springs preloaded between a disc and the housing clamp once the disc lifts.

    The levers turn on disc 1. Their short legs first push the plate against its return springs, then against the
    friction disc, and once they push harder than the clamp springs, lift disc 1, up to a stop that caps the force.
    """

    name = "centrifugal_reversed"
    title = "Centrifugal clutch, reversed"
    kind = REVERSED

    stop_text = "the window of disc 1, so that the clamp force is capped"
    steps_text = "Disc 1 lifts step by step: it leaves the housing at a lower speed than the lever stops at"
    pushed = "pressure plate, and of disc 1"
    arms = (("plate_arm", "contact_travel"),)
    discs = DISC_1

    def declare_legs(self, d: Declaration, lever: Lever) -> Legs:
        """Declare clamp springs, leg and return springs."""
        clamping = declare_springs(
            d, slot="clamp_spring", symbol="sp", count_symbol="N_s", text="between disc 1 and the housing"
        )
        arm = d.variable(
            "plate_arm",
            "mm",
            *PLATE_ARM,
            grid=0.5,
            symbol="l_p",
            text="Short leg of the lever, which pushes the plate",
            source=RECONSTRUCTED,
        )
        returning = declare_springs(
            d, slot="return_spring", symbol="spr", count_symbol="N_r", text="draw the plate off the friction disc"
        )
        deflection = d.variable(
            "return_preload_deflection",
            "mm",
            0.5,
            20,
            grid=0.1,
            symbol="delta_r",
            text="Deflection of the return springs at rest",
            source=RECONSTRUCTED,
        )
        # They make the forces at contact and at the stop, and make up for one another; a sharp band sees them apart.
        d.split_last(
            "return_spring",
            "return_springs",
            "return_preload_deflection",
            "spring_preload_deflection",
            unless=("engagement_band", "idle_margin"),
        )
        back = Fitted(returning, deflection, lever.contact_travel)
        return ReversedLegs(arm, arm, "plate_arm", "plate_arm", PLATE_ARM[1], 1.0, clamping, back)
