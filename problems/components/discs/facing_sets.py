"""Facings of a list: each row is a ring of lining as it is bought, with its thickness and how deep it may wear."""

from __future__ import annotations

from typing import Any

import numpy as np

from synth.declaration import Declaration, Part

from ..bought import declare_bought, limit_bought
from ..lining.model import Pair
from .model import Facing

TABLE = "facing_sets"
NO_RIVETS = 0.05  # m, more than any facing is thick: what is glued wears by its thickness


def declare_facing_set(d: Declaration) -> Part | None:
    """Declare the option plates, and the slot facing_set where facings are those of a list.

    Parameters
    ----------
    d : Declaration
        Takes the declarations.

    Returns
    -------
    Part or None
        The row of the list; None where facings are made to size.
    """
    text = "Facing on either side of a disc, as bought"
    return declare_bought(d, slot="facing_set", table=TABLE, made="the friction ring", text=text)


def facing_of(row: Part) -> Facing:
    """Return thickness and wear of the facings of a row: down to the rivets, or all of what is glued."""
    return Facing(row.facing_thickness, np.minimum(row.filled("rivet_depth", NO_RIVETS), row.facing_thickness))


def declare_set_limits(d: Declaration, row: Part, *, pair: Pair, pressure: Any) -> None:
    """Declare what a list says of its facings: of which lining they are, and how much pressure they stand.

    Parameters
    ----------
    d : Declaration
        Takes the declarations.
    row : Part
        Row of facing_sets.
    pair : Pair
        Slot friction_pair.
    pressure : symbol
        Pressure on the linings [Pa].
    """
    limit_bought(d, row, table=TABLE, what="facings", lined="facings of the lining", pair=pair, pressure=pressure)
