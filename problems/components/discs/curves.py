"""Curves of a pack of one or two discs: size over lining, pressure over radius, torque over force."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from synth.text.numbers import number_text

from ...mechanics import disc
from ...mechanics import ring as ring_formulas
from ...sources import S1

if TYPE_CHECKING:
    import pandas as pd

    from synth import Design, DesignProblem

LININGS_SHOWN = (0.02, 0.4)  # friction times allowed pressure [N/mm2], about from wet to ceramic linings


def diameter_over_lining(problem: DesignProblem, spec: Mapping[str, Any]) -> pd.DataFrame:
    """Outer diameter of the friction ring over friction times allowed pressure, for one and two discs.

    Parameters
    ----------
    problem : DesignProblem
        The family.
    spec : mapping
        Requirements of the blocks duty, ring and disc pack in SI.

    Returns
    -------
    pandas.DataFrame
        For the narrowest and the widest ring allowed.
    """
    import pandas as pd

    grip = np.geomspace(*LININGS_SHOWN, 121) * 1e6
    required = spec["required_torque"]
    columns = {"friction times allowed pressure [N/mm2]": grip / 1e6}
    lines: list[dict[str, Any]] = []
    for discs, words in ((1, "one disc"), (2, "two discs")):
        for name, short in (("ring_ratio_min", "narrow"), ("ring_ratio_max", "wide")):
            ratio = spec[name]
            mean = ring_formulas.sizing_mean_diameter(required, disc.surface_count(discs), 1.0, grip, ratio)
            columns[f"{words}, {short} ring [mm]"] = ring_formulas.outer_diameter(mean, ratio) * 1e3
    names = [name for name in columns if name.endswith("[mm]")]
    if spec["outer_diameter_limit"] is not None:
        room = (spec["outer_diameter_limit"] - 2 * spec["cover_gap"]) * 1e3
        lines.append({"panel": 0, "y": room, "label": "outer_diameter_limit less cover_gap"})
    frame = pd.DataFrame(columns)
    frame.attrs = {
        "title": f"{problem.title}: outer diameter of the friction ring for {number_text(required)} N m",
        "panels": [{"label": "ring outer diameter [mm]", "columns": names}],
        "lines": lines,
        "source": f"{S1}, sizing for pressure",
    }
    return frame


def pressure_over_radius(problem: DesignProblem, design: Design) -> pd.DataFrame:
    """Pressure on the lining over the radius, new and worn in.

    Parameters
    ----------
    problem : DesignProblem
        The family.
    design : Design
        The design.

    Returns
    -------
    pandas.DataFrame
        From the inner to the outer edge of the ring.
    """
    import pandas as pd

    value = design.values
    mean, ratio = value["mean_diameter"], value["ring_ratio"]
    radius = np.linspace(value["ring_inner_diameter"], value["ring_outer_diameter"], 101) / 2
    worn = disc.worn_pressure(value["actuation_force"], mean, ratio, radius)
    frame = pd.DataFrame(
        {
            "radius [mm]": radius * 1e3,
            "new lining [N/mm2]": np.full_like(radius, value["surface_pressure"]) / 1e6,
            "worn-in lining [N/mm2]": worn / 1e6,
        }
    )
    frame.attrs = {
        "title": f"{problem.title}: pressure on the lining",
        "panels": [{"label": "pressure [N/mm2]", "columns": list(frame.columns[1:])}],
        "marks": [
            {"x": value["friction_radius"] * 1e3, "label": "friction radius, new"},
            {"x": design.steps["worn_friction_radius"] * 1e3, "label": "friction radius, worn in"},
        ],
        "lines": [{"panel": 0, "y": design.parts["friction_pair"]["p_allow"] / 1e6, "label": "p_allow"}],
        "source": "uniform pressure; Shigley, Mechanical Engineering Design, uniform wear",
    }
    return frame


def torque_over_force(problem: DesignProblem, spec: Mapping[str, Any], design: Design) -> pd.DataFrame:
    """Torque and pressure over the axial force, new and worn in.

    Parameters
    ----------
    problem : DesignProblem
        The family.
    spec : mapping
        Requirements of the block duty in SI.
    design : Design
        The design.

    Returns
    -------
    pandas.DataFrame
        From no force to more than that of the design.
    """
    import pandas as pd

    value = design.values
    share = np.linspace(0.0, 1.4, 141)
    frame = pd.DataFrame(
        {
            "axial force [N]": share * value["actuation_force"],
            "new lining [N*m]": share * value["torque"],
            "worn-in lining [N*m]": share * value["worn_torque"],
            "pressure, new lining [N/mm2]": share * value["surface_pressure"] / 1e6,
        }
    )
    lines: list[dict[str, Any]] = [
        {"panel": 0, "y": spec["required_torque"], "label": "sizing torque"},
        {"panel": 0, "y": spec["load_torque"], "label": "load torque"},
        {"panel": 1, "y": design.parts["friction_pair"]["p_allow"] / 1e6, "label": "p_allow"},
    ]
    given = [name for name in ("startup_torque", "overload_torque") if spec[name] is not None]
    lines += [{"panel": 0, "y": spec[name], "label": name} for name in given]
    frame.attrs = {
        "title": f"{problem.title}: torque over the force on the pressure plate",
        "panels": [
            {"label": "torque [N*m]", "columns": ["new lining [N*m]", "worn-in lining [N*m]"]},
            {"label": "pressure [N/mm2]", "columns": ["pressure, new lining [N/mm2]"]},
        ],
        "marks": [{"x": value["actuation_force"], "label": "F0"}],
        "lines": lines,
        "source": f"{S1}; Shigley, Mechanical Engineering Design, uniform wear",
    }
    return frame
