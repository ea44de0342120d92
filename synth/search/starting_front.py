"""The front of an earlier search of the same question, to go on from: none of its designs is lost."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from synth.results import ParetoFront
from synth.search.formulation import Formulation


@dataclass(frozen=True)
class StartingFront:
    """Designs and proven gap of an earlier search.

    Parameters
    ----------
    phi : array (designs, objectives)
        Of its designs.
    gap : float, optional
        That was proven of them.
    amounts : array (objectives,)
        In SI: what its claim stands for where it is no share of the value; infinite where it is one.
    """

    phi: np.ndarray
    gap: float | None
    amounts: np.ndarray

    @classmethod
    def nothing(cls, objectives: int) -> StartingFront:
        """Stand-in for no earlier search."""
        return cls(np.empty((0, objectives)), None, np.full(objectives, math.inf))

    def places(self, phi: np.ndarray, rounded: float) -> list[int]:
        """Positions of designs that weakly dominate those of the starting front.

        Parameters
        ----------
        phi : array (designs, objectives)
        rounded : float
            Relative: objectives closer than this are the same.
        """
        places = dict[int, None]()
        for listed in self.phi:
            rounding = rounded * np.maximum(np.abs(listed), 1.0)
            as_good = np.flatnonzero(np.all(phi <= listed + rounding, axis=1))
            if len(as_good):
                places[int(as_good[np.argmin(phi[as_good].sum(axis=1))])] = None
        return list(places)


def starting_front(form: Formulation, front: ParetoFront) -> StartingFront:
    """Add the designs of an earlier search to the archive; return them with their proven gap."""
    points = np.array([[d.values[v.name] for v in form.model.variables] for d in front.designs])
    points = points.reshape(len(front.designs), form.n)
    combinations = np.array([form.instance.combinations.number(d) for d in front.designs], dtype=np.int64)
    closely, phi = form.points.feasible_rows(points, combinations)
    edge, _ = form.points.edge_rows(points, combinations)
    phi[edge] += form.tuning.tolerances.edge_worth
    rows = np.concatenate([closely, edge])
    form.archive.add(combinations[rows], points[rows], phi[rows])
    resolutions, traded = front.certificate.resolution, form.names[: form.traded]
    amounts = np.array([resolutions.get(name, math.inf) for name in traded])
    return StartingFront(phi[rows, : form.traded], front.certificate.gap, amounts)
