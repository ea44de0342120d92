"""What a row of a table says, by the names that models use: numbers, and numbers that stand for texts."""

from __future__ import annotations

import hashlib
import math
from collections.abc import Mapping
from functools import lru_cache
from typing import TypeAlias

Cell: TypeAlias = "float | str | None"  # a number in SI, a text, or nothing

CODE_OF = "code of "  # before the name of a column of text: the column of numbers that stand for its texts
ELSE = " else "  # between the name of a column of numbers and what counts where there is none


def text_code(text: str) -> float:
    """Return a whole number that stands for a text, the same everywhere; different texts have different ones.

    Notes
    -----
    The first 48 bits of the SHA-256: exact as a float, and two of a million texts share one once in 500 tries.
    """
    return float(int.from_bytes(hashlib.sha256(text.encode()).digest()[:6], "big"))


@lru_cache(maxsize=1 << 16)
def named_column(column: str) -> str:
    """Return the name that a column has in its table, of one that is a text or has a number that counts instead."""
    return column.removeprefix(CODE_OF).partition(ELSE)[0]


def cell_value(row: Mapping[str, Cell], column: str) -> float:
    """Return a cell of a row as results hold it, as models use it: not-a-number where it is empty.

    Parameters
    ----------
    row : mapping
        Column -> number in SI, or text.
    column : str
        Name of the column as a model uses it.
    """
    if column.startswith(CODE_OF):
        return text_code(str(row.get(column.removeprefix(CODE_OF)) or ""))
    name, _, other = column.partition(ELSE)
    cell = row.get(name)
    value = math.nan if cell is None else float(cell)
    return float(other) if other and math.isnan(value) else value
