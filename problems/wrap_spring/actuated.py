"""Wrap spring clutch with clearance fit: an energising torque on the free end closes the spring on its hub."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Any

from synth import Design, DesignProblem
from synth.declaration import Block, Declaration, Requirement, Variable

from .. import practice
from ..components.wrap_spring import body, formulas, requirements
from ..components.wrap_spring.model import Built, Size, WrapSpring, declare_spring
from ..duty import coverage, of_drive
from ..practice import UNSOURCED
from ..sources import DRIVE, NOT_IN_S2, TYPICAL
from . import curves
from .layers import Fit, declare_size, layers_of

if TYPE_CHECKING:
    from collections.abc import Mapping

    from synth.drawing import Drawing


class Sizes(Block):
    """What the search decides of the fit."""

    clearance = Variable(
        "mm",
        0.005,
        5,
        symbol="c",
        text="By how much the mean radius of the free coils is larger than that of the closed ones",
        source=NOT_IN_S2,
    )
    actuator_torque = Variable(
        "N*m", 1e-4, 1e4, symbol="T0", text="Energising torque at the free end of the spring", source=NOT_IN_S2
    )


class ClearanceDuty(requirements.Duty):
    """What the drive asks of a clutch with this fit."""

    interference_tolerance = replace(
        requirements.Duty.interference_tolerance, text="Tolerance of the clearance, +- of wire, bore and hub together"
    )


class PracticeClearanceDuty(ClearanceDuty, requirements.PracticeDuty):
    """What the drive asks of a clutch with this fit, by the rules of practice."""


class Wants(Block):
    """Requirements of the clearance fit alone, all in SI; None where an optional one is not given."""

    group = "model"

    clearance_min = Requirement(
        "mm",
        0.05,
        lower=0.001,
        upper=5,
        symbol="c_r",
        text=f"Least clearance that must be left after tolerance, run-out and heat ({TYPICAL})",
        source=TYPICAL,
    )
    relative_speed = Requirement(
        "1/min",
        lower=0.1,
        upper=60000,
        symbol="omega_rel",
        text="Speed between the hub and the held free end; gives engagement time only",
        source=DRIVE,
        group="duty",
    )
    actuator_torque_limit = of_drive("N*m", 1e-4, 1e4, "T0_max", "Largest energising torque", group="actuator")
    wrap_angle_limit = of_drive(
        "rad", 0.01, 50, "phi_max", "Largest angle until the coils are closed; 3 rad is usual", group="duty"
    )
    fixed_coils = Requirement(
        "-",
        1,
        lower=0.5,
        upper=10,
        symbol="n_fix",
        text=f"Coils anchored on the second hub ({TYPICAL})",
        source=TYPICAL,
    )
    hub_wall_min = Requirement(
        "mm",
        3,
        lower=0.2,
        upper=100,
        symbol="t_hub",
        text=f"Least wall of the hub around its bore ({TYPICAL})",
        source=TYPICAL,
    )


class PracticeWants(Wants):
    """Requirements of the clearance fit by the rules of practice."""

    actuator_torque_limit = replace(
        Wants.actuator_torque_limit,
        optional=False,
        text=f"Largest energising torque; by default a tenth of required torque ({UNSOURCED})",
        source=UNSOURCED,
    )


class CollarRequirements(body.BodyRequirements):
    """Shaft, bosses and control collar of a complete clutch, all in SI."""

    group = "practice"
    parts = 4  # hubs, spring and collar

    collar_wall = Requirement(
        "mm",
        3,
        lower=0.2,
        upper=50,
        symbol="t_col",
        text=f"Wall of the control collar around the spring ({UNSOURCED})",
        source=UNSOURCED,
    )

    def collar_mass(self, built: Built) -> Any:
        """Return the mass of the control collar [kg]."""
        density, spring = built.spring.duty.hub_density, built.size
        return formulas.collar_mass(density, spring.diameter, built.clearance, self.collar_wall, spring.length)

    def complete_size(self, built: Built) -> Size:
        """Return the size of the clutch with its bosses and the collar around the spring."""
        size = super().complete_size(built)
        return replace(
            size,
            mass=size.mass + self.collar_mass(built),
            diameter=formulas.collar_diameter(built.size.diameter, built.clearance, self.collar_wall),
            outside="Outside of the collar",
        )

    def declare(self, d: Declaration, built: Built) -> None:
        """Declare the complete clutch and its collar."""
        super().declare(d, built)
        mass, text = self.collar_mass(built), "Control collar around the spring"
        d.derive("collar_mass", "kg", mass, symbol="m_col", text=text, source="geometry")
        inside = built.size.diameter
        for name, value, symbol, text in (
            ("spring_diameter", inside, "D_sp", "Outside of the closed coils"),
            ("collar_bore", inside + 4 * built.clearance, "d_col", "Inside of the control collar"),
        ):
            d.step(name, "mm", value, symbol=symbol, text=text, source="geometry")


class Rules(body.SpringRules):
    """Rules for this fit, all in SI."""

    group = "practice"

    tang_length_ratio = Requirement(
        "-",
        2,
        lower=0.01,
        upper=20,
        symbol="k_tang",
        text=f"Length of the tang, at whose end it is held, over the width of the wire ({UNSOURCED})",
        source=UNSOURCED,
    )

    def limit(self, d: Declaration, built: Built) -> None:
        """Declare the limits that an engineer adds to this fit."""
        super().limit(d, built)
        actuator, spring = d.variables["actuator_torque"].sx, built.spring
        source = f"bending of a cantilever; {NOT_IN_S2}"
        stress = d.derive(
            "tang_stress",
            "N/mm2",
            formulas.tang_stress(actuator, spring.mean_radius, spring.wire.thickness, self.tang_length_ratio),
            symbol="sigma_t",
            text="Bending stress of the tang under the energising torque",
            source=source,
        )
        text = "The tang that holds the free end does not yield"
        d.at_most("tang", stress, spring.wire.bending_allow, "N/mm2", text=text, source=source)


FIT = Fit("actuator_torque", ClearanceDuty, PracticeClearanceDuty, Wants, PracticeWants, Rules, CollarRequirements)
LAYERS = layers_of(FIT)


class ActuatedWrapSpringClutch(DesignProblem):
    """Wrap spring clutch, clearance fit, engaged by a torque on the free end of the spring (tang, control collar).

    One end is anchored on the second hub; released, the coils stand clear of the first.
    """

    name = "wrap_spring_actuated"
    title = "Wrap spring clutch, clearance fit"
    sources = requirements.SOURCES
    understands = requirements.COMMON
    declines, disregards, as_limits = coverage.ACTUATED, coverage.NO_HEAT, coverage.ENVELOPE

    def declare(self, d: Declaration) -> None:
        """Declare requirements, unknowns, limits and objectives."""
        layer_of = LAYERS[practice.declare_scope(d)]
        options = d.block(requirements.Options)
        layer = layer_of(d)
        duty = layer.declare_duty(d)
        wants: Wants = layer.declare_wants(d, duty)
        sizes = d.block(Sizes)
        clearance, actuator = sizes.clearance, sizes.actuator_torque
        spring = declare_spring(d, options=options, duty=duty, pairs=layer.pairs(d, wants))
        loose, tight, effective = self._declare_moments(d, spring, clearance)
        text = "The energising torque closes the widest clearance; otherwise nothing grips"
        d.at_least("grip", actuator, -effective, "N*m", guard=True, text=text, source=NOT_IN_S2)
        held = formulas.closing_torque(effective, spring.exponent_low, actuator)
        spring.declare_closing(d, held, needs="grip")
        narrowest, text = clearance - duty.interference_tolerance, "Released, the coils stand clear of the hub"
        d.at_least("clearance_kept", narrowest, wants.clearance_min, "mm", text=text, source=NOT_IN_S2)
        text = "Torque that the wire sees at overload: peak torque"
        load = d.derive("wire_torque", "N*m", duty.peak_torque, symbol="T_load", text=text, source=NOT_IN_S2)
        bending = spring.bending_stress(-loose)
        stress, _ = spring.declare_load(d, bending_stress=bending, moment=tight, load=load)
        self._declare_actuation(d, spring, wants, widest=clearance + duty.interference_tolerance, actuator=actuator)
        least, text = duty.bore_diameter + 2 * wants.hub_wall_min, "The hub has a wall around its bore"
        d.at_least("hub_bore", spring.hub_diameter, least, "mm", text=text, source="geometry")
        built = Built(spring, wants, spring.declare_size(d, fixed_coils=wants.fixed_coils), clearance)
        declare_size(d, layer.size(built), duty)
        layer.extend(d, built)
        self._remark_on_fatigue(d, spring, stress)
        d.headline(
            "mass",
            "outer_diameter",
            "length",
            "wire_stress",
            "contact_pressure",
            "actuator_torque",
            "wrap_angle",
            sized_by="closing_torque",
        )
        layer.declare_objectives(d, "wrap_angle", "outer_diameter")

    def curves(self, spec: Mapping[str, Any], design: Design | None = None) -> dict[str, Any]:
        """Return torque over friction and energising torque, actuation over clearance, and what the coils feel."""
        if design is None:
            return {"over_belt_exponent": curves.actuator_over_belt_exponent(spec)}
        return curves.clearance_curves(curves.fitted(self, spec, design), spec, design.values)

    def drawing(self, spec: Mapping[str, Any], design: Design) -> Drawing:
        """Return the section through hubs, spring and collar, engaged, and a detail of the coils."""
        from . import drawing as wrap_spring  # costly to import; searches do without

        return wrap_spring.clearance_drawing(
            spec, design, scope=self.option("mass_scope"), seed=self.option("model") == "seed"
        )

    def _remark_on_fatigue(self, d: Declaration, spring: WrapSpring, stress: Any) -> None:
        stands = spring.wire.endurance_amplitude, spring.wire.tensile_strength
        d.advise(
            "fatigue_of_the_wire",
            formulas.goodman_utilisation(1.0, 0.0, stress, *stands) > 1,
            "engaged again and again up to wire torque the wire tires: its stress swings between 0 and wire stress and "
            "lies above Goodman's line",
            source=f"Goodman; {NOT_IN_S2}",
        )

    def _declare_moments(self, d: Declaration, spring: WrapSpring, clearance: Any) -> tuple[Any, Any, Any]:
        """Bending moments of the widest and the narrowest clearance, and the first as it grips at speed [N m]."""
        tolerance, model, mean = spring.duty.interference_tolerance, spring.model, spring.mean_radius
        widest, narrowest = clearance + tolerance, clearance - tolerance
        loose, tight = (spring.fitted_moment(-fit, model.free_radius(-fit, mean)) for fit in (widest, narrowest))
        spinning = spring.centrifugal_moment()
        text, source = "Clearance at its widest, c + tol", NOT_IN_S2
        d.step("greatest_clearance", "mm", widest, symbol="c_hi", text=text, source=source)
        text = "Bending moment that closes the widest clearance"
        d.step("closing_moment", "N*m", -loose, symbol="M_close", text=text, source=source)
        free, text = model.free_radius(-widest, mean), "Mean radius of the free spring, widest clearance"
        named = [
            ("greatest_free_radius", "mm", free, "r_free_hi", text),
            ("centrifugal_moment", "N*m", spinning, "M_cf", "What the spinning wire adds to that moment"),
        ]
        model.declare_steps(d, named, source)
        return loose, tight, loose - spinning

    def _declare_actuation(
        self, d: Declaration, spring: WrapSpring, wants: Wants, *, widest: Any, actuator: Any
    ) -> None:
        closing = spring.per_hub + spring.duty.gap_coils
        angle, text = formulas.wrap_angle(closing, widest, spring.mean_radius), "Angle until the coils are closed"
        text += ", at the widest clearance"
        angle = d.derive("wrap_angle", "rad", angle, symbol="phi", text=text, source=NOT_IN_S2)
        time, text = angle / wants.relative_speed, "Time until the coils are closed when the free end is held"
        d.derive("engagement_time", "s", time, symbol="t_e", text=text, source=NOT_IN_S2)
        torque = "The actuator can apply the energising torque"
        for name, unit, value, most, text in (
            ("wrap_angle", "rad", angle, wants.wrap_angle_limit, "The clutch closes soon enough"),
            ("actuator_torque", "N*m", actuator, wants.actuator_torque_limit, torque),
        ):
            if most is not None:
                d.at_most(name, value, most, unit, text=text, source=DRIVE)
