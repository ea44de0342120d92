"""Sourced formulas of clutch mechanics, to be used alone: public functions of numbers, and what may be relied on.

* A formula is a pure function. It takes floats, NumPy arrays or CasADi symbols alike and gives the same numbers for
  each; where it takes numbers alone, the types of its arguments say so (``float``, ``scalar or array``).
* Arguments and results are in SI units, named in square brackets. A formula holds for any other consistent units,
  unless it has constants with a unit.
* Each function has one line of meaning, its equation, the unit of every argument and of the result, its source, and
  a checked number as doctest. A test computes every equation and compares it with the function.
* Names, the order of arguments and meaning stay. A change of one is told in the changelog beforehand; a number that
  was wrong is corrected at once and stands there under "Changes that alter numbers".
* Public is what ``__all__`` of this package and of its modules names. What is not public starts with an underscore.

A name belongs to its module, and ``from synth.problems.mechanics import ring`` is the way in: ``contact_force`` is one
thing in :mod:`synth.problems.mechanics.guide_friction` and another in :mod:`synth.problems.mechanics.two_spring`.
Modules are imported when they are asked for; none imports CasADi.

Examples
--------
>>> from synth.problems.mechanics import ring
>>> radius = ring.friction_radius(0.206488499, 0.25)
>>> ring.friction_torque(0.1, 13394.966, radius, 10)
1411.76
"""

from __future__ import annotations

from importlib import import_module
from typing import Any, TypeAlias

__all__ = [
    "Quantity",
    "ball_ramp",
    "centrifugal",
    "centrifugal_levers",
    "contact",
    "disc",
    "guide_friction",
    "heat",
    "lever_motion",
    "magnetics",
    "motors",
    "plates",
    "reduction",
    "ring",
    "shaft",
    "startup",
    "startup_simulation",
    "two_spring",
    "wear",
]

# A float, a NumPy array or a CasADi symbol: no common base class exists, the formulas use only what all three share.
Quantity: TypeAlias = Any


def __getattr__(name: str) -> Any:
    if name in __all__:
        return import_module(f"{__name__}.{name}")
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
