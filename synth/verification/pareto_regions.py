"""Regions of the objectives that a front leaves uncovered."""

from __future__ import annotations

import math

import numpy as np


def uncovered(points: np.ndarray) -> np.ndarray:
    """Return the ends of the regions that no point covers: everything below an end is not above any point.

    Parameters
    ----------
    points : array (points, objectives)

    Returns
    -------
    array (regions, objectives)
        Local upper bounds, infinite where nothing bounds a region.

    References
    ----------
    K. Klamroth, R. Lacour, D. Vanderpooten: On the representation of the search region in multi-objective
    optimization. European J. of Operational Research 245 (2015) 767-778.

    Examples
    --------
    >>> uncovered(np.array([[1.0, 2.0], [2.0, 1.0]])).tolist()
    [[inf, 1.0], [2.0, 2.0], [1.0, inf]]
    """
    ends = np.full((1, points.shape[1]), math.inf)
    for point in points:
        above = np.all(point < ends, axis=1)
        split = ends[above]
        parts = []
        for k in range(len(point)):
            part = split.copy()
            part[:, k] = point[k]
            parts.append(part)
        ends = np.unique(np.concatenate([ends[~above], *parts]), axis=0)
        inside = np.all(ends[:, None, :] <= ends[None, :, :], axis=2)
        np.fill_diagonal(inside, False)
        ends = ends[~inside.any(axis=1)]
    return ends[np.lexsort(ends.T)]
