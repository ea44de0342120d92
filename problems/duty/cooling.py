"""How heat leaves a clutch: one row of cooling_options, for every family that has heat."""

from __future__ import annotations

from typing import Any

import numpy as np

from synth.declaration import Declaration, Option, Part
from synth.errors import InputError

from ..practice import UNSOURCED
from ..sources import S0

TABLE = "cooling_options"
STILL, TURNING = "heat_transfer_still", "heat_transfer"
TYPED = {TURNING: "heat_transfer", STILL: "still_heat_transfer"}  # requirements that win over a row
STILL_AIR = 12.0  # of a body that stands, where a table of one's own does not tell [W/(m2 K)]

COOLING = Option(
    table=TABLE,
    default="still_air",
    symbol="cool",
    text="How heat leaves the clutch; gives the default of heat transfer",
    source=f"{S0}, cooling of the plates",
)


def row(d: Declaration) -> Part:
    """Row of the cooling that is chosen."""
    return d.row(TABLE, d.options["cooling"].chosen)


def still_transfer(d: Declaration) -> Any:
    """Surface coefficient of a body that stands [W/(m2 K)]."""
    return row(d).filled(STILL, STILL_AIR)


def effective(d: Declaration, area: Any) -> Any:
    """Surface that gives off as much heat as an outside [m2] with its fins."""
    return area if _figure(d, "area_factor", 1.0) == 1 else row(d).area_factor * area


def fin_mass(d: Declaration, shell: Any) -> Any:
    """Mass of the fins on a shell [kg]; None without fins."""
    return row(d).fin_mass * shell if _figure(d, "fin_mass", 0.0) > 0 else None


def stands(d: Declaration) -> bool:
    """Whether the cooling needs a body that stands."""
    return bool(np.isnan(_figure(d, TURNING, np.nan)))


def refuse_unfit(d: Declaration, lubrication: str | None, *, turning: bool) -> None:
    """Refuse a cooling that does not go with the lubrication, None for any, or with a body that turns.

    Raises
    ------
    InputError
        Names those that go.
    """
    chosen = d.options["cooling"].chosen
    if turning and stands(d):
        fitting = [other for other in d.designations(TABLE) if np.isfinite(_figure(d, TURNING, np.nan, other))]
        raise InputError("cooling_stands", f"cooling {chosen}", f"a cooling of bodies that turn: {', '.join(fitting)}")
    suited = ("", "any", lubrication)
    fitting = [other for other in d.designations(TABLE) if d.cell(TABLE, other, "lubrication") in suited]
    if lubrication is not None and chosen not in fitting:
        right = f"a cooling for lubrication {lubrication}: {' or '.join(fitting)}"
        raise InputError("lubrication_mismatch", f"cooling {chosen}", right)


def advise_stronger(d: Declaration, limit: str, column: str = TURNING) -> None:
    """Remark a limit on a rise that is used by more than 90 %, with the next stronger cooling."""
    chosen = d.options["cooling"].chosen
    strength = {x: _figure(d, column, STILL_AIR, x) * _figure(d, "area_factor", 1.0, x) for x in d.designations(TABLE)}
    suited = (d.cell(TABLE, chosen, "lubrication"), "any")
    ratios = [(strength[x] / strength[chosen], x) for x in strength if d.cell(TABLE, x, "lubrication") in suited]
    if max(ratios)[0] <= 1 or TYPED[column] in d.specified:
        return
    factor, following = min((x for x in ratios if x[0] > 1), key=lambda x: x[0])
    used, following = d.limits[limit], following.replace("_", " ")
    text = f"Rise over ambient with cooling {following}, about"
    d.step("cooler_rise", "K", used.value / factor, symbol="dT_next", text=text, source=UNSOURCED)
    message = (
        f"{limit.replace('_', ' ')} is used by more than 90 %: cooling {following} would bring the rise to about "
        f"{round(100 / factor)} % of what it is (cooler rise)"
    )
    d.advise("stronger_cooling", used.value > 0.9 * used.limit, message, source=UNSOURCED)


def _figure(d: Declaration, column: str, otherwise: float, of: str | None = None) -> float:
    """Number of a row, by default the one chosen; another where table or row do not have it."""
    if not d.has_column(TABLE, column):
        return otherwise
    index = d.designations(TABLE).index(of or d.options["cooling"].chosen)
    value = float(d.numbers(TABLE, column)[index])
    return otherwise if np.isnan(value) else value
