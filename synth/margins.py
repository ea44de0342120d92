"""The one margin by which ends are moved outward, so that rounding costs no value that is on an end.

Compiled code has the same in ``bounds/templates/margins.c``.
"""

from __future__ import annotations

from typing import Any

import numpy as np


def below(ends: Any, relative: float, absolute: float = 0.0) -> Any:
    """Return ends moved down by a share of their size, whatever their sign.

    Parameters
    ----------
    ends : float or array
        Any unit; infinite ends stay what they are.
    relative : float
        Share of the size, below 1.
    absolute : float
        In the unit of the ends: what is moved where an end is zero.

    Examples
    --------
    >>> [float(below(x, 0.5, 1.0)) for x in (4.0, 0.0, -4.0, -np.inf, np.inf)]
    [1.0, -1.0, -7.0, -inf, inf]
    """
    return np.minimum(ends * (1 - relative), ends * (1 + relative)) - absolute


def above(ends: Any, relative: float, absolute: float = 0.0) -> Any:
    """Return ends moved up, as :func:`below` moves them down.

    Examples
    --------
    >>> [float(above(x, 0.5, 1.0)) for x in (4.0, 0.0, -4.0)]
    [7.0, 1.0, -1.0]
    """
    return np.maximum(ends * (1 + relative), ends * (1 - relative)) + absolute


def within(values: Any, low: Any, high: Any, relative: float, absolute: float = 0.0) -> Any:
    """Tell which values lie between two ends, both moved outward.

    Examples
    --------
    >>> within(np.array([-2.0, -1.0, 0.0]), -1.0 + 1e-13, 0.0, 1e-12).tolist()
    [False, True, True]
    """
    return (values >= below(low, relative, absolute)) & (values <= above(high, relative, absolute))
