"""Curves of the electromagnetic clutch: torque over current and temperature, pull over the gap, heat balance."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np

from synth.text.numbers import number_text

from ...sources import S4
from ..coil import curves as coil_curves
from ..coil.curves import POINTS, CoilDrawings
from . import formulas as pot_magnet

if TYPE_CHECKING:
    import pandas as pd

    from synth import Design, DesignProblem

SOURCE = f"{S4}, section 6.6; derived, not measured"


@dataclass(frozen=True)
class Built:
    """The magnet of one design, all in SI."""

    circuit: pot_magnet.Circuit
    return_force: float

    @property
    def shape(self) -> pot_magnet.PotMagnet:
        """Sizes of the magnet."""
        return self.circuit.shape

    def flux_density(self, ampere_turns: Any) -> np.ndarray:
        """Return the flux densities that ampere-turns give, by bisection [T]."""
        highest = self.circuit.iron_saturation / float(self.circuit.densest(1.0))
        return coil_curves.flux_densities(ampere_turns, self.circuit.ampere_turns, highest)

    def force(self, flux_density: Any) -> Any:
        """Force left for the pack [N]."""
        return np.maximum(pot_magnet.magnet_force(flux_density, self.shape) - self.return_force, 0.0)


def built(spec: Mapping[str, Any], design: Design) -> Built:
    """Sizes of the magnet of a design as the formulas take them."""
    value = design.values
    shape = pot_magnet.PotMagnet(
        bore=spec["magnet_bore_radius"],
        pole_width=value["inner_pole_width"],
        coil_length=value["coil_length"],
        coil_height=value["coil_height"],
        thickness=value["yoke_thickness"],
        residual_gap=spec["residual_gap"],
    )
    circuit = pot_magnet.Circuit(shape, spec["leakage_factor"], spec["iron_reluctance"], spec["iron_saturation"])
    return Built(circuit, spec["return_spring_force"])


def drawings(problem: DesignProblem, spec: Mapping[str, Any], design: Design) -> CoilDrawings:
    """Curves of the coil of a design; torque is in proportion to the force on the pack.

    Parameters
    ----------
    problem : DesignProblem
        The family.
    spec : mapping
        Requirements in SI.
    design : Design
        The design.
    """
    body, value = built(spec, design), design.values
    unit = value["torque"] / value["actuation_force"]
    return CoilDrawings(
        problem=problem,
        design=design,
        heat=coil_curves.warmth(spec, design, "insulation"),
        torque_of=lambda ampere_turns: unit * body.force(body.flux_density(ampere_turns)),
        torques=[
            {"panel": 0, "y": spec["required_torque"], "label": "sizing torque"},
            {"panel": 0, "y": spec["load_torque"], "label": "load_torque"},
        ],
        source=SOURCE,
    )


def torque_over_current(coil: CoilDrawings, spec: Mapping[str, Any]) -> pd.DataFrame:
    """Torque, forces, flux densities and temperature rise over the current, with their limits.

    Parameters
    ----------
    coil : CoilDrawings
        Of the design.
    spec : mapping
        Requirements in SI.

    Returns
    -------
    pandas.DataFrame
        From no current to half as much again as the design has.
    """
    body, value = built(spec, coil.design), coil.design.values
    turned = coil.currents * coil.design.values["turns"]
    flux_density = body.flux_density(turned)
    force = body.force(flux_density)
    share = turned / value["ampere_turns"]
    needed = spec["pull_in_margin"] * coil.design.steps["springs_and_drag"]
    overload = spec["overload_torque"]
    return coil.torque_over_current(
        {
            "torque [N*m]": force / value["actuation_force"] * value["torque"],
            "on the pack [N]": force,
            "pull on the released armature [N]": share**2 * value["pull_in_force"],
            "poles [T]": body.circuit.pole(flux_density),
            "yoke [T]": body.circuit.yoke(flux_density),
        },
        [
            {"label": "force [N]", "columns": ["on the pack [N]", "pull on the released armature [N]"]},
            {"label": "flux density [T]", "columns": ["poles [T]", "yoke [T]"]},
        ],
        [
            *([] if overload is None else [{"panel": 0, "y": overload, "label": "overload_torque"}]),
            {"panel": 1, "y": needed, "label": "pull_in"},
            {"panel": 2, "y": spec["iron_flux_limit"], "label": "iron_flux_limit"},
        ],
    )


def force_over_gap(problem: DesignProblem, spec: Mapping[str, Any], design: Design) -> pd.DataFrame:
    """Pull of the magnet over the gap at each pole, at the current of the design, with and without iron.

    Parameters
    ----------
    problem : DesignProblem
        The family.
    spec : mapping
        Requirements in SI.
    design : Design
        The design.

    Returns
    -------
    pandas.DataFrame
        From the engaged to the released armature and a little beyond.
    """
    import pandas as pd

    body, value = built(spec, design), design.values
    engaged, released = spec["residual_gap"], design.steps["released_gap"]
    gaps = np.linspace(engaged, 1.2 * released - 0.2 * engaged, POINTS)
    turned = value["ampere_turns"]
    pull = []
    for gap in gaps:
        opened = replace(body, circuit=replace(body.circuit, shape=replace(body.shape, residual_gap=gap)))
        pull.append(float(pot_magnet.magnet_force(opened.flux_density([turned])[0], body.shape)))
    springs = design.steps["springs_and_drag"]
    frame = pd.DataFrame(
        {
            "gap at each pole [mm]": gaps * 1e3,
            "pull [N]": pull,
            "pull, iron neglected [N]": pot_magnet.pull_in_force(turned, gaps, body.shape.pole_area),
        }
    )
    frame.attrs = {
        "title": f"{problem.title}: pull over the gap at {number_text(value['current'], 3)} A",
        "panels": [{"label": "pull [N]", "columns": list(frame.columns[1:]), "log": True}],
        "marks": [{"x": engaged * 1e3, "label": "engaged"}, {"x": released * 1e3, "label": "released"}],
        "lines": [
            {"panel": 0, "y": springs, "label": "springs and drag"},
            {"panel": 0, "y": spec["pull_in_margin"] * springs, "label": "with pull_in_margin"},
        ],
        "source": SOURCE,
    }
    return frame
