"""Centrifugal clutch with levers and headed rods: flyweights swing levers that clamp through springs."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from synth import Design
from synth.declaration import Block, Declaration, Requirement, Variable

from .. import centrifugal as blocks
from .. import practice
from ..components.springs import model as spring_sets
from ..mechanics import centrifugal_levers as formulas
from ..sources import NOT_IN_S4, S4
from . import levers as lever_blocks
from .layers import LAYERS
from .lever_clutch import LeverClutch
from .lever_curves import ROD
from .levers import LOADED, RECONSTRUCTED

if TYPE_CHECKING:
    from collections.abc import Mapping

    from synth.drawing import Drawing


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

    @property
    def ratio(self) -> Any:
        """Arm of the rod over arm of the spring [-]."""
        return self.rod_arm / self.spring_arm

    @property
    def lead(self) -> Any:
        """Arm at which spring and taut rod together resist the flyweights [m]."""
        return self.spring_arm - self.rod_arm


class CentrifugalLever(LeverClutch):
    """Centrifugal clutch with levers, clamp springs and headed rods.

    A flyweight swings its lever outwards. The rod carries the plate along until it touches; then the rod goes slack and
    the spring between lever and plate clamps, up to a stop that caps the force.
    """

    name = "centrifugal_lever"
    title = "Centrifugal clutch, levers with headed rods"
    kind = ROD

    def declare(self, d: Declaration) -> None:
        """Declare requirements, unknowns, limits and objectives."""
        layer = LAYERS[practice.declare_scope(d)](d, blocks.LeverRules)
        duty = layer.duty
        lever = lever_blocks.declare_lever(d, duty=duty, stop_text="beyond contact, so that the clamp force is capped")
        rods = d.block(Rods)
        springs = spring_sets.declare_springs(
            d, slot="clamp_spring", symbol="sp", count_symbol="N_s", text="between lever and pressure plate"
        )
        lining = blocks.declare_lining(d, duty=duty, linings=layer.linings(d))
        lever_blocks.limit_contact(d, lever=lever, plate_arm=rods.rod_arm, longest=ROD_ARM[1], name="rod_arm")
        shortest = lever.worn_travel / (rods.rod_ratio_max * lever.weights.angle_limit)
        lever_blocks.refuse_room(d, duty=duty, least_leg=shortest, name="spring_arm")

        squeeze = rods.spring_arm * lever.stop_angle
        travel = squeeze - lever.contact_travel
        full = springs.force(lever.deflection + travel)
        self._declare_guards(d, lever=lever, rods=rods, squeeze=squeeze)
        self._declare_speeds(d, duty=duty, lining=lining, lever=lever, rods=rods, springs=springs, full=full)
        blocks.declare_clamp(
            d,
            lining=lining,
            force=full,
            text="Clamp force from full clamp speed on, with new linings",
            source=RECONSTRUCTED,
        )
        self._declare_retraction(d, lever=lever, rods=rods, springs=springs)
        fitted = spring_sets.Fitted(springs, lever.deflection, travel)
        spring_sets.limit_spring_force(d, fitted, name="spring_force", text="The clamp springs stand the stop")
        spring_sets.name_spring_lengths(d, fitted)
        blocks.limit_weight_room(
            d, duty=duty, weights=lever.weights, rest_radius=lever.rest_radius, pivot_arm=rods.spring_arm
        )
        layer.declare_size(d, lever_blocks.built(lining, lever, [springs]))
        layer.limit_set(d, fitted)
        at_stop = formulas.clamp_flyweight_force(full, rods.spring_arm, lever.weights.arm)
        at_start = formulas.travel_flyweight_force(
            springs.force(lever.deflection), rods.spring_arm, rods.rod_arm, lever.weights.arm
        )
        stop_force = lever_blocks.advise_lever(
            d,
            duty=duty,
            lining=lining,
            lever=lever,
            start_pull=at_start,
            stop_pull=at_stop,
        )
        layer.judge_stop(d, stop_force=stop_force, clamp_force=full)
        layer.advise_springs(d, fitted, radius=lever.rest_radius)
        layer.declare_objectives(d)

    def drawing(self, spec: Mapping[str, Any], design: Design) -> Drawing:
        """Return front view, lever and spring.

        Parameters
        ----------
        spec : mapping
            Requirements in SI by name, None where an optional one is not given.
        design : Design
            The design.
        """
        # Costly to import; searches do without.
        from ..components.springs.drawing import CLAMP
        from . import lever_drawing

        arms = lever_drawing.Leg("rod_arm", "contact_travel"), lever_drawing.Leg("spring_arm")
        return lever_drawing.lever_drawing(spec, design, arms=arms, pushed="pressure plate", springs=(CLAMP,))

    def _declare_guards(self, d: Declaration, *, lever: lever_blocks.Lever, rods: Rods, squeeze: Any) -> None:
        d.at_least(
            GUARDS[0],
            rods.spring_arm,
            rods.rod_arm,
            "mm",
            guard=True,
            text="The rod sits nearer to the pivot than the spring; otherwise the lever cannot retract and the clutch "
            "stays engaged",
            source=PLACES,
        )
        lever_blocks.require_loaded_springs(d, lever=lever, squeeze=squeeze)

    def _declare_speeds(
        self,
        d: Declaration,
        *,
        duty: blocks.Duty,
        lining: blocks.Lining,
        lever: lever_blocks.Lever,
        rods: Rods,
        springs: spring_sets.SpringSet,
        full: Any,
    ) -> None:
        """Declare the speeds, and that no phase of the motion snaps."""
        arm, contact_angle = lever.weights.arm, formulas.contact_angle(lever.contact_travel, rods.rod_arm)
        after = lever.stop_angle - contact_angle
        band_squared = formulas.band_squared(
            formulas.growth(lever.deflection + rods.lead * contact_angle, rods.spring_arm, after),
            formulas.growth(lever.radius(contact_angle), arm, after),
            rods.ratio,
        )
        contact, stop, band = lever.speeds(formulas.clamp_flyweight_force(full, rods.spring_arm, arm), band_squared)
        self._name_engagement(d, lever=lever, rods=rods, contact_angle=contact_angle, squared=band_squared)
        worn = full - springs.rate * lever.wear
        blocks.declare_contact(d, duty=duty, contact=contact, needs=GUARDS)
        blocks.declare_full_clamp(
            d, duty=duty, lining=lining, worn_force=worn, full_clamp_speed=stop, source=RECONSTRUCTED, needs=LOADED
        )
        blocks.declare_band(
            d, band=band, text="Full-clamp speed over contact speed; a small one is sharp", needs=GUARDS
        )
        d.at_most(
            "no_snap_travel",
            formulas.gradual_radius(lever.deflection, arm, rods.lead),
            lever.rest_radius,
            "mm",
            text="The lever travels to contact step by step: it starts at a lower speed than it touches at; shown is "
            "the rest radius below which it would jump",
            source=NOT_IN_S4,
        )
        d.at_most(
            "no_snap_clamp",
            formulas.gradual_radius(lever.deflection - lever.contact_travel, arm, rods.spring_arm),
            lever.rest_radius,
            "mm",
            text="The lever clamps step by step: the rod is free at a lower speed than it stops at; shown is the rest "
            "radius below which it would jump",
            source=NOT_IN_S4,
        )

    def _name_engagement(
        self, d: Declaration, *, lever: lever_blocks.Lever, rods: Rods, contact_angle: Any, squared: Any
    ) -> None:
        """Name what the speeds are made of: deflection at contact, growth of force and radius up to the stop."""
        after = lever.stop_angle - contact_angle
        deflection = lever.deflection + rods.lead * contact_angle
        lever_blocks.name_contact(d, lever=lever, angle=contact_angle)
        for name, unit, value, symbol, text in (
            ("contact_deflection", "mm", deflection, "delta_c", "Deflection of the clamp springs at contact"),
            (
                "force_growth",
                "-",
                formulas.growth(deflection, rods.spring_arm, after),
                "k_F",
                "Force of the clamp springs at the stop over that at contact",
            ),
            (
                "band_squared",
                "-",
                squared,
                "k_band",
                "Square of the stop speed over the contact speed",
            ),
        ):
            d.step(name, unit, value, symbol=symbol, text=text, source=RECONSTRUCTED)

    def _declare_retraction(
        self, d: Declaration, *, lever: lever_blocks.Lever, rods: Rods, springs: spring_sets.SpringSet
    ) -> None:
        d.at_most(
            "retraction_arm",
            rods.rod_arm,
            rods.rod_ratio_max * rods.spring_arm,
            "mm",
            text="The spring draws the lever back with an arm to spare",
            source=PLACES,
        )
        force = formulas.retraction_force(springs.force(lever.deflection), rods.spring_arm, rods.rod_arm)
        d.at_least(
            "retraction_force",
            force,
            rods.retraction_force_min,
            "N",
            text="At standstill the spring draws the lever back",
            source=NOT_IN_S4,
        )
