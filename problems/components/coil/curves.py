"""What the curves of clutches with a coil share: flux of ampere-turns, torque over temperature, heat balance."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from synth.text.numbers import number_text

from ...mechanics import magnetics

if TYPE_CHECKING:
    import pandas as pd

    from synth import Design, DesignProblem

POINTS = 121
ZERO_CELSIUS = 273.15  # [K]


@dataclass(frozen=True)
class Warmth:
    """What heats and cools the body of one design, all in SI; ``limited_by`` says whose limit it is.

    ``share`` is turns to wind over turns that fill the window: as much heat as in a filled one, like the design itself.
    """

    conductance: float
    ambient: float
    limit: float
    limited_by: str
    other_heat: float
    brush_drop: float
    resistance: float
    share: float

    def copper_loss(self, current: Any, temperature: Any) -> Any:
        """Return the copper loss at a temperature of the coil [W]."""
        return self._cold(current) * magnetics.resistance_ratio(temperature)

    def other_loss(self, current: Any) -> Any:
        """Heat of the body beside that of its copper [W]."""
        return self.other_heat + self.share * self.brush_drop * current

    def _cold(self, current: Any) -> Any:
        """Return the copper loss at 20 degC [W]."""
        return self.share * current**2 * self.resistance

    def rise(self, current: Any) -> Any:
        """Return the steady temperature rise under constant current; not-a-number beyond thermal runaway [K]."""
        cold, other = self._cold(current), self.other_loss(current)
        runaway = self.conductance / magnetics.COPPER_COEFFICIENT
        ratio = magnetics.resistance_ratio(self.ambient)
        with np.errstate(divide="ignore"):
            return np.where(cold < runaway, magnetics.coil_temperature_rise(cold, runaway, ratio, other), np.nan)

    @property
    def temperatures(self) -> np.ndarray:
        """Temperatures to draw, from ambient to a little above the limit [K]."""
        return np.linspace(self.ambient, self.limit + 0.1 * (self.limit - self.ambient), POINTS)

    def marks(self, steady: float) -> list[dict[str, Any]]:
        """Return the steady temperature [K] and the limit as marks."""
        return [
            {"x": steady - ZERO_CELSIUS, "label": "steady"},
            {"x": self.limit - ZERO_CELSIUS, "label": self.limited_by},
        ]


def warmth(spec: Mapping[str, Any], design: Design, limited_by: str) -> Warmth:
    """Heating and cooling of the body of a design; ``limited_by`` says whose limit it is."""
    step = design.steps
    return Warmth(
        conductance=step["coil_conductance"],
        ambient=spec["ambient_temperature"],
        limit=step["coil_temperature_limit"],
        limited_by=limited_by,
        other_heat=step["coil_other_heat"],
        brush_drop=step["coil_brush_drop"],
        resistance=step["coil_resistance"],
        share=design.values["turns"] / step["window_turns"],
    )


def flux_densities(ampere_turns: Any, excitation: Callable[[Any], Any], highest: float) -> np.ndarray:
    """Return the flux densities that ampere-turns give, by bisection.

    Parameters
    ----------
    ampere_turns : array
        NI [A], not negative.
    excitation : callable
        NI(B) [A] of a flux density [T], rising; it may divide by zero where the iron saturates.
    highest : float
        Flux density at which the iron saturates [T].

    Returns
    -------
    numpy.ndarray
        B [T].
    """

    def below_saturation(flux_density: Any) -> Any:
        with np.errstate(divide="ignore"):  # the pole at saturation, which the bisection may touch
            value = excitation(flux_density)
        return np.where(np.isfinite(value), value, np.inf)

    given = np.asarray(ampere_turns, dtype=float)
    return np.array([magnetics.flux_density_at(x, below_saturation, highest) for x in given])


@dataclass(frozen=True, kw_only=True)
class CoilDrawings:
    """The drawings of one design with a coil, and what they share.

    Parameters
    ----------
    problem : DesignProblem
        The family.
    design : Design
        The design; its voltage is that of the hot coil.
    heat : Warmth
        What heats and cools it.
    torque_of : callable
        Torque [N m] of ampere-turns [A].
    torques : list of dict
        Torques to compare with, as lines of the first panel.
    source : str
        Shown below the drawings.
    """

    problem: DesignProblem
    design: Design
    heat: Warmth
    torque_of: Callable[[np.ndarray], Any]
    torques: Sequence[dict[str, Any]]
    source: str

    @property
    def currents(self) -> np.ndarray:
        """Currents to draw, from none to half as much again as the design has [A]."""
        result: np.ndarray = np.linspace(0.0, 1.5, POINTS) * self.design.values["current"]
        return result

    def torque_over_current(
        self, columns: Mapping[str, Any], panels: Sequence[Mapping[str, Any]], lines: Sequence[dict[str, Any]]
    ) -> pd.DataFrame:
        """Torque, what the family adds, and temperature rise over the current, with their limits.

        Parameters
        ----------
        columns : mapping
            Heading -> values at :attr:`currents`, the torque [N*m] first.
        panels : list of mapping
            Of the other columns, between the first (torque) and the last (temperature rise).
        lines : list of dict
            Limits of these panels.

        Returns
        -------
        pandas.DataFrame
            From no current to half as much again as the design has.
        """
        import pandas as pd

        value, current, heat = self.design.values, self.currents, self.heat
        frame = pd.DataFrame({"current [A]": current, **columns, "temperature rise [K]": heat.rise(current)})
        highest = self.design.steps["wire_current_limit"]
        frame.attrs = {
            "title": f"{self.problem.title}: torque over current",
            "panels": [
                {"label": "torque [N*m]", "columns": ["torque [N*m]"]},
                *panels,
                {"label": "temperature rise [K]", "columns": ["temperature rise [K]"]},
            ],
            "marks": [{"x": value["current"], "label": "design"}, {"x": highest, "label": "current_density_limit"}],
            "lines": [
                *self.torques,
                *lines,
                {"panel": len(panels) + 1, "y": heat.limit - heat.ambient, "label": heat.limited_by},
            ],
            "source": self.source,
        }
        return frame

    def torque_over_temperature(self) -> pd.DataFrame:
        """Torque and current over the temperature of the coil, fed with constant voltage or with constant current.

        Returns
        -------
        pandas.DataFrame
            From ambient temperature to a little above the limit.
        """
        import pandas as pd

        value, heat, temperature = self.design.values, self.heat, self.heat.temperatures
        hot = heat.resistance * magnetics.resistance_ratio(temperature)
        current = (value["coil_voltage"] - heat.brush_drop) / hot
        frame = pd.DataFrame(
            {
                "coil temperature [degC]": temperature - ZERO_CELSIUS,
                "constant voltage [N*m]": self.torque_of(current * value["turns"]),
                "constant current [N*m]": np.full_like(temperature, value["torque"]),
                "constant voltage [A]": current,
            }
        )
        frame.attrs = {
            "title": f"{self.problem.title}: torque over temperature at {number_text(value['coil_voltage'], 3)} V",
            "panels": [
                {"label": "torque [N*m]", "columns": ["constant voltage [N*m]", "constant current [N*m]"]},
                {"label": "current [A]", "columns": ["constant voltage [A]"]},
            ],
            "marks": heat.marks(self.design.steps["coil_temperature"]),
            "lines": list(self.torques),
            "source": self.source,
        }
        return frame

    def heat_balance(self) -> pd.DataFrame:
        """Heat made and heat given off over the temperature of the body, under constant current.

        Where the lines cross the clutch stays; where they never cross it runs away.

        Returns
        -------
        pandas.DataFrame
            From ambient temperature to a little above the limit.
        """
        import pandas as pd

        value, heat, temperature = self.design.values, self.heat, self.heat.temperatures
        frame = pd.DataFrame(
            {
                "temperature [degC]": temperature - ZERO_CELSIUS,
                "heat made [W]": heat.copper_loss(value["current"], temperature) + heat.other_loss(value["current"]),
                "heat given off [W]": heat.conductance * (temperature - heat.ambient),
            }
        )
        frame.attrs = {
            "title": f"{self.problem.title}: steady heat at {number_text(value['current'], 3)} A",
            "panels": [{"label": "heat [W]", "columns": list(frame.columns[1:])}],
            "marks": heat.marks(self.design.steps["coil_temperature"]),
            "source": self.source,
        }
        return frame
