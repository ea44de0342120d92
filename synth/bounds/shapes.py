"""What is known of one quantity as a function of the inputs, and how it is said in words."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from synth.bounds.curvature import AFFINE, UNKNOWN

NAMED = 4  # inputs that a text names per direction
LONGEST = 100  # characters of a text
FLAT = 1e-12  # an elasticity as small as this may be none but for rounding


@dataclass(frozen=True)
class Shape:
    """What is known of one quantity, or of the quotient of both sides of a limit.

    Parameters
    ----------
    sign : int
        +1 or -1 where it surely has that sign, 0 where that is not known; then nothing else is known.
    nonzero : bool
        Whether it is surely not zero either, for no value of the inputs.
    curvature : str
        ``log-affine``, ``log-convex``, ``log-concave`` or ``unknown``: of the logarithm of its size.
    elasticity : array (inputs, 2)
        Least and largest d log / d log per input; of an input that it jumps with, everything.
    text : str
        The same for people, in short.
    """

    sign: int
    nonzero: bool
    curvature: str
    elasticity: np.ndarray
    text: str = ""

    def rising(self) -> np.ndarray:
        """Inputs with which it rises."""
        return (self.elasticity[:, 0] >= -FLAT) & (self.elasticity[:, 1] > 0)

    def falling(self) -> np.ndarray:
        """Inputs with which it falls."""
        return (self.elasticity[:, 1] <= FLAT) & (self.elasticity[:, 0] < 0)

    def open(self) -> np.ndarray:
        """Return the inputs with which it may rise or fall."""
        return (self.elasticity[:, 0] < -FLAT) & (self.elasticity[:, 1] > FLAT)


def worded(shape: Shape, named: Sequence[tuple[int, str]], equal: bool = False) -> Shape:
    """Return a shape with its text."""
    if shape.sign != 1:
        text = "equality" if equal else "not surely positive"
    elif equal:
        text = f"equality, {AFFINE}" if shape.curvature == AFFINE and shape.nonzero else "equality"
    else:
        ending = "" if shape.nonzero else ", can be 0"
        text = shape.curvature if shape.curvature != UNKNOWN else _directions(shape, named, LONGEST - len(ending))
        text += ending
    return replace(shape, text=text)


def _directions(shape: Shape, named: Sequence[tuple[int, str]], longest: int) -> str:
    """Text on the inputs in which a quantity is monotone, with as many names as fit."""
    rising, falling, unknown = (
        [label for k, label in named if which[k]] for which in (shape.rising(), shape.falling(), shape.open())
    )
    if not rising and not falling:
        return UNKNOWN
    for count in range(NAMED, -1, -1):
        if not unknown:
            ways = [("rises", rising), ("falls", falling)]
            text = "monotone: " + ", ".join(f"{verb} with {_listed(names, count)}" for verb, names in ways if names)
        elif len(unknown) <= count:
            text = f"monotone in all but {_listed(unknown, count)}"
        else:
            text = f"monotone in {_listed(rising + falling, count)}, unknown in {_listed(unknown, count)}"
        if len(text) <= longest:
            break
    return text


def _listed(names: Sequence[str], count: int) -> str:
    """Names as a list; those beyond ``count`` as a number.

    Examples
    --------
    >>> _listed(["a", "b", "c"], 2), _listed(["a", "b", "c"], 3), _listed(["a"], 0)
    ('a, b and 1 more', 'a, b, c', '1 input')
    """
    unnamed = len(names) - count
    if unnamed <= 0:
        return ", ".join(names)
    if not count:
        return f"{unnamed} input{'s' if unnamed > 1 else ''}"
    return f"{', '.join(names[:count])} and {unnamed} more"
