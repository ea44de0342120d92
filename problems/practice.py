"""What an experienced engineer adds to the models: rules of practice, and what is counted as mass.

Most of these figures stand in no source that could be opened. They are defaults that the user may widen one by one,
and say so.
"""

from __future__ import annotations

from typing import NamedTuple, TypeVar

from synth.declaration import Declaration

Layer = TypeVar("Layer")
UNSOURCED = "practice, unsourced"
COUNTED = {"on": "complete", "off": "parts"}  # default of mass_scope by practice


class Scope(NamedTuple):
    """What a question asks for beside the formulas of the sources; families choose a layer by it.

    Attributes
    ----------
    rules : bool
        Whether the rules of practice are limits.
    complete : bool
        Whether mass, length and volume are those of the complete clutch.
    """

    rules: bool
    complete: bool


def by_scope(sources: Layer, complete: Layer, ruled: Layer, ruled_complete: Layer) -> dict[tuple[bool, bool], Layer]:
    """Layers of a family by :class:`Scope`: the sources alone, the complete clutch, rules of practice, and both."""
    return {(False, False): sources, (False, True): complete, (True, False): ruled, (True, True): ruled_complete}


def declare_scope(d: Declaration) -> Scope:
    """Declare the options practice and mass_scope; they come early, because defaults of others depend on them."""
    rules = d.option(
        "practice",
        ("on", "off"),
        "on",
        symbol="prac",
        text="on: what an experienced engineer demands beside the formulas is a limit, each with a requirement that "
        "widens it; off: the sources alone",
        source=UNSOURCED,
        group="practice",
    )
    scope = d.option(
        "mass_scope",
        ("complete", "parts"),
        COUNTED[rules],
        symbol="scope",
        text="complete: mass, length and volume are those of the whole clutch; parts: of what its formulas size",
        source="geometry",
        group="practice",
    )
    return Scope(rules=rules == "on", complete=scope == "complete")
