"""What a clutch or coupling is asked to do, and what a family answers to what it does not serve."""

from __future__ import annotations

from collections.abc import Mapping

from synth.declaration import Declaration
from synth.errors import ELSEWHERE, NotCoveredError

from ..sources import DRIVE
from .machine import MOVED

START, COUPLING, CONTINUOUS_SLIP, OVERRUN = KINDS = ("start", "coupling", "continuous_slip", "overrun")
# First come, first served.
DUTY_OF = {"slip_speed": CONTINUOUS_SLIP, "overrun_speed": OVERRUN, **dict.fromkeys(("driven_inertia", *MOVED), START)}


def declare_kind(d: Declaration, usual: str, refused: Mapping[str, str]) -> str:
    """Declare the option duty and return the kind that is asked for.

    Parameters
    ----------
    d : Declaration
        Takes the declaration.
    usual : str
        The kind where nothing that is stated asks for one.
    refused : mapping
        Kinds that the family does not serve: why, and what does.

    Raises
    ------
    NotCoveredError
        When it does not serve what is asked for.
    """
    kind = d.option(
        "duty",
        KINDS,
        next((kind for word, kind in DUTY_OF.items() if word in d.specified), usual),
        text="start: it brings a load up to speed; coupling: it holds a torque; continuous_slip: it slips all the "
        "time; overrun: it lets the driven side run ahead; by default what the requirements stated ask for",
        source=DRIVE,
        group="duty",
    )
    if kind in refused:
        raise NotCoveredError("option duty", kind, ELSEWHERE + refused[kind], ("options", "duty"))
    return kind
