"""Curves of the wrap spring clutches, for reports: each is a table with units in its headers and what to draw of it."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from ..components.wrap_spring import formulas
from ..components.wrap_spring.models import MODELS, Refined
from ..sources import S2

if TYPE_CHECKING:
    import pandas as pd

    from synth import Design, DesignProblem

POINTS = 161
MM, MEGA, RPM = 1e-3, 1e6, 2 * math.pi / 60
# Largest over least friction of a pair: no scatter, and as much as greased and oiled pairs have.
FRICTION_SPREADS = (1.0, 1.5, 2.0)
FRICTION_AXIS = "friction coefficient [-]"
COIL_AXIS = "coil from the free end [-]"
SPEED_AXIS = "spring speed [1/min]"


@dataclass(frozen=True)
class Fitted:
    """Figures of one design, all in SI."""

    model: Refined
    thickness: float
    width: float
    modulus: float
    density: float
    bending_allow: float
    hub_diameter: float
    coils: float
    mu_min: float
    mu_max: float
    pressure_allow: float

    @property
    def mean_radius(self) -> float:
        """Mean radius of the fitted coils [m]."""
        return float(self.model.mean_radius(self.hub_diameter, self.thickness))

    @property
    def radius_ratio(self) -> float:
        """Hub radius over mean radius [-]."""
        return float(self.model.radius_ratio(self.hub_diameter, self.thickness))

    def belt_exponent(self, mu: Any) -> Any:
        """Belt exponent of one hub [-]."""
        return formulas.belt_exponent(mu, self.coils, self.radius_ratio)

    def moment(self, interference: Any) -> Any:
        """Bending moment of the fitted wire [N m]; below 0 for a clearance."""
        free = self.model.free_radius(interference, self.mean_radius)
        curvature = formulas.curvature_change(interference, self.mean_radius, free)
        return formulas.bending_moment(self.modulus, self.width, self.thickness, curvature)

    def centrifugal_moment(self, speed: Any) -> Any:
        """Return the part of the moment that the spinning wire carries itself [N m]."""
        return self.model.centrifugal_moment(self.density, self.width, self.thickness, self.mean_radius, speed)

    def stress(self, moment: Any, section_moment: Any) -> Any:
        """Stress of the wire that is bent by one moment and pulled by another [Pa]."""
        bending = formulas.bending_stress(abs(moment), self.width, self.thickness)
        tension = formulas.wire_tension(section_moment, self.mean_radius)
        return formulas.wire_stress(bending, tension, self.width, self.thickness)


def fitted(problem: DesignProblem, spec: Mapping[str, Any], design: Design) -> Fitted:
    """Return the figures of a design that both fits need.

    Parameters
    ----------
    problem : DesignProblem
        The family with its options.
    spec : mapping
        Requirements in SI.
    design : Design
        Values and parts in SI.
    """
    custom = problem.option("wire_choice") == "custom"
    wire, pair = {} if custom else design.parts["wire"], design.parts["friction_pair"]
    return Fitted(
        model=MODELS[problem.option("model")],
        thickness=design.values["wire_thickness"] if custom else wire["radial_thickness_a"],
        width=design.values["wire_width"] if custom else wire["axial_width_b"],
        modulus=spec["wire_modulus"] if custom else wire["E"],
        density=spec["wire_density"] if custom else wire["density"],
        bending_allow=spec["wire_bending_allow"] if custom else wire["bending_allow_static"],
        hub_diameter=design.values["hub_diameter"],
        coils=design.values["coils_per_hub"],
        mu_min=pair["mu_min"],
        mu_max=pair["mu_max"],
        pressure_allow=pair["p_allow"],
    )


def frame(columns: Mapping[str, Any], **attributes: Any) -> pd.DataFrame:
    """Return a table with what is to be drawn of it."""
    import pandas as pd

    result = pd.DataFrame(dict(columns))
    result.attrs.update(attributes)
    return result


def panel(label: str, columns: Sequence[str], log: bool = False) -> dict[str, Any]:
    """Return one panel of a drawing."""
    return {"label": label, "columns": list(columns), "log": log}


def mark(x: float, label: str) -> dict[str, Any]:
    """Return a vertical mark of a drawing."""
    return {"x": float(x), "label": label}


def line(number: int, y: float | None, label: str, unit: float = 1.0) -> list[dict[str, Any]]:
    """Return a horizontal line in a panel, or none where there is no value."""
    return [] if y is None else [{"panel": number, "y": float(y) / unit, "label": label}]


def friction_ladder(clutch: Fitted) -> np.ndarray:
    """Return friction coefficients around the range of the pair, with both ends of it exactly."""
    ladder = np.linspace(0.5 * clutch.mu_min, 1.25 * clutch.mu_max, POINTS)
    return np.unique(np.concatenate([ladder, [clutch.mu_min, clutch.mu_max]]))


def friction_marks(clutch: Fitted) -> list[dict[str, Any]]:
    """Return marks at both ends of the friction."""
    return [mark(clutch.mu_min, "mu_min"), mark(clutch.mu_max, "mu_max")]


def torque_lines(spec: Mapping[str, Any], number: int = 0) -> list[dict[str, Any]]:
    """Return lines at the torque to hold and the peak torque."""
    needed = spec["slip_safety"] * spec["required_torque"]
    return [*line(number, needed, "slip_safety × required_torque"), *line(number, spec["peak_torque"], "peak_torque")]


def section_moments(
    clutch: Fitted, torque: float, moment: float, mu: float, preload: float, coil: np.ndarray
) -> np.ndarray:
    """Return N r_m along the coils while a torque is carried.

    From the gap it falls as on a belt until it meets the tension that the free end holds; from there on nothing slips.

    Parameters
    ----------
    clutch : Fitted
        The design.
    torque, moment : float
        Torque carried and bending moment of the fitted wire [N m].
    mu : float
        Friction coefficient [-].
    preload : float
        N r_m at the free end [N m].
    coil : array
        Coils counted from the free end [-].
    """
    from_gap = 2 * math.pi * (clutch.coils - coil) * mu * clutch.radius_ratio
    return np.maximum((moment + torque) * np.exp(-from_gap), preload)


def along_the_coils(
    clutch: Fitted, cases: Mapping[str, tuple[float, np.ndarray]], coil: np.ndarray, source: str
) -> pd.DataFrame:
    """Return tension, pressure and stress along the coils of one hub.

    Parameters
    ----------
    clutch : Fitted
        The design.
    cases : mapping
        Label to the bending moment of the fitted wire and N r_m along the coils [N m].
    coil : array
        Coils counted from the free end [-].
    source : str
        Source of the curves.
    """
    columns: dict[str, Any] = {COIL_AXIS: coil}
    tension, pressure, stress = [], [], []
    hub_radius = clutch.hub_diameter / 2
    for label, (moment, section) in cases.items():
        tension.append(f"{label} tension [N]")
        columns[tension[-1]] = formulas.wire_tension(section, clutch.mean_radius)
        pressure.append(f"{label} pressure [N/mm2]")
        contact = formulas.contact_pressure(section, clutch.width, hub_radius, clutch.mean_radius)
        columns[pressure[-1]] = contact / MEGA
        stress.append(f"{label} stress [N/mm2]")
        columns[stress[-1]] = clutch.stress(moment, section) / MEGA
    return frame(
        columns,
        title="Tension, pressure and stress along the coils of one hub; the gap is at the right",
        panels=[panel("tension [N]", tension), panel("pressure [N/mm2]", pressure), panel("stress [N/mm2]", stress)],
        lines=[
            *line(1, clutch.pressure_allow, "p_allow", MEGA),
            *line(2, clutch.bending_allow, "allowed stress", MEGA),
        ],
        source=source,
    )


def coil_ladder(clutch: Fitted) -> np.ndarray:
    """Return places along the coils of one hub, from the free end to the gap."""
    return np.linspace(0, clutch.coils, POINTS)


def over_belt_exponent(spec: Mapping[str, Any], drag_limit: float | None) -> pd.DataFrame:
    """Limits by the requirement alone: least drag and the slip torque that comes with it.

    Parameters
    ----------
    spec : mapping
        Requirements in SI.
    drag_limit : float or None
        Largest drag asked for [N m].
    """
    low = np.linspace(0.3, 8, POINTS)
    moment = spec["slip_safety"] * spec["required_torque"] / formulas.closing_torque(1.0, low)
    columns: dict[str, Any] = {"belt exponent at the least friction [-]": low}
    drag, slip = [], []
    for spread in FRICTION_SPREADS:
        drag.append(f"spread {spread:g} drag torque [N*m]")
        columns[drag[-1]] = formulas.opening_torque(moment, spread * low)
        slip.append(f"spread {spread:g} slip torque [N*m]")
        columns[slip[-1]] = formulas.closing_torque(moment, spread * low)
    return frame(
        columns,
        title="Least drag and slip torque for the required torque, by the spread of friction mu_max/mu_min",
        panels=[panel("drag torque [N*m]", drag, log=True), panel("slip torque [N*m]", slip, log=True)],
        lines=[*line(0, drag_limit, "drag_torque_limit"), *line(1, spec["peak_torque"], "peak_torque")],
        source=f"{S2}, eq. (15), (20); the moment is the least that holds, without tolerance",
    )


# -- interference fit ------------------------------------------------------------------------------


def interference_curves(clutch: Fitted, spec: Mapping[str, Any], values: Mapping[str, float]) -> dict[str, Any]:
    """Return the curves of one design with interference fit.

    Parameters
    ----------
    clutch : Fitted
        The design.
    spec : mapping
        Requirements in SI.
    values : mapping
        Values of the design in SI.
    """
    tolerance = spec["interference_tolerance"]
    low = float(clutch.moment(values["interference"] - tolerance))
    high = float(clutch.moment(values["interference"] + tolerance))
    result = {
        "torque_over_friction": _torque_over_friction(clutch, spec, low, high),
        "torque_over_interference": _torque_over_interference(clutch, spec, values),
        "along_the_coils": _interference_along(clutch, spec, values, low, high),
        "windup": _windup(clutch, spec, low, high),
        "overrun": _overrun(clutch, spec, values, high),
    }
    if not clutch.model.at_rest:
        result["torque_over_speed"] = _torque_over_speed(clutch, spec, low)
    return result


def _pressing(moment: Any) -> Any:
    """Return the moment that presses a spring with interference on its hub: none once it has lifted off."""
    return np.maximum(moment, 0.0)


def _torque_over_friction(clutch: Fitted, spec: Mapping[str, Any], low: float, high: float) -> pd.DataFrame:
    mu = friction_ladder(clutch)
    spinning = _pressing(low - clutch.centrifugal_moment(spec["spring_speed"]))
    beta = clutch.belt_exponent(mu)
    columns = {
        FRICTION_AXIS: mu,
        "loosest closing torque [N*m]": formulas.closing_torque(spinning, beta),
        "tightest closing torque [N*m]": formulas.closing_torque(high, beta),
        "loosest opening torque [N*m]": formulas.opening_torque(spinning, beta),
        "tightest opening torque [N*m]": formulas.opening_torque(high, beta),
    }
    names = list(columns)
    return frame(
        columns,
        title="Closing and opening torque; loosest fit at spring_speed, tightest fit at rest",
        panels=[panel("closing torque [N*m]", names[1:3], log=True), panel("opening torque [N*m]", names[3:])],
        marks=friction_marks(clutch),
        lines=[*torque_lines(spec), *line(1, spec["drag_torque_limit"], "drag_torque_limit")],
        source=f"{S2}, eq. (15), (20)",
    )


def _torque_over_interference(clutch: Fitted, spec: Mapping[str, Any], values: Mapping[str, float]) -> pd.DataFrame:
    tolerance, here = spec["interference_tolerance"], values["interference"]
    # As far as small strains allow, but not so far that the design itself is lost in a corner.
    widest = min(spec["interference_ratio_max"] * clutch.mean_radius, 3 * here + tolerance) - tolerance
    nominal = np.unique(np.append(np.linspace(tolerance, max(widest, here), POINTS), here))
    low, high = clutch.moment(nominal - tolerance), clutch.moment(nominal + tolerance)
    spinning = _pressing(low - clutch.centrifugal_moment(spec["spring_speed"]))
    columns = {
        "interference [mm]": nominal / MM,
        "least closing torque [N*m]": formulas.closing_torque(spinning, clutch.belt_exponent(clutch.mu_min)),
        "largest slip torque [N*m]": formulas.closing_torque(high, clutch.belt_exponent(clutch.mu_max)),
        "largest drag [N*m]": formulas.opening_torque(high, clutch.belt_exponent(clutch.mu_max)),
        "bending stress [N/mm2]": clutch.stress(high, 0.0) / MEGA,
    }
    names = list(columns)
    return frame(
        columns,
        title="What more or less interference does",
        panels=[*(panel(name, [name]) for name in names[1:])],
        marks=[mark(here / MM, "interference")],
        lines=[
            *torque_lines(spec)[:1],
            *torque_lines(spec, 1)[1:],
            *line(2, spec["drag_torque_limit"], "drag_torque_limit"),
        ],
        source=f"{S2}, eq. (6), (8), (15), (20)",
    )


def _interference_along(
    clutch: Fitted, spec: Mapping[str, Any], values: Mapping[str, float], low: float, high: float
) -> pd.DataFrame:
    coil = coil_ladder(clutch)
    from_free_end = 2 * math.pi * coil * clutch.mu_max * clutch.radius_ratio
    overload = section_moments(clutch, values["wire_torque"], high, clutch.mu_max, high, coil)
    cases = {
        "required": (low, section_moments(clutch, spec["required_torque"], low, clutch.mu_min, low, coil)),
        "overload": (high, overload),
        "resting": (high, np.full_like(coil, high)),
        "overrunning": (high, high * np.exp(-from_free_end)),
    }
    return along_the_coils(clutch, cases, coil, f"{S2}, eq. (6), (18), (22) corrected; derived")


def _windup(clutch: Fitted, spec: Mapping[str, Any], low: float, high: float) -> pd.DataFrame:
    slips = {"loosest": (low, clutch.mu_min), "tightest": (high, clutch.mu_max)}
    limits = {k: float(formulas.closing_torque(m, clutch.belt_exponent(mu))) for k, (m, mu) in slips.items()}
    end = max(spec["required_torque"], min(spec["peak_torque"], max(limits.values())))
    torque = np.unique(
        np.append(np.linspace(0, end, POINTS), [spec["required_torque"], min(min(limits.values()), end)])
    )
    columns: dict[str, Any] = {"torque [N*m]": torque}
    angles, arcs = [], []
    stiffness = clutch.modulus * clutch.thickness * clutch.width
    for label, (moment, mu) in slips.items():
        friction = mu * clutch.radius_ratio
        angle = formulas.windup_angle(torque, moment, friction, clutch.mean_radius, stiffness, spec["gap_coils"])
        carried = torque <= limits[label] * (1 + 1e-12)
        angles.append(f"{label} wind-up [deg]")
        columns[angles[-1]] = np.where(carried, np.degrees(angle), np.nan)
        arcs.append(f"{label} slipping coils [-]")
        slipping = formulas.slip_arc(torque, moment, friction) / (2 * math.pi)
        columns[arcs[-1]] = np.where(carried, slipping, np.nan)
    return frame(
        columns,
        title="Wind-up between the hubs; loosest fit with least friction, tightest with highest, until it slips",
        panels=[panel("wind-up [deg]", angles), panel("slipping coils [-]", arcs)],
        marks=[mark(spec["required_torque"], "required_torque")],
        lines=line(1, clutch.coils, "coils_per_hub"),
        source="elongation of the slipping arcs; derived",
    )


def _overrun(clutch: Fitted, spec: Mapping[str, Any], values: Mapping[str, float], high: float) -> pd.DataFrame:
    drag = float(formulas.opening_torque(high, clutch.belt_exponent(clutch.mu_max)))
    length = values.get("spring_length", values["length"])  # of a whole clutch the spring alone gives off its heat
    geometry = (spec["heat_transfer"], values["outer_diameter"], length)

    def rise(speed: Any) -> Any:
        return formulas.overrun_temperature_rise(drag, speed, spec["overrun_duty"], *geometry)

    here = spec["overrun_speed"] or 0.0
    # Without a speed asked for: up to the one that the heat allows, or a usual motor speed where heat is no matter.
    hot = spec["temperature_rise_limit"] / rise(1.0) if spec["overrun_duty"] > 0 else 1500 * RPM
    end = 1.5 * here if here > 0 else min(1.25 * hot, 6000 * RPM)
    speed = np.unique(np.append(np.linspace(0, end, POINTS), here))
    hub_radius = clutch.hub_diameter / 2
    preload = formulas.contact_pressure(high, clutch.width, hub_radius, clutch.mean_radius)
    columns = {
        "overrun speed [1/min]": speed / RPM,
        "friction heat [W]": drag * speed,
        "temperature rise [K]": rise(speed),
        "pressure times speed [W/mm2]": formulas.overrun_pv(preload, speed, hub_radius) / MEGA,
    }
    names = list(columns)
    return frame(
        columns,
        title="Heat when overrunning, highest friction and tightest fit",
        panels=[panel(name, [name]) for name in names[1:]],
        marks=[mark(here / RPM, "overrun_speed")] if here > 0 else [],
        lines=line(1, spec["temperature_rise_limit"], "temperature_rise_limit"),
        source="lumped heat balance; derived",
    )


def _torque_over_speed(clutch: Fitted, spec: Mapping[str, Any], low: float) -> pd.DataFrame:
    lift = float(
        formulas.liftoff_speed(low, clutch.density, clutch.width, clutch.thickness, clutch.mean_radius)
        if low > 0
        else 0.0
    )
    here = spec["spring_speed"]
    speed = np.unique(np.append(np.linspace(0, lift, POINTS), min(here, lift)))
    effective = _pressing(low - clutch.centrifugal_moment(speed))
    columns = {
        SPEED_AXIS: speed / RPM,
        "least closing torque [N*m]": formulas.closing_torque(effective, clutch.belt_exponent(clutch.mu_min)),
    }
    margin = spec["liftoff_margin"] * lift
    return frame(
        columns,
        title="Closing torque over the speed of the spring, up to lift-off; least friction, loosest fit",
        panels=[panel("closing torque [N*m]", list(columns)[1:])],
        marks=[*([mark(here / RPM, "spring_speed")] if here > 0 else []), mark(margin / RPM, "liftoff_margin")],
        lines=torque_lines(spec)[:1],
        source="hoop tension of the spinning wire; derived",
    )


# -- clearance fit ---------------------------------------------------------------------------------


def clearance_curves(clutch: Fitted, spec: Mapping[str, Any], values: Mapping[str, float]) -> dict[str, Any]:
    """Return the curves of one design with clearance fit.

    Parameters
    ----------
    clutch : Fitted
        The design.
    spec : mapping
        Requirements in SI.
    values : mapping
        Values of the design in SI.
    """
    tolerance = spec["interference_tolerance"]
    wide = float(clutch.moment(-(values["clearance"] + tolerance)))
    narrow = float(clutch.moment(-(values["clearance"] - tolerance)))
    return {
        "torque_over_friction": _actuated_over_friction(clutch, spec, values, wide, narrow),
        "torque_over_actuator": _actuated_over_actuator(clutch, spec, values, wide, narrow),
        "actuation_over_clearance": _actuation_over_clearance(clutch, spec, values),
        "along_the_coils": _actuated_along(clutch, spec, values, wide, narrow),
    }


def _gripping(moment: Any, exponent: Any, actuator: Any) -> Any:
    """Return the closing torque, and the energising torque alone where nothing grips."""
    grips = actuator + moment > 0
    return np.where(grips, formulas.closing_torque(moment, exponent, actuator), actuator)


def _actuated_over_friction(
    clutch: Fitted, spec: Mapping[str, Any], values: Mapping[str, float], wide: float, narrow: float
) -> pd.DataFrame:
    mu = friction_ladder(clutch)
    beta, actuator = clutch.belt_exponent(mu), values["actuator_torque"]
    spinning = wide - clutch.centrifugal_moment(spec["spring_speed"])
    columns = {
        FRICTION_AXIS: mu,
        "widest closing torque [N*m]": _gripping(spinning, beta, actuator),
        "narrowest closing torque [N*m]": _gripping(narrow, beta, actuator),
    }
    return frame(
        columns,
        title="Closing torque; widest clearance at spring_speed, narrowest clearance at rest",
        panels=[panel("closing torque [N*m]", list(columns)[1:], log=True)],
        marks=friction_marks(clutch),
        lines=torque_lines(spec),
        source=f"{S2}, eq. (18), with an energising torque; derived",
    )


def _actuated_over_actuator(
    clutch: Fitted, spec: Mapping[str, Any], values: Mapping[str, float], wide: float, narrow: float
) -> pd.DataFrame:
    here = values["actuator_torque"]
    actuator = np.unique(np.append(np.linspace(0, 2 * here, POINTS), here))
    spinning = wide - clutch.centrifugal_moment(spec["spring_speed"])
    columns = {
        "energising torque [N*m]": actuator,
        "least closing torque [N*m]": _gripping(spinning, clutch.belt_exponent(clutch.mu_min), actuator),
        "largest closing torque [N*m]": _gripping(narrow, clutch.belt_exponent(clutch.mu_max), actuator),
    }
    return frame(
        columns,
        title="Closing torque over the energising torque; nothing grips before the gap is closed",
        panels=[panel(name, [name]) for name in list(columns)[1:]],
        marks=[mark(here, "actuator_torque")],
        lines=[*torque_lines(spec)[:1], *torque_lines(spec, 1)[1:]],
        source=f"{S2}, eq. (18), with an energising torque; derived",
    )


def _actuation_over_clearance(clutch: Fitted, spec: Mapping[str, Any], values: Mapping[str, float]) -> pd.DataFrame:
    tolerance, here = spec["interference_tolerance"], values["clearance"]
    clearance = np.unique(np.append(np.linspace(tolerance, 3 * here, POINTS), here))
    wide = clutch.moment(-(clearance + tolerance)) - clutch.centrifugal_moment(spec["spring_speed"])
    needed = spec["slip_safety"] * spec["required_torque"]
    exponent = clutch.belt_exponent(clutch.mu_min)
    closing = clutch.coils + spec["gap_coils"]
    columns = {
        "clearance [mm]": clearance / MM,
        "energising torque needed [N*m]": formulas.actuator_torque_for(needed, wide, exponent),
        "angle until closed [rad]": formulas.wrap_angle(closing, clearance + tolerance, clutch.mean_radius),
    }
    names = list(columns)
    return frame(
        columns,
        title="What more or less clearance does to the actuator, least friction and widest clearance",
        panels=[panel("energising torque [N*m]", [names[1]]), panel("angle [rad]", [names[2]])],
        marks=[
            mark(here / MM, "clearance"),
            mark((spec["clearance_min"] + tolerance) / MM, "clearance_min + tolerance"),
        ],
        lines=[
            *line(0, spec["actuator_torque_limit"], "actuator_torque_limit"),
            *line(1, spec["wrap_angle_limit"], "wrap_angle_limit"),
        ],
        source="clearance fit; derived",
    )


def _actuated_along(
    clutch: Fitted, spec: Mapping[str, Any], values: Mapping[str, float], wide: float, narrow: float
) -> pd.DataFrame:
    coil, actuator = coil_ladder(clutch), values["actuator_torque"]

    def carried(torque: float, moment: float, mu: float) -> tuple[float, np.ndarray]:
        return moment, section_moments(clutch, torque, moment, mu, max(actuator + moment, 0.0), coil)

    cases = {
        "required": carried(spec["required_torque"], wide, clutch.mu_min),
        "overload": carried(values["wire_torque"], narrow, clutch.mu_max),
    }
    return along_the_coils(clutch, cases, coil, f"{S2}, eq. (18), with an energising torque; derived")


def actuator_over_belt_exponent(spec: Mapping[str, Any]) -> pd.DataFrame:
    """Limits by the requirement alone: the energising torque without what closes the gap.

    Parameters
    ----------
    spec : mapping
        Requirements in SI.
    """
    low = np.linspace(0.3, 8, POINTS)
    needed = spec["slip_safety"] * spec["required_torque"]
    columns = {
        "belt exponent at the least friction [-]": low,
        "least energising torque [N*m]": formulas.actuator_torque_for(needed, 0.0, low),
    }
    return frame(
        columns,
        title="Energising torque that the required torque entails; what closes the gap comes on top",
        panels=[panel("energising torque [N*m]", list(columns)[1:], log=True)],
        lines=line(0, spec["actuator_torque_limit"], "actuator_torque_limit"),
        source="clearance fit; derived",
    )
