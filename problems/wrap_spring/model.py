"""Wrap spring clutch with interference fit: a preloaded spring grips two hubs in one sense and slips in the other."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np

from synth import Design, DesignProblem
from synth.declaration import Block, Declaration, Option, Requirement, Variable

from .. import practice
from ..components.lining import wear
from ..components.wrap_spring import body, formulas, requirements
from ..components.wrap_spring.model import Built, WrapSpring, declare_spring
from ..duty import coverage, of_drive, sized_by_load
from ..practice import UNSOURCED
from ..sources import DRIVE, NOT_IN_S2, S2, TYPICAL
from . import curves
from .layers import Fit, declare_size, layers_of

if TYPE_CHECKING:
    from collections.abc import Mapping

    from synth.drawing import Drawing


MODEL_VALUE = f"{TYPICAL} of the reference model"
WEAR = "wear volume in proportion to friction work (Archard)"


class Options(requirements.Options):
    """Options of the interference fit."""

    overload = Option(
        ("slip_limited", "torque_limited"),
        "slip_limited",
        symbol="pol",
        text="slip_limited: the wire sees peak torque or the largest slip torque, whichever is smaller; "
        "torque_limited: it sees peak torque",
        source=NOT_IN_S2,
        group="duty",
    )


class Sizes(Block):
    """What the search decides of the fit."""

    interference = Variable(
        "mm",
        0.005,
        10,
        symbol="dr",
        text="By how much the mean radius of the free coils is smaller than that of the fitted ones",
        source=f"{S2}, Delta r",
    )


class InterferenceDuty(requirements.Duty):
    """What the drive asks of a clutch with this fit."""

    interference_tolerance = replace(
        requirements.Duty.interference_tolerance,
        text="Tolerance of the interference, +- of wire, bore and hub together",
    )


class PracticeInterferenceDuty(InterferenceDuty, requirements.PracticeDuty):
    """What the drive asks of a clutch with this fit, by the rules of practice."""


class Wants(Block):
    """Requirements of the interference fit alone, all in SI; None where an optional one is not given."""

    group = "duty"

    service_factor = Requirement(
        "-",
        lambda wants: 1 if sized_by_load(wants) else 1.5,
        lower=1,
        upper=5,
        symbol="K_A",
        text="The wire must stand service factor times required torque again and again; 1 where safety factor is in it",
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
    drag_torque_limit = of_drive(
        "N*m", 1e-4, 1e4, "drag_max", "Largest drag when overrunning; a twentieth of required torque is usual"
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


class PracticeWants(Wants):
    """Requirements of the interference fit by the rules of practice."""

    overrun_speed = replace(
        Wants.overrun_speed,
        default=None,
        lower=0.1,
        optional=True,
        text="Speed between spring and hub when overrunning; where it is given, no pair is dry",
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
    service_life = of_drive("h", 0.01, 1e6, "L_h", "Hours in service, the least overrunning life", group="duty")
    overrun_life_min = Requirement(
        "h",
        lambda rules: rules.service_life if rules.specifies("service_life") else 500,
        lower=0.01,
        upper=1e6,
        symbol="t_wear_min",
        text=f"Least time in service until overrunning has worn the hubs ({UNSOURCED})",
        source=UNSOURCED,
    )

    def may_run_dry(self, wants: Any) -> bool:
        """True if dry friction pairs are offered, which wear out where the clutch overruns."""
        return wants.overrun_speed is None and super().may_run_dry(wants)

    def limit(self, d: Declaration, built: Built) -> None:
        """Declare the limits that an engineer adds to this fit."""
        super().limit(d, built)
        wants: Wants = built.wants
        d.at_least(
            "hub_wall",
            built.spring.hub_diameter,
            self.hub_wall_ratio * built.spring.duty.bore_diameter,
            "mm",
            text="The hub has a wall around its bore",
            source=UNSOURCED,
        )
        if wants.overrun_speed is None:
            return
        pair, needed = built.spring.pair, (wear.DEPTH, wear.RATE)
        if pair.known.issuperset(needed):
            life = d.derive(
                "overrun_life",
                "h",
                formulas.overrun_life(
                    pair.wearable_depth, pair.wear_rate, pair.mu_max, d.derived["overrun_pv"].sx, wants.overrun_duty
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
    sources = requirements.SOURCES
    understands = (*requirements.COMMON, "drag_torque_limit", "overrun_speed", "service_life")
    declines, disregards, as_limits = coverage.GRIPPING, (*coverage.FACTORS, "ambient_temperature"), coverage.ENVELOPE

    def declare(self, d: Declaration) -> None:
        """Declare requirements, unknowns, limits and objectives."""
        layer_of = LAYERS[practice.declare_scope(d)]
        options = d.block(Options)
        layer = layer_of(d)
        duty = layer.declare_duty(d)
        wants: Wants = layer.declare_wants(d, duty)
        interference = d.block(Sizes).interference
        spring = declare_spring(d, options=options, duty=duty, pairs=layer.pairs(d, wants))
        self._refuse_drag(d, spring, wants)
        self._declare_fit(d, spring, wants, interference)
        low, high = self._declare_moments(d, spring, interference)
        effective = self._declare_grip(d, spring, wants, low)
        load = self._declare_overload(d, spring, overload=options.overload, high=high)
        bending = spring.bending_stress(high)
        stress, pressure = spring.declare_load(
            d, bending_stress=bending, moment=high, load=load, needs="interference_positive"
        )
        self._declare_fatigue(d, spring, wants, bending=bending, high=high)
        self._declare_hub(d, spring, wants, load)
        built = Built(spring, wants, spring.declare_size(d))
        declare_size(d, layer.size(built), duty)
        drag = self._declare_drag(d, spring, wants, high)
        self._declare_overrun(d, built, high=high, drag=drag)
        layer.extend(d, built)
        self._declare_windup(d, spring, low)
        self._declare_utilisation(d, spring, stress=stress, pressure=pressure)
        self._declare_remarks(d, spring, wants, effective=effective, bending=bending, stress=stress)
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
            spec, design, scope=self.option("mass_scope"), seed=self.option("model") == "seed"
        )

    def _refuse_drag(self, d: Declaration, spring: WrapSpring, wants: Wants) -> None:
        """Refuse friction pairs whose range makes the drag limit unreachable, whatever spring and hub."""
        if wants.drag_torque_limit is None:
            return
        coils, pair, duty = requirements.COILS_RANGE[1], spring.pair, spring.duty
        low, high = (formulas.belt_exponent(mu, coils, 1.0) for mu in (pair.mu_min, pair.mu_max))
        moment = duty.slip_safety * duty.required_torque / formulas.closing_torque(1.0, low)
        d.refuse(
            "drag_limit_unreachable",
            wants.drag_torque_limit < formulas.opening_torque(moment, high),
            f"a drag_torque_limit that can be reached with the friction range of the pair and {coils} coils per hub, "
            "at least slip_safety required_torque (1 - exp(-beta_max))/(exp(beta_min) - 1): raise it or choose a pair "
            "with more friction",
        )

    def _declare_moments(self, d: Declaration, spring: WrapSpring, interference: Any) -> tuple[Any, Any]:
        """Bending moments of the loosest and the tightest fit [N m]; what they are made of is named."""
        tolerance, mean = spring.duty.interference_tolerance, spring.mean_radius
        loosest = interference - tolerance
        # The tightest fit is bounded by interference_range; what is built on it is known to be positive.
        small = spring.model.free_radius(interference + tolerance, mean)
        large = spring.model.loosened(small, 2 * tolerance)
        low = spring.fitted_moment(loosest, large)
        inside = spring.hub_diameter - 2 * interference
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
            ("centrifugal_moment", "N*m", spring.centrifugal_moment(), "M_cf", text),
        ]
        spring.model.declare_steps(d, named, source)
        text = "Bending moment of the loosest fit"
        d.step("least_moment", "N*m", low, symbol="M_lo", text=text, source=f"{S2}, eq. (4)")
        return low, formulas.tightened_moment(low, loosest, 2 * tolerance, large, small)

    def _declare_fit(self, d: Declaration, spring: WrapSpring, wants: Wants, interference: Any) -> None:
        tolerance, text = spring.duty.interference_tolerance, "The preload survives the tolerance"
        d.at_least("interference_positive", interference, tolerance, "mm", guard=True, text=text, source=NOT_IN_S2)
        most = interference + tolerance
        d.at_most(
            "interference_range",
            most / spring.mean_radius,
            wants.interference_ratio_max,
            "-",
            text="The strains stay small; interference with its tolerance over mean coil radius",
            source=f"{S2}, small Delta r",
        )
        d.advise(
            "no_free_radius",
            most >= spring.mean_radius,
            "the interference is not below the mean coil radius: there is no such spring, and its other figures mean "
            "nothing",
            source=S2,
        )

    def _declare_grip(self, d: Declaration, spring: WrapSpring, wants: Wants, low: Any) -> Any:
        """Declare the torque that the loosest fit closes on; its bending moment at speed [N m]."""
        spinning = spring.centrifugal_moment()
        effective = low - spinning
        guards = spring.model.declare_grip(d, low, spinning)
        spring.declare_closing(d, formulas.closing_torque(effective, spring.exponent_low), needs=guards)
        self._declare_liftoff(d, spring, wants, low)
        return effective

    def _declare_liftoff(self, d: Declaration, spring: WrapSpring, wants: Wants, low: Any) -> None:
        wire, source = spring.wire, NOT_IN_S2
        speed = d.derive(
            "liftoff_speed",
            "1/min",
            formulas.liftoff_speed(low, wire.density, wire.width, wire.thickness, spring.mean_radius),
            symbol="omega_lift",
            needs="interference_positive",
            text="Speed at which the loosest spring lifts off its hub",
            source=source,
        )
        text = "The spring stays on its hub at spring speed, also with model seed, which counts torques at rest"
        most = wants.liftoff_margin * speed
        d.at_most("liftoff", spring.duty.spring_speed, most, "1/min", text=text, source=source)

    def _declare_overload(self, d: Declaration, spring: WrapSpring, *, overload: str, high: Any) -> Any:
        """Declare the largest slip torque; the torque that the wire sees."""
        peak, load = spring.duty.peak_torque, "Torque that the wire sees at overload"
        text = "Largest torque at which the closing clutch slips: highest friction, tightest fit, at rest"
        slip = formulas.closing_torque(high, spring.exponent_high)
        slip = d.derive("slip_torque", "N*m", slip, symbol="T_cap", text=text, source=f"{S2}, eq. (18)-(20)")
        limited = overload == "slip_limited"
        if limited:
            d.advise(
                "slips_below_peak",
                slip < peak,
                "the clutch always slips below peak torque: slip torque loads the wire, not the drive",
                source=NOT_IN_S2,
            )
        seen = np.minimum(peak, slip) if limited else peak
        return d.derive("wire_torque", "N*m", seen, symbol="T_load", text=load, source=NOT_IN_S2)

    def _declare_fatigue(self, d: Declaration, spring: WrapSpring, wants: Wants, *, bending: Any, high: Any) -> None:
        wire, torque, source = spring.wire, wants.service_factor * spring.duty.required_torque, f"{S2}, eq. (8)"
        least, largest = spring.wire_stress(bending, high + 0.0), spring.wire_stress(bending, high + torque)
        text = "Stress of the wire without a torque"
        d.step("least_stress", "N/mm2", least, symbol="sigma_lo", text=text, source=source)
        text = "Stress of the wire under service factor times required torque"
        d.step("fatigue_stress", "N/mm2", largest, symbol="sigma_hi", text=text, source=source)
        stands, source = (wire.endurance_amplitude, wire.tensile_strength), f"Goodman; {NOT_IN_S2}"
        used = d.derive(
            "fatigue_utilisation",
            "-",
            formulas.goodman_utilisation(wants.fatigue_safety, least, largest, *stands),
            symbol="u_F",
            text="Fatigue of the wire between no torque and service factor times required torque",
            source=source,
        )
        d.at_most("fatigue", used, 1.0, "-", text="The wire does not tire", source=source)

    def _declare_hub(self, d: Declaration, spring: WrapSpring, wants: Wants, load: Any) -> None:
        hub, bore, source = spring.hub_diameter, spring.duty.bore_diameter, "torsion of a tube"
        text = "The hub is thicker than its bore"
        d.at_least("hub_bore", hub, bore, "mm", guard=True, text=text, source="geometry")
        shear = d.derive(
            "hub_shear",
            "N/mm2",
            formulas.hub_shear_stress(load, hub, bore),
            symbol="tau",
            needs="hub_bore",
            text="Shear stress of the hub under wire torque",
            source=source,
        )
        text = "The hub does not twist off"
        d.at_most("hub_shear", shear, wants.hub_shear_limit, "N/mm2", text=text, source=source)

    def _declare_drag(self, d: Declaration, spring: WrapSpring, wants: Wants, high: Any) -> Any:
        """Declare the drag when overrunning with its limit; the drag [N m]."""
        drag = d.derive(
            "drag_torque",
            "N*m",
            formulas.opening_torque(high, spring.exponent_high),
            symbol="T_open",
            text="Drag when overrunning: highest friction, tightest fit",
            source=f"{S2}, eq. (15), (21)",
        )
        if wants.drag_torque_limit is not None:
            most, text = wants.drag_torque_limit, "The clutch overruns freely"
            d.at_most("drag_torque", drag, most, "N*m", text=text, source=f"{S2}, eq. (21)")
        return drag

    def _declare_overrun(self, d: Declaration, built: Built, *, high: Any, drag: Any) -> None:
        wants, spring, size = built.wants, built.spring, built.size
        if wants.overrun_speed is None:
            return
        rubbing = d.derive(
            "overrun_pv",
            "W/mm2",
            formulas.overrun_pv(spring.contact_pressure(high), wants.overrun_speed, spring.hub_radius),
            symbol="pv",
            text="Pressure of the preload times sliding speed when overrunning",
            source=NOT_IN_S2,
        )
        text = "Wire and hub stand the rubbing"
        d.at_most("overrun_pv", rubbing, spring.pair.pv_allow, "W/mm2", text=text, source=NOT_IN_S2)
        rise, source = formulas.overrun_temperature_rise, f"lumped heat balance; {NOT_IN_S2}"
        hot = d.derive(
            "temperature_rise",
            "K",
            rise(drag, wants.overrun_speed, wants.overrun_duty, wants.heat_transfer, size.diameter, size.length),
            symbol="dT",
            text="Steady rise over ambient when overrunning",
            source=source,
        )
        text = "The clutch stays cool when overrunning"
        d.at_most("overrun_temperature", hot, wants.temperature_rise_limit, "K", text=text, source=source)

    def _declare_windup(self, d: Declaration, spring: WrapSpring, low: Any) -> None:
        wire, torque, mean = spring.wire, spring.duty.required_torque, spring.mean_radius
        slope, stiffness = spring.pair.mu_min * spring.radius_ratio, wire.modulus * wire.thickness * wire.width
        angle = formulas.windup_angle(torque, low, slope, mean, stiffness, spring.duty.gap_coils)
        arc = formulas.slip_arc(torque, low, slope)
        for name, unit, value, symbol, text in (
            ("excess_tension", "N", torque / mean, "N_T", "Tension that carries the torque"),
            ("slip_arc", "rad", arc, "alpha_s", "Arc over which the loaded wire slips"),
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

    def _declare_utilisation(self, d: Declaration, spring: WrapSpring, *, stress: Any, pressure: Any) -> None:
        stressed, pressed = stress / spring.wire.bending_allow, pressure / spring.pair.p_allow
        for name, value, symbol, text, source in (
            ("stress_utilisation", stressed, "u_s", "wire stress over its limit", "eq. (8) and (18)"),
            ("pressure_utilisation", pressed, "u_p", "contact pressure over its limit", "eq. (22), corrected"),
        ):
            d.derive(name, "-", value, symbol=symbol, text=text, source=f"{S2}, {source}")

    def _declare_remarks(
        self, d: Declaration, spring: WrapSpring, wants: Wants, *, effective: Any, bending: Any, stress: Any
    ) -> None:
        wire, pair = spring.wire, spring.pair
        d.advise(
            "weak_belt",
            spring.exponent_low < 2,
            "at the least friction the belt exponent is below 2: the drag when overrunning is above some 15 % of the "
            "torque held",
            source=NOT_IN_S2,
        )
        factor = formulas.curved_bar_factor(2 * spring.mean_radius / wire.thickness)
        d.advise(
            "curved_wire",
            stress + (factor - 1) * bending > wire.bending_allow,
            "counting the curvature of the wire (Wahl's factor on bending) its inner fibre is above the allowed stress",
            source="Wahl, Mechanical Springs",
        )
        gripping = spring.per_hub - formulas.tip_coil_loss()
        tips = formulas.belt_exponent(pair.mu_min, gripping, spring.radius_ratio)
        d.advise(
            "tip_lifts_off",
            formulas.closing_torque(effective, tips) < spring.duty.required_torque,
            "the tip of a free end lifts off and about 0.05 coils there do not grip; counting that, the least closing "
            "torque is below required torque: raise slip safety",
            source=NOT_IN_S2,
        )
        if wants.overrun_speed is not None:
            d.advise(
                "overrun_sliding_speed",
                wants.overrun_speed * spring.hub_radius > pair.optional("v_allow"),
                "the sliding speed when overrunning is above what the friction pair stands",
                source="table friction_materials, allowed speed",
            )
