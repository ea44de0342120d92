"""Reversed centrifugal clutch: flyweights lift a disc off its stop and put preloaded springs on the pressure plate."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from synth import Design

from .. import centrifugal as blocks
from .. import practice
from ..components.springs import model as spring_sets
from ..mechanics import centrifugal_levers as formulas
from ..sources import NOT_IN_S4
from . import levers as lever_blocks
from .layers import LAYERS
from .lever_clutch import LeverClutch
from .lever_curves import REVERSED
from .levers import LOADED, RECONSTRUCTED

if TYPE_CHECKING:
    from collections.abc import Mapping

    from synth.declaration import Declaration
    from synth.drawing import Drawing

# Range of the short leg [mm]; refusals reason with it.
PLATE_ARM = (3.0, 150.0)
DISC_1 = 1  # plates beside flywheel and pressure plate


@dataclass(frozen=True)
class Leg:
    """Short leg of the lever and the springs that draw the plate back, all in SI."""

    arm: Any
    springs: spring_sets.SpringSet
    deflection: Any

    def force(self, travel: Any) -> Any:
        """Return the force of the return springs after some travel of the plate [N]."""
        return self.springs.force(self.deflection + travel)


class CentrifugalReversed(LeverClutch):
    """Reversed centrifugal clutch: springs preloaded between a disc and the housing clamp once the disc lifts.

    The levers turn on disc 1. Their short legs first push the plate against its return springs, then against the
    friction disc, and once they push harder than the clamp springs, lift disc 1, up to a stop that caps the force.
    """

    name = "centrifugal_reversed"
    title = "Centrifugal clutch, reversed"
    kind = REVERSED

    def declare(self, d: Declaration) -> None:
        """Declare requirements, unknowns, limits and objectives."""
        layer = LAYERS[practice.declare_scope(d)](d, blocks.LeverRules)
        duty = layer.duty
        lever = lever_blocks.declare_lever(
            d, duty=duty, stop_text="the window of disc 1, so that the clamp force is capped"
        )
        springs = spring_sets.declare_springs(
            d, slot="clamp_spring", symbol="sp", count_symbol="N_s", text="between disc 1 and the housing"
        )
        leg = self._declare_leg(d)
        # They make the forces at contact and at the stop, and make up for one another; a sharp band sees them apart.
        d.split_last(
            "return_spring",
            "return_springs",
            "return_preload_deflection",
            "spring_preload_deflection",
            unless=("engagement_band", "idle_margin"),
        )
        lining = blocks.declare_lining(d, duty=duty, linings=layer.linings(d))
        lever_blocks.limit_contact(d, lever=lever, plate_arm=leg.arm, longest=PLATE_ARM[1], name="plate_arm")
        lever_blocks.refuse_room(
            d, duty=duty, least_leg=lever.worn_travel / lever.weights.angle_limit, name="plate_arm"
        )

        squeeze = leg.arm * lever.stop_angle
        lever_blocks.require_loaded_springs(d, lever=lever, squeeze=squeeze)
        lift = squeeze - lever.contact_travel
        push = springs.force(lever.deflection + lift)
        clamp = push - leg.force(lever.contact_travel)
        self._declare_speeds(d, duty=duty, lining=lining, lever=lever, leg=leg, springs=springs, push=push)
        blocks.declare_clamp(
            d,
            lining=lining,
            force=clamp,
            text="Clamp force from full clamp speed on, with new linings",
            source=RECONSTRUCTED,
        )
        fitted = spring_sets.Fitted(springs, lever.deflection, lift)
        back = spring_sets.Fitted(leg.springs, leg.deflection, lever.contact_travel)
        self._limit_springs(d, fitted, back)
        for one in (fitted, back):
            spring_sets.name_spring_lengths(d, one)
        blocks.limit_weight_room(d, duty=duty, weights=lever.weights, rest_radius=lever.rest_radius, pivot_arm=leg.arm)
        layer.declare_size(d, lever_blocks.built(lining, lever, [springs, leg.springs], DISC_1))
        layer.limit_set(d, fitted)
        layer.limit_set(d, back, prefix="return_")
        at_stop, at_start = (
            formulas.clamp_flyweight_force(force, leg.arm, lever.weights.arm) for force in (push, leg.force(0.0))
        )
        stop_force = lever_blocks.advise_lever(
            d,
            duty=duty,
            lining=lining,
            lever=lever,
            start_pull=at_start,
            stop_pull=at_stop,
        )
        layer.judge_stop(d, stop_force=stop_force, clamp_force=clamp)
        for one in (fitted, back):
            layer.advise_springs(d, one, radius=lever.rest_radius)
        layer.declare_objectives(d)

    def drawing(self, spec: Mapping[str, Any], design: Design) -> Drawing:
        """Return front view, lever and springs.

        Parameters
        ----------
        spec : mapping
            Requirements in SI by name, None where an optional one is not given.
        design : Design
            The design.
        """
        # Costly to import; searches do without.
        from ..components.springs.drawing import CLAMP, return_spring
        from . import lever_drawing

        arms = (lever_drawing.Leg("plate_arm", "contact_travel"),)
        springs = (CLAMP, return_spring("contact_travel"))
        return lever_drawing.lever_drawing(
            spec, design, arms=arms, pushed="pressure plate, and of disc 1", springs=springs
        )

    def _declare_leg(self, d: Declaration) -> Leg:
        return Leg(
            arm=d.variable(
                "plate_arm",
                "mm",
                *PLATE_ARM,
                grid=0.5,
                symbol="l_p",
                text="Short leg of the lever, which pushes the plate",
                source=RECONSTRUCTED,
            ),
            springs=spring_sets.declare_springs(
                d, slot="return_spring", symbol="spr", count_symbol="N_r", text="draw the plate off the friction disc"
            ),
            deflection=d.variable(
                "return_preload_deflection",
                "mm",
                0.5,
                20,
                grid=0.1,
                symbol="delta_r",
                text="Deflection of the return springs at rest",
                source=RECONSTRUCTED,
            ),
        )

    def _declare_speeds(
        self,
        d: Declaration,
        *,
        duty: blocks.Duty,
        lining: blocks.Lining,
        lever: lever_blocks.Lever,
        leg: Leg,
        springs: spring_sets.SpringSet,
        push: Any,
    ) -> None:
        """Declare the speeds, and that no phase of the motion snaps."""
        arm, contact_angle = lever.weights.arm, formulas.contact_angle(lever.contact_travel, leg.arm)
        back = leg.force(lever.contact_travel)
        band_squared = formulas.band_squared(
            push / back, formulas.growth(lever.radius(contact_angle), arm, lever.stop_angle - contact_angle)
        )
        contact = lever.speed(formulas.clamp_flyweight_force(back, leg.arm, arm), contact_angle)
        stop = lever.speed(formulas.clamp_flyweight_force(push, leg.arm, arm), lever.stop_angle)
        lever_blocks.name_contact(d, lever=lever, angle=contact_angle)
        text = "Force of the clamp springs at the stop"
        d.step("stop_spring_force", "N", push, symbol="F_2", text=text, source=RECONSTRUCTED)
        text = "Force of the return springs at contact"
        d.step("contact_force", "N", back, symbol="F_1", text=text, source=RECONSTRUCTED)
        text = "Square of the stop speed over the contact speed"
        d.step("band_squared", "-", band_squared, symbol="k_band", text=text, source=RECONSTRUCTED)
        worn = push - back - (springs.rate + leg.springs.rate) * lever.wear
        blocks.declare_contact(d, duty=duty, contact=contact)
        blocks.declare_full_clamp(
            d, duty=duty, lining=lining, worn_force=worn, full_clamp_speed=stop, source=RECONSTRUCTED, needs=LOADED
        )
        blocks.declare_band(
            d,
            band=np.sqrt(band_squared),
            text="Full-clamp speed over contact speed; a small one is sharp",
            needs=LOADED,
        )
        d.at_most(
            "no_snap_travel",
            formulas.gradual_radius(leg.deflection, arm, leg.arm),
            lever.rest_radius,
            "mm",
            text="The lever travels to contact step by step: it starts at a lower speed than it touches at; shown is "
            "the rest radius below which it would jump",
            source=NOT_IN_S4,
        )
        d.at_most(
            "no_snap_clamp",
            formulas.gradual_radius(lever.deflection - lever.contact_travel, arm, leg.arm),
            lever.rest_radius,
            "mm",
            text="Disc 1 lifts step by step: it leaves the housing at a lower speed than the lever stops at; shown is "
            "the rest radius below which it would jump",
            source=NOT_IN_S4,
        )

    def _limit_springs(self, d: Declaration, fitted: spring_sets.Fitted, back: spring_sets.Fitted) -> None:
        """Declare the limits of clamp and return springs."""
        d.at_most(
            "preload_order",
            back.springs.force(back.most),
            fitted.springs.force(fitted.preload),
            "N",
            text="The plate is on the friction disc before disc 1 lifts",
            source=NOT_IN_S4,
        )
        text = "The clamp springs stand the stop"
        spring_sets.limit_spring_force(d, fitted, name="spring_force", text=text)
        text = "The return springs stand the travel to contact"
        spring_sets.limit_spring_force(d, back, name="return_spring_force", text=text)
