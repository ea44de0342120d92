"""How long linings last, and what is left of it where a table of linings does not tell how they wear.

The columns of wear are not needed to size a clutch: a table of one's own may lack them.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from synth.declaration import Declaration, Part, Requirement

from ...mechanics import wear as wear_formulas
from ...sources import DRIVE

WEAR_LIFE = "wear_life"
PREFERRED = {WEAR_LIFE: "max", "peak_temperature_rise": "min", "coil_temperature_rise": "min"}
DEPTH, RATE = "wearable_depth", "wear_rate"
LEAST_LIFE = Requirement(
    "-",
    lower=1,
    upper=1e12,
    optional=True,
    symbol="N_w_min",
    text="Least engagements until the linings are worn; without it those in the service life that is asked",
    source=DRIVE,
    group="duty",
)


def depth(part: Part, limit: Any) -> Any:
    """Return the wear of one lining before it is replaced [m]: its own or the limit asked for, whichever is less."""
    return np.minimum(part.wearable_depth, limit) if DEPTH in part.known else limit


def declare_wear_life(d: Declaration, part: Part, *, area: Any, depth: Any, work: Any, text: str) -> Any:
    """Declare the engagements until linings are worn; where their table has no wear rates, a remark in its place.

    Parameters
    ----------
    d : Declaration
        Takes the declarations.
    part : Part
        Row of the lining.
    area : symbol
        All friction surfaces [m2].
    depth : symbol
        Wear of one lining before it is replaced [m].
    work : symbol
        Work of one engagement [J].
    text : str
        What is counted.

    Returns
    -------
    symbol or None
        Engagements; None where the table does not tell.
    """
    if RATE not in part.known:
        remark_no_wear(d, part, f"{WEAR_LIFE} is not told and no objective", (RATE,))
        return None
    return d.derive(
        WEAR_LIFE,
        "-",
        wear_formulas.wear_life(area, depth, part.wear_rate, work),
        symbol="N_w",
        text=text,
        source="wear volume in proportion to friction work (Archard)",
    )


def offer_wear_life(d: Declaration) -> None:
    """Offer the wear life as objective, where it is known; of equal designs the one that lasts and stays cool."""
    if WEAR_LIFE in d.derived:
        d.objective(WEAR_LIFE, "max", default=False)
        for name, sense in PREFERRED.items():
            d.prefer(name, sense)


def limit_wear_life(d: Declaration, part: Part, least: Any, *, text: str) -> None:
    """Declare the least wear life that is asked; without wear rates the limit is void, and designs say so by column.

    Where there is none it is the engagements within the service life.
    """
    known = d.derived.get(WEAR_LIFE)
    if least is None and "service_life" in d.specified and "engagements_per_hour" in d.requirements:
        least = d.requirements["service_life"].sx * d.requirements["engagements_per_hour"].sx
    if least is not None:
        life = part.optional(RATE) if known is None else known.sx
        d.at_least(WEAR_LIFE, life, least, "-", text=text, source=DRIVE)


def remark_no_wear(d: Declaration, part: Part, so: str, needed: tuple[str, ...]) -> None:
    """Remark on every design that the table of linings lacks columns of wear, and what is not told therefore."""
    lacking = " and ".join(column for column in needed if column not in part.known)
    d.advise("wear_not_known", True, f"table {part.table} has no {lacking}: {so}")
