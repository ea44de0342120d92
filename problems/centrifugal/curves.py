"""Curves of the centrifugal clutches: forces and travel over speed, and what the requirement alone allows."""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from synth.text.numbers import number_text

from ..mechanics import centrifugal, two_spring

if TYPE_CHECKING:
    import pandas as pd

    from synth import Design, DesignProblem

POINTS = 41
MM, RPM = 1e-3, 2 * math.pi / 60
SPEED_AXIS = "speed [1/min]"
S4 = "S4 (notes on centrifugal clutches), corrected; friction in the mechanism derived"


@dataclass(frozen=True)
class Path:
    """Way of the flyweights through the regimes of a clutch, all in SI.

    ``knots`` are the borders of the regimes: axial force and travel where a regime begins, the last where motion ends;
    ``regimes`` are the names of the stretches before, between and after them. Between two knots force and travel are
    linear in each other. ``columns`` gives what is to be seen, in display units, from force and travel.
    """

    mass: float
    rest_radius: float
    ratio: float
    outward: float
    inward: float
    knots: Sequence[tuple[float, float]]
    regimes: Sequence[str]
    columns: Callable[[np.ndarray, np.ndarray], Mapping[str, np.ndarray]]
    panels: Sequence[Mapping[str, Any]]

    def radius(self, travel: Any) -> Any:
        """Radius of the flyweight centres at a travel [m]."""
        return centrifugal.orbit_radius(self.rest_radius, self.ratio, travel)

    def speed(self, force: Any, travel: Any, efficiency: float) -> Any:
        """Speed at which the flyweights exert a force at a travel [rad/s]."""
        return centrifugal.speed_for_force(force, self.mass, self.radius(travel), self.ratio, efficiency)

    def force(self, speed: Any, travel: Any, efficiency: float) -> Any:
        """Axial force of the flyweights at a speed and a travel [N]."""
        pull = centrifugal.centrifugal_force(self.mass, self.radius(travel), speed)
        return centrifugal.axial_force(pull, self.ratio, efficiency)


def over_speed(
    problem: DesignProblem, spec: Mapping[str, Any], path: Path, lines: Sequence[Mapping[str, Any]] = ()
) -> dict[str, pd.DataFrame]:
    """Return forces, travel and torque over the speed, for the driver that speeds up and the one that slows down.

    The travel is the parameter, so that a stretch in which the flyweights jump shows as a curve that runs back.

    Parameters
    ----------
    problem : DesignProblem
        The family.
    spec : mapping
        Requirements in SI.
    path : Path
        The regimes of the design.
    lines : sequence of mapping
        Horizontal lines to draw.

    Returns
    -------
    dict of str to DataFrame
        ``engaging_over_speed`` with the friction of flyweights going out, ``releasing_over_speed`` coming in.
    """
    return {
        "engaging_over_speed": _branch(problem, spec, path, path.outward, "speeding up, flyweights going out", lines),
        "releasing_over_speed": _branch(problem, spec, path, path.inward, "slowing down, flyweights coming in", lines),
    }


def _branch(
    problem: DesignProblem,
    spec: Mapping[str, Any],
    path: Path,
    efficiency: float,
    words: str,
    lines: Sequence[Mapping[str, Any]],
) -> pd.DataFrame:
    import pandas as pd

    knots = path.knots
    borders = [float(path.speed(force, travel, efficiency)) for force, travel in knots]
    top = max(spec["top_speed"], 1.05 * borders[-1])
    stretches = [
        (path.force(np.linspace(0, borders[0], POINTS), knots[0][1], efficiency), np.full(POINTS, knots[0][1]))
    ]
    for (low, start), (high, end) in itertools.pairwise(knots):
        share = np.linspace(0, 1, POINTS)
        stretches.append((low + (high - low) * share, start + (end - start) * share))
    last = knots[-1][1]
    stretches.append((path.force(np.linspace(borders[-1], top, POINTS), last, efficiency), np.full(POINTS, last)))
    force, travel = (np.concatenate([stretch[k] for stretch in stretches]) for k in (0, 1))
    speed = path.speed(force, travel, efficiency)
    frame = pd.DataFrame(
        {
            SPEED_AXIS: speed / RPM,
            "centrifugal force [N]": centrifugal.centrifugal_force(path.mass, path.radius(travel), speed),
            **path.columns(force, travel),
            "radius [mm]": path.radius(travel) / MM,
        }
    )
    jumps = any(later < earlier * (1 - 1e-9) for earlier, later in itertools.pairwise(borders))
    title = f"{problem.title}: {words}"
    if jumps:
        title += "; where the curve runs back the flyweights jump across it"
    edges = [0.0, *borders, top]
    frame.attrs = {
        "title": title,
        "panels": [
            *({**panel, "columns": list(panel["columns"])} for panel in path.panels),
            {"label": "radius of the flyweights [mm]", "columns": ["radius [mm]"]},
        ],
        "marks": [
            {"x": spec[name] / RPM, "label": name} for name in ("idle_speed", "full_torque_speed") if spec[name] < top
        ],
        "spans": [
            {"from": low / RPM, "to": high / RPM, "label": label}
            for low, high, label in zip(edges, edges[1:], path.regimes, strict=False)
            if high > low * (1 + 1e-9)
        ],
        "lines": list(lines),
        "source": S4,
    }
    return frame


def ball_ramp_path(spec: Mapping[str, Any], design: Design) -> Path:
    """Return the regimes of device A: at rest, travelling, clamping.

    Parameters
    ----------
    spec : mapping
        Requirements in SI.
    design : Design
        Values and parts in SI.
    """
    value, spring = design.values, design.parts["return_spring"]
    gap, deflection = value["plate_gap"], value["spring_preload_deflection"]
    rate = centrifugal.set_rate(value["return_springs"], spring["rate_R"])
    loss = centrifugal.contact_loss(spec["ball_friction"], value["ramp_ratio"])
    contact = centrifugal.spring_force(rate, deflection + gap)

    def columns(force: np.ndarray, travel: np.ndarray) -> dict[str, np.ndarray]:
        clamp = np.maximum(force - contact, 0.0)
        return {
            "spring force [N]": centrifugal.spring_force(rate, deflection + travel),
            "clamp force [N]": clamp,
            "gap [mm]": (gap - travel) / MM,
            "torque [N*m]": clamp * torque_per_force(design),
        }

    return Path(
        mass=value["flyweight_mass"],
        rest_radius=value["rest_radius"],
        ratio=value["ramp_ratio"],
        outward=float(centrifugal.outward_efficiency(loss)),
        inward=float(centrifugal.inward_efficiency(loss)),
        knots=[(float(centrifugal.spring_force(rate, deflection)), 0.0), (float(contact), gap)],
        regimes=("at rest", "travelling", "clamping"),
        columns=columns,
        panels=[
            {"label": "force [N]", "columns": ["centrifugal force [N]", "spring force [N]", "clamp force [N]"]},
            {"label": "torque [N*m]", "columns": ["torque [N*m]"]},
            {"label": "gap [mm]", "columns": ["gap [mm]"]},
        ],
    )


def two_spring_path(problem: DesignProblem, spec: Mapping[str, Any], design: Design) -> Path:
    """Return the regimes of device B, with balls or levers.

    Parameters
    ----------
    problem : DesignProblem
        The family with its options.
    spec : mapping
        Requirements in SI.
    design : Design
        Values and parts in SI.
    """
    value, first, second = design.values, design.parts["return_spring"], design.parts["clamp_spring"]
    s1 = centrifugal.set_rate(value["return_springs"], first["rate_R"])
    s2 = centrifugal.set_rate(value["clamp_springs"], second["rate_R"])
    plate, stop = value["plate_travel"], value["stop_travel"]
    clamp_deflection = value["clamp_preload_deflection"]
    start = float(centrifugal.spring_force(s2, clamp_deflection))
    plate_start = float(centrifugal.spring_force(s1, value["return_preload_deflection"]))
    contact = float(two_spring.contact_force(plate_start, s1, plate))
    full = float(two_spring.stop_force(start, s2, plate, stop))

    def columns(force: np.ndarray, travel: np.ndarray) -> dict[str, np.ndarray]:
        at_plate = two_spring.plate_travel_at(force, plate_start, s1, plate)
        clamp = two_spring.clamp_force_at(force, contact, full)
        return {
            "return spring force [N]": plate_start + s1 * at_plate,
            "clamp spring force [N]": start + s2 * (travel - at_plate),
            "clamp force [N]": clamp,
            "stop force [N]": two_spring.stop_load(force, full),
            "torque [N*m]": clamp * torque_per_force(design),
            "plate gap [mm]": (plate - at_plate) / MM,
            "stop gap [mm]": (stop - travel) / MM,
        }

    if problem.option("mechanism") == "ball_ramp":
        ratio = value["ramp_ratio"]
        loss = centrifugal.contact_loss(spec["ball_friction"], ratio)
        outward, inward = centrifugal.outward_efficiency(loss), centrifugal.inward_efficiency(loss)
    else:
        ratio, outward = value["lever_ratio"], spec["mechanism_efficiency"]
        inward = 1 / outward
    return Path(
        mass=value["flyweight_mass"],
        rest_radius=value["rest_radius"],
        ratio=ratio,
        outward=float(outward),
        inward=float(inward),
        knots=[
            (start, 0.0),
            (plate_start, float(two_spring.clamp_spring_travel(plate_start, start, clamp_deflection))),
            (contact, float(two_spring.contact_travel(contact, start, clamp_deflection, plate))),
            (full, stop),
        ],
        regimes=("at rest", "tension disc", "both", "clamping", "at the stop"),
        columns=columns,
        panels=[
            {"label": "force [N]", "columns": ["centrifugal force [N]", "clamp force [N]", "stop force [N]"]},
            {"label": "spring force [N]", "columns": ["return spring force [N]", "clamp spring force [N]"]},
            {"label": "torque [N*m]", "columns": ["torque [N*m]"]},
            {"label": "gap [mm]", "columns": ["plate gap [mm]", "stop gap [mm]"]},
        ],
    )


def torque_per_force(design: Design) -> float:
    """Return the torque of the linings per newton of clamp force [m]."""
    value = design.values
    radius = centrifugal.lining_radius(value["lining_inner_radius"], value["lining_outer_radius"])
    return float(design.parts["friction_pair"]["mu_dynamic"] * value["friction_surfaces"] * radius)


def clamp_force_over_lining(problem: DesignProblem, spec: Mapping[str, Any]) -> pd.DataFrame:
    """Clamp force that the torque asks for, over friction times friction radius.

    Parameters
    ----------
    problem : DesignProblem
        The family.
    spec : mapping
        Requirements in SI.

    Returns
    -------
    pandas.DataFrame
        One column for each number of friction surfaces.
    """
    import pandas as pd

    arm = np.geomspace(0.004, 0.08, 4 * POINTS)
    torque = spec["torque_reserve"] * spec["required_torque"]
    columns = {"friction times friction radius [mm]": arm / MM}
    for surfaces in (2, 4, 6, 8):
        force = centrifugal.force_for_torque(torque, 1.0, surfaces, arm)
        columns[f"{surfaces} surfaces [N]"] = force
    frame = pd.DataFrame(columns)
    cap = spec.get("clamp_force_limit")
    frame.attrs = {
        "title": f"{problem.title}: clamp force for {number_text(torque)} N m",
        "panels": [{"label": "clamp force [N]", "columns": list(frame.columns[1:]), "log": True}],
        "lines": [] if cap is None else [{"panel": 0, "y": cap, "label": "clamp_force_limit"}],
        "source": "Shigley, Mechanical Engineering Design, disc clutch with uniform wear",
    }
    return frame


def idle_margin_over_ramp(problem: DesignProblem, spec: Mapping[str, Any]) -> pd.DataFrame:
    """Largest idle margin that friction at the balls allows, over the angle of the ramp.

    Parameters
    ----------
    problem : DesignProblem
        The family.
    spec : mapping
        Requirements in SI.

    Returns
    -------
    pandas.DataFrame
        Without friction, with ``ball_friction`` and with twice as much.
    """
    import pandas as pd

    ratio = np.linspace(0.4, 2.0, 4 * POINTS)
    best = spec["contact_speed_max"] / spec["idle_speed"]
    columns = {"ramp angle [deg]": np.degrees(centrifugal.ramp_angle(ratio))}
    for factor, words in ((0, "no friction"), (1, "ball_friction"), (2, "twice ball_friction")):
        loss = centrifugal.contact_loss(factor * spec["ball_friction"], ratio)
        columns[f"{words} [-]"] = best * centrifugal.release_ratio(loss)
    frame = pd.DataFrame(columns)
    frame.attrs = {
        "title": f"{problem.title}: largest idle margin, contact at contact_speed_max",
        "panels": [{"label": "idle margin [-]", "columns": list(frame.columns[1:])}],
        "lines": [{"panel": 0, "y": spec["idle_margin_min"], "label": "idle_margin_min"}],
        "source": S4,
    }
    return frame
