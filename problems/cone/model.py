"""Cone clutch: torque through a lined cone, with the spring outside or its force closed inside."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from synth import Design, DesignProblem
from synth.declaration import Block, Declaration, Part, Requirement
from synth.text.numbers import number_text, typed_number

from .. import friction, practice
from ..components.lining import wear
from ..components.lining.model import Pair, declare_friction_pair, declare_surface_loads
from ..duty import cooling, coverage, of_drive
from ..friction import startup_curves
from ..mechanics import heat, plates
from ..sources import ARCHARD, LIST_S0, NEALE, S1, SHAFT, TYPICAL
from . import body as cone_body
from . import formulas as cone
from .body import DERIVED, Cone
from .layers import LAYERS, Sources

if TYPE_CHECKING:
    import pandas as pd

    from synth.drawing import Drawing

# The friction work is shared by the inner and the outer cone.
SHELL_SHARE = 0.5
COOLING = "still_air"


# Of the curves: half angles [deg], and friction where no pair is chosen.
ANGLES_SHOWN = (4.0, 30.0)
FRICTION_SHOWN = (0.1, 0.2, 0.3, 0.4, 0.5)


class Wants(Block):
    """Requirements of the cone, all in SI; None where an optional one is not given."""

    group = "practice"

    ring_ratio_min = Requirement(
        "-",
        0.15,
        lower=0.02,
        upper=0.9,
        symbol="c_min",
        text="Least generator length over mean diameter",
        source=f"{S1}, empirical range of c",
    )
    ring_ratio_max = Requirement(
        "-",
        0.20,
        lower=0.02,
        upper=0.9,
        symbol="c_max",
        text="Largest generator length over mean diameter",
        source=f"{S1}, empirical range of c",
    )
    locking_margin = Requirement(
        "-",
        1.05,
        lower=0.5,
        upper=2,
        symbol="k_lock",
        text="Least tan(alpha) over static friction; below 1 the cones may lock",
        source=DERIVED,
        group="actuator",
    )
    seating_pressure_factor = Requirement(
        "-",
        2.5,
        lower=1,
        upper=10,
        symbol="k_seat",
        text="Largest pressure after seating over the allowed pressure of the lining",
        source="premise of the cone model",
        group="model",
    )
    bearing_force_limit = of_drive(
        "N", 1, 1e6, "F_bearing_max", "Largest axial load of the shaft bearings", group="actuator"
    )
    temperature_rise_limit = Requirement(
        "K",
        100,
        lower=1,
        upper=1000,
        symbol="dT_allow",
        text=f"Largest temperature rise of a shell in one engagement ({TYPICAL})",
        source=TYPICAL,
        group="material",
    )


class ConeClutch(DesignProblem):
    """Cone clutch with a spring that pushes against the shaft bearings, or with an inner cone that closes the force.

    Sizing and start-up follow S1, whose cone formulas are lost in print and were derived again.
    """

    name = "cone_clutch"
    title = "Cone clutch"
    sources = (
        "S1: lecture on friction clutches (cone, disc, multi-plate; start-up and heat); cone formulas derived again",
        "Shigley, Mechanical Engineering Design, cone clutch: uniform pressure and uniform wear",
        NEALE,
        LIST_S0,
        ARCHARD,
        "Shop Practice vol. 2, requirements of clutches",
        *SHAFT,
    )
    simulation_settings = startup_curves.SETTINGS
    understands = (*friction.COMMON, "steel_specific_heat", "temperature_rise_limit")
    declines, disregards, as_limits = coverage.ENGAGED_DRY, ("peak_torque",), coverage.ENVELOPE

    def declare(self, d: Declaration) -> None:
        """Declare requirements, unknowns, limits and objectives."""
        layer_of = LAYERS[practice.declare_scope(d)]
        duty = friction.declare_duty(d, cooling_default=COOLING, lubrication=None, kind=layer_of.kind)
        if duty.cooling != COOLING:
            d.advise(
                "cooling_not_counted",
                True,
                "the heat that a cone gives off is not computed: cooling decides only which hourly heat of the lining "
                "counts, heat transfer nothing",
                source="premise of the cone model",
            )
        layer = layer_of(d, duty)
        wants = self._declare_requirements(d, pull_max=layer.pull_max)
        shape = self._declare_cone(d, wants=wants, layer=layer)
        ramp_time = friction.declare_ramp_time(d)
        pair = declare_friction_pair(
            d,
            suited=["'cone facing' in surfaces"],
            duty=duty,
            lubrication=None,
            linings=layer.linings,
            take_up=layer.take_up,
        )
        layout = d.part(
            "cone_layout",
            "cone_layouts",
            symbol="lay",
            text="Outer spring, or inner cone that closes the axial force inside",
            source=f"{S1}, inner-cone clutch",
        )

        def torque(peripheral_force: Any) -> Any:
            return cone.friction_torque(peripheral_force, shape.mean_diameter, shape.ratio, shape.angle)

        low, high = pair.mu_low, pair.mu_high
        # The peripheral force stays one expression for torque and pressure, so that a bound on one reaches the other.
        grip_low = shape.force * cone.grip_factor(shape.angle, low)
        grip_high = grip_low if high is low else shape.force * cone.grip_factor(shape.angle, high)
        seated_force = cone.seated_force(shape.force, shape.angle)
        seated_torque = torque(high * seated_force)
        self._name_wedge(d, shape=shape, low=low, high=high, grip=grip_low)
        torques = friction.declare_torque(
            d,
            duty=duty,
            pair=pair,
            torque_low=torque(grip_low),
            torque_high=torque(grip_high),
            source=f"{S1}, cone clutch; formula lost in print, derived",
            overload=seated_torque,
        )
        start = friction.declare_startup(d, duty=duty, torques=torques, ramp_time=ramp_time)
        declare_surface_loads(
            d,
            duty=duty,
            pair=pair,
            start=start,
            area=shape.area,
            rubbing_area=shape.area,
            pressure=grip_low / low / shape.area,
            pressure_source=f"{S1}, cone clutch; formula lost in print, derived",
            rubbing_radius=shape.largest_diameter / 2,
            narrowing=shape.ratio * np.sin(shape.angle),
        )
        self._declare_seating(
            d, duty=duty, wants=wants, pair=pair, shape=shape, torque=seated_torque, pressure=seated_force / shape.area
        )
        self._declare_release(
            d,
            duty=duty,
            wants=wants,
            layer=layer,
            pair=pair,
            shape=shape,
            force=cone.release_force(grip_high / high, shape.angle, high),
        )
        self._declare_bearing(d, wants=wants, shape=shape, layout=layout)
        shell_mass = cone.shell_mass(duty.steel_density, shape.area, shape.shell_thickness)
        lining = pair.part.lining_thickness
        pack_size = friction.Size(
            mass=cone.clutch_mass(
                layout.mass_factor, shape.area, duty.steel_density, shape.shell_thickness, pair.part.density, lining
            ),
            diameter=cone.overall_diameter(shape.largest_diameter, shape.shell_thickness, lining),
            length=cone.overall_length(shape.length, shape.angle, layout.length_add),
        )
        cones = cone_body.Cones(duty, shape, pair, start, pack_size, grip_low)
        size = layer.size(cones)
        friction.declare_size(
            d, size=size, mass_of=layer.mass_of, outside="Outside of the outer cone", along=layer.along
        )
        layer.extend(d, cones)
        self._declare_temperature(
            d, duty=duty, wants=wants, pair=pair, start=start, size=pack_size, shell_mass=shell_mass
        )
        friction.declare_envelope(d, duty=duty, force=shape.force, diameter=size.diameter, length=size.length)
        self._declare_objectives(d)

    def drawing(self, spec: Mapping[str, Any], design: Design) -> Drawing:
        """Return the section through the engaged cones."""
        from . import drawing as cone_drawing  # costly to import; searches do without

        return cone_drawing.cone_drawing(spec, design)

    def _declare_objectives(self, d: Declaration) -> None:
        d.headline(
            "mass",
            "outer_diameter",
            "length",
            "cone_half_angle",
            "actuation_force",
            "surface_pressure",
            "temperature_rise",
            sized_by="torque_capacity",
        )
        d.objective("mass")
        d.objective("actuation_force")
        for name in ("outer_diameter", "length", "volume", "friction_work"):
            d.objective(name, default=False)
        wear.offer_wear_life(d)
        if "stroke" in d.derived:
            d.objective("stroke", default=False)

    def _declare_requirements(self, d: Declaration, *, pull_max: Any) -> Wants:
        wants = d.block(Wants)
        d.refuse(
            "bad_ratio",
            wants.ring_ratio_min > wants.ring_ratio_max,
            "a ring_ratio_min of at most ring_ratio_max; otherwise no cone satisfies both",
        )
        if pull_max is None:
            d.advise(
                "locking_allowed",
                wants.locking_margin < 1,
                "locking margin below 1 lets the cones lock: they must be pulled apart, with more than release force "
                "says where the friction at rest is the higher one",
                source=f"{S1}, release by an outer force",
            )
        return wants

    def _declare_cone(self, d: Declaration, *, wants: Wants, layer: Sources) -> Cone:
        force = d.variable(
            "actuation_force",
            "N",
            50,
            100000,
            symbol="F0",
            text="Spring force: the axial force that engages the cones",
            source=f"{S1}, the spring is sized for it",
        )
        mean_diameter = d.variable(
            "mean_diameter",
            "mm",
            40,
            800,
            grid=1,
            symbol="dm",
            text="Mean diameter of the friction cone",
            source=f"{S1}, dm",
        )
        length = d.variable(
            "generator_length",
            "mm",
            4,
            200,
            grid=0.5,
            symbol="l_g",
            text="Length of the friction face along its generator",
            source=f"{S1}, b",
        )
        angle = d.variable(
            "cone_half_angle",
            "deg",
            6,
            26,
            grid=0.5,
            symbol="alpha",
            text="Between generator and axis",
            source=f"{S1}, alpha",
        )
        shell_thickness = d.variable(
            "shell_thickness",
            "mm",
            3,
            20,
            grid=0.5,
            symbol="t_s",
            text="Wall of the inner and of the outer cone, which store the heat",
            source="geometry",
        )
        ratio = d.derive(
            "ring_ratio",
            "-",
            length / mean_diameter,
            symbol="c",
            text="Generator length over mean diameter",
            source=f"{S1}, c = b/dm",
        )
        d.at_least(
            "ring_ratio_min",
            ratio,
            wants.ring_ratio_min,
            "-",
            text="The face is not too narrow",
            source=f"{S1}, empirical range of c",
        )
        d.at_most(
            "ring_ratio_max",
            ratio,
            wants.ring_ratio_max,
            "-",
            text="The face is not too wide",
            source=f"{S1}, empirical range of c",
        )
        area = d.step(
            "face_area",
            "cm2",
            cone.face_area(mean_diameter, length),
            symbol="A_face",
            text="Area of the friction face",
            source="geometry",
        )
        shape = Cone(
            force=force,
            mean_diameter=mean_diameter,
            length=length,
            angle=angle,
            shell_thickness=shell_thickness,
            ratio=ratio,
            area=area,
            largest_diameter=cone.largest_diameter(mean_diameter, length, angle),
        )
        layer.judge_angle(d, shape)
        return shape

    def _name_wedge(self, d: Declaration, *, shape: Cone, low: Any, high: Any, grip: Any) -> None:
        """Name what torques and forces of cones are made of."""
        across = 2 * shape.mean_diameter - shape.largest_diameter
        for name, unit, value, symbol, text in (
            ("wedge_factor", "-", cone.wedge_factor(shape.angle, low), "k_w", "Axial over normal force, engaging"),
            ("peripheral_force", "N", grip, "F_u", "Friction force of a clutch that has just engaged"),
            (
                "mean_radius_factor",
                "-",
                cone.mean_radius_factor(shape.ratio, shape.angle),
                "k_r",
                "Friction radius at uniform pressure over the mean radius",
            ),
            ("wide_end_diameter", "mm", shape.largest_diameter, "d_wide", "Friction face at its wide end"),
            ("narrow_end_diameter", "mm", across, "d_narrow", "Friction face at its narrow end"),
        ):
            d.step(name, unit, value, symbol=symbol, text=text, source=DERIVED)
        if high is not low:
            d.step(
                "greatest_wedge_factor",
                "-",
                cone.wedge_factor(shape.angle, high),
                symbol="k_w_max",
                text="Axial over normal force, engaging, with the greatest friction",
                source=DERIVED,
            )

    def _declare_seating(
        self, d: Declaration, *, duty: friction.Duty, wants: Wants, pair: Pair, shape: Cone, torque: Any, pressure: Any
    ) -> None:
        """Declare torque and pressure after vibration has removed the axial friction."""
        d.derive(
            "seated_torque",
            "N*m",
            torque,
            symbol="M_seat",
            text="Torque after vibration has seated the cones under the same spring (worst case: greatest friction)",
            source="derived, N = F/sin(alpha)",
        )
        seated = d.derive(
            "seated_pressure",
            "N/mm2",
            pressure,
            symbol="p_seat",
            text="Pressure after vibration has seated the cones under the same spring",
            source="derived, N = F/sin(alpha)",
        )
        d.at_most(
            "seated_pressure",
            seated,
            wants.seating_pressure_factor * pair.part.p_allow,
            "N/mm2",
            text="The lining stands the pressure of the seated cones",
            source="premise of the cone model",
        )
        if duty.overload_torque is None:
            d.advise(
                "seating",
                cone.seating_factor(shape.angle, pair.mu_high) > 2,
                "seated by vibration the clutch slips only at more than twice its torque: reckon with seated torque "
                "for shafts and drive; overload torque limits it",
                source=f"{S1}, clutch as safety element; derived",
            )

    def _declare_release(
        self, d: Declaration, *, duty: friction.Duty, wants: Wants, layer: Sources, pair: Pair, shape: Cone, force: Any
    ) -> None:
        """Declare the release force and the limit against self-locking, or against a pull that is too hard."""
        release = d.derive(
            "release_force",
            "N",
            force,
            symbol="F_rel",
            text="Force with which the cones push apart; negative: they must be pulled (worst case: greatest friction)",
            source=DERIVED,
        )
        static = pair.part.mu_static
        if duty.friction_basis == "worst_case":
            static = np.maximum(static, pair.part.mu_max)
        d.step(
            "locking_angle",
            "deg",
            cone.locking_angle(static),
            symbol="alpha_lock",
            text="Below this half angle the cones may lock",
            source=DERIVED,
        )
        pull_max = layer.pull_max
        kept, keeps = cone.locking_angle(static * np.maximum(wants.locking_margin, 1.0)), "locking margin"
        if pull_max is not None:
            kept, keeps = np.maximum(cone.pull_angle(static, pair.mu_low, pull_max), 0.0), "release pull max"
        d.step("kept_angle", "deg", kept, symbol="alpha_kept", text=f"Half angle that keeps {keeps}", source=DERIVED)
        if pull_max is None:
            d.at_least(
                "self_locking",
                np.tan(shape.angle),
                wants.locking_margin * static,
                "-",
                text="The cones come apart by themselves",
                source=DERIVED,
            )
        layer.declare_pull(d, shape, static, pair)
        d.advise(
            "pulled_apart",
            release < 0,
            "the cones stay together without a force and must be pulled apart",
            source=f"{S1}, release by an outer force",
        )

    def _declare_bearing(self, d: Declaration, *, wants: Wants, shape: Cone, layout: Part) -> None:
        force = d.derive(
            "bearing_force",
            "N",
            cone.bearing_force(shape.force, layout.force_closed),
            symbol="F_bear",
            text="Axial load of the shaft bearings: the spring force, 0 with an inner cone",
            source=f"{S1}, cone and inner-cone clutch",
        )
        if wants.bearing_force_limit is not None:
            d.at_most(
                "bearing_axial",
                force,
                wants.bearing_force_limit,
                "N",
                text="The shaft bearings stand the spring",
                source="requirement of the drive",
            )
        else:
            d.advise(
                "bearing_thrust",
                layout.force_closed < 0.5,
                "the spring loads the shaft bearings with bearing force as long as the clutch is engaged; an inner "
                "cone does not",
                source=f"{S1}, cone and inner-cone clutch",
            )

    def _declare_temperature(
        self,
        d: Declaration,
        *,
        duty: friction.Duty,
        wants: Wants,
        pair: Pair,
        start: friction.Startup,
        size: friction.Size,
        shell_mass: Any,
    ) -> None:
        friction.declare_heated_body(
            d,
            heat_capacity=shell_mass * duty.steel_specific_heat,
            cooled_area=cooling.effective(d, plates.cylinder_surface(size.diameter, size.length)),
            body="A shell",
        )
        rise = d.derive(
            "temperature_rise",
            "K",
            heat.adiabatic_rise(start.friction_work, shell_mass, duty.steel_specific_heat, SHELL_SHARE),
            symbol="dT",
            text="A shell after one engagement, which takes half of the friction work",
            source="heat balance",
        )
        d.at_most(
            "shell_temperature_rise",
            rise,
            wants.temperature_rise_limit,
            "K",
            text="The shell is thick enough for the heat of one engagement",
            source="heat balance",
        )
        d.advise(
            "lining_temperature",
            rise > pair.linings.peak_temperature(pair.part, pair.part.optional("temp_max")) - duty.ambient_temperature,
            "one engagement makes the shell hotter than the lining stands, even from ambient temperature; a thicker "
            "shell helps, or a lower temperature rise limit",
            source="Neale, Tribology Handbook, Table 7.4",
        )
        d.advise(
            "cooling_pause",
            rise
            > pair.linings.mean_temperature(pair.part, pair.part.optional("temp_continuous"))
            - duty.ambient_temperature,
            "one engagement makes the shell hotter than the lining stands continuously: it has to cool down before "
            "the next; frequent switching makes cooling compulsory",
            source="Neale, Tribology Handbook, Table 7.4; S0 (Szoke 1966), cooling of the plates",
        )

    def simulate(self, spec: Mapping[str, Any], design: Design) -> dict[str, pd.DataFrame]:
        """Return the start-up in time, and the temperature of the conical shell over repeated engagements."""
        return startup_curves.startup_frames(self, spec, design)

    def curves(self, spec: Mapping[str, Any], design: Design | None = None) -> dict[str, pd.DataFrame]:
        """Return axial forces over the half angle, for some friction values and of a design, and the start-up.

        Parameters
        ----------
        spec : mapping
            Requirements in SI by name, None where an optional one is not given.
        design : Design, optional
            The design to draw; mean diameter, face and torque are held, the angle varies.

        Returns
        -------
        dict of str to DataFrame
            ``force_ratio_over_angle``, ``startup_over_torque``, and of a design ``force_over_angle``.
        """
        curves = {
            "force_ratio_over_angle": self._force_ratio_over_angle(spec),
            "startup_over_torque": startup_curves.startup_over_torque(self, spec, design),
        }
        if design is not None:
            curves["force_over_angle"] = self._force_over_angle(spec, design)
        return curves

    def _force_ratio_over_angle(self, spec: Mapping[str, Any]) -> pd.DataFrame:
        import pandas as pd

        degrees = np.linspace(*ANGLES_SHOWN, 105)
        angle = np.radians(degrees)
        engaging = {
            f"engaging force dm/(2M) friction {mu:g} [-]": cone.engaging_force(1 / mu, angle, mu)
            for mu in FRICTION_SHOWN
        }
        releasing = {
            f"releasing force dm/(2M) friction {mu:g} [-]": cone.release_force(1 / mu, angle, mu)
            for mu in FRICTION_SHOWN
        }
        frame = pd.DataFrame({"half angle [deg]": degrees, **engaging, **releasing})
        required = spec["required_torque"]
        frame.attrs = {
            "title": f"Cone clutch: axial force over peripheral force 2M/dm (M = {number_text(required)} N m)",
            "panels": [
                {"label": "engaging force dm/(2M) [-]", "columns": list(engaging)},
                {"label": "releasing force dm/(2M) [-]", "columns": list(releasing)},
            ],
            "marks": [
                {"x": float(np.degrees(cone.locking_angle(mu))), "label": f"self-locking below, {typed_number(mu)}"}
                for mu in FRICTION_SHOWN
            ],
            "lines": [{"panel": 1, "y": 0.0, "label": "below: must be pulled apart"}],
            "source": DERIVED,
        }
        return frame

    def _force_over_angle(self, spec: Mapping[str, Any], design: Design) -> pd.DataFrame:
        import pandas as pd

        value, step, pair = design.values, design.steps, design.parts["friction_pair"]
        low, high = step["least_friction"], step["greatest_friction"]
        degrees = np.linspace(*ANGLES_SHOWN, 105)
        angle = np.radians(degrees)
        mean, ratio = value["mean_diameter"], value["ring_ratio"]
        # The normal force that carries the torque of the design at each angle, and the spring that engages it.
        normal = value["torque"] / cone.friction_torque(low, mean, ratio, angle)
        spring = cone.engaging_force(normal, angle, low)
        seated = cone.seated_force(spring, angle)
        frame = pd.DataFrame(
            {
                "half angle [deg]": degrees,
                "engaging: the spring [N]": spring,
                "in service [N]": cone.service_force(normal, angle),
                "releasing [N]": cone.release_force(cone.normal_force(spring, angle, high), angle, high),
                "engaged [N*m]": np.full_like(angle, value["torque"]),
                "seated by vibration [N*m]": cone.friction_torque(high * seated, mean, ratio, angle),
                "engaged [N/mm2]": normal / step["face_area"] / 1e6,
                "seated by vibration [N/mm2]": seated / step["face_area"] / 1e6,
            }
        )
        by_unit = {unit: [c for c in frame.columns if c.endswith(unit)] for unit in ("[N]", "[N*m]", "[N/mm2]")}
        locking, kept = (math.degrees(step[name]) for name in ("locking_angle", "kept_angle"))
        allowed = pair["p_allow"] / 1e6
        spans = [
            {"from": ANGLES_SHOWN[0], "to": locking, "label": "self-locking"},
            {"from": locking, "to": kept, "label": "below locking_margin"},
        ]
        if "release_pull" in design.limits:
            spans = [
                {"from": ANGLES_SHOWN[0], "to": kept, "label": "above release_pull_max"},
                {"from": kept, "to": locking, "label": "must be pulled apart"},
            ]
        lines = [
            {"panel": 0, "y": 0.0, "label": "below: must be pulled apart"},
            {"panel": 2, "y": allowed, "label": "p_allow"},
            {"panel": 2, "y": allowed * spec["seating_pressure_factor"], "label": "p_allow of seated cones"},
        ]
        if spec["overload_torque"] is not None:
            lines.append({"panel": 1, "y": spec["overload_torque"], "label": "overload_torque"})
        frame.attrs = {
            "title": f"Cone clutch: forces over the half angle for {number_text(value['torque'])} N m, "
            f"{pair['designation']}",
            "panels": [
                {"label": "axial force [N]", "columns": by_unit["[N]"]},
                {"label": "torque [N*m]", "columns": by_unit["[N*m]"]},
                {"label": "pressure [N/mm2]", "columns": by_unit["[N/mm2]"]},
            ],
            "marks": [{"x": float(np.degrees(value["cone_half_angle"])), "label": "this design"}],
            "spans": spans,
            "lines": lines,
            "source": DERIVED,
        }
        return frame
