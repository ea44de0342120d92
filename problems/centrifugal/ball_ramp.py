"""Centrifugal clutch with balls in ramps that push the pressure plate directly (device A)."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from synth import Design, DesignProblem
from synth.declaration import Declaration

from .. import centrifugal as blocks
from .. import practice
from ..components.springs import model as spring_sets
from ..duty import coverage
from ..mechanics import ball_ramp, centrifugal
from ..sources import NOT_IN_S4, S4
from . import balls as ball_blocks
from . import curves
from . import state as states
from .layers import LAYERS

if TYPE_CHECKING:
    import pandas as pd

    from synth.drawing import Drawing


class CentrifugalBallRamp(DesignProblem):
    """Centrifugal clutch: balls in conical ramps push the pressure plate against return springs.

    The clamp force grows with the speed for ever, so that the clutch cannot be released at speed.
    """

    name = "centrifugal_ball_ramp"
    title = "Centrifugal clutch, ball ramp"
    sources = blocks.SOURCES
    understands = (*blocks.COMMON, "contact_speed_min", "clamp_force_limit", "ball_friction", "hertz_pressure_limit")
    declines, disregards, as_limits = coverage.AT_SPEED, coverage.NO_HOURS, coverage.ENVELOPE
    operating_point = states.OPERATING_POINT

    def declare(self, d: Declaration) -> None:
        """Declare requirements, unknowns, limits and objectives."""
        layer = LAYERS[practice.declare_scope(d)](d, blocks.Rules)
        duty, wear = layer.duty, layer.declare_wear(d)
        wants = ball_blocks.declare_force_limits(d, duty=duty)
        rest = blocks.declare_rest_radius(d)
        gap = d.variable(
            "plate_gap", "mm", 1.5, 6, symbol="h", text="Travel of the pressure plate to contact", source=f"{S4}, h"
        )
        deflection = d.variable(
            "spring_preload_deflection",
            "mm",
            1,
            20,
            grid=0.1,
            symbol="delta",
            text="Deflection of the return springs at rest",
            source=f"{S4}, F_R0/s",
        )
        balls = ball_blocks.declare_balls(d, duty=duty, rest_radius=rest)
        springs = spring_sets.declare_springs(
            d, slot="return_spring", symbol="sp", count_symbol="N_s", text="they push the pressure plate back"
        )
        # All four make the spring force at contact, and hardly anything else.
        d.split_last("return_spring", "return_springs", "spring_preload_deflection", "plate_gap")
        lining = blocks.declare_lining(d, duty=duty, linings=layer.linings(d))

        end = centrifugal.orbit_radius(rest, balls.ratio, gap)
        at_contact = springs.force(deflection + gap)
        gain = centrifugal.axial_gain(balls.mass, end, balls.push)
        text = "Force of the return springs at contact"
        d.step("contact_force", "N", at_contact, symbol="F_R1", text=text, source=f"{S4}, F_R1")
        text = "Axial force of the balls over the square of the speed"
        d.step("axial_gain", "kg*m", gain, symbol="g_ax", text=text, source=f"{S4}, analysis 1")
        speed = centrifugal.speed_for_force(at_contact, balls.mass, end, balls.push)
        # The same force at the same radius: written with the contact speed, the two speeds bound each other.
        release = speed * balls.release_ratio
        blocks.declare_contact(d, duty=duty, contact=speed, release=release, needs="ramp_returns")
        needed = lining.force(duty.torque_to_carry)
        blocks.declare_band(
            d,
            band=ball_ramp.clamp_speed_ratio(at_contact, needed),
            text="Speed at which required torque with its reserve is reached, over the contact speed",
        )
        # The two clamp forces share their terms, so that a bound of one bounds the other.
        at_full_speed = ball_ramp.clamp_force(gain, duty.full_torque_speed, speed)
        clamp = ball_ramp.faster_clamp_force(at_full_speed, gain, duty.full_torque_speed, duty.top_speed)
        text = "Clamp force at full torque speed"
        d.step("full_speed_force", "N", at_full_speed, symbol="F_full", text=text, source=f"{S4}, analysis 1")
        full = d.derive(
            "full_speed_torque",
            "N*m",
            lining.torque(at_full_speed),
            symbol="M_full",
            text="Torque at full torque speed, worn-in lining",
            source=f"{S4}, analysis 1, eq. (12), corrected",
        )
        d.at_least(
            "torque_at_full_speed",
            full,
            duty.torque_to_carry,
            "N*m",
            text="At full torque speed the clutch carries required torque with its reserve",
            source=f"{S4}, analysis 1, eq. (12), corrected",
        )
        blocks.declare_clamp(
            d,
            lining=lining,
            force=clamp,
            text="Clamp force at top speed, the largest",
            source=f"{S4}, analysis 1, eq. (12), corrected",
        )
        ball_blocks.limit_contact_and_clamp(
            d, wants=wants, contact_speed=speed, clamp_force=clamp, speed_text=" at top speed"
        )
        blocks.declare_stop_force(
            d,
            force=clamp,
            text="Force on the stop at top speed: the friction disc stops the plate, there is no other stop",
            source=f"{S4}, analysis 1",
        )
        d.at_most(
            "no_snap",
            deflection * balls.ratio,
            rest,
            "mm",
            text="The plate moves gradually: a larger speed for every further travel, no jump",
            source=NOT_IN_S4,
        )
        fitted = spring_sets.Fitted(springs, deflection, gap)
        spring_sets.limit_spring_force(
            d, fitted, name="spring_force", text="The return springs stand their deflection at contact"
        )
        spring_sets.name_spring_lengths(d, fitted)
        ball_blocks.declare_ball_pressure(d, duty=duty, balls=balls, end_radius=end)
        ball_blocks.limit_circle_room(d, wants=wants, rest_radius=rest, balls=balls, springs=[springs])
        layer.declare_size(
            d,
            blocks.Built(
                lining,
                rest,
                blocks.Flyweights(balls.mass, end, balls.radius, balls.part.diameter, balls.count),
                [springs],
                wear=wear,
                gap=gap,
                travel=gap,
                ball=balls.part,
            ),
        )
        layer.limit_set(d, fitted)
        start = centrifugal.speed_for_force(springs.force(deflection), balls.mass, rest, balls.push)
        blocks.advise_gravity(d, rest_radius=rest, start_speed=start)
        blocks.advise_release_gap(d, gap=gap, lining=lining)
        layer.advise_springs(d, fitted, radius=rest)
        layer.declare_objectives(d)

    def curves(self, spec: Mapping[str, Any], design: Design | None = None) -> dict[str, pd.DataFrame]:
        """Friction at the balls and the force that the torque demands; of a design forces and travel over speed.

        Parameters
        ----------
        spec : mapping
            Requirements in SI by name, None where an optional one is not given.
        design : Design, optional
            The design to draw.

        Returns
        -------
        dict of str to DataFrame
            ``idle_margin_over_ramp``, ``clamp_force_over_lining``, and of a design ``engaging_over_speed`` and
            ``releasing_over_speed``.
        """
        frames = {
            "idle_margin_over_ramp": curves.idle_margin_over_ramp(self, spec),
            "clamp_force_over_lining": curves.clamp_force_over_lining(self, spec),
        }
        if design is not None:
            frames |= curves.over_speed(self, spec, curves.ball_ramp_path(spec, design))
        return frames

    def state(self, spec: Mapping[str, Any], design: Design, point: Mapping[str, float]) -> pd.DataFrame:
        """State of the flyweights at a speed, the pressing force and the torque that can be carried.

        Parameters
        ----------
        spec : mapping
            Requirements in SI by name, None where an optional one is not given.
        design : Design
            The design.
        point : mapping
            ``speed`` of the driving side [rad/s].
        """
        return states.of_path(spec, curves.ball_ramp_path(spec, design), point["speed"])

    def drawing(self, spec: Mapping[str, Any], design: Design) -> Drawing:
        """Return front view, ramp and spring.

        Parameters
        ----------
        spec : mapping
            Requirements in SI by name, None where an optional one is not given.
        design : Design
            The design.
        """
        # Costly to import; searches do without.
        from ..components.springs.drawing import return_spring
        from . import ramp_drawing

        return ramp_drawing.ramp_drawing(
            spec, design, travel="plate_gap", pushed="pressure plate", springs=[return_spring("plate_gap")]
        )
