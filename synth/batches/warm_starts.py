"""Which questions of a job teach others: where one design is known, and what is worth splitting, less is left to learn.

One question in a hundred, drawn by its content, is a teacher; every other one is answered with the experience of the
teacher whose requirements are nearest. The teacher becomes part of what is asked, so that an answer still depends on
its question alone, not on what is solved before or where.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from synth.batches.entries import RowQuestion
from synth.batches.settings import BATCHES, WarmStartSettings
from synth.batches.solve import LIKE
from synth.queue.database import digest

SMALL = 1e-6  # SI; above it requirements are compared by their ratio


def place(values: Sequence[float]) -> tuple[float, ...]:
    """Position of requirements (SI) among others: steps of the same ratio are equally wide.

    Examples
    --------
    >>> near, far = place([100.0, -1.0]), place([200.0, -1.0])
    >>> round(far[0] - near[0], 6)
    0.693147
    """
    return tuple(np.arcsinh(np.asarray(values, dtype=float) / SMALL).tolist())


class WarmStarts:
    """The teachers of a job. All its questions are shown first; then each may ask who teaches it."""

    def __init__(self, settings: WarmStartSettings = BATCHES.warm_starts) -> None:
        self._settings = settings
        self._teachers: dict[str, dict[str, tuple[tuple[float, ...], Mapping[str, Any]]]] = {}
        self._nearest: dict[str, tuple[list[str], Any]] = {}

    def show(self, structure: str, key: str, where: tuple[float, ...], question: RowQuestion) -> None:
        """Show one question: its structure, key, place and content."""
        if int(key[:12], 16) % self._settings.one_in == 0:
            self._teachers.setdefault(structure, {})[key] = (where, question)

    def taught(
        self, structure: str, key: str, where: tuple[float, ...], question: RowQuestion
    ) -> tuple[str, Mapping[str, Any], str]:
        """Return the key of a question and the question, its teacher in it, and the key of that teacher.

        Teachers are taught by nobody, and stand for themselves; without any the last key is empty.
        """
        teachers = self._teachers.get(structure)
        if not teachers or key in teachers:
            return key, question, key if teachers else ""
        if structure not in self._nearest:
            from scipy.spatial import cKDTree  # costly to import; small jobs have no teachers

            keys = sorted(teachers)
            self._nearest[structure] = keys, cKDTree([teachers[k][0] for k in keys])
        keys, tree = self._nearest[structure]
        teacher = keys[int(tree.query(where)[1])]
        extended = {**question, LIKE: dict(teachers[teacher][1])}
        return digest(extended), extended, teacher
