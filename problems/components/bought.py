"""Plates and facings as they are bought: rows of a list in place of sizes that are searched."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from synth.declaration import Declaration, Part


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
