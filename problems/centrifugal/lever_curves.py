"""Curves of the centrifugal clutches with levers: forces, gap and radius over the speed, with new and worn linings."""

from __future__ import annotations

import itertools
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

from ..mechanics import centrifugal
from ..mechanics.lever_motion import Motion, ReversedLever, RodLever
from . import curves as centrifugal_curves
from .curves import MM, RPM, SPEED_AXIS
from .levers import RECONSTRUCTED

if TYPE_CHECKING:
    import pandas as pd

    from synth import Design, DesignProblem

POINTS = 41


def rod_lever(spec: Mapping[str, Any], design: Design) -> RodLever:
    """Return the lever with a headed rod of a design.

    Parameters
    ----------
    spec : mapping
        Requirements in SI.
    design : Design
        Values and parts in SI.
    """
    value = design.values
    rate = centrifugal.set_rate(value["clamp_springs"], design.parts["clamp_spring"]["rate_R"])
    return RodLever(
        mass=value["flyweight_mass"],
        rest_radius=value["rest_radius"],
        flyweight_arm=value["flyweight_arm"],
        preload=centrifugal.spring_force(rate, value["spring_preload_deflection"]),
        rate=rate,
        contact_travel=spec["contact_travel"],
        stop_angle=value["lever_stop_angle"],
        spring_arm=value["spring_arm"],
        rod_arm=value["rod_arm"],
    )


def reversed_lever(spec: Mapping[str, Any], design: Design) -> ReversedLever:
    """Return the reversed lever of a design.

    Parameters
    ----------
    spec : mapping
        Requirements in SI.
    design : Design
        Values and parts in SI.
    """
    value = design.values
    rate = centrifugal.set_rate(value["clamp_springs"], design.parts["clamp_spring"]["rate_R"])
    return_rate = centrifugal.set_rate(value["return_springs"], design.parts["return_spring"]["rate_R"])
    return ReversedLever(
        mass=value["flyweight_mass"],
        rest_radius=value["rest_radius"],
        flyweight_arm=value["flyweight_arm"],
        preload=centrifugal.spring_force(rate, value["spring_preload_deflection"]),
        rate=rate,
        contact_travel=spec["contact_travel"],
        stop_angle=value["lever_stop_angle"],
        short_leg=value["plate_arm"],
        return_preload=centrifugal.spring_force(return_rate, value["return_preload_deflection"]),
        return_rate=return_rate,
    )


@dataclass(frozen=True)
class LeverKind:
    """What tells the drawings of one kind of lever from those of another.

    Parameters
    ----------
    lever : callable
        Requirements and design -> the lever with new linings.
    regimes : tuple of str
        Names of the stretches of its motion.
    own : tuple of (str, str, float)
        What it shows beside what all do: heading, name in ``Motion``, and unit.
    """

    lever: Callable[[Mapping[str, Any], Any], RodLever | ReversedLever]
    regimes: tuple[str, ...]
    own: tuple[tuple[str, str, float], ...]


ROD = LeverKind(
    rod_lever,
    ("rest", "travel", "rod unloads", "spring clamps", "stop"),
    (("spring force [N]", "spring_force", 1.0), ("rod force [N]", "link_force", 1.0)),
)
REVERSED = LeverKind(
    reversed_lever,
    ("rest", "travel", "leg clamps", "disc 1 lifts", "stop"),
    (
        ("spring force [N]", "spring_force", 1.0),
        ("housing force [N]", "link_force", 1.0),
        ("return force [N]", "return_force", 1.0),
        ("lift of disc 1 [mm]", "lift", MM),
    ),
)


def over_speed(
    problem: DesignProblem, spec: Mapping[str, Any], design: Design, kind: LeverKind
) -> dict[str, pd.DataFrame]:
    """Return everything of a lever over the speed.

    Parameters
    ----------
    problem : DesignProblem
        The family.
    spec : mapping
        Requirements in SI.
    design : Design
        The design.
    kind : LeverKind
        Of the family.

    Returns
    -------
    dict of str to DataFrame
        ``over_speed`` with new linings, ``over_speed_worn`` with worn ones.
    """
    lever = kind.lever(spec, design)
    return {
        "over_speed": _over_speed(problem, spec, design, kind, lever, "new linings"),
        "over_speed_worn": _over_speed(problem, spec, design, kind, worn(lever, spec), "worn linings"),
    }


def worn(lever: RodLever | ReversedLever, spec: Mapping[str, Any]) -> RodLever | ReversedLever:
    """Return the lever with worn linings, whose wear the plate travels besides."""
    return replace(lever, contact_travel=lever.contact_travel + spec["lining_wear"])


def columns_of(motion: Motion, design: Design, own: Sequence[tuple[str, str, float]]) -> dict[str, Any]:
    """Columns of a motion, by heading.

    Parameters
    ----------
    motion : Motion
        Of the lever.
    design : Design
        Values and parts in SI.
    own : sequence
        What this lever shows beside what both do: heading, name and unit.
    """
    return {
        SPEED_AXIS: motion.speed / RPM,
        "centrifugal force [N]": motion.flyweight_force,
        **{header: getattr(motion, name) / unit for header, name, unit in own if unit == 1.0},
        "clamp force [N]": motion.clamp_force,
        "stop force [N]": motion.stop_force,
        "torque [N*m]": centrifugal_curves.torque_per_force(design) * motion.clamp_force,
        "gap [mm]": motion.gap / MM,
        **{header: getattr(motion, name) / unit for header, name, unit in own if unit != 1.0},
        "radius [mm]": motion.radius / MM,
        "lever angle [rad]": motion.angle,
    }


def _over_speed(
    problem: DesignProblem,
    spec: Mapping[str, Any],
    design: Design,
    kind: LeverKind,
    lever: RodLever | ReversedLever,
    words: str,
) -> pd.DataFrame:
    """Return one drawing; the lever angle is the parameter, so that a lever that snaps runs back in speed."""
    import pandas as pd

    borders = lever.borders()
    top = 1.5 * max(spec["full_torque_speed"], *borders.speeds)
    columns = columns_of(lever.motion(top, POINTS), design, kind.own)
    frame = pd.DataFrame(columns)
    forces = [name for name in columns if name.endswith("[N]")]
    gaps = [name for name in columns if name.endswith("[mm]") and not name.startswith("radius")]
    edges = (0.0, *borders.speeds, top)
    title = f"{problem.title}: {words}"
    if borders.snaps:
        title += "; where the curve runs back the lever jumps, outwards at the higher speed and home at the lower"
    frame.attrs = {
        "title": title,
        "panels": [
            {"label": "force [N]", "columns": forces, "height": 2},
            {"label": "torque [N*m]", "columns": ["torque [N*m]"]},
            {"label": "gap [mm]" if len(gaps) == 1 else "travel [mm]", "columns": gaps},
            {"label": "radius [mm]", "columns": ["radius [mm]"]},
        ],
        "marks": [
            {"x": spec[name] / RPM, "label": name} for name in ("idle_speed", "contact_speed_max", "full_torque_speed")
        ],
        "spans": [
            {"from": low / RPM, "to": high / RPM, "label": label}
            for (low, high), label in zip(itertools.pairwise(edges), kind.regimes, strict=True)
            if high > low
        ],
        "lines": [{"panel": 1, "y": spec["torque_reserve"] * spec["required_torque"], "label": "required"}],
        "source": RECONSTRUCTED,
    }
    return frame
