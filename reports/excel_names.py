"""Names of quantities as a spreadsheet takes them: public names, changed only where they would mean something else."""

from __future__ import annotations

import re
from collections.abc import Iterable

# Columns go to XFD; all that looks like one and a row is left alone, also without a row 0.
CELL = re.compile(r"[A-Za-z]{1,3}[0-9]+")
ROW_AND_COLUMN = re.compile(r"[Rr][0-9]*|[Cc][0-9]*|[Rr][0-9]*[Cc][0-9]*")
RESERVED = frozenset(("true", "false", "and", "or", "not", "if", "na", "pi"))
MOST = 200  # characters; 255 are taken


class LegalNames:
    """Hands out names, each once; capital letters tell no two of them apart.

    Examples
    --------
    >>> names = LegalNames()
    >>> [names.of(x) for x in ("torque", "wire.d", "F0", "R", "rc", "log10", "Torque", "a:b c", "2nd", "r1c1.x")]
    ['torque', 'wire.d', 'F0_', 'R_', 'rc_', 'log10_', 'Torque_2', 'a_b_c', '_2nd', 'r1c1.x']
    """

    def __init__(self, used: Iterable[str] = ()) -> None:
        self._used = {name.lower() for name in used}

    def of(self, public: str) -> str:
        """Return the name for a public name."""
        name = re.sub(r"[^A-Za-z0-9_.]", "_", public)[:MOST] or "_"
        if not re.match(r"[A-Za-z_]", name) or name.lower().startswith("_xl"):
            name = f"_{name}"
        if CELL.fullmatch(name) or ROW_AND_COLUMN.fullmatch(name) or name.lower() in RESERVED:
            name = f"{name}_"
        candidate, number = name, 1
        while candidate.lower() in self._used:
            number += 1
            candidate = f"{name.rstrip('_')}_{number}"
        self._used.add(candidate.lower())
        return candidate
