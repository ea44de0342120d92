"""Hypervolume of fronts against a reference front: both objectives smaller is better."""

from __future__ import annotations

import csv
from collections.abc import Sequence
from pathlib import Path

import moocore
import numpy as np

HERE = Path(__file__).parent
REFERENCE_POINT = 1.1  # where the ideal point of the reference front is 0 and its nadir 1


class Reference:
    """A front that others are measured by.

    Parameters
    ----------
    points : array (designs, objectives)
        In any units; dominated rows are dropped.
    """

    def __init__(self, points: np.ndarray) -> None:
        self.points = np.asarray(moocore.filter_dominated(np.asarray(points, dtype=float)))
        self._ideal = self.points.min(axis=0)
        self._range = self.points.max(axis=0) - self._ideal
        self._range[self._range <= 0] = 1.0
        self.volume = self._volume(self.points)

    def ratio(self, points: np.ndarray | Sequence[Sequence[float]]) -> float:
        """Return the hypervolume of a front over that of the reference."""
        return self._volume(np.asarray(points, dtype=float)) / self.volume

    def _volume(self, points: np.ndarray) -> float:
        if not len(points):
            return 0.0
        unit = (points - self._ideal) / self._range
        return float(moocore.hypervolume(unit, ref=np.full(unit.shape[1], REFERENCE_POINT)))


def path(size: str, grid: bool) -> Path:
    """Return the file of the stored reference of a size."""
    return HERE / f"reference_{size}{'_grid' if grid else ''}.csv"


def stored(size: str, grid: bool) -> np.ndarray:
    """Return the stored reference front of a size (designs, objectives); without rows where there is none."""
    file = path(size, grid)
    if not file.exists():
        return np.empty((0, 2))
    lines = [line for line in file.read_text(encoding="utf-8").splitlines() if not line.startswith("#")]
    return np.array([[float(cell) for cell in row] for row in list(csv.reader(lines))[1:]])


def store(size: str, grid: bool, points: np.ndarray, note: str) -> Path:
    """Write a reference front with the note of how it was made."""
    file = path(size, grid)
    front = np.unique(np.asarray(moocore.filter_dominated(points)), axis=0)
    lines = [f"# {line}" for line in note.splitlines()] + ["mass [kg],actuation_force [N]"]
    lines += [",".join(f"{x:.9g}" for x in row) for row in front]
    file.write_text("\n".join(lines) + "\n", encoding="utf-8")
    return file
