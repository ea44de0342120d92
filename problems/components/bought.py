"""Plates and facings as they are bought: rows of a list in place of sizes that are searched."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from synth.declaration import Declaration, Part

    from .lining.model import Pair


def declare_bought(d: Declaration, *, slot: str, table: str, made: str, text: str) -> Part | None:
    """Declare the option plates, and a slot where they are those of a list.

    Parameters
    ----------
    d : Declaration
        Takes the declarations.
    slot, table : str
        What is bought, and its list.
    made : str
        What is made to the sizes found otherwise.
    text : str
        Of the slot.

    Returns
    -------
    Part or None
        The row of the list; None where all is made to size.
    """
    source = f"table {table}"
    plates = d.option(
        "plates",
        ("made", "standard"),
        "made",
        symbol="pls",
        text=f"made: {made} to the sizes found; standard: a row of table {table}, your maker's list",
        source=source,
        group="model",
    )
    return None if plates == "made" else d.part(slot, table, symbol="set", text=text, source=source)


def limit_bought(d: Declaration, row: Part, *, table: str, what: str, lined: str, pair: Pair, pressure: Any) -> None:
    """Declare what every list says of its rows: of which lining they are, and how much pressure they stand.

    Parameters
    ----------
    d : Declaration
        Takes the declarations.
    row : Part
        Row of the list.
    table, what : str
        The list, and what it lists.
    lined : str
        Beginning of the sentence that refuses other linings.
    pair : Pair
        Slot friction_pair.
    pressure : symbol
        Largest pressure on the linings [Pa].
    """
    if d.has_column(table, "lining"):
        d.refuse(
            f"lining_of_{what}",
            np.logical_not(np.logical_or(row.says("lining", ""), row.code("lining") == pair.part.code("designation"))),
            f"{lined} that their list names",
        )
    d.at_most(
        "set_pressure",
        pressure,
        row.optional("p_max"),
        "N/mm2",
        text=f"No more pressure than the list of the {what} allows",
        source=f"table {table}",
    )
    if d.has_column(table, "confidence"):
        d.advise(
            f"computed_{what}",
            row.says("confidence", "computed"),
            f"these {what} are of a computed series, no maker lists them: give a maker's list as table {table}",
            source=f"table {table}",
        )
