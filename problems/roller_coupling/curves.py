"""Curves of the roller coupling: pin force over the arm radius, angled shafts, and its motion over one turn."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from synth import Design
from synth.text.numbers import number_text

from ..sources import EXTENDS_S3, S3
from . import formulas
from . import motion as kinematics

if TYPE_CHECKING:
    import pandas as pd

# Panels by their labels: how the columns in them begin.
PANELS = {
    "roller gap [mm]": "gap",
    "at offset capacity [mm]": "least",
    "contact force [N]": "contact force",
    "pin force [N]": "pin force",
    "force on shaft 1 [N]": "force on shaft 1",
    "float centre [mm]": "float centre",
    "lead [deg]": "lead",
    "speed [1/min]": "driven speed",
    "slide [mm]": "slide",
}


def pin_force(spec: Mapping[str, Any], design: Design) -> pd.DataFrame:
    """Return forces on a pin over the arm radius; the float and its centrifugal force are those of the design."""
    import pandas as pd

    torque, speed, roller_mass = spec["required_torque"], spec["driver_speed"], design.steps["roller_mass"]
    centrifugal, chosen = design.values["centrifugal_force"], design.values["arm_radius"]
    radius = np.geomspace(chosen / 3, 3 * chosen, 241)
    tangential = formulas.tangential_force(torque, radius, radius)
    own = formulas.roller_centrifugal_force(roller_mass, radius, speed)
    frame = pd.DataFrame(
        {
            "arm radius [mm]": 1000 * radius,
            "from the torque [N]": tangential,
            "from the float [N]": np.full_like(radius, centrifugal),
            "from the roller itself [N]": own,
            "resultant [N]": formulas.resultant_pin_force(tangential + centrifugal, own),
        }
    )
    marks = [{"x": 1000 * chosen, "label": "design"}]
    if speed > 0:
        # Newton's steps to a root, which no calculation tells: it is asked for here alone.
        best = float(formulas.optimum_arm_radius_with_float(torque, roller_mass, speed, centrifugal))
        if radius[0] <= best <= radius[-1]:
            marks.append({"x": 1000 * best, "label": "least pin force"})
    frame.attrs = {
        "title": "Pin force over the arm radius",
        "panels": [{"label": "force [N]", "columns": list(frame.columns[1:])}],
        "marks": marks,
        "source": f"{S3}, eq. (15), with the float: {EXTENDS_S3}",
    }
    return frame


def torque_force(spec: Mapping[str, Any], least: float, largest: float) -> pd.DataFrame:
    """Force on a pin by the torque alone, over the arm radius; float and rollers add to it."""
    import pandas as pd

    radius = np.geomspace(least, largest, 241)
    tangential = formulas.tangential_force(spec["required_torque"], radius, radius)
    frame = pd.DataFrame({"arm radius [mm]": 1000 * radius, "from the torque [N]": tangential})
    frame.attrs = {
        "title": f"Pin force of {number_text(spec['required_torque'])} N*m over the arm radius",
        "panels": [{"label": "force [N]", "columns": ["from the torque [N]"], "log": True}],
        "source": f"{S3}, eq. (15)",
    }
    return frame


def angled_shafts(spec: Mapping[str, Any]) -> pd.DataFrame:
    """Return lead, speed and slide over one turn of shafts at an angle."""
    import pandas as pd

    motion = _turn(spec)
    speed = motion.speed_ratio * spec["driver_speed"] * 30 / math.pi
    columns = _angles(motion, {}, {"driven speed [1/min]": speed})
    frame = pd.DataFrame(columns)
    frame.attrs = {
        "title": f"One turn with shafts at {number_text(math.degrees(spec['shaft_angle']), 3)} deg",
        "panels": _panels(columns, "lead [deg]", "speed [1/min]", "slide [mm]"),
        "source": f"{S3}, eq. (23) to (25), generalised",
    }
    return frame


def _panels(columns: Iterable[str], *labels: str) -> list[dict[str, Any]]:
    return [{"label": x, "columns": [c for c in columns if c.startswith(PANELS[x])]} for x in labels]


def _turn(spec: Mapping[str, Any], offset: float | None = None) -> kinematics.Turn:
    """Motion of the question's shafts, or of parallel shafts at another offset."""
    if offset is not None:
        return kinematics.turn(offset, guide_angle=spec["guide_angle"])
    return kinematics.turn(spec["offset"], spec["float_distance"], spec["shaft_angle"], spec["guide_angle"])


def _angles(motion: kinematics.Turn, centre: Mapping[str, Any], speed: Mapping[str, Any]) -> dict[str, Any]:
    """Columns of the angles and of the slide, with those of the float and of the speed between them."""
    return {
        "driving angle [deg]": np.degrees(motion.driving_angle),
        **centre,
        "lead of the driven shaft [deg]": np.degrees(motion.lead),
        **speed,
        "slide along shaft 2 [mm]": 1000 * (motion.slide - motion.slide[:-1].mean()),
    }


def _clearances(spec: Mapping[str, Any], design: Design, motion: kinematics.Turn) -> dict[str, Any]:
    """Columns of gaps, run-in and run-out at the offset of the shafts, and of the least at the offset capacity."""
    values = design.values
    sizes = (values["arm_radius"], values["guide_half_length"], design.parts["roller"]["outer_diameter"])
    found = kinematics.clearances(motion, *sizes)
    widest = kinematics.clearances(_turn(spec, values["offset_capacity"]), *sizes)
    pairs = ("1a-2a", "1a-2b", "1b-2a", "1b-2b")
    columns = {f"gap {pair} [mm]": 1000 * found.gaps[:, k] for k, pair in enumerate(pairs)}
    for k, guide in enumerate(("I", "II")):
        columns[f"run-in, guide {guide} [mm]"] = 1000 * found.run_in[:, k]
        columns[f"run-out, guide {guide} [mm]"] = 1000 * found.run_out[:, k]
    for name, clear in (("roller gap", widest.gaps), ("run-in", widest.run_in), ("run-out", widest.run_out)):
        columns[f"least {name} at offset capacity [mm]"] = 1000 * clear.min(axis=1)
    return columns


def _of_forces(force: kinematics.Forces) -> dict[str, Any]:
    """Columns of the forces on rollers, pins and shaft 1, and of the torque that is driven."""
    rollers = list(enumerate(("1a", "1b", "2a", "2b")))
    return {
        **{f"contact force {name} [N]": force.contact[:, k] for k, name in rollers},
        **{f"pin force {name} [N]": force.pins[:, k] for k, name in rollers},
        "force on shaft 1, x [N]": force.first_shaft[:, 0],
        "force on shaft 1, y [N]": force.first_shaft[:, 1],
        "driven torque [N*m]": force.driven_torque,
    }


def _forces(spec: Mapping[str, Any], design: Design, motion: kinematics.Turn) -> kinematics.Forces:
    values = design.values
    return kinematics.forces(
        motion,
        values["arm_radius"],
        spec["required_torque"],
        spec["driver_speed"],
        values["float_mass"],
        design.steps["roller_mass"],
        values["float_mass"] if design.choices["balance"] == "yes" else 0.0,
    )


def one_turn(spec: Mapping[str, Any], design: Design) -> pd.DataFrame:
    """Return positions of the float, roller gaps and forces of a design over one turn, from exact kinematics."""
    import pandas as pd

    values, motion = design.values, _turn(spec)
    force = _forces(spec, design, motion)
    centre = {f"float centre {axis} [mm]": 1000 * motion.centre[:, k] for k, axis in enumerate("xy")}
    columns = _angles(motion, centre, {"speed ratio [-]": motion.speed_ratio})
    columns |= _clearances(spec, design, motion) | _of_forces(force)
    frame = pd.DataFrame(columns)
    steady, vibration = kinematics.steady_and_vibrating(force.first_shaft)
    least = formulas.least_roller_distance(values["arm_radius"], values["offset_capacity"], spec["guide_angle"])
    least_gap = float(least - design.parts["roller"]["outer_diameter"])
    tangential, centrifugal = values["tangential_force"], values["centrifugal_force"]
    labels = list(PANELS)[:6] + (["lead [deg]", "slide [mm]"] if spec["shaft_angle"] > 0 else [])
    frame.attrs = {
        "title": "One turn of the roller coupling",
        "x": "driving angle [deg]",
        "panels": _panels(columns, *labels),
        "lines": [
            {"panel": 0, "y": 1000 * spec["roller_gap_min"], "label": "roller_gap_min"},
            {"panel": 1, "y": 1000 * least_gap, "label": "least gap, eq. (18)"},
            {"panel": 2, "y": tangential + centrifugal, "label": "F + Q"},
            {"panel": 2, "y": tangential - centrifugal, "label": "F - Q"},
            {"panel": 3, "y": values["pin_force"], "label": "pin_force"},
        ],
        "source": f"exact kinematics; closed forms: {S3}, eq. (14), (18) to (25)",
        "quantities": {
            "axial_slide": float(np.ptp(motion.slide)),
            "speed_fluctuation": float(motion.speed_ratio.max() - 1),
            "centrifugal_force": float(np.ptp(force.contact[:, 0]) / 2),
            "pin_force": float(force.pins.max()),
            "steady_force": float(steady),
            "vibration_force": float(vibration),
        },
    }
    return frame
