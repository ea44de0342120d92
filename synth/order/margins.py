"""How closely numbers must agree to be the same, and by how much ends are moved outward against rounding.

The kernels have :func:`below` and :func:`above` in ``kernels/c/margins.h``. Not here is what limits may be
missed by (``synth.order.feasibility``), what the search takes for equal inside that
(``synth.search.settings.Tolerances``), and what verification does, which shares neither (``synth.proof.settings``).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, TypeAlias

import numpy as np

Numbers: TypeAlias = "float | np.ndarray"


@dataclass(frozen=True, kw_only=True)
class Margins:
    """By how much numbers may miss each other and still be the same; no part of an answer hangs on them.

    Parameters
    ----------
    conversion : float
        Relative. Between two entries of one number, in different units or files: a few roundings.
    end : float
        Relative. By how much something may lie beyond the end of a given range: both may have been written
        with nine digits.
    step : float
        Share of a step, or of a whole number, by which a value may miss it and still be on it.
    same : float
        Relative. Of numbers that were computed in two ways, or saved and computed again.
    """

    conversion: float = 1e-12
    end: float = 1e-9
    step: float = 1e-9
    same: float = 1e-9


MARGINS = Margins()


def below(ends: Numbers, relative: float, absolute: float = 0.0) -> Any:
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


def above(ends: Numbers, relative: float, absolute: float = 0.0) -> Any:
    """Return ends moved up, as :func:`below` moves them down.

    Examples
    --------
    >>> [float(above(x, 0.5, 1.0)) for x in (4.0, 0.0, -4.0)]
    [7.0, 1.0, -1.0]
    """
    return np.maximum(ends * (1 + relative), ends * (1 - relative)) + absolute


def within(values: Numbers, low: Numbers, high: Numbers, relative: float, absolute: float = 0.0) -> Any:
    """Tell which values lie between two ends, both moved outward.

    Examples
    --------
    >>> within(np.array([-2.0, -1.0, 0.0]), -1.0 + 1e-13, 0.0, 1e-12).tolist()
    [False, True, True]
    """
    return (values >= below(low, relative, absolute)) & (values <= above(high, relative, absolute))
