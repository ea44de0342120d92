"""The designs that a search knows, as they are drawn while it is at work."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from synth.question.settings import ProgressState
from synth.search.formulation import Formulation
from synth.search.settings import ProgressLimits
from synth.units import from_si, header


class ShownDesigns:
    """Reports the objectives of the designs of an archive whenever they changed.

    Parameters
    ----------
    objectives : list of str
        Those that are traded off.
    limits : ProgressLimits
    """

    def __init__(self, objectives: Sequence[str], limits: ProgressLimits) -> None:
        self._objectives, self._limits = list(objectives), limits
        self._last: np.ndarray | None = None  # phi of the archive that was told last

    def of(self, form: Formulation) -> ProgressState:
        """Return ``columns``, names with units, and ``points``, a row of numbers in these units for each design.

        At most so many as the limits say, spread evenly along the first objective, its ends among them; nothing where
        no design is known or all have been told.
        """
        phi = form.archive.phi
        if not len(phi) or phi is self._last:
            return {}
        self._last = phi
        m, most = len(self._objectives), self._limits.points
        rows = np.argsort(phi[:, 0], kind="stable")
        if len(rows) > most:
            rows = rows[np.linspace(0, len(rows) - 1, most).round().astype(int)]
        senses = np.array([goal.sign for goal in form.goals[:m]], dtype=float)
        values = form.objectives.values_of(phi[rows, :m]) * senses
        units = [form.model.units[name] for name in self._objectives]
        columns = [np.asarray(from_si(values[:, k], unit)).tolist() for k, unit in enumerate(units)]
        return {
            "columns": [header(name, unit) for name, unit in zip(self._objectives, units, strict=True)],
            "points": [[self._number(x) for x in row] for row in zip(*columns, strict=True)],
        }

    def _number(self, value: float) -> float | None:
        return float(f"{value:.{self._limits.digits}g}") if math.isfinite(value) else None
