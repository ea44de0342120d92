"""Numbers and names as a screen shows them: as many digits as are decided by, no exponents, no underscores."""

from __future__ import annotations

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


def in_unit(si: float, unit: str) -> str:
    """Return an SI value in a unit, for a screen; nothing where it does not exist."""
    return plain_number(finite_from_si(si, unit, None))
