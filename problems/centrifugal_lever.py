"""Centrifugal clutch with levers and headed rods: flyweights swing levers that clamp through springs."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from problems import centrifugal_blocks as blocks
from problems import centrifugal_lever_blocks as lever_blocks
from problems.centrifugal_blocks import DERIVED, S4
from problems.centrifugal_lever_blocks import RECONSTRUCTED
from problems.mechanics import centrifugal
from problems.mechanics import centrifugal_levers as formulas
from synth import DesignProblem

if TYPE_CHECKING:

    from synth.declaration import Declaration

# Ranges of the arms [mm]; refusals reason with them.
SPRING_ARM, ROD_ARM = (10.0, 200.0), (3.0, 150.0)


class CentrifugalLever(DesignProblem):
    """Centrifugal clutch with levers whose clamp springs are held together by headed rods.

    A flyweight swings its lever outwards. The rod carries the plate along until it touches; then the rod goes slack and
    the spring between lever and plate clamps, up to a stop that caps the force.
    """

    name = "centrifugal_lever"
    title = "Centrifugal clutch, levers with headed rods"
    sources = (*blocks.SOURCES, "EN 13906-1, cylindrical helical compression springs")
    understands = (*blocks.COMMON, "lining_wear", "contact_travel")

    def declare(self, d: Declaration) -> None:
        """Declare requirements, unknowns, limits and objectives."""
        duty = blocks.declare_duty(d)
        rod_ratio = d.requirement(
            "rod_ratio_max", "-", 0.8, lower=0.1, upper=0.99, symbol="rho_rod",
            text="Largest arm of the rod over arm of the spring; at 1 nothing draws the lever back",
            source=f"{S4}, what if rod and spring change places; {DERIVED}",
        )  # fmt: skip
        retraction_min = d.requirement(
            "retraction_force_min", "N", 150, lower=0, upper=1e5, symbol="F_retract_min",
            text="Least force at the spring's arm that draws the lever back at standstill", source=DERIVED,
        )  # fmt: skip
        lever = lever_blocks.declare_lever(d, duty, "beyond contact, so that the clamp force is capped")
        spring_arm = d.variable(
            "spring_arm", "mm", *SPRING_ARM, grid=0.5, symbol="l_s",
            text="Arm of the clamp springs on the lever", source=RECONSTRUCTED,
        )  # fmt: skip
        rod_arm = d.variable(
            "rod_arm", "mm", *ROD_ARM, grid=0.5, symbol="l_r",
            text="Arm of the headed rod on the lever", source=RECONSTRUCTED,
        )  # fmt: skip
        springs = blocks.declare_springs(d, "clamp_spring", "sp", "N_s", "clamp springs between lever and plate")
        lining = blocks.declare_lining(d, self.name, duty)
        lever_blocks.limit_contact(d, lever, rod_arm, ROD_ARM[1], "rod_arm")
        shortest = lever.worn_travel / (rod_ratio * lever.weights.angle_limit)
        lever_blocks.refuse_room(d, duty, shortest, "spring_arm")

        d.at_least(
            "rod_inside_spring", spring_arm, rod_arm, "mm", guard=True,
            text="The rod sits nearer to the pivot than the spring; otherwise the lever cannot retract and the clutch "
            "stays engaged", source=f"{S4}, what if rod and spring change places; {DERIVED}",
        )  # fmt: skip
        squeeze = spring_arm * lever.stop_angle
        d.at_least(
            "clamp_spring_squeezed", lever.deflection + squeeze, lever.contact_travel, "mm", guard=True,
            text="At the stop the clamp springs are under load: there is a clamp force", source=DERIVED,
        )  # fmt: skip
        guards = ("rod_inside_spring", "clamp_spring_squeezed")
        arm, travel = lever.weights.arm, lever.contact_travel
        lead = spring_arm - rod_arm
        preload = springs.force(lever.deflection)
        contact_angle = formulas.contact_angle(travel, rod_arm)
        at_contact = formulas.travel_spring_force(preload, springs.rate, spring_arm, rod_arm, contact_angle)
        full = formulas.clamp_spring_force(preload, springs.rate, spring_arm, travel, lever.stop_angle)
        stop_flyweight = formulas.clamp_flyweight_force(full, spring_arm, arm)
        stop = lever.speed(stop_flyweight, lever.stop_angle)
        after = lever.stop_angle - contact_angle
        spring_gain = 1 + spring_arm * after / (lever.deflection + lead * contact_angle)
        radius_gain = 1 + arm * after / (lever.rest_radius + arm * contact_angle)
        band = np.sqrt(spring_gain / ((1 - rod_arm / spring_arm) * radius_gain))
        contact = stop / band
        blocks.declare_contact(d, duty, contact, needs="rod_inside_spring")
        blocks.declare_full_clamp(
            d, duty, lining, full - springs.rate * lever.wear, stop, RECONSTRUCTED, "clamp_spring_squeezed"
        )
        blocks.declare_band(d, band, "Full-clamp speed over contact speed; small is sharp", guards)
        blocks.declare_clamp(d, lining, full, "Clamp force from full_clamp_speed on, new lining", RECONSTRUCTED)
        stop_force = blocks.declare_stop_force(
            d, centrifugal.centrifugal_force(lever.weights.mass, lever.end_radius, duty.top_speed) - stop_flyweight,
            "Force of all flyweights on the stops of their levers at top_speed, at flyweight_arm", RECONSTRUCTED,
        )  # fmt: skip
        d.at_most(
            "no_snap_travel", formulas.gradual_radius(lever.deflection, arm, lead), lever.rest_radius, "mm",
            text="The plate travels gradually: the lever starts at a lower speed than that of contact; largest rest "
            "radius at which it would jump", source=DERIVED,
        )  # fmt: skip
        d.at_most(
            "no_snap_clamp", formulas.gradual_radius(lever.deflection - travel, arm, spring_arm), lever.rest_radius,
            "mm",
            text="The clamp force grows gradually: the rod goes slack at a lower speed than that of the stop; largest "
            "rest radius at which it would jump", source=DERIVED,
        )  # fmt: skip
        d.at_most(
            "retraction_arm", rod_arm, rod_ratio * spring_arm, "mm",
            text="The spring draws the lever back with an arm to spare", source=DERIVED,
        )  # fmt: skip
        d.at_least(
            "retraction_force", formulas.retraction_force(preload, spring_arm, rod_arm), retraction_min, "N",
            text="At standstill the spring draws the lever back", source=DERIVED,
        )  # fmt: skip
        blocks.limit_spring_force(
            d, "spring_force", springs, lever.deflection + squeeze - travel, "The clamp springs stand the stop"
        )
        blocks.limit_weight_room(d, duty, lever.weights, lever.rest_radius, spring_arm)
        flyweights = blocks.Flyweights(lever.weights.mass, lever.end_radius, lever.weights.thickness / 2)
        blocks.declare_size(d, duty, lining, lever.rest_radius, flyweights, [springs])
        start = lever.speed(formulas.travel_flyweight_force(preload, spring_arm, rod_arm, arm), 0.0)
        lever_blocks.advise_lever(d, duty, lining, lever, start, stop_force, full)
        blocks.advise_bowing(
            d, "clamp_springs_bow", duty, springs, lever.rest_radius, full / springs.count, "the clamp springs"
        )
        blocks.declare_objectives(d)
