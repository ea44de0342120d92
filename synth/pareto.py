"""Dominance, and the ranking of a front."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

DIGITS = 9  # of phi, to which designs are the same: solvers differ beyond them


def non_dominated(phi: np.ndarray) -> np.ndarray:
    """Return the mask of the non-dominated rows; of rows equal to nine digits the first is kept."""
    if not len(phi):
        return np.zeros(0, dtype=bool)
    # Compared as they stand, two designs that differ in the last digits of the solver would both be kept.
    with np.errstate(over="ignore"):  # the largest numbers there are become infinite
        rounded = np.round(phi, DIGITS)
    if rounded.shape[1] > 2:
        import moocore  # costly to import; few questions need it

        return np.asarray(moocore.is_nondominated(rounded, keep_weakly=False), dtype=bool)
    # In order of the first objective, a row is beaten unless it is better in the last one than all before it.
    order = np.lexsort(rounded.T[::-1])
    last = rounded[order, -1]
    better = np.ones(len(order), dtype=bool)
    better[1:] = last[1:] < np.minimum.accumulate(last)[:-1]
    keep = np.zeros(len(order), dtype=bool)
    keep[order[better]] = True
    return keep


def extremes(phi: np.ndarray) -> list[int]:
    """Return the positions of the rows that are least in a column."""
    return list(dict.fromkeys(int(np.argmin(phi[:, k])) for k in range(phi.shape[1]))) if len(phi) else []


def spread_subset(phi: np.ndarray, count: int, first: Sequence[int] | None = None) -> np.ndarray:
    """Return positions of at most ``count`` rows: the ``first``, then always the one farthest from those taken.

    The extremes are the first ones by default.
    """
    if len(phi) <= count:
        return np.arange(len(phi))
    span = np.maximum(phi.max(axis=0) - phi.min(axis=0), 1e-300)
    unit = (phi - phi.min(axis=0)) / span
    taken = list(dict.fromkeys(extremes(unit) if first is None else first))[:count]
    # Column by column: rows are many and short.
    columns = np.ascontiguousarray(unit.T)
    distance = np.full(len(unit), np.inf)
    for row in taken:
        np.minimum(distance, _distances(columns, row), out=distance)
    while len(taken) < count:
        farthest = int(np.argmax(distance))
        taken.append(farthest)
        np.minimum(distance, _distances(columns, farthest), out=distance)
    return np.sort(np.array(taken))


def _distances(columns: np.ndarray, row: int) -> np.ndarray:
    """Return the distances of all rows of a table, which is given by columns, from one of them."""
    square = np.zeros(columns.shape[1])
    for column in columns:
        apart = column - column[row]
        square += apart * apart
    distances: np.ndarray = np.sqrt(square, out=square)
    return distances


@dataclass(frozen=True)
class Ranking:
    """Order of the designs of a front (positions, best first), their scores and notes."""

    order: list[int]
    scores: np.ndarray
    notes: list[str]


def rank(
    objectives: Mapping[str, str], values: np.ndarray, weights: Sequence[float], complete: bool = False
) -> Ranking:
    """Rank designs by their weighted distance to the ideal point.

    Parameters
    ----------
    objectives : mapping
        Names and senses.
    values : array (designs, objectives)
        SI.
    weights : list of float
        One per objective.
    complete : bool
        Whether there are no other non-dominated designs.

    Returns
    -------
    Ranking
    """
    signs = np.array([1.0 if sense == "min" else -1.0 for sense in objectives.values()])
    signed = values * signs
    ideal, nadir = signed.min(axis=0), signed.max(axis=0)
    unit = np.where(nadir > ideal, (signed - ideal) / np.where(nadir > ideal, nadir - ideal, 1.0), 0.0)
    share = np.asarray(weights, dtype=float) / np.sum(weights)
    scores = np.sqrt(np.sum(share * unit**2, axis=1))
    keys = [*(np.round(signed[:, k], 15) for k in reversed(range(signed.shape[1]))), np.round(scores, 12)]
    order = [int(k) for k in np.lexsort(keys)]
    notes: list[list[str]] = [[] for _ in order]
    if len(order) > 1:
        for k, (name, sense) in enumerate(objectives.items()):
            word = "smallest" if sense == "min" else "largest"
            notes[int(np.argmin(signed[:, k]))].append(f"{word} {name}")
        if len(order) > 2 and signed.shape[1] > 1:
            notes[int(np.argmin(unit.sum(axis=1)))].append("knee")
    elif signed.shape[1] == 1:
        notes[0].append("optimum")
    elif complete:
        notes[0].append("only non-dominated design")
    return Ranking(order, scores, ["; ".join(n) for n in notes])
