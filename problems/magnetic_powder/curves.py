"""Curves of the magnetic-powder clutch: stress needed, torque over current and temperature, heat balance."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from synth.text.numbers import number_text

from ..components.coil import curves as coil_curves
from ..components.coil.curves import POINTS, CoilDrawings
from ..sources import S4
from . import formulas as powder

if TYPE_CHECKING:
    import pandas as pd

    from synth import Design, DesignProblem

POLE_LENGTHS = (0.01, 0.02, 0.04)  # [m]
SOURCE = f"{S4} [P1] to [P8]; the shear curve of the powder is unverified"


@dataclass(frozen=True)
class Built:
    """One design, all in SI."""

    circuit: powder.Circuit
    saturation_stress: float
    half_flux_density: float

    def flux_density(self, ampere_turns: Any) -> np.ndarray:
        """Return the flux densities that ampere-turns give, by bisection [T]."""
        circuit = self.circuit
        highest = circuit.iron_saturation / float(circuit.iron(1.0).densest)

        def excitation(flux_density: Any) -> Any:
            return circuit.ampere_turns(flux_density, circuit.iron(flux_density).densest)

        return coil_curves.flux_densities(ampere_turns, excitation, highest)

    def torque(self, flux_density: Any) -> Any:
        """Return the torque of a flux density [N m]."""
        layout = self.circuit.layout
        stress = powder.shear_stress(np.maximum(flux_density, 1e-9), self.saturation_stress, self.half_flux_density)
        return powder.torque(stress, layout.gap_radius, layout.pole_length)


def built(spec: Mapping[str, Any], design: Design) -> Built:
    """Sizes of a design as the formulas take them."""
    value, row = design.values, design.parts["powder"]
    still = design.choices["coil"] == "stationary"
    layout = powder.Layout(
        gap_radius=value["gap_radius"],
        pole_length=value["pole_length"],
        gap=value["powder_gap"],
        coil_length=value["coil_length"],
        coil_height=value["coil_height"],
        thickness=value["yoke_thickness"],
        drum=spec["drum_thickness"] if still else 0.0,
        air_gap=spec["air_gap"] if still else 0.0,
    )
    circuit = powder.Circuit(
        layout=layout,
        rim=powder.rim_section_width(layout.gap_radius, layout.thickness),
        permeability=row["relative_permeability"],
        leakage_factor=spec["leakage_factor"],
        iron_reluctance=spec["iron_reluctance"],
        iron_saturation=spec["iron_saturation"],
    )
    return Built(circuit, row["tau_sat"], row["half_flux_density"])


def stress_over_radius(problem: DesignProblem, spec: Mapping[str, Any]) -> pd.DataFrame:
    """Shear stress that the powder must carry over the radius of the gap, for some pole lengths.

    Parameters
    ----------
    problem : DesignProblem
        The family.
    spec : mapping
        Requirements in SI.

    Returns
    -------
    pandas.DataFrame
        For two pole faces of 10, 20 and 40 mm.
    """
    import pandas as pd

    radius = np.linspace(0.02, 0.15, POINTS)
    needed = spec["torque_reserve"] * spec["required_torque"]
    columns = {"gap radius [mm]": radius * 1e3}
    for length in POLE_LENGTHS:
        columns[f"poles of {length * 1e3:.0f} mm [kPa]"] = needed / powder.torque(1.0, radius, length) / 1e3
    frame = pd.DataFrame(columns)
    frame.attrs = {
        "title": f"{problem.title}: shear stress for {number_text(needed)} N m",
        "panels": [{"label": "shear stress [kPa]", "columns": list(frame.columns[1:]), "log": True}],
        "source": f"{S4} [P5]",
    }
    return frame


def drawings(problem: DesignProblem, spec: Mapping[str, Any], design: Design) -> CoilDrawings:
    """Curves of the coil of a design.

    Parameters
    ----------
    problem : DesignProblem
        The family.
    spec : mapping
        Requirements in SI.
    design : Design
        The design.
    """
    body, needed = built(spec, design), spec["required_torque"]
    return CoilDrawings(
        problem=problem,
        design=design,
        heat=coil_curves.warmth(spec, design, "insulation and powder"),
        torque_of=lambda ampere_turns: body.torque(body.flux_density(ampere_turns)),
        torques=[
            {"panel": 0, "y": needed, "label": "required_torque"},
            {"panel": 0, "y": spec["torque_reserve"] * needed, "label": "with torque_reserve"},
        ],
        source=SOURCE,
    )


def torque_over_current(coil: CoilDrawings, spec: Mapping[str, Any]) -> pd.DataFrame:
    """Torque, flux densities and temperature rise over the current, with their limits.

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
    body = built(spec, coil.design)
    flux_density = body.flux_density(coil.currents * coil.design.values["turns"])
    iron = body.circuit.iron(flux_density)
    return coil.torque_over_current(
        {
            "torque [N*m]": body.torque(flux_density),
            "powder [T]": flux_density,
            "yoke [T]": iron.yoke,
            "rotor [T]": iron.rotor,
        },
        [{"label": "flux density [T]", "columns": ["powder [T]", "yoke [T]", "rotor [T]"]}],
        [
            {"panel": 1, "y": spec["powder_flux_limit"], "label": "powder_flux_limit"},
            {"panel": 1, "y": spec["iron_flux_limit"], "label": "iron_flux_limit"},
        ],
    )
