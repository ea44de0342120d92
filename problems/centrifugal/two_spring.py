"""Centrifugal clutch with capped clamp force: balls or levers, tension disc, two spring sets and a stop (device B)."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from synth import Design, DesignProblem
from synth.declaration import Declaration

from .. import centrifugal as blocks
from .. import practice
from ..components.springs import model as spring_sets
from ..duty import coverage
from ..mechanics import centrifugal, two_spring
from ..sources import NOT_IN_S4, S4, TYPICAL
from . import balls as ball_blocks
from . import curves
from . import state as states
from .layers import LAYERS

if TYPE_CHECKING:
    import pandas as pd

    from synth.drawing import Drawing

ANALYSIS = f"{S4}, analysis 2, corrected"
MECHANISMS = ("ball_ramp", "lever")
TENSION_DISC = 1  # plates beside flywheel and pressure plate


@dataclass(frozen=True)
class Drive:
    """What balls and levers have in common: axial over centrifugal force going out, and what comes back of the speed.

    ``ratio`` is radial over axial travel, ``balls`` is None for levers.
    """

    mass: Any
    count: Any
    half_height: Any
    width: Any
    ratio: Any
    push: Any
    release_ratio: Any
    needs: tuple[str, ...]
    balls: ball_blocks.Balls | None


@dataclass(frozen=True)
class Way:
    """Gaps, springs and forces at the borders of the regimes, in the order in which they are met."""

    plate_travel: Any
    stop_travel: Any
    returning: spring_sets.SpringSet
    clamping: spring_sets.SpringSet
    clamp_preload: Any
    return_preload: Any
    contact_force: Any
    stop_force: Any
    start_travel: Any
    contact_travel: Any
    return_deflection: Any
    clamp_deflection: Any

    @property
    def fitted_return(self) -> spring_sets.Fitted:
        """The return springs, which are shortest at contact."""
        return spring_sets.Fitted(self.returning, self.return_deflection, self.plate_travel)

    @property
    def fitted_clamp(self) -> spring_sets.Fitted:
        """The clamp springs, which are shortest at the stop."""
        return spring_sets.Fitted(self.clamping, self.clamp_deflection, self.stop_travel - self.plate_travel)

    @property
    def return_rate(self) -> Any:
        """Rate of the return springs [N/m]."""
        return self.return_preload / self.return_deflection

    @property
    def clamp_rate(self) -> Any:
        """Rate of the clamp springs [N/m]."""
        return self.clamp_preload / self.clamp_deflection


class CentrifugalTwoSpring(DesignProblem):
    """Centrifugal clutch whose flyweights press clamp springs on the plate until a stop caps them.

    Because the clamp force is capped, a release bearing can open the clutch at any speed.
    """

    name = "centrifugal_two_spring"
    title = "Centrifugal clutch, two springs"
    sources = blocks.SOURCES
    understands = (*blocks.COMMON, "contact_speed_min", "clamp_force_limit", "lining_wear")
    declines, disregards, as_limits = coverage.AT_SPEED, coverage.NO_HOURS, coverage.ENVELOPE
    operating_point = states.OPERATING_POINT

    def declare(self, d: Declaration) -> None:
        """Declare requirements, unknowns, limits and objectives."""
        layer_of = LAYERS[practice.declare_scope(d)]
        mechanism = d.option(
            "mechanism",
            MECHANISMS,
            "ball_ramp",
            symbol="mech",
            text="ball_ramp: balls in ramps push the tension disc; lever: weights on single levers do",
            source=f"{S4}, analysis 2; practice 2",
            group="model",
        )
        layer = layer_of(d, blocks.Rules)
        duty = layer.duty
        wants = ball_blocks.declare_force_limits(d, duty=duty)
        wear = blocks.declare_wear(d)
        rest = blocks.declare_rest_radius(d)
        way = self._declare_way(d)
        drive = (
            self._declare_balls(d, duty=duty, rest=rest)
            if mechanism == "ball_ramp"
            else self._declare_levers(d, duty=duty, rest=rest, way=way)
        )
        lining = blocks.declare_lining(d, duty=duty, linings=layer.linings(d))

        def radius(travel: Any) -> Any:
            return centrifugal.orbit_radius(rest, drive.ratio, travel)

        end, at_contact = radius(way.stop_travel), radius(way.contact_travel)
        contact = centrifugal.speed_for_force(way.contact_force, drive.mass, at_contact, drive.push)
        stop = centrifugal.speed_for_force(way.stop_force, drive.mass, end, drive.push)
        self._name_way(d, way=way, at_contact=at_contact, at_start=radius(way.start_travel))
        blocks.declare_contact(d, duty=duty, contact=contact, release=contact * drive.release_ratio, needs=drive.needs)
        band = centrifugal.speed_ratio(way.stop_force, end, way.contact_force, at_contact)
        blocks.declare_band(d, band=band, text="Speed at which the clamp force is complete, over the contact speed")
        clamp = two_spring.clamp_force(way.stop_force, way.contact_force)
        worn = two_spring.worn_clamp_force(clamp, way.return_rate, way.clamp_rate, wear)
        blocks.declare_full_clamp(d, duty=duty, lining=lining, worn_force=worn, full_clamp_speed=stop, source=ANALYSIS)
        blocks.declare_clamp(
            d, lining=lining, force=clamp, text="Clamp force at the stop, the largest, new lining", source=ANALYSIS
        )
        ball_blocks.limit_contact_and_clamp(d, wants=wants, contact_speed=contact, clamp_force=clamp)
        self._limit_order(
            d, way=way, wear=wear, rest=rest, at_contact=at_contact, at_start=radius(way.start_travel), band=band
        )
        spring_sets.limit_share_of_force(
            d,
            name="spring1_force",
            springs=way.returning,
            force=way.contact_force,
            text="The return springs stand their deflection at contact",
        )
        spring_sets.limit_share_of_force(
            d,
            name="spring2_force",
            springs=way.clamping,
            force=way.stop_force,
            text="The clamp springs stand their deflection at the stop",
        )
        for fitted in (way.fitted_return, way.fitted_clamp):
            spring_sets.name_spring_lengths(d, fitted)
        if drive.balls is not None:
            ball_blocks.declare_ball_pressure(d, duty=duty, balls=drive.balls, end_radius=end)
        ball_blocks.limit_circle_room(
            d, wants=wants, rest_radius=rest, balls=drive.balls, springs=[way.returning, way.clamping]
        )
        push = centrifugal.axial_gain(drive.mass, end, drive.push) * duty.top_speed**2
        load = blocks.declare_stop_force(
            d,
            force=two_spring.stop_load(push, way.stop_force),
            text="Force on the stop of the tension disc at top speed",
            source=ANALYSIS,
        )
        layer.declare_size(
            d,
            blocks.Built(
                lining,
                rest,
                blocks.Flyweights(drive.mass, end, drive.half_height, drive.width, drive.count),
                [way.returning, way.clamping],
                wear=wear,
                gap=way.plate_travel,
                travel=way.stop_travel,  # the tension disc goes the whole way to its stop, the plate a part of it
                ball=None if drive.balls is None else drive.balls.part,
                discs=TENSION_DISC,
            ),
        )
        layer.limit_set(d, way.fitted_clamp)
        layer.limit_set(d, way.fitted_return, prefix="return_")
        start = centrifugal.speed_for_force(way.clamp_preload, drive.mass, rest, drive.push)
        blocks.advise_gravity(d, rest_radius=rest, start_speed=start)
        blocks.advise_release_gap(d, gap=way.plate_travel, lining=lining)
        for fitted in (way.fitted_return, way.fitted_clamp):
            layer.advise_springs(d, fitted, radius=rest)
        layer.judge_stop(d, stop_force=load, clamp_force=clamp)
        layer.declare_objectives(d)

    def curves(self, spec: Mapping[str, Any], design: Design | None = None) -> dict[str, pd.DataFrame]:
        """Curves that the torque demands; of a design forces and travel over speed, both branches.

        Parameters
        ----------
        spec : mapping
            Requirements in SI by name, None where an optional one is not given.
        design : Design, optional
            The design to draw.

        Returns
        -------
        dict of str to DataFrame
            ``clamp_force_over_lining``, with balls ``idle_margin_over_ramp``, and of a design ``engaging_over_speed``
            and ``releasing_over_speed``.
        """
        frames = {"clamp_force_over_lining": curves.clamp_force_over_lining(self, spec)}
        if self.option("mechanism") == "ball_ramp":
            frames["idle_margin_over_ramp"] = curves.idle_margin_over_ramp(self, spec)
        if design is not None:
            frames |= curves.over_speed(self, spec, curves.two_spring_path(self, spec, design))
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
        return states.of_path(spec, curves.two_spring_path(self, spec, design), point["speed"])

    def drawing(self, spec: Mapping[str, Any], design: Design) -> Drawing:
        """Return front view, ramp or lever, and springs.

        Parameters
        ----------
        spec : mapping
            Requirements in SI by name, None where an optional one is not given.
        design : Design
            The design.
        """
        # Costly to import; searches do without.
        from ..components.springs.drawing import CLAMP, return_spring
        from . import lever_drawing, ramp_drawing

        pushed, springs = "tension disc", (return_spring("plate_travel"), CLAMP)
        if self.option("mechanism") == "ball_ramp":
            return ramp_drawing.ramp_drawing(spec, design, travel="stop_travel", pushed=pushed, springs=springs)
        arms = (lever_drawing.Leg("axial_arm", "stop_travel"),)
        return lever_drawing.lever_drawing(spec, design, arms=arms, pushed=pushed, springs=springs)

    def _declare_way(self, d: Declaration) -> Way:
        plate = d.variable(
            "plate_travel",
            "mm",
            1,
            10,
            grid=0.1,
            symbol="a",
            text="Travel of the pressure plate to contact",
            source=f"{S4}, h1",
        )
        stop = d.variable(
            "stop_travel",
            "mm",
            1,
            40,
            grid=0.1,
            symbol="b",
            text="Travel of the tension disc to its stop",
            source=f"{S4}, h2",
        )
        return_deflection = d.variable(
            "return_preload_deflection",
            "mm",
            0.5,
            20,
            grid=0.1,
            symbol="delta1",
            text="Deflection of the return springs at rest",
            source=f"{S4}, F_R10/s1",
        )
        clamp_deflection = d.variable(
            "clamp_preload_deflection",
            "mm",
            0.5,
            20,
            grid=0.1,
            symbol="delta2",
            text="Deflection of the clamp springs at rest",
            source=f"{S4}, F_R20/s2",
        )
        returning = spring_sets.declare_springs(
            d,
            slot="return_spring",
            symbol="sp1",
            count_symbol="N_1",
            text="they push the pressure plate off the lining (R1)",
        )
        # The contact speed sees their force alone; room and stroke of the clamp springs decide with radius and ramp.
        d.split_last(
            "return_spring", "return_springs", "return_preload_deflection", unless=("engagement_band", "idle_margin")
        )
        clamping = spring_sets.declare_springs(
            d,
            slot="clamp_spring",
            symbol="sp2",
            count_symbol="N_2",
            text="the tension disc presses them on the pressure plate (R2)",
        )
        return_preload = returning.force(return_deflection)
        clamp_preload = clamping.force(clamp_deflection)
        # Through preloads and deflections: numbers and rates of the springs stand in the two preloads alone.
        contact_force = two_spring.stretched_force(return_preload, return_deflection, plate)
        return Way(
            plate_travel=plate,
            stop_travel=stop,
            returning=returning,
            clamping=clamping,
            clamp_preload=clamp_preload,
            return_preload=return_preload,
            contact_force=contact_force,
            stop_force=two_spring.stretched_force(clamp_preload, clamp_deflection, stop - plate),
            start_travel=two_spring.clamp_spring_travel(return_preload, clamp_preload, clamp_deflection),
            contact_travel=two_spring.contact_travel(contact_force, clamp_preload, clamp_deflection, plate),
            return_deflection=return_deflection,
            clamp_deflection=clamp_deflection,
        )

    def _name_way(self, d: Declaration, *, way: Way, at_contact: Any, at_start: Any) -> None:
        """Name the forces, travels and radii at the borders of the regimes."""
        for name, unit, value, symbol, text in (
            ("return_preload", "N", way.return_preload, "F_10", "Force of the return springs at rest"),
            ("clamp_preload", "N", way.clamp_preload, "F_20", "Force of the clamp springs at rest"),
            ("contact_force", "N", way.contact_force, "F_a", "Force of the return springs at contact"),
            ("stop_spring_force", "N", way.stop_force, "F_b", "Force of the clamp springs at the stop"),
            ("start_travel", "mm", way.start_travel, "x_s", "Travel of the tension disc until the plate moves"),
            ("disc_contact_travel", "mm", way.contact_travel, "x_c", "Travel of the tension disc at contact"),
            ("return_rate", "N/mm", way.return_rate, "s_1", "Rate of the return springs"),
            ("clamp_rate", "N/mm", way.clamp_rate, "s_2", "Rate of the clamp springs"),
            ("start_radius", "mm", at_start, "r_s", "Radius of the flyweights when the plate begins to move"),
            ("contact_radius", "mm", at_contact, "r_c", "Radius of the flyweights at contact"),
        ):
            d.step(name, unit, value, symbol=symbol, text=text, source=ANALYSIS)

    def _declare_balls(self, d: Declaration, *, duty: blocks.Duty, rest: Any) -> Drive:
        balls = ball_blocks.declare_balls(d, duty=duty, rest_radius=rest)
        return Drive(
            mass=balls.mass,
            count=balls.count,
            half_height=balls.radius,
            width=balls.part.diameter,
            ratio=balls.ratio,
            push=balls.push,
            release_ratio=balls.release_ratio,
            needs=("ramp_returns",),
            balls=balls,
        )

    def _declare_levers(self, d: Declaration, *, duty: blocks.Duty, rest: Any, way: Way) -> Drive:
        efficiency = d.requirement(
            "mechanism_efficiency",
            "-",
            0.95,
            lower=0.5,
            upper=1,
            symbol="eta_m",
            text=f"Efficiency of the levers, going out as coming in ({TYPICAL})",
            source=TYPICAL,
            group="model",
        )
        weights = blocks.declare_weights(d, duty=duty)
        arm = d.variable(
            "axial_arm",
            "mm",
            5,
            150,
            grid=0.5,
            symbol="l_a",
            text="Arm of the levers on the tension disc",
            source=f"{S4}, l_a",
        )
        ratio = d.derive(
            "lever_ratio",
            "-",
            weights.arm / arm,
            symbol="i_l",
            text="Transmission of the levers dr/dx",
            source=f"{S4}, practice 2",
        )
        angle = way.stop_travel / arm
        text = "Angle of the levers when the tension disc meets its stop"
        d.step("lever_stop_angle", "rad", angle, symbol="phi_max", text=text, source="geometry")
        d.at_most(
            "lever_angle",
            angle,
            weights.angle_limit,
            "rad",
            text="The levers turn so little that the model holds",
            source=NOT_IN_S4,
        )
        blocks.limit_weight_room(d, duty=duty, weights=weights, rest_radius=rest)
        d.advise(
            "levers_reconstructed",
            True,
            "the drawings of the levers are lost: their arms and the room they need are a reconstruction, and "
            "mechanism efficiency is a typical value",
            source=NOT_IN_S4,
        )
        return Drive(
            mass=weights.mass,
            count=weights.count,
            half_height=weights.thickness / 2,
            width=weights.width,
            ratio=ratio,
            push=ratio * efficiency,
            release_ratio=efficiency,  # sqrt(eta_out/eta_in) with eta_in = 1/eta_out
            needs=(),
            balls=None,
        )

    def _limit_order(
        self, d: Declaration, *, way: Way, wear: Any, rest: Any, at_contact: Any, at_start: Any, band: Any
    ) -> None:
        d.at_most(
            "preload_order",
            way.clamp_preload,
            way.return_preload,
            "N",
            text="The clamp springs do not push the plate onto the lining at rest: it would drag at idle",
            source=f"{NOT_IN_S4}; practice 1",
        )
        worn = two_spring.worn_contact_travel(way.contact_travel, way.return_rate, way.clamp_rate, wear)
        d.at_most(
            "stop_after_contact",
            worn,
            way.stop_travel,
            "mm",
            text="The tension disc reaches its stop only after the worn lining is in contact",
            source=NOT_IN_S4,
        )
        # Speeds of the same flyweights: mass and transmission cancel, and with them most of what blurs a bound.
        text = "The {} gradually: every further travel asks for a larger speed (speed before over speed after)"
        d.at_most(
            "no_snap_tension",
            centrifugal.speed_ratio(way.clamp_preload, rest, way.return_preload, at_start),
            1,
            "-",
            text=text.format("tension disc moves alone"),
            source=NOT_IN_S4,
        )
        d.at_most(
            "no_snap_plate",
            centrifugal.speed_ratio(way.return_preload, at_start, way.contact_force, at_contact),
            1,
            "-",
            text=text.format("plate moves"),
            source=NOT_IN_S4,
        )
        d.at_least(
            "no_snap_clamp",
            band,
            1,
            "-",
            text="The clamp force rises gradually: full clamp speed over contact speed",
            source=NOT_IN_S4,
        )
