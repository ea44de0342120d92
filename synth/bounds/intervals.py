"""The rules of interval arithmetic for traced programs, for many boxes at once.

``FORWARD`` gives the interval of a node from those of its arguments, ``BACKWARD`` what the interval of a
node says of its arguments. Together they are forward-backward bound tightening on the expression graph
(Schichl and Neumaier 2005, "Interval analysis on directed acyclic graphs for global optimization"), which
:mod:`synth.bounds.contractor` carries out.

Not-a-number stands for "nothing known" and never excludes a box. Intervals are not rounded
outward: limits are loosened by ``SLACK``, which is far above rounding and twice the tolerance of
feasibility.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from synth.model.program import OPERATIONS
from synth.operations.enclosures import where_sure
from synth.operations.record import Interval
from synth.order.margins import Numbers
from synth.special import SpecialFunction

ROUNDING = 1e-8  # relative: ends of an interval that pass each other by less do so by rounding

FORWARD = {op: known.enclosure for op, known in OPERATIONS.items() if known.enclosure is not None}
BACKWARD = {op: known.backward for op, known in OPERATIONS.items() if any(known.backward)}


def backward(op: int, result: Interval, args: Sequence[Interval]) -> list[Interval | None]:
    """What the interval of a node says of each of its arguments; None where nothing follows."""
    return [None if rule is None else rule(result, *args) for rule in BACKWARD.get(op, (None,) * len(args))]


def special_range(function: SpecialFunction, args: Sequence[Interval]) -> Interval:
    """Range of a special function: it is monotone in every argument."""
    rising = [low >= 0 for low, _ in function.elasticity]
    least = function.formula(*[a[0] if up else a[1] for a, up in zip(args, rising, strict=True)])
    most = function.formula(*[a[1] if up else a[0] for a, up in zip(args, rising, strict=True)])
    inside = np.logical_and.reduce(np.broadcast_arrays(*[a[0] >= 0 for a in args]))
    return where_sure(inside, (least, most))


def loosened(limit: Numbers, size: Numbers, share: float) -> Any:
    """The limit moved by a share of its size: outward by the slack that feasibility and rounding may use.

    Parameters
    ----------
    limit : float or array
    size : float or array
        Smallest size that counts.
    share : float
        Negative to move it down.
    """
    return limit + share * np.maximum(np.abs(limit), size)
