"""Curves of a multi-plate pack: torque over the number of surfaces, contact force and pressure along the pack."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from synth.text.numbers import number_text, typed_number

from ...mechanics import guide_friction
from ...sources import S0

if TYPE_CHECKING:
    import pandas as pd

    from synth import Design, DesignProblem

IDEAL, FIRST = "no guide friction", "geometric series (5)"
SERIES = {
    FIRST: "geometric",
    "exponential sum (10)": "exponential_K",
    "Lipka's sum (5'')": "lipka",
    "exact balance": "exact",
}
SOURCE = f"{S0}, eq. (5), (10), (14) to (16), appendix by I. Lipka (5''); exact: balance of every plate."
MOST_SURFACES = 120
FRICTIONS = (0.05, 0.10, 0.15)  # where no design says which lining it is


def _limits(step: Mapping[str, float], threshold: float) -> list[dict[str, Any]]:
    """Return the plate-count limits as marks."""
    guide_number = step["inner_guide_ratio"] + step["outer_guide_ratio"]
    named = (
        ("(14)", guide_friction.surface_limit_exponential(guide_number, threshold)),
        ("(15)", step["surfaces_legacy"]),
        ("(16)", guide_friction.surface_limit_geometric(guide_number, threshold)),
    )
    return [{"x": float(x), "label": f"worth while to {number_text(float(x), 3)} {label}"} for label, x in named]


def torque_over_plates(problem: DesignProblem, spec: Mapping[str, Any], design: Design | None = None) -> pd.DataFrame:
    """Torque over the number of friction surfaces by every series, exact and ideal, with the limits (14) to (16).

    Parameters
    ----------
    problem : DesignProblem
        The family.
    spec : mapping
        Requirements of the blocks duty and pack in SI.
    design : Design, optional
        Without one the torque is that of unit mu F0 r on a narrow ring (spline radii equal to the friction radius), for
        a few coefficients of friction.

    Returns
    -------
    pandas.DataFrame
        Whole numbers of surfaces, in newton metres with a design.
    """
    import pandas as pd

    if design is None:
        return _sum_factor_over_plates(problem, spec)
    values, step = design.values, design.steps
    inner, outer, unit = step["inner_guide_ratio"], step["outer_guide_ratio"], step["surface_moment"]
    guide_number = inner + outer
    built = int(values["friction_surfaces"])
    marks: list[dict[str, Any]] = [{"x": built, "label": f"built z = {built}"}]
    reach = 1.5 * built
    if guide_number > 0:
        marks += _limits(step, spec["plate_effectiveness_min"])
        reach = max(1.15 * float(mark["x"]) for mark in marks)
        reach = max(reach, 1.3 * built)
    surfaces = np.arange(0.0, min(math.ceil(reach), max(MOST_SURFACES, 2 * built)) + 1)
    data = {"friction_surfaces [-]": surfaces, f"{IDEAL} [N*m]": unit * surfaces}
    for heading, series in SERIES.items():
        data[f"{heading} [N*m]"] = unit * guide_friction.torque_sum_factor(series, surfaces, inner, outer)
    lines = [{"panel": 0, "y": spec["required_torque"], "label": "required torque"}]
    if guide_number > 0:
        lines.append({"panel": 0, "y": step["torque_bound"], "label": "never more: mu F0 r/S"})
    torques = list(data)[1:]
    others = []
    for heading in list(SERIES)[1:]:
        others.append(f"{heading} excess [%]")
        with np.errstate(invalid="ignore"):  # nothing over nothing where there is no plate
            data[others[-1]] = 100 * (data[f"{heading} [N*m]"] / data[f"{FIRST} [N*m]"] - 1)
    frame = pd.DataFrame(data)
    note = (
        f" Excess: torque over that of (5), less 1. S = {number_text(guide_number)}, mu F0 r = {number_text(unit)} N m."
    )
    if guide_number > 0:
        share = number_text(spec["plate_effectiveness_min"])
        note += f" Worth while by (16): the torque is {share} of what it were without guides."
    if problem.option("guide_model") == "cz":
        note += " This design is sized with the factor c_z: its torque is the ideal one."
    frame.attrs = {
        "title": f"{problem.title}: torque over the number of friction surfaces",
        "x": "friction_surfaces [-]",
        "panels": [
            {"label": "torque [N*m]", "columns": torques, "height": 2.2},
            {"label": "excess [%]", "columns": others},
        ],
        "marks": marks,
        "lines": lines,
        "source": SOURCE + note,
    }
    return frame


def _sum_factor_over_plates(problem: DesignProblem, spec: Mapping[str, Any]) -> pd.DataFrame:
    import pandas as pd

    guide = spec["guide_friction"]
    marks: list[dict[str, Any]] = []
    series = problem.option("guide_series")
    surfaces = np.arange(0.0, 61.0)
    data = {"friction_surfaces [-]": surfaces, f"{IDEAL} [-]": surfaces}
    for mu in FRICTIONS:
        data[f"friction_{mu:g} [-]"] = guide_friction.torque_sum_factor(series, surfaces, mu * guide, mu * guide)
        limit = float(guide_friction.surface_limit_geometric(2 * mu * guide, spec["plate_effectiveness_min"]))
        if 0 < limit <= surfaces[-1]:
            marks.append({"x": limit, "label": f"worth while to {number_text(limit, 3)} at {typed_number(mu)} (16)"})
    frame = pd.DataFrame(data)
    frame.attrs = {
        "title": f"{problem.title}: torque over mu F0 r, over the number of friction surfaces",
        "x": "friction_surfaces [-]",
        "panels": [{"label": "torque_sum_factor [-]", "columns": list(frame.columns[1:])}],
        "marks": marks,
        "source": f"Narrow ring, S = 2 mu mu1 with mu1 = {typed_number(guide)}; series {series}. {SOURCE}",
    }
    return frame


def force_along_pack(problem: DesignProblem, spec: Mapping[str, Any], design: Design) -> pd.DataFrame:
    """Contact force and pressure on every friction surface, counted from the actuator.

    Parameters
    ----------
    problem : DesignProblem
        The family.
    spec : mapping
        Requirements of the blocks duty and pack in SI.
    design : Design
        The design.

    Returns
    -------
    pandas.DataFrame
        One row per surface.
    """
    import pandas as pd

    values, step = design.values, design.steps
    inner, outer, force = step["inner_guide_ratio"], step["outer_guide_ratio"], step["net_force"]
    surfaces = np.arange(1.0, values["friction_surfaces"] + 1)
    # A release aid takes force and area; the pressure of the design tells both.
    series_used = problem.option("guide_series") if problem.option("guide_model") == "series" else None
    first = force if series_used is None else guide_friction.contact_force(series_used, force, 1, inner, outer)
    area = first / values["surface_pressure"]
    data = {"surface [-]": surfaces, f"{IDEAL} [N]": np.full(len(surfaces), force)}
    for heading, series in SERIES.items():
        data[f"{heading} [N]"] = guide_friction.contact_force(series, force, surfaces, inner, outer)
    forces = list(data)[1:]
    for heading in forces:
        data[heading.replace(" [N]", "_pressure [N/mm2]")] = data[heading] / area / 1e6
    frame = pd.DataFrame(data)
    frame.attrs = {
        "title": f"{problem.title}: contact force and pressure along the pack",
        "x": "surface [-]",
        "panels": [
            {"label": "contact_force [N]", "columns": forces, "points": True},
            {"label": "pressure [N/mm2]", "columns": list(frame.columns[len(forces) + 1 :]), "points": True},
        ],
        "lines": [{"panel": 1, "y": design.parts["friction_pair"]["p_allow"] / 1e6, "label": "p_allow"}],
        "source": f"Surfaces counted from the actuator. {SOURCE} S = {number_text(inner + outer)}.",
    }
    return frame
