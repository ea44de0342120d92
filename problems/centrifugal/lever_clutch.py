"""What the centrifugal clutches with levers are: the declaration that they share, drawing, curves and state."""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, ClassVar

from synth import Design, DesignProblem
from synth.declaration import Declaration

from .. import centrifugal as blocks
from .. import practice
from ..components.springs import model as spring_sets
from ..duty import coverage
from ..mechanics import centrifugal_levers as formulas
from ..sources import NOT_IN_S4
from . import curves as centrifugal_curves
from . import lever_curves
from . import levers as lever_blocks
from . import state as states
from .layers import LAYERS, Sources
from .levers import LOADED, RECONSTRUCTED

if TYPE_CHECKING:
    from collections.abc import Mapping

    import pandas as pd

    from synth.drawing import Drawing

JUMPS = "shown is the rest radius below which it would jump"


@dataclass(frozen=True)
class Legs(ABC):
    """Short and long leg of a lever, the springs at them, and what is called how.

    Attributes
    ----------
    short, long : symbol
        Arm that moves the plate, and arm of the clamp springs, the longest below the flyweights [m].
    short_name, long_name : str
        Of both arms.
    longest : float
        Upper bound of the short leg [mm].
    ratio_max : symbol
        Largest short leg over long one.
    clamping : SpringSet
        Clamp springs.
    back : Fitted or None
        Return springs, where there are some.
    """

    short: Any
    long: Any
    short_name: str
    long_name: str
    longest: float
    ratio_max: Any
    clamping: spring_sets.SpringSet
    back: spring_sets.Fitted | None

    def guard(self, d: Declaration, lever: lever_blocks.Lever) -> None:
        """Declare the guards without which nothing clamps."""
        lever_blocks.require_loaded_springs(d, lever=lever, squeeze=self.long * lever.stop_angle)

    @abstractmethod
    def engage(self, d: Declaration, lever: lever_blocks.Lever, push: Any) -> Engagement:
        """Name what the speeds are made of, with the push of the clamp springs at the stop [N]; speeds and forces."""

    @abstractmethod
    def limit_return(self, d: Declaration, lever: lever_blocks.Lever) -> None:
        """Declare that springs draw the plate back."""


@dataclass(frozen=True)
class Engagement:
    """Speeds at contact and at the stop [rad/s], their ratio, forces [N], and guards of contact and of the ratio.

    ``clamp`` is the clamp force with new linings, ``worn`` that with worn ones, ``start_pull`` the pull of the
    flyweights as they leave their rest; ``jump_radius`` the rest radius below which it would jump to contact [m].
    """

    contact: Any
    stop: Any
    band: Any
    clamp: Any
    worn: Any
    start_pull: Any
    jump_radius: Any
    contact_needs: tuple[str, ...]
    band_needs: tuple[str, ...]


class LeverClutch(DesignProblem):
    """Centrifugal clutch with levers; families say of which kind they are."""

    kind: ClassVar[lever_curves.LeverKind]
    stop_text: ClassVar[str]  # what the stop is
    steps_text: ClassVar[str]  # how it clamps step by step
    pushed: ClassVar[str]
    arms: ClassVar[tuple[tuple[str, str], ...]]  # that are drawn: name, and name of the way of the end
    discs: ClassVar[int] = 0  # plates beside flywheel and pressure plate
    sources = blocks.SOURCES
    understands = (*blocks.COMMON, "lining_wear", "contact_travel")
    declines, disregards, as_limits = coverage.AT_SPEED, coverage.NO_HOURS, coverage.AT_CONTACT
    operating_point = states.OPERATING_POINT

    @abstractmethod
    def declare_legs(self, d: Declaration, lever: lever_blocks.Lever) -> Legs:
        """Declare legs and springs."""

    def declare(self, d: Declaration) -> None:
        """Declare requirements, unknowns, limits and objectives."""
        layer = LAYERS[practice.declare_scope(d)](d, blocks.LeverRules)
        duty = layer.duty
        lever = lever_blocks.declare_lever(d, duty=duty, stop_text=self.stop_text)
        legs = self.declare_legs(d, lever)
        lining = blocks.declare_lining(d, duty=duty, linings=layer.linings(d))
        lever_blocks.limit_contact(d, lever=lever, plate_arm=legs.short, longest=legs.longest, name=legs.short_name)
        least = lever.worn_travel / (legs.ratio_max * lever.weights.angle_limit)
        lever_blocks.refuse_room(d, duty=duty, least_leg=least, name=legs.long_name)
        lift = legs.long * lever.stop_angle - lever.contact_travel
        clamping = spring_sets.Fitted(legs.clamping, lever.deflection, lift)
        push = legs.clamping.force(clamping.most)
        legs.guard(d, lever)
        engaged = legs.engage(d, lever, push)
        self._declare_speeds(d, layer, lining, lever, legs, engaged)
        text = "Clamp force from full clamp speed on, with new linings"
        blocks.declare_clamp(d, lining=lining, force=engaged.clamp, text=text, source=RECONSTRUCTED)
        legs.limit_return(d, lever)
        fitted = _limit_springs(d, clamping, legs.back)
        blocks.limit_weight_room(
            d, duty=duty, weights=lever.weights, rest_radius=lever.rest_radius, pivot_arm=legs.long
        )
        layer.declare_size(d, lever_blocks.built(lining, lever, [one.springs for one in fitted], self.discs))
        for one, prefix in zip(fitted, ("", "return_"), strict=False):
            layer.limit_set(d, one, prefix)
        stop_pull = formulas.clamp_flyweight_force(push, legs.long, lever.weights.arm)
        stop_force = lever_blocks.advise_lever(
            d, duty=duty, lining=lining, lever=lever, start_pull=engaged.start_pull, stop_pull=stop_pull
        )
        layer.judge_stop(d, stop_force=stop_force, clamp_force=engaged.clamp)
        for one in fitted:
            layer.advise_springs(d, one, radius=lever.rest_radius)
        layer.declare_objectives(d)

    def _declare_speeds(
        self,
        d: Declaration,
        layer: Sources,
        lining: blocks.Lining,
        lever: lever_blocks.Lever,
        legs: Legs,
        engaged: Engagement,
    ) -> None:
        """Declare the speeds, and that no phase of the motion snaps."""
        duty = layer.duty
        blocks.declare_contact(d, duty=duty, contact=engaged.contact, needs=engaged.contact_needs)
        blocks.declare_full_clamp(
            d,
            duty=duty,
            lining=lining,
            worn_force=engaged.worn,
            full_clamp_speed=engaged.stop,
            source=RECONSTRUCTED,
            needs=LOADED,
        )
        text = "Full-clamp speed over contact speed; a small one is sharp"
        blocks.declare_band(d, band=engaged.band, text=text, needs=engaged.band_needs)
        reach = lever.deflection - lever.contact_travel
        travels = "The lever travels to contact step by step: it starts at a lower speed than it touches at"
        for name, radius, text in (
            ("no_snap_travel", engaged.jump_radius, travels),
            ("no_snap_clamp", formulas.gradual_radius(reach, lever.weights.arm, legs.long), self.steps_text),
        ):
            d.at_most(name, radius, lever.rest_radius, "mm", text=f"{text}; {JUMPS}", source=NOT_IN_S4)

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

        arms = [lever_drawing.Leg(*arm) for arm in self.arms]
        back = [return_spring("contact_travel")] if "return_spring" in design.parts else []
        return lever_drawing.lever_drawing(spec, design, arms=arms, pushed=self.pushed, springs=[CLAMP, *back])

    def curves(self, spec: Mapping[str, Any], design: Design | None = None) -> dict[str, Any]:
        """Return clamp force over lining; of a design what happens over the speed, with new and with worn linings.

        Parameters
        ----------
        spec : mapping
            Requirements in SI by name, None where an optional one is not given.
        design : Design, optional
            The design to draw.

        Returns
        -------
        dict of str to DataFrame
            ``clamp_force_over_lining``, or of a design ``over_speed`` and ``over_speed_worn``.
        """
        if design is None:
            return {"clamp_force_over_lining": centrifugal_curves.clamp_force_over_lining(self, spec)}
        return lever_curves.over_speed(self, spec, design, self.kind)

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
        return states.of_lever(spec, design, self.kind, point["speed"])


def _limit_springs(
    d: Declaration, clamping: spring_sets.Fitted, back: spring_sets.Fitted | None
) -> list[spring_sets.Fitted]:
    """Declare the limits of clamp and return springs, and name their lengths; the sets that there are."""
    text = "The clamp springs stand the stop"
    spring_sets.limit_spring_force(d, clamping, name="spring_force", text=text)
    fitted = [clamping]
    if back is not None:
        text = "The return springs stand the travel to contact"
        spring_sets.limit_spring_force(d, back, name="return_spring_force", text=text)
        fitted.append(back)
    for one in fitted:
        spring_sets.name_spring_lengths(d, one)
    return fitted
