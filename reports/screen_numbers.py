"""Numbers and names as a screen shows them: as many digits as are decided by, no exponents, no underscores."""

from __future__ import annotations

import math
from collections.abc import Sequence

from synth.plain_text import plain_number
from synth.units import finite_from_si


def words(name: str) -> str:
    """Return the name of a quantity as words.

    Examples
    --------
    >>> words("ring_outer_diameter")
    'ring outer diameter'
    """
    return name.replace("_", " ")


def alike(values: Sequence[float | None], most: int = 15) -> list[str]:
    """Return the numbers of a column with the same decimals: four digits of the largest, none where all are whole.

    ``most``: at most so many decimals.

    Examples
    --------
    >>> alike([14.568, 9.4, None]), alike([12.0, 8.0]), alike([0.0082654, 0.0033])
    (['14.57', '9.40', ''], ['12', '8'], ['0.008265', '0.003300'])
    """
    known = [abs(x) for x in values if x is not None and math.isfinite(x)]
    whole = all(x == round(x) for x in known)
    largest = max(known, default=0.0)
    decimals = 0 if whole or not largest else min(max(3 - math.floor(math.log10(largest)), 0), most)
    return [
        plain_number(x) if x is None or not math.isfinite(x) else f"{x:,.{decimals}f}".replace(",", " ") for x in values
    ]


def in_unit(si: float, unit: str) -> str:
    """Return an SI value in a unit, for a screen; nothing where it does not exist."""
    return plain_number(finite_from_si(si, unit, None))
