"""Motion of the levers of centrifugal clutches over the speed: every force and position in every regime, as numbers.

The lever angle, not the speed, is the parameter of a motion: force and radius belong to an angle, and the speed follows
from them. So a lever that snaps is drawn as it is: its speed falls while it swings out, and what lies between is passed
in a jump.

Source: S4 (notes on centrifugal clutches), figures 2-24 to 2-26; the relations are derived, see
:mod:`synth.problems.mechanics.centrifugal_levers`.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from . import Quantity, centrifugal
from . import centrifugal_levers as levers

__all__ = ["CLAMP", "CONTACT", "REST", "STOP", "TRAVEL", "Borders", "Motion", "ReversedLever", "RodLever"]

REST, TRAVEL, CONTACT, CLAMP, STOP = range(5)
_ROUNDING = 1e-12


@dataclass(frozen=True)
class Borders:
    """Speeds at which one regime gives way to the next [rad/s], and the centrifugal forces there [N].

    Of ``speeds`` and ``forces``: the lever starts, the plate meets the disc, the rod goes slack (disc 1 lifts), the
    lever stops.
    """

    speeds: tuple[float, float, float, float]
    forces: tuple[float, float, float, float]

    @property
    def snaps(self) -> bool:
        """Whether the lever jumps through a phase."""
        start, contact, free, stop = self.speeds
        return start > contact * (1 + _ROUNDING) or free > stop * (1 + _ROUNDING)


@dataclass(frozen=True)
class Motion:
    """A lever from standstill to the top speed: arrays of one length, in SI.

    ``link_force`` is that in the rod, or that of disc 1 on the housing. ``rest_force`` and ``stop_force`` act at the
    arm of the flyweights. ``return_force`` and ``lift`` (of disc 1) are those of a reversed lever, else 0.
    """

    regime: Quantity
    speed: Quantity
    angle: Quantity
    radius: Quantity
    flyweight_force: Quantity
    spring_force: Quantity
    link_force: Quantity
    return_force: Quantity
    clamp_force: Quantity
    gap: Quantity
    lift: Quantity
    rest_force: Quantity
    stop_force: Quantity


@dataclass(frozen=True)
class _Lever:
    """What both levers have: flyweights, the gap to close, and a stop."""

    mass: float
    rest_radius: float
    flyweight_arm: float
    preload: float
    rate: float
    contact_travel: float
    stop_angle: float

    @property
    def plate_arm(self) -> float:
        """Arm that moves the plate [m]."""
        raise NotImplementedError

    def travel_force(self, angle: Quantity) -> Quantity:
        """Return F_C that holds the lever while the plate travels [N]."""
        raise NotImplementedError

    def clamp_force(self, angle: Quantity) -> Quantity:
        """Return F_C that holds the lever while the springs clamp [N]."""
        raise NotImplementedError

    @property
    def contact_angle(self) -> float:
        """Lever angle at contact [rad]."""
        return float(levers.contact_angle(self.contact_travel, self.plate_arm))

    def radius(self, angle: Quantity) -> Quantity:
        """Return the radius of the flyweights at an angle [m]."""
        return centrifugal.orbit_radius(self.rest_radius, self.flyweight_arm, angle)

    def borders(self) -> Borders:
        """Return speeds and centrifugal forces at the borders of the regimes."""
        contact = self.contact_angle
        forces = (
            float(self.travel_force(0.0)),
            float(self.travel_force(contact)),
            float(self.clamp_force(contact)),
            float(self.clamp_force(self.stop_angle)),
        )
        radii = (self.rest_radius, self.radius(contact), self.radius(contact), self.radius(self.stop_angle))
        start, meets, free, stop = (
            float(centrifugal.speed_for_force(force, self.mass, radius))
            for force, radius in zip(forces, radii, strict=True)
        )
        return Borders((start, meets, free, stop), forces)

    def _steps(self, top_speed: float, points: int) -> tuple[Quantity, Quantity, Quantity]:
        """Return regime, angle and F_C from standstill to a top speed, or to the stop where that is faster."""
        borders, contact = self.borders(), self.contact_angle
        share = np.linspace(0.0, 1.0, points)
        travelling, clamping = contact * share, contact + (self.stop_angle - contact) * share
        first, last = (
            borders.speeds[0] * share,
            np.linspace(borders.speeds[3], max(top_speed, borders.speeds[3]), points),
        )
        angles = (0.0 * share, travelling, np.full(points, contact), clamping, np.full(points, self.stop_angle))
        forces = (
            centrifugal.centrifugal_force(self.mass, self.rest_radius, first),
            self.travel_force(travelling),
            borders.forces[1] + (borders.forces[2] - borders.forces[1]) * share,
            self.clamp_force(clamping),
            centrifugal.centrifugal_force(self.mass, self.radius(self.stop_angle), last),
        )
        return np.repeat(np.arange(5), points), np.concatenate(angles), np.concatenate(forces)

    def _motion(self, steps: tuple[Quantity, Quantity, Quantity], **own: Quantity) -> Motion:
        """Return a motion from its steps and the forces that this lever has of its own."""
        regime, angle, force = steps
        borders, radius = self.borders(), self.radius(angle)
        return Motion(
            regime=regime,
            speed=centrifugal.speed_for_force(force, self.mass, radius),
            angle=angle,
            radius=radius,
            flyweight_force=force,
            gap=np.maximum(self.contact_travel - self.plate_arm * angle, 0.0),
            rest_force=np.where(regime == REST, borders.forces[0] - force, 0.0),
            stop_force=np.where(regime == STOP, force - borders.forces[3], 0.0),
            **own,
        )


@dataclass(frozen=True)
class RodLever(_Lever):
    """A lever with a headed rod, all in SI; mass, preload and rate are totals.

    Parameters
    ----------
    mass, rest_radius, flyweight_arm : float
        m [kg], r0 [m] and l_c [m].
    preload, rate : float
        F_R0 [N] and s [N/m] of the clamp springs.
    contact_travel : float
        Gap at rest x0 [m], with the wear of the lining where it is worn.
    stop_angle : float
        phi_max [rad], beyond contact.
    spring_arm, rod_arm : float
        l_s and l_r [m].
    """

    spring_arm: float
    rod_arm: float

    @property
    def plate_arm(self) -> float:
        """Arm that moves the plate, l_r [m]."""
        return self.rod_arm

    def travel_force(self, angle: Quantity) -> Quantity:
        """Return F_C that holds the lever while the rod is taut [N]."""
        spring = levers.travel_spring_force(self.preload, self.rate, self.spring_arm, self.rod_arm, angle)
        return levers.travel_flyweight_force(spring, self.spring_arm, self.rod_arm, self.flyweight_arm)

    def clamp_force(self, angle: Quantity) -> Quantity:
        """Return F_C that holds the lever while the rod is slack [N]."""
        spring = levers.clamp_spring_force(self.preload, self.rate, self.spring_arm, self.contact_travel, angle)
        return levers.clamp_flyweight_force(spring, self.spring_arm, self.flyweight_arm)

    def motion(self, top_speed: float, points: int = 61) -> Motion:
        """Return the lever from standstill to a top speed.

        Parameters
        ----------
        top_speed : float
            Last speed [rad/s]; the stop speed where that is higher.
        points : int
            Points of every regime.

        Returns
        -------
        Motion
            All regimes in order of the lever angle.

        Examples
        --------
        Practice 3 of S4 with its assumed arms, largest clamp force:

        >>> lever = RodLever(1.0, 0.152, 0.1, 1200.0, 1e5, 0.01, 0.3, 0.1, 0.05)
        >>> float(lever.motion(150.0).clamp_force.max())
        3200.0
        """
        return self.along(self._steps(top_speed, points))

    def along(self, steps: tuple[Quantity, Quantity, Quantity]) -> Motion:
        """Return the lever at some steps of its motion: regimes, angles and centrifugal forces [N]."""
        regime, angle, force = steps
        travelling = levers.travel_spring_force(self.preload, self.rate, self.spring_arm, self.rod_arm, angle)
        clamping = levers.clamp_spring_force(self.preload, self.rate, self.spring_arm, self.contact_travel, angle)
        spring = np.where(regime <= TRAVEL, travelling, clamping)
        unloading = levers.rod_force(force, spring, self.spring_arm, self.rod_arm, self.flyweight_arm)
        rod = np.where(regime <= TRAVEL, spring, np.where(regime == CONTACT, unloading, 0.0))
        nothing = np.zeros_like(angle)
        return self._motion(
            steps, spring_force=spring, link_force=rod, clamp_force=spring - rod, return_force=nothing, lift=nothing
        )


@dataclass(frozen=True)
class ReversedLever(_Lever):
    """A reversed lever, all in SI; mass, preloads and rates are totals.

    Parameters
    ----------
    mass, rest_radius, flyweight_arm : float
        m [kg], r0 [m] and l_c [m].
    preload, rate : float
        F_R0 [N] and s [N/m] of the clamp springs behind disc 1.
    contact_travel : float
        Gap at rest x0 [m], with the wear of the lining where it is worn.
    stop_angle : float
        phi_max [rad], beyond contact.
    short_leg : float
        l_p [m].
    return_preload, return_rate : float
        F_ret0 [N] and s_ret [N/m] of the springs that draw the plate back.
    """

    short_leg: float
    return_preload: float
    return_rate: float

    @property
    def plate_arm(self) -> float:
        """Arm that moves the plate, l_p [m]."""
        return self.short_leg

    def travel_force(self, angle: Quantity) -> Quantity:
        """Return F_C that holds the lever against the return springs [N]."""
        back = levers.return_force(self.return_preload, self.return_rate, self.short_leg * angle)
        return levers.clamp_flyweight_force(back, self.short_leg, self.flyweight_arm)

    def clamp_force(self, angle: Quantity) -> Quantity:
        """Return F_C that holds disc 1 off the housing [N]."""
        spring = levers.clamp_spring_force(self.preload, self.rate, self.short_leg, self.contact_travel, angle)
        return levers.clamp_flyweight_force(spring, self.short_leg, self.flyweight_arm)

    def motion(self, top_speed: float, points: int = 61) -> Motion:
        """Return the lever from standstill to a top speed.

        Parameters
        ----------
        top_speed : float
            Last speed [rad/s]; the stop speed where that is higher.
        points : int
            Points of every regime.

        Returns
        -------
        Motion
            All regimes in order of the lever angle.

        Examples
        --------
        Computed here; the springs give 2000 N at the stop, the return springs take 300 N of it:

        >>> lever = ReversedLever(0.8, 0.08, 0.06, 1500.0, 1e5, 0.003, 0.32, 0.025, 210.0, 3e4)
        >>> float(lever.motion(400.0).clamp_force.max())
        1700.0
        """
        return self.along(self._steps(top_speed, points))

    def along(self, steps: tuple[Quantity, Quantity, Quantity]) -> Motion:
        """Return the lever at some steps of its motion: regimes, angles and centrifugal forces [N]."""
        regime, angle, force = steps
        travel = np.minimum(self.short_leg * angle, self.contact_travel)
        back = levers.return_force(self.return_preload, self.return_rate, travel)
        clamping = levers.clamp_spring_force(self.preload, self.rate, self.short_leg, self.contact_travel, angle)
        spring = np.where(regime >= CLAMP, clamping, self.preload)
        # At rest the plate leans on the leg; at the stop the window carries what the springs do not.
        pushing = levers.plate_force(force, self.flyweight_arm, self.short_leg)
        push = np.where(regime == REST, back, np.where(regime == STOP, clamping, pushing))
        return self._motion(
            steps,
            spring_force=spring,
            link_force=np.where(regime >= CLAMP, 0.0, spring - push),
            clamp_force=np.where(regime >= CONTACT, push - back, 0.0),
            return_force=back,
            lift=np.where(regime >= CLAMP, self.short_leg * angle - self.contact_travel, 0.0),
        )
