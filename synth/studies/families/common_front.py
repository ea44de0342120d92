"""The one front of several families: the designs of all of them that no other one beats."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np
from msgspec import structs

from synth.order.margins import MARGINS
from synth.order.pareto import Scale, extremes, senses_of, spread_subset
from synth.results import Design
from synth.results.assembly import ranked, scale_of
from synth.studies.families.competitor import Competitor


class CommonFront:
    """Designs of several families on one front.

    Parameters
    ----------
    objectives : mapping
        Names and senses.
    points : int
        Designs that are listed, at most.
    weights : mapping, optional
        Objective -> weight for the ranking; 1 where missing.

    Attributes
    ----------
    members : list of Competitor
        Families whose designs stand on it; they come as they are searched.
    """

    def __init__(self, objectives: Mapping[str, str], points: int, weights: Mapping[str, float] | None = None) -> None:
        self.objectives, self.points, self._weights = dict(objectives), points, weights or {}
        self.senses = senses_of(self.objectives)
        self.members: list[Competitor] = []

    def signed(self, designs: Sequence[Design]) -> np.ndarray:
        """Return the objectives of designs in SI, those to be made large with a minus sign."""
        rows = [[d.values[n] for n in self.objectives] for d in designs]
        signed: np.ndarray = np.array(rows, dtype=float).reshape(len(designs), len(self.objectives)) * self.senses
        return signed

    def useful(self, designs: Sequence[Design]) -> list[Design]:
        """Designs that no known design dominates or equals."""
        known = self.everything()
        return [d for d, point in zip(designs, self.signed(designs), strict=True) if not beaten(known, point).any()]

    @property
    def weights(self) -> list[float]:
        """Weights of the objectives; families refuse what is none when they are asked."""
        return [float(self._weights.get(name, 1.0)) for name in self.objectives]

    def take(self, member: Competitor, fresh: Sequence[Design], proven: bool) -> None:
        """Add designs of a family; those that its own proof covers stand on its own front as well."""
        member.designs += fresh
        if not fresh or not proven:
            return
        better, front = self.signed(fresh), member.front
        pairs = zip(front.designs, self.signed(front.designs), strict=True)
        kept, chosen = [d for d, x in pairs if not beaten(better, x).any()], front.frame.objectives
        _, designs = ranked([*kept, *fresh], chosen, self.weights, front.complete, front.scale)
        settings = structs.replace(front.settings, points=max(self.points, len(designs)))
        scale = scale_of(designs, chosen, front.scale)
        member.front = replace(front, designs=designs, scale=scale, settings=settings)

    def everything(self) -> np.ndarray:
        """Return the objectives of all designs that are known, as ``signed`` does."""
        return self.signed([d for m in self.members for d in m.designs])

    def listed(self) -> tuple[list[tuple[Competitor, Design]], list[tuple[Competitor, Design]]]:
        """Return the designs of the common front, and all that nothing beats."""
        every = [(m, d) for m in self.members for d in m.designs]
        signed = self.signed([d for _, d in every])
        stay: list[int] = []
        for k, point in enumerate(signed):
            better = beaten(signed, point) & (strictly_better(signed, point) | (np.arange(len(signed)) < k))
            if not better.any():
                stay.append(k)
        front = [every[k] for k in stay]
        return [front[k] for k in self._spread([m for m, _ in front], signed[stay])], front

    def _spread(self, owners: Sequence[Competitor], signed: np.ndarray) -> list[int]:
        """Return designs that spread best, at most so many as asked for; no family is left out that has one.

        The first by rank stays in any case, and so do what is best in each objective as long as there are others.
        """
        if not len(signed):
            return []
        most, ends = self.points, extremes(signed)
        first = int(np.argmin(Scale.of(signed).scores(signed, self.weights)))
        chosen = [int(k) for k in spread_subset(signed, most, [first, *ends])]
        kept = [owners[k].one.label for k in chosen]
        for label in dict.fromkeys(m.one.label for m in owners):
            if label not in kept:
                spare = [k for k, owner in enumerate(kept) if kept.count(owner) > 1 and chosen[k] != first]
                spare = [k for k in spare if chosen[k] not in ends] or spare
                if not spare:
                    break
                low, high = signed.min(axis=0), signed.max(axis=0)
                unit = (signed - low) / np.where(high > low, high - low, 1.0)
                of_family = [k for k, m in enumerate(owners) if m.one.label == label]
                best = min(of_family, key=lambda k: float(np.linalg.norm(unit[k])))
                # It takes the place of the design nearest to it of a family that has more.
                gone = min(spare, key=lambda k: float(np.linalg.norm(unit[chosen[k]] - unit[best])))
                chosen[gone], kept[gone] = best, label
        return sorted(chosen)


def beaten(signed: np.ndarray, point: np.ndarray, of_others: bool = False) -> np.ndarray:
    """Tell which rows are as good as a design in every objective; ``of_others``: which ones it is as good as."""
    tolerance = MARGINS.same * np.maximum(np.abs(point), np.abs(signed))
    better = point <= signed + tolerance if of_others else signed <= point + tolerance
    result: np.ndarray = np.all(better, axis=1)
    return result


def strictly_better(signed: np.ndarray, point: np.ndarray) -> np.ndarray:
    """Tell which rows are better than a design in some objective."""
    tolerance = MARGINS.same * np.maximum(np.abs(point), np.abs(signed))
    result: np.ndarray = np.any(signed < point - tolerance, axis=1)
    return result
