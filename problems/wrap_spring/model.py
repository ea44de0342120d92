"""Wrap spring clutch with interference fit: a preloaded spring grips two hubs in one sense and slips in the other."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np

from synth import Design, DesignProblem
from synth.declaration import Block, Declaration, Requirement

from .. import practice
from ..components.lining import wear
from ..practice import UNSOURCED
from ..sources import DRIVE, NOT_IN_S2, S2, TYPICAL
from . import blocks, body, curves, formulas
from .layers import Fit, layers_of

if TYPE_CHECKING:
    from collections.abc import Mapping

    from synth.drawing import Drawing


MODEL_VALUE = f"{TYPICAL} of the reference model"
WEAR = "wear volume in proportion to friction work (Archard)"
OVERLOADS = ("slip_limited", "torque_limited")


class InterferenceDuty(blocks.Duty):
    """What the drive asks of a clutch with this fit."""

    interference_tolerance = replace(
        blocks.Duty.interference_tolerance, text="Tolerance of the interference, +- of wire, bore and hub together"
    )


class PracticeInterferenceDuty(InterferenceDuty, blocks.PracticeDuty):
    """What the drive asks of a clutch with this fit, by the rules of practice."""


class Wants(Block):
    """Requirements of the interference fit alone, all in SI; None where an optional one is not given."""

    group = "duty"

    service_factor = Requirement(
        "-",
        1.5,
        lower=1,
        upper=5,
        symbol="K_A",
        text="The wire must stand service factor times required torque again and again",
        source=MODEL_VALUE,
    )
    overrun_speed = Requirement(
        "1/min",
        0,
        lower=0,
        upper=60000,
        symbol="omega_over",
        text="Speed between spring and hub when overrunning",
        source=DRIVE,
    )
    overrun_duty = Requirement(
        "-", 1, lower=0, upper=1, symbol="duty", text="Part of the time spent overrunning", source=DRIVE
    )
    drag_torque_limit = Requirement(
        "N*m",
        lower=1e-4,
        upper=1e4,
        optional=True,
        symbol="drag_max",
        text="Largest drag when overrunning; a twentieth of required torque is usual",
        source=DRIVE,
    )
    hub_shear_limit = Requirement(
        "N/mm2",
        80,
        lower=1,
        upper=1000,
        symbol="tau_hub",
        text="Allowed shear stress of the hub",
        source=MODEL_VALUE,
        group="material",
    )
    interference_ratio_max = Requirement(
        "-",
        0.1,
        lower=0.005,
        upper=0.3,
        symbol="dr_rel_max",
        text="Largest interference, with its tolerance, over mean coil radius",
        source="small strains",
        group="practice",
    )
    liftoff_margin = Requirement(
        "-",
        0.7,
        lower=0.1,
        upper=1,
        symbol="k_lift",
        text="Largest spring speed over the speed at which the spring lifts off",
        source=MODEL_VALUE,
        group="model",
    )
    fatigue_safety = Requirement(
        "-", 1.2, lower=1, upper=4, symbol="S_F", text="Safety on Goodman's line", source=MODEL_VALUE, group="model"
    )
    heat_transfer = Requirement(
        "W/(m2*K)",
        25,
        lower=1,
        upper=1000,
        symbol="h_cool",
        text="Surface coefficient of the spring's outside",
        source=MODEL_VALUE,
        group="model",
    )
    temperature_rise_limit = Requirement(
        "K",
        60,
        lower=1,
        upper=1e9,
        symbol="dT_max",
        text="Allowed rise over ambient when overrunning",
        source=MODEL_VALUE,
        group="material",
    )

    @property
    def lubricated(self) -> bool:
        """True if dry friction pairs are left out."""
        return False


class PracticeWants(Wants):
    """Requirements of the interference fit by the rules of practice."""

    overrun_speed = replace(
        Wants.overrun_speed,
        default=None,
        lower=0.1,
        optional=True,
        text="Speed between spring and hub when overrunning; where it is given, the pair is in oil or greased",
    )
    overrun_duty = replace(Wants.overrun_duty, lower=1e-4)
    drag_torque_limit = replace(
        Wants.drag_torque_limit,
        optional=False,
        text=f"Largest drag when overrunning; by default a tenth of required torque ({UNSOURCED})",
        source=UNSOURCED,
    )
    interference_ratio_max = replace(
        Wants.interference_ratio_max,
        default=0.04,
        text="Largest interference, with its tolerance, over mean coil radius: the spring must be opened over its hub",
        source=f"tinyclutch.com, spring clutches: slightly smaller; {UNSOURCED}",
    )

    @property
    def lubricated(self) -> bool:
        """True if dry friction pairs are left out: where the clutch overruns."""
        return self.overrun_speed is not None


class Rules(body.SpringRules):
    """Rules for this fit, all in SI."""

    group = "practice"

    hub_wall_ratio = Requirement(
        "-",
        1.4,
        lower=1,
        upper=5,
        symbol="k_wall",
        text=f"Least diameter of a hub over its bore ({UNSOURCED})",
        source=UNSOURCED,
    )
    overrun_life_min = Requirement(
        "h",
        500,
        lower=0.01,
        upper=1e6,
        symbol="t_wear_min",
        text=f"Least time in service until overrunning has worn the hubs ({UNSOURCED})",
        source=UNSOURCED,
    )

    def limit(self, d: Declaration, built: blocks.Built) -> None:
        """Declare the limits that an engineer adds to this fit."""
        super().limit(d, built)
        wants: Wants = built.wants
        d.at_least(
            "hub_wall",
            built.coils.hub_diameter,
            self.hub_wall_ratio * built.duty.bore_diameter,
            "mm",
            text="The hub has a wall around its bore",
            source=UNSOURCED,
        )
        if wants.overrun_speed is None:
            return
        pair, needed = built.friction.part, (wear.DEPTH, wear.RATE)
        if pair.known.issuperset(needed):
            life = d.derive(
                "overrun_life",
                "h",
                formulas.overrun_life(
                    pair.wearable_depth,
                    pair.wear_rate,
                    pair.mu_max,
                    d.derived["overrun_pv"].sx,
                    wants.overrun_duty,
                ),
                symbol="t_wear",
                text="Time in service until overrunning has worn the hubs: highest friction, tightest fit",
                source=WEAR,
            )
        else:
            life = pair.optional(next(column for column in needed if column not in pair.known))
            wear.remark_no_wear(d, pair, "overrun_life is not told", needed)
        d.at_least("overrun_life", life, self.overrun_life_min, "h", text="The hubs last long enough", source=WEAR)


FIT = Fit("drag_torque", InterferenceDuty, PracticeInterferenceDuty, Wants, PracticeWants, Rules, body.BodyRequirements)
LAYERS = layers_of(FIT)


class WrapSpringClutch(DesignProblem):
    """Wrap spring clutch, interference fit; also a freewheel.

    Torque in one sense winds the spring down on both hubs (belt friction), in the other it loosens it and overruns.
    """

    name = "wrap_spring"
    title = "Wrap spring clutch, interference fit"
    sources = blocks.SOURCES
    understands = (*blocks.COMMON, "drag_torque_limit")

    def declare(self, d: Declaration) -> None:
        """Declare requirements, unknowns, limits and objectives."""
        layer_of = LAYERS[practice.declare_scope(d)]
        options = d.block(blocks.Options)
        overload = d.option(
            "overload",
            OVERLOADS,
            "slip_limited",
            symbol="pol",
            text="slip_limited: the wire sees peak torque or the largest slip torque, whichever is smaller; "
            "torque_limited: it sees peak torque",
            source=NOT_IN_S2,
            group="duty",
        )
        layer = layer_of(d)
        duty = layer.declare_duty(d)
        wants: Wants = layer.declare_wants(d, duty)
        interference = d.variable(
            "interference",
            "mm",
            0.005,
            10,
            symbol="dr",
            text="By how much the mean radius of the free coils is smaller than that of the fitted ones",
            source=f"{S2}, Delta r",
        )
        wire = blocks.declare_wire(d, options=options)
        coils = blocks.declare_coils(d, options=options, duty=duty, wire=wire)
        friction = blocks.declare_friction(d, duty=duty, coils=coils, lubricated=wants.lubricated)
        if wants.drag_torque_limit is not None:
            self._refuse_drag(d, duty=duty, wants=wants, friction=friction)

        self._declare_fit(d, duty=duty, wants=wants, coils=coils, interference=interference)
        low, high = self._fitted_moments(duty, wire, coils, interference)
        self._name_fit(d, duty=duty, wire=wire, coils=coils, interference=interference)
        text = "Bending moment of the loosest fit"
        d.step("least_moment", "N*m", low, symbol="M_lo", text=text, source=f"{S2}, eq. (4)")
        spinning = blocks.centrifugal_moment(duty, wire, coils)
        effective = low - spinning
        guards = coils.model.declare_grip(d, low, spinning)
        blocks.declare_closing(
            d, duty=duty, torque=formulas.closing_torque(effective, friction.exponent_low), needs=guards
        )
        self._declare_liftoff(d, duty=duty, wants=wants, wire=wire, coils=coils, low=low)
        load = self._declare_overload(d, duty=duty, overload=overload, friction=friction, high=high)
        bending = formulas.bending_stress(high, wire.width, wire.thickness)
        stress, pressure = blocks.declare_load(
            d,
            wire=wire,
            coils=coils,
            friction=friction,
            bending_stress=bending,
            moment=high,
            load=load,
            needs="interference_positive",
        )
        self._declare_fatigue(d, duty=duty, wants=wants, wire=wire, coils=coils, bending=bending, high=high)
        self._declare_hub(d, duty=duty, wants=wants, coils=coils, load=load)
        spring = blocks.spring_size(d, duty=duty, wire=wire, coils=coils)
        built = blocks.Built(duty, wants, wire, coils, friction, spring)
        blocks.declare_size(d, duty=duty, size=layer.size(built))
        drag = self._declare_drag(d, wants=wants, friction=friction, high=high)
        if wants.overrun_speed is not None:
            self._declare_overrun(d, built, high=high, drag=drag)
        layer.extend(d, built)
        self._declare_windup(d, built, low=low)
        self._declare_utilisation(d, built, stress=stress, pressure=pressure)
        self._declare_remarks(d, built, effective=effective, bending=bending, stress=stress)
        d.headline(
            "mass",
            "outer_diameter",
            "length",
            "wire_stress",
            "contact_pressure",
            "drag_torque",
            "temperature_rise",
            sized_by="closing_torque",
        )
        layer.declare_objectives(d, "stress_utilisation", "pressure_utilisation", "outer_diameter")
        if "overrun_life" in d.derived:
            d.objective("overrun_life", "max", default=False)

    def curves(self, spec: Mapping[str, Any], design: Design | None = None) -> dict[str, Any]:
        """Return torque over friction, interference and speed, wind-up, heat, and what happens along the coils."""
        if design is None:
            return {"over_belt_exponent": curves.over_belt_exponent(spec, spec["drag_torque_limit"])}
        return curves.interference_curves(curves.fitted(self, spec, design), spec, design.values)

    def drawing(self, spec: Mapping[str, Any], design: Design) -> Drawing:
        """Return the section through hubs and spring, and a detail of the coils."""
        from . import drawing as wrap_spring  # costly to import; searches do without

        return wrap_spring.interference_drawing(
            spec,
            design,
            scope=self.option("mass_scope"),
            seed=self.option("model") == "seed",
        )

    def _refuse_drag(self, d: Declaration, *, duty: blocks.Duty, wants: Wants, friction: blocks.Friction) -> None:
        """Refuse friction pairs whose range makes the drag limit unreachable, whatever spring and hub."""
        coils = blocks.COILS_RANGE[1]
        low = formulas.belt_exponent(friction.part.mu_min, coils, 1.0)
        high = formulas.belt_exponent(friction.part.mu_max, coils, 1.0)
        moment = duty.slip_safety * duty.required_torque / formulas.closing_torque(1.0, low)
        d.refuse(
            "drag_limit_unreachable",
            wants.drag_torque_limit < formulas.opening_torque(moment, high),
            f"a drag_torque_limit that can be reached with the friction range of the pair and {coils} coils per hub, "
            "at least slip_safety required_torque (1 - exp(-beta_max))/(exp(beta_min) - 1): raise it or choose a pair "
            "with more friction",
        )

    def _fitted_moments(
        self, duty: blocks.Duty, wire: blocks.Wire, coils: blocks.Coils, interference: Any
    ) -> tuple[Any, Any]:
        """Return the bending moments of the loosest and the tightest fit [N m]."""
        tolerance, mean = duty.interference_tolerance, coils.mean_radius
        loosest = interference - tolerance
        # The tightest fit is bounded by interference_range; what is built on it is known to be positive.
        small = coils.model.free_radius(interference + tolerance, mean)
        large = coils.model.loosened(small, 2 * tolerance)
        low = blocks.fitted_moment(wire, coils, loosest, large)
        return low, formulas.tightened_moment(low, loosest, 2 * tolerance, large, small)

    def _name_fit(
        self,
        d: Declaration,
        *,
        duty: blocks.Duty,
        wire: blocks.Wire,
        coils: blocks.Coils,
        interference: Any,
    ) -> None:
        """Name what the moments of the loosest and the tightest fit are made of."""
        tolerance, mean = duty.interference_tolerance, coils.mean_radius
        small = coils.model.free_radius(interference + tolerance, mean)
        large = coils.model.loosened(small, 2 * tolerance)
        loosest = interference - tolerance
        inside = coils.hub_diameter - 2 * interference
        curvature = formulas.curvature_change(loosest, mean, large)
        source = f"{S2}, Delta r; {NOT_IN_S2}"
        for name, unit, value, symbol, text in (
            ("least_interference", "mm", loosest, "dr_lo", "Interference of the loosest fit, dr - tol"),
            ("curvature_change", "1/m", curvature, "kappa", "Curvature change of the wire, loosest fit"),
            ("free_inside_diameter", "mm", inside, "d_free", "Inside of the free spring"),
        ):
            d.step(name, unit, value, symbol=symbol, text=text, source=source)
        text = "What the spinning wire carries of its bending moment itself"
        named = [
            ("least_free_radius", "mm", small, "r_free_lo", "Mean radius of the free spring, tightest fit"),
            ("greatest_free_radius", "mm", large, "r_free_hi", "Mean radius of the free spring, loosest fit"),
            ("centrifugal_moment", "N*m", blocks.centrifugal_moment(duty, wire, coils), "M_cf", text),
        ]
        coils.model.declare_steps(d, named, source)

    def _declare_fit(
        self, d: Declaration, *, duty: blocks.Duty, wants: Wants, coils: blocks.Coils, interference: Any
    ) -> None:
        d.at_least(
            "interference_positive",
            interference,
            duty.interference_tolerance,
            "mm",
            guard=True,
            text="The preload survives the tolerance",
            source=NOT_IN_S2,
        )
        most = interference + duty.interference_tolerance
        d.at_most(
            "interference_range",
            most / coils.mean_radius,
            wants.interference_ratio_max,
            "-",
            text="The strains stay small; interference with its tolerance over mean coil radius",
            source=f"{S2}, small Delta r",
        )
        d.advise(
            "no_free_radius",
            most >= coils.mean_radius,
            "the interference is not below the mean coil radius: there is no such spring, and its other figures mean "
            "nothing",
            source=S2,
        )

    def _declare_liftoff(
        self, d: Declaration, *, duty: blocks.Duty, wants: Wants, wire: blocks.Wire, coils: blocks.Coils, low: Any
    ) -> None:
        speed = d.derive(
            "liftoff_speed",
            "1/min",
            formulas.liftoff_speed(low, wire.density, wire.width, wire.thickness, coils.mean_radius),
            symbol="omega_lift",
            needs="interference_positive",
            text="Speed at which the loosest spring lifts off its hub",
            source=NOT_IN_S2,
        )
        d.at_most(
            "liftoff",
            duty.spring_speed,
            wants.liftoff_margin * speed,
            "1/min",
            text="The spring stays on its hub at spring speed, also with model seed, which counts torques at rest",
            source=NOT_IN_S2,
        )

    def _declare_overload(
        self, d: Declaration, *, duty: blocks.Duty, overload: str, friction: blocks.Friction, high: Any
    ) -> Any:
        """Declare the largest slip torque and return the torque that the wire sees."""
        slip = d.derive(
            "slip_torque",
            "N*m",
            formulas.closing_torque(high, friction.exponent_high),
            symbol="T_cap",
            text="Largest torque at which the closing clutch slips: highest friction, tightest fit, at rest",
            source=f"{S2}, eq. (18)-(20)",
        )
        limited = overload == "slip_limited"
        if limited:
            d.advise(
                "slips_below_peak",
                slip < duty.peak_torque,
                "the clutch always slips below peak torque: slip torque loads the wire, not the drive",
                source=NOT_IN_S2,
            )
        return d.derive(
            "wire_torque",
            "N*m",
            np.minimum(duty.peak_torque, slip) if limited else duty.peak_torque,
            symbol="T_load",
            text="Torque that the wire sees at overload",
            source=NOT_IN_S2,
        )

    def _declare_fatigue(
        self,
        d: Declaration,
        *,
        duty: blocks.Duty,
        wants: Wants,
        wire: blocks.Wire,
        coils: blocks.Coils,
        bending: Any,
        high: Any,
    ) -> None:
        def stress(torque: Any) -> Any:
            tension = formulas.wire_tension(high + torque, coils.mean_radius)
            return formulas.wire_stress(bending, tension, wire.width, wire.thickness)

        least, largest = stress(0.0), stress(wants.service_factor * duty.required_torque)
        text = "Stress of the wire without a torque"
        d.step("least_stress", "N/mm2", least, symbol="sigma_lo", text=text, source=f"{S2}, eq. (8)")
        text = "Stress of the wire under service factor times required torque"
        d.step("fatigue_stress", "N/mm2", largest, symbol="sigma_hi", text=text, source=f"{S2}, eq. (8)")
        used = d.derive(
            "fatigue_utilisation",
            "-",
            formulas.goodman_utilisation(
                wants.fatigue_safety,
                least,
                largest,
                wire.endurance_amplitude,
                wire.tensile_strength,
            ),
            symbol="u_F",
            text="Fatigue of the wire between no torque and service factor times required torque",
            source=f"Goodman; {NOT_IN_S2}",
        )
        d.at_most(
            "fatigue",
            used,
            1.0,
            "-",
            text="The wire does not tire",
            source=f"Goodman; {NOT_IN_S2}",
        )

    def _declare_hub(self, d: Declaration, *, duty: blocks.Duty, wants: Wants, coils: blocks.Coils, load: Any) -> None:
        d.at_least(
            "hub_bore",
            coils.hub_diameter,
            duty.bore_diameter,
            "mm",
            guard=True,
            text="The hub is thicker than its bore",
            source="geometry",
        )
        shear = d.derive(
            "hub_shear",
            "N/mm2",
            formulas.hub_shear_stress(load, coils.hub_diameter, duty.bore_diameter),
            symbol="tau",
            needs="hub_bore",
            text="Shear stress of the hub under wire torque",
            source="torsion of a tube",
        )
        d.at_most(
            "hub_shear",
            shear,
            wants.hub_shear_limit,
            "N/mm2",
            text="The hub does not twist off",
            source="torsion of a tube",
        )

    def _declare_drag(self, d: Declaration, *, wants: Wants, friction: blocks.Friction, high: Any) -> Any:
        """Declare the drag when overrunning with its limit, and return it [N m]."""
        drag = d.derive(
            "drag_torque",
            "N*m",
            formulas.opening_torque(high, friction.exponent_high),
            symbol="T_open",
            text="Drag when overrunning: highest friction, tightest fit",
            source=f"{S2}, eq. (15), (21)",
        )
        if wants.drag_torque_limit is not None:
            d.at_most(
                "drag_torque",
                drag,
                wants.drag_torque_limit,
                "N*m",
                text="The clutch overruns freely",
                source=f"{S2}, eq. (21)",
            )
        return drag

    def _declare_overrun(self, d: Declaration, built: blocks.Built, *, high: Any, drag: Any) -> None:
        wants, coils, spring = built.wants, built.coils, built.spring
        preload = formulas.contact_pressure(high, built.wire.width, coils.hub_radius, coils.mean_radius)
        rubbing = d.derive(
            "overrun_pv",
            "W/mm2",
            formulas.overrun_pv(preload, wants.overrun_speed, coils.hub_radius),
            symbol="pv",
            text="Pressure of the preload times sliding speed when overrunning",
            source=NOT_IN_S2,
        )
        d.at_most(
            "overrun_pv",
            rubbing,
            built.friction.part.pv_allow,
            "W/mm2",
            text="Wire and hub stand the rubbing",
            source=NOT_IN_S2,
        )
        rise = d.derive(
            "temperature_rise",
            "K",
            formulas.overrun_temperature_rise(
                drag, wants.overrun_speed, wants.overrun_duty, wants.heat_transfer, spring.diameter, spring.length
            ),
            symbol="dT",
            text="Steady rise over ambient when overrunning",
            source=f"lumped heat balance; {NOT_IN_S2}",
        )
        d.at_most(
            "overrun_temperature",
            rise,
            wants.temperature_rise_limit,
            "K",
            text="The clutch stays cool when overrunning",
            source=f"lumped heat balance; {NOT_IN_S2}",
        )

    def _declare_windup(self, d: Declaration, built: blocks.Built, *, low: Any) -> None:
        duty, wire, coils = built.duty, built.wire, built.coils
        slope = built.friction.part.mu_min * coils.radius_ratio
        stiffness = wire.modulus * wire.thickness * wire.width
        angle = formulas.windup_angle(duty.required_torque, low, slope, coils.mean_radius, stiffness, duty.gap_coils)
        for name, unit, value, symbol, text in (
            ("excess_tension", "N", duty.required_torque / coils.mean_radius, "N_T", "Tension that carries the torque"),
            (
                "slip_arc",
                "rad",
                formulas.slip_arc(duty.required_torque, low, slope),
                "alpha_s",
                "Arc over which the loaded wire slips",
            ),
        ):
            d.step(name, unit, value, symbol=symbol, text=text, source=NOT_IN_S2)
        d.derive(
            "windup_angle",
            "deg",
            angle,
            symbol="theta",
            needs="interference_positive",
            text="Angle between the hubs until required torque is carried: least friction, loosest fit, at rest",
            source=NOT_IN_S2,
        )

    def _declare_utilisation(self, d: Declaration, built: blocks.Built, *, stress: Any, pressure: Any) -> None:
        d.derive(
            "stress_utilisation",
            "-",
            stress / built.wire.bending_allow,
            symbol="u_s",
            text="wire stress over its limit",
            source=f"{S2}, eq. (8) and (18)",
        )
        d.derive(
            "pressure_utilisation",
            "-",
            pressure / built.friction.part.p_allow,
            symbol="u_p",
            text="contact pressure over its limit",
            source=f"{S2}, eq. (22), corrected",
        )

    def _declare_remarks(
        self, d: Declaration, built: blocks.Built, *, effective: Any, bending: Any, stress: Any
    ) -> None:
        wants, wire, coils, friction = built.wants, built.wire, built.coils, built.friction
        d.advise(
            "weak_belt",
            friction.exponent_low < 2,
            "at the least friction the belt exponent is below 2: the drag when overrunning is above some 15 % of the "
            "torque held",
            source=NOT_IN_S2,
        )
        factor = formulas.curved_bar_factor(2 * coils.mean_radius / wire.thickness)
        d.advise(
            "curved_wire",
            stress + (factor - 1) * bending > wire.bending_allow,
            "counting the curvature of the wire (Wahl's factor on bending) its inner fibre is above the allowed stress",
            source="Wahl, Mechanical Springs",
        )
        tips = formulas.belt_exponent(
            friction.part.mu_min, coils.per_hub - formulas.tip_coil_loss(), coils.radius_ratio
        )
        d.advise(
            "tip_lifts_off",
            formulas.closing_torque(effective, tips) < built.duty.required_torque,
            "the tip of a free end lifts off and about 0.05 coils there do not grip; counting that, the least closing "
            "torque is below required torque: raise slip safety",
            source=NOT_IN_S2,
        )
        if wants.overrun_speed is not None:
            d.advise(
                "overrun_sliding_speed",
                wants.overrun_speed * coils.hub_radius > friction.part.optional("v_allow"),
                "the sliding speed when overrunning is above what the friction pair stands",
                source="table friction_materials, allowed speed",
            )
