"""By how much a design must be better to count: the gap as a distance, and what no gap goes below.

The search measures objectives as *phi*: by logarithm where they are surely positive and to be made small, else as
shares of a usual size. A gap of the former is a share of the value, whatever its size. The latter may be zero, where no
share tells anything: there every claim ends at the *resolution*, an amount of the objective.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from synth.units import parse_unit

if TYPE_CHECKING:
    from synth.declaration import Declaration

# In phi. Settling ties gives away some 1e-9 of it at each of its steps: no claim is finer than a few of them.
FINEST = 1e-8
ROUNDING = 5e-9


def declared_resolution(declaration: Declaration, name: str) -> float | None:
    """Declared resolution of an objective in SI; None where it follows from the usual size."""
    resolution = declaration.objectives[name].resolution if name in declaration.objectives else None
    if resolution is None:
        return None
    unit = next(unit for quantity, unit, _ in declaration.quantities() if quantity == name)
    return float(resolution) * float(parse_unit(unit).ratio)


def goal_scales(log: np.ndarray, sizes: np.ndarray, declared: Sequence[float | None]) -> tuple[np.ndarray, np.ndarray]:
    """Unit of phi and resolution in phi, per objective.

    Parameters
    ----------
    log : array (objectives,)
        Which are measured by logarithm.
    sizes : array (objectives,)
        Usual sizes in SI.
    declared : list
        Resolutions in SI, None where the declaration leaves it to the usual size.

    Examples
    --------
    >>> units, finest = goal_scales(np.array([True, False, False]), np.array([2.0, 2.0, 2.0]), [None, None, 1e-9])
    >>> units.tolist(), finest.tolist()
    ([1.0, 2.0, 0.1], [0.0, 1e-08, 1e-08])
    """
    resolutions = np.array([math.inf if x is None else x for x in declared], dtype=float)
    units = np.where(log, 1.0, np.minimum(sizes, resolutions / FINEST))
    finest = np.where(np.isfinite(resolutions), resolutions / units, FINEST)
    return units, np.where(log, 0.0, finest)


def gap_tolerance(gap: float, log: np.ndarray, finest: np.ndarray, sizes: np.ndarray) -> np.ndarray:
    """The gap as a distance in phi, per objective.

    Parameters
    ----------
    gap : float
    log, finest : array (objectives,)
        As :func:`goal_scales` takes and gives them.
    sizes : array (objectives,)
        What the gap is a share of where it is not one of the value, in phi.
    """
    distance: np.ndarray = np.where(log, -np.log1p(-gap), np.maximum(gap * sizes, finest) - ROUNDING)
    return distance


def ranges(phi: np.ndarray) -> np.ndarray:
    """Reference of the gap of objectives that may be zero: their range, or size where they have none."""
    span = np.ptp(phi, axis=0)
    sizes: np.ndarray = np.where(span > 0, span, np.abs(phi).max(axis=0))
    return sizes


def rounded_up(amount: float, unit: str) -> float:
    """Return an amount in SI, so much larger that three digits tell it in its unit."""
    ratio = float(parse_unit(unit).ratio)
    shown = amount / ratio
    if not (math.isfinite(shown) and shown > 0):
        return amount
    digits = 10.0 ** (math.floor(math.log10(shown)) - 2)
    text = f"{math.ceil(shown / digits * (1 - 1e-12)) * digits:.3g}"
    return float(text) * ratio
